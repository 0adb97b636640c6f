"""Clips on paths that are longer than they are, and in bends: seams and headings of cycles, and what bends cost.

    python benchmarks/follow_cycles.py

Cycles: clips repeated over a straight path, an arc of 3 m and a slalom of four times their own length; the largest step
and second difference of a joint within two frames of a seam, times what 99.5 % of the frames elsewhere stay below
(least 1.0); how far the root turns away from the path's heading a cycle, degrees (least 0.1); how fast balls slide in
contact in the clip, carried and held, cm/s; contacts let go.

Paced: the paths of follow.py in mode paced; how many times as long they take, the greatest second difference of a joint
times that of mode arclength, how fast balls slide in contact, carried and held; contacts let go.
"""

from __future__ import annotations

import warnings

import numpy as np
from follow import CLIPS, CM, clip, drawn, jumps

import mocurve as mc
from mocurve import rotation
from mocurve.kinematics import world

LENGTHS = 4  # times a clip's own path


def tours(length: float) -> dict[str, mc.Path]:
    """A straight path, an arc of 3 m and a slalom whose bends swing by 34 degrees every 2 m; metres."""
    ahead = np.linspace(0.0, length, max(24, round(5 * length)))
    aside = np.cumsum(np.tan(0.6 * np.cos(0.5 * np.pi * ahead))) * ahead[1]
    slalom = np.stack([aside, ahead], axis=1)
    gone = np.cumsum(np.linalg.norm(np.diff(slalom, axis=0, prepend=0.0), axis=1))
    shapes = {
        "straight": np.stack([0 * ahead, ahead], axis=1),
        "arc of 3 m": 3.0 * np.stack([1.0 - np.cos(ahead / 3.0), np.sin(ahead / 3.0)], axis=1),
        "slalom": slalom[gone <= length],
    }
    return {name: mc.Path(100.0 / CM * points) for name, points in shapes.items()}


def cycles() -> None:
    """Clips repeated over four times their own length: at the seams, and a heading that would drift."""
    heads = "".join(f"{head:>9}" for head in ("cycles", "step", "bend", "drift", "clip", "carried", "held"))
    print(f"\n{'cycles':22}{heads}{'let go':>10}")
    for name in CLIPS:
        motion = clip(name)
        edit = mc.PathEdit.of(motion)
        for shape, path in tours(LENGTHS * CM / 100.0 * edit.path.length).items():
            made = edit.laid(path, at_end="cycle")
            told, table = made.history[-1]["measured"], made.history[-1]["table"]
            cycle, places = np.array(table["cycle"]), world(made)
            row = f"{told['cycles']:9}" + "".join(f"{at_seams(places, cycle, order):9.2f}" for order in (1, 2))
            row += f"{drift(made, path.at(np.array(table['distance']))[1], cycle):9.3f}"
            feet = told["feet"]
            row += "".join(f"{feet[part]:9.2f}" for part in ("speed_own", "speed_slid", "speed"))
            print(f"{name:10}{shape:12}{row}{feet['released']:5} of {feet['contacts']}", flush=True)


def at_seams(places: np.ndarray, cycle: np.ndarray, order: int) -> float:
    """The largest step (order 1) or second difference (2) of a joint within two frames of a seam, times what 99.5 % of
    the frames elsewhere stay below."""
    change = np.linalg.norm(np.diff(places, order, axis=0), axis=-1).max(axis=1)
    wide = np.pad(cycle, 2, "edge")
    across = wide[order + 4 :] != wide[: -order - 4]
    return float(change[across].max() / np.percentile(change[~across], 99.5))


def drift(made: mc.Motion, ahead: np.ndarray, cycle: np.ndarray) -> float:
    """Degrees a cycle by which the root, mean over a cycle, turns away from headings (F,) of the path: the slope of a
    line through the means."""
    columns, order = made.skeleton.eulers[0]
    turn = rotation.from_euler(made.values[:, columns], order)
    looks = np.unwrap(2.0 * np.arctan2(turn[:, 2], turn[:, 0]) - ahead)
    means = [np.degrees(looks[cycle == k].mean()) for k in range(cycle[-1])]
    return float(abs(np.polyfit(np.arange(len(means)), means, 1)[0]))


def bends() -> None:
    """What bends cost in mode paced."""
    print(f"\n{'paced':30}" + "".join(f"{head:>9}" for head in ("time", "bend", "carried", "held", "let go")))
    for name in CLIPS[:5]:
        edit = mc.PathEdit.of(clip(name))
        for shape, path in drawn().items():
            plain, made = (edit.laid(path, mode=mode) for mode in ("arclength", "paced"))
            told = made.history[-1]["measured"]
            rough = jumps(world(made))[1] / jumps(world(plain))[1]
            feet = told["feet"]
            row = f"{told['slower']:9.2f}{rough:9.2f}{feet['speed_slid']:9.2f}{feet['speed']:9.2f}{feet['released']:9}"
            print(f"{name:10}{shape:20}{row}", flush=True)


def main() -> None:
    warnings.simplefilter("ignore")  # no frame rate in Acclaim files
    cycles()
    bends()


if __name__ == "__main__":
    main()
