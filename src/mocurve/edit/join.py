"""The verb `join`: from one motion over into another, where the two look most alike."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from .. import planar
from ..errors import OptionError
from ..feet.planted import SPEED
from ..info import first_frame_is_t_pose
from ..kinematics import rest_height, world
from ..motion import Clip, Motion, complete, frame_count
from ..spline import SplineMotion
from . import _cuts
from ._couple import Pair, at_rate, paired
from ._pair import check, check_mode, recorded, same_curves, tell_sampled
from ._seams import bends, centimetres, steps
from ._splices import carried, spliced
from ._transitions import MODES, Cut, alignments, joined

TRIED = 24  # cuts, of which the one that shows least is taken
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
    distance:     between the two clips over the transition, root mean square over joints, as they were placed.
    step:         the largest step of a joint in the transition, as a part of the steps of the calmer of the two clips:
                  of what 99.5 % of its frames stay below.
    acceleration: the largest acceleration of a joint, as a part in the same way.
    foot_speed:   per second, mean over the transition, of feet that rest in both clips; None where none does.
    off:          degrees by which a root's angles are off where splines cannot say its turning exactly, else 0.
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
    off: float = 0.0

    def __str__(self) -> str:
        feet = "" if self.foot_speed is None else f"\nfeet that rest in both go {self.foot_speed:.3g} {self.unit}/s"
        off = f"\nthe turned root is fitted to {self.off:.2g} degrees" if self.off else ""
        return (
            f"from {self.leave:.3f} s over to {self.enter:.3f} s in {self.frames} frames, turned by "
            f"{self.turn:.3g} degrees\nthere they are {self.distance:.3g} {self.unit} apart\n"
            f"largest step {self.step:.2f}, largest acceleration {self.acceleration:.2f} of the clips' own{feet}{off}"
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
) -> Clip:
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
        was ahead in pose and speed dies away; it needs nothing of the first after the cut. spline: the coefficients of
        both, on the same knots, fade channel by channel; two splines stay a spline.
    match
        exact: both bodies have the same joints and channels. names: the second's rotations are put on the joints of the
        first that are called the same; others hold still.

    The result has the body and the frame time of the first, whose frames before the transition stay to the last digit.
    Where the bones are longer in one, the second's way and height are scaled as its legs, and both stand on the same
    floor. The last step of its `history` has the numbers of `Join` under "measured". Errors: Mismatch for bodies that
    do not match, OptionError for times that do not lie in the clips.

    >>> both = mc.join(mc.read("walk.bvh"), mc.read("run.bvh"))
    """
    check_mode(mode, tuple(MODES))
    check(first.skeleton, second.skeleton, match)
    as_splines = mode == "spline" and isinstance(first, SplineMotion) and same_curves([first, second])
    if not as_splines:
        tell_sampled([first, second], "a transition is made of frames (of two splines, mode spline makes a spline)")
    a, b = complete(first.sample()), at_rate(second, first.frame_time)
    count = _count(seconds, a.frame_time)
    at = (_frame(leave, a, "first"), _frame(enter, b, "second"))
    away = int(first_frame_is_t_pose(b))  # frames of the second that are not entered, and have no speed
    pair = paired(a, replace(b, values=np.vstack([b.values[away : 2 * away], b.values[away:]])))
    cut, found = _best(pair, _cuts_of(pair, count, mode, at, away), count, mode)
    if as_splines:
        made: Clip
        made, found = _spliced(first, second, pair, cut)  # type: ignore[arg-type]  # both are splines
    else:
        after = joined(a, pair.holding(cut.i), cut, mode)
        made = replace(a, values=np.vstack([a.values[: cut.i], after.values]))
    told = {"verb": "join", "leave": leave, "enter": enter, "seconds": seconds, "mode": mode, "match": match}
    step = {**told, "measured": found.to_json(), "with": list(second.history)}
    return recorded(made, (*first.history, step))


# -- in call order ---------------------------------------------------------------------------------


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


