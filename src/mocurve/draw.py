"""Stick figures as pictures: one pose or a sheet of poses (.png), or the motion playing (.gif).

The camera is parallel, stands still and holds the whole clip; on a sheet it goes along with the figure. Pictures are
drawn larger and then reduced, which smooths their edges.
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Literal, get_args

import numpy as np
from PIL import Image

from . import draw_gif, kinematics
from . import draw_scene as scene
from .draw_curves import curves
from .draw_lines import lines
from .errors import OptionError
from .formats._files import replacing
from .info import z_is_up
from .keyed import KeyedMotion
from .motion import Clip
from .progress import advance

__all__ = ["curves", "lines", "render", "sheet"]

View = Literal["front", "side", "top", "three-quarter", "behind"]

LARGER = 3  # a still is drawn this much larger, a moving picture:
LARGER_GIF = 2
SHEET = (4, 2)  # poses across and down
ACROSS = 6  # of a sheet with more than 8, at most
MOST_ON_SHEET = 600
MOST_POSES = 200  # in one picture
ALONE = ((27, 73, 125), (140, 178, 219))  # near and far bones
FIRST = ((214, 102, 88), (240, 196, 190))  # drawn thicker, so that it shows as a rim where both agree
SECOND = ((12, 110, 92), (120, 190, 175))


def render(
    clip: Clip,
    path: str | PathLike[str],
    second: Clip | None = None,
    *,
    width: int = 640,
    view: View = "three-quarter",
    fps: float = 25.0,
    frame: int | None = None,
    poses: int | None = None,
) -> None:
    """Draw the moving figure: .png shows one pose, poses along the way or a sheet of them, .gif plays the clip.

    A second clip is drawn over the first, in green over red; it may have another skeleton or frame rate.

    width: of the picture, in pixels.
    view: front (looking against Z, or along Y where Z points up), side, top, three-quarter, or behind, its other side.
    fps: pictures a second of a .gif, at most 50; fewer where the clip has fewer frames or would take over 1000.
    frame: the one frame to show, counted from 0; .png only. Without it: a sheet of eight poses.
    poses: so many poses in one picture, each at its place on the way; .png only.

    OptionError for another extension, an unknown view, a frame that is not there or a clip without frames.

    >>> mc.render(walk, "walk.gif", mc.reduce(walk, tolerance="5mm"))
    """
    path = Path(path)
    kind = path.suffix.lower()
    if kind not in (".png", ".gif"):
        raise OptionError(f"{path.name}: the extension of a picture is .png or .gif, not {kind!r}")
    _check(clip, kind, width, view, fps, frame, poses)
    figures = _figures(clip, second)
    if kind == ".gif":
        _write_gif(figures, clip, path, width, view, fps)
        return
    if poses is not None:
        image = _along(figures, clip, width, view, poses)
    elif frame is not None:
        image = _pose(figures, clip, width, view, frame)
    else:  # poses evenly in time
        evenly = np.linspace(0, clip.frames - 1, SHEET[0] * SHEET[1]).round().astype(int)
        image = _sheet(figures, clip, width, view, np.unique(evenly), numbered=False)
    with replacing(path) as file:
        image.save(file, "PNG", optimize=True)


def sheet(
    clip: Clip, path: str | PathLike[str], frames: Sequence[int], *, width: int = 1200, view: View = "three-quarter"
) -> None:
    """A contact sheet, .png: the poses at these frames, each with its time and its frame, line after line.

    OptionError for another extension, an unknown view, a frame that is not there or a clip without frames.

    >>> mc.sheet(walk, "poses.png", mc.reduce(walk, keys=12).report.key_frames)
    """
    path = Path(path)
    if path.suffix.lower() != ".png":
        raise OptionError(f"{path.name}: the extension of a sheet is .png, not {path.suffix.lower()!r}")
    if not 1 <= len(frames) <= MOST_ON_SHEET:
        raise OptionError(f"a sheet shows 1 to {MOST_ON_SHEET} poses, not {len(frames)}")
    for frame in (min(frames), max(frames)):
        _check(clip, ".png", width, view, draw_gif.MOST_FPS, int(frame), None)
    image = _sheet(_figures(clip, None), clip, width, view, np.array(frames, np.int64), numbered=True)
    with replacing(path) as file:
        image.save(file, "PNG", optimize=True)


# -- in call order -----------------------------------------------------------------------------------------------------


def _check(clip: Clip, kind: str, width: int, view: str, fps: float, frame: int | None, poses: int | None) -> None:
    if view not in get_args(View):
        raise OptionError(f"view is one of {', '.join(get_args(View))}, not {view!r}")
    if not 64 <= width <= 8192:
        raise OptionError(f"width is from 64 to 8192 pixels, not {width}")
    if not clip.frames or not clip.skeleton.names:
        raise OptionError("the clip has no frames to draw")
    if kind == ".gif" and frame is not None:
        raise OptionError("one frame is drawn as .png; a .gif plays them all")
    if not 0 < fps <= draw_gif.MOST_FPS:
        raise OptionError(f"fps is over 0 and at most {draw_gif.MOST_FPS}, which is what a .gif can play; not {fps:g}")
    if poses is not None and (kind == ".gif" or frame is not None):
        raise OptionError("poses along the way are drawn as .png, and not together with a single frame")
    if poses is not None and not 1 <= poses <= MOST_POSES:
        raise OptionError(f"poses is from 1 to {MOST_POSES}, not {poses}")
    if frame is not None and not 0 <= frame < clip.frames:
        raise OptionError(f"there is no frame {frame}: the clip has frames 0 to {clip.frames - 1}")


def _figures(clip: Clip, second: Clip | None) -> list[scene.Figure]:
    places = [kinematics.world(clip.sample())]
    if second is not None and second.frames:
        others = kinematics.world(second.sample(None if second.frame_time == clip.frame_time else clip.frame_time))
        places += [others[np.minimum(np.arange(clip.frames), len(others) - 1)]]  # the shorter stays in its last pose
    if not all(np.isfinite(there).all() for there in places):
        raise OptionError("a clip has values that are not finite numbers; they cannot be drawn")
    if z_is_up(places[0]):
        places = [scene.y_up(there) for there in places]
    if second is None or len(places) < 2:
        return [scene.Figure(clip.skeleton, places[0], *ALONE, "")]
    names = ("original", "reduced") if isinstance(second, KeyedMotion) else ("first", "second")
    return [
        scene.Figure(clip.skeleton, places[0], *FIRST, names[0], thick=1.7),
        scene.Figure(second.skeleton, places[1], *SECOND, names[1]),
    ]


def _shown(figures: list[scene.Figure], frames: np.ndarray, floor: scene.Ground) -> np.ndarray:
    """(N, 3): every place at these frames and the ground under it."""
    places = np.concatenate([figure.places[frames].reshape(-1, 3) for figure in figures])
    return np.concatenate([places, places * (1, 0, 1) + (0, floor.floor, 0)])


def _pose(figures: list[scene.Figure], clip: Clip, width: int, view: str, frame: int) -> Image.Image:
    floor = scene.ground(figures)
    shown = _shown(figures, np.array([frame]), floor)
    camera = scene.camera(shown, view, width * LARGER, (0.6, 1.2))
    image = scene.empty(camera, floor, shown)
    for figure in figures:
        scene.draw_figure(image, camera, figure, floor, frame)
    scene.label(image, figures, frame * clip.frame_time, 16 * LARGER)
    return image.reduce(LARGER)


def _along(figures: list[scene.Figure], clip: Clip, width: int, view: str, poses: int) -> Image.Image:
    """Poses evenly in time, each where it is, and the way of the root over the ground."""
    frames = np.unique(np.linspace(0, clip.frames - 1, poses).round().astype(int))
    floor = scene.ground(figures)
    shown = _shown(figures, np.arange(clip.frames), floor)
    camera = scene.camera(shown, view, width * LARGER, (0.2, 1.2))
    image = scene.empty(camera, floor, shown)
    for figure in figures:
        scene.draw_trail(image, camera, figure, floor, clip.frames - 1)
    for frame in frames:
        for figure in figures:
            scene.draw_figure(image, camera, figure, floor, frame)
    scene.label(image, figures, clip.duration, 13 * LARGER)
    return image.reduce(LARGER)


def _sheet(
    figures: list[scene.Figure], clip: Clip, width: int, view: str, frames: np.ndarray, numbered: bool
) -> Image.Image:
    """Poses at the frames (K,); every panel has the same scale and follows the figure over the ground."""
    across = min(len(frames), SHEET[0] if len(frames) <= SHEET[0] * SHEET[1] else ACROSS)
    floor = scene.ground(figures)
    middle = figures[0].places.mean(axis=1) * (1, 0, 1)  # (F, 3)
    near = np.concatenate([_shown(figures, np.array([f]), floor) - middle[f] for f in frames])
    panel = width // across
    camera = scene.camera(near, view, panel * LARGER, (0.8, 1.6))
    high = camera.size[1] // LARGER
    sheet = Image.new("RGB", (width, -(-len(frames) // across) * high), scene.PAPER)
    for i, frame in enumerate(frames):
        here = camera.moved(middle[frame])
        image = scene.empty(here, floor, near + middle[frame])
        for figure in figures:
            scene.draw_figure(image, here, figure, floor, frame)
        which = f", frame {frame}" if numbered else ""
        scene.label(image, figures if i == 0 else [], frame * clip.frame_time, 13 * LARGER, which)
        sheet.paste(image.reduce(LARGER), (i % across * panel, i // across * high))
        advance("drawing", i + 1, len(frames))
    return sheet


def _write_gif(figures: list[scene.Figure], clip: Clip, path: Path, width: int, view: str, fps: float) -> None:
    times, delays = draw_gif.timing(clip.duration, clip.frame_time, fps)

    def frame_at(time: float) -> int:
        return min(round(time / clip.frame_time), clip.frames - 1)

    floor = scene.ground(figures)
    shown = _shown(figures, np.array([frame_at(time) for time in times]), floor)
    camera = scene.camera(shown, view, width * LARGER_GIF, (0.45, 1.2))
    bare = scene.empty(camera, floor, shown)

    def picture(time: float) -> Image.Image:
        image, frame = bare.copy(), frame_at(time)
        scene.draw_trail(image, camera, figures[0], floor, frame)
        for figure in figures:
            scene.draw_figure(image, camera, figure, floor, frame)
        scene.label(image, figures, frame * clip.frame_time, 15 * LARGER_GIF)
        return image.reduce(LARGER_GIF)

    draw_gif.write(path, times, delays, picture)
