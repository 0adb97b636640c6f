"""The pictures and numbers of docs/papers/sudarsky-house-1998.md: a captured walk and a run of one person.

python sudarsky_figures.py [--pictures ../docs/pictures]

The walk is 02_01 and the run 02_03 of the CMU database. With --pictures the figures are drawn there; the numbers are
printed in any case.
"""

from __future__ import annotations

import warnings
from argparse import ArgumentParser
from pathlib import Path

import numpy as np
from clips import folder
from PIL import Image

import mocurve as mc
from mocurve import spline

TOLERANCE = "5mm"
CLOSED = {"close": "spline", "cycles": 3}


def person(name: str) -> mc.Motion:
    """One of the two clips, as Acclaim has it."""
    cmu = folder() / "cmu"
    clip = mc.read(cmu / f"cmu_{name}.amc", skeleton=cmu / "cmu_02.asf")
    assert isinstance(clip, mc.Motion)
    return clip


def laws(walk: mc.SplineMotion, run: mc.SplineMotion) -> dict[str, tuple[mc.Clip, mc.Clip]]:
    """What has to be the same, in pairs; both splines are equally long."""
    first, second = spline.align(walk, run)
    at, name = 0.5 * walk.duration, "lfemur.Xrotation"
    was = float(walk.at(np.array([at]))[0, walk.skeleton.channel(name)])
    end = walk.domain[1]
    slow = mc.retime(walk, {end: 2.0 * end})
    by = mc.difference(run, walk, mode="curves")
    return {
        f"the walk on the knots of both ({len(first.knots)})": (first, walk),
        "the difference added to the walk is the run": (mc.add(by, walk), second),
        "blended at 0 it is the walk": (mc.blend(walk, run, 0.0, mode="curves"), walk),
        "blended at 1 it is the run": (mc.blend(walk, run, 1.0, mode="curves"), run),
        "warped to a value and back it is the walk": (
            mc.warp(mc.warp(walk, at, {name: was + 30.0}), at, {name: was}),
            walk,
        ),
        "at half the speed and back it is the walk": (mc.retime(slow, {2.0 * end: end}), walk),
    }


def draw(path: Path, clip: mc.Clip, poses: int) -> None:
    """A clip from the side, in few colours."""
    mc.render(clip, path, poses=poses, view="side", width=1000)
    with Image.open(path) as image:
        small = image.convert("RGB").quantize(64)
    small.save(path, "PNG", optimize=True)


def main() -> None:
    options = ArgumentParser(description=(__doc__ or "").splitlines()[0])
    options.add_argument("--pictures", type=Path)
    pictures = options.parse_args().pictures
    warnings.simplefilter("ignore")  # splines become samples where joints are turned
    walk, run = person("02_01"), person("02_03")
    splines = [mc.fit(clip, tolerance=TOLERANCE) for clip in (walk, run)]
    for name, made in zip(("walk", "run"), splines, strict=True):
        print(f"{name}: {made.report.sentence()}")
    stretched = mc.retime(splines[1], {splines[1].domain[1]: splines[0].domain[1]})
    print("\nlargest difference, degrees or units")
    for told, (made, wanted) in laws(splines[0], stretched).items():
        print(f"  {told:48} {np.abs(made.sample().values - wanted.sample().values).max():.1e}")

    joined = mc.join(*splines, mode="spline")
    looped = mc.loop(splines[1], **CLOSED)
    between = mc.interpolate([walk, run], [0.5, 0.5], method="fourier", cycles=3)
    for title, clip in (("transition", joined), ("cyclification", looped), ("interpolation", between)):
        print(f"\n{title}: {clip!r}")
        for name, value in clip.history[-1]["measured"].items():
            print(f"  {name:14} {value}")
    if pictures is None:
        return
    for name, clip, poses in (
        ("walk", walk, 10),
        ("run", run, 8),
        ("transition", joined, 16),
        ("cycles", looped, 16),
        ("between", between, 12),
    ):
        draw(pictures / f"sudarsky_{name}.png", clip, poses)


if __name__ == "__main__":
    main()
