"""Paths in files: control points as .csv or .json, curves as .svg."""

from __future__ import annotations

import io
import json
import os
import re
import warnings
from dataclasses import asdict, fields, replace
from typing import Any, NoReturn

import numpy as np

from . import path_svg
from .errors import FileError, MocurveError, OptionError
from .formats._files import Path as File
from .formats._files import encoded, opened, replacing
from .path import LARGEST, Fit, Path, walkable

EXTENSIONS = (".csv", ".json", ".svg")
KIND = "mocurve path"
MOST_BYTES = 64_000_000
_SAYS = re.compile(r"#\s*mocurve path\s*(\{.*\})\s*")
_SEPARATORS = (",", ";", "\t")


def read(file: File) -> Path:
    """A path from .csv, .json or .svg; FileError with the line where it is none."""
    kind = extension(file)
    with opened(file) as source:
        raw = source.read(MOST_BYTES + 1)
    if len(raw) > MOST_BYTES:
        raise FileError(f"is larger than {MOST_BYTES / 1e6:g} MB: no path is", file)
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise FileError("is not text in UTF-8", file, raw.count(b"\n", 0, error.start) + 1) from error
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    path, lines = {".csv": _from_csv, ".json": _from_json, ".svg": path_svg.parsed}[kind](text, file)
    try:
        walkable(path)
    except OptionError as error:
        raise FileError(str(error), file, lines[0]) from error
    if kind != ".svg":  # there the ends of handles often lie together
        _tell_doubled(path.points, lines, os.fsdecode(file))
    return path


def write(file: File, path: Path) -> None:
    """Write a path as .csv, .json or .svg."""
    made = {".csv": _as_csv, ".json": _as_json, ".svg": path_svg.written}[extension(file)](path)
    with replacing(file) as target:
        target.write(encoded(made, file))


def extension(file: File) -> str:
    """The extension of a path's file; FileError for another one."""
    kind = os.path.splitext(os.fsdecode(file))[1].lower()
    if kind not in EXTENSIONS:
        raise FileError(f"a path is in a file {', '.join(EXTENSIONS)}, not {kind!r}", file)
    return kind


def as_json(path: Path) -> dict[str, Any]:
    """What a path is, as plain numbers and texts."""
    told: dict[str, Any] = {"kind": path.kind, "degree": path.degree, "points": path.points.tolist()}
    if not _even(path):
        told["knots"] = path.knots.tolist()
    if path.fit is not None:
        told["fit"] = asdict(path.fit)
    return told


def of_json(told: Any) -> Path:
    """The path that `as_json` told, or a bare list of points; OptionError where it is none."""
    if isinstance(told, list):
        return Path(np.array(_rows(told)))
    if not isinstance(told, dict) or not isinstance(told.get("points"), list):
        raise FileError('a path is {"points": [[x, z], ...], "degree": 3}, or the points alone')
    odd = set(told) - {"format", "version", "kind", "degree", "points", "knots", "fit"}
    if odd:
        raise FileError(f"a path has no {sorted(odd)[0]!r}")
    fit = told.get("fit")
    if fit is not None and (not isinstance(fit, dict) or set(fit) - {part.name for part in fields(Fit)}):
        raise FileError("fit of a path says points, degree, kind, track and height")
    kind = told.get("kind", "spline")
    if not isinstance(kind, str):
        raise FileError(f"kind of a path is a text, not {kind!r}")
    made = Path(np.array(_rows(told["points"])), told.get("degree", 3), kind, np.array(_numbers(told.get("knots", []))))
    return made if fit is None else replace(made, fit=Fit(**fit))


# -- in call order ---------------------------------------------------------------------------------


def _tell_doubled(points: np.ndarray, lines: list[int | None], file: str) -> None:
    """Warned of: points in one place, or straight above one another."""
    same = np.diff(points, axis=0) == 0
    for doubled, told in (
        (same.all(axis=1), "where the one before it is: the path has a corner there"),
        (
            same[:, [0, -1]].all(axis=1) & ~same.all(axis=1),
            "straight above or below the one before it: the path is steep",
        ),
    ):
        if doubled.any():
            line = lines[int(np.argmax(doubled)) + 1]
            place = file if line is None else f"{file}:{line}"
            warnings.warn(f"{place}: the point is {told}", stacklevel=4)


