"""A path over the ground: what is left of a motion when its details are taken away, and what it can be laid along.

Gleicher 2001, Motion path editing. A path is a B-spline with control points, or one polynomial through its points; it
knows the distance along it, so that a motion can keep its speed.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from os import PathLike
from typing import TYPE_CHECKING

import numpy as np

from . import bspline, planar
from .errors import OptionError, UnknownName
from .path_length import LengthTable, measured
from .skeleton import frozen

if TYPE_CHECKING:
    from .motion import Clip

KINDS = ("spline", "polynomial")
TRACKS = ("root", "support", "smooth")
PARTS = 16  # places between two knots where a heading is looked for
USUAL = 3  # degree
STANDS = 1e-9  # of the mean speed: slower than this a curve has no direction
MOST_POINTS, MOST_DEGREE = 100_000, 200
NOWHERE = "all points are in one place: the path has no length"
LARGEST = 1e12  # of a coordinate: squares of larger ones lose the digits of a path


@dataclass(frozen=True)
class Fit:
    """How a path was fitted to a clip, so that the clip's own path can be found again: the options of `Path.of`."""

    points: int | None = None
    degree: int = 3
    kind: str = "spline"
    track: str = "root"
    height: bool = False

    def __post_init__(self) -> None:
        for what, name, names in (("kind of path", self.kind, KINDS), ("track", self.track, TRACKS)):
            if name not in names:
                raise UnknownName(what, name, names)
        if self.points is not None and not _whole(self.points, 2, MOST_POINTS):
            raise OptionError(f"a path has 2 to {MOST_POINTS} points, not {self.points!r}")
        if not _whole(self.degree, 1, MOST_DEGREE):
            raise OptionError(f"the degree of a path is a whole number from 1 to {MOST_DEGREE}, not {self.degree!r}")
        if not isinstance(self.height, bool):
            raise OptionError(f"height is true or false, not {self.height!r}")


