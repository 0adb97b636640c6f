"""`mocurve compare`: what changed."""

from __future__ import annotations

from .. import measure
from ..formats import read
from ._options import Html, Json, Source, Unit, check_outputs, tell
from ._terminal import told_when_compiling


@told_when_compiling()
def compare(before: Source, after: Source, /, *, html: Html = None, unit: Unit = None, json: Json = False) -> None:
    """What changed between two clips: per channel, per joint, and as a page to look at.

    Both must have the same skeleton. Errors are in degrees, in the file's length
    unit, and in space: how far joints and ends of limbs are from where they were.

    For example:
      mocurve compare jump.bvh jump.curves.json --html jump.html
    """
    check_outputs(before, html)
    check_outputs(after, html)
    report = measure.compare(read(before, unit=unit), read(after, unit=unit))
    if html is not None:
        report.save(html)
    tell(report, json, html)
