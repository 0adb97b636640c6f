"""The verb `join`: from one motion over into another, where the two look most alike.

Source: Kovar, Gleicher and Pighin 2002, Motion graphs, sections 3.1 and 3.2, for distance, alignment and overlap;
Bollo 2018, Inertialization (GDC), for the mode that needs no overlap.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from .. import planar, rotation
from ..errors import OptionError, UnknownName
from ..feet.planted import SPEED, planted
from ..info import first_frame_is_t_pose
from ..kinematics import rest_height, world
from ..motion import Clip, Motion, frame_count, unroll
from . import _cuts
from ._pair import at_times, check, complete, onto, tell_sampled
from ._poses import Poses, mixed, motion_of, moved, poses_of, smooth, strung
from ._seams import bends, centimetres, steps

USUAL = 99.5  # percent of a clip's frames that are below what is counted as its fastest
LEAD = 0.05  # seconds before the cut that are compared where nothing overlaps
TRIED = 12  # pairs of frames, of which the one that shows least is taken
GOOD = 0.95  # of what the clips do themselves: below, nothing shows
SLIDING = 2.0 * SPEED  # rest heights a second: of a foot that should rest, as bad as a step beyond the usual
SAME_TIME = 1e-6  # seconds: times are given in decimal digits


@dataclass(frozen=True)
class Join:
    """Where two clips were joined, and how well.

    leave:        seconds in the first clip at which the transition begins.
    enter:        seconds in the second clip that belong there.
    frames:       of the transition.
    unit:         of the distance: "cm", or "units" of the file where nobody knows how long these are.
    turn:         degrees by which the second clip was turned.
    distance:     between the two clips over the transition, root mean square over joints, after alignment.
    step:         the largest step of a joint in the transition, as a part of the steps of the calmer of the two clips:
                  of what 99.5 % of its frames stay below.
    acceleration: the largest acceleration of a joint, as a part in the same way.
    foot_speed:   per second, mean over the transition, of feet that rest in both clips; None where none does.
    """

    leave: float
    enter: float
    frames: int
    unit: str
    turn: float
    distance: float
    step: float
    acceleration: float
    foot_speed: float | None

    def __str__(self) -> str:
        feet = "" if self.foot_speed is None else f"\nfeet that rest in both go {self.foot_speed:.3g} {self.unit}/s"
        return (
            f"from {self.leave:.3f} s over to {self.enter:.3f} s in {self.frames} frames, turned by "
            f"{self.turn:.3g} degrees\nthere they are {self.distance:.3g} {self.unit} apart\n"
            f"largest step {self.step:.2f}, largest acceleration {self.acceleration:.2f} of the clips' own{feet}"
        )

    def to_json(self) -> dict[str, Any]:
        """The same as plain numbers and texts."""
        return asdict(self)


def join(
    first: Clip,
    second: Clip,
    *,
    leave: float | None = None,
    enter: float | None = None,
    seconds: float = 0.4,
    mode: str = "overlap",
    match: str = "exact",
) -> Motion:
    """The first motion and then the second, which is moved and turned to where the first has arrived.

    Parameters
    ----------
    leave
        Second of the first clip at which the transition begins; by default the best in its second half.
    enter
        Second of the second clip that belongs there; by default the best in its first half.
    seconds
        How long the transition takes.
    mode
        overlap: both go on, and the one fades into the other. inertial: the second alone goes on, and what the first
        was ahead in pose and speed dies away; it needs nothing of the first after the cut.
    match
        exact: both bodies have the same joints and channels. names: the second's rotations are put on the joints of the
        first that are called the same; others hold still.

    The result has the body and the frame time of the first, whose frames before the transition stay to the last digit.
    Where the bones are longer in one, the second's way and height are scaled as its legs, and both stand on the same
    floor. The last step of its `history` has the numbers of `Join` under "measured". Errors: Mismatch for bodies that
    do not match, OptionError for times that do not lie in the clips.

    >>> both = mc.join(mc.read("walk.bvh"), mc.read("run.bvh"))
    """
    if mode not in MODES:
        raise UnknownName("mode", mode, MODES)
    check(first.skeleton, second.skeleton, match)
    tell_sampled([first, second], "a transition is made of frames")
    a, b = complete(first.sample()), _at_rate(second, first.frame_time)
    count = _count(seconds, a.frame_time)
    at = (_frame(leave, a, "first"), _frame(enter, b, "second"))
    fitted = _fitted(a, b, a.frames - 1)
    cuts = _cuts_of(a, fitted, count, mode, at)
    usual = _usual(a, fitted)
    tried = []
    for i, j in cuts:
        after = MODES[mode](a, _fitted(a, b, i), i, j, count)
        tried.append((i, after, _measured(a, fitted, after, (i, j, count), usual)))
    i, after, found = min(tried, key=lambda one: _shows(one[2], a))
    told = {"verb": "join", "leave": leave, "enter": enter, "seconds": seconds, "mode": mode, "match": match}
    history = (*first.history, {**told, "measured": found.to_json()})
    return replace(a, values=np.vstack([a.values[:i], after.values]), history=history, report=None)


# -- in call order ---------------------------------------------------------------------------------


def _at_rate(clip: Clip, frame_time: float) -> Motion:
    """The samples of a clip at another clip's frame time."""
    if clip.frame_time == frame_time:
        return complete(clip.sample())
    return at_times(clip, np.arange(frame_count(clip.duration, frame_time)) * frame_time, frame_time)


