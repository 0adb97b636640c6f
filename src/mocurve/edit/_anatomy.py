"""Knees, elbows, hips and shoulders, found by name, and what those of people can do.

The ranges are those that the American Academy of Orthopaedic Surgeons gives as normal (Joint Motion: Method of
Measuring and Recording, Chicago 1965), with cones around the directions that its hip and shoulder reach, and an
allowance. Knees and elbows do not bend backwards.
"""

from __future__ import annotations

import re

import numpy as np

from .. import kinematics, rotation
from ..motion import Motion
from ._ranges import Ball, Hinge, Limit

SIDES = {"left": 1, "l": 1, "lft": 1, "right": -1, "r": -1, "rgt": -1}
KNEES = {"knee", "shin", "tibia", "calf", "lowerleg", "loleg"}
THIGHS = {"upleg", "upperleg", "thigh", "femur", "hip"}
ELBOWS = {"elbow", "forearm", "lowerarm", "loarm", "radius", "ulna"}
NOISE = {"bip", "b", "def", "jnt", "joint", "bone", "bind"}
WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")

ALLOWANCE = 15.0  # degrees beyond what is normal: norms are no extremes, and directions are told from joints, not bones
FLEXION = {"knee": (0.0, 135.0 + ALLOWANCE), "elbow": (0.0, 150.0 + ALLOWANCE)}
# the middle of a cone as (to the limb's own side, up, ahead), and degrees from there: the smallest cones that hold a
# hip bent by 120 and stretched by 30, an arm raised by 180, stretched by 60 and brought across by 130
CONES = {"knee": ((0.0, -1.0, 1.0), 75.0 + ALLOWANCE), "elbow": ((2.105, -0.577, 1.0), 104.0 + ALLOWANCE)}
TWISTS = {"knee": 45.0 + ALLOWANCE, "elbow": 90.0 + ALLOWANCE}
SOURCE = f"ranges of people (AAOS 1965, and {ALLOWANCE:g} degrees more)"
BENT = np.sin(np.radians(5.0))  # mean over the frames; a joint that bends less does not show its axis
ONE_WAY = 0.7  # of all bending; less goes now one way and now another, which is no hinge


def part_of(name: str) -> tuple[str, int]:
    """What a joint is called without its side, and the side: 1 left, -1 right, 0 not said."""
    words = [word.lower() for word in WORD.findall(re.split(r"[:|]", name)[-1])]
    sides = [SIDES[word] for word in words if word in SIDES]
    part = "".join(word for word in words if word not in SIDES and word not in NOISE)
    if not sides and part[:1] in SIDES and part[1:] in KNEES | ELBOWS:  # Acclaim: ltibia
        return part[1:], SIDES[part[0]]
    return part, sides[0] if sides else 0


def hinges(skeleton_names: tuple[str, ...], parents: np.ndarray) -> dict[int, tuple[str, int]]:
    """{joint: ("knee" or "elbow", side)} of those that are called so."""
    found = {}
    for joint, name in enumerate(skeleton_names):
        part, side = part_of(name)
        above = part_of(skeleton_names[parents[joint]])[0] if parents[joint] >= 0 else ""
        if part in KNEES or (part == "leg" and above in THIGHS):
            found[joint] = ("knee", side)
        elif part in ELBOWS:
            found[joint] = ("elbow", side)
    return {joint: kind for joint, kind in found.items() if parents[joint] >= 0 and kind[1]}


def of_people(motion: Motion) -> tuple[list[Limit], list[str]]:
    """Limits of the joints that are recognised, and a line for each that is but cannot be limited.

    A hinge's axis is that about which it bends on the whole; bending back does not change it. Up, to the side and ahead
    are where the middle of both shoulders lies from that of the hips, and the joint of the other side, on the mean over
    the clip, as the joint above sees it. None of this hangs on the pose at rest.
    """
    skeleton = motion.skeleton
    found: list[Limit] = []
    lost: list[str] = []
    offsets = kinematics.rest_offsets(motion)
    called = hinges(skeleton.names, skeleton.parents)
    made: dict[int, Hinge] = {}
    for joint, (kind, _) in called.items():
        hinge = _hinge(motion, offsets, joint, kind)
        if isinstance(hinge, Hinge):
            found.append(hinge)
            made[joint] = hinge
        else:
            lost.append(f"{skeleton.names[joint]}: {hinge}")
    balls, why = _balls(motion, offsets, called, made)
    return [*found, *balls], [*lost, *why]


# -- in call order ---------------------------------------------------------------------------------


