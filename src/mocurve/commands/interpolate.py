"""`mocurve interpolate`: between motions of one kind."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from ..edit import interpolate as verb
from ..formats import format_of, read, write
from ._edits import Lossless, Output
from ._options import Json, Profile, Source, Unit, check_outputs, tell, with_options_of
from ._terminal import told_when_compiling

More = Annotated[Path, Parameter(name="MORE", help="More clips.")]
Weights = Annotated[
    list[str] | None,
    Parameter(
        help="How much of each clip: 0.3,0.7, or one after the other, 0:1,2:0 0:0,2:1 (changes in time). Below 0 is "
        "away from a clip: --weights=-0.5,1.5. Default: all the same.",
        consume_multiple=True,
    ),
]
Places = Annotated[
    list[str] | None,
    Parameter(
        help="Instead: where each clip stands among adverbs, 0,1,2, or with two adverbs 0,0 1,0 0,1.",
        consume_multiple=True,
    ),
]
At = Annotated[
    list[str] | None,
    Parameter(help="Where among the places: 0.5, or 0.5,0.2, or changing in time, 0:0,2:1.", consume_multiple=True),
]


@with_options_of(verb.interpolate)
@told_when_compiling()
def interpolate(
    first: Source,
    second: Source,
    /,
    *more: More,
    output: Output,
    weights: Weights = None,
    places: Places = None,
    at: At = None,
    unit: Unit = None,
    profile: Profile = None,
    lossless: Lossless = False,
    json: Json = False,
    **options: Any,
) -> None:
    """Between motions of one kind, brought in step: a walk, a run, and what lies between or beyond.

    Moments that look alike are found, and poses, timing and the way the body goes
    are mixed there. Of gaits, --method fourier takes one cycle of each clip.

    For example:
      mocurve interpolate walk.bvh limp.bvh -o half.bvh --weights 0.5,0.5
      mocurve interpolate walk.bvh run.bvh -o jog.bvh --method fourier --cycles 4
      mocurve interpolate slow.bvh walk.bvh run.bvh -o at.bvh --places 0.8,1.4,3.5 --at 2
      mocurve interpolate walk.bvh limp.bvh -o over.bvh --weights 0:1,2:0 0:0,2:1 --json
    """
    sources = [first, second, *more]
    format_of(output)  # refused before work is done
    for source in sources:
        check_outputs(source, output)
    made = verb.interpolate([read(source, unit=unit) for source in sources], weights, places, at, **options)
    write(output, made, profile=profile, lossless=lossless)
    tell(verb.Interpolation(**made.history[-1]["measured"]), json, output)
