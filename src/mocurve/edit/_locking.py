"""Feet held where they stand while the body is carried elsewhere: footprints, swings, pelvis, legs, in that order.

Follows Kovar, Schreiner and Gleicher 2002, Footskate cleanup for motion capture editing, in what is done (footprints,
root, legs), not in how: the root is one least squares over all frames, so that no knee is yanked, and a footprint may
move a little while the feet follow the body between footprints.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .. import planar, rotation
from ..errors import Mismatch
from ..feet.contacts import Contact, runs
from ..feet.legs import Leg, centimetres
from ..info import first_frame_is_t_pose
from ..kinematics import world, world_rotations
from ..motion import Motion
from ._body import bearer, carried, set_anew
from ._clearance import cleared
from ._footprints import Prints, Targets, prints, relieved, targets
from ._heights import LOWERS, Ground, Rise, flat
from ._hinge import Hinge, hinge_of, reached
from ._joints import Joints, joints_of
from ._pelvis import Legs, beyond_reach, shifted, spared
from ._reach import Strain
from ._stances import FAR, STILL, Stances, near, stances, wanted
from ._swings import REACH

ROUNDS, MOVING = 3, 2  # solutions of the pelvis, and after how many of them footprints move


@dataclass(frozen=True, eq=False)
class Side:
    """What is known of one leg in the source: its joints, its bones and bends, where it stands; where its heel is, and
    from ball to ankle (F, 3), cm; which part of a slope's tilt the foot takes on, (F,); how the world sees the axes
    (F, 4) of what carries the hip, and of what carries the ankle; what hip and ankle can do."""

    leg: Leg
    hinge: Hinge
    stances: Stances
    heel: np.ndarray
    offset: np.ndarray
    flat: np.ndarray
    above: np.ndarray
    shank: np.ndarray
    joints: Joints

    def cut(self, span: slice) -> tuple[Side, slice]:
        """Some of the frames, and which stances are in them."""
        stances, kept = self.stances.cut(span)
        parts = (part[span] for part in (self.heel, self.offset, self.flat, self.above, self.shank))
        heel, offset, flat, above, shank = parts
        hinge, joints = self.hinge.cut(span), self.joints.cut(span)
        return Side(self.leg, hinge, stances, heel, offset, flat, above, shank, joints), kept


@dataclass(frozen=True, eq=False)
class Source:
    """What is known of a motion before it is carried anywhere. lead: T-poses in front, which are not part of it; scale:
    centimetres a unit; bearer: the joint whose place moves the body over its feet."""

    motion: Motion
    lead: int
    scale: float
    bearer: int
    sides: tuple[Side, ...]

    def cut(self, span: slice) -> Source:
        """Some of the frames; the first and the last stance may be cut too."""
        inner = slice(max(span.start - self.lead, 0), max(span.stop - self.lead, 0))
        sides = tuple(side.cut(inner)[0] for side in self.sides)
        return replace(self, motion=self.motion[span], lead=max(self.lead - span.start, 0), sides=sides)

    def standing(self, listed: Sequence[Contact]) -> Source:
        """The same with other contacts."""
        inner = [replace(c, first=max(c.first - self.lead, 0), last=c.last - self.lead) for c in listed]
        sides = (
            replace(side, stances=_stood(self.motion, side.leg, side.stances.ball, side.heel, inner, self.scale))
            for side in self.sides
        )
        return replace(self, sides=tuple(sides))

    def near(self, touched: np.ndarray) -> slice:
        """The frames that have to be looked at where some (F,) are carried unlike those beside them."""
        inner = touched[self.lead :]
        moves = np.logical_or.reduce([s.stances.frames(s.stances.some(inner)) for s in self.sides])
        if not moves.any():
            found = np.flatnonzero(touched)
            return slice(int(found[0]), int(found[-1]) + 1)
        active, _ = _windows(self.sides, moves, self.motion.frame_time)
        span = _context(self.sides, active | inner)
        return slice(0 if touched[: self.lead].any() else span.start + self.lead, span.stop + self.lead)


def source_of(base: Motion, listed: Sequence[Contact], legs: Sequence[Leg]) -> Source:
    """What locking needs to know of a motion (samples), its contacts, and its legs as `feet.legs` finds them: once for
    a clip that is laid on one path after another."""
    lead = int(first_frame_is_t_pose(base))
    motion, scale = base[lead:], centimetres(base)
    inner = [replace(c, first=max(c.first - lead, 0), last=c.last - lead) for c in listed if c.last >= lead]
    places = scale * world(motion)
    sides = tuple(_side(motion, pair, inner, places, scale) for pair in zip(legs, legs[::-1], strict=True))
    return Source(base, lead, scale, bearer(base.skeleton, _common(base, legs)), sides)


def locked(base: Motion, carry: np.ndarray, listed: Sequence[Contact], legs: Sequence[Leg]) -> tuple[Motion, Strain]:
    """`held` for a motion that is carried once."""
    return held(source_of(base, listed, legs), carry)


def held(
    source: Source, carry: np.ndarray, touched: np.ndarray | None = None, rise: Rise | None = None
) -> tuple[Motion, Strain]:
    """The motion carried elsewhere, its feet held in their contacts, and what that took.

    carry: (F, 3) planar transforms of the root of each frame, angle, x, z in file units (`planar`); all zero for plain
    cleanup. touched: (F,) the frames outside of which nothing is to be mended: a foot that slides in other stances goes
    on sliding; all by default. rise: by how much bodies and feet are lifted, by default not.

    Places in contact are the contacts' own, taken along by the mean of the carries over the contact. Contacts whose
    foot is held already, and carried as one, are not touched, nor are frames from 0.6 s away of others. Nothing is
    refused here: Strain says where a leg was asked for too much.
    """
    base, sides, lead = source.motion, source.sides, source.lead
    up = np.zeros(len(carry)) if rise is None else rise.body
    made = carried(base, carry, up)
    carry = np.column_stack([np.unwrap(carry[:, 0]), source.scale * carry[:, 1:], source.scale * up])[lead:]
    ground = Ground(carry, None if rise is None else rise.cut(slice(lead, len(up))), source.scale, base.frame_time)
    if touched is not None:
        sides = tuple(replace(side, stances=side.stances.mending(touched[lead:])) for side in sides)
    marks = [ground.raised(prints(side.stances, carry, side.joints, base.frame_time), side.stances) for side in sides]
    changed = [side.stances.changed | (mark.uneven > STILL) for side, mark in zip(sides, marks, strict=True)]
    counts = sum(map(len, changed)), int(sum(map(np.sum, changed)))
    if not counts[1]:
        return made, Strain.none(counts[0])
    moves = np.array([side.stances.frames(own) for side, own in zip(sides, changed, strict=True)])
    active, free = _windows(sides, np.logical_or(*moves), base.frame_time)
    window = _context(sides, active)
    parts = [side.cut(window) for side in sides]
    sides = tuple(side for side, _ in parts)
    marks = [mark.cut(kept, window) for mark, (_, kept) in zip(marks, parts, strict=True)]
    even = bool(np.abs(np.diff(carry, axis=0)).max(initial=0.0) < 1e-9)
    carry, moves, active, free = carry[window], moves[:, window], active[window], free[window]
    shift, aims, pulls, sinks = _solved(sides, marks, moves, ground.cut(window), ~free)
    turns, taken = _legs_set(sides, pulls, aims, shift, carry, active)
    lead += window.start
    all_shift = (shift - sinks[:, None] * [0.0, 1.0, 0.0])[active] / source.scale
    made = set_anew(made, source.bearer, all_shift, turns, lead + np.flatnonzero(active))
    places = source.scale * world(made[lead : lead + len(carry)])
    tracks = taken | _taken(sides, marks, aims, places, shift, carry[:, 0], moves, base.frame_time)
    wholes = np.concatenate([mark.pivots.whole for mark in marks])
    strain = Strain.of(*counts, tracks, wholes, even, base.frame_time).later(lead)
    return made, replace(strain, sunk=float(sinks.max(initial=0.0)))


# -- in call order ---------------------------------------------------------------------------------


def _side(motion: Motion, pair: tuple[Leg, Leg], listed: Sequence[Contact], places: np.ndarray, scale: float) -> Side:
    """The first leg of a pair."""
    leg, parents = pair[0], motion.skeleton.parents
    above = [parents[leg.hip], leg.hip, parents[leg.knee], leg.knee, parents[leg.ankle], leg.ankle]
    turned = world_rotations(motion, above)
    hinge = hinge_of(motion, leg, places, turned[:, [1, 2, 3, 5]])
    ball = places[:, leg.ball]
    heel = hinge.ankle + rotation.rotate(hinge.foot, scale * leg.heel)
    stood = _stood(motion, leg, ball, heel, listed, scale)
    joints = joints_of(hinge, turned[:, 0], places[:, pair[1].hip], ball - heel, stood.of >= 0)
    offset = hinge.ankle - ball
    return Side(leg, hinge, stood, heel, offset, flat(ball, heel), turned[:, 0], turned[:, 4], joints)


def _stood(
    motion: Motion, leg: Leg, ball: np.ndarray, heel: np.ndarray, listed: Sequence[Contact], scale: float
) -> Stances:
    name, ankle = (motion.skeleton.names[joint] for joint in (leg.ball, leg.ankle))
    own = [contact for contact in listed if contact.joint in (name, ankle)]
    return stances(ball, heel, own, name, scale, motion.frame_time)


def _common(motion: Motion, legs: Sequence[Leg]) -> int:
    """The lowest joint above all hips."""
    below = [motion.skeleton.below(joint) for joint in range(len(motion.skeleton.names))]
    above = [joint for joint, under in enumerate(below) if all(under[leg.hip] and joint != leg.hip for leg in legs)]
    if not above:
        raise Mismatch("the legs hang on no common joint, so no body can be moved over its feet")
    return max(above)


def _windows(sides: Sequence[Side], changed: np.ndarray, frame_time: float) -> tuple[np.ndarray, np.ndarray]:
    """Frames (F,) that may change, and those of them in which the pelvis may move."""
    reach = int(REACH / frame_time)
    free = np.zeros(len(changed), bool)
    for first, end in runs(changed):
        free[max(first - reach, 0) : end + reach] = True
    active = free.copy()
    touched = np.flatnonzero(changed)
    beside = np.zeros(len(changed), bool)
    beside[np.concatenate([touched, np.maximum(touched - 1, 0), np.minimum(touched + 1, len(changed) - 1)])] = True
    for side in sides:  # a swing from or to a foot that is held elsewhere, or past one
        for first, end in runs(side.stances.of < 0):
            if end - first <= 2 * reach and beside[first:end].any():
                active[first:end] = True
    return active, free


def _context(sides: Sequence[Side], active: np.ndarray) -> slice:
    """The frames that have to be looked at: those that may change and, for each leg, a stance on both sides of them.
    What is cut off at either end has no part in what they become."""
    inside = np.flatnonzero(active)
    first, end = int(inside[0]), int(inside[-1]) + 1
    firsts, ends = [first], [end]
    for side in sides:
        spans = side.stances.spans
        before, after = spans[spans[:, 0] <= first, 0], spans[spans[:, 1] >= end, 1]
        firsts.append(int(before[-1]) if len(before) else 0)
        ends.append(int(after[0]) if len(after) else len(active))
    return slice(max(min(firsts) - 2, 0), min(max(ends) + 2, len(active)))  # two frames in which nothing is shifted


def _solved(
    sides: Sequence[Side], marks: Sequence[Prints], moves: np.ndarray, ground: Ground, fixed: np.ndarray
) -> tuple[np.ndarray, list[Targets], list[Legs], np.ndarray]:
    """The shift of the pelvis (F, 3), cm, where the feet are to be, how the legs pull, and how far (F,) a slope has
    taken the hips down before. moves: (2, F) frames in which a foot stands anew."""
    marks, shift = list(marks), np.zeros((len(fixed), 3))
    pinned = [side.stances.pinned(ground.frame_time) for side in sides]
    aims = _aims(sides, marks, pinned, ground)
    inner = 1.0 - near(fixed, ground.frame_time, LOWERS)
    moved = [ground.moved(aim, ball, side.offset) for side, aim, ball in zip(sides, aims, pinned, strict=True)]
    legs = [(side.hinge, aim.ankle, away) for side, aim, away in zip(sides, aims, moved, strict=True)]
    sinks = inner * ground.sinks(legs, moves)
    pulls = [_pull(*part, ground, sinks) for part in zip(sides, moved, moves, strict=True)]
    for turn in range(ROUNDS):
        pairs = [(pull, aim.ankle) for pull, aim in zip(pulls, aims, strict=True)]
        shift = shifted(pairs, shift, fixed, ground.frame_time)
        if turn < MOVING:
            marks = [
                ground.raised(relieved(mark, s.stances, s.hinge, pull.hip + shift, aim.ankle, pull.wanted), s.stances)
                for mark, s, aim, pull in zip(marks, sides, aims, pulls, strict=True)
            ]
            aims = _aims(sides, marks, pinned, ground)
    pairs = [(pull, aim.ankle) for pull, aim in zip(pulls, aims, strict=True)]
    shift = spared(pairs, shift, fixed, ground.frame_time)
    shift[:, 1] -= inner * beyond_reach(pairs, shift, moves, ground.frame_time)
    return shift, aims, pulls, sinks


def _pull(side: Side, moved: np.ndarray | None, changed: np.ndarray, ground: Ground, sinks: np.ndarray) -> Legs:
    """How a leg with these changed stances (F,) pulls at the body that is carried, and sinks (F,). moved: (F, 3) by how
    much a slope moves its ankle, None where it is level."""
    hip = ground.taken(side.hinge.hip)
    hip[:, 1] -= sinks
    if moved is not None:
        moved = moved + sinks[:, None] * [0.0, 1.0, 0.0]
    bends = wanted(side.hinge, near(changed, ground.frame_time, FAR), moved)
    return Legs(side.hinge, hip, bends, side.stances.minded)


def _aims(
    sides: Sequence[Side], marks: Sequence[Prints], pinned: Sequence[np.ndarray], ground: Ground
) -> list[Targets]:
    carry, frame_time = ground.carry, ground.frame_time
    aims = [
        targets(side.stances, mark, carry, ball, side.offset, side.flat, frame_time)
        for side, mark, ball in zip(sides, marks, pinned, strict=True)
    ]
    before = [Targets(side.hinge.ankle - side.offset, side.hinge.ankle, carry[:, 0]) for side in sides]
    heading = np.ascontiguousarray(carry[:, 0])
    for own, other in ((0, 1), (1, 0)):
        pairs = (before[own], before[other]), (sides[own].stances, sides[other].stances)
        aims[own] = cleared(aims[own], aims[other], *pairs, heading, frame_time)
    return aims


def _legs_set(
    sides: Sequence[Side],
    pulls: Sequence[Legs],
    aims: Sequence[Targets],
    shift: np.ndarray,
    carry: np.ndarray,
    active: np.ndarray,
) -> tuple[dict[int, np.ndarray], dict[str, np.ndarray]]:
    """Rotations (N, 4) of hips, knees and ankles against their parents at the active frames; by how much (2, F), cm,
    the ankles fall short, and by how many degrees hips and ankles go too far."""
    turns: dict[int, np.ndarray] = {}
    short, far = np.zeros((len(sides), len(carry))), np.zeros((2, len(sides), len(carry)))
    within = slice(*(np.flatnonzero(active)[[0, -1]] + [0, 1]).tolist())
    some, heading = active[within], carry[within, 0]
    back = rotation.inv(planar.quaternion(carry[within]))
    for i, (side, pull, aim) in enumerate(zip(sides, pulls, aims, strict=True)):
        hinge, leg, yaw = side.hinge.cut(within), side.leg, aim.yaw[within]
        hip, goal = pull.hip[within] + shift[within], aim.ankle[within]
        joints, turned = side.joints.cut(within), planar.quaternion(yaw[:, None])
        whole, knee, short[i, within] = reached(
            hinge, hip, goal, yaw, heading, pull.wanted[within], side.stances.exact[within], joints.share(yaw - heading)
        )
        above = rotation.mul(back, whole)
        bent = rotation.mul(knee, rotation.inv(hinge.knee))
        turns[leg.hip] = rotation.mul(rotation.inv(side.above[within]), rotation.mul(above, hinge.thigh))
        turns[leg.knee] = rotation.mul(knee, rotation.mul(rotation.inv(hinge.knee), hinge.shin))
        shin = rotation.mul(whole, rotation.mul(hinge.knee, bent))
        turned = turned if aim.tilt is None else rotation.mul(aim.tilt[within], turned)
        foot = rotation.mul(turned, hinge.foot)
        turns[leg.ankle] = rotation.mul(rotation.inv(rotation.mul(shin, side.shank[within])), foot)
        far[:, i, within] = np.where(some, joints.beyond(above, shin, turned), 0.0)
    swings = np.array([side.stances.of < 0 for side in sides])
    taken = {"short": np.where(swings, np.abs(short), 0.0), "hip": far[0], "ankle": far[1]}
    return {joint: local[some] for joint, local in turns.items()}, taken


def _taken(
    sides: Sequence[Side],
    marks: Sequence[Prints],
    aims: Sequence[Targets],
    places: np.ndarray,
    shift: np.ndarray,
    heading: np.ndarray,
    moves: np.ndarray,
    frame_time: float,
) -> dict[str, np.ndarray]:
    """What was taken of each kind of `_reach.LIMITS` in every frame, (F,) or of both legs (2, F), measured on the
    places (F, J, 3), cm."""
    off = [np.linalg.norm(places[:, s.leg.ball] - aim.ball, axis=1) for s, aim in zip(sides, aims, strict=True)]
    turned = [side.joints.more(aim.yaw - heading) for side, aim in zip(sides, aims, strict=True)]
    speeds = [mark.pivots.speeds(side.stances, frame_time) for side, mark in zip(sides, marks, strict=True)]
    return {
        "drop": -shift[:, 1],
        "shift": np.linalg.norm(shift[:, [0, 2]], axis=1),
        "twist": np.degrees(np.where(moves, turned, 0.0)),
        "pivot": np.degrees(speeds),
        "miss": np.where(moves, off, 0.0),
    }
