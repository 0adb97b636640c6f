"""`mocurve blend`: between clips."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from ..edit import blend as verb
from ..edit.mix import mix
from ..errors import OptionError
from ..formats import read
from ._edits import Edited, Lossless, Output, changed, check_files, finish, sentence
from ._options import Json, Profile, Source, with_options_of
from ._terminal import told_when_compiling

More = Annotated[Path, Parameter(name="MORE", help="More clips, for --weights.")]
Weight = Annotated[
    list[str] | None,
    Parameter(
        help="How much of the second clip: 0.3, 0:0,2:1 (changes in time), 'Left*=0.3' (only there). Default 0.5."
    ),
]
Weights = Annotated[str | None, Parameter(help="The mean of all clips instead: a weight for each, 0.2,0.3,0.5.")]


@with_options_of(verb.blend)
@told_when_compiling()
def blend(
    first: Source,
    second: Source,
    /,
    *more: More,
    output: Output,
    weight: Weight = None,
    weights: Weights = None,
    profile: Profile = None,
    lossless: Lossless = False,
    json: Json = False,
    **options: Any,
) -> None:
    """Between two clips, or the mean of several: joints turn the shorter way, without flips.

    Clips of different length are stretched onto one another. Body and frame
    time are the first's.

    For example:
      mocurve blend walk.bvh run.bvh -o jog.bvh --weight 0.5
      mocurve blend walk.bvh run.bvh -o faster.bvh --weight 0:0,2:1
      mocurve blend walk.bvh wave.bvh -o both.bvh --weight '*Arm=1'
      mocurve blend a.bvh b.bvh c.bvh -o mean.bvh --weights 1,1,2
    """
    sources = [first, second, *more]
    check_files(output, *sources)
    if (more and weights is None) or (weights is not None and weight is not None):
        raise OptionError("two clips are blended with --weight; several with --weights, a number for each")
    clips = [read(source) for source in sources]
    if weights is not None:
        made = mix(clips, [_number(text) for text in weights.split(",")], **options)
    else:
        made = verb.blend(clips[0], clips[1], 0.5 if weight is None else weight, **options)
    told = changed(clips[0], made)
    finish(
        Edited(made, {"from_first": told}, (sentence(told, "from the first clip"),)), output, profile, lossless, json
    )


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise OptionError(f"weights are numbers, one for each clip, like 1,1,2; not {text!r}") from None
