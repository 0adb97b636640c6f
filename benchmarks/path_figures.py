"""The experiments of chapter 5 of the thesis on path editing, on captured walks: each as a picture and as numbers, in
its page.

    python path_figures.py [--pictures ../docs/pictures] [--check] [--only hills]

Speeds are those of the place on the path, frame by frame, where the clip itself goes faster than 20 cm/s: the mean, and
how far they are off from the clip's, root mean square of ratio - 1. "Away" is the root's distance from its place on the
path, root mean square. Slide: how fast balls of feet in contact go over the ground (`feet.skate`) in the clip; carried
along the path, as the thesis has it; held. Contacts let go; how far the hips go down.
"""

from __future__ import annotations

import re
import warnings
from argparse import ArgumentParser
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path as File
from typing import Any

import numpy as np
from clips import folder
from PIL import Image, ImageDraw, ImageFont

import mocurve as mc
from mocurve import draw_path, draw_views, rotation
from mocurve.data import example
from mocurve.draw_curves import Axes, frame
from mocurve.feet.legs import legs
from mocurve.feet.skate import skate
from mocurve.formats._files import replacing
from mocurve.kinematics import world
from mocurve.path_fit import gone, roots

PAGE = File(__file__).resolve().parents[1] / "docs" / "papers" / "path-editing.md"
CM = 5.6444  # a unit of these clips
METRE = 100.0 / CM
MOVES = 20.0  # cm/s
VIEW = "three-quarter"
DEGREES = (2, 4, 13, 45)
COLOURS = 64  # of a picture
HEAD = (
    "| | path cm | gone cm | frames | cycles | speed cm/s | speed off | away cm | slide: clip, carried, held cm/s "
    "| let go | hips down cm |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
)


@cache
def walk() -> mc.Motion:
    """Straight ahead; the T-pose in front left out."""
    return mc.read(folder() / "cmu" / "cmu_12_01_walk.bvh")[1:]


@cache
def wander() -> mc.Motion:
    """Ahead, backwards, sideways, and around in a loop."""
    return mc.read(folder() / "cmu" / "cmu_09_12.amc", skeleton=folder() / "cmu" / "cmu_09.asf")


# -- paths, metres ---------------------------------------------------------------------------------
def drawn(points: Any, degree: int = 3) -> mc.Path:
    return mc.Path(METRE * np.array(points, float), degree)


def around(radius: float, turns: float, sense: float = 1.0) -> np.ndarray:
    angle = np.linspace(0.0, 2.0 * np.pi * turns, round(24 * turns) + 1)
    return np.stack([sense * radius * (1.0 - np.cos(angle)), radius * np.sin(angle)], axis=1)


def weaving(length: float) -> mc.Path:
    ahead = np.linspace(0.0, length, 7)
    return drawn(np.stack([1.6 + 0.5 * np.sin(2.0 * np.pi * ahead / length), ahead], axis=1))


CIRCLE = drawn(around(1.2, 1.0) + np.array([1.2, 1.0]))
EIGHT = drawn(np.concatenate([around(1.1, 1.0), around(1.1, 1.0, -1.0)[1:]]) + np.array([3.2, 1.0]))
ZIGZAG = drawn([(1.2 + 0.9 * (k % 2), 1.5 * k) for k in range(7)], 2)
WALKABOUT = drawn([(2, 0), (2, 2), (3.5, 3.5), (5.5, 2.5), (5, 0.5), (6.5, -1), (8.5, 0), (8, 2.5), (6.5, 4.5)])
HILLS = drawn([(0, 0, 0), (0, 0, 0.5), (0, 0.55, 1.8), (0, 0.55, 2.1), (0, 0, 3.3), (0, 0, 3.9)])


