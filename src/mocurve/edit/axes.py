"""The verb `axes`: a clip whose file has another axis up than y, turned to y up, and back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .. import rotation
from ..errors import UnknownName
from ..keyed import HermiteCurve, KeyedMotion
from ..motion import Clip
from ..skeleton import AXES, JointLimits, Skeleton
from ._pair import recorded


def axes(clip: Clip, *, up: str = "z", to: str = "y") -> Clip:
    """The clip turned as a whole, body and rest pose, by a quarter about one axis, so that another one points up.

    Parameters
    ----------
    up
        The axis that points up in the clip: x, y or z.
    to
        The axis that then does; `follow`, `contacts` and `lock_feet` want y.

    With the defaults x stays, z becomes y, and y becomes -z. Nothing is computed but signs: channels get the names of
    other axes (a rotation order ZXY becomes YXZ), so keys and splines stay what they are, and the way back, up="y",
    to="z", gives every digit back. UnknownName for an axis that is none.

    >>> walk = mc.axes(mc.read("z_up.bvh"))
    """
    for name in (up, to):
        if name not in tuple(AXES.lower()):
            raise UnknownName("axis", name, tuple(AXES.lower()))
    goes, sign = _turn(AXES.lower().index(up), AXES.lower().index(to))
    skeleton, columns, signs = _channels(clip.skeleton, goes, sign)
    if isinstance(clip, KeyedMotion):
        curves = tuple(_signed(clip.curves[column], s) for column, s in zip(columns, signs.tolist(), strict=True))
        made: Clip = replace(clip, skeleton=skeleton, curves=curves, report=None)
    else:  # samples or coefficients
        values = clip.values[:, columns] * signs  # type: ignore[attr-defined]
        made = replace(clip, skeleton=skeleton, values=values, report=None)  # type: ignore[type-var]
    return recorded(made, (*clip.history, {"verb": "axes", "up": up, "to": to}))


# -- in call order ---------------------------------------------------------------------------------


def _turn(up: int, to: int) -> tuple[np.ndarray, np.ndarray]:
    """Which axis (3,) each axis becomes, and with which sign (3,): a turn that takes one axis to another."""
    goes, sign = np.arange(3), np.ones(3)
    goes[[up, to]] = to, up
    if up != to:
        sign[to] = -1.0
    return goes, sign


def _channels(skeleton: Skeleton, goes: np.ndarray, sign: np.ndarray) -> tuple[Skeleton, np.ndarray, np.ndarray]:
    """The turned skeleton, and of each of its channels the column (C,) that it was, and its sign (C,)."""
    columns: list[int] = []
    kinds: list[tuple[str, ...]] = []
    first = 0
    for own in skeleton.channels:
        named = [AXES[goes[AXES.index(kind[0])]] + kind[1:] for kind in own]
        places = [i for i, kind in enumerate(own) if kind.endswith("position")]
        order = list(range(len(own)))
        if sorted(named[i] for i in places) == sorted(own[i] for i in places):  # their order stays as well
            for place in places:
                order[place] = named.index(own[place])
        columns += [first + i for i in order]
        kinds.append(tuple(named[i] for i in order))
        first += len(own)
    turn = np.zeros((3, 3))
    turn[goes, np.arange(3)] = sign
    found = np.array(columns, np.int64)
    limits = tuple(_limits(one, goes, sign, turn) for one in skeleton.limits)
    made = replace(skeleton, offsets=skeleton.offsets @ turn.T, channels=tuple(kinds), limits=limits)
    return made, found, sign[skeleton.channel_axes[found]] if len(found) else np.ones(0)


def _limits(limits: JointLimits, goes: np.ndarray, sign: np.ndarray, turn: np.ndarray) -> JointLimits:
    """The same limits, about axes that are turned with the body."""
    about = [AXES.index(axis) for axis in limits.order]
    low, high = limits.low * sign[about], limits.high * sign[about]
    across = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])  # 2 sin of it
    quarter = rotation.exp(0.25 * np.pi * across)
    own = rotation.mul(rotation.mul(quarter, limits.axes), rotation.inv(quarter))
    order = "".join(AXES[goes[axis]] for axis in about)
    return JointLimits(limits.joint, own, order, np.minimum(low, high), np.maximum(low, high))


def _signed(curve: HermiteCurve, sign: float) -> HermiteCurve:
    slopes = sign * curve.slopes
    return HermiteCurve(curve.times, sign * curve.values, slopes, sign * curve.in_slopes if curve.broken else slopes)
