"""`mocurve fit`: curves on few knots."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from .. import fitting
from ..formats import format_of, read, write
from ._options import Json, Profile, Source, Unit, check_outputs, tell, with_options_of
from ._terminal import told_when_compiling

Output = Annotated[
    Path | None,
    Parameter(
        name=("--output", "-o"),
        help="Where the result goes: .spline.json keeps the splines, .curves.json .blend.py .glb .usda .ma the same "
        "curves as keys, others samples.",
    ),
]


@with_options_of(fitting.fit)
@told_when_compiling()
def fit(
    file: Source,
    /,
    *,
    output: Output = None,
    profile: Profile = None,
    unit: Unit = None,
    json: Json = False,
    **options: Any,
) -> None:
    """B-splines on few knots, which all channels share; nothing moves more than the tolerance.

    The promise is checked at every frame, and --tolerance takes all that
    mocurve reduce takes: 2mm, 0.1%height, 0.5deg, LeftHand=0.5mm, @1..2=0.2mm.
    Keys (mocurve reduce) are fewer numbers; splines have no corners, and
    blending, adding or warping them is arithmetic on their coefficients.

    For example:
      mocurve fit jump.bvh -o jump.spline.json --tolerance 1%height
      mocurve fit jump.bvh -o jump.spline.json --knots uniform --spans 40
      mocurve fit jump.bvh --tolerance 0.5deg --json
    """
    check_outputs(file, output)
    if output is not None:
        format_of(output)  # refused before work is done
    made = fitting.fit(read(file, unit=unit), **options)
    assert made.report is not None  # fit always measures
    if output is not None:
        write(output, made, profile=profile)
    tell(made.report, json, output)
