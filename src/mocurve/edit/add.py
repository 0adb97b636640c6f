"""The verb `add`: a displacement put onto a clip."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from .. import kinematics, rotation
from ..keyed import HermiteCurve
from ..motion import Clip, Motion, unroll
from ..spline import SplineMotion, align
from ._pair import check, check_mode, recorded, same_curves, side_by_side, tell_sampled
from ._turns import free_joints
from .difference import MODES


def add(displacement: Clip, clip: Clip, *, mode: str | None = None, match: str = "exact") -> Clip:
    """A displacement, as `difference` makes it, put onto a clip: each joint is turned by it in its own frame.

    Parameters
    ----------
    mode
        rotations or curves: how the displacement was made. By default what its history says, else rotations.
    match
        exact: both have the same joints and channels. names: joints are found by name, others are not displaced.

    Errors: Mismatch naming the first difference of the skeletons, or the lengths where they differ.

    >>> limping_run = mc.add(mc.difference(limping, walking), run)
    """
    mode = mode_of(displacement) if mode is None else mode
    check_mode(mode, MODES)
    step = {"verb": "add", "mode": mode, "match": match, "with": list(displacement.history)}
    history = (*clip.history, step)
    if mode == "curves" and same_curves((clip, displacement)):
        check(clip.skeleton, displacement.skeleton, match)
        return recorded(_of_curves(clip, displacement), history)
    keys_lost = "joints turn frame by frame (mode curves keeps keys)"
    tell_sampled((clip, displacement), keys_lost if mode == "rotations" else "both clips must be keys, or both splines")
    base, by, had = side_by_side(clip, displacement, match, "add")
    by = replace(by, values=np.where(had, by.values, 0.0))
    touched = by.values.any(axis=0)
    moved = unroll(base).values + unroll(by).values
    made = replace(base, values=np.where(touched, moved, base.values), history=history, report=None)
    return _turned(made, base, by) if mode == "rotations" else made


def mode_of(displacement: Clip) -> str:
    """How a displacement was made, as far as its history says."""
    made = [step for step in displacement.history if step.get("verb") == "difference"]
    return str(made[-1].get("mode", MODES[0])) if made else MODES[0]


# -- in call order ---------------------------------------------------------------------------------


def _of_curves(clip: Any, by: Any) -> Clip:
    """Two clips of keys, or two splines."""
    base, moved = align(clip, by)
    if isinstance(base, SplineMotion):
        return replace(base, values=base.values + moved.values)
    return replace(base, curves=tuple(_sum(x, y) for x, y in zip(base.curves, moved.curves, strict=True)))


def _sum(a: HermiteCurve, b: HermiteCurve) -> HermiteCurve:
    """Two curves with keys at the same times."""
    if not len(a) or not len(b):
        return a
    return HermiteCurve(a.times, a.values + b.values, a.slopes + b.slopes, a.in_slopes + b.in_slopes)


def _turned(made: Motion, base: Motion, by: Motion) -> Motion:
    """The joints that can express any rotation turned by theirs; one that is not displaced keeps its channels."""
    before, more = kinematics.rotations(base), kinematics.rotations(by)
    values = np.array(made.values, order="F")
    turned = kinematics.rotations(made)
    for joint, columns, _ in free_joints(made.skeleton):
        values[:, columns] = base.values[:, columns]
        turned[:, joint] = rotation.mul(before[:, joint], more[:, joint])
    return kinematics.with_rotations(replace(made, values=values), turned)
