"""The verb `follow`: a motion laid along another path (Gleicher 2001, Motion path editing).

A motion is taken relative to its own path, to axes that stand upright, look along the path and move as the body does;
these are put onto the other path, at the same distance from its beginning.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from ..errors import Mismatch, MocurveError, OptionError, UnknownName
from ..info import z_is_up
from ..kinematics import world
from ..motion import Clip, Motion
from ..path import Fit, Path
from ..path_files import as_json, of_json
from ..path_fit import fitted, gone, lead, roots
from ..path_length import LengthTable
from . import _bearing
from ._along import ENDS, STRIDES, Course, Way, way
from ._carry import Plan, at_frames, carried_out, laid
from ._facing import progress
from ._pair import check_mode, complete, recorded, tell_sampled
from ._repeat import repeated
from ._seams import centimetres
from ._steps import Steps, stepping

MODES = ("arclength", "time", "scaled", "span")
HEADINGS = ("tangent", "facing")
POSTURES = ("upright", "tangent")
LOOKED_AT = 500  # frames, to tell how far the root is from its path
UP = 8  # frames, to see which way that is
NOTHING = 1e-10  # of the path's size: a frame that is moved by less stays where it is


@dataclass(frozen=True)
class Following:
    """What became of the clip's own path.

    unit:        of the lengths that follow: "cm", or "units" of the file where nobody knows how long these are.
    own_length:  of the clip's own path; length: of the new one.
    travelled:   along the new path, from the first frame to the last.
    beyond:      how much of that lies straight on behind an end of the path.
    residual:    how far the root is from the clip's own path, root mean square.
    frames:      of the result; cycles: how often the motion begins in it.
    stride:      how long strides are where only a span was edited, times the source's; slower: how much time they take.
    first, last: frame from which and to which the result differs from the clip; None where it does not.
    turned:      the most that a frame is turned, degrees.
    feet:        the numbers of `Steps`; None where no feet were held.
    """

    unit: str
    own_length: float
    length: float
    travelled: float
    beyond: float
    residual: float
    frames: int
    cycles: int
    stride: float
    slower: float
    first: int | None
    last: int | None
    turned: float
    feet: dict[str, Any] | None = None

    def __str__(self) -> str:
        again = f", {self.cycles} cycles" if self.cycles > 1 else ""
        lines = [
            f"own path: {self.own_length:.4g} {self.unit}, the root {self.residual:.3g} {self.unit} away from it",
            f"new path: {self.length:.4g} {self.unit}, {self.travelled:.4g} {self.unit} of it gone along in "
            f"{self.frames} frames{again}",
        ]
        if self.beyond > 0.001 * self.length:
            lines.append(f"the path is shorter than that: {self.beyond:.4g} {self.unit} lie straight on behind its end")
        if self.stride != 1.0:
            time = "" if self.slower == 1.0 else f" and take {self.slower:.3g} times the time"
            lines.append(f"in the edited span strides are {self.stride:.3g} times as long{time}")
        changed = "nothing" if self.first is None else f"frames {self.first} to {self.last}"
        lines.append(f"changed: {changed}, turned by up to {self.turned:.3g} degrees")
        return "\n".join(lines if self.feet is None else [*lines, str(Steps(**self.feet))])

    def to_json(self) -> dict[str, Any]:
        """The same as plain numbers and texts."""
        return asdict(self)


def follow(
    clip: Clip,
    path: Path | Sequence[Any] | Mapping[str, Any],
    *,
    mode: str = "arclength",
    at_end: str = "extend",
    heading: str = "tangent",
    posture: str = "upright",
    of: Path | None = None,
    lock_feet: bool = True,
) -> Motion:
    """The motion laid along a path: what it does relative to its own path, it does relative to the new one.

    Parameters
    ----------
    mode
        How far along the new path a frame is. arclength: as far as it was along the clip's own path, so that the speed
        stays. time: where the curve's parameter is the same. scaled: so that the clip fills the path, with longer or
        shorter strides. span: only where control points of the clip's own path were moved is anything changed.
    at_end
        Where one of the two is longer, for mode arclength. extend: straight on behind the path's end. truncate: the
        clip ends with the path. stop: it comes to rest there. reset: it begins again there, as does the path. scale:
        strides are shortened to fit. cycle: the clearest cycle is repeated to the path's end.
    heading
        tangent: the body turns as the path does. facing: so too, but where it backs up it goes back along the path.
    posture
        On a path with heights. upright: the body is lifted. tangent: it also leans with the slope.
    of
        The path that the clip is on; by default the one that the path is an edit of, or one that is fitted.
    lock_feet
        Hold feet still where they stand in the clip, as the verb lock_feet does, where the path moves them unevenly.

    The path is in the clip's length unit, on the ground x, z with y up: a `Path`, or its points. The own path laid back
    changes nothing; one moved as a whole moves the motion so. The last step of `history` has the numbers of `Following`
    under "measured", and under "table" of every frame which frame it was, in which cycle, and its distance along the
    path. Errors: OptionError and Mismatch for paths and options that do not fit the clip. Warnings: of a clip that goes
    nowhere, of strides beyond 0.6 to 1.15, of a path that asks too much of the legs, of a body that has none.

    >>> tour = mc.follow(walk, mc.Path([(0, 0), (200, 80), (400, -80), (600, 0)]), at_end="cycle")
    """
    given = _path(path)
    own_given = None if of is None else _path(of)
    _check(mode, at_end, heading, posture, own_given)
    if not isinstance(lock_feet, bool):
        raise OptionError(f"lock_feet is true or false, not {lock_feet!r}")
    tell_sampled((clip,), "a body is moved along a path frame by frame")
    motion = complete(clip.sample())
    if not motion.frames:
        raise Mismatch("a clip without frames follows no path")
    _tell_up(motion)
    ahead = lead(motion)
    body = replace(motion[ahead:], history=motion.history)  # of which the path of the last step is asked
    start, every = 0, body.frames
    course = _course(body, ahead, given, own_given)
    table = given.table()
    if at_end == "cycle" and table.length > course.table.length * (1.0 + NOTHING):
        body, start, every = repeated(body, table.length)
        course = _course(body, 0, None, None)
        start, ahead = start + ahead, 0  # a T-pose is no part of a cycle
    found, back = _found(body, course, given, table, (mode, at_end, heading))
    base = at_frames(body, found.frame)
    plan = _planned(base, course, given, table, found, back, posture)
    made, steps = _made(base, plan, found, lock_feet, ahead)
    frames = found.frame if every == body.frames else np.mod(found.frame, every)
    cycle = found.cycle if every == body.frames else (found.frame // every).astype(np.int64)
    rows = {"frame": frames + start + ahead, "cycle": cycle, "distance": found.distance}
    if ahead:
        made = _with_lead(made, motion[:ahead], Plan(*(part[:1] for part in plan)))
        rows = {name: np.concatenate([row[:1] if name != "frame" else [0], row]) for name, row in rows.items()}
    measured = _measured(base, made, course, table, found, plan.by, int(cycle[-1]) + 1)
    measured = replace(measured, feet=None if steps is None else steps.to_json())
    _tell(measured)
    step: dict[str, Any] = {"verb": "follow", "path": as_json(given), "mode": mode, "at_end": at_end}
    step |= {"heading": heading}
    step |= {"posture": posture, "of": None if own_given is None else as_json(own_given), "lock_feet": lock_feet}
    step |= {"measured": measured.to_json(), "table": {name: row.tolist() for name, row in rows.items()}}
    return recorded(made, (*clip.history, step))  # type: ignore[return-value]  # a Motion stays one


def own_path(clip: Clip, path: Path, of: Path | None = None) -> Path:
    """The path that `follow` takes the clip to be on."""
    motion = complete(clip.sample())
    ahead = lead(motion)
    return _course(motion[ahead:], ahead, path, of).path


# -- in call order ---------------------------------------------------------------------------------


def _path(given: object) -> Path:
    """A path, or what its points or its JSON say."""
    if isinstance(given, Path):
        return given
    try:
        if isinstance(given, Mapping):
            return of_json(dict(given))
        return Path(given)  # type: ignore[arg-type]  # it checks what it gets
    except MocurveError as error:
        raise OptionError(str(error)) from error


def _check(mode: str, at_end: str, heading: str, posture: str, of: Path | None) -> None:
    check_mode(mode, MODES)
    for what, name, names in (
        ("way to end", at_end, tuple(ENDS)),
        ("heading", heading, HEADINGS),
        ("posture", posture, POSTURES),
    ):
        if name not in names:
            raise UnknownName(what, name, names)
    if mode != "arclength" and at_end != "extend":
        raise OptionError(f"at_end {at_end} is for mode arclength: in mode {mode} clip and path end together")
    if mode != "arclength" and heading == "facing":
        raise OptionError(f"heading facing is for mode arclength, not {mode}")
    if at_end == "cycle" and of is not None:
        raise OptionError("at_end cycle repeats the clip, which then has a path of its own: leave `of` out")


def _tell_up(motion: Motion) -> None:
    frames = np.unique(np.linspace(0, motion.frames - 1, UP).astype(int))
    if z_is_up(world(replace(motion, values=motion.values[frames], report=None))):
        warnings.warn("the body seems to stand along z: a path lies on the ground x, z, with y up", stacklevel=3)


def _course(body: Motion, ahead: int, path: Path | None, of: Path | None) -> Course:
    """The clip's own path: the one that is given, that the last step put it onto, or that is fitted."""
    if of is None and path is not None:
        step = body.history[-1] if body.history else {}
        distance = np.array(step.get("table", {}).get("distance", [])) if step.get("verb") == "follow" else np.zeros(0)
        if len(distance) == body.frames + ahead and (np.diff(distance) >= 0).all() and not step["table"]["cycle"][-1]:
            own = of_json(step["path"])
            return Course(own, own.table(), distance[ahead:])
    own = of or fitted(body, (path and path.fit) or Fit())
    table = own.table()
    return Course(own, table, table.distance(gone(body)))


