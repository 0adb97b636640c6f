"""`mocurve follow`: a clip laid along a path."""

from __future__ import annotations

from pathlib import Path as File
from typing import Annotated, Any

from cyclopts import Parameter

from ..edit import follow as following
from ..formats import read
from ..path import Path
from ._edits import Edited, Lossless, Output, check_files, finish
from ._options import Html, Json, Profile, Source, Unit, with_options_of
from ._terminal import told_when_compiling
from .path import Picture, check_pictures, draw

Along = Annotated[File, Parameter(name="--path", help="The path: .csv, .json or .svg, in the clip's length unit.")]
Of = Annotated[
    File | None, Parameter(help="The path that the clip is on, where the new one is not an edit of it: a file too.")
]


@with_options_of(following.follow)
@told_when_compiling()
def follow(
    file: Source,
    /,
    *,
    path: Along,
    output: Output,
    of: Of = None,
    unit: Unit = None,
    html: Html = None,
    picture: Picture = None,
    profile: Profile = None,
    lossless: Lossless = False,
    json: Json = False,
    **options: Any,
) -> None:
    """A clip laid along a path: what it does relative to its own path, it does relative to the new one.

    The path comes from mocurve path, with control points moved, or from any
    drawing. Each frame stays as far along the path as it was, so that the body
    keeps its speed; the rest is --mode and --at-end.

    For example:
      mocurve path jump.bvh -o path.csv
      mocurve follow jump.bvh --path path.csv -o same.bvh
      mocurve follow walk.bvh --path tour.svg -o tour.bvh --at-end cycle
      mocurve follow walk.bvh --path moved.csv -o moved.bvh --mode span
    """
    check_files(output, file, path)
    check_pictures(file, html, picture)
    clip = read(file, unit=unit)
    new, own = Path.read(path), None if of is None else Path.read(of)
    made = following.follow(clip, new, of=own, **options)
    measured = following.Following(**made.history[-1]["measured"])
    draw(clip, own or following.own_path(clip, new), html, picture, str(measured), made, new)
    finish(Edited(made, sentences=(str(measured),)), output, profile, lossless, json, html, picture)
