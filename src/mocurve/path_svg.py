"""Lines drawn in vector programs: the d attribute of a <path> in an .svg, to a cubic B-spline and back.

Seen from above: x to the right is x, y downwards is z. Bézier segments one after the other are a B-spline with triple
knots; its knots lie apart as the segments are long.
"""

from __future__ import annotations

import html
import re
import warnings

import numpy as np

from . import bspline
from .errors import FileError, OptionError
from .formats._files import Path as File
from .path import NOWHERE, Path

_PATH = re.compile(r"<path\b([^>]*)>", re.IGNORECASE | re.DOTALL)
_D = re.compile(r"\bd\s*=\s*(\"[^\"]*\"|'[^']*')", re.DOTALL)
_TOKEN = re.compile(r"\s*,?\s*(?:([A-Za-z])|([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?))")
TAKEN = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "Z": 0}  # numbers after a letter


def parsed(text: str, file: File) -> tuple[Path, list[int | None]]:
    """The one line of an SVG file, or a bare d attribute, and the line of the file where each of its points is."""
    drawn = [found for found in _PATH.finditer(text) if _D.search(found[1])]
    if len(drawn) > 1:
        number = text.count("\n", 0, drawn[1].start()) + 1
        raise FileError(f"{len(drawn)} lines are drawn in it: a path is one, keep it alone", file, number)
    start, data = 0, text
    if drawn:
        attribute = _D.search(drawn[0][1])
        assert attribute is not None
        start, data = drawn[0].start(1) + attribute.start(1) + 1, html.unescape(attribute[1][1:-1])
        if re.search(r"\btransform\s*=", text):
            warnings.warn(f"{file}: transform is not looked at, numbers count as they are", stacklevel=4)
    elif "<" in text:
        raise FileError("no line is drawn in it: <path d=...> expected (turn shapes into paths first)", file, 1)
    line = text.count("\n", 0, start) + 1
    segments = _segments(data, file, line)
    lengths = np.linalg.norm(np.diff(segments, axis=1), axis=2).sum(axis=1)
    segments = segments[lengths > 0]
    if not len(segments):
        raise FileError(NOWHERE, file, line)
    lengths = lengths[lengths > 0]
    points = np.concatenate([segments[:1, 0], segments[:, 1:].reshape(-1, 2)])
    breaks = np.concatenate([[0.0], np.cumsum(lengths) / lengths.sum()])
    breaks[-1] = 1.0
    inner = np.repeat(breaks[1:-1], 3)
    try:
        return Path(points, 3, "spline", np.concatenate([[0.0] * 4, inner, [1.0] * 4])), [line] * len(points)
    except OptionError as error:
        raise FileError(str(error), file, line) from error


def written(path: Path) -> str:
    """An SVG file with the line; OptionError for a curve above degree 3."""
    if path.kind == "polynomial" or path.degree > 3:
        raise OptionError(f"an .svg has curves up to degree 3, not {path.degree}: write .json or .csv")
    flat = path.points[:, [0, -1]]
    knots, values, degree = path.knots, flat, path.degree
    while degree < 3:
        knots, values, degree = bspline.raise_degree(knots, values, degree)
    breaks, places, leaving, arriving = bspline.to_hermite(knots, values)
    third = np.diff(breaks)[:, None] / 3.0
    rows = np.concatenate([places[:-1] + third * leaving[:-1], places[1:] - third * arriving[1:], places[1:]], axis=1)
    parts = ["M " + " ".join(map(repr, places[0].tolist()))]
    parts += ["C " + " ".join(map(repr, row)) for row in rows.tolist()]
    low, size = places.min(axis=0), np.ptp(flat, axis=0)
    margin = 0.05 * max(float(size.max()), 1e-9)
    box = " ".join(f"{v:.6g}" for v in [*(low - margin), *(size + 2 * margin)])
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}">\n<path fill="none" stroke="#1b497d" '
        f'stroke-width="{0.2 * margin:.6g}" d="\n' + "\n".join(parts) + '\n"/>\n</svg>\n'
    )


