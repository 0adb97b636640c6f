"""`mocurve act-out`: the timing of a performance."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import numpy as np
from cyclopts import Parameter

from ..edit import act_out as verb
from ..errors import OptionError, UnknownName
from ..formats import read
from ..formats.csv import signals
from ..motion import Clip
from ._edits import Edited, Lossless, Output, check_files, finish
from ._options import Json, Profile, Source, with_options_of
from ._terminal import told_when_compiling

Performed = Annotated[
    Path,
    Parameter(
        help="A table (.csv) with a column time and what was performed; only times: taps. Or a clip that does the same."
    ),
]
Column = Annotated[
    list[str] | None,
    Parameter(help="Which column of the table, where it has more; for speeds, which columns.", consume_multiple=True),
]
Fps = Annotated[float | None, Parameter(help="Rows a second of a table without a column time.")]


@with_options_of(verb.act_out)
@told_when_compiling()
def act_out(
    file: Source,
    /,
    *,
    output: Output,
    performance: Performed,
    column: Column = None,
    fps: Fps = None,
    profile: Profile = None,
    lossless: Lossless = False,
    json: Json = False,
    **options: Any,
) -> None:
    """A clip gets the timing with which somebody performs it.

    Say what is performed, --channel or --joint. Its highs and lows are those of
    the performance, in order; what only one of the two has is left out.

    For example:
      mocurve act-out wave.bvh -o timed.bvh --performance mouse.csv --joint LeftHand
      mocurve act-out walk.bvh -o beat.bvh --performance taps.csv --joint LeftFoot --features lows
      mocurve act-out wave.curves.json -o as_she_does.curves.json --performance her.bvh --joint LeftHand --json
    """
    check_files(output, file, performance)
    one = options.get("of") != "speed"
    table = performance.suffix.lower() == ".csv"
    acted = _table(performance, column, fps, one) if table else _clip(performance, column, fps)
    made = verb.act_out(read(file), acted, **options)
    found = verb.ActedOut(**made.history[-1]["measured"])
    finish(Edited(made, sentences=(str(found),)), output, profile, lossless, json)


def _clip(path: Path, column: list[str] | None, fps: float | None) -> Clip:
    if column is not None or fps is not None:
        raise OptionError(f"--column and --fps are of tables, and {path} is a clip")
    return read(path)


def _table(path: Path, wanted: list[str] | None, fps: float | None, one: bool) -> np.ndarray:
    """Rows of seconds and values, or seconds of taps."""
    columns, time = signals(path)
    if fps is not None and not (np.isfinite(fps) and fps > 0):
        raise OptionError(f"--fps is a positive number of rows a second, not {fps:g}")
    for name in wanted or []:
        if name not in columns:
            raise UnknownName("column", name, columns)
    names = wanted or [name for name in columns if name != time]
    if one and len(names) > 1:
        raise OptionError(f"{path} has the columns {', '.join(names[:8])}: --column says which was performed")
    count = len(next(iter(columns.values())))
    if fps is not None:
        seconds = np.arange(count) / fps
    elif time is not None:
        seconds = columns[time]
    elif len(columns) == 1:
        return next(iter(columns.values()))  # taps
    else:
        raise OptionError(f"{path} has no column 'time': --fps says how many rows a second it has")
    return np.column_stack([seconds, *(columns[name] for name in names)]) if names else seconds
