"""How much feet slide while they should stand, by every measure that is in use.

Contacts and the floor are always those of the source, so that an edit cannot hide a sliding foot by lifting it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d

from ..motion import Motion
from .contacts import LEAVING, Contact
from .legs import Leg, centimetres, tracks

FLOOR = 5.0  # percent of the frames of a point are lower than its floor
LIFTED = 1.0  # cm away from the height of the contact: the same
RATIO_RATE, RATIO_LOW, RATIO_FAST, RATIO_MEAN = 20.0, 5.0, 50.0, 5  # frames a second, cm, cm/s, frames
WEIGHED = 2.5  # cm above the floor at which sliding no longer counts
TOUCHES = 1.0  # cm above its floor: a point that touches it
NEAR, CALM = 5.0, 10.0  # cm above the floor and cm/s up or down: a point of the sole that rests


@dataclass(frozen=True)
class Skate:
    """How feet slide; centimetres, and everything over the ground. Means over all frames in contact:

    speed, speed_p95: a second, and the 95th percentile of that; step: the mean in millimetres a frame.
    drift:       the largest distance to the middle of the contact, mean over contacts.
    kept:        part of the frames in which the foot is slower than what ends a contact, and within 1 cm of the height
                 that it has in the source.
    penetration: how far the foot is below the height of its contact.
    floating:    how far above.

    Without contacts, as others measure, heights counted from the floor of each point in the source (5 % of its frames
    are lower):

    ratio:    part of the frames, 20 a second, in which a ball that is lower than 5 cm before and after goes faster than
              50 cm/s, now and over five frames (Karunratanakul et al. 2023, Guided motion diffusion).
    weighed:  a second, of the balls, times 2 - 2^(h / 2.5 cm), h the height up to 2.5 cm: what is lifted counts less
              (Zhang et al. 2018, Mode-adaptive neural networks); mean over all frames.
    touching: millimetres a frame, of balls and heels within 1 cm of the floor before and after (as Yuan et al. 2023,
              PhysDiff, have it for vertices); None where nothing touches it.
    sole:     a second, of balls and heels lower than 5 cm that rise or sink by less than 10 cm/s; None where none does.
    """

    speed: float
    speed_p95: float
    step: float
    drift: float
    kept: float
    penetration: float
    floating: float
    ratio: float
    weighed: float
    touching: float | None
    sole: float | None

    def to_json(self) -> dict[str, float | None]:
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
    found in, by default the motion itself: heights are compared with it. speed: as that of `contacts`.
    """
    scale, names = centimetres(motion), motion.skeleton.names
    points = scale * np.stack(tracks(motion, both))  # (2, legs, F, 3), balls and heels
    own = points if source is None else scale * np.stack(tracks(source, both))
    rows = {names[leg.ankle]: (1, i) for i, leg in enumerate(both)} | {
        names[leg.ball]: (0, i) for i, leg in enumerate(both)
    }
    speeds, drifts, kept, away = [], [], [], []
    for contact in listed:
        span = slice(contact.first, contact.last + 1)
        track, height = points[rows[contact.joint]][span], own[rows[contact.joint]][span, 1]
        steps = _steps(track) / motion.frame_time
        speeds.append(steps)
        drifts.append(np.linalg.norm(track[:, ::2] - track[:, ::2].mean(axis=0), axis=1).max())
        slow = np.append(steps, steps[-1:]) < LEAVING * speed if len(steps) else np.ones(1, bool)
        kept.append(slow & (np.abs(track[:, 1] - height) < LIFTED))
        away.append(track[:, 1] - height.mean())
    if not any(map(len, speeds)):
        return None
    above, paces = np.concatenate(away), np.concatenate(speeds)
    over = points.copy()
    over[..., 1] -= np.percentile(own[..., 1], FLOOR, axis=-1)[..., None]
    return Skate(
        speed=float(paces.mean()),
        speed_p95=float(np.percentile(paces, 95)),
        step=float(10.0 * paces.mean() * motion.frame_time),
        drift=float(np.mean(drifts)),
        kept=float(np.concatenate(kept).mean()),
        penetration=float(np.maximum(-above, 0.0).mean()),
        floating=float(np.maximum(above, 0.0).mean()),
        ratio=_ratio(over[0], motion.frame_time),
        weighed=_weighed(over[0], motion.frame_time),
        touching=_touching(over),
        sole=_sole(over, motion.frame_time),
    )


# -- in call order ---------------------------------------------------------------------------------
# tracks (..., F, 3) of points, cm, heights from the floor


def _steps(track: np.ndarray) -> np.ndarray:
    """(..., F - 1) how far points go over the ground."""
    return np.linalg.norm(np.diff(track[..., ::2], axis=-2), axis=-1)


def _ratio(balls: np.ndarray, frame_time: float) -> float:
    rate = min(RATIO_RATE, 1.0 / frame_time)  # slower clips as they are
    last = balls.shape[1] - 1.0
    at = np.minimum(np.arange(int(last * frame_time * rate + 1e-9) + 1) / (rate * frame_time), last)
    if len(at) < 2:
        return 0.0
    whole = np.minimum(at.astype(np.int64), balls.shape[1] - 2)
    part = (at - whole)[:, None]
    seen = (1.0 - part) * balls[:, whole] + part * balls[:, whole + 1]
    low = (seen[:, 1:, 1] < RATIO_LOW) & (seen[:, :-1, 1] < RATIO_LOW)
    pace = _steps(seen) * rate
    mean = uniform_filter1d(pace, RATIO_MEAN, axis=1, mode="constant")
    return float((low & (pace > RATIO_FAST) & (mean > RATIO_FAST)).any(axis=0).mean())


def _weighed(balls: np.ndarray, frame_time: float) -> float:
    counts = 2.0 - 2.0 ** np.clip(balls[:, 1:, 1] / WEIGHED, 0.0, 1.0)
    return float((_steps(balls) * counts).mean()) / frame_time


def _touching(points: np.ndarray) -> float | None:
    low = points[..., 1] < TOUCHES
    both = low[..., 1:] & low[..., :-1]
    return float(10.0 * _steps(points)[both].mean()) if both.any() else None


def _sole(points: np.ndarray, frame_time: float) -> float | None:
    rises = np.abs(np.diff(points[..., 1], axis=-1)) / frame_time
    rests = (rises < CALM) & (points[..., 1:, 1] < NEAR)
    return float(_steps(points)[rests].mean() / frame_time) if rests.any() else None
