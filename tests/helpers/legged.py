"""Bodies with two straight legs that step as they are told, and skeletons with a joint more or some less."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import mocurve as mc

FPS = 100
NAMES = ("Hips", "LThigh", "LShin", "LFoot", "LToe", "RThigh", "RShin", "RFoot", "RToe")


def still_body(frames: int, scale: float = 1.0, fps: float = FPS) -> mc.Motion:
    """Two straight legs, cm times a scale, of which only the root moves and, under it, the left hip along X and Y."""
    leg = [[10, -10, 0], [0, -40, 0], [0, -40, 0], [0, -8, 12]]
    offsets = [[0, 98, 0], *leg, *([-x, y, z] for x, y, z in leg)]
    kinds = tuple(f"{axis}{kind}" for kind in ("position", "rotation") for axis in "XYZ")
    turns = kinds[3:]
    skeleton = mc.Skeleton(
        NAMES,
        [-1, 0, 1, 2, 3, 0, 5, 6, 7],
        scale * np.array(offsets, float),
        (kinds, kinds, *[turns] * 7),
        unit=0.01 / scale,
    )
    values = np.zeros((frames, skeleton.channel_count))
    for joint in (0, 1):
        values[:, 6 * joint : 6 * joint + 3] = scale * np.array(offsets[joint], float)
    return mc.Motion(skeleton, values, 1.0 / fps)


def stepping(ahead: np.ndarray, up: np.ndarray, scale: float = 1.0, fps: float = FPS) -> mc.Motion:
    """The left leg goes along X and up by so many cm (F,)."""
    body = still_body(len(ahead), scale, fps)
    values = body.values.copy()
    values[:, 6] += scale * ahead
    values[:, 7] += scale * up
    return replace(body, values=values)


def walk_left(fps: float = FPS, scale: float = 1.0) -> mc.Motion:
    """Half a second of rest, half a second of a step of 60 cm, 20 cm up, half a second of rest."""
    u = np.clip(np.arange(int(1.5 * fps) + 1) / fps * 2.0 - 1.0, 0.0, 1.0)
    smooth = u * u * (3.0 - 2.0 * u)
    return stepping(60.0 * smooth, 20.0 * np.sin(np.pi * u) ** 2, scale, fps)


def with_twist(clip: mc.Motion, parent: str, child: str, part: float) -> mc.Motion:
    """The clip with a joint more, this part of the way from a joint to one of its children, turning nothing."""
    skeleton = clip.skeleton
    above, below = skeleton.joint(parent), skeleton.joint(child)
    names = [*skeleton.names[:below], f"{parent}Twist", *skeleton.names[below:]]
    parents = [p + (p >= below) for p in skeleton.parents.tolist()]
    parents[below] = below
    parents.insert(below, above)
    offsets = np.insert(skeleton.offsets, below, part * skeleton.offsets[below], axis=0)
    offsets[below + 1] *= 1.0 - part
    channels = [*skeleton.channels[:below], ("Xrotation", "Yrotation", "Zrotation"), *skeleton.channels[below:]]
    ends = np.insert(skeleton.end_sites, below, False)
    at = int(np.argmax(skeleton.channel_joints >= below))
    values = np.insert(clip.values, [at] * 3, 0.0, axis=1)
    return replace(clip, skeleton=mc.Skeleton(names, parents, offsets, tuple(channels), ends), values=values)


def without(clip: mc.Motion, *joints: str) -> mc.Motion:
    """The clip without some joints and all that hangs on them."""
    skeleton = clip.skeleton
    gone = np.any([skeleton.below(skeleton.joint(name)) for name in joints], axis=0)
    place = np.cumsum(~gone) - 1
    kept = np.flatnonzero(~gone)
    body = mc.Skeleton(
        [skeleton.names[j] for j in kept],
        [place[p] if p >= 0 else -1 for p in skeleton.parents[kept]],
        skeleton.offsets[kept],
        tuple(skeleton.channels[j] for j in kept),
        skeleton.end_sites[kept],
    )
    return replace(clip, skeleton=body, values=clip.values[:, ~gone[skeleton.channel_joints]])
