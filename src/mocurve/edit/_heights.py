"""Heights foot by foot: on a path with heights each foot stands on the path beside it, and the hips are as high as the
path is between the feet.

A body that is lifted frame by frame keeps all of itself level, so that on a slope the foot in front sinks in and the
one behind floats. Here a stance is lifted by the height of the path at its own place; the body by the heights at all
stances, interpolated along the path, so that neither stairs nor bumps between two steps shake the hips. Soles are laid
along the slope; hips sink, by a smooth amount that is known before anything is solved, as far as a leg must reach down.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .. import hermite, planar
from ..feet.contacts import Contact
from ..path import Path
from ..path_length import LengthTable
from ._footprints import Prints, Targets
from ._hinge import STRAIGHT, Hinge
from ._pelvis import around, lacking
from ._poses import smooth
from ._stances import FAR, Stances, near

STEEPEST = np.radians(45.0)  # nobody stands on what is steeper
BESIDE, BESIDES = 12, 1e-10  # steps towards the place of a path that a foot is beside, until they are as small
MERGED = 0.2  # of the body's mean way between two stances: nearer ones count as one
LOWER, LOWERS = 12.0, 0.3  # cm that hips are lower on a slope at most; seconds around
BENT = np.radians(20.0)  # flexion that a leg keeps that reaches down, if it has as much in the source
SHARE = 1.5  # times what a slope moves a foot by: hips sink no more for it
LIFTED = np.radians(50.0)  # of a sole: its foot pushes off, whatever the slope
LEVEL = 1e-6  # radians: what slopes less does not
NOTHING = 1e-9  # of the path's size: lifts that are as small are none


@dataclass(frozen=True, eq=False)
class Line:
    """A path with heights, and how far along it every frame is, (F,)."""

    path: Path
    table: LengthTable
    distance: np.ndarray

    def cut(self, span: slice) -> Line:
        """Some of the frames."""
        return replace(self, distance=self.distance[span])

    def tilts(self, at: np.ndarray) -> np.ndarray:
        """Rotation vectors (N, 2), about x and z, that lay what is level along the path so far along it, (N,)."""
        slope, heading = self.path.slope(self.table.parameter(at)), self.path.at(at, self.table)[1]
        return slope[:, None] * np.stack([-np.cos(heading), np.sin(heading)], axis=1)

    def beside(self, frames: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """How far along the path and how high it is beside places (N, 3) at frames (N,)."""
        at = self.distance[frames]
        room = np.ptp(self.path.points, axis=0).max()
        for _ in range(BESIDE):
            there, heading = self.path.at(at, self.table)
            ahead = (places[:, 0] - there[:, 0]) * np.sin(heading) + (places[:, 2] - there[:, 2]) * np.cos(heading)
            step = ahead / np.cos(self.path.slope(self.table.parameter(at)))
            at = at + np.clip(step, -room, room)
            if np.abs(step).max(initial=0.0) <= BESIDES * room:
                break
        return at, self.path.at(at, self.table)[0][:, 1]


@dataclass(frozen=True, eq=False)
class Rise:
    """By how much a body and its feet are lifted. body: (F,), file units. new: the path that they are on; own: the
    clip's own where that has heights, else None."""

    body: np.ndarray
    new: Line
    own: Line | None

    def cut(self, span: slice) -> Rise:
        """Some of the frames."""
        return Rise(self.body[span], self.new.cut(span), self.own and self.own.cut(span))

    def below(self, frames: np.ndarray, places: np.ndarray) -> np.ndarray:
        """How high (N, 3), 0, and how the clip's own path slopes, as `Line.tilts`, 1 and 2, below places (N, 3)."""
        if self.own is None:
            return np.zeros((len(frames), 3))
        at, height = self.own.beside(frames, places)
        return np.column_stack([height, self.own.tilts(at)])

    def at(
        self, frames: np.ndarray, there: np.ndarray, turn: np.ndarray, below: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """By how much (N,) feet are lifted that stand `there` (N, 3), turned by (N,), at frames (N,); and by which
        rotation vectors (N, 2), about x and z, they are laid along the slope. below: of their places in the clip."""
        at, height = self.new.beside(frames, there)
        cosine, sine = np.cos(turn), np.sin(turn)
        own = np.column_stack([cosine * below[:, 1] + sine * below[:, 2], cosine * below[:, 2] - sine * below[:, 1]])
        return height - below[:, 0], self.new.tilts(at) - own


@dataclass(frozen=True, eq=False)
class Ground:
    """What feet are led over. carry: (F, 4) angle, x, z and height by which the body is taken elsewhere, cm."""

    carry: np.ndarray
    rise: Rise | None
    scale: float
    frame_time: float

    def cut(self, span: slice) -> Ground:
        """Some of the frames."""
        return replace(self, carry=self.carry[span], rise=None if self.rise is None else self.rise.cut(span))

    def raised(self, prints: Prints, stances: Stances) -> Prints:
        """Footprints at the heights of their places."""
        if self.rise is None or not len(stances.spans):
            return prints
        there = planar.move(prints.taken, stances.places)
        frames, below = stances.middles, prints.below
        below = self.rise.below(frames, stances.places / self.scale) if below is None else below
        lift, tilt = self.rise.at(frames, there / self.scale, prints.taken[:, 0], below)
        lift *= self.scale
        inside = stances.of >= 0
        off = np.abs(self.carry[inside, 3] - lift[stances.of[inside]])
        uneven = np.maximum(prints.uneven, 10.0 * np.abs(tilt).max(axis=1))  # a foot is 10 cm either way
        np.maximum.at(uneven, stances.of[inside], off)
        laid = tilt if np.abs(tilt).max() > LEVEL else None
        return replace(prints, lift=lift, tilt=laid, uneven=uneven, below=below)

    def moved(self, aim: Targets, pinned: np.ndarray, offset: np.ndarray) -> np.ndarray | None:
        """By how much (F, 3), as the body sees it, a slope moves the ankle of a foot: up, and because the foot is laid
        along it; None where the path has no heights. pinned: (F, 3) its ball in the source, offset: (F, 3) from there
        to the ankle."""
        if self.rise is None:
            return None
        found = np.zeros_like(offset)
        found[:, 1] = aim.ball[:, 1] - pinned[:, 1] - self.carry[:, 3]
        if aim.tilt is not None:
            turn = np.zeros((len(offset), 3))
            turn[:, 0] = -aim.yaw
            found += planar.move(turn, aim.ankle - aim.ball) - offset
        return found

    def sinks(self, legs: Sequence[tuple[Hinge, np.ndarray, np.ndarray | None]], stands: np.ndarray) -> np.ndarray:
        """How far (F,), cm, a slope takes the hips down, up to LOWER: as far as a leg that is all but straight must
        reach down to its foot wherever one stands anew (`stands`, (2, F)) and shortly before and after, smooth around.
        legs: each with where its ankle is to be, (F, 3), and by how much that is `moved`."""
        need = np.zeros(len(self.carry))
        for (hinge, ankle, moved), there in zip(legs, stands, strict=True):
            if moved is None:
                return need
            over = lacking(self.taken(hinge.hip) - ankle, hinge.length(np.clip(hinge.flexion, STRAIGHT, BENT)))
            over = np.minimum(over, SHARE * np.abs(moved[:, 1]))  # not what long steps ask for on level ground too
            need = np.maximum(need, np.sqrt(near(there, self.frame_time, FAR)) * over)
        return around(np.minimum(need, LOWER), round(LOWERS / self.frame_time))

    def taken(self, places: np.ndarray) -> np.ndarray:
        """Places (F, 3) of the body in the source, where they are carried."""
        there = planar.move(self.carry, places)
        there[:, 1] += self.carry[:, 3]
        return there


def rise(carry: np.ndarray, contacts: Sequence[Contact], new: Line, own: Line | None) -> tuple[Rise, np.ndarray]:
    """What lifts a body that is carried by planar transforms (F, 3) and stands in these contacts; and in which frames
    (F,) one of them is not lifted as the body is."""
    frames = np.array([(contact.first + contact.last) // 2 for contact in contacts], int)
    places = np.array([contact.place for contact in contacts]).reshape(-1, 3)
    there = np.array(
        [planar.move(carry[c.first : c.last + 1], np.array(c.place)).mean(axis=0) for c in contacts]
    ).reshape(-1, 3)
    body = _between(new, frames, there) - (0.0 if own is None else _between(own, frames, places))
    least = NOTHING * (1.0 + np.abs(new.path.points).max())
    body = np.where(np.abs(body) <= least, 0.0, body)
    found = Rise(body, new, own)
    apart = np.zeros(len(carry), bool)
    if len(frames):
        lifts, _ = found.at(frames, there, 0.0 * body[frames], found.below(frames, places))
        for contact, lift in zip(contacts, lifts.tolist(), strict=True):
            span = slice(contact.first, contact.last + 1)
            apart[span] |= np.abs(body[span] - lift) > least
    return found, apart


def flat(ball: np.ndarray, heel: np.ndarray) -> np.ndarray:
    """Which part (F,) of a slope's tilt a foot takes on: all while its sole is down or its toes are up, less and less
    as the heel is lifted: who pushes off uphill stretches the ankle instead. ball, heel: (F, 3)."""
    rise = np.arcsin(np.clip((heel - ball)[:, 1] / np.maximum(np.linalg.norm(heel - ball, axis=1), 1e-9), -1.0, 1.0))
    return 1.0 - smooth(np.clip(rise / LIFTED, 0.0, 1.0))


def steep(line: Line) -> bool:
    """Whether a path is anywhere on the way too steep to stand on."""
    return bool((np.abs(line.path.slope(line.table.parameter(line.distance))) > STEEPEST).any())


# -- in call order ---------------------------------------------------------------------------------


def _between(line: Line, frames: np.ndarray, places: np.ndarray) -> np.ndarray:
    """The height (F,) of a path at every frame, interpolated along it between places (N, 3) that it is beside, and the
    ends of the way."""
    ends = np.array([line.distance.min(), line.distance.max()])
    if not ends[1] > ends[0]:
        return line.path.at(line.distance, line.table)[0][:, 1]
    at, height = line.beside(frames, places)
    end_heights = line.path.at(ends, line.table)[0][:, 1]
    at, height = np.append(at, ends), np.append(height, end_heights)
    order = np.argsort(at, kind="stable")
    at, height = at[order], height[order]
    first = np.append(True, np.diff(at) > MERGED * (ends[1] - ends[0]) / max(len(frames), 1))
    group = np.cumsum(first) - 1
    count = np.bincount(group)
    at, height = (np.bincount(group, part) / count for part in (at, height))
    if len(at) < 2:
        return line.path.at(line.distance, line.table)[0][:, 1]
    return hermite.evaluate(at, height, np.gradient(height, at), np.clip(line.distance, at[0], at[-1]))
