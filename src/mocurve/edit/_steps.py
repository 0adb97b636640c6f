"""Feet held still while a motion is laid along a path: which contacts, which of them are let go, and what it took."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from .. import planar
from ..errors import MocurveError
from ..feet.contacts import GAP, HEIGHT, LEAST, Contact, found, runs, slowness
from ..feet.legs import Leg, feet_of, legs, tracks
from ..feet.skate import skate
from ..kinematics import world
from ..motion import Motion
from ._body import carried
from ._heights import Line, rise
from ._locking import Source, held, source_of
from ._reach import LIMITS, Problem, Strain
from ._release import released

NEAR = 5.0  # seconds around what is touched that are looked at where time is stretched
SHORT = 1.0  # seconds: it is no wonder if in less no foot stands
CHANGES = 1e-9  # of a carry from frame to frame: less is none


@dataclass(frozen=True)
class Steps:
    """Contacts of feet with the floor, and how they were kept; centimetres.

    contacts: of balls and heels, where the path changes the clip. released: those let go, because the body would be
    pulled out of shape: there feet slide. asked: what holding them would have taken: kind (drop, shift: of the hips;
    twist: of the body over a foot; pivot: speed of a foot that turns on the spot; miss, short: feet out of reach; hip,
    ankle: joints beyond what they can), value and limit (cm, degrees), first and last frame, and stride: how many times
    as long the steps may be. stride: that for all of the clip; None where no other length helps, or none is needed.
    speed_own, speed_slid, speed: how fast balls slide in contact: in the clip, carried along the path, and held.
    drop, shift: how far the hips go down and aside for it at most. sunk: how far they go down on a slope besides,
    because a leg must reach down. pivots: how many standing feet turn on the spot; pivoted: by how many degrees.
    """

    contacts: int
    released: int
    speed_own: float
    speed_slid: float
    speed: float
    drop: float
    shift: float
    stride: float | None = None
    asked: Sequence[dict[str, Any]] = field(default_factory=list)
    sunk: float = 0.0
    pivots: int = 0
    pivoted: float = 0.0

    def __str__(self) -> str:
        gone = f", {self.released} of them let go," if self.released else ""
        turns = f"; {self.pivots} turn on the spot, by up to {self.pivoted:.0f} degrees" if self.pivots else ""
        slope = f", on slopes by {self.sunk:.2g} cm besides," if self.sunk else ""
        return (
            f"feet in {self.contacts} contacts{gone} slide {self.speed:.2f} cm/s, else {self.speed_slid:.2f} (in the "
            f"clip {self.speed_own:.2f}){turns}; the hips go down by up to {self.drop:.2g} cm{slope} and aside by "
            f"{self.shift:.2g}"
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
            stride=min((part.stride for part in some if part.stride is not None), default=None),
            asked=[problem for part in some for problem in part.asked],
            sunk=max(part.sunk for part in some),
            pivots=sum(part.pivots for part in some),
            pivoted=max(part.pivoted for part in some),
        )

    def to_json(self) -> dict[str, Any]:
        """The same as plain numbers."""
        return asdict(self)


@dataclass(frozen=True, eq=False)
class Feet:
    """What is known of the feet of a clip before it is laid anywhere. source: its legs and stances; contacts: of balls
    and heels. why: there are none."""

    legs: Sequence[Leg] = ()
    contacts: Sequence[Contact] = ()
    source: Source | None = None
    why: str = ""

    @classmethod
    def of(cls, body: Motion) -> Feet:
        """Looked for as `contacts` looks for them."""
        try:
            both = legs(body)
            listed = found(body, both, slowness(body), HEIGHT)
            if not listed and body.duration > SHORT:
                return cls(why="no foot stands anywhere")
            return cls(both, listed, source_of(body, listed, both))
        except MocurveError as error:
            return cls(why=str(error).split(";")[0])  # without options that are another verb's

    def shown(self, base: Motion, frames: np.ndarray) -> tuple[tuple[Contact, ...], Source | None]:
        """The contacts of a base that shows frames (G,) of the clip, and its source, None where it shows times between
        frames or leaves some out."""
        assert self.source is not None
        start, whole = int(frames[0]), np.array_equal(frames, frames[0] + np.arange(len(frames)))
        whole &= start == frames[0]
        if whole and len(frames) == self.source.motion.frames:
            return tuple(self.contacts), self.source
        return self._mapped(base, frames), self.source.cut(slice(start, start + len(frames))) if whole else None

    def repeated(self, long: Motion, shown: np.ndarray) -> Feet:
        """The same of a motion that shows frames (G,) of the clip, again and again. A foot that stands where one time
        ends and where the next begins, stands through."""
        if self.source is None:
            return self
        joints = sorted({contact.joint for contact in self.contacts})
        spans = []
        for joint in joints:
            stands = np.zeros(len(shown), bool)
            for contact in self.contacts:
                if contact.joint == joint:
                    stands |= (shown >= contact.first) & (shown <= contact.last)
            for first, end in runs(~stands):
                stands[first:end] = first > 0 and end < len(stands) and (end - first) * long.frame_time < GAP
            lasting = [span for span in runs(stands).tolist() if (span[1] - span[0]) * long.frame_time >= LEAST]
            spans += [(joint, first, end - 1) for first, end in lasting]
        listed = self._at(long, spans)
        if not listed:
            return Feet(why="no foot stands anywhere in the cycle")
        return Feet(self.legs, listed, source_of(long, listed, self.legs))

    def leaning(self, steps: Steps, made: Motion, frames: np.ndarray, carry: np.ndarray, pitch: np.ndarray) -> Steps:
        """The numbers of a motion that shows frames (F,) of the clip and has leaned (F,) after its feet were held."""
        balls, touched = {made.skeleton.names[leg.ball] for leg in self.legs}, _touched(carry, pitch)
        listed = [c for c in self.shown(made, frames)[0] if c.joint in balls and touched[c.first : c.last + 1].any()]
        found = skate(made, listed, self.legs)
        return replace(steps, speed=found.speed if found else 0.0)

    def _mapped(self, base: Motion, frames: np.ndarray) -> tuple[Contact, ...]:
        spans = []
        for contact in self.contacts:
            inside = np.flatnonzero((frames >= contact.first) & (frames <= contact.last))
            if len(inside) > 1:
                spans.append((contact.joint, int(inside[0]), int(inside[-1])))
        return self._at(base, spans)

    def _at(self, base: Motion, spans: Sequence[tuple[str, int, int]]) -> tuple[Contact, ...]:
        """Contacts of joints from a first to a last frame, where these are in a base."""
        names, (balls, heels) = base.skeleton.names, tracks(base, self.legs)
        ways = {names[leg.ankle]: heel for leg, heel in zip(self.legs, heels, strict=True)}
        ways |= {names[leg.ball]: ball for leg, ball in zip(self.legs, balls, strict=True)}
        listed = []
        for joint, first, last in spans:
            x, y, z = (float(mean) for mean in ways[joint][first : last + 1].mean(axis=0))
            listed.append(Contact(joint, first, last, (x, y, z)))
        return tuple(sorted(listed, key=lambda contact: (contact.first, contact.joint)))


def stepping(
    feet: Feet,
    base: Motion,
    frames: np.ndarray,
    carry: np.ndarray,
    lift: np.ndarray,
    lines: tuple[Line, Line | None] | None,
    first: int,
) -> tuple[Motion, Steps | None]:
    """The motion carried by planar transforms (F, 3), its feet held in contact; None where no foot is changed or there
    are no legs, which is told by a warning.

    base: the frames (F,) of the clip whose feet are known. lift: (F,) upwards; instead of it, feet and body are lifted
    as `_heights` has it where the new path (and the clip's own, if it has heights) are given as `lines`. first: the
    frame of the result that the motion begins with. Feet that slide in the clip are held too, but only where its frames
    are not carried as one.
    """
    if feet.source is None:
        if _touched(carry, lift).any():
            warnings.warn(f"feet are not held: {feet.why}", stacklevel=4)
        return carried(base, carry, lift), None
    listed, source = feet.shown(base, frames)
    raised, apart = None, np.zeros(len(carry), bool)
    if lines is not None:
        balls = {base.skeleton.names[leg.ball] for leg in feet.legs}
        raised, apart = rise(carry, [contact for contact in listed if contact.joint in balls], *lines)
        lift = raised.body
    touched = _touched(carry, lift) | apart
    if not touched.any():
        return carried(base, carry, lift), None
    span = slice(0, base.frames)
    if source is None:
        span = _around(touched, listed, round(NEAR / base.frame_time))
        listed = _within(listed, span)
        source = source_of(base[span], listed, feet.legs)
    near = source.near(touched[span])
    inner = slice(span.start + near.start, span.start + near.stop)
    part, rises = source.cut(near), None if raised is None else raised.cut(inner)

    def hold(kept: Sequence[Contact]) -> tuple[Motion, Strain]:
        known = part if len(kept) == len(listed) else source.standing(kept).cut(near)
        made, strain = held(known, carry[inner], touched[inner], rises)
        return made, strain.later(near.start)

    made, strain, gone, asked = released(listed, feet_of(base, feet.legs), hold)
    moved = carry.any(axis=1) | (lift != 0)
    elsewhere = moved[: inner.start].any() or moved[inner.stop :].any()
    values = np.array((carried(base, carry, lift) if elsewhere else base).values, order="F")
    values[inner] = made.values
    met = [contact for contact in listed if touched[span][contact.first : contact.last + 1].any()]
    own, slid, now = _sliding(part, carry[inner], made, _within(met, near))
    later = first + span.start
    asked = tuple(replace(p, first=p.first + later, last=p.last + later) for p in asked)
    strides = [problem.stride for problem in asked if problem.stride is not None]
    took = strain.drop, strain.shift, min(strides, default=None), _told(asked)
    told = strain.sunk, strain.pivots, strain.pivoted
    steps = Steps(len(met), len(gone), own, slid, now, *took, *told)
    if asked:
        _tell(asked, steps, base.frame_time)
    return replace(base, values=values, report=None), steps


# -- in call order ---------------------------------------------------------------------------------


def _touched(carry: np.ndarray, lift: np.ndarray) -> np.ndarray:
    """(F,) frames that are carried otherwise than one beside them."""
    touched = np.zeros(len(lift), bool)
    for taken in (*carry.T, lift):  # column by column, which is three times as fast
        moves = np.abs(np.diff(taken)) > CHANGES * (1.0 + np.abs(taken).max(initial=0.0))
        touched[:-1] |= moves
        touched[1:] |= moves
    return touched


def _around(touched: np.ndarray, listed: Sequence[Contact], near: int) -> slice:
    """The frames around those that are touched, and no contact in part."""
    some = np.flatnonzero(touched)
    first, end = max(int(some[0]) - near, 0), min(int(some[-1]) + near + 1, len(touched))
    for contact in listed:  # in the order of their first frames
        if contact.first < end <= contact.last:
            end = contact.last + 1
    for contact in sorted(listed, key=lambda contact: -contact.last):
        if contact.first < first <= contact.last:
            first = contact.first
    return slice(first, end)


def _within(listed: Sequence[Contact], span: slice) -> tuple[Contact, ...]:
    """The contacts in some frames, counted from the first of these."""
    return tuple(
        replace(c, first=max(c.first, span.start) - span.start, last=min(c.last, span.stop - 1) - span.start)
        for c in listed
        if c.first < span.stop and c.last >= span.start
    )


def _sliding(part: Source, carry: np.ndarray, made: Motion, listed: Sequence[Contact]) -> list[float]:
    """How fast balls slide in contact, cm/s, mean over all frames: in the source, carried, and held."""
    names = [made.skeleton.names[side.leg.ball] for side in part.sides]
    spans = [
        (names.index(c.joint), max(c.first - part.lead, 0), c.last + 1 - part.lead) for c in listed if c.joint in names
    ]
    stands = np.zeros(made.frames - part.lead, bool)
    for _, first, end in spans:
        stands[first:end] = True
    own = np.stack([side.stances.ball for side in part.sides], axis=1)
    now = own.copy()
    standing = replace(made, values=made.values[part.lead :][stands])
    now[stands] = part.scale * world(standing)[:, [side.leg.ball for side in part.sides]]
    slid = planar.move((carry[part.lead :] * [1.0, part.scale, part.scale])[:, None], own)
    told = []
    for track in (own, slid, now):
        steps = [np.linalg.norm(np.diff(track[first:end, foot, ::2], axis=0), axis=1) for foot, first, end in spans]
        told.append(float(np.concatenate(steps).mean()) / made.frame_time if any(map(len, steps)) else 0.0)
    return told


def _told(asked: Sequence[Problem]) -> list[dict[str, Any]]:
    return [
        {
            "kind": p.kind,
            "value": p.value,
            "limit": LIMITS[p.kind],
            "first": p.first,
            "last": p.last,
            "stride": p.stride,
        }
        for p in asked
    ]


def _tell(asked: Sequence[Problem], steps: Steps, frame_time: float) -> None:
    """What is asked of the legs, in one sentence."""
    more = len(asked) - 1
    others = f", and {more} more such span{'' if more == 1 else 's'}" if more else ""
    warnings.warn(
        f"the path asks too much of the legs: {asked[0].sentence(frame_time)}{others}; {steps.released} of "
        f"{steps.contacts} contacts are let go, and slide",
        stacklevel=5,
    )