@dataclass(frozen=True, eq=False)
class Path:
    """A curve over the ground, in the clip's length unit.

    points: (N, 2) x, z, or (N, 3) x, y, z with the height y; two or more, read-only.
    degree: of the curve, 3, or N - 1 for fewer points N, so that two points are a straight line.
    kind:   spline: a clamped B-spline, which begins at its first control point and ends at its last one.
            polynomial: the one polynomial of degree N - 1 through all points, which stand where the extrema of a
            Chebyshev polynomial stand in the parameter; at any degree it is computed in the Chebyshev basis.
    knots:  (N + degree + 1,) of a spline, from 0 to 1 and clamped; by default evenly spaced.
    fit:    how it was fitted to a clip; None for a path that was drawn.

    Errors: OptionError for points that are no numbers, too few or too many, for a degree and for knots.

    >>> path = mc.Path([(0, 0), (200, 80), (400, -80), (600, 0)])
    >>> place, heading = path.at(0.5 * path.length)
    """

    points: np.ndarray
    degree: int = 3
    kind: str = "spline"
    knots: np.ndarray = field(default_factory=lambda: np.zeros(0))
    fit: Fit | None = None

    def __post_init__(self) -> None:
        put = object.__setattr__  # the dataclass is frozen; this is its constructor
        points = _checked(self.points)
        Fit(None, self.degree, self.kind)  # has the same names and degrees
        if self.kind == "polynomial" and len(points) > MOST_DEGREE + 1:
            raise OptionError(f"a polynomial has {MOST_DEGREE + 1} points at most, not {len(points)}")
        put(self, "points", frozen(points))
        most = len(points) - 1
        if self.degree > max(most, USUAL):
            raise OptionError(too_few(len(points), self.degree, self.kind))
        put(self, "degree", most if self.kind == "polynomial" else min(int(self.degree), most))
        put(self, "knots", frozen(self._knots()))

    def __repr__(self) -> str:
        up = ", with heights" if self.points.shape[1] == 3 else ""
        what = "control points" if self.kind == "spline" else "points of a polynomial"
        return f"<Path {len(self.points)} {what} of degree {self.degree}, {self.length:.6g} long{up}>"

    @classmethod
    def of(
        cls,
        clip: Clip,
        *,
        points: int | None = None,
        degree: int = 3,
        kind: str = "spline",
        track: str = "root",
        height: bool = False,
    ) -> Path:
        """The path of a clip: the curve nearest to where its body goes, in the sense of least squares.

        Parameters
        ----------
        points
            How many control points; by default about one for every second that it moves, so that the hips' sway is left
            to the motion. A polynomial has one more than its degree.
        degree
            Of the curve, up to 200.
        kind
            spline, or polynomial as in Gleicher's scheme.
        track
            What is followed: root, support (the middle of the feet), smooth (the root without the sway of a stride,
            for many control points).
        height
            Whether the height of the root is followed too, as on stairs.

        The parameter of the curve grows with the square root of the root's speed, so that pauses take none of it. A
        T-pose in front is left out. Errors: OptionError for more
        points than frames, Mismatch for samples that are missing.
        """
        from .path_fit import fitted

        return fitted(clip, Fit(points, degree, kind, track, height))

    @classmethod
    def read(cls, path: str | PathLike[str]) -> Path:
        """A path from a file: .csv (x,z or x,y,z), .json, or the line in an .svg. FileError with the line where it is
        none."""
        from .path_files import read

        return read(path)

    def write(self, path: str | PathLike[str]) -> None:
        """Write the path as .csv or .json, to all digits, or as .svg (up to degree 3)."""
        from .path_files import write

        write(path, self)

    @property
    def length(self) -> float:
        """From one end to the other along the curve, clip's length unit."""
        return self.table().length

    def at(self, distance: float | np.ndarray, table: LengthTable | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Places (..., 2 or 3), as the points have them, and headings (...) at distances (...) from the beginning.

        A heading is in radians, from +z towards +x, continuous along the distances. Beyond both ends the path goes
        straight on. Where the curve stands still or goes straight up, the heading is that of the nearest place that
        has one, and 0 where there is none. table: of `table()`, where it is at hand.
        """
        table = table or self.table()
        distance = _numbers(distance, "a distance along a path is a number")
        flat = distance.reshape(-1)
        parameter = table.parameter(flat)
        places = self.place(parameter)
        beyond = flat - np.clip(flat, 0.0, table.length)
        out = beyond != 0
        if out.any():
            places[out] += beyond[out, None] * self._direction(parameter[out])
        return places.reshape(*distance.shape, -1), self.heading(parameter).reshape(distance.shape)

    def residuals(self, clip: Clip) -> np.ndarray:
        """How far (F,) the clip's root is from the path at every frame, clip's length unit.

        Each frame counts at the parameter that it would have in a fit. A T-pose in front counts as lying where the next
        frame lies.
        """
        from .path_fit import residuals

        return residuals(self, clip)

    def moved(self, by: np.ndarray | tuple[float, float, float]) -> Path:
        """The path turned about the vertical and shifted: by = angle in radians (from +z towards +x), x, z."""
        flat = np.insert(self.points, 1, 0.0, axis=1) if self.points.shape[1] == 2 else self.points
        told = "a path is moved by three numbers: an angle, x and z"
        if (taken := _numbers(by, told)).shape != (3,):
            raise OptionError(told)
        points = planar.move(taken, flat)
        return replace(self, points=points if self.points.shape[1] == 3 else points[:, [0, 2]])

    # -- the curve over its parameter, 0 to 1 ------------------------------------------------------
    def place(self, parameter: np.ndarray) -> np.ndarray:
        """Places (M, 2 or 3) at parameters (M,)."""
        if self.kind == "spline":
            return np.ascontiguousarray(bspline.evaluate(self.knots, self.points, self.degree, parameter))
        return np.polynomial.chebyshev.chebval(2.0 * parameter - 1.0, self._chebyshev()).T.copy()

    def velocity(self, parameter: np.ndarray) -> np.ndarray:
        """Places per parameter (M, 2 or 3) at parameters (M,)."""
        if self.kind == "spline":
            knots, slopes, degree = bspline.derivative(self.knots, self.points, self.degree)
            return np.ascontiguousarray(bspline.evaluate(knots, slopes, degree, parameter))
        slopes = 2.0 * np.polynomial.chebyshev.chebder(self._chebyshev())
        return np.polynomial.chebyshev.chebval(2.0 * parameter - 1.0, slopes).T.copy()

    def heading(self, parameter: np.ndarray) -> np.ndarray:
        """Headings (M,) at parameters (M,), radians, continuous from one to the next."""
        ahead = self.velocity(parameter)[:, [0, -1]]
        angle, moves = np.arctan2(ahead[:, 0], ahead[:, 1]), self._moves(ahead)
        if not moves.all():
            angle = np.where(moves, angle, self._nearest_heading(parameter))
        return np.unwrap(angle)

    def slope(self, parameter: np.ndarray) -> np.ndarray:
        """Radians (M,) by which a path with heights rises at parameters (M,)."""
        ahead = self.velocity(parameter)
        if ahead.shape[1] == 2:
            return np.zeros(len(ahead))
        return np.arctan2(ahead[:, 1], np.hypot(ahead[:, 0], ahead[:, 2]))

    def table(self) -> LengthTable:
        """Distances along the curve; what is asked for often is asked of one table."""
        return measured(lambda at: np.linalg.norm(self.velocity(at), axis=1), self._breaks())

    # -- in call order -----------------------------------------------------------------------------
    def _knots(self) -> np.ndarray:
        """Checked, or evenly spaced ones."""
        count, degree = len(self.points), self.degree
        if self.kind == "polynomial":
            return np.zeros(0)
        if not np.size(self.knots):
            return bspline.clamped(np.linspace(0.0, 1.0, count - degree + 1), degree)
        knots = np.array(self.knots, np.float64).reshape(-1)
        if len(knots) != count + degree + 1:
            raise OptionError(f"{count} control points of degree {degree} have {count + degree + 1} knots")
        ends = (knots[: degree + 1] == 0).all() and (knots[count:] == 1).all()
        if not ends or not (np.diff(knots) >= 0).all() or (knots[degree + 1 :] == knots[: -degree - 1]).any():
            raise OptionError(
                f"the knots of a path rise from {degree + 1} times 0 to {degree + 1} times 1, none more often than "
                f"{degree} times in between"
            )
        return knots

    def _chebyshev(self) -> np.ndarray:
        """Coefficients (N, 2 or 3) in the Chebyshev basis of the polynomial through the points."""
        count = len(self.points)
        nodes = chebyshev_places(count)
        weights = np.polynomial.chebyshev.chebvander(2.0 * nodes - 1.0, count - 1).T  # (N, N) orthogonal sums
        weights[:, [0, -1]] *= 0.5
        weights[[0, -1]] *= 0.5
        return 2.0 / (count - 1) * weights @ self.points

    def _breaks(self) -> np.ndarray:
        """Parameters between which the curve is smooth."""
        return np.unique(self.knots) if self.kind == "spline" else chebyshev_places(len(self.points))

    def _direction(self, parameter: np.ndarray) -> np.ndarray:
        """Unit vectors (M, 2 or 3) along the curve; where it stands, those of the heading."""
        ahead = self.velocity(parameter)
        speed = np.linalg.norm(ahead, axis=1, keepdims=True)
        heading = self.heading(parameter)
        flat = np.stack([np.sin(heading), np.cos(heading)], axis=1)
        if ahead.shape[1] == 3:
            flat = np.insert(flat, 1, 0.0, axis=1)
        stands = speed <= STANDS * np.ptp(self.points, axis=0).max()
        return np.where(stands, flat, ahead / np.where(stands, 1.0, speed))

    def _moves(self, ahead: np.ndarray) -> np.ndarray:
        """Which of velocities over the ground (M, 2) have a direction."""
        return np.hypot(ahead[:, 0], ahead[:, 1]) > STANDS * float(np.ptp(self.points, axis=0).max())

    def _nearest_heading(self, parameter: np.ndarray) -> np.ndarray:
        """Headings (M,) of the nearest places in between that have one."""
        breaks = self._breaks()
        inner = (np.arange(PARTS) + 0.5) / PARTS
        there = (breaks[:-1, None] + np.diff(breaks)[:, None] * inner).reshape(-1)
        ahead = self.velocity(there)[:, [0, -1]]
        moves = self._moves(ahead)
        if not moves.any():
            return np.zeros(len(parameter))
        there, angle = there[moves], np.arctan2(ahead[moves, 0], ahead[moves, 1])
        after = np.clip(np.searchsorted(there, parameter), 0, len(there) - 1)
        before = np.maximum(after - 1, 0)
        return np.where(parameter - there[before] < there[after] - parameter, angle[before], angle[after])


def too_few(points: int, degree: int, kind: str) -> str:
    """A sentence for a degree that takes more points."""
    if kind == "polynomial":
        return f"a polynomial of degree {degree} has {degree + 1} points, not {points}"
    return (
        f"{points} control points make a curve of degree {points - 1} at most, not {degree}: take more points, or "
        f"degree {points - 1}"
    )


def walkable(path: Path) -> Path:
    """The path, to be followed; OptionError where it has no way over the ground."""
    extent = np.ptp(path.points, axis=0)
    if not extent.any():
        raise OptionError(NOWHERE)
    if not extent[[0, -1]].max() > STANDS * extent.max():
        raise OptionError("the path goes straight up: it has no way over the ground")
    return path


def chebyshev_places(count: int) -> np.ndarray:
    """(N,) parameters from 0 to 1 of the points of a polynomial: the extrema of a Chebyshev polynomial."""
    return 0.5 - 0.5 * np.cos(np.pi * np.arange(count) / (count - 1))


def _numbers(given: object, told: str) -> np.ndarray:
    """Finite floats; OptionError that tells what is wanted."""
    try:
        numbers = np.asarray(given, np.float64)
    except (TypeError, ValueError):
        raise OptionError(f"{told}, not {given!r}") from None
    if not np.isfinite(numbers).all():
        raise OptionError(told)
    return numbers


def _whole(number: object, least: int, most: int) -> bool:
    return isinstance(number, int | np.integer) and not isinstance(number, bool) and bool(least <= number <= most)


def _checked(points: object) -> np.ndarray:
    """Points (N, 2 or 3), two or more."""
    try:
        given = np.array(points, np.float64)
    except (TypeError, ValueError):
        raise OptionError("the points of a path are rows of numbers, x, z or x, y, z") from None
    if given.ndim != 2 or given.shape[1] not in (2, 3):
        raise OptionError(f"the points of a path have two columns x, z or three x, y, z, not shape {given.shape}")
    if not 2 <= len(given) <= MOST_POINTS:
        raise OptionError(f"a path has 2 to {MOST_POINTS} points, not {len(given)}")
    bad = ~(np.abs(given) <= LARGEST).all(axis=1)
    if bad.any():
        place = int(np.argmax(bad))
        raise OptionError(
            f"point {place + 1} of the path is {tuple(given[place].tolist())}: coordinates are numbers up to "
            f"{LARGEST:g}"
        )
    return given
