"""A comparison as one page to look at (.html, complete in itself), as .json or as .txt.

The page shows the numbers, the animation curve of any channel before and after with keys and tangents, both skeletons
playing in space, the error of every joint, and what other tolerances would have given (Önder 2007, figures 4.1 to 4.5
and 4.7); of a clip that was denoised also its noise, spectra and artefacts.
"""

from __future__ import annotations

import html
import json
import math
from importlib.resources import files
from os import PathLike
from pathlib import Path

from .errors import OptionError
from .formats._files import replacing
from .measure import Report, compare
from .motion import Clip
from .report_data import page_data
from .report_sweep import sweep_data

KINDS = (".html", ".json", ".txt")

SCRIPTS = ("base.js", "noise.js", "curves.js", "figures.js", "errors.js")  # in this order, one scope


def save(report: Report | tuple[Clip, Clip], path: str | PathLike[str], *, sweep: bool = True) -> None:
    """Write a report, or the comparison of two clips, as .html, .json or .txt.

    sweep: the page also shows what other tolerances would give; that takes seconds, reducing the first clip again. Not
    where the second clip was only denoised.

    OptionError for another extension, or for a page of a report that was read from JSON and so has no clips to show.

    >>> mc.compare(walk, mc.reduce(walk, tolerance="2mm")).save("walk.html")
    """
    path = Path(path)
    kind = path.suffix.lower()
    if kind not in KINDS:
        raise OptionError(f"{path.name}: the extension of a report is one of {', '.join(KINDS)}, not {kind!r}")
    told = report if isinstance(report, Report) else compare(*report)
    if kind == ".html":
        text = page(told, path.stem, sweep=sweep)
    else:
        text = (json.dumps(told.to_json(), indent=1) if kind == ".json" else str(told)) + "\n"
    with replacing(path) as file:
        file.write(text.encode(errors="replace"))  # a file name may hold bytes that are no text


def page(report: Report, title: str, *, sweep: bool = True) -> str:
    """The page as text: data, style, program and plotly.js in one, so that it opens from a folder without a network."""
    from plotly.offline import get_plotlyjs

    from . import __version__

    if report.clips is None:
        raise OptionError("this report has no clips to show; save compare(a, b) as .html")
    if not math.isfinite(report.max_error_world + (report.max_error_degrees or 0) + (report.max_error_length or 0)):
        raise OptionError("a clip has values that are not finite numbers; they cannot be drawn")
    data = page_data(report)
    if report.noise is not None and not data["keyed"]:
        sweep = False  # a clip that was cleaned and not reduced has no tolerance
    data["sweep"] = sweep_data(report) if sweep else None
    folder = files("mocurve") / "report_page"
    parts = {
        "title": html.escape(title),
        "version": __version__,
        "style": (folder / "page.css").read_text("utf-8"),
        "script": "".join((folder / name).read_text("utf-8") for name in SCRIPTS),
        "plotly": get_plotlyjs().replace("</script", "<\\/script"),
        "data": json.dumps(data).replace("<", "\\u003c"),  # so that no </script> comes from a joint's name
    }
    parts["size"] = f"{sum(map(len, parts.values())) / 1e6:.1f} MB"
    return _filled((folder / "page.html").read_text("utf-8"), parts)


def _filled(template: str, parts: dict[str, str]) -> str:
    """The template with each {{name}} filled in, once: what is filled in is not looked at again."""
    pieces = template.split("{{")
    out = [pieces[0]]
    for piece in pieces[1:]:
        name, rest = piece.split("}}", 1)
        out += [parts[name], rest]
    return "".join(out)
