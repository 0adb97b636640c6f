"""Paths seen from above and by four cameras: the clip's own in red, a new one in green, control points, and how far the
root is from them.

x goes to the right and z down, as on the ground seen by somebody who looks along -y with -z ahead.
"""

from __future__ import annotations

import html
import io
from base64 import b64encode
from os import PathLike
from pathlib import Path as File

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from . import draw_views
from .draw_curves import GRID, LARGER, PAPER, TEXT, Axes, frame, legend, ticks
from .errors import OptionError
from .formats._files import replacing
from .info import unit_of
from .motion import Clip
from .path import Path
from .path_fit import lead, roots

(OWN, OWN_TRACK), (NEW, NEW_TRACK), POINT = draw_views.OWN, draw_views.NEW, draw_views.POINT
SHAPES = (0.3, 1.1)  # height over width of the view from above
GRAPH = 0.22  # height over width of the graph below it
FINE = 600  # places along a path


def save(
    file: str | PathLike[str],
    clip: Clip,
    own: Path,
    made: Clip | None = None,
    new: Path | None = None,
    *,
    numbers: str = "",
    width: int = 1000,
) -> None:
    """A picture (.png), a page with it (.html) or moving figures (.gif) of a clip's path and, if given, of another clip
    on a new path.

    clip, own: the clip and the path that it is on. made, new: what became of it, and its path.
    numbers:   text below the picture on a page. width: in pixels.
    """
    file = File(file)
    kind = file.suffix.lower()
    if kind not in (".png", ".html", ".gif"):
        raise OptionError(f"{file.name}: the extension of this picture is .png, .html or .gif, not {kind!r}")
    if not 200 <= width <= 4096:
        raise OptionError(f"width is from 200 to 4096 pixels, not {width}")
    if kind == ".gif":
        draw_views.write_gif(file, draw_views.laid(clip, own, made, new), width)
        return
    image = picture(clip, own, made, new, width=width)
    raw = io.BytesIO()
    image.save(raw, "PNG", optimize=True)
    data = raw.getvalue() if kind == ".png" else page(raw.getvalue(), file.stem, numbers).encode(errors="replace")
    with replacing(file) as target:
        target.write(data)


def page(png: bytes, title: str, numbers: str) -> str:
    """A picture and text as a page complete in itself."""
    return (
        f'<!doctype html>\n<html lang="en"><meta charset="utf-8"><title>{html.escape(title)}</title>\n'
        "<style>body{font:15px/1.5 system-ui,sans-serif;margin:2em auto;max-width:1040px;color:#222}"
        "img{width:100%}pre{font:inherit;white-space:pre-wrap}</style>\n"
        f"<h1>{html.escape(title)}</h1>\n"
        f'<img alt="paths seen from above" src="data:image/png;base64,{b64encode(png).decode()}">\n'
        f"<pre>{html.escape(numbers)}</pre></html>\n"
    )