def _hinge(motion: Motion, offsets: np.ndarray, joint: int, kind: str) -> Hinge | str:
    """The hinge, or why it is none."""
    skeleton = motion.skeleton
    columns, order = skeleton.eulers[joint]
    children = np.flatnonzero(skeleton.parents == joint)
    if not order or not len(children) or not offsets[joint].any() or not offsets[children].any():
        return "has no rotation channels, or no bone on one side"
    tip = max(offsets[children], key=np.linalg.norm)
    bone, tip = offsets[joint] / np.linalg.norm(offsets[joint]), tip / np.linalg.norm(tip)
    turned = rotation.from_euler(motion.values[:, columns], order)
    bends = np.cross(bone, rotation.rotate(turned, tip))
    total, size = bends.sum(axis=0), np.linalg.norm(bends, axis=1).sum()
    along = np.linalg.norm(total)
    if not along > BENT * motion.frames:
        return "bends too little in this clip to tell about which axis"
    if along < ONE_WAY * size:
        return "bends now one way, now another: no hinge"
    axis = total / along
    if len(order) < 3:
        own = np.eye(3)["XYZ".index(order[0])]
        axis = own * np.sign(own @ axis)
        if not abs(own @ total) > ONE_WAY * along:
            return f"its channels ({order}) do not turn it about the axis that it bends about"
    low, high = (np.array([end]) for end in FLEXION[kind])
    return Hinge((f"{skeleton.names[joint]}.flexion",), columns, order, low, high, bone, tip, axis)


def _balls(
    motion: Motion, offsets: np.ndarray, called: dict[int, tuple[str, int]], made: dict[int, Hinge]
) -> tuple[list[Limit], list[str]]:
    """Hips and shoulders: the joints right above knees and elbows."""
    skeleton = motion.skeleton
    below = {kind: joint for joint, kind in called.items()}
    pairs = [(part, side) for part in ("knee", "elbow") for side in (1, -1)]
    if len(called) != 4 or set(below) != set(pairs) or not motion.frames:
        return [], ["hips and shoulders: both knees and both elbows are needed, one of each, to tell up and ahead"]
    places, above = kinematics.world(motion), _above(motion, [skeleton.parents[below[pair]] for pair in pairs])
    ball = {pair: int(skeleton.parents[below[pair]]) for pair in pairs}
    shoulders, hips = (places[:, ball[part, 1]] + places[:, ball[part, -1]] for part in ("elbow", "knee"))
    up = shoulders - hips
    found: list[Limit] = []
    lost = []
    for part, side in pairs:
        joint, hinge = below[part, side], made.get(below[part, side])
        name, (columns, order) = skeleton.names[ball[part, side]], skeleton.eulers[ball[part, side]]
        left = places[:, ball[part, 1]] - places[:, ball[part, -1]]
        frame = above[ball[part, side]]
        axes = _axes(*(rotation.rotate(rotation.inv(frame), way).mean(axis=0) for way in (left, up)))
        if hinge is None or axes is None or len(order) < 3:
            lost.append(
                f"{name}: " + ("has fewer than three rotation channels" if len(order) < 3 else "no axis below it")
            )
            continue
        side_way, up_way, ahead = side * axes[0], axes[1], axes[2]
        middle, wide = CONES[part]
        centre = np.array(middle) @ np.stack([side_way, up_way, ahead])
        centre /= np.linalg.norm(centre)
        bends_about = axes[0] if part == "knee" else -axes[0]  # hanging down, knees bend back and elbows ahead
        zero = rotation.rotate(_turn(-up_way, centre), bends_about)
        low, high = np.array([-np.inf, -TWISTS[part]]), np.array([wide, TWISTS[part]])
        limb = offsets[joint] / np.linalg.norm(offsets[joint])
        names = (f"{name}.swing", f"{name}.twist")
        found.append(Ball(names, columns, order, low, high, limb, hinge.axis, centre, zero))
    return found, lost


def _above(motion: Motion, joints: list[int]) -> dict[int, np.ndarray]:
    """{joint: (F, 4)} how the joint above each of these is turned in the world."""
    parents, local = motion.skeleton.parents, kinematics.rotations(motion)
    found = {}
    for joint in joints:
        turned = np.broadcast_to(np.array([1.0, 0.0, 0.0, 0.0]), (motion.frames, 4))
        above = parents[joint]
        while above >= 0:
            turned = rotation.mul(local[:, above], turned)
            above = parents[above]
        found[int(joint)] = turned
    return found


def _axes(left: np.ndarray, up: np.ndarray) -> np.ndarray | None:
    """(3, 3) rows: left, up and ahead, at right angles; None where they cannot be told."""
    up = up / max(np.linalg.norm(up), 1e-300)
    left = left - (left @ up) * up
    size = np.linalg.norm(left)
    if not size > 1e-6 or not np.isfinite(size):
        return None
    left = left / size
    return np.stack([left, up, np.cross(left, up)])


def _turn(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """(4,) the shortest rotation from one direction to another."""
    q = np.concatenate([[1.0 + start @ end], np.cross(start, end)])
    return q / np.linalg.norm(q)
