"""A person of thirteen joints that bends its knees and elbows, and the same person in a rig whose joints lie askew."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import mocurve as mc
from mocurve import kinematics, rotation

STEP = 1 / 100
TURNS = ("Zrotation", "Xrotation", "Yrotation")
PLACE = ("Xposition", "Yposition", "Zposition")
PARTS = [  # +x is the person's left, +y up, +z ahead; standing, arms hanging
    ("Hips", -1, (0, 95, 0)),
    ("Spine", 0, (0, 20, 0)),
    ("Head", 1, (0, 40, 2)),
    ("LeftArm", 1, (20, 30, 0)),
    ("LeftForeArm", 3, (0, -28, 0)),
    ("LeftHand", 4, (0, -25, 0)),
    ("RightArm", 1, (-20, 30, 0)),
    ("RightForeArm", 6, (0, -28, 0)),
    ("RightHand", 7, (0, -25, 0)),
    ("LeftUpLeg", 0, (10, -5, 0)),
    ("LeftLeg", 9, (0, -42, 0)),
    ("LeftFoot", 10, (0, -42, 0)),
    ("RightUpLeg", 0, (-10, -5, 0)),
    ("RightLeg", 12, (0, -42, 0)),
    ("RightFoot", 13, (0, -42, 0)),
]
KNEES, ELBOWS = ("LeftLeg", "RightLeg"), ("LeftForeArm", "RightForeArm")


def person(frames: int = 200, knee: np.ndarray | None = None) -> mc.Motion:
    """Knees and elbows bend by 10 to 70 degrees, the left knee as told (degrees); all else sways a little."""
    names, parents, offsets = zip(*PARTS, strict=True)
    kinds = tuple((*PLACE, *TURNS) if parent < 0 else TURNS for parent in parents)
    body = mc.Skeleton(names, parents, offsets, kinds, unit=0.01)
    time = np.arange(frames) * STEP
    values = 4.0 * np.sin(3.0 * time[:, None] + 1.7 * np.arange(body.channel_count))
    for name in (*KNEES, *ELBOWS):
        bend = 40.0 + 30.0 * np.sin(4.0 * time + len(name))
        bend = knee if name == "LeftLeg" and knee is not None else bend
        for kind in TURNS:
            values[:, body.channel(f"{name}.{kind}")] = 0.0
        values[:, body.channel(f"{name}.Xrotation")] = bend if name in KNEES else -bend
    return mc.Motion(body, values, STEP)


def askew(motion: mc.Motion, seed: int = 5) -> mc.Motion:
    """The same places at every frame, by joints whose axes lie anyhow."""
    body, dice = motion.skeleton, np.random.default_rng(seed)
    own = dice.normal(size=(len(body.names), 4))
    own /= np.linalg.norm(own, axis=1, keepdims=True)
    turned, offsets = kinematics.rotations(motion), body.offsets.copy()
    for joint, parent in enumerate(body.parents):
        above = own[parent] if parent >= 0 else np.array([1.0, 0.0, 0.0, 0.0])
        if parent >= 0:
            offsets[joint] = rotation.rotate(rotation.inv(above), body.offsets[joint])
        turned[:, joint] = rotation.mul(rotation.mul(rotation.inv(above), turned[:, joint]), own[joint])
    other = replace(motion, skeleton=replace(body, offsets=offsets))
    return kinematics.with_rotations(other, turned)
