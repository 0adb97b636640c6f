"""A clip made ready to be laid along one path after another: all that is known of it before a path is given.

Whoever draws a path and watches lays the same clip many times. What does not depend on the new path, the clip's own
path, its contacts, its legs, is looked for once.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..errors import Mismatch, MocurveError, OptionError, UnknownName
from ..info import tell_up
from ..motion import Clip, History, Motion, complete
from ..path import Fit, Path, walkable
from ..path_files import as_json, of_json
from ..path_fit import fitted, gone, lead
from ..path_length import LengthTable
from . import _bearing
from ._along import ENDS, Course, Way, way
from ._along import at_frames as distances_at
from ._carry import Plan, at_frames, carried_out, laid
from ._facing import progress
from ._following import measured, tell
from ._heights import Line, steep
from ._pace import paced
from ._pair import check_mode, recorded, tell_sampled
from ._repeat import repeated
from ._steps import Feet, Steps, stepping

MODES = ("arclength", "paced", "time", "scaled", "span")
ALONG = ("arclength", "paced")  # that keep distances, so that clip and path need not end together
HEADINGS = ("tangent", "facing", "kept")
POSTURES = ("upright", "lift", "tangent")
ROUNDS = 60  # in which the way back is looked for; walks and runs take 5 to 20
SAME = 1e-4  # of a path's length: a fit as near is the path that was fitted, written with few digits
NOTHING = 1e-10  # of places on the paths: a frame that is moved by less stays where it is


@dataclass(frozen=True, eq=False)
class PathEdit:
    """A clip whose path is edited. `laid` is what the verb `follow` does, without looking for all of this again.

    motion: its samples. ahead: how many frames in front are a T-pose, and no part of the path. body: the others.
    course: the clip's own path, and how far along it every frame is. feet: its legs and contacts; None where feet are
    not held. said: whether the path was given; fit: how it was fitted, None where it was not.

    >>> edit = mc.PathEdit.of(mc.read("walk.bvh"))
    >>> made = edit.laid(edit.path.moved((0.5, 20, 0)))
    """

    motion: Motion
    history: History
    ahead: int
    body: Motion
    course: Course
    lock_feet: bool
    feet: Feet | None
    said: bool = False
    fit: Fit | None = None

    @classmethod
    def of(
        cls, clip: Clip, of: Path | Sequence[Any] | Mapping[str, Any] | None = None, *, lock_feet: bool = True
    ) -> PathEdit:
        """A clip made ready. of: the path that it is on; by default the one that it was laid along last, or one that is
        fitted. lock_feet: as that of `follow`. Errors: Mismatch for a clip without frames or with gaps."""
        return ready(clip, None, None if of is None else path_of(of), lock_feet)

    @property
    def path(self) -> Path:
        """The clip's own path: the one to move points of."""
        return self.course.path

    def laid(
        self,
        path: Path | Sequence[Any] | Mapping[str, Any],
        *,
        mode: str = "arclength",
        at_end: str = "extend",
        heading: str = "tangent",
        posture: str = "upright",
    ) -> Motion:
        """The motion laid along a path; all is as in `follow`, which has these options too."""
        given = walkable(path_of(path))
        check(mode, at_end, heading, posture, self.said)
        motion, ahead, body, course = self.motion, self.ahead, self.body, self.course
        start, every, feet, goes = 0, body.frames, self.feet, None
        table = given.table()
        if at_end == "cycle" and table.length > course.table.length * (1.0 + NOTHING):
            cycles = repeated(body, table.length)
            body, course, every = cycles.motion, cycles.course, cycles.frames
            feet = feet and feet.repeated(body, cycles.shown)
            start, ahead, goes = cycles.start + ahead, 0, cycles.goes  # a T-pose is no part of a cycle
        found, back = _found(body, course, given, table, (mode, at_end, heading))
        base = at_frames(body, found.frame)
        plan = _planned(base, course, given, table, found, back, posture)
        lines = _lines(course, given, table, found) if posture == "upright" and feet is not None else None
        made, steps = _made(base, plan, found, feet, lines, ahead)
        frames = found.frame if every == body.frames else np.mod(found.frame, every)
        cycle = found.cycle if every == body.frames else (found.frame // every).astype(np.int64)
        rows = {"frame": frames + start + ahead, "cycle": cycle, "distance": found.distance}
        if ahead:
            made = _with_lead(made, motion[:ahead], Plan(*(part[:1] for part in plan)))
            rows = {name: np.concatenate([row[:1] if name != "frame" else [0], row]) for name, row in rows.items()}
        told = measured(base, made, self.course, table, found, plan.by, (int(cycle[-1]) + 1, goes))
        told = replace(told, feet=None if steps is None else steps.to_json())
        tell(told)
        fitted_so = self.fit is None or self.fit == (given.fit or Fit())
        own = None if at_end == "cycle" or (fitted_so and not self.said) else as_json(self.path)
        step: dict[str, Any] = {"verb": "follow", "path": as_json(given), "mode": mode, "at_end": at_end}
        step |= {"heading": heading, "posture": posture, "of": own, "lock_feet": self.lock_feet}
        step |= {"measured": told.to_json(), "table": {name: row.tolist() for name, row in rows.items()}}
        return recorded(made, (*self.history, step))  # type: ignore[return-value]  # a Motion stays one


def ready(clip: Clip, path: Path | None, of: Path | None, lock_feet: bool) -> PathEdit:
    """A clip made ready for a path, which may say how its own was fitted."""
    if not isinstance(lock_feet, bool):
        raise OptionError(f"lock_feet is true or false, not {lock_feet!r}")
    tell_sampled((clip,), "a body is moved along a path frame by frame")
    motion = complete(clip.sample())
    if not motion.frames:
        raise Mismatch("a clip without frames follows no path")
    tell_up(motion, "a path lies", 5)
    ahead = lead(motion)
    body = replace(motion[ahead:], history=motion.history) if ahead else motion  # of its last step the path is asked
    course = course_of(body, ahead, path, of)
    feet = Feet.of(body) if lock_feet else None
    fit = None if of is not None or _laid_last(body, ahead) else (path and path.fit) or Fit()
    return PathEdit(motion, clip.history, ahead, body, course, lock_feet, feet, of is not None, fit)


def taken_back(edit: PathEdit, path: Path, heading: str, posture: str) -> PathEdit:
    """The clip, which is said to be on some path, made ready to go back to the one that was fitted to it before.

    How far along its path every frame is can be told only by about a centimetre: the sway of the hips goes longer or
    shorter ways on another path. What comes out has to have the same distances along the path that it goes back to: an
    equation for them, solved by putting in again what they come to. Where that does not settle, or what comes out has
    another path of its own, so that this is no way back, all stays as it was.
    """
    body, course, table = edit.body, edit.course, path.table()
    count, width = path.points.shape
    fit = path.fit or Fit(count, path.degree, path.kind, height=width == 3)
    for turn in range(ROUNDS if body.frames > 1 else 0):
        found, back = _found(body, course, path, table, ("arclength", "extend", heading))
        made = carried_out(body, _planned(body, course, path, table, found, back, posture))
        distance = table.distance(gone(made))
        settled = np.abs(distance - course.distance).max() <= NOTHING * table.length
        course = Course.of(body, course.path, course.table, distance)
        if settled and not turn:
            return edit
        if settled:
            try:
                own = fitted(made, fit).points
            except OptionError:  # more points than the clip settles
                return edit
            alike = own.shape == path.points.shape and np.abs(own - path.points).max() <= SAME * table.length
            return replace(edit, course=course) if alike else edit
    return edit


def path_of(given: object) -> Path:
    """A path, or what its points or its JSON say."""
    if isinstance(given, Path):
        return given
    try:
        if isinstance(given, Mapping):
            return of_json(dict(given))
        return Path(given)  # type: ignore[arg-type]  # it checks what it gets
    except MocurveError as error:
        raise OptionError(str(error)) from error


def check(mode: str, at_end: str, heading: str, posture: str, said: bool) -> None:
    """OptionError or UnknownName for options that are none, or do not go together."""
    check_mode(mode, MODES)
    for what, name, names in (
        ("way to end", at_end, tuple(ENDS)),
        ("heading", heading, HEADINGS),
        ("posture", posture, POSTURES),
    ):
        if name not in names:
            raise UnknownName(what, name, names)
    if mode not in ALONG and at_end != "extend":
        raise OptionError(
            f"at_end {at_end} is for modes arclength and paced: in mode {mode} clip and path end together"
        )
    if mode not in ALONG and heading == "facing":
        raise OptionError(f"heading facing is for modes arclength and paced, not {mode}")
    if at_end == "cycle" and said:
        raise OptionError("at_end cycle repeats the clip, which then has a path of its own: leave `of` out")


def course_of(body: Motion, ahead: int, path: Path | None, of: Path | None) -> Course:
    """The clip's own path: the one that is given, that the last step put it onto, or that is fitted."""
    last = _laid_last(body, ahead) if of is None else None
    if last is not None:
        return last
    own = of or fitted(body, (path and path.fit) or Fit())
    table = own.table()
    return Course.of(body, own, table, table.distance(gone(body)))


# -- in call order ---------------------------------------------------------------------------------


def _laid_last(body: Motion, ahead: int) -> Course | None:
    """The path that the last step of its history laid the body along."""
    step = body.history[-1] if body.history else {}
    if step.get("verb") != "follow" or len(step["table"]["distance"]) != body.frames + ahead:
        return None
    distance = np.array(step["table"]["distance"])
    if (np.diff(distance) < 0).any():
        return None
    own = of_json(step["path"])
    return Course.of(body, own, own.table(), distance[ahead:])


def _found(
    body: Motion, course: Course, path: Path, table: LengthTable, options: tuple[str, str, str]
) -> tuple[Way, np.ndarray | None]:
    """The way along the path, and which frames (G,) of it go backwards; None where the body does not turn."""
    mode, at_end, heading = options
    if heading != "facing":
        found = way(course, path, table, mode, at_end, body.frame_time)
        found = paced(found, body, course, path, table) if mode == "paced" else found
        return found, None if heading == "kept" else np.zeros(len(found.frame), bool)
    distance, back = progress(body, course, path, table, _bearing.gate(body)[0])
    signed = replace(course, distance=distance)
    found = way(signed, path, table, mode, at_end, body.frame_time)
    if mode == "paced":
        found = paced(replace(found, own=course.distance[found.frame.astype(np.int64)]), body, course, path, table)
    own = distances_at(course.distance, found.frame)
    return replace(found, own=own), back[found.frame.astype(np.int64)]


def _planned(
    base: Motion, course: Course, path: Path, table: LengthTable, found: Way, back: np.ndarray | None, posture: str
) -> Plan:
    """What is done to the root of every frame (G,); nothing to those that are kept."""
    some = np.flatnonzero(~found.kept)
    plan = Plan(*(np.zeros((len(found.kept), width)) for width in (3, 1, 1, 4)))
    if not len(some):
        return plan
    own, distance = found.own[some], found.distance[some]
    (old, old_heading), (new, new_heading) = course.at(found.frame[some], own), path.at(distance, table)
    turn = np.zeros(len(some))
    if back is not None and course.table.length > 0 and table.length > 0:
        turn = _turned(base, found, some, old_heading, new_heading + np.pi * back[some])
    by = laid(turn, old[:, [0, -1]], new[:, [0, -1]])
    rises, rose = new.shape[1] == 3, old.shape[1] == 3
    lift = (new[:, 1] if rises else 0.0) - (old[:, 1] if rises and rose else 0.0) + np.zeros(len(some))
    pitch = np.zeros(len(some))
    if posture == "tangent" and rises:
        pitch = path.slope(table.parameter(distance)) - course.path.slope(course.table.parameter(own))
    near = NOTHING * (1.0 + max(np.abs(old).max(), np.abs(new).max()))
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


def _lines(course: Course, path: Path, table: LengthTable, found: Way) -> tuple[Line, Line | None] | None:
    """The new path with heights, and the clip's own where it has some too; None where there are none."""
    if path.points.shape[1] == 2:
        return None
    new = Line(path, table, found.distance)
    if steep(new):
        warnings.warn("the path is steeper than 45 degrees: feet are lifted as the body is", stacklevel=4)
        return None
    return new, None if course.path.points.shape[1] == 2 else Line(course.path, course.table, found.own)


def _made(
    base: Motion,
    plan: Plan,
    found: Way,
    feet: Feet | None,
    lines: tuple[Line, Line | None] | None,
    ahead: int,
) -> tuple[Motion, Steps | None]:
    """The base carried as planned, its feet held if that is asked for and something is not carried as one. lines: along
    which feet and body are lifted one by one; else all is lifted as planned, and leans."""
    if feet is None:
        return carried_out(base, plan), None
    lift = plan.lift[:, 0] if lines is not None else np.zeros(base.frames)
    parts = []
    runs = _bearing.runs(found.cycle)
    for run in runs:  # no foot stands from one beginning of the motion into the next
        part = base if len(runs) == 1 else base[run]
        own = None if lines is None else (lines[0].cut(run), lines[1] and lines[1].cut(run))
        parts.append(stepping(feet, part, found.frame[run], plan.by[run], lift[run], own, ahead + run.start))
    made, told = parts[0][0], [steps for _, steps in parts]
    if len(parts) > 1:
        made = replace(base, values=np.concatenate([part.values for part, _ in parts]), report=None)
    if lines is None:
        made = carried_out(made, plan._replace(by=np.zeros_like(plan.by)))
        if plan.pitch.any():  # a body that leans takes its feet along
            told = [
                steps and feet.leaning(steps, made[run], found.frame[run], plan.by[run], plan.pitch[run, 0])
                for steps, run in zip(told, runs, strict=True)
            ]
    return made, Steps.of(told)


def _with_lead(made: Motion, first: Motion, plan: Plan) -> Motion:
    """The T-pose in front again, moved as the first frame is."""
    values = np.concatenate([carried_out(first, plan).values, made.values])
    return replace(made, values=values)
