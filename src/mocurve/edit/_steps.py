"""Feet held still while a motion is laid along a path: which contacts, which of them are let go, and what it took."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..errors import MocurveError
from ..feet.contacts import Contact, found
from ..feet.legs import Leg, centimetres, legs
from ..feet.skate import skate
from ..motion import Motion
from ._body import carried
from ._locking import held, source_of
from ._reach import Problem, Strain

RUNS = 220.0  # cm/s: faster bodies run
WALKING, RUNNING = 15.0, 45.0  # cm/s: slower feet come to stand
HEIGHT = 4.0  # cm above the floor that a standing foot may be
TRIES = 12  # times that contacts are let go
# cm and degrees: what is asked of a body beyond its usual limits is told; beyond these, contacts are let go instead
MOST = {"drop": 5.0, "shift": 7.0, "twist": 75.0, "miss": 2.0}
CHANGES = 1e-9  # of a carry from frame to frame: less is none


@dataclass(frozen=True)
class Steps:
    """Contacts of feet with the floor, and how they were kept; centimetres.

    contacts: of balls and heels in the clip. released: those let go because the body would be pulled out of shape.
    speed_own, speed_slid, speed: how fast balls slide in contact: in the clip, carried along the path, and held.
    drop, shift: how far the hips go down and aside for it at most.
    """

    contacts: int
    released: int
    speed_own: float
    speed_slid: float
    speed: float
    drop: float
    shift: float

    def __str__(self) -> str:
        gone = f"; {self.released} let go" if self.released else ""
        return (
            f"feet in {self.contacts} contacts{gone} slide {self.speed:.2f} cm/s, else {self.speed_slid:.2f} (in the "
            f"clip {self.speed_own:.2f}); the hips go down by up to {self.drop:.2g} cm and aside by {self.shift:.2g}"
        )

    def to_json(self) -> dict[str, Any]:
        """The same as plain numbers."""
        return asdict(self)


def stepping(base: Motion, carry: np.ndarray, speed: float) -> tuple[Motion, Steps | None]:
    """The motion carried by planar transforms (F, 3), its feet held in contact; None where no foot is changed or there
    are no legs, which is told by a warning.

    speed: of the body, file units a second. Feet that slide in the clip are held too, but only where its frames are not
    carried as one.
    """
    touched = _touched(carry)
    if not touched.any():
        return carried(base, carry), None
    try:
        both = legs(base)
        slow = RUNNING if speed * centimetres(base) > RUNS else WALKING
        listed = found(base, both, slow, HEIGHT)
        made, strain, released = _released(base, carry, listed, both, touched)
    except MocurveError as error:
        warnings.warn(f"feet are not held: {error}", stacklevel=4)
        return carried(base, carry), None
    if not listed:
        warnings.warn("feet are not held: no foot stands anywhere", stacklevel=4)
        return made, None
    names = {base.skeleton.names[leg.ball] for leg in both}
    balls = [contact for contact in listed if contact.joint in names]
    own, slid, now = (
        sliding.speed if sliding is not None else 0.0
        for sliding in (skate(clip, balls, both, base, slow) for clip in (base, carried(base, carry), made))
    )
    return made, Steps(len(listed), released, own, slid, now, strain.drop, strain.shift)


# -- in call order ---------------------------------------------------------------------------------


def _touched(carry: np.ndarray) -> np.ndarray:
    """(F,) frames that are carried otherwise than one beside them."""
    steps = np.abs(np.diff(carry, axis=0)) > CHANGES * (1.0 + np.abs(carry).max(axis=0, initial=0.0))
    moves = steps.any(axis=1)
    touched = np.zeros(len(carry), bool)
    touched[:-1] |= moves
    touched[1:] |= moves
    return touched


def _released(
    base: Motion, carry: np.ndarray, listed: Sequence[Contact], both: Sequence[Leg], touched: np.ndarray
) -> tuple[Motion, Strain, int]:
    """The motion with its feet held in as many contacts as its body allows, and how many it does not."""
    kept = list(listed)
    worst: Problem | None = None
    for _ in range(TRIES):
        made, strain = held(source_of(base, kept, both, touched), carry)
        worst = worst or (strain.problems[0] if strain.problems else None)
        bad = {
            c
            for problem in strain.problems
            if problem.value > MOST.get(problem.kind, np.inf)
            for c in _at(problem, kept)
        }
        if not bad:
            break
        kept = [contact for contact in kept if contact not in bad]
    gone = len(listed) - len(kept)
    if worst is not None:
        warnings.warn(
            f"the path asks much of the legs: {worst.sentence(base.frame_time)}"
            + (f"; {gone} of {len(listed)} contacts are let go" if gone else ""),
            stacklevel=5,
        )
    return made, strain, gone


def _at(problem: Problem, listed: Sequence[Contact]) -> list[Contact]:
    """The contacts during a problem, or else the nearest ones."""
    away = [max(contact.first - problem.last, problem.first - contact.last, 0) for contact in listed]
    return [contact for contact, frames in zip(listed, away, strict=True) if frames == min(away)]
