"""`mocurve retime`: slower here, faster there."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from cyclopts import Parameter

from ..edit import retime as verb
from ..formats import read
from ._edits import Edited, Lossless, Output, check_files, finish
from ._options import Json, Profile, Source, with_options_of
from ._terminal import told_when_compiling

Map = Annotated[
    list[str], Parameter(help="Old time and new one, seconds, T:NEW, as many as needed.", consume_multiple=True)
]


@with_options_of(verb.retime)
@told_when_compiling()
def retime(
    file: Source,
    /,
    *,
    output: Output,
    map: Map,
    profile: Profile = None,
    lossless: Lossless = False,
    json: Json = False,
    **options: Any,
) -> None:
    """Moments of a clip moved to other times; smooth in between, never backwards.

    The start stays at 0; what comes after the last pair keeps its speed.

    For example:
      mocurve retime jump.bvh -o slower.bvh --map 3.49:5
      mocurve retime jump.curves.json -o land.curves.json --map 2:2 2.4:2.6
    """
    check_files(output, file)
    clip = read(file)
    bent = verb.time_map(clip, map)
    made = verb.retime(clip, map, **options)
    rate = bent.speeds(np.linspace(bent.old[0], bent.old[-1], 1000))
    off = verb.departure(clip, made, bent)
    numbers = {"speed": {"least": float(1.0 / rate.max()), "greatest": float(1.0 / rate.min())}, "off": off}
    told = (
        f"speed {1.0 / rate.max():.3g} to {1.0 / rate.min():.3g} times the old one",
        f"off the bent curves by up to {off['degrees']:.3g} degrees, {off['units']:.3g} units",
    )
    finish(Edited(made, numbers, told), output, profile, lossless, json)
