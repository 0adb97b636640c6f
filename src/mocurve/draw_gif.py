"""Moving pictures: when each is shown, and the .gif that they become."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from PIL import Image

from .formats._files import replacing
from .progress import advance

MOST_FPS = 50  # players take a delay under 2/100 s for 10/100 s
MOST_PICTURES = 1000
COLOURS = 128


def write(path: Path, times: np.ndarray, delays: list[int], picture: Callable[[float], Image.Image]) -> None:
    """Pictures of these seconds, each shown for so many milliseconds, as one .gif."""
    palette = picture(float(times[-1])).quantize(COLOURS)  # the last one has all colours

    def pictures() -> Iterator[Image.Image]:
        for done, time in enumerate(times, start=1):
            advance("drawing", done, len(times))
            yield picture(float(time)).quantize(palette=palette, dither=Image.Dither.NONE)

    drawn = pictures()
    with replacing(path) as file:
        next(drawn).save(file, "GIF", save_all=True, append_images=drawn, duration=delays, loop=0)


def timing(duration: float, frame_time: float, fps: float) -> tuple[np.ndarray, list[int]]:
    """When each picture is shown (seconds), for how many milliseconds; a GIF counts in 1/100 s: rounding is spread."""
    wanted = min(fps, 1 / frame_time)
    count = int(duration * wanted + 1e-6) + 1
    if count > MOST_PICTURES:
        wanted *= (MOST_PICTURES - 1) / (count - 1)
        count = MOST_PICTURES
        warnings.warn(
            f"a long clip: {wanted:.3g} pictures a second, so that there are no more than {count}", stacklevel=4
        )
    times = np.arange(count + 1) / wanted
    delays = np.diff((times * 100).round().astype(int)) * 10
    return times[:-1], [int(delay) for delay in delays]
