"""Keys, error and time of `optimal` against Blender's decimate at the same margin (optional: needs bpy).

    python benchmarks/blender_decimate.py [--step 8] [--frames 1000] [--rounds 3]

Channels: those of optimal.py, every `step`-th, the first `frames` frames. Each is an F-curve with a key a frame, as one
of two kinds: "linear" keys, as Blender's BVH import makes them (decimate leaves free handles, most of them broken), or
"smooth" ones (Bezier with automatic handles, the default of a new key; decimate leaves them aligned and keeps more).
Decimate measures error as distance in the plane of frames and values, so the unit matters: in degrees it oversteps its
margin on fast channels, in radians, which Blender itself uses, hardly. All four are shown.

error: the largest at any frame, in margins. over: share of channels whose error exceeds the margin. broken: share of
inner keys whose handles make an angle of over one degree, values taken in degrees. ours / Blender: keys of all
channels; geometric mean over channels; keys of all where ours is asked, channel by channel, for the error that Blender
reached; processor time, median of the rounds.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser
from itertools import product
from statistics import median
from time import process_time
from typing import Any, NamedTuple

import numpy as np
from optimal import TOLERANCES, live_channels

from mocurve.hermite import evaluate
from mocurve.reduction.keys import Keys
from mocurve.reduction.optimal import solve

try:
    import bpy
except ImportError:
    sys.exit('this benchmark needs Blender as a Python module: with Python 3.11, pip install "bpy==4.5.*"')

UNITS = {"degrees": 1.0, "radians": np.pi / 180.0}  # of an F-curve's values, for one degree
KINDS = {"linear": "LINEAR", "smooth": "BEZIER"}  # a new key's handles are automatic
LEAST = 1e-6  # degrees; where Blender removed no key, its error is the rounding of its 32 bits
GOAL = "keys ours / Blender: least 0.55, aim 0.5"


class Decimated(NamedTuple):
    """What Blender made of the channels."""

    keys: np.ndarray  # (channels,) int
    error: np.ndarray  # (channels,) largest at any frame, degrees
    broken: float  # share of inner keys
    seconds: float  # of the operator


def graph_editor() -> dict[str, Any]:
    """The context that the operator asks for; a module has a window too, whose first area becomes a graph editor."""
    window = bpy.context.window_manager.windows[0]
    area = window.screen.areas[0]
    area.type = "GRAPH_EDITOR"
    region = next(region for region in area.regions if region.type == "WINDOW")
    return {"window": window, "area": area, "region": region}


def holder() -> Any:
    """A selected object: the graph editor shows its curves."""
    made = bpy.data.objects.new("holder", None)
    bpy.context.scene.collection.objects.link(made)
    bpy.context.view_layer.objects.active = made
    made.select_set(True)
    return made


def curves(owner: Any, channels: list[np.ndarray], interpolation: str, unit: float) -> Any:
    """The owner's new action, an F-curve a channel (1, F), all keys selected."""
    owner["channels"] = [0.0] * len(channels)
    action = bpy.data.actions.new("channels")
    slot = action.slots.new("OBJECT", owner.name)
    owner.animation_data_create().action = action
    owner.animation_data.action_slot = slot
    for i, y in enumerate(channels):
        curve = action.fcurves.new('["channels"]', index=i)
        curve.keyframe_points.add(y.size)
        points = np.column_stack([np.arange(y.size), y[0] * unit]).astype(np.float32)
        curve.keyframe_points.foreach_set("co", points.ravel())
        for key in curve.keyframe_points:
            key.interpolation = interpolation
        curve.update()
    return action


def kinks(curve: Any, unit: float) -> np.ndarray:
    """Angle (inner keys,) between the two handles of a key, degrees."""
    read = {}
    for name in ("handle_left", "co", "handle_right"):
        points = np.empty(2 * len(curve.keyframe_points), np.float32)
        curve.keyframe_points.foreach_get(name, points)
        read[name] = points.reshape(-1, 2)[1:-1].astype(np.float64) / (1.0, unit)
    arriving, leaving = read["co"] - read["handle_left"], read["handle_right"] - read["co"]
    angles = np.arctan2(arriving[:, 1], arriving[:, 0]) - np.arctan2(leaving[:, 1], leaving[:, 0])
    return np.degrees(np.abs(angles))


