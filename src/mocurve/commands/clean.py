"""`mocurve clean`: noise out, motion kept."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from .. import denoising
from ..formats import format_of, read, write
from ._options import Html, Json, Source, Unit, check_outputs, tell, with_options_of
from ._terminal import told_when_compiling

Output = Annotated[
    Path | None,
    Parameter(name=("--output", "-o"), help="Where the clean clip goes. Without it the noise is only told, or shown."),
]


@with_options_of(denoising.denoise)
@told_when_compiling()
def clean(
    file: Source,
    /,
    *,
    output: Output = None,
    html: Html = None,
    unit: Unit = None,
    json: Json = False,
    **options: Any,
) -> None:
    """Jitter, spikes and dropouts of a capture go; kicks and heel strikes stay. Nothing has to be tuned.

    How much each channel shakes is measured, and it is smoothed as far as that
    asks for, less where it moves fast. Spikes, flips, frozen frames and gaps are
    found and filled in; parts that are displaced for a while are moved back. What
    was found is told, and shown with --html.

    Where that is not enough:
      it still shakes: "no white noise floor found"   --strength 1.4  or  --limit 6
      only one limb is bad                            --only 'Left*Arm'
      a real hit was taken for a spike                --mark: told, but kept
      the clip begins with a T-pose                   --drop-t-pose

    For example:
      mocurve clean noisy.bvh -o clean.bvh --html clean.html
      mocurve clean kinect.bvh -o clean.bvh --limit 6
      mocurve clean noisy.bvh --mark --json
    """
    check_outputs(file, output, html)
    if output is not None:
        format_of(output)  # refused before work is done
    made = denoising.denoise(read(file, unit=unit), **options)
    assert made.report is not None  # denoise always measures
    if output is not None:
        write(output, made)
    if html is not None:
        made.report.save(html)
    tell(made.report, json, output, html)