def _cuts_of(
    pair: Pair, count: int, mode: str, at: tuple[int | None, int | None], away: int = 0
) -> list[tuple[int, int]]:
    """Frames of both clips at which the transition may begin, the best pair first."""
    a, b = pair.a, pair.b
    if at[1] == 0 and away:
        raise OptionError("the second clip cannot be entered at 0 s: its first frame is a T-pose")
    again = a.frames == b.frames and np.array_equal(
        a.values[away:], b.values[away:]
    )  # not to be left where it is entered
    spots = []
    for which, clip, given, needed, low, high in (
        ("first", a, at[0], {"overlap": count, "inertial": 1, "spline": count + 1}[mode], a.frames // 2, a.frames),
        ("second", b, at[1], count + (mode == "spline"), away, b.frames // 2 - again * count),
    ):
        last = clip.frames - needed
        if last < (0 if given is None else given):
            raise OptionError(f"the {which} clip is too short for a transition of {count} frames there")
        first = min(low, last) if given is None else given
        spots.append(range(first, max(min(high, last), first) + 1 if given is None else given + 1))
    return _cuts.find(_candidates(pair, count, mode), spots[0], spots[1], max(1, count // 4), TRIED)


def _candidates(pair: Pair, count: int, mode: str) -> _cuts.Candidates:
    places, others = world(pair.a), world(pair.b)
    resting, rest = pair.resting
    feet = resting.any(axis=1) | rest.any(axis=1)
    rough = np.ones(len(others))
    if mode == "inertial" and pair.usual[1] > 0:  # nothing hides what the second clip does itself
        own = np.pad(bends(others), (0, count + 2), constant_values=0.0) / pair.usual[1]
        rough = np.maximum(np.lib.stride_tricks.sliding_window_view(own, count + 3).max(axis=1), 1.0)
    alone = mode == "inertial"
    return _cuts.Candidates(
        places, others, resting[feet].T, rest[feet].T, 1 if alone else count, 0.5 * count * alone, rough
    )


def _best(pair: Pair, cuts: list[tuple[int, int]], count: int, mode: str) -> tuple[Cut, Join]:
    """The cut and the alignment that show least."""
    tried = []
    for i, j in cuts:
        b = pair.holding(i)
        for step in alignments(pair.a, b, (i, j), count, mode, pair.both_rest(i, j, count)):
            cut = Cut(i, j, count, step)
            tried.append((cut, _measured(pair, joined(pair.a, b, cut, mode, after=3), cut)))
    return min(tried, key=lambda one: _shows(one[1], pair.a))


def _measured(pair: Pair, after: Motion, cut: Cut, off: float = 0.0) -> Join:
    """The numbers of a transition: a up to frame i, then `after`, in which so many frames are neither a nor b."""
    a, b, (i, j, count, step) = pair.a, pair.b, cut
    lead = min(i, 3)
    places = world(replace(a, values=np.vstack([a.values[i - lead : i], after.values[: count + 3]]), report=None))
    overlap = min(count, a.frames - i)
    here, there = a[i : i + overlap], b[j : j + overlap]
    apart = world(here) - planar.move(step, world(there))
    length = centimetres(a)
    scale = length or 1.0
    rests = pair.both_rest(i, j, count)
    speed = np.linalg.norm(np.gradient(places, axis=0), axis=-1)[lead : lead + overlap].T / a.frame_time
    ratios = [
        float(of(places).max()) / most if most > 0 else 0.0 for of, most in zip((steps, bends), pair.usual, strict=True)
    ]
    return Join(
        leave=i * a.frame_time,
        enter=j * a.frame_time,
        frames=count,
        unit="cm" if length else "units",
        turn=float(np.degrees(np.remainder(step[0] + np.pi, 2.0 * np.pi) - np.pi)),
        distance=scale * float(np.sqrt((apart**2).sum(axis=-1).mean())),
        step=ratios[0],
        acceleration=ratios[1],
        foot_speed=scale * float(speed[rests].mean()) if rests.any() else None,
        off=off,
    )


def _shows(found: Join, a: Motion) -> tuple[float, float]:
    """How much a transition shows: first what goes beyond what the clips do themselves, then its distance, and how far
    feet that rest go."""
    sliding = SLIDING * rest_height(a) * (centimetres(a) or 1.0)
    speed = found.foot_speed or 0.0
    feet = speed / sliding if sliding > 0 else 0.0
    return max(found.step, found.acceleration, feet, GOOD), found.distance + speed * found.frames * a.frame_time


def _spliced(first: SplineMotion, second: SplineMotion, pair: Pair, cut: Cut) -> tuple[SplineMotion, Join]:
    """The same with the splines themselves."""
    step = pair.a.frame_time
    leave, enter = cut.i * step, cut.j * step
    second = replace(second, skeleton=first.skeleton, values=second.values * pair.factors + pair.added)
    placed, off = carried(replace(second, knots=second.knots + (leave - enter)), cut.step)
    made = spliced(first, placed, leave, leave + cut.frames * step)
    frames = cut.i + frame_count(second.duration - enter, step)
    made = replace(made, frames=frames, frame_time=step)
    return made, _measured(pair, made.sample()[cut.i :], cut, off)
