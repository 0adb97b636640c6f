"""`mocurve waveshape`: values of channels put through a curve."""

from __future__ import annotations

from typing import Annotated, Any

from cyclopts import Parameter

from ..edit import waveshape as verb
from ..errors import OptionError
from ..formats import read
from ._edits import Edited, Lossless, Output, check_files, finish
from ._options import Json, Profile, Source, with_options_of
from ._terminal import told_when_compiling

Soft = Annotated[
    list[str],
    Parameter(
        help="Limits that a channel bends towards, LeftArm.Zrotation=-90:45; one side may be left out.",
        consume_multiple=True,
    ),
]
Map = Annotated[
    list[str],
    Parameter(
        help="Old and new values that a rising curve goes through: LeftArm.Zrotation=-90:-60,0:0,90:60.",
        consume_multiple=True,
    ),
]


@with_options_of(verb.waveshape)
@told_when_compiling()
def waveshape(
    file: Source,
    /,
    *,
    output: Output,
    soft: Soft = [],  # noqa: B006  # never changed
    map: Map = [],  # noqa: B006
    profile: Profile = None,
    lossless: Lossless = False,
    json: Json = False,
    **options: Any,
) -> None:
    """Values of channels put through a curve: bent softly towards limits, or through given pairs.

    The curve rises and is smooth, and where it leaves values alone they stay to the
    last digit. For limits that nothing but a violation touches: mocurve limit.

    For example:
      mocurve waveshape jump.bvh -o soft.bvh --soft LeftForeArm.Zrotation=-60:60
      mocurve waveshape jump.bvh -o less.bvh --map Hips.Yposition=15:15.5,17:17,20:18
    """
    check_files(output, file)
    if not soft and not map:
        raise OptionError("waveshape takes --soft NAME=LOW:HIGH or --map NAME=OLD:NEW,OLD:NEW, or both")
    made = verb.waveshape(read(file), soft, map, **options)
    rows = made.history[-1]["measured"]
    finish(
        Edited(made, {"channels": rows}, tuple(str(verb.Shaped(**row)) for row in rows)),
        output,
        profile,
        lossless,
        json,
    )