def _found(
    body: Motion, course: Course, path: Path, table: LengthTable, options: tuple[str, str, str]
) -> tuple[Way, np.ndarray]:
    """The way along the path, and which frames (G,) of it go backwards."""
    mode, at_end, heading = options
    if heading == "tangent":
        found = way(course, path, table, mode, at_end, body.frame_time)
        return found, np.zeros(len(found.frame), bool)
    distance, back = progress(body, course, path, table, _bearing.gate(body)[0])
    signed = replace(course, distance=distance)
    found = way(signed, path, table, mode, at_end, body.frame_time)
    frames = found.frame.astype(np.int64)
    return replace(found, own=course.distance[frames]), back[frames]


def _planned(
    base: Motion, course: Course, path: Path, table: LengthTable, found: Way, back: np.ndarray, posture: str
) -> Plan:
    """What is done to the root of every frame (G,); nothing to those that are kept."""
    some = np.flatnonzero(~found.kept)
    plan = Plan(*(np.zeros((len(found.kept), width)) for width in (3, 1, 1, 4)))
    if not len(some):
        return plan
    own, distance = found.own[some], found.distance[some]
    (old, old_heading), (new, new_heading) = course.path.at(own, course.table), path.at(distance, table)
    turn = np.zeros(len(some))
    if course.table.length > 0 and table.length > 0:
        turn = _turned(base, found, some, old_heading, new_heading + np.pi * back[some])
    by = laid(turn, old[:, [0, -1]], new[:, [0, -1]])
    rises, rose = new.shape[1] == 3, old.shape[1] == 3
    lift = (new[:, 1] if rises else 0.0) - (old[:, 1] if rises and rose else 0.0) + np.zeros(len(some))
    pitch = np.zeros(len(some))
    if posture == "tangent" and rises:
        pitch = path.slope(table.parameter(distance)) - course.path.slope(course.table.parameter(own))
    near = NOTHING * (1.0 + max(table.length, course.table.length))
    same = (np.abs(by).max(axis=1, initial=0.0) <= near) & (np.abs(lift) <= near) & (np.abs(pitch) <= NOTHING)
    about = np.stack([new[:, 0], new[:, 1] if rises else lift, new[:, -1], new_heading], axis=1)
    for whole, part in zip(plan, (by, lift[:, None], pitch[:, None], about), strict=True):
        whole[some] = np.where(same[:, None], 0.0, part)
    return plan


