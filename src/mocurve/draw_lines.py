"""Numbers against numbers as a still picture: a line a name, both axes logarithmic."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from .draw_curves import GRID, LARGER, PAPER, TEXT, Axes, legend
from .errors import OptionError
from .formats._files import replacing

RATIO = 0.56  # height over width
COLOURS = ("#d1495b", "#1b497d", "#e8a33d", "#0c6e5c", "#7b5ea7", "#9aa5b1", "#3aa6b9", "#5c4033")


def lines(
    along: Sequence[float],
    named: Mapping[str, Sequence[float]],
    path: str | PathLike[str],
    *,
    titles: tuple[str, str],
    width: int = 1200,
) -> None:
    """Draw a .png: each of the named rows (N,) against `along` (N,), positive numbers; titles: of the axes along and
    up. width is in pixels. OptionError for another extension."""
    path = Path(path)
    if path.suffix.lower() != ".png":
        raise OptionError(f"{path.name}: the extension of this picture is .png, not {path.suffix.lower()!r}")
    image = _drawn(np.asarray(along, float), {n: np.asarray(row, float) for n, row in named.items()}, titles, width)
    with replacing(path) as file:
        image.reduce(LARGER).save(file, "PNG", optimize=True)


def _drawn(along: np.ndarray, named: dict[str, np.ndarray], titles: tuple[str, str], width: int) -> Image.Image:
    width *= LARGER
    size, letter = (width, round(RATIO * width)), round(width / 58)
    box = (5 * letter, 4.2 * letter, width - 1.5 * letter, size[1] - 3.6 * letter)  # left, top, right, bottom
    image = Image.new("RGB", size, PAPER)
    draw = ImageDraw.Draw(image)
    known = [row[row > 0] for row in named.values()]
    every = np.concatenate(known) if known else np.ones(1)
    every = every if every.size else np.ones(1)
    low, high = np.log10(every.min()) - 0.05, np.log10(every.max()) + 0.05
    axes = Axes(box, (np.log10(along[0]), np.log10(along[-1])), (low, max(high, low + 0.1)))
    _frame(draw, axes, along, letter, titles)
    thick = max(1, width // 500)
    for colour, row in zip(COLOURS, named.values(), strict=False):
        points = axes(np.log10(along), np.log10(np.maximum(row, 10.0**low)))
        draw.line(points, colour, thick, joint="curve")
        for at in points:
            draw.circle(at, 1.8 * thick, colour, PAPER, thick // 2)
    entries = list(zip(COLOURS, named, strict=False))
    legend(draw, entries, (box[0], box[1], box[2], box[3]), letter)
    return image


def _frame(draw: ImageDraw.ImageDraw, axes: Axes, along: np.ndarray, letter: int, titles: tuple[str, str]) -> None:
    font = ImageFont.load_default(letter)
    left, top, right, bottom = axes.box
    for number in along:
        ((across, _),) = axes(np.log10([number]), np.array([axes.values[0]]))
        draw.line([(across, top), (across, bottom)], GRID, 2)
        draw.text((across, bottom + 0.4 * letter), f"{number:g}", TEXT, font, anchor="mt")
    for power in range(int(np.floor(axes.values[0])), int(np.ceil(axes.values[1])) + 1):
        for step in (1, 2, 5):
            value = np.log10(step) + power
            if axes.values[0] <= value <= axes.values[1]:
                ((_, down),) = axes(np.array([axes.span[0]]), np.array([value]))
                draw.line([(left, down), (right, down)], GRID, 2)
                draw.text((left - 0.5 * letter, down), f"{step * 10.0**power:g}", TEXT, font, anchor="rm")
    draw.text(((left + right) / 2, bottom + 2.0 * letter), titles[0], TEXT, font, anchor="mt")
    draw.text((left, top - 2.6 * letter), titles[1], TEXT, ImageFont.load_default(round(1.15 * letter)), anchor="ls")
