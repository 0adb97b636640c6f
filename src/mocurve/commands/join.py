"""`mocurve join`: two motions, one after the other."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from ..edit import join as joining
from ..formats import format_of, read, write
from ._options import Json, Source, Unit, check_outputs, tell, with_options_of
from ._terminal import told_when_compiling

Second = Annotated[Path, Parameter(help="The clip that follows")]
Output = Annotated[Path, Parameter(name=("--output", "-o"), help="Where both go, in any format.")]


@with_options_of(joining.join)
@told_when_compiling()
def join(
    first: Source, second: Second, /, *, output: Output, unit: Unit = None, json: Json = False, **options: Any
) -> None:
    """One motion over into another, where the two look most alike.

    The second is moved and turned to where the first has arrived. Where they were
    joined is told, and how the steps and accelerations there compare with the
    clips' own.

    For example:
      mocurve join walk.bvh run.bvh -o both.bvh
      mocurve join walk.bvh run.bvh -o both.bvh --leave 2.1 --enter 0.4
      mocurve join walk.bvh other_body.bvh -o both.bvh --match names --json
    """
    check_outputs(first, output)
    check_outputs(second, output)
    format_of(output)  # refused before work is done
    made = joining.join(read(first, unit=unit), read(second, unit=unit), **options)
    write(output, made)
    tell(joining.Join(**made.history[-1]["measured"]), json, output)