def _from_csv(text: str, file: File) -> tuple[Path, list[int | None]]:
    says: dict[str, Any] = {}
    rows: list[tuple[int, list[str]]] = []
    for number, line in enumerate(text.split("\n"), 1):
        if line.lstrip().startswith("#"):
            says = says or _said(line, file, number)
        elif line.strip(" \t,;"):
            rows.append((number, _cells(line)))
    width = len(rows[0][1]) if rows else 0
    if rows and not any(_is_number(cell) for cell in rows[0][1]):
        order = _columns(rows[0][1], file, rows.pop(0)[0])
    else:
        order = list(range(len(rows[0][1]))) if rows else [0, 1]
    if len(rows) < 2:
        raise FileError(f"a path has two points or more, here {'is one' if rows else 'is none'}", file)
    points = [_point(cells, order, width, file, number) for number, cells in rows]
    numbers: list[int | None] = [number for number, _ in rows]
    try:
        return of_json({**says, "points": points}), numbers
    except MocurveError as error:
        raise FileError(str(error), file, numbers[0]) from error


def _cells(line: str) -> list[str]:
    separator = next((mark for mark in _SEPARATORS if mark in line), None)
    cells = line.split(separator) if separator else line.split()
    return [cell.strip().strip('"') for cell in cells]


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _columns(names: list[str], file: File, number: int) -> list[int]:
    """Where x, z or x, y, z stand."""
    lower = [name.lower() for name in names]
    wanted = ["x", "y", "z"] if "y" in lower else ["x", "z"]
    if any(lower.count(name) != 1 for name in wanted):
        raise FileError(f"the columns of a path are x,z or x,y,z, not {','.join(names)[:60]}", file, number)
    return [lower.index(name) for name in wanted]


def _point(cells: list[str], order: list[int], width: int, file: File, number: int) -> list[float]:
    if len(order) not in (2, 3):
        raise FileError(f"a point has two numbers x,z or three x,y,z; {len(cells)} found", file, number)
    if len(cells) != width:
        raise FileError(f"{width} cells expected as in the first row, {len(cells)} found", file, number)
    point = []
    for place in order:
        value = float(cells[place]) if _is_number(cells[place]) else np.nan
        if not abs(value) <= LARGEST:
            wanted = f"a number up to {LARGEST:g}" if abs(value) < np.inf else "a number"
            raise FileError(f"column {place + 1}: {wanted} expected, {cells[place][:40]!r} found", file, number)
        point.append(value)
    return point


def _said(line: str, file: File, number: int) -> dict[str, Any]:
    """What a comment says of the path: {"degree": 5, ...}; other comments say nothing."""
    found = _SAYS.fullmatch(line.strip())
    if found is None:
        return {}
    try:
        return dict(json.loads(found[1], parse_constant=_no_number))
    except (ValueError, RecursionError) as error:
        raise FileError(f"the comment is no JSON: {error}", file, number) from error


def _as_csv(path: Path) -> str:
    told = as_json(path)
    del told["points"]
    rows = io.StringIO()
    rows.write(f"# {KIND} {json.dumps(told)}\n")
    rows.write("x,y,z\n" if path.points.shape[1] == 3 else "x,z\n")
    for point in path.points.tolist():
        rows.write(",".join(map(repr, point)) + "\n")
    return rows.getvalue()


def _from_json(text: str, file: File) -> tuple[Path, list[int | None]]:
    try:
        path = of_json(json.loads(text, parse_constant=_no_number))
    except json.JSONDecodeError as error:
        raise FileError(f"column {error.colno}: not JSON: {error.msg}", file, error.lineno) from error
    except RecursionError as error:
        raise FileError("not a path: nested too deep", file) from error
    except MocurveError as error:
        raise FileError(str(error), file, 1) from error
    except ValueError as error:
        raise FileError(f"not JSON: {error}", file, 1) from error
    return path, [None] * len(path.points)


def _as_json(path: Path) -> str:
    told = as_json(path)
    points = ",\n".join(json.dumps(point) for point in told.pop("points"))
    head = json.dumps({"format": KIND, "version": 1, **told})
    return f'{head[:-1]}, "points": [\n{points}\n]}}\n'


def _even(path: Path) -> bool:
    """Whether the knots are those that a path has by itself."""
    return path.kind == "polynomial" or np.array_equal(path.knots, Path(path.points, path.degree).knots)


def _rows(points: list[Any]) -> list[list[float]]:
    """Rows of two or three numbers each."""
    for number, point in enumerate(points, 1):
        if not isinstance(point, list) or len(point) not in (2, 3) or len(point) != len(points[0]):
            raise FileError(f"point {number} is not two numbers x, z, or three x, y, z as all are")
        _numbers(point)
    return points


def _numbers(values: Any) -> list[float]:
    good = isinstance(values, list) and all(
        isinstance(value, int | float) and not isinstance(value, bool) for value in values
    )
    if not good:
        raise FileError(f"numbers expected, {str(values)[:40]} found")
    try:
        return [float(value) for value in values]
    except OverflowError:
        raise FileError("a number is too large") from None


def _no_number(name: str) -> NoReturn:
    raise ValueError(f"{name} is no number of JSON")
