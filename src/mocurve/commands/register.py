"""`mocurve register`: one clip in step with another."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from ..edit import register as registering
from ..formats import format_of, read, write
from ._options import Json, Source, Unit, check_outputs, tell, with_options_of
from ._terminal import told_when_compiling

Reference = Annotated[Path, Parameter(help="The clip that sets the pace")]
Output = Annotated[Path, Parameter(name=("--output", "-o"), help="Where the retimed clip goes, in any format.")]


@with_options_of(registering.register)
@told_when_compiling()
def register(
    clip: Source, reference: Reference, /, *, output: Output, unit: Unit = None, json: Json = False, **options: Any
) -> None:
    """One clip retimed so that it runs in step with another.

    At every moment it does what the reference does: the pairs of moments that look
    alike are found by dynamic time warping, and time is bent smoothly along them.
    Steps of walks that are to be blended fall together then.

    For example:
      mocurve register slow.bvh quick.bvh -o in_step.bvh
      mocurve register slow.bvh quick.bvh -o in_step.bvh --band 0.3 --json
    """
    check_outputs(clip, output)
    check_outputs(reference, output)
    format_of(output)  # refused before work is done
    made = registering.register(read(clip, unit=unit), read(reference, unit=unit), **options)
    write(output, made)
    tell(registering.Registration(**made.history[-1]["measured"]), json, output)
