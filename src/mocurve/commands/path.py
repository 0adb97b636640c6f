"""`mocurve path`: the path of a clip, as control points."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path as File
from typing import Annotated, Any

import numpy as np
from cyclopts import Parameter

from .. import draw_path
from ..edit._seams import centimetres
from ..errors import OptionError
from ..formats import read
from ..motion import Clip
from ..path import Path
from ..path_files import as_json, extension
from ._options import Html, Json, Source, Unit, check_outputs, tell, with_options_of
from ._terminal import told_when_compiling

Output = Annotated[File, Parameter(name=("--output", "-o"), help="Where the path goes: .csv, .json or .svg.")]
Picture = Annotated[File | None, Parameter(help="Draw paths and figures, from above and in four views: .png, or .gif.")]


@dataclass(frozen=True)
class Fitted:
    """A path and how well it is that of a clip; lengths in cm where the clip's unit is known, else in its units."""

    path: Path
    unit: str
    length: float
    rms: float
    largest: float

    def __str__(self) -> str:
        what = f"{len(self.path.points)} {'control ' if self.path.kind == 'spline' else ''}points"
        return (
            f"path: {self.length:.4g} {self.unit} long, {self.path.kind} of degree {self.path.degree}, {what}\n"
            f"root: {self.rms:.3g} {self.unit} away from it, root mean square; {self.largest:.3g} at most"
        )

    def to_json(self) -> dict[str, Any]:
        """The same as plain numbers, texts and lists; points in the clip's length unit."""
        told = {"unit": self.unit, "length": self.length, "rms": self.rms, "largest": self.largest}
        return {**told, **as_json(self.path)}


@with_options_of(Path.of)
@told_when_compiling()
def path(
    file: Source,
    /,
    *,
    output: Output,
    unit: Unit = None,
    html: Html = None,
    picture: Picture = None,
    json: Json = False,
    **options: Any,
) -> None:
    """The path of a clip over the ground, as control points to edit.

    The curve nearest to where the body goes. Control points are written in the
    clip's own length unit, to be moved in any editor and given to mocurve follow.

    For example:
      mocurve path jump.bvh -o path.csv --points 6
      mocurve path jump.bvh -o path.svg --picture path.png
      mocurve path jump.bvh -o path.json --kind polynomial --degree 20 --json
    """
    check_outputs(file, output)
    check_pictures(file, html, picture)
    extension(output)  # refused before work is done
    clip = read(file, unit=unit)
    made = Path.of(clip, **options)
    found = fitted(made, clip)
    if not made.length > 0:
        warnings.warn("the clip goes nowhere: its path has no length, and nothing follows it", stacklevel=2)
    made.write(output)
    draw(clip, made, html, picture, str(found))
    tell(found, json, output, html, picture)


def check_pictures(source: File, html: File | None, picture: File | None) -> None:
    """Refused before work is done: a picture that is none, or over the clip."""
    check_outputs(source, html, picture)
    for target, what, kinds in ((html, "page", (".html",)), (picture, "picture", (".png", ".gif"))):
        if target is not None and target.suffix.lower() not in kinds:
            raise OptionError(f"{target}: the extension of a {what} is {' or '.join(kinds)}, not {target.suffix!r}")


def fitted(made: Path, clip: Clip) -> Fitted:
    """How well a path is that of a clip."""
    length = centimetres(clip.sample())
    scale = length or 1.0
    away = scale * made.residuals(clip)
    told = "cm" if length else "units"
    return Fitted(made, told, scale * made.length, float(np.sqrt(np.mean(away**2))), float(away.max()))


def draw(
    clip: Clip,
    own: Path,
    html: File | None,
    picture: File | None,
    numbers: str,
    made: Clip | None = None,
    new: Path | None = None,
) -> None:
    """The pictures that were asked for."""
    for target in (html, picture):
        if target is not None:
            draw_path.save(target, clip, own, made, new, numbers=numbers)