# -- in call order ---------------------------------------------------------------------------------


def _segments(data: str, file: File, line: int) -> np.ndarray:
    """(S, 4, 2) cubic Bézier segments."""
    here = start = handle = np.zeros(2)
    before = ""
    made: list[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]] = []
    for letter, numbers, at in _commands(data, file, line):
        kind, relative = letter.upper(), letter.islower()
        if kind == "M" and made:
            raise FileError("the line breaks off and starts again (M): a path is one line", file, at)
        end, corners = _corners(kind, numbers, here if relative else np.zeros(2), here, start)
        if kind == "M":
            here = start = end
        else:
            mirrored = 2.0 * here - handle
            if kind == "C":
                first, second = corners
            elif kind == "S":
                first, second = mirrored if before in ("C", "S") else here, corners[0]
            elif kind in ("Q", "T"):
                middle = corners[0] if kind == "Q" else mirrored if before in ("Q", "T") else here
                first, second = (2.0 * middle + here) / 3.0, (2.0 * middle + end) / 3.0
            else:
                first, second = (2.0 * here + end) / 3.0, (here + 2.0 * end) / 3.0
            handle = middle if kind in ("Q", "T") else second
            made.append((here, first, second, end))
            here = end
        before = kind
    if not made:
        raise FileError("a path has two points or more, here is none or one", file, line)
    return np.array(made)


def _commands(data: str, file: File, line: int) -> list[tuple[str, list[float], int]]:
    """Letters, each with the numbers of one segment, and their lines in the file."""
    found: list[tuple[str, list[float], int]] = []
    letter, place = "", 0
    numbers: list[float] = []
    data = data.rstrip()
    while place < len(data):
        token = _TOKEN.match(data, place)
        at = line + data.count("\n", 0, len(data) - len(data[place:].lstrip()))
        if token is None:
            raise FileError(f"a letter or a number expected, {data[place : place + 20].strip()!r} found", file, at)
        place = token.end()
        if token[1]:
            if numbers:
                raise FileError(f"{letter} takes {TAKEN[letter.upper()]} numbers a segment", file, at)
            letter = token[1]
            if letter.upper() not in TAKEN:
                hint = "; turn arcs into curves first" if letter in "Aa" else ""
                raise FileError(f"{letter!r} is not read: M L H V C S Q T Z are{hint}", file, at)
            if not found and letter not in "Mm":
                raise FileError(f"a line begins with M, not with {letter!r}", file, at)
            if letter in "Zz":
                found.append((letter, [], at))
            elif found and found[-1][0] in "Zz" and letter in "Mm":
                raise FileError("the line breaks off and starts again (M): a path is one line", file, at)
            continue
        if not letter or letter in "Zz":
            raise FileError(f"a letter expected, {token[2]!r} found", file, at)
        value = float(token[2])
        if not np.isfinite(value):
            raise FileError(f"{token[2]!r} is too large a number", file, at)
        numbers.append(value)
        if len(numbers) == TAKEN[letter.upper()]:
            found.append((letter, numbers, at))
            numbers = []
            letter = {"M": "L", "m": "l"}.get(letter, letter)  # more points after M are lines
    if numbers:
        raise FileError(f"{letter} takes {TAKEN[letter.upper()]} numbers a segment", file, line + data.count("\n"))
    return found


def _corners(
    kind: str, numbers: list[float], base: np.ndarray, here: np.ndarray, start: np.ndarray
) -> tuple[np.ndarray, list[np.ndarray]]:
    """Where a segment ends, and the handles that it names."""
    if kind == "Z":
        return start, []
    if kind == "H":
        return np.array([base[0] + numbers[0], here[1]]), []
    if kind == "V":
        return np.array([here[0], base[1] + numbers[0]]), []
    corners = [base + numbers[i : i + 2] for i in range(0, len(numbers), 2)]
    return corners[-1], corners[:-1]
