"""`mocurve limit`: joints within what they can do."""

from __future__ import annotations

from typing import Annotated, Any

from cyclopts import Parameter

from ..edit import limit as verb
from ..formats import read
from ._edits import Edited, Lossless, Output, changed, check_files, finish, sentence
from ._options import Json, Profile, Source, with_options_of
from ._terminal import told_when_compiling

Limits = Annotated[
    list[str] | None,
    Parameter(
        name="--limit",
        help="Of a channel, LeftArm.Zrotation=-90:45, or of an angle that the command tells, LeftLeg.flexion=-3:140; "
        "one side may be left out. By default what the file says, else ranges of people.",
        consume_multiple=True,
    ),
]


@with_options_of(verb.limit)
@told_when_compiling()
def limit(
    file: Source,
    /,
    *,
    output: Output,
    limits: Limits = None,
    profile: Profile = None,
    lossless: Lossless = False,
    json: Json = False,
    **options: Any,
) -> None:
    """Joints kept within what they can do, bent smoothly wherever they are not.

    Limits come from --limit; else from the file (Acclaim); else knees, elbows,
    hips and shoulders are found by name and get ranges of people. Which, and what
    was changed, is told. Frames away from a violation stay to the last digit.

    Where that is not enough:
      this person bends further        --limit 'Left*.flexion=-5:165'
      only knees and elbows            --only '*Leg' '*ForeArm'
      it bends too suddenly            --support 0.4

    For example:
      mocurve limit walk.bvh -o able.bvh
      mocurve limit jump.bvh -o able.bvh --limit LeftArm.Zrotation=-90:45 --json
    """
    check_files(output, file)
    clip = read(file)
    made = verb.limit(clip, limits, **options)
    measured = made.history[-1]["measured"]
    rows = [verb.Limited(**row) for row in measured["angles"]]
    lines = [f"limits: {measured['source']}", *(str(row) for row in rows if row.runs)]
    lines += (
        [f"within: {', '.join(row.named for row in rows if not row.runs)}"] if not all(row.runs for row in rows) else []
    )
    lines += [f"not limited: {line}" for line in measured["not_limited"]]
    lines += [
        f"{measured['frames']} frames changed; largest violation {measured['before']:.3g}, now {measured['after']:.2g}"
    ]
    told = changed(clip, made)
    finish(Edited(made, {"changed": told}, (*lines, sentence(told, "changed"))), output, profile, lossless, json)
