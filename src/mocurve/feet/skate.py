"""How much feet slide while they should stand: the contacts are always those of the source, so that an edit cannot hide
a sliding foot by lifting it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np

from ..motion import Motion
from .contacts import LEAVING, Contact
from .legs import Leg, centimetres, tracks

LIFTED = 1.0  # cm away from the height of the contact: the same


@dataclass(frozen=True)
class Skate:
    """Means over all frames in contact, centimetres.

    speed:       over the ground, a second.
    drift:       the largest distance over the ground to the middle of the contact, mean over contacts.
    kept:        part of the frames in which the foot is slower than what ends a contact, and within 1 cm of the height
                 that it has in the source.
    penetration: how far the foot is below the height of its contact.
    floating:    how far above.
    """

    speed: float
    drift: float
    kept: float
    penetration: float
    floating: float

    def to_json(self) -> dict[str, float]:
        """The same as plain numbers."""
        return asdict(self)


def skate(
    motion: Motion,
    listed: Sequence[Contact],
    both: Sequence[Leg],
    source: Motion | None = None,
    speed: float = 15.0,
) -> Skate | None:
    """How feet slide in these contacts; None where there are no two frames of one. `source` is what the contacts were
    found in, by default the motion itself: heights in contact are compared with it. speed: as that of `contacts`.
    """
    scale = centimetres(motion)
    points = _points(motion, both)
    heights = points if source is None else _points(source, both)
    speeds, drifts, kept, away = [], [], [], []
    for contact in listed:
        span = slice(contact.first, contact.last + 1)
        track = scale * points[contact.joint][span]
        own = scale * heights[contact.joint][span, 1]
        steps = np.linalg.norm(np.diff(track[:, ::2], axis=0), axis=1) / motion.frame_time
        speeds.append(steps)
        middle = track[:, ::2].mean(axis=0)
        drifts.append(np.linalg.norm(track[:, ::2] - middle, axis=1).max())
        slow = np.append(steps, steps[-1:]) < LEAVING * speed if len(steps) else np.ones(1, bool)
        kept.append(slow & (np.abs(track[:, 1] - own) < LIFTED))
        away.append(track[:, 1] - own.mean())
    if not any(map(len, speeds)):
        return None
    above = np.concatenate(away)
    return Skate(
        speed=float(np.concatenate(speeds).mean()),
        drift=float(np.mean(drifts)),
        kept=float(np.concatenate(kept).mean()),
        penetration=float(np.maximum(-above, 0.0).mean()),
        floating=float(np.maximum(above, 0.0).mean()),
    )


def _points(motion: Motion, both: Sequence[Leg]) -> dict[str, np.ndarray]:
    """Places (F, 3) of every joint that a contact may name."""
    balls, heels = tracks(motion, both)
    names = motion.skeleton.names
    found = {names[leg.ankle]: heel for leg, heel in zip(both, heels, strict=True)}
    return found | {names[leg.ball]: ball for leg, ball in zip(both, balls, strict=True)}
