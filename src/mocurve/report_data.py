"""What a report's page needs of two clips, small enough to embed: curves, errors, keys, poses."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import numpy as np

from . import draw_scene, kinematics
from .errors import MocurveError, OptionError
from .info import unit_of, z_is_up
from .keyed import KeyedMotion
from .measure import Report, side_by_side
from .measure_noise import Noise
from .motion import Motion
from .report_curves import bridged, packed, thinned
from .report_noise import noise_data
from .skeleton import Skeleton

MOST_VALUES = 1_200_000  # of samples, and as many errors: 6.4 MB each on the page
MOST_PLACES = 400_000  # coordinates of each figure
POSE_FPS = 30.0


def page_data(report: Report) -> dict[str, Any]:
    """All that the page shows but the sweep, ready for JSON."""
    assert report.clips is not None
    a, b = report.clips
    first, second = side_by_side(a, b)
    skeleton = first.skeleton
    curved = bool(report.channels)  # else the channels differ and only space is compared
    stride = max(1, -(-first.values.size // MOST_VALUES)) if curved else 1
    before, after = thinned(first.values, second.values, stride) if curved else (np.empty((0, 0)),) * 2
    noise = report.noise if curved else None
    cleaned = first if isinstance(b, KeyedMotion) else second
    drawn = bridged(first), bridged(second)
    limits = _limits(report, replace(first, report=report))  # a tolerance in sigma looks the noise up there
    left_out = ("channels", "joints", "noise")  # the page has them in other words
    return {
        "report": {name: value for name, value in report.to_json().items() if name not in left_out},
        "millimetres": None if report.unit is None else report.unit * 1000,
        "guess": _guess(drawn[0]) if report.unit is None else None,
        "degree_length": float(np.radians(kinematics.rest_height(first))) or 1.0,  # what a degree spans at the height
        "frame_time": first.frame_time,
        "duration": first.duration,
        "stride": stride,
        "shown_frames": len(before),
        "keyed": isinstance(b, KeyedMotion),
        "channels": _channels(report, skeleton),
        "first_channel": _liveliest(drawn[0], noise) if curved else 0,
        "samples": packed(before.T),
        "errors": packed((after - before).T),
        "noise": None if noise is None else noise_data(noise, cleaned, drawn[1], stride),
        "keys": _keys(b) if curved and isinstance(b, KeyedMotion) else None,
        "bands": None if limits is None or not curved else [_band(row, stride) for row in limits[0]],
        "joints": _joints(report, skeleton, None if limits is None else limits[1]),
        "poses": _poses(*drawn),
    }


# -- in call order -----------------------------------------------------------------------------------------------------


def _guess(motion: Motion) -> dict[str, Any] | None:
    """The length unit that the body's height suggests."""
    try:
        unit = unit_of(motion)
    except OptionError:  # a body without height
        return None
    return {"name": unit.name, "millimetres": unit.metres * 1000}


def _channels(report: Report, skeleton: Skeleton) -> list[dict[str, Any]]:
    names = ("name", "unit", "keys", "max", "rms", "lower_bound")
    kinds = [kind for kinds in skeleton.channels for kind in kinds]
    joints = [int(joint) for joint in skeleton.channel_joints]
    return [
        {**{name: getattr(row, name) for name in names}, "kind": kind, "joint": joint}
        for row, kind, joint in zip(report.channels, kinds, joints, strict=bool(report.channels))
    ]


def _liveliest(motion: Motion, noise: Noise | None) -> int:
    """What the page opens with: the rotation channel below a root that swings the longest chain the furthest, one with
    artefacts where there are any."""
    skeleton = motion.skeleton
    if not motion.frames or not skeleton.channel_count:
        return 0
    swung = motion.values.std(axis=0) * kinematics.reach(motion)[skeleton.channel_joints]
    inner = skeleton.rotation_channels & (skeleton.parents[skeleton.channel_joints] >= 0)
    bad = {name for row in noise.artefacts for name in row.channels} if noise is not None else set()
    told = inner & np.isin(skeleton.channel_names, list(bad))
    return int(np.argmax(np.where(told if told.any() else inner, swung, -1.0)))


