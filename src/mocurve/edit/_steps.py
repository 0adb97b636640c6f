"""Feet held still while a motion is laid along a path: which contacts, which of them are let go, and what it took."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from .. import planar
from ..errors import MocurveError, OptionError
from ..feet.contacts import Contact, found, slowness
from ..feet.legs import Leg, centimetres, legs
from ..kinematics import world
from ..motion import Motion
from ._body import carried
from ._locking import held, source_of
from ._reach import Problem, Strain

HEIGHT = 4.0  # cm above the floor that a standing foot may be
NEAR = 5.0  # seconds around what is touched in which feet and the floor are looked for
SHORT = 1.0  # seconds: it is no wonder if in less no foot stands
TRIES = 12  # times that contacts are let go
# cm and degrees: what is asked of a body beyond its usual limits is told; beyond these, contacts are let go instead
MOST = {"drop": 5.0, "shift": 7.0, "twist": 75.0, "miss": 2.0}
CHANGES = 1e-9  # of a carry from frame to frame: less is none


@dataclass(frozen=True)
class Steps:
    """Contacts of feet with the floor, and how they were kept; centimetres.

    contacts: of balls and heels, where the path changes the clip. released: those let go, because the body would be
    pulled out of shape.
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

    @classmethod
    def of(cls, parts: Sequence[Steps | None]) -> Steps | None:
        """The numbers of several parts of a motion as one; None where no feet were held in any."""
        some = [part for part in parts if part is not None]
        if len(some) < 2:
            return some[0] if some else None
        weights = [max(part.contacts, 1e-9) for part in some]
        means = {
            name: float(np.average([getattr(part, name) for part in some], weights=weights))
            for name in ("speed_own", "speed_slid", "speed")
        }
        return cls(
            contacts=sum(part.contacts for part in some),
            released=sum(part.released for part in some),
            **means,
            drop=max(part.drop for part in some),
            shift=max(part.shift for part in some),
        )

    def to_json(self) -> dict[str, Any]:
        """The same as plain numbers."""
        return asdict(self)


def stepping(base: Motion, carry: np.ndarray, first: int) -> tuple[Motion, Steps | None]:
    """The motion carried by planar transforms (F, 3), its feet held in contact; None where no foot is changed or there
    are no legs, which is told by a warning.

    first: the frame of the result that the motion begins with. Feet that slide in the clip are held too, but only where
    its frames are not carried as one.
    """
    touched, plain = _touched(carry), carried(base, carry)
    if not touched.any():
        return plain, None
    some, near = np.flatnonzero(touched), round(NEAR / base.frame_time)
    span = slice(max(int(some[0]) - near, 0), int(some[-1]) + near + 1)
    part, moves, touched = base[span], carry[span], touched[span]
    try:
        both = legs(part)
        listed = found(part, both, slowness(part), HEIGHT)
        if not listed and base.duration > SHORT:
            raise OptionError("no foot stands anywhere")
        made, strain, released = _released(part, moves, listed, both, touched, first + span.start)
    except MocurveError as error:
        reason = str(error).split(";")[0]  # without options that are another verb's
        warnings.warn(f"feet are not held: {reason}", stacklevel=4)
        return plain, None
    values = np.array(plain.values, order="F")
    values[span] = made.values
    met = [contact for contact in listed if touched[contact.first : contact.last + 1].any()]
    own, slid, now = _sliding(part, moves, made, met, both)
    return replace(plain, values=values), Steps(len(met), released, own, slid, now, strain.drop, strain.shift)


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
    base: Motion, carry: np.ndarray, listed: Sequence[Contact], both: Sequence[Leg], touched: np.ndarray, first: int
) -> tuple[Motion, Strain, int]:
    """The motion, which begins at a frame `first`, with its feet held in as many contacts as its body allows, and how
    many it does not."""
    kept = list(listed)
    worst: Problem | None = None
    for _ in range(TRIES):
        made, strain = held(source_of(base, kept, both, touched), carry)
        worst = worst or (strain.later(first).problems[0] if strain.problems else None)
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


def _sliding(
    base: Motion, carry: np.ndarray, made: Motion, listed: Sequence[Contact], both: Sequence[Leg]
) -> list[float]:
    """How fast balls slide in contact, cm/s, mean over all frames: in the clip, carried, and held."""
    balls = [leg.ball for leg in both]
    columns = {base.skeleton.names[ball]: column for column, ball in enumerate(balls)}
    places = world(base)[:, balls]
    scale, told = centimetres(base) / base.frame_time, []
    for track in (places, planar.move(carry[:, None], places), world(made)[:, balls]):
        steps = [
            np.linalg.norm(np.diff(track[c.first : c.last + 1, columns[c.joint]][:, [0, 2]], axis=0), axis=1)
            for c in listed
            if c.joint in columns
        ]
        told.append(scale * float(np.concatenate(steps).mean()) if any(map(len, steps)) else 0.0)
    return told