def _count(seconds: float, frame_time: float) -> int:
    if not (np.isfinite(seconds) and seconds > 0):
        raise OptionError(f"a transition takes a positive number of seconds, not {seconds!r}")
    return max(2, round(seconds / frame_time))


def _frame(time: float | None, motion: Motion, which: str) -> int | None:
    if time is None:
        return None
    if not -SAME_TIME <= time <= motion.duration + SAME_TIME:
        raise OptionError(f"{time:g} s is not in the {which} clip: it ends at {motion.duration:g} s")
    return round(time / motion.frame_time)


def _fitted(a: Motion, b: Motion, held: int) -> Motion:
    """The second motion on the first body and floor; joints that it does not have hold still as in a frame of the
    first."""
    if not min(a.frames, b.frames):
        raise OptionError("a clip without frames cannot be joined")
    fitted, _ = onto(replace(a, values=np.repeat(a.values[[held]], b.frames, axis=0)), b)
    if len(a.skeleton.names) == len(b.skeleton.names) and np.allclose(a.skeleton.offsets, b.skeleton.offsets):
        return fitted
    (floor, _), (own_floor, own_height), (_, height) = (_standing(clip) for clip in (a, b, fitted))
    scale = height / own_height if own_height > 0 and height > 0 else 1.0
    moves = ~a.skeleton.rotation_channels & (a.skeleton.parents[a.skeleton.channel_joints] < 0)
    upright = moves & (a.skeleton.channel_axes == 1)
    values = np.array(fitted.values, order="F")
    values[:, moves] *= scale
    values[:, upright] += floor - scale * own_floor
    return replace(fitted, values=values)


def _standing(motion: Motion) -> tuple[float, float]:
    """Where the floor is, and how high the root stands above the lowest joint: medians over the frames."""
    heights = world(motion)[..., 1]
    lowest = heights.min(axis=1)
    return float(np.median(lowest)), float(np.median(heights[:, 0] - lowest))


