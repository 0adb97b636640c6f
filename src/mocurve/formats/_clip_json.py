"""What the JSON formats of clips share: skeleton, history and report, written a line a joint, and taken apart again."""

from __future__ import annotations

import json
import math
from typing import Any, NoReturn

import numpy as np

from ..errors import FileError, Mismatch, MocurveError, OptionError
from ..keyed import KeyedMotion
from ..motion import MAX_FRAMES
from ..skeleton import JointLimits, Skeleton
from ..spline import SplineMotion
from ._files import Path


def document(kind: str, version: int, clip: KeyedMotion | SplineMotion, parts: dict[str, str]) -> str:
    """The file in ASCII: what all kinds have, and between joints and history these parts, written already."""
    body = clip.skeleton
    head = {
        "format": kind,
        "version": version,
        "frame_time": clip.frame_time,
        "frames": clip.frames,
        "unit": body.unit,
    }
    tail = {"history": list(clip.history), "report": None if clip.report is None else _finite(clip.report.to_json())}
    joints = [
        {"name": name, "parent": int(parent), "offset": offset, "channels": list(kinds), "end_site": bool(end)}
        for name, parent, offset, kinds, end in zip(
            body.names, body.parents, body.offsets.tolist(), body.channels, body.end_sites, strict=True
        )
    ]
    for own in body.limits:
        joints[own.joint]["limits"] = limits_row(own)
    written = {key: dumped(value) for key, value in head.items()} | {"joints": rows(joints)} | parts
    written |= {key: dumped(value) for key, value in tail.items()}
    return "{\n" + ",\n".join(f'"{key}": {text}' for key, text in written.items()) + "\n}\n"


def limits_row(limits: JointLimits) -> dict[str, Any]:
    """How far a joint may turn, null where there is no limit."""
    ends = {name: [x if math.isfinite(x) else None for x in getattr(limits, name).tolist()] for name in ("low", "high")}
    return {"axes": limits.axes.tolist(), "order": limits.order, **ends}


def limits_of(joint: int, row: Any) -> JointLimits:
    """The same from what such a row says; MocurveError where it is none."""
    try:
        ends = {"low": -np.inf, "high": np.inf}
        low, high = ([end if x is None else float(x) for x in row[name]] for name, end in ends.items())
        return JointLimits(
            joint, np.array([float(x) for x in row["axes"]]), str(row["order"]), np.array(low), np.array(high)
        )
    except MocurveError:
        raise
    except (TypeError, KeyError, ValueError, OverflowError) as error:
        raise Mismatch(f"no limits of a joint: {type(error).__name__}: {error}") from error


def rows(objects: list[dict[str, Any]]) -> str:
    """A list as text, a line an object, so that versions can be compared."""
    return "[\n" + ",\n".join(map(dumped, objects)) + "\n]" if objects else "[]"


def dumped(value: Any) -> str:
    """A value as JSON on one line; OptionError where it is none."""
    try:
        return json.dumps(value, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise OptionError(f"cannot be written as JSON: {error}") from error


def loaded(raw: bytes, path: Path, extension: str) -> Any:
    """The JSON in the bytes of a file; FileError with the line where it is none."""
    try:
        return json.loads(raw, parse_constant=_no_constant)
    except json.JSONDecodeError as error:
        raise FileError(f"column {error.colno}: not JSON: {error.msg}", path, error.lineno) from error
    except RecursionError as error:
        raise FileError(f"not a {extension} file: nested too deep", path) from error
    except ValueError as error:
        raise FileError(f"not JSON: {error}", path) from error


def _finite(value: Any) -> Any:
    """The same with null for what JSON has no number for."""
    if isinstance(value, dict):
        return {key: _finite(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _no_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is no number of JSON")


class Reader:
    """Takes parsed JSON apart; whatever is not as it has to be is told by its place."""

    def __init__(self, path: Path):
        self.path = path

    def fail(self, place: str, expected: str) -> NoReturn:
        raise FileError(f"{place}: {expected} expected", self.path)

    def head(self, data: Any, kind: str, known: int) -> tuple[float, int]:
        """Frame time and frames of a file of this kind and version."""
        if not isinstance(data, dict) or data.get("format") != kind:
            self.fail("format", f"an object with {kind!r}")
        version = data.get("version")
        if type(version) is not int or version != known:
            self.fail("version", f"{known}, not {str(version)[:40]},")
        frame_time = self.number(data.get("frame_time"), "frame_time")
        if frame_time <= 0:
            self.fail("frame_time", "seconds above 0")
        return frame_time, self.whole(data.get("frames"), "frames", 0, MAX_FRAMES)

    def skeleton(self, data: dict[str, Any]) -> Skeleton:
        joints = self.rows(data.get("joints"), "joints")
        unit = data.get("unit")
        for i, joint in enumerate(joints):
            place = f"joints[{i}]"
            if not isinstance(joint.get("name"), str):
                self.fail(f"{place}.name", "a string")
            self.whole(joint.get("parent"), f"{place}.parent", -1, i - 1)
            if len(self.numbers(joint.get("offset"), f"{place}.offset")) != 3:
                self.fail(f"{place}.offset", "three numbers")
            kinds = joint.get("channels")
            if not isinstance(kinds, list) or not all(isinstance(kind, str) for kind in kinds):
                self.fail(f"{place}.channels", "a list of strings")
            if not isinstance(joint.get("end_site", False), bool):
                self.fail(f"{place}.end_site", "true or false")
        try:
            return Skeleton(
                tuple(joint["name"] for joint in joints),
                [joint["parent"] for joint in joints],  # type: ignore[arg-type]
                [joint["offset"] for joint in joints],  # type: ignore[arg-type]
                tuple(tuple(joint["channels"]) for joint in joints),
                [joint.get("end_site", False) for joint in joints],  # type: ignore[arg-type]
                None if unit is None else self.number(unit, "unit"),
                tuple(
                    self.limits(i, joint["limits"]) for i, joint in enumerate(joints) if joint.get("limits") is not None
                ),
            )
        except MocurveError as error:
            raise FileError(f"joints: {error}", self.path) from error

    def limits(self, joint: int, row: Any) -> JointLimits:
        try:
            return limits_of(joint, row)
        except MocurveError as error:
            raise FileError(f"joints[{joint}].limits: {error}", self.path) from error

    def report(self, data: Any) -> Any:
        if data is None:
            return None
        from ..measure import Report  # only files that carry a report need it

        try:
            report = Report.from_json(data)
            report.sentence()
        except Exception as error:  # whatever a report made of foreign data can raise
            raise FileError(f"report: {type(error).__name__}: {error}", self.path) from error
        return report

    def rows(self, value: Any, place: str) -> list[dict[str, Any]]:
        if not isinstance(value, list) or not all(isinstance(row, dict) for row in value):
            self.fail(place, "a list of objects")
        return value

    def whole(self, value: Any, place: str, least: int, most: int) -> int:
        if type(value) is not int or not least <= value <= most:
            self.fail(place, f"a whole number from {least} to {most}")
        return value

    def number(self, value: Any, place: str) -> float:
        return float(self.numbers([value], place)[0])

    def numbers(self, value: Any, place: str) -> np.ndarray:
        if not isinstance(value, list) or not set(map(type, value)) <= {int, float}:
            self.fail(place, "finite numbers")
        try:
            array = np.array(value, np.float64)
        except OverflowError:
            array = np.array([np.inf])
        if not np.isfinite(array).all():
            self.fail(place, "finite numbers")
        return array
