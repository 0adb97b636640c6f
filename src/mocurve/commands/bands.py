"""`mocurve bands`: the fine and the slow of a motion."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from ..edit import bands as verb
from ..formats import read
from ._edits import Edited, Lossless, changed, check_files, finish, sentence
from ._options import Json, Profile, Source, tell, with_options_of
from ._terminal import told_when_compiling

Output = Annotated[
    Path | None,
    Parameter(name=("--output", "-o"), help="Where the result goes. Without it the bands are only told."),
]
Gains = Annotated[
    list[str],
    Parameter(
        help="Gains from the finest band on, 0,0.5, of some, 0=0 3=1.5, or of the band that holds a frequency, 6Hz=2. "
        "Others have 1.",
        consume_multiple=True,
    ),
]


@with_options_of(verb.bands)
@told_when_compiling()
def bands(
    file: Source,
    /,
    *,
    output: Output = None,
    gains: Gains = [],  # noqa: B006  # never changed
    profile: Profile = None,
    lossless: Lossless = False,
    json: Json = False,
    **options: Any,
) -> None:
    """The fine and the slow of a motion, each made more or less: smoothed, or exaggerated.

    Without --output the bands of the clip are told: frequencies, periods, and how
    large each is. Then say gains: 0 takes a band away, 2 doubles it.

    For example:
      mocurve bands jump.bvh
      mocurve bands jump.bvh -o smooth.bvh --gains 0=0 1=0.5
      mocurve bands jump.bvh -o lively.bvh --gains 2Hz=1.6 --only '*Arm'
    """
    if output is not None:
        check_files(output, file)
    clip = read(file)
    made = verb.bands(clip, gains, **options)
    told = changed(clip, made)
    rows = [verb.Band(**row) for row in made.history[-1]["measured"]]
    lines = [" band  frequencies", *map(str, rows)] if rows else ["too few frames for a band"]
    found = Edited(made, {"bands": made.history[-1]["measured"], "changed": told}, (*lines, sentence(told, "changed")))
    if output is None:
        tell(found, json)
    else:
        finish(found, output, profile, lossless, json)
