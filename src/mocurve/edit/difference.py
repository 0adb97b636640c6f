"""The verb `difference`: the displacement from one clip to another (Lee and Shin 1999; Bruderlin and Williams 1995)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from .. import kinematics, rotation
from ..keyed import HermiteCurve
from ..motion import Clip, Motion, unroll
from ..spline import SplineMotion, align
from ._pair import check, check_mode, recorded, same_curves, side_by_side, tell_sampled, whole_turns
from ._turns import free_joints

MODES = ("rotations", "curves")


def difference(a: Clip, b: Clip, *, mode: str = "rotations", match: str = "exact") -> Clip:
    """What is to be added to b to get a: a displacement, itself a clip. add(difference(a, b), b) is a.

    Parameters
    ----------
    mode
        rotations: each joint's displacement is a rotation in its own frame, which turns b into a; keys and splines
        become samples. curves: channel by channel, keys stay keys and splines stay splines.
    match
        exact: both have the same joints and channels. names: joints are found by name, others are not displaced.

    Rotation channels hold the displacement's angles in each joint's own order, position channels the difference of
    places. Errors: Mismatch naming the first difference of the skeletons, or the lengths where they differ.

    >>> limp = mc.difference(limping, walking)
    """
    check_mode(mode, MODES)
    history = (*a.history, {"verb": "difference", "mode": mode, "match": match, "with": list(b.history)})
    if mode == "curves" and same_curves((a, b)):
        check(a.skeleton, b.skeleton, match)
        return recorded(_of_curves(a, b), history)
    keys_lost = "joints turn frame by frame (mode curves keeps keys)"
    tell_sampled((a, b), keys_lost if mode == "rotations" else "both clips must be keys, or both splines")
    first, second, had = side_by_side(a, b, match, "difference")
    smooth = [unroll(clip).values for clip in (first, second)]
    apart = smooth[0] - smooth[1]
    apart -= np.where(first.skeleton.rotation_channels, whole_turns(apart), 0.0)
    made = replace(first, values=np.where(had, apart, 0.0), history=history, report=None)
    return _turned(made, first, second, had) if mode == "rotations" else made


# -- in call order ---------------------------------------------------------------------------------


def _of_curves(a: Any, b: Any) -> Clip:
    """Two clips of keys, or two splines."""
    first, second = align(a, b)
    if isinstance(first, SplineMotion):
        return replace(first, values=first.values - second.values)
    return replace(first, curves=tuple(_apart(x, y) for x, y in zip(first.curves, second.curves, strict=True)))


def _apart(a: HermiteCurve, b: HermiteCurve) -> HermiteCurve:
    """Two curves with keys at the same times."""
    if not len(a) or not len(b):
        return a
    return HermiteCurve(a.times, a.values - b.values, a.slopes - b.slopes, a.in_slopes - b.in_slopes)


def _turned(made: Motion, first: Motion, second: Motion, had: np.ndarray) -> Motion:
    """The joints that can express any rotation hold the one that turns second into first."""
    after, before = kinematics.rotations(first), kinematics.rotations(second)
    values = np.array(made.values, order="F")
    turned = kinematics.rotations(made)
    for joint, columns, _ in free_joints(made.skeleton):
        values[:, columns] = 0.0
        turned[:, joint] = [1.0, 0.0, 0.0, 0.0]
        if had[columns[0]]:
            turned[:, joint] = rotation.mul(rotation.inv(before[:, joint]), after[:, joint])
    return kinematics.with_rotations(replace(made, values=values), turned)
