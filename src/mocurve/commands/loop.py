"""`mocurve loop`: a cycle, closed and repeated."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from ..edit import loop as looping
from ..formats import format_of, read, write
from ._options import Json, Source, Unit, check_outputs, tell, with_options_of
from ._terminal import told_when_compiling

Output = Annotated[Path, Parameter(name=("--output", "-o"), help="Where the loop goes, in any format.")]


@with_options_of(looping.loop)
@told_when_compiling()
def loop(file: Source, /, *, output: Output, unit: Unit = None, json: Json = False, **options: Any) -> None:
    """One cycle of a motion, closed and repeated without a seam.

    The clearest cycle is found, and where in it a cut shows least. Each cycle goes
    on from where the one before has arrived, also in a curve. What was cut, and
    how well the ends meet, is told.

    Where that is not enough:
      another cycle is meant           --start 1.2, or --start 1.2 --end 2.3
      the clip is just one cycle       --start 0 --end 1.1 --close cubic

    For example:
      mocurve loop walk.bvh -o tour.bvh --cycles 8
      mocurve loop jump.bvh -o hops.bvh --cycles 3 --json
    """
    check_outputs(file, output)
    format_of(output)  # refused before work is done
    made = looping.loop(read(file, unit=unit), **options)
    write(output, made)
    tell(looping.Loop(**made.history[-1]["measured"]), json, output)