def picture(clip: Clip, own: Path, made: Clip | None, new: Path | None, *, width: int = 1000) -> Image.Image:
    """The picture that `save` writes: from above, four views of the figures, and how far the root is from its path."""
    tracks = [(_track(clip), OWN_TRACK)] + ([(_track(made), NEW_TRACK)] if made is not None else [])
    paths = [(own, OWN)] + ([(new, NEW)] if new is not None else [])
    size, letter = width * LARGER, round(width * LARGER / 62)
    shown = np.concatenate([track for track, _ in tracks] + [path.points[:, [0, -1]] for path, _ in paths])
    top = _from_above(shown, tracks, paths, size, letter)
    graph = _graph(clip, own, size, letter)
    views = draw_views.sheet(draw_views.laid(clip, own, made, new), width)
    sheet = Image.new("RGB", (width, (top.size[1] + graph.size[1]) // LARGER + views.size[1]), PAPER)
    sheet.paste(top.reduce(LARGER), (0, 0))
    sheet.paste(views, (0, top.size[1] // LARGER))
    sheet.paste(graph.reduce(LARGER), (0, top.size[1] // LARGER + views.size[1]))
    return sheet


# -- in call order ---------------------------------------------------------------------------------


def _track(clip: Clip) -> np.ndarray:
    motion = clip.sample()
    return roots(motion)[lead(motion) :, [0, 2]]


def _from_above(
    shown: np.ndarray, tracks: list[tuple[np.ndarray, str]], paths: list[tuple[Path, str]], size: int, letter: int
) -> Image.Image:
    """Tracks, curves and control points to scale, on a grid."""
    low, high = shown.min(axis=0), shown.max(axis=0)
    extent = np.maximum(high - low, max(0.1 * float((high - low).max()), 1e-6)) * 1.12
    left, up, edge = 5 * letter, 2.6 * letter, 1.2 * letter
    inner = size - left - edge
    tall = inner * float(np.clip(extent[1] / extent[0], *SHAPES))
    scale = min(inner / extent[0], tall / extent[1])
    half = 0.5 * np.array([inner, tall]) / scale
    middle = 0.5 * (low + high)
    spans = [(float(middle[a] - half[a]), float(middle[a] + half[a])) for a in range(2)]
    axes = Axes((left, up, size - edge, up + tall), spans[0], spans[1][::-1])  # z grows downwards
    image = Image.new("RGB", (size, round(up + tall + 3.4 * letter)), PAPER)
    draw = ImageDraw.Draw(image)
    _grid(draw, axes, letter)
    thick = max(2, size // 700)
    for track, colour in tracks:
        draw.line(axes(*track.T), colour, thick, joint="curve")
    for path, colour in paths:
        places = path.place(np.linspace(0.0, 1.0, FINE))[:, [0, -1]]
        draw.line(axes(*places.T), colour, 2 * thick, joint="curve")
    last, _ = paths[-1]
    points = last.points[:, [0, -1]]
    draw.line(axes(*points.T), POINT, max(1, thick // 2))
    for at in axes(*points.T):
        draw.circle(at, 2.6 * thick, POINT, PAPER, max(1, thick // 2))
    for path, colour in paths:
        (start,) = axes(*path.place(np.zeros(1))[:, [0, -1]].T)
        draw.circle(start, 4.5 * thick, None, colour, thick)
    told = [(OWN_TRACK, "root"), (OWN, "own path")]
    if len(paths) > 1:
        told += [(NEW_TRACK, "root now"), (NEW, "new path")]
    legend(draw, [*told, (POINT, f"{len(points)} control points")], axes.box, letter)
    return image


def _grid(draw: ImageDraw.ImageDraw, axes: Axes, letter: int) -> None:
    font = ImageFont.load_default(letter)
    left, top, right, bottom = axes.box
    z = sorted(axes.values)
    step = ticks(*axes.span, 8)
    for x in step:
        ((across, _),) = axes(np.array([x]), np.array([z[0]]))
        draw.line([(across, top), (across, bottom)], GRID, 2)
        draw.text((across, bottom + 0.4 * letter), f"{x:g}", TEXT, font, anchor="mt")
    wide = float(step[1] - step[0]) if len(step) > 1 else z[1] - z[0]
    for value in np.arange(np.ceil(z[0] / wide), np.floor(z[1] / wide) + 1) * wide + 0.0:
        ((_, down),) = axes(np.array([axes.span[0]]), np.array([value]))
        draw.line([(left, down), (right, down)], GRID, 2)
        draw.text((left - 0.5 * letter, down), f"{value:g}", TEXT, font, anchor="rm")
    draw.text(((left + right) / 2, bottom + 1.8 * letter), "x, length units; z downwards", TEXT, font, anchor="mt")


def _graph(clip: Clip, own: Path, size: int, letter: int) -> Image.Image:
    """How far the root is from the clip's own path, over time."""
    motion = clip.sample()
    away = own.residuals(motion)
    try:
        away, unit = away * 100.0 * unit_of(motion).metres, "cm"
    except OptionError:
        unit = "length units"
    times = np.arange(len(away)) * motion.frame_time
    image = Image.new("RGB", (size, round(GRAPH * size)), PAPER)
    draw = ImageDraw.Draw(image)
    box = (5 * letter, 2.0 * letter, size - 1.2 * letter, image.size[1] - 3.4 * letter)
    axes = Axes(box, (0.0, float(times[-1])), (0.0, max(1.1 * float(away.max()), 1e-6)))
    frame(draw, axes, letter, f"root away from its own path ({unit})")
    draw.line(axes(times, away), OWN, max(2, size // 900), joint="curve")
    return image