def _turned(base: Motion, found: Way, some: np.ndarray, old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Radians (S,) by which the body is turned at some frames (S,)."""
    limits, width = _bearing.gate(base), _bearing.WIDTH / base.frame_time
    moves = [_bearing.speeds(d[some], found.cycle[some], base.frame_time) for d in (found.own, found.distance)]
    speed = np.sqrt(moves[0] * moves[1])  # of both alike, so that the way back is weighted as the way there
    turn = np.zeros(len(some))
    for run in _bearing.runs(found.cycle[some]):
        before, after = some[run.start] - 1, some[run.stop - 1] + 1
        held = before >= 0 and bool(found.kept[before]), after < len(found.kept) and bool(found.kept[after])
        turn[run] = _bearing.turns(old[run], new[run], speed[run], limits, width, held)
    return turn


def _made(base: Motion, plan: Plan, found: Way, lock_feet: bool, ahead: int) -> tuple[Motion, Steps | None]:
    """The base carried as planned, its feet held if that is asked for and something is not carried as one."""
    if not lock_feet:
        return carried_out(base, plan), None
    parts = []
    for run in _bearing.runs(found.cycle):  # no foot stands from one beginning of the motion into the next
        parts.append(stepping(base[run], plan.by[run], ahead + run.start))
    made = replace(base, values=np.concatenate([part.values for part, _ in parts]), report=None)
    return carried_out(made, plan._replace(by=np.zeros_like(plan.by))), Steps.of([steps for _, steps in parts])


def _with_lead(made: Motion, first: Motion, plan: Plan) -> Motion:
    """The T-pose in front again, moved as the first frame is."""
    values = np.concatenate([carried_out(first, plan).values, made.values])
    return replace(made, values=values)


def _measured(
    base: Motion, made: Motion, course: Course, table: LengthTable, found: Way, by: np.ndarray, cycles: int
) -> Following:
    length = centimetres(base)
    scale = length or 1.0
    some = np.arange(0, base.frames, max(1, base.frames // LOOKED_AT))
    place = course.path.at(found.own[some], course.table)[0][:, [0, -1]]
    away = np.linalg.norm(roots(base)[some][:, [0, 2]] - place, axis=1)
    ahead = made.frames - base.frames
    moved = ahead + np.flatnonzero((made.values[ahead:] != base.values).any(axis=1))
    return Following(
        unit="cm" if length else "units",
        own_length=scale * course.table.length,
        length=scale * table.length,
        travelled=scale * sum(float(np.abs(np.diff(found.distance[run])).sum()) for run in _bearing.runs(found.cycle)),
        beyond=scale * float(np.ptp(found.distance) - np.ptp(np.clip(found.distance, 0.0, table.length))),
        residual=scale * float(np.sqrt(np.mean(away**2))),
        frames=made.frames,
        cycles=cycles,
        stride=found.stride,
        slower=found.slower,
        first=int(moved[0]) if len(moved) else None,
        last=int(moved[-1]) if len(moved) else None,
        turned=float(np.degrees(np.abs(by[:, 0]).max(initial=0.0))),
    )


def _tell(measured: Following) -> None:
    if measured.own_length <= 0.0 < measured.length:
        warnings.warn("the clip goes nowhere: it is put where the path begins, facing as it does", stacklevel=3)
    if not STRIDES[0] <= measured.stride <= STRIDES[1]:
        warnings.warn(
            f"the edit makes strides {measured.stride:.3g} times as long, beyond {STRIDES[0]} to {STRIDES[1]}: "
            f"the rest goes into time, {measured.slower:.3g} times as much",
            stacklevel=3,
        )
