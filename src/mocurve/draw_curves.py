"""One animation curve as a still picture: samples, the curve through the keys, keys and their tangents."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from . import hermite
from .errors import OptionError
from .formats._files import replacing
from .keyed import KeyedMotion
from .measure import side_by_side
from .motion import Clip

LARGER = 2  # drawn larger, then reduced
RATIO = 0.42  # height over width
PAPER, GRID, TEXT = "#ffffff", "#e4e8ed", "#46505c"
SAMPLES, CURVE, KEY, HANDLE = "#9aa5b1", "#1b497d", "#d1495b", "#e8a33d"


def curves(original: Clip, keyed: KeyedMotion, channel: str, path: str | PathLike[str], *, width: int = 1200) -> None:
    """Draw one channel, "LeftLeg.Xrotation", as a .png: grey samples, blue curve, red keys with their tangents.

    The tangents are drawn as Bézier handles, which end at a third of the way to the next key. width is in pixels.
    OptionError for another extension; UnknownName for a channel that is not there; Mismatch where the skeletons differ.
    """
    path = Path(path)
    if path.suffix.lower() != ".png":
        raise OptionError(f"{path.name}: the extension of this picture is .png, not {path.suffix.lower()!r}")
    if not 200 <= width <= 8192:
        raise OptionError(f"width is from 200 to 8192 pixels, not {width}")
    column = original.skeleton.channel(channel)
    first, _ = side_by_side(original, keyed)
    if not first.frames:
        raise OptionError("the clip has no frames to draw")
    times = np.arange(first.frames) * first.frame_time
    image = _drawn(keyed, column, channel, times, first.values[:, column], width * LARGER)
    with replacing(path) as file:
        image.reduce(LARGER).save(file, "PNG", optimize=True)


def handles(keyed: KeyedMotion, column: int) -> np.ndarray:
    """(K-1, 4, 2) Bézier control points of a channel: seconds and values."""
    curve = keyed.curves[column]
    return hermite.to_bezier(curve.times, curve.values, curve.slopes, curve.in_slopes if curve.broken else None)


# -- in call order -----------------------------------------------------------------------------------------------------


def _drawn(
    keyed: KeyedMotion, column: int, channel: str, times: np.ndarray, samples: np.ndarray, width: int
) -> Image.Image:
    curve, points = keyed.curves[column], handles(keyed, column)
    fine = np.linspace(times[0], times[-1], max(2, min(width, 20 * len(times))))
    smooth = curve.at(fine)
    size, letter = (width, round(RATIO * width)), round(width / 58)
    box = (5 * letter, 2.6 * letter, width - 1.2 * letter, size[1] - 3.4 * letter)  # left, top, right, bottom
    shown = np.concatenate([samples, smooth])
    margin = max(0.08 * float(np.ptp(shown)), 1e-3)
    axes = Axes(box, (float(times[0]), float(times[-1])), (float(shown.min()) - margin, float(shown.max()) + margin))
    image = Image.new("RGB", size, PAPER)
    unit = "degrees" if keyed.skeleton.rotation_channels[column] else "length units"
    frame(ImageDraw.Draw(image), axes, letter, f"{channel} ({unit})")
    thick = max(1, width // 1200)
    left, top, right, bottom = (round(e + s * 7 * thick) for e, s in zip(box, (-1, -1, 1, 1), strict=True))
    bare, draw = image.copy(), ImageDraw.Draw(image)
    draw.line(axes(times, samples), SAMPLES, 3 * thick, joint="curve")
    draw.line(axes(fine, smooth), CURVE, 2 * thick, joint="curve")
    for start, leaving, arriving, end in points:
        draw.line(axes(*np.array([start, leaving]).T), HANDLE, 2 * thick)
        draw.line(axes(*np.array([arriving, end]).T), HANDLE, 2 * thick)
    for at in axes(*points[:, 1:3].reshape(-1, 2).T):
        draw.circle(at, 3 * thick, HANDLE)
    for at in axes(curve.times, curve.values):
        draw.circle(at, 6 * thick, KEY, PAPER, thick)
    bare.paste(image.crop((left, top, right, bottom)), (left, top))  # without handles that leave the box
    entries = [
        (SAMPLES, f"{len(samples)} samples"),
        (CURVE, "curve"),
        (KEY, f"{len(curve)} keys"),
        (HANDLE, "tangents"),
    ]
    legend(ImageDraw.Draw(bare), entries, box, letter)
    return bare


class Axes:
    """From (seconds, value) to pixels inside a box."""

    def __init__(
        self,
        box: tuple[float, float, float, float],
        span: tuple[float, float],
        values: tuple[float, float],
    ):
        self.box, self.span, self.values = box, (span[0], max(span[1], span[0] + 1e-9)), values

    def __call__(self, times: np.ndarray, values: np.ndarray) -> list[tuple[float, float]]:
        left, top, right, bottom = self.box
        across = left + (np.asarray(times) - self.span[0]) / (self.span[1] - self.span[0]) * (right - left)
        down = bottom - (np.asarray(values) - self.values[0]) / (self.values[1] - self.values[0]) * (bottom - top)
        return list(zip(across.tolist(), down.tolist(), strict=True))


def frame(draw: ImageDraw.ImageDraw, axes: Axes, letter: int, title: str) -> None:
    """Grid, numbers and a title; `letter` is the height of the letters in pixels."""
    font = ImageFont.load_default(letter)
    left, top, right, bottom = axes.box
    for time in ticks(*axes.span, 10):
        ((across, _),) = axes(np.array([time]), np.array([axes.values[0]]))
        draw.line([(across, top), (across, bottom)], GRID, 2)
        draw.text((across, bottom + 0.4 * letter), f"{time:g}", TEXT, font, anchor="mt")
    for value in ticks(*axes.values, 6):
        ((_, down),) = axes(np.array([axes.span[0]]), np.array([value]))
        draw.line([(left, down), (right, down)], GRID, 2)
        draw.text((left - 0.5 * letter, down), f"{value:g}", TEXT, font, anchor="rm")
    draw.text(((left + right) / 2, bottom + 1.8 * letter), "seconds", TEXT, font, anchor="mt")
    draw.text((left, top - 0.8 * letter), title, TEXT, ImageFont.load_default(round(1.15 * letter)), anchor="ls")


def ticks(low: float, high: float, about: int) -> np.ndarray:
    """Round numbers within the span, about so many."""
    exact = (high - low) / about
    power = 10.0 ** np.floor(np.log10(exact))
    step = power * min((s for s in (1, 2, 5, 10) if s * power >= exact), default=10)
    ticks = np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1) * step
    return np.round(ticks, max(0, -int(np.floor(np.log10(step))))) + 0.0  # no -0


def legend(
    draw: ImageDraw.ImageDraw,
    entries: list[tuple[str, str]],
    box: tuple[float, float, float, float],
    letter: int,
) -> None:
    """Colours and what they stand for, above the right corner of the box."""
    font = ImageFont.load_default(letter)
    across = box[2]
    for colour, text in reversed(entries):
        across -= draw.textlength(text, font)
        draw.text((across, box[1] - 0.8 * letter), text, TEXT, font, anchor="ls")
        across -= 0.9 * letter
        draw.circle((across + 0.3 * letter, box[1] - 1.15 * letter), 0.3 * letter, colour)
        across -= letter
