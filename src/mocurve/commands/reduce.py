"""`mocurve reduce`: the main job."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from .. import reduction
from ..errors import UnknownName
from ..formats import FORMATS, read, write
from ._options import Html, Json, Profile, Source, Unit, check_outputs, tell, with_options_of
from ._terminal import told_when_compiling

Output = Annotated[
    Path | None,
    Parameter(
        name=("--output", "-o"),
        help="Where the result goes: .curves.json keeps the keys, .blend.py .glb .usda .ma carry them on, others get "
        "samples.",
    ),
]


@with_options_of(reduction.reduce)
@told_when_compiling()
def reduce(
    file: Source,
    /,
    *,
    output: Output = None,
    profile: Profile = None,
    html: Html = None,
    unit: Unit = None,
    json: Json = False,
    **options: Any,
) -> None:
    """Few Hermite keys instead of a sample at every frame; nothing moves more than the tolerance.

    The promise is checked at every frame. Give --tolerance as often as needed:
      2mm  0.2cm  0.05in     how far any joint may be from where it was, in space
      0.1%height             the same, as a part of the body's height at rest
      0.35u                  the same, in the file's own unit
      0.5deg  0.5%range      how far any channel may be off
      LeftHand=0.5mm         only this joint (or LeftArm.Xrotation=0.1deg)
      @1.2..2.0=0.2mm        only from second 1.2 to second 2.0
      LeftHand@1..2=0.2mm    both
      0.3sigma               a part of each channel's noise (with --denoise)
    Or ask for a number of whole poses: --keys 16, with --pin where keys have to be.

    For example:
      mocurve reduce jump.bvh -o jump.curves.json --html jump.html
      mocurve reduce jump.bvh -o jump.glb --profile linear --tolerance 5mm
      mocurve reduce jump.bvh -o blocked.curves.json --keys 16 --pin 0.8s --pin contacts
      mocurve reduce jump.bvh -o small.bvh --tolerance 2mm --tolerance '*Hand=0.5mm'
    """
    check_outputs(file, output, html)
    if output is not None and not output.name.lower().endswith(tuple(FORMATS)):
        raise UnknownName("format", output.suffix, FORMATS)
    clip = read(file, unit=unit)
    keys = reduction.reduce(clip, **options)
    assert keys.report is not None  # reduce always measures
    if output is not None:
        write(output, keys, profile=profile)
    if html is not None:
        keys.report.save(html)
    tell(keys.report, json, output, html)