def _cuts_of(a: Motion, b: Motion, count: int, mode: str, at: tuple[int | None, int | None]) -> list[tuple[int, int]]:
    """Frames of both clips at which the transition may begin, the pair that is most alike first."""
    beyond = count if mode == "overlap" else 1  # frames that the first clip must still have
    lead = 0 if mode == "overlap" else min([round(LEAD / a.frame_time), *(frame for frame in at if frame is not None)])
    away = int(first_frame_is_t_pose(b))
    spots = []
    for which, clip, given, needed, low, high in (
        ("first", a, at[0], beyond, a.frames // 2, a.frames),
        ("second", b, at[1], count, away + lead, b.frames // 2),
    ):
        last = clip.frames - needed
        if last < (lead if given is None else given):
            raise OptionError(f"the {which} clip is too short for a transition of {count} frames there")
        first = min(max(low, lead), last) if given is None else given
        end = max(min(high, last), first) if given is None else given
        spots.append(range(first - lead, end - lead + 1))
    window = count if mode == "overlap" else lead + 1
    return [(i + lead, j + lead) for i, j in _cuts.find(world(a), world(b), window, spots[0], spots[1], TRIED)]


def _overlap(a: Motion, b: Motion, i: int, j: int, count: int) -> Motion:
    """From frame i of a on: so many frames fade from a to b, which then goes on."""
    poses, others = poses_of(a[i : i + count]), poses_of(b[j:])
    step = planar.align(_cloud(a, i, count), _cloud(b, j, count))
    others = moved(others, a.skeleton, step)
    weights = smooth(np.arange(1, count + 1) / (count + 1))
    return _continued(a, b, i, j, strung(mixed(poses, others[:count], weights), others[count:]))


def _inertial(a: Motion, b: Motion, i: int, j: int, count: int) -> Motion:
    """From frame i of a on: b, with what a was ahead of it in pose and speed, dying away in so many frames."""
    lead = min(i, j, 1)
    step = planar.align(_cloud(a, i - lead, lead + 1), _cloud(b, j - lead, lead + 1))
    before, others = poses_of(a[i - lead : i + 1]), moved(poses_of(b[j - lead :]), a.skeleton, step)
    shifts = before.shifts - others.shifts[: lead + 1]
    turns = rotation.log(rotation.mul(rotation.inv(others.turns[: lead + 1]), before.turns))
    u = np.minimum(np.arange(len(others) - lead) / count, 1.0)[:, None, None]
    place = 1.0 - smooth(u)
    speed = count * u * (1.0 - u * u * (6.0 - u * (8.0 - 3.0 * u)))
    shift, turn = (
        place * ahead[lead] + speed * (ahead[lead] - ahead[0]) / max(lead, 1) / max(lead, 1)
        for ahead in (shifts, turns)
    )
    others = others[lead:]
    return _continued(a, b, i, j, Poses(others.shifts + shift, rotation.mul(others.turns, rotation.exp(turn))))


MODES: dict[str, Callable[[Motion, Motion, int, int, int], Motion]] = {"overlap": _overlap, "inertial": _inertial}


def _cloud(motion: Motion, first: int, count: int) -> np.ndarray:
    """All joints (N, 3) of some frames."""
    return world(motion[first : first + count]).reshape(-1, 3)


def _continued(a: Motion, b: Motion, i: int, j: int, poses: Poses) -> Motion:
    """The motion in these poses, its channels going on from where a leaves them at frame i."""
    values = np.array(b.values[j:], order="F")
    values[0] = a.values[i]
    made = motion_of(poses, replace(b, values=values))
    lead = a.values[max(i - 1, 0) : max(i, 1)]
    smooth_on = unroll(replace(made, values=np.vstack([lead, made.values])))
    return smooth_on[1:]


def _usual(a: Motion, b: Motion) -> tuple[float, float]:
    """The largest usual step and bend of a joint in the calmer of two clips, file units, without T-poses in front."""
    places = [world(clip[int(first_frame_is_t_pose(clip)) :]) for clip in (a, b)]
    usual = [[float(np.percentile(of(p), USUAL)) if len(p) > 2 else 0.0 for p in places] for of in (steps, bends)]
    return min(usual[0]), min(usual[1])


def _measured(a: Motion, b: Motion, after: Motion, cut: tuple[int, int, int], usual: tuple[float, float]) -> Join:
    """The numbers of a transition: a up to frame i, then `after`, in which so many frames are neither a nor b."""
    i, j, count = cut
    lead = min(i, 3)
    both = replace(a, values=np.vstack([a.values[i - lead : i], after.values[: count + 3]]), report=None)
    places = world(both)
    overlap = min(count, a.frames - i)
    here, there = world(a[i : i + overlap]), world(b[j : j + overlap])
    apart = here - planar.move(planar.align(here.reshape(-1, 3), there.reshape(-1, 3)), there)
    turn = planar.align(world(after[-1:])[0], world(b[-1:])[0])[0]
    length = centimetres(a)
    scale = length or 1.0
    rests = planted(a)[:, i : i + overlap] & planted(b)[:, j : j + overlap]
    speed = np.linalg.norm(np.gradient(places, axis=0), axis=-1)[lead : lead + overlap].T / a.frame_time
    ratios = [
        float(of(places).max()) / most if most > 0 else 0.0 for of, most in zip((steps, bends), usual, strict=True)
    ]
    return Join(
        leave=i * a.frame_time,
        enter=j * a.frame_time,
        frames=count,
        unit="cm" if length else "units",
        turn=float(np.degrees(turn)),
        distance=scale * float(np.sqrt((apart**2).sum(axis=-1).mean())),
        step=ratios[0],
        acceleration=ratios[1],
        foot_speed=scale * float(speed[rests].mean()) if rests.any() else None,
    )


def _shows(found: Join, a: Motion) -> tuple[float, float]:
    """How much a transition shows: first what goes beyond what the clips do themselves, then its distance."""
    sliding = SLIDING * rest_height(a) * (centimetres(a) or 1.0)
    feet = found.foot_speed / sliding if found.foot_speed is not None and sliding > 0 else 0.0
    return max(found.step, found.acceleration, feet, GOOD), found.distance
