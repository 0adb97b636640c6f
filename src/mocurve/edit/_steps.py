"""Feet held still while a motion is laid along a path: which contacts, which of them are let go, and what it took."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from .. import planar
from ..errors import MocurveError, OptionError
from ..feet.contacts import Contact, found
from ..feet.legs import Leg, centimetres, legs
from ..kinematics import world
from ..motion import Motion
from ._body import carried
from ._locking import held, source_of
from ._reach import Problem, Strain

RUNS = 220.0  # cm/s: faster bodies run
WALKING, RUNNING = 15.0, 45.0  # cm/s: slower feet come to stand
HEIGHT = 4.0  # cm above the floor that a standing foot may be
NEAR = 2.5  # seconds around what is touched that are looked at
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
        if not listed:
            if base.duration > SHORT:
                raise OptionError("no foot stands anywhere")
            return carried(base, carry), None
        part = _part(touched, listed, base.frame_time)
        inside = [
            replace(contact, first=contact.first - part.start, last=contact.last - part.start)
            for contact in listed
            if part.start <= contact.first and contact.last < part.stop
        ]
        made, strain, released = _released(base[part], carry[part], inside, both, touched[part])
    except MocurveError as error:
        reason = str(error).split(";")[0]  # without options that are another verb's
        warnings.warn(f"feet are not held: {reason}", stacklevel=4)
        return carried(base, carry), None
    plain = carried(base, carry)
    values = np.array(plain.values, order="F")
    values[part] = made.values
    met = [contact for contact in inside if touched[part][contact.first : contact.last + 1].any()]
    return replace(plain, values=values), Steps(
        contacts=len(met),
        released=released,
        **_sliding(base[part], carry[part], made, met, both),
        drop=strain.drop,
        shift=strain.shift,
    )


# -- in call order ---------------------------------------------------------------------------------


def _touched(carry: np.ndarray) -> np.ndarray:
    """(F,) frames that are carried otherwise than one beside them."""
    steps = np.abs(np.diff(carry, axis=0)) > CHANGES * (1.0 + np.abs(carry).max(axis=0, initial=0.0))
    moves = steps.any(axis=1)
    touched = np.zeros(len(carry), bool)
    touched[:-1] |= moves
    touched[1:] |= moves
    return touched


def _part(touched: np.ndarray, listed: Sequence[Contact], frame_time: float) -> slice:
    """The frames that holding feet has to do with: those that are touched, what is near, and whole contacts."""
    near = round(NEAR / frame_time)
    some = np.flatnonzero(touched)
    first, last = max(int(some[0]) - near, 0), min(int(some[-1]) + near, len(touched) - 1)
    cut = [contact for contact in listed if contact.first <= last and first <= contact.last]
    return slice(min([first, *(c.first for c in cut)]), max([last, *(c.last for c in cut)]) + 1)


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


def _sliding(
    base: Motion, carry: np.ndarray, made: Motion, listed: Sequence[Contact], both: Sequence[Leg]
) -> dict[str, float]:
    """How fast balls slide in contact, mean over all frames: in the clip, carried, and held."""
    balls = {base.skeleton.names[leg.ball]: leg.ball for leg in both}
    places = world(base)[:, list(balls.values())]
    tracks = places, planar.move(carry[:, None], places), world(made)[:, list(balls.values())]
    columns = {name: column for column, name in enumerate(balls)}
    scale, told = centimetres(base) / base.frame_time, {}
    for name, track in zip(("speed_own", "speed_slid", "speed"), tracks, strict=True):
        steps = [
            np.linalg.norm(np.diff(track[c.first : c.last + 1, columns[c.joint]][:, [0, 2]], axis=0), axis=1)
            for c in listed
            if c.joint in columns
        ]
        told[name] = scale * float(np.concatenate([*steps, np.zeros(0)]).mean()) if any(map(len, steps)) else 0.0
    return told