# -- numbers ---------------------------------------------------------------------------------------
def followed(clip: mc.Motion, path: mc.Path, own: mc.Path, **options: Any) -> mc.Motion:
    """Laid along the path; what is warned of stands in the numbers."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return mc.follow(clip, path, of=None if options.get("at_end") == "cycle" else own, **options)


def row(name: str, clip: mc.Motion, own: mc.Path, made: mc.Motion, path: mc.Path) -> str:
    """One line of a table."""
    told = made.history[-1]
    measured, feet = told["measured"], told["measured"]["feet"] or {}
    frames, cycle, distance = (np.array(told["table"][part]) for part in ("frame", "cycle", "distance"))
    run = (np.diff(cycle) == 0) & (np.diff(frames) == 1)
    before = speeds(own.place(gone(clip)), clip)[np.minimum(frames[:-1].astype(int), clip.frames - 2)]
    place = path.at(distance)[0]
    now = speeds(place, made)
    some = run & (before > MOVES)
    off = np.sqrt(np.mean((now[some] / before[some] - 1.0) ** 2))
    away = CM * np.linalg.norm(roots(made)[:, [0, 2]] - place[:, [0, -1]], axis=1)
    slide = (
        ", ".join(f"{feet[part]:.2f}" for part in ("speed_own", "speed_slid", "speed")) if feet else "nothing to hold"
    )
    let = f"{feet['released']} of {feet['contacts']}" if feet else ""
    return (
        f"| {name} | {measured['length']:.0f} | {measured['travelled']:.0f} | {made.frames} | {measured['cycles']} | "
        f"{now[some].mean():.0f} | {100 * off:.1f} % | {np.sqrt(np.mean(away**2)):.1f} | {slide} | {let} | "
        f"{feet.get('drop', 0.0):.1f} |"
    )


def speeds(places: np.ndarray, clip: mc.Motion) -> np.ndarray:
    return CM * np.linalg.norm(np.diff(places, axis=0), axis=1) / clip.frame_time


# -- pictures --------------------------------------------------------------------------------------
def panel(
    clip: mc.Motion, own: mc.Path, made: mc.Motion | None, new: mc.Path | None, name: str, **asked: Any
) -> Image.Image:
    return draw_views.view(draw_views.laid(clip, own, made, new), name, asked.pop("width", 330), **asked)


def save(image: Image.Image, file: File) -> None:
    with replacing(file) as stream:
        image.quantize(COLOURS, dither=Image.Dither.NONE).save(stream, "PNG", optimize=True)


def graph(away: np.ndarray, frame_time: float, most: float, width: int) -> Image.Image:
    """Residuals over time, cm."""
    letter, size = 2 * width // 40, (2 * width, 2 * round(0.34 * width))
    image = Image.new("RGB", size, "white")
    draw = ImageDraw.Draw(image)
    axes = Axes(
        (4 * letter, 2 * letter, size[0] - letter, size[1] - 3.4 * letter), (0.0, len(away) * frame_time), (0.0, most)
    )
    frame(draw, axes, letter, "root away from its path, cm")
    draw.line(axes(np.arange(len(away)) * frame_time, away), draw_views.OWN[0], 3, joint="curve")
    return image.reduce(2)


# -- the experiments -------------------------------------------------------------------------------
def residuals() -> tuple[str, Image.Image]:
    """Figures 3.1 and 3.2: a body that goes zig-zag along a straight path, which then turns aside."""
    clip = replace(followed(walk(), mc.Path(ZIGZAG.points[:4], 1), mc.Path.of(walk()), at_end="cycle"), history=())
    own = mc.Path.of(clip, points=2, degree=1)
    quarter = np.linspace(0.0, 0.5 * np.pi, 8)
    bend = np.stack([1.2 - 1.2 * np.cos(quarter), 0.6 + 1.2 * np.sin(quarter)], axis=1)
    path = drawn(np.concatenate([[(0.0, 0.0)], bend, np.linspace([1.2, 1.8], [3.8, 1.8], 8)[1:]]))
    lines, panels = [HEAD], [traced(clip, own, 330, ahead=True)]
    names = ["3.2 a: zig-zag, and its path", "3.2 b: absolute", "3.2 c: relative to the path"]
    for name, heading in zip(names[1:], ("kept", "tangent"), strict=True):
        made = followed(clip, path, own, heading=heading)
        lines.append(row(name, clip, own, made, path))
        panels.append(traced(made, path, 330, ahead=True))
    for name, image in zip(names, panels, strict=True):
        draw_title(image, name)
    return "\n".join(lines), draw_views.beside(panels, 3)


def arc_length() -> tuple[str, Image.Image]:
    """Figures 5.1 to 5.5."""
    own, far, near = mc.Path.of(walk()), weaving(6.0), weaving(2.4)
    lines, panels = [HEAD], [panel(walk(), own, None, None, VIEW, title="5.1 the walk and its path")]
    for name, path, options in (
        ("5.2 longer path, over time", far, {"mode": "time"}),
        ("5.3 shorter path, over time", near, {"mode": "time"}),
        ("5.4 longer path, arc length", far, {}),
        ("5.5 shorter path, arc length, reset", near, {"at_end": "reset"}),
        ("shorter path, arc length, stop", near, {"at_end": "stop"}),
    ):
        made = followed(walk(), path, own, **options)
        lines.append(row(name, walk(), own, made, path))
        panels.append(panel(walk(), own, made, path, VIEW, title=name))
    return "\n".join(lines), draw_views.beside(panels, 2)


def cycling() -> tuple[str, Image.Image]:
    """Figure 5.6: the seam of the thesis is that from the last frame to the first; ours by what is repeated."""
    own, far = mc.Path.of(walk()), weaving(12.0)
    made = followed(walk(), far, own, at_end="cycle")
    lines = [HEAD, row("5.6 a path of 12 m, cycled", walk(), own, made, far), "", *seams(made)]
    return "\n".join(lines), panel(walk(), own, made, far, VIEW, title="5.6 cycled", width=800, poses=17, ratio=0.45)


def seams(made: mc.Motion) -> list[str]:
    clip = walk()
    places = world(clip) * CM
    relative = places - roots(clip)[:, None] * CM * [1.0, 0.0, 1.0]
    whole = np.linalg.norm(relative[0] - relative[-1], axis=1).max()
    usual = np.linalg.norm(np.diff(relative, axis=0), axis=2).max()
    now = np.linalg.norm(np.diff(world(made) * CM, axis=0), axis=2).max(axis=1)
    at = np.flatnonzero(np.diff(made.history[-1]["table"]["cycle"]) > 0)
    ours = max(now[max(k - 1, 0) : k + 2].max() for k in at)
    return [
        "| the seam | largest step of a joint, cm | elsewhere in the clip, cm |",
        "| --- | --- | --- |",
        f"| the whole clip again, without blending | {whole:.1f} | {usual:.1f} |",
        f'| `at_end="cycle"` | {ours:.1f} | {CM * np.linalg.norm(np.diff(world(clip), axis=0), axis=2).max():.1f} |',
    ]


def degrees() -> tuple[str, Image.Image]:
    """Figures 5.7 to 5.11."""
    clip = wander()
    lines = [
        "| degree | path cm | away: root mean square, largest cm | over time instead: root mean square, largest cm |",
        "| --- | --- | --- | --- |",
    ]
    panels: list[Image.Image] = []
    time, track = np.linspace(-1.0, 1.0, clip.frames), clip.values[:, [0, 2]]
    for figure, degree in zip((8, 9, 10, 11), DEGREES, strict=True):
        path = mc.Path.of(clip, kind="polynomial", degree=degree)
        away = CM * path.residuals(clip)
        basis = np.polynomial.chebyshev.chebvander(time, degree)
        plain = CM * np.linalg.norm(basis @ np.linalg.lstsq(basis, track, rcond=None)[0] - track, axis=1)
        told = [f"{np.sqrt(np.mean(part**2)):.1f}" for part in (away, plain)]
        lines.append(
            f"| {degree} | {CM * path.length:.0f} | {told[0]}, {away.max():.1f} | {told[1]}, {plain.max():.1f} |"
        )
        above = traced(clip, path, 400)
        whole = Image.new("RGB", (400, above.size[1] + 156), "white")
        whole.paste(above, (0, 20))
        whole.paste(graph(away, clip.frame_time, 250.0, 400), (0, above.size[1] + 20))
        draw_title(whole, f"5.7, 5.{figure} degree {degree}")
        panels.append(whole)
    return "\n".join(lines), draw_views.beside(panels, 2)


def traced(clip: mc.Motion, path: mc.Path, width: int, ahead: bool = False) -> Image.Image:
    """The root, pale, and a path, from above, z to the right. ahead: also where the body looks, twice a second."""
    track, curve = roots(clip)[:, [2, 0]], path.place(np.linspace(0.0, 1.0, 600))[:, [1, 0]]
    both = np.concatenate([track, curve])
    low, high = both.min(axis=0), both.max(axis=0)
    image = Image.new("RGB", (2 * width, round(2 * 0.42 * width)), "white")
    room = np.array(image.size) - [0.0, 60.0]  # below the title
    scale = 0.9 * float((room / np.maximum(high - low, 1e-9)).min())
    draw, middle = ImageDraw.Draw(image), 0.5 * room + [0.0, 60.0]

    def line(places: np.ndarray, colour: str, thick: int) -> None:
        at = (places - 0.5 * (low + high)) * scale + middle
        draw.line([(float(x), float(y)) for x, y in at], colour, thick, joint="curve")

    line(track, draw_views.OWN[1], 7)
    line(curve, draw_views.OWN[0], 4)
    if ahead:
        columns, order = clip.skeleton.eulers[0]
        look = rotation.rotate(rotation.from_euler(clip.values[:, columns], order), np.array([0.0, 0.0, 1.0]))[
            :, [2, 0]
        ]
        for frame in range(0, clip.frames, round(0.5 / clip.frame_time)):
            line(track[frame] + np.outer([0.0, 0.25 * METRE], look[frame]), "#46505c", 4)
    return image.reduce(2)


def draw_title(image: Image.Image, text: str) -> None:
    ImageDraw.Draw(image).text((4, 4), text, "#46505c", ImageFont.load_default(14))


def simple_to_complex() -> tuple[str, Image.Image]:
    """Figures 5.12 to 5.16."""
    own = mc.Path.of(walk())
    lines, panels = [HEAD], [panel(walk(), own, None, None, VIEW, title="5.12 the walk")]
    for name, path in (
        ("5.13 circle", CIRCLE),
        ("5.14 zig-zag", ZIGZAG),
        ("5.15 figure of eight", EIGHT),
        ("5.16 walkabout", WALKABOUT),
    ):
        made = followed(walk(), path, own, at_end="cycle")
        lines.append(row(name, walk(), own, made, path))
        panels.append(panel(walk(), own, made, path, VIEW, title=name, poses=17))
    panels.append(panel(walk(), own, made, path, "top", title="5.16 from above", poses=17))
    return "\n".join(lines), draw_views.beside(panels, 2)


def complex_to_simple() -> tuple[str, Image.Image]:
    """Figures 5.17 and 5.18."""
    clip, lines = wander(), [HEAD]
    panels: list[Image.Image] = []
    for degree in DEGREES:
        own = mc.Path.of(clip, kind="polynomial", degree=degree)
        line = drawn([(3.0, 0.0), (3.0, own.length / METRE)])
        made = followed(clip, line, own)
        lines.append(row(f"5.17 degree {degree}, straight", clip, own, made, line))
        panels.append(panel(clip, own, made, line, VIEW, title=f"5.17 degree {degree}, straight", poses=15, ratio=0.5))
    for name, options in (("spline, 17 points", {}), ("the same, facing", {"heading": "facing"})):
        own = mc.Path.of(clip)
        line = drawn([(3.0, 0.0), (3.0, own.length / METRE)])
        lines.append(row(name, clip, own, followed(clip, line, own, **options), line))
    return "\n".join(lines), draw_views.beside(panels, 2)


def complex_to_complex() -> tuple[str, Image.Image]:
    """Figures 5.19 and 5.20."""
    clip, lines = wander(), [HEAD]
    own = mc.Path.of(clip, kind="polynomial", degree=45)
    panels: list[Image.Image] = []
    for name, path in (("5.19 a figure of eight", EIGHT), ("5.20 walkabout", WALKABOUT)):
        for heading in ("tangent", "facing"):
            made = followed(clip, path, own, at_end="truncate", heading=heading)
            lines.append(row(f"{name}, {heading}", clip, own, made, path))
        panels.append(panel(clip, own, made, path, VIEW, title=name, poses=17))
    return "\n".join(lines), draw_views.beside(panels, 2)


def hills() -> tuple[str, Image.Image]:
    """Figures 5.21 and 5.22, and the same with feet that stand on the slope."""
    own, lines = mc.Path.of(walk()), [HEAD]
    rises = [
        "| while a ball stands | it goes over the ground, cm/s | its height changes by, cm |",
        "| --- | --- | --- |",
    ]
    rises.append(standing("in the clip", walk()))
    panels: list[Image.Image] = []
    for name, posture in (
        ("5.21 upright, lifted", "lift"),
        ("5.22 relative to the tangent", "tangent"),
        ("ours, foot by foot", "upright"),
    ):
        made = followed(walk(), HILLS, own, posture=posture)
        lines.append(row(name, walk(), own, made, HILLS))
        rises.append(standing(name, made))
        panels.append(panel(walk(), own, made, HILLS, "side", title=name, width=640, poses=11, ratio=0.5))
    return "\n".join([*lines, "", *rises]), draw_views.beside(panels, 1)


def standing(name: str, made: mc.Motion) -> str:
    """How fast balls slide in the contacts of the walk, and how far they go up or down there, mean over contacts."""
    both = legs(walk())
    balls = {walk().skeleton.names[leg.ball]: leg.ball for leg in both}
    listed = [contact for contact in mc.contacts(walk()) if contact.joint in balls]
    slides = skate(made, listed, both, walk())
    assert slides is not None
    heights = CM * world(made)[:, :, 1]
    rises = [np.ptp(heights[contact.first : contact.last + 1, balls[contact.joint]]) for contact in listed]
    return f"| {name} | {slides.speed:.2f} | {np.mean(rises):.1f} |"


def tour() -> Image.Image:
    """What the program showed on its screen (section 4.6): the shipped jump along a slalom."""
    jump = mc.read(example())
    path = mc.Path([(0, 10), (28, 25), (40, 40), (28, 55), (0, 70), (-28, 85), (-40, 100), (-28, 115), (0, 130)])
    return draw_path.picture(jump, mc.Path.of(jump), mc.follow(jump, path, at_end="cycle"), path, width=800)


EXPERIMENTS: dict[str, Callable[[], tuple[str, Image.Image]]] = {
    "residuals": residuals,
    "arc length": arc_length,
    "cycling": cycling,
    "degrees": degrees,
    "simple to complex": simple_to_complex,
    "complex to simple": complex_to_simple,
    "complex to complex": complex_to_complex,
    "hills": hills,
}


def main() -> None:
    asked = ArgumentParser(description=(__doc__ or "").splitlines()[0])
    asked.add_argument("--pictures", type=File, help="a folder to draw into")
    asked.add_argument("--check", action="store_true", help="print the numbers, write no page")
    asked.add_argument("--only", default="")
    options = asked.parse_args()
    warnings.filterwarnings("ignore", message=".*frame rate.*")  # Acclaim files have none
    if options.pictures is not None and not options.only:
        save(tour(), options.pictures / "follow.png")
    for name, experiment in EXPERIMENTS.items():
        if options.only not in name:
            continue
        table, image = experiment()
        print(f"\n{name}\n{table}", flush=True)
        if options.pictures is not None:
            save(image, options.pictures / f"path-{name.replace(' ', '-')}.png")
        if not options.check:
            text = PAGE.read_text(encoding="utf-8")
            marked = re.compile(f"(<!-- {name} -->\n).*?(<!-- end -->)", re.DOTALL)
            PAGE.write_text(
                marked.sub(lambda found, table=table: f"{found[1]}{table}\n{found[2]}", text), encoding="utf-8"
            )


if __name__ == "__main__":
    main()
