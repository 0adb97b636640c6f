"""Interpolation of captured walks and runs: laws, planted feet, roughness, and what lies between known clips.

    python interpolate.py [--picture ../docs/pictures/interpolate.png]

Clips are cut to whole cycles that begin in the same pose. The peer is `mix`, the weighted mean without registration, in
the same run; feet count where they rest in all clips at the moments that are mixed. A known clip in between: each walk,
and the same with every swing 1.4 times as wide and its time bent; halfway there are 1.2 times and half the bend.
"""

from __future__ import annotations

import time
import warnings
from argparse import ArgumentParser
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from clips import folder
from PIL import Image

import mocurve as mc
from mocurve.edit import _fourier
from mocurve.edit._in_step import in_step, moments, registered
from mocurve.edit._interpolated import Interpolation, measured
from mocurve.edit._poses import motion_of, moved, poses_of
from mocurve.edit._seams import centimetres
from mocurve.edit._shares import shares_of
from mocurve.kinematics import world

CLIPS = {  # name: (file, its skeleton file, frames of whole cycles)
    "12_01 walk": ("cmu_12_01_walk.bvh", None, slice(44, 198)),
    "02_01 walk": ("cmu_02_01_walk_blender.bvh", None, slice(91, 224)),
    "02_01.amc walk": ("cmu_02_01.amc", "cmu_02.asf", slice(71, 204)),
    "16_15 walk": ("cmu_16_15.amc", "cmu_16.asf", slice(67, 206)),
    "09_01 run": ("cmu_09_01.amc", "cmu_09.asf", slice(29, 118)),
}
PAIRS = [("12_01 walk", "02_01 walk"), ("02_01.amc walk", "16_15 walk"), ("16_15 walk", "09_01 run")]
WEIGHTS = (0.25, 0.5, 0.75)
WARP = [(0.3, 0.4), (0.6, 0.62), (0.85, 1.0)]  # old and new parts of the clip
WIDER = 1.4
ASIDE = np.array([0.5 * np.pi, 0.0, 0.0])  # the second clip goes another way: to the others that is the same


def whole(name: str) -> mc.Motion:
    file, skeleton, _ = CLIPS[name]
    body = {} if skeleton is None else {"skeleton": folder() / "cmu" / skeleton}
    clip = mc.read(folder() / "cmu" / file, **body)
    assert isinstance(clip, mc.Motion)
    return clip


def cut(name: str) -> mc.Motion:
    return whole(name)[CLIPS[name][2]]


def numbers(made: mc.Motion) -> Interpolation:
    return Interpolation(**made.history[-1]["measured"])


def apart(a: mc.Motion, b: mc.Motion) -> float:
    """How far some joint is from where it should be, at most, cm."""
    frames = min(a.frames, b.frames)
    return (centimetres(a) or 1.0) * float(np.linalg.norm(world(a[:frames]) - world(b[:frames]), axis=-1).max())


def laws() -> None:
    a, b = whole("12_01 walk")[1:], whole("02_01 walk")  # the first has a T-pose in front
    values = np.array(a.values)
    values[:, [0, 2]] += [40.0, -25.0]
    elsewhere = replace(a, values=values)
    clips = [cut("12_01 walk"), wider(cut("12_01 walk"), WIDER), bent(cut("12_01 walk"), 1.0)]
    first = mc.interpolate(clips, [0.5, 0.3, 0.2])
    again = mc.interpolate([clips[2], *clips[:2]], [0.2, 0.5, 0.3])
    print("law                            worst")
    print(f"weight 1, numbers that differ  {int((mc.interpolate([a, b], [1, 0]).values != a.values).sum())}")
    print(f"a clip and itself, cm          {apart(mc.interpolate([a, a, a], [1, 2, 3]), a):.1e}")
    print(f"a clip and itself moved, cm    {apart(mc.interpolate([a, elsewhere], [0.7, 0.3]), a):.1e}")
    print(f"another order, cm              {apart(again, first):.1e}")


def in_step_against_mix() -> None:
    ways = "".join(f"{way:>13}" for way in ("mix, aside", "mix", "multitarget", "fourier"))
    print(f"\n{'feet cm/s, acceleration':34}{'weight':>7}{'own':>12}{ways}")
    for names in PAIRS:
        motions = [cut(name) for name in names]
        wholes = [whole(name) for name in names]
        for weight in WEIGHTS:
            weights = [1.0 - weight, weight]
            found = numbers(mc.interpolate(motions, weights))
            series = numbers(mc.interpolate(wholes, weights, method="fourier", cycles=2))
            turned = [motions[0], motion_of(moved(poses_of(motions[1]), motions[1].skeleton, ASIDE), motions[1])]
            unaware = [mixed(clips, weights) for clips in (turned, motions)]
            own = "/".join(f"{clip['foot_speed'] or 0.0:.1f}" for clip in found.clips)
            rows = [f"{row.foot_speed or 0:.1f}, {row.acceleration:.2f}" for row in (*unaware, found, series)]
            print(f"{' + '.join(names):34}{weight:7.2f}{own:>12}" + "".join(f"{row:>13}" for row in rows), flush=True)


def mixed(motions: list[mc.Motion], weights: list[float]) -> Interpolation:
    """The same numbers of the mean of clips that are only stretched."""
    made = mc.mix(motions, weights)
    along = np.linspace(0.0, 1.0, made.frames)
    times = np.stack([along * motion.duration for motion in motions])
    return measured(made, motions, times, np.array(weights), [{}, {}])


