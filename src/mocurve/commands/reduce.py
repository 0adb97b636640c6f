"""`mocurve reduce`: the main job."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .. import reduction
from ..formats import read, write
from ._options import Html, Json, Unit, keep_apart, print_json, with_options_of
from ._terminal import told_when_compiling

Output = Annotated[
    Path | None,
    Parameter(
        name=("--output", "-o"), help="Where the result goes: .curves.json keeps the keys; .bvh .csv .npz get samples."
    ),
]


@with_options_of(reduction.reduce)
def reduce(
    file: Path, /, *, output: Output = None, html: Html = None, unit: Unit = None, json: Json = False, **options: object
) -> None:
    """Few Hermite keys instead of a sample at every frame; nothing moves more than the tolerance.

    The promise is checked at every frame. A tolerance is a length in space (2mm 0.2cm 0.05in 0.1%height 0.35u, where u
    is the file's unit) or holds for each channel (0.5deg 0.5%range), for all or for one joint or channel, always or
    from one second to another: LeftHand=0.5mm  @1.2..2.0=0.2mm  LeftHand@1.2..2.0=0.2mm  LeftKnee.Xrotation=0.1deg

    Examples:
      mocurve reduce jump.bvh -o jump.curves.json --html jump.html
      mocurve reduce jump.bvh -o jump.bvh.npz --tolerance 2mm --tolerance LeftHand=0.5mm
    """
    keep_apart(file, output, html)
    clip = read(file, unit=unit)
    with told_when_compiling():
        keys = reduction.reduce(clip, **options)
    if output is not None:
        write(output, keys)
    if html is not None:
        keys.report.save(html)
    print_json(keys.report.to_json()) if json else print(keys.report)
