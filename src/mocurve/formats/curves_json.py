"""Keys as JSON, version 1: skeleton, curves, how they were made. The schema is in docs/formats.md."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any, NoReturn

import numpy as np

from ..errors import FileError, MocurveError, OptionError
from ..keyed import HermiteCurve, KeyedMotion
from ..motion import Clip
from ..skeleton import Skeleton
from ._files import Path, opened, replacing

FORMAT, VERSION = "mocurve curves", 1
MAX_FRAMES = 100_000_000  # eleven days at 100 frames a second; sampling allocates by it


def read(path: Path) -> KeyedMotion:
    """The keys in a .curves.json file, numbers exactly as written. FileError names the place in it that is wrong."""
    with opened(path) as file:
        return parsed(file.read(), path)


def parsed(raw: bytes, path: Path) -> KeyedMotion:
    """The keys in the bytes of such a file; `path` is only named in errors."""
    try:
        data = json.loads(raw, parse_constant=_no_constant)
    except json.JSONDecodeError as error:
        raise FileError(f"column {error.colno}: not JSON: {error.msg}", path, error.lineno) from error
    except RecursionError as error:
        raise FileError("not a .curves.json file: nested too deep", path) from error
    except ValueError as error:
        raise FileError(f"not JSON: {error}", path) from error
    return _Reader(path).keyed(data)


def write(path: Path, clip: Clip, lossless: bool = True) -> None:
    """Write the keys of a KeyedMotion, always with all digits; OptionError for a clip that has no keys."""
    if not isinstance(clip, KeyedMotion):
        raise OptionError(f"a .curves.json file holds keys, a {type(clip).__name__} has none: reduce it first")
    encoded = text(clip).encode()
    with replacing(path) as file:
        file.write(encoded)


def text(keys: KeyedMotion) -> str:
    """What such a file holds, in ASCII: a line a joint and a line a curve, so that versions can be compared."""
    body = keys.skeleton
    head = {
        "format": FORMAT,
        "version": VERSION,
        "frame_time": keys.frame_time,
        "frames": keys.frames,
        "unit": body.unit,
    }
    tail = {"history": list(keys.history), "report": None if keys.report is None else _finite(keys.report.to_json())}
    joints = [
        {"name": name, "parent": int(parent), "offset": offset, "channels": list(kinds), "end_site": bool(end)}
        for name, parent, offset, kinds, end in zip(
            body.names, body.parents, body.offsets.tolist(), body.channels, body.end_sites, strict=True
        )
    ]
    curves = [_curve(name, curve) for name, curve in zip(body.channel_names, keys.curves, strict=True)]
    parts = [f'"{key}": {_dump(value)}' for key, value in head.items()]
    parts += [f'"{key}": [{_lines(rows)}]' for key, rows in (("joints", joints), ("curves", curves))]
    parts += [f'"{key}": {_dump(value)}' for key, value in tail.items()]
    return "{\n" + ",\n".join(parts) + "\n}\n"


def _lines(rows: list[dict[str, Any]]) -> str:
    return "\n" + ",\n".join(map(_dump, rows)) + "\n" if rows else ""


def _dump(value: Any) -> str:
    try:
        return json.dumps(value, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise OptionError(f"cannot be written as JSON: {error}") from error


def _curve(name: str, curve: HermiteCurve) -> dict[str, Any]:
    row = {
        "channel": name,
        "times": curve.times.tolist(),
        "values": curve.values.tolist(),
        "slopes": curve.slopes.tolist(),
    }
    return {**row, "in_slopes": curve.in_slopes.tolist()} if curve.broken else row


def _finite(value: Any) -> Any:
    """The same with null for what JSON has no number for."""
    if isinstance(value, dict):
        return {key: _finite(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _no_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is no number of JSON")


class _Reader:
    """Takes parsed JSON apart; whatever is not as it has to be is told by its place."""

    def __init__(self, path: Path):
        self.path = path

    def fail(self, place: str, expected: str) -> NoReturn:
        raise FileError(f"{place}: {expected} expected", self.path)

    def keyed(self, data: Any) -> KeyedMotion:
        if not isinstance(data, dict) or data.get("format") != FORMAT:
            self.fail("format", f"an object with {FORMAT!r}")
        version = data.get("version")
        if type(version) is not int or version != VERSION:
            self.fail("version", f"{VERSION}, not {str(version)[:40]},")
        frame_time = self.number(data.get("frame_time"), "frame_time")
        if frame_time <= 0:
            self.fail("frame_time", "seconds above 0")
        frames = self.whole(data.get("frames"), "frames", 0, MAX_FRAMES)
        body = self.skeleton(data)
        curves = self.curves(data, body, frames)
        history = self.rows(data.get("history", []), "history")
        return KeyedMotion(body, curves, frame_time, frames, tuple(history), self.report(data.get("report")))

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
            )
        except MocurveError as error:
            raise FileError(f"joints: {error}", self.path) from error

    def curves(self, data: dict[str, Any], body: Skeleton, frames: int) -> tuple[HermiteCurve, ...]:
        rows = self.rows(data.get("curves"), "curves")
        if len(rows) != body.channel_count:
            self.fail("curves", f"one for each of the {body.channel_count} channels")
        return tuple(self.curve(row, f"curves[{i}]", body.channel_names[i], frames) for i, row in enumerate(rows))

    def curve(self, row: dict[str, Any], place: str, name: str, frames: int) -> HermiteCurve:
        if row.get("channel") != name:
            self.fail(f"{place}.channel", repr(name))
        parts = [self.numbers(row.get(key), f"{place}.{key}") for key in ("times", "values", "slopes")]
        arriving = row.get("in_slopes")
        if frames and not len(parts[0]):
            self.fail(f"{place}.times", "at least one key")
        try:
            curve = HermiteCurve(*parts)
            return curve if arriving is None else replace(curve, in_slopes=self.numbers(arriving, f"{place}.in_slopes"))
        except MocurveError as error:
            raise FileError(f"{place}: {error}", self.path) from error

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