def _keys(keyed: KeyedMotion) -> dict[str, str]:
    parts = ("times", "values", "slopes", "in_slopes")
    return {part: packed(np.concatenate([getattr(curve, part) for curve in keyed.curves])) for part in parts}


def _limits(report: Report, motion: Motion) -> tuple[np.ndarray, np.ndarray | None] | None:
    """(C, F), and (J, F) or None: what the tolerance allows channels and joints; None where it is not known."""
    from .reduction.tolerance import parse, resolve  # Numba comes with it

    if not report.tolerance or not motion.frames:
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # whoever reduced was told that the length unit is guessed
        try:
            limits = resolve(parse(report.tolerance.split(", ")), motion)
        except MocurveError:  # a ratio, or names of another skeleton
            return None
    return limits.channels, limits.joints


def _band(limits: np.ndarray, stride: int) -> float | str | None:
    """What a channel (F,) may be off: one number, one a frame, or None where there is no limit."""
    if not np.isfinite(limits).any():
        return None
    return float(limits[0]) if (limits == limits[0]).all() else packed(limits[::stride])


def _joints(report: Report, skeleton: Skeleton, limits: np.ndarray | None) -> list[dict[str, Any]]:
    """A row a joint; its tolerance is what it may be off where it may be off most."""
    most = (
        [None] * len(skeleton.names)
        if limits is None
        else [float(x) if np.isfinite(x) else None for x in limits.max(axis=1)]
    )
    depth = np.zeros(len(skeleton.names), int)
    for joint, parent in enumerate(skeleton.parents):
        depth[joint] = depth[parent] + 1 if parent >= 0 else 0
    return [
        {
            "name": row.name,
            "parent": int(skeleton.parents[j]),
            "depth": int(depth[j]),
            "max": row.max,
            "rms": row.rms,
            "tolerance": most[j],
        }
        for j, row in enumerate(report.joints)
    ]


def _poses(first: Motion, second: Motion) -> dict[str, Any]:
    """Both figures with Y up at 30 or fewer frames a second, and the room they need."""
    if not first.frames:
        return {"count": 0, "a": "", "b": ""}
    most = max(2, MOST_PLACES // (3 * len(first.skeleton.names)))
    fps = min(POSE_FPS, 1 / first.frame_time, most / max(first.duration, first.frame_time))
    count = int(first.duration * fps + 1e-6) + 1
    frames = np.minimum((np.arange(count) / fps / first.frame_time).round().astype(int), first.frames - 1)
    a, b = (kinematics.world(_some(motion, frames)) for motion in (first, second))
    if z_is_up(a):
        a, b = draw_scene.y_up(a), draw_scene.y_up(b)
    figures = [draw_scene.Figure(first.skeleton, places, (0, 0, 0), (0, 0, 0), "") for places in (a, b)]
    ground = draw_scene.ground(figures)
    flat = np.concatenate([a, b], axis=1)[..., [0, 2]]
    way = a[..., [0, 2]].mean(axis=1)
    middle = (flat.min(axis=(0, 1)) + flat.max(axis=(0, 1))) / 2
    near = np.abs(flat - way[:, None]).max(axis=(0, 1)).max() + 0.1 * ground.body
    whole = np.ptp(flat, axis=(0, 1)) / 2 + 0.15 * ground.body
    return {
        "fps": fps,
        "count": count,
        "a": packed(a),
        "b": packed(b),
        "way": [round(float(x), 6) for x in way.reshape(-1)],
        "middle": middle.tolist(),
        "near": [float(near), float(near)],
        "whole": whole.tolist(),
        "travels": bool(whole.max() > 1.5 * near),
        "floor": ground.floor,
        "top": float(max(a[..., 1].max(), b[..., 1].max(), ground.floor + 1e-6)),
        "square": ground.square,
    }


def _some(motion: Motion, frames: np.ndarray) -> Motion:
    return Motion(motion.skeleton, motion.values[frames], motion.frame_time)
