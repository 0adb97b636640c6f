"""The verb `scale`: more or less of a displacement."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..keyed import HermiteCurve, KeyedMotion
from ..motion import Clip
from ._pair import check_mode, recorded
from ._weights import Rule, Weight, parse, told
from .add import mode_of
from .blend import MODES, between_clips


def scale(displacement: Clip, factor: Weight, *, mode: str | None = None) -> Clip:
    """So much of a displacement, as `difference` makes it: none at 0, all of it at 1, the way back at -1.

    Parameters
    ----------
    factor
        How much: 0.5, or changing in time, 0:0,2:1, or of some joints, '*Arm=2' (the others keep all of theirs).
    mode
        rotations: angles about the same axes are multiplied. curves, coefficients: as in blend. By default what the
        displacement's history says, else rotations.

    Errors: OptionError for a factor, UnknownName for a joint.

    >>> half_a_limp = mc.scale(mc.difference(limping, walking), 0.5)
    """
    rules = parse(factor, "factor")
    mode = mode_of(displacement) if mode is None else mode
    check_mode(mode, MODES)
    history = (*displacement.history, {"verb": "scale", "factor": told(rules), "mode": mode})
    others = Rule(None, np.zeros(1), np.ones(1))
    made = between_clips(_nothing(displacement), displacement, (others, *rules), mode, nearest=False)
    return recorded(made, history)


def _nothing(displacement: Clip) -> Clip:
    """A displacement of as many frames, keys or coefficients that does nothing."""
    if isinstance(displacement, KeyedMotion):
        curves = tuple(HermiteCurve(c.times, 0 * c.values, 0 * c.slopes) for c in displacement.curves)
        return replace(displacement, curves=curves)
    values = np.zeros(displacement.values.shape)  # type: ignore[attr-defined]
    return replace(displacement, values=values)  # type: ignore[type-var]