def references() -> None:
    print(f"\n{'reference':34}{'apart cm':>10}{'stretched':>11}{'other reference, cm':>21}{'time s':>8}")
    for names in PAIRS:
        motions = [cut(name) for name in names]
        mc.interpolate(motions)  # compiles
        start = time.process_time()
        found = numbers(mc.interpolate(motions))
        spent = time.process_time() - start
        match = next(clip for clip in found.clips if "distance" in clip)
        shares = shares_of(2, None, None, None)
        both = [in_step(one, moments(one, shares)) for one in (registered(motions, place) for place in (0, 1))]
        other = f"{apart(*both):21.2f}"
        print(
            f"{' + '.join(names):34}{match['distance']:10.2f}{match['even_distance']:11.2f}{other}{spent:8.2f}",
            flush=True,
        )


def series() -> None:
    print("\nfourier, harmonics                error of both, cm      feet cm/s  all phases interpolated")
    added = _fourier._between
    for names in PAIRS:
        motions = [whole(name) for name in names]
        for count in (3, 5, 7, 12):
            found = []
            for way in (added, all_phases):
                _fourier._between = way
                found.append(numbers(mc.interpolate(motions, method="fourier", cycles=2, harmonics=count)))
            _fourier._between = added
            error = " ".join(f"{clip['error']:.2f}" for clip in found[0].clips)
            feet = f"{found[0].foot_speed:12.1f}{found[1].foot_speed:12.1f}"
            print(f"{' + '.join(names):30}{count:4}{error:>18}{feet}", flush=True)


def all_phases(coefficients: list[np.ndarray], shares: np.ndarray) -> np.ndarray:
    """Amplitude and phase of every harmonic, as Unuma and others write it."""
    every = np.stack(coefficients)
    sizes, base = np.abs(every), np.take_along_axis(every, np.abs(every).argmax(axis=0)[None], axis=0)[0]
    ahead = np.where(sizes > 0.01 * np.abs(base), np.angle(every * base.conj()), 0.0)
    size, angle = (np.einsum("nj,nhjk->hjk", shares, part) for part in (sizes, ahead))
    made = size * np.exp(1j * (np.angle(base) + angle))
    made[0] = np.einsum("nj,njk->jk", shares, every[:, 0].real)
    return made


def held_out() -> None:
    print(f"\n{'known halfway':34}{'multitarget cm':>15}{'mix cm':>9}{'rms':>7}{'rms':>7}")
    for name in CLIPS:
        clip = cut(name)
        far, known = bent(wider(clip, WIDER), 1.0), bent(wider(clip, 0.5 + 0.5 * WIDER), 0.5)
        found = []
        for made in (mc.interpolate([clip, far]), mc.mix([clip, far], [1, 1])):
            frames = min(made.frames, known.frames)
            off = np.linalg.norm(world(made[:frames]) - world(known[:frames]), axis=-1) * (centimetres(clip) or 1.0)
            found.append((float(off.max()), float(np.sqrt((off**2).mean()))))
        (most, mean), (mix_most, mix_mean) = found
        print(f"{name:34}{most:15.2f}{mix_most:9.2f}{mean:7.2f}{mix_mean:7.2f}", flush=True)


def wider(clip: mc.Motion, factor: float) -> mc.Motion:
    """All joints but the root swing so much wider about their middle."""
    values = mc.unroll(clip).values.copy(order="F")
    chosen = clip.skeleton.rotation_channels & (clip.skeleton.parents[clip.skeleton.channel_joints] >= 0)
    middle = values[:, chosen].mean(axis=0)
    values[:, chosen] = middle + factor * (values[:, chosen] - middle)
    return replace(clip, values=values)


def bent(clip: mc.Motion, part: float) -> mc.Motion:
    """The clip with its time bent, or only a part of that."""
    pairs = [(old * clip.duration, (old + part * (new - old)) * clip.duration) for old, new in WARP]
    return mc.retime(clip, pairs)


def picture(path: str) -> None:
    """Half a cycle of a walk, of a run, and of three gaits between, one below the other."""
    motions = [whole(name) for name in PAIRS[-1]]
    rows = []
    with TemporaryDirectory() as scratch:
        for weight in (0.0, *WEIGHTS, 1.0):
            made = mc.interpolate(motions, [1.0 - weight, weight], method="fourier")
            sheet = Path(scratch) / f"{weight}.png"
            mc.render(made, sheet, view="side", width=560)
            with Image.open(sheet) as drawn:
                rows.append(drawn.crop((0, 0, drawn.width, drawn.height // 2 + 8)))
    page = Image.new("RGB", (rows[0].width, sum(row.height for row in rows)), "white")
    for place, row in enumerate(rows):
        page.paste(row, (0, place * row.height))
    page.quantize(64).save(path, optimize=True)


def main() -> None:
    parser = ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--picture", help="draw a walk, a run and what lies between, and measure nothing")
    path = parser.parse_args().picture
    warnings.simplefilter("ignore")  # bones of other lengths, no frame rate in Acclaim files
    if path is not None:
        picture(path)
        return
    laws()
    in_step_against_mix()
    references()
    series()
    held_out()


if __name__ == "__main__":
    main()
