"""The scene of a picture: a parallel camera, the ground, and figures of bones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from .skeleton import Skeleton

TURN_AND_TILT = {  # degrees
    "front": (0.0, 8.0),
    "side": (90.0, 8.0),
    "top": (0.0, 90.0),
    "three-quarter": (35.0, 20.0),
    "behind": (215.0, 20.0),
}
PAPER, GRID, TEXT, TRAIL = "#ffffff", "#cfd7e0", "#46505c", "#e8a33d"
BONE = 0.016  # thickness over body height


@dataclass(frozen=True)
class Figure:
    """A clip as places (F, J, 3) with Y up; colours of its near and far bones; `thick` times the usual width."""

    skeleton: Skeleton
    places: np.ndarray
    near: tuple[int, int, int]
    far: tuple[int, int, int]
    name: str
    thick: float = 1.0


@dataclass(frozen=True)
class Ground:
    """Where the figures stand: floor height, length of a grid square, and the body's height; length units."""

    floor: float
    square: float
    body: float


@dataclass(frozen=True)
class Camera:
    """Parallel projection: rows of axes (3, 3) point right, up and to the viewer; scale is pixels a length unit."""

    axes: np.ndarray
    scale: float
    centre: np.ndarray  # (2,) right and up of the picture's middle, length units
    size: tuple[int, int]  # pixels

    def __call__(self, places: np.ndarray) -> np.ndarray:
        """(..., 3) -> (..., 2) pixels, rightwards and downwards."""
        seen = (places @ self.axes[:2].T - self.centre) * self.scale
        return seen * (1, -1) + np.array(self.size) / 2

    def moved(self, by: np.ndarray) -> Camera:
        """The same camera, gone along by (3,) length units."""
        return Camera(self.axes, self.scale, self.centre + self.axes[:2] @ by, self.size)


def camera(places: np.ndarray, view: str, width: int, shape: tuple[float, float]) -> Camera:
    """The camera that holds all places (..., 3); height over width of its picture lies within `shape`."""
    turn, tilt = np.radians(TURN_AND_TILT[view])
    right = np.array([np.cos(turn), 0.0, -np.sin(turn)])
    towards = np.array([np.sin(turn) * np.cos(tilt), np.sin(tilt), np.cos(turn) * np.cos(tilt)])
    axes = np.stack([right, np.cross(towards, right), towards])
    seen = places.reshape(-1, 3) @ axes[:2].T
    low, high = seen.min(axis=0), seen.max(axis=0)
    extent = np.maximum(high - low, max(1e-9, 0.05 * float((high - low).max()))) * 1.14
    size = (width, max(1, round(width * float(np.clip(extent[1] / extent[0], *shape)))))
    return Camera(axes, float((size / extent).min()), (low + high) / 2, size)


def y_up(places: np.ndarray) -> np.ndarray:
    """Places (..., 3) with Z up, turned so that Y is up."""
    return places[..., [0, 2, 1]] * (1, 1, -1)


def ground(figures: list[Figure]) -> Ground:
    """The floor under the lowest place of the clip, in squares of about a quarter of the body."""
    heights = [np.ptp(figure.places[..., 1], axis=1).mean() for figure in figures]
    body = float(max(*heights, 1e-6, 0.1 * max(np.ptp(f.places, axis=1).max() for f in figures)))
    exact = body / 3
    power = 10.0 ** np.floor(np.log10(exact))
    square = power * max(step for step in (1, 2, 5) if step * power <= exact)
    return Ground(float(min(figure.places[..., 1].min() for figure in figures)), square, body)


def empty(view: Camera, floor: Ground, around: np.ndarray) -> Image.Image:
    """A picture of the bare ground under and around the places (..., 3)."""
    image = Image.new("RGB", view.size, PAPER)
    draw = ImageDraw.Draw(image)
    flat = around.reshape(-1, 3)[:, [0, 2]]
    low = np.floor((flat.min(axis=0) - 0.25 * floor.body) / floor.square)
    high = np.ceil((flat.max(axis=0) + 0.25 * floor.body) / floor.square)
    thin = max(1, round(view.size[0] / 900))
    for axis in (0, 1):
        for line in np.arange(low[axis], high[axis] + 1):
            ends = np.array([[line, low[1 - axis]], [line, high[1 - axis]]])[:, :: 1 - 2 * axis] * floor.square
            pixels = view(np.insert(ends, 1, floor.floor, axis=1))
            draw.line([tuple(p) for p in pixels], GRID, thin)
    return image


def draw_trail(image: Image.Image, view: Camera, figure: Figure, floor: Ground, frame: int) -> None:
    """The way of the root over the ground, up to a frame."""
    way = figure.places[: frame + 1, 0].copy()
    way[:, 1] = floor.floor
    pixels = view(way)
    thick = max(1, round(0.5 * BONE * floor.body * view.scale))
    ImageDraw.Draw(image).line([tuple(p) for p in pixels], TRAIL, thick, joint="curve")


def draw_figure(image: Image.Image, view: Camera, figure: Figure, floor: Ground, frame: int) -> None:
    """Bones from far to near, far ones paler, with a dot at every joint."""
    draw = ImageDraw.Draw(image)
    places = figure.places[frame]
    pixels, depth = view(places), places @ view.axes[2]
    thick = max(2.0, BONE * figure.thick * floor.body * view.scale)
    span = max(float(np.ptp(depth)), 1e-9)
    parents = figure.skeleton.parents
    order = sorted(range(len(parents)), key=lambda j: depth[j] + depth[max(parents[j], 0)])
    for joint in order:
        nearness = (depth[joint] - depth.min()) / span if span > 0.02 * floor.body else 1.0
        colour = _between(figure.far, figure.near, nearness)
        over = int(parents[joint])
        if over >= 0:
            draw.line([tuple(pixels[over]), tuple(pixels[joint])], colour, round(thick))
        dot = thick * (0.5 if figure.skeleton.end_sites[joint] else 0.8)
        draw.circle(tuple(pixels[joint]), dot, colour)


def label(image: Image.Image, figures: list[Figure], time: float, size: int, after: str = "") -> None:
    """The time below on the left and what comes after it, above it the figures' names in their colours; letters of
    `size` pixels."""
    draw = ImageDraw.Draw(image)
    font = ImageFont.load_default(size)
    lines: list[tuple[str, str | tuple[int, int, int]]] = [(f.name, f.near) for f in figures if f.name]
    lines += [(f"{time:.2f} s{after}", TEXT)]
    for i, (text, colour) in enumerate(reversed(lines)):
        draw.text((0.7 * size, image.size[1] - (0.6 + 1.25 * i) * size), text, colour, font, anchor="ls")


def _between(a: tuple[int, int, int], b: tuple[int, int, int], part: float) -> tuple[int, int, int]:
    red, green, blue = (round(x + (y - x) * part) for x, y in zip(a, b, strict=True))
    return red, green, blue
