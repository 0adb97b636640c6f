"""A clip on its path and what became of it on another one, seen by cameras: figures, both paths, control points, and
blocks that show where on its path each figure is.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path as File

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from . import draw_gif, kinematics
from . import draw_scene as scene
from .errors import OptionError
from .motion import Clip, Motion
from .path import Path
from .path_fit import gone, lead

VIEWS = ("three-quarter", "behind", "front", "side")
RATIO = 0.62  # height over width of a view
OWN, NEW, POINT = ("#c0392b", "#e8a79f"), ("#1e8449", "#8fcba6"), "#1b497d"
FIGURES = (((192, 57, 43), (236, 190, 184)), ((30, 132, 73), (176, 218, 193)))  # near and far bones: own, new
POSES = 9  # of the longer one
FINE = 300  # places along a path
LARGER, LARGER_GIF = 2, 2  # drawn larger, then reduced
GIF_FPS = 25.0


@dataclass(frozen=True)
class Laid:
    """A figure, its path (K, 3) and control points (N, 3), and where on the path it is at every frame (F, 3)."""

    figure: scene.Figure
    frame_time: float
    path: np.ndarray
    points: np.ndarray
    tracker: np.ndarray
    colour: str

    def frame(self, time: float) -> int:
        """The frame of a time; the last one after it."""
        return min(round(time / self.frame_time), len(self.tracker) - 1)


def laid(clip: Clip, own: Path, made: Clip | None = None, new: Path | None = None) -> list[Laid]:
    """What is drawn of a clip on its own path, in red, and of another clip on a new one, in green."""
    motion = clip.sample()
    motion = motion[lead(motion) :]
    places = kinematics.world(motion)
    lowest = float(places[..., 1].min())
    raised = lowest if own.points.shape[1] == 2 else 0.0  # heights count from the floor, or are those of the root
    found = [_laid(motion, places, own, own.place(gone(motion)), (lowest, raised), 0)]
    if made is not None and new is not None:
        now = made.sample()
        ahead = lead(now)
        there = kinematics.world(now[ahead:])
        found.append(_laid(now[ahead:], there, new, _tracked(made, now, new)[ahead:], (lowest, raised), 1))
    return found


def view(
    figures: list[Laid], name: str, width: int, *, title: str = "", poses: int = POSES, ratio: float = RATIO
) -> Image.Image:
    """One view as a still: poses evenly in time, so that whoever is faster has them further apart."""
    times = np.linspace(0.0, max(one.frame_time * (len(one.tracker) - 1) for one in figures), poses)
    stage = _Stage(figures, name, width * LARGER, ratio, title)
    return stage.shown([np.unique([one.frame(t) for t in times]).tolist() for one in figures]).reduce(LARGER)


def sheet(figures: list[Laid], width: int) -> Image.Image:
    """Four views as a still, two beside two."""
    return beside([view(figures, name, width // 2) for name in VIEWS], 2)


def write_gif(file: File, figures: list[Laid], width: int) -> None:
    """From above and four views, the figures moving along their paths."""
    stages = [_Stage(figures, "top", width * LARGER_GIF, RATIO)]
    stages += [_Stage(figures, name, width // 2 * LARGER_GIF, RATIO) for name in VIEWS]
    longest = max(figures, key=lambda one: one.frame_time * len(one.tracker))
    duration = longest.frame_time * (len(longest.tracker) - 1)
    times, delays = draw_gif.timing(duration, longest.frame_time, GIF_FPS)

    def picture(time: float) -> Image.Image:
        top, *rest = (s.shown([[one.frame(time)] for one in figures]).reduce(LARGER_GIF) for s in stages)
        return beside([top, beside(rest, 2)], 1)

    draw_gif.write(file, times, delays, picture)


def beside(images: list[Image.Image], across: int) -> Image.Image:
    """Pictures of one size in rows."""
    wide, tall = images[0].size[0], [image.size[1] for image in images[::across]]
    made = Image.new("RGB", (wide * across, sum(tall)), scene.PAPER)
    for place, image in enumerate(images):
        made.paste(image, (place % across * wide, sum(tall[: place // across])))
    return made


# -- in call order ---------------------------------------------------------------------------------


def _laid(
    motion: Motion, places: np.ndarray, path: Path, tracker: np.ndarray, floor: tuple[float, float], which: int
) -> Laid:
    if not np.isfinite(places).all():
        raise OptionError("a clip has values that are not finite numbers; they cannot be drawn")
    figure = scene.Figure(motion.skeleton, places, *FIGURES[which], ("original", "new")[which])
    lowest, raised = floor

    def standing(there: np.ndarray) -> np.ndarray:
        return np.insert(there, 1, lowest, axis=1) if there.shape[1] == 2 else there + np.array([0.0, raised, 0.0])

    curve = standing(path.place(np.linspace(0.0, 1.0, FINE)))
    return Laid(figure, motion.frame_time, curve, standing(path.points), standing(tracker), (OWN, NEW)[which][0])


def _tracked(made: Clip, now: Motion, path: Path) -> np.ndarray:
    """Where (F, 2 or 3) along its path a clip is: as the step that laid it there tells, or as far as it has gone."""
    step = made.history[-1] if made.history else {}
    distance = step.get("table", {}).get("distance", [])
    if len(distance) != now.frames:
        distance = Path.of(now).table().distance(gone(now))
    return path.at(np.array(distance))[0]


class _Stage:
    """One camera with all that stands still in it, drawn once."""

    def __init__(self, figures: list[Laid], name: str, width: int, ratio: float, title: str = ""):
        self.figures, self.floor = figures, scene.ground([figures[0].figure])
        around = np.concatenate(
            [part.reshape(-1, 3) for one in figures for part in (one.figure.places, one.path, one.points)]
        )
        under = around * (1, 0, 1) + (0, self.floor.floor, 0)
        self.camera = scene.camera(np.concatenate([around, under]), name, width, (ratio, ratio))
        self.bare = scene.empty(self.camera, self.floor, around)
        self.thick = max(2, width // 300)
        draw = ImageDraw.Draw(self.bare)
        for one in figures:
            draw.line(self._pixels(one.path), one.colour, self.thick, joint="curve")
        points = figures[-1].points
        draw.line(self._pixels(points), POINT, max(1, self.thick // 3))
        for at in self._pixels(points):
            draw.circle(at, 1.3 * self.thick, POINT)
        font = ImageFont.load_default(max(10, width // 36))
        draw.text((2 * self.thick, 2 * self.thick), title or name, scene.TEXT, font)

    def shown(self, frames: list[list[int]]) -> Image.Image:
        """The figures at frames, a list for each of them."""
        image = self.bare.copy()
        draw = ImageDraw.Draw(image)
        for one, some in zip(self.figures, frames, strict=True):
            for x, y in self._pixels(one.tracker[some]):
                side = 1.6 * self.thick
                draw.rectangle((x - side, y - side, x + side, y + side), one.colour)
            for frame in some:
                scene.draw_figure(image, self.camera, one.figure, self.floor, frame)
        return image

    def _pixels(self, places: np.ndarray) -> list[tuple[float, float]]:
        return [(float(x), float(y)) for x, y in self.camera(places)]
