"""The stances of one leg in the source: contacts of ball and heel put together, and the foot held still in them.

A stance is a union of a ball contact and the heel contacts that overlap it. While the ball is down it is held at its
place; while only the heel is, the heel is held where it is when the ball arrives or leaves, and one fades into the
other. Only the ground plan is changed: height and tilt of the foot stay the source's, so the floor is not broken. A
place with another height than the source's lifts the foot.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..feet.contacts import Contact, runs
from ._hinge import Hinge
from ._poses import smooth
from ._swings import filled

STILL = 0.01  # cm and cm/s: a ball that moves less while it stands is held already, and stays as it is
DIE = 0.08  # seconds within which speeds of the source's sliding die out of a swing
NEAR, FAR = 0.10, 0.35  # seconds from a contact: the leg reaches exactly; the pelvis minds the knee
FLOOR, ROUND = np.radians(7.0), np.radians(3.0)  # flexion of the knee that is wanted at least, and how softly
SOFT, STEEP = np.radians(12.0), 1.0  # how softly on slopes, and half so at so many cm that one moves the foot by
SWING = 0.1  # seconds: the shortest swing that a heel contact leaves, and the shortest stand on a heel alone
SLIDES, LIFTED = 3.0, 1.0  # cm: a heel alone that goes further does not stand; the ball is higher than it
GROUND = [0, 2]


@dataclass(frozen=True, eq=False)
class Stances:
    """The stances of a leg, cm.

    spans:   (N, 2) first frame, and frame after the last. of: (F,) which stance, -1 in a swing.
    down:    (N, 2) the frames of it in which the ball stands, or the heel, where only that does.
    places:  (N, 3) where it stands. placed: (N,) whether that is not where it stands in the source.
    changed: (N,) whether the source's foot slides there, or is placed.
    ball:    (F, 3) of the source. error: (F, 3) what is to be added to it in stances that change, so that it is still.
    exact:   (F,) 1 in a stance, 0 from 0.1 s away on. minded: the same to 0.35 s.
    """

    spans: np.ndarray
    of: np.ndarray
    places: np.ndarray
    placed: np.ndarray
    changed: np.ndarray
    ball: np.ndarray
    error: np.ndarray
    exact: np.ndarray
    minded: np.ndarray
    down: np.ndarray

    def cut(self, span: slice) -> tuple[Stances, slice]:
        """Some of the frames, and which stances are in them."""
        inside = np.flatnonzero((self.spans[:, 1] > span.start) & (self.spans[:, 0] < span.stop))
        kept = slice(int(inside[0]), int(inside[-1]) + 1) if len(inside) else slice(0, 0)
        of = self.of[span]
        return Stances(
            np.clip(self.spans[kept] - span.start, 0, len(of)),
            np.where(of >= 0, of - kept.start, -1),
            self.places[kept],
            self.placed[kept],
            self.changed[kept],
            self.ball[span],
            self.error[span],
            self.exact[span],
            self.minded[span],
            np.clip(self.down[kept] - span.start, 0, len(of)),
        ), kept

    def mending(self, touched: np.ndarray) -> Stances:
        """The same where nothing is mended but stances with touched frames (F,): a foot that slides in others goes on
        sliding."""
        mends = self.changed & self.some(touched)
        error = np.where(_standing(self.of, mends)[:, None], self.error, 0.0)
        return replace(self, changed=mends, error=error)

    def some(self, frames: np.ndarray) -> np.ndarray:
        """(N,) the stances that have some of these frames (F,)."""
        found = np.zeros(len(self.spans), bool)
        found[self.of[frames & (self.of >= 0)]] = True
        return found

    def frames(self, some: np.ndarray) -> np.ndarray:
        """(F,) True in these stances (N,)."""
        return _standing(self.of, some)

    def pinned(self, frame_time: float) -> np.ndarray:
        """The ball (F, 3), held still in all stances that change, smooth between."""
        held: np.ndarray = self.ball + filled(self.error, self.spans, frame_time, DIE)
        return held

    @property
    def middles(self) -> np.ndarray:
        """(N,) the frame in the middle of each stance."""
        return (self.spans.sum(axis=1) - 1) // 2

    def mean(self, values: np.ndarray) -> np.ndarray:
        """Mean (N, M) over each stance of values (F, M)."""
        inside = self.of >= 0
        count = np.bincount(self.of[inside], minlength=len(self.spans))
        sums = [np.bincount(self.of[inside], column[inside], len(self.spans)) for column in values.T]
        return np.stack(sums, axis=1) / np.maximum(count, 1)[:, None]


def stances(
    ball: np.ndarray,
    heel: np.ndarray,
    listed: Sequence[Contact],
    name: str,
    scale: float,
    frame_time: float,
) -> Stances:
    """The stances of the leg whose ball (F, 3), cm, is called `name`, out of contacts of its ball and heel."""
    frames = len(ball)
    balls = sorted((contact for contact in listed if contact.joint == name), key=lambda contact: contact.first)
    heels = [contact for contact in listed if contact.joint != name]
    down, on_heel = (_mask(some, frames) for some in (balls, heels))
    unions = runs(down | on_heel).tolist()
    least = round(SWING / frame_time)
    alone = _alone(heels, balls, np.stack([ball, heel]), least)
    stands = sorted([*balls, *alone], key=lambda contact: contact.first)
    spans = _spans(stands, unions, least)
    of = np.full(frames, -1)
    error, places = np.zeros((frames, 3)), np.zeros((len(spans), 3))
    placed, changed = np.zeros(len(spans), bool), np.zeros(len(spans), bool)
    for i, ((first, end), contact) in enumerate(zip(spans, stands, strict=True)):
        of[first:end] = i
        places[i] = scale * np.array(contact.place)
        point = ball if contact.joint == name else heel
        own = point[contact.first : contact.last + 1]
        error[first:end] = _holding(point, heel, (first, end), contact, places[i])
        placed[i] = np.abs(places[i] - own.mean(axis=0)).max() > STILL
        steps = np.linalg.norm(np.diff(own[:, GROUND], axis=0), axis=1) / frame_time
        slides = np.abs(own[:, GROUND] - own[:, GROUND].mean(axis=0)).max()
        changed[i] = placed[i] or slides > STILL or steps.mean() > STILL if len(steps) else placed[i]
        if not changed[i]:
            error[first:end] = 0.0
    exact, minded = (near(of >= 0, frame_time, seconds) for seconds in (NEAR, FAR))
    held = np.array([[contact.first, contact.last + 1] for contact in stands], int).reshape(-1, 2)
    return Stances(spans, of, places, placed, changed, ball, error, exact, minded, held)


def wanted(hinge: Hinge, weight: np.ndarray, moved: np.ndarray | None = None) -> np.ndarray:
    """Flexion (F,) of the knee that is aimed at: the source's, near stances that change never quite straight, where a
    little of the leg's length would cost much of the knee's turn. moved: (F, 3) cm by which the ankle is elsewhere, on
    a slope: so much more or less the knee bends."""
    flexion, steep = hinge.flexion, np.zeros(len(weight))
    if moved is not None:
        to = hinge.hip - hinge.ankle - moved
        away = (moved * moved).sum(axis=1)
        steep = away / (away + STEEP**2)
        flexion = flexion + hinge.bend(np.linalg.norm(to, axis=1))[0] - hinge.bend(hinge.length(flexion))[0]
        weight = np.maximum(weight, np.tanh(away))  # lower than straight no leg reaches: the hips do
    wide = ROUND + (SOFT - ROUND) * steep
    floor = FLOOR + wide * np.logaddexp(0.0, (flexion - FLOOR) / wide)
    return flexion + weight * (floor - flexion)


def near(mask: np.ndarray, frame_time: float, seconds: float) -> np.ndarray:
    """1 where the mask (F,) is, smoothly down to 0 so many seconds away."""
    away = np.full(len(mask), np.inf)
    spans = runs(mask)
    if len(spans):
        frames = np.arange(len(mask))
        begun = np.searchsorted(spans[:, 0], frames, side="right")
        since = np.where(begun > 0, frames - (spans[np.maximum(begun - 1, 0), 1] - 1), len(mask))
        until = np.where(begun < len(spans), spans[np.minimum(begun, len(spans) - 1), 0] - frames, len(mask))
        away = np.where(mask, 0.0, np.minimum(np.maximum(since, 0), until)) * frame_time
    return smooth(np.clip(1.0 - away / seconds, 0.0, 1.0))


# -- in call order ---------------------------------------------------------------------------------


def _standing(of: np.ndarray, some: np.ndarray) -> np.ndarray:
    return (of >= 0) & some[of] if len(some) else np.zeros(len(of), bool)


def _mask(listed: Sequence[Contact], frames: int) -> np.ndarray:
    mask = np.zeros(frames, bool)
    for contact in listed:
        mask[contact.first : contact.last + 1] = True
    return mask


def _alone(heels: Sequence[Contact], balls: Sequence[Contact], places: np.ndarray, least: int) -> list[Contact]:
    """The contacts of a heel that stands alone, the ball lifted above it all the time, for so many frames at least and
    so many away from contacts of the ball. places: (2, F, 3) of ball and heel."""
    found = []
    for heel in heels:
        span = slice(heel.first, heel.last + 1)
        ball, own = places[0, span], places[1, span]
        apart = all(max(heel.first - other.last, other.first - heel.last) > least for other in balls)
        slides = np.abs(own[:, GROUND] - own[:, GROUND].mean(axis=0)).max()
        if apart and len(own) >= least and (ball - own)[:, 1].min() > LIFTED and slides < SLIDES:
            found.append(heel)
    return found


def _spans(balls: Sequence[Contact], unions: Sequence[Sequence[int]], least: int) -> np.ndarray:
    """For each ball contact (in order) the span (N, 2) of frames in which it or a heel contact that overlaps it is
    there. Where that would leave less than so many frames of swing between two of them, the heel does not count."""
    spans = []
    for first, end in unions:
        inner = [contact for contact in balls if first <= contact.first < end]
        for contact in inner:
            start = first if contact is inner[0] else contact.first
            spans.append([start, end if contact is inner[-1] else contact.last + 1])
    for at, (one, after) in enumerate(pairwise(spans)):
        if after[0] - one[1] < least:
            one[1], after[0] = balls[at].last + 1, balls[at + 1].first
    return np.array(spans, int).reshape(-1, 2)


def _holding(
    ball: np.ndarray, heel: np.ndarray, span: tuple[int, int], contact: Contact, place: np.ndarray
) -> np.ndarray:
    """What is to be added to the places of the foot in a stance (frames of it, 3) so that it stands still there."""
    first, end = span
    own = slice(contact.first, contact.last + 1)
    error = np.zeros((end - first, 3))
    error[:, GROUND] = place[GROUND] - ball[first:end, GROUND]
    lift = place[1] - ball[own, 1].mean()
    error[:, 1] = lift if abs(lift) > STILL else 0.0
    for at, frames in ((own.start, np.arange(first, own.start)), (own.stop - 1, np.arange(own.stop, end)[::-1])):
        if not len(frames):  # frames in which only the heel is down, from the far one to the ball's
            continue
        inside = (frames[:, None] - first, GROUND)
        on_heel = heel[at, GROUND] + error[at - first, GROUND] - heel[frames][:, GROUND]
        fade = smooth(np.arange(1, len(frames) + 1) / (len(frames) + 1))[:, None]
        error[inside] += (1.0 - fade) * (on_heel - error[inside])
    return error