def decimate(
    owner: Any, context: dict[str, Any], channels: list[np.ndarray], margin: float, interpolation: str, unit: float
) -> Decimated:
    """Blender's decimate with an allowed change of `margin` degrees, on all channels in one call."""
    action = curves(owner, channels, interpolation, unit)
    start = process_time()
    with bpy.context.temp_override(**context):
        bpy.ops.graph.decimate(mode="ERROR", remove_error_margin=margin * unit)
    seconds = process_time() - start
    keys = np.array([len(curve.keyframe_points) for curve in action.fcurves])
    error = np.array(
        [
            max(abs(curve.evaluate(frame) / unit - value) for frame, value in enumerate(y[0]))
            for curve, y in zip(action.fcurves, channels, strict=True)
        ]
    )
    broken = float(np.mean(np.concatenate([kinks(curve, unit) for curve in action.fcurves]) > 1.0))
    bpy.data.actions.remove(action)
    return Decimated(keys, error, broken, seconds)


def ours(channels: list[np.ndarray], tolerances: np.ndarray) -> tuple[list[Keys], float]:
    """Keys of each channel within its tolerance (channels,), and processor seconds."""
    halves = [np.full_like(y, tolerance) for y, tolerance in zip(channels, tolerances, strict=True)]
    start = process_time()
    keys = [solve(y, half, "default") for y, half in zip(channels, halves, strict=True)]
    return keys, process_time() - start


def error_of(keys: Keys, y: np.ndarray) -> float:
    """Largest error at any frame."""
    return float(np.abs(evaluate(keys.frames, keys.values[0], keys.slopes[0], np.arange(y.size)) - y[0]).max())


def count(keys: list[Keys]) -> np.ndarray:
    """Keys (channels,)."""
    return np.array([len(k.frames) for k in keys])


def row(
    name: str, margin: float, channels: list[np.ndarray], rounds: list[tuple[Decimated, list[Keys], float]]
) -> tuple[float, float, float]:
    """Prints a margin's line; returns its three ratios of keys."""
    theirs, keys, _ = rounds[0]
    kept, cells = count(keys), sum(y.size for y in channels)
    error = max(error_of(k, y) for k, y in zip(keys, channels, strict=True))
    same_error = count(ours(channels, np.maximum(theirs.error, LEAST))[0])
    ratios = (
        kept.sum() / theirs.keys.sum(),
        float(np.exp(np.mean(np.log(kept / theirs.keys)))),
        same_error.sum() / theirs.keys.sum(),
    )
    print(
        f"{name:16}{margin:6g} |{theirs.keys.sum() / cells:11.4f}{theirs.error.max() / margin:8.3f}"
        f"{np.mean(theirs.error > 1.001 * margin):6.0%}{theirs.broken:8.0%} |{kept.sum() / cells:11.4f}"
        f"{error / margin:8.3f} |{ratios[0]:7.3f}{ratios[1]:8.3f}{ratios[2]:12.3f}"
        f"{median(seconds / made.seconds for made, _, seconds in rounds):8.4f}",
        flush=True,
    )
    return ratios


def main() -> None:
    asked = ArgumentParser()
    asked.add_argument("--step", type=int, default=8)
    asked.add_argument("--frames", type=int, default=1000)
    asked.add_argument("--rounds", type=int, default=3)
    options = asked.parse_args()
    channels = [y for y in live_channels(options.frames, options.step) if y.size > 2]
    context, owner = graph_editor(), holder()
    ours(channels[:1], np.ones(1))  # compiles
    print(f"{len(channels)} channels, {sum(y.size for y in channels)} channel-frames")
    print(f"Blender {bpy.app.version_string}; {GOAL}")
    print(f"{'':22} |{'Blender':>11}{'':22} |{'ours':>11}{'':8} |   ours / Blender")
    print(
        f"{'values, keys':16}{'deg':>6} |{'keys/frame':>11}{'error':>8}{'over':>6}{'broken':>8} |"
        f"{'keys/frame':>11}{'error':>8} |{'keys':>7}{'mean':>8}{'same error':>12}{'time':>8}"
    )
    for (unit, factor), (kind, interpolation) in product(UNITS.items(), KINDS.items()):
        ratios = []
        for margin in TOLERANCES:
            rounds = [
                (
                    decimate(owner, context, channels, margin, interpolation, factor),
                    *ours(channels, np.full(len(channels), margin)),
                )
                for _ in range(options.rounds)
            ]
            ratios.append(row(f"{unit}, {kind}", margin, channels, rounds))
        keys, mean, same_error = np.exp(np.mean(np.log(ratios), axis=0))
        print(f"{'    geometric mean of the margins':79}{keys:7.3f}{mean:8.3f}{same_error:12.3f}")


if __name__ == "__main__":
    main()
