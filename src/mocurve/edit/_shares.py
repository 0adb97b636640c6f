"""How much of each of several clips: weights as they are given, or found from where the clips stand among adverbs.

Source: Rose, Cohen and Bodenheimer 1998, Verbs and adverbs, section 4: every value of an example is a linear function
of the adverbs, by least squares, and radial functions around the examples bring in what that leaves. Both are linear
in the examples, so all that is needed is how much of each example there is at a place (Sloan, Rose and Cohen 2001,
Shape by example, section 3.1): the same shares for every channel and for the time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import OptionError
from ..skeleton import Skeleton
from ._weights import Rule, Weight, constant, parse, resolve, told

Weights = str | Sequence[Weight]
Places = str | Sequence[str] | Sequence[float] | Sequence[Sequence[float]]
MOST = 10.0  # of a clip: shares beyond say nothing about motion any more
SINGULAR, ROUNDING = 1e-10, 1e-13


@dataclass(frozen=True, eq=False)
class Shares:
    """What part of the result each of N clips is, at any time and for any joint.

    rules:  one for each clip, its weight; with places one for each adverb, where the result is.
    places: (N, D) where each clip stands, None where weights are given.
    """

    rules: tuple[tuple[Rule, ...], ...]
    places: np.ndarray | None

    @property
    def constant(self) -> bool:
        """Whether none of them changes in time."""
        return all(constant(rules) for rules in self.rules)

    def at(self, times: np.ndarray, skeleton: Skeleton) -> np.ndarray:
        """(N, F, J) shares that sum to 1, at times (F,), seconds of the first clip."""
        with np.errstate(over="ignore", invalid="ignore"):  # huge numbers are refused below
            shares = self._shares(times, skeleton)
        if not np.abs(shares).max(initial=0.0) <= MOST:
            raise OptionError(
                f"a clip would count {np.abs(shares).max():.4g} times, more than {MOST:g}: that is no motion"
            )
        return shares

    def _shares(self, times: np.ndarray, skeleton: Skeleton) -> np.ndarray:
        given = np.stack([resolve(rules, skeleton, times, 0.0) for rules in self.rules])
        if self.places is not None:
            return np.repeat(cardinal(self.places, given[:, :, 0].T)[:, :, None], given.shape[2], axis=2)
        total = given.sum(axis=0)
        odd = np.argwhere(~((total > 0) & np.isfinite(total)))
        if len(odd):
            frame, joint = odd[0]
            where = "" if self.constant else f" at {times[frame]:.4g} s"
            name = f" of {skeleton.names[joint]!r}" if (total[frame] != total[frame, joint]).any() else ""
            told = f"the weights{name} add up to {total[frame, joint]:g}{where}"
            raise OptionError(f"{told}, and not to a number above 0")
        return given / total

    def told(self) -> dict[str, Any]:
        """The options as a step of a history can say them."""
        rules = [told(one) for one in self.rules]
        if self.places is None:
            return {"weights": rules, "places": None, "at": None}
        return {"weights": None, "places": self.places.tolist(), "at": rules}


def shares_of(count: int, weights: Weights | None, places: Places | None, at: Weights | None) -> Shares:
    """From the options of `interpolate`; OptionError where they do not say how much of each clip is wanted."""
    if (places is None) != (at is None):
        raise OptionError("places say where each clip stands, at where the result is: both are needed, or neither")
    if places is None:
        given = [1.0] * count if weights is None else _each(weights, count, "weights", f"{count} clips")
        return Shares(tuple(parse(weight, "weight") for weight in given), None)
    if weights is not None:
        raise OptionError("weights are given, and places too: say how much of each clip, or where the result is")
    spots = _spots(places, count)
    dimensions = spots.shape[1]
    rules = tuple(parse(where, "place") for where in _each(at, dimensions, "at", f"places of {dimensions} numbers"))
    if any(rule.name is not None for one in rules for rule in one):
        raise OptionError("at is one place for the whole body, without names of joints")
    return Shares(rules, spots)


def cardinal(places: np.ndarray, at: np.ndarray) -> np.ndarray:
    """(N, F) how much of each of N examples, which stand at places (N, D), there is at other places (F, D).

    They sum to 1; at an example they are 1 for it and 0 for the others; a value that is linear in the places comes out
    linear. Every dimension is counted in its range. Radial functions are cubic B-splines that end at twice the distance
    to the nearest other example.
    """
    size = np.ptp(places, axis=0)
    size = np.where(size > 0, size, 1.0)
    middle = places.mean(axis=0)
    own, there = (places - middle) / size, (at - middle) / size
    if len(own) == 1:
        return np.ones((1, len(at)))
    solve = np.linalg.pinv(own, rcond=SINGULAR)  # (D, N) linear parts, from values less their mean
    linear = 1.0 / len(own) + there @ solve
    left = np.eye(len(own)) - 1.0 / len(own) - own @ solve  # what the linear part leaves of each example
    apart = np.linalg.norm(own[:, None] - own, axis=-1)
    nearest = np.where(np.eye(len(own), dtype=bool), np.inf, apart).min(axis=1)
    around = _radial(apart / nearest)
    if np.linalg.cond(around) > 1.0 / SINGULAR:
        raise OptionError("the places of the clips are too uneven to be interpolated")
    away = np.linalg.norm(there[:, None] - own, axis=-1)
    shares = (linear + _radial(away / nearest) @ np.linalg.solve(around, left)).T
    met = away == 0.0
    shares = np.where(np.abs(shares) < ROUNDING, 0.0, shares)
    return np.where(met.any(axis=1), met.T.astype(float), shares)


# -- in call order ---------------------------------------------------------------------------------


def _each(given: object, count: int, what: str, of: str) -> list[Weight]:
    """One for each, of a list or of a text like 0.2,0.3,0.5."""
    if isinstance(given, str):
        given = [given]
    if not isinstance(given, Sequence | np.ndarray):
        given = [given]
    found: list[Any] = list(given)
    if len(found) == 1 and count > 1 and isinstance(found[0], str) and ":" not in found[0] and "=" not in found[0]:
        found = found[0].split(",")
    if len(found) != count:
        raise OptionError(f"{what}: {len(found)} given, for {of}")
    return found


def _spots(given: Places, count: int) -> np.ndarray:
    """Places (N, D) from any of the forms: 0,1,2 or 0 1 2, with several adverbs 0,0 1,0 0,1."""
    try:
        rows = [
            [float(number) for number in (row.split(",") if isinstance(row, str) else np.atleast_1d(row))]  # type: ignore[arg-type]
            for row in _each(given, count, "places", f"{count} clips")
        ]
    except (TypeError, ValueError) as error:
        if isinstance(error, OptionError):
            raise
        raise OptionError(f"places are numbers, one or several for each clip, like 0,0 1,0; not {given!r}") from None
    if len({len(row) for row in rows}) != 1 or not rows[0]:
        raise OptionError(f"all places have as many numbers, not {sorted({len(row) for row in rows})}")
    spots = np.array(rows)
    if not np.isfinite(spots).all():
        raise OptionError(f"places are finite numbers, not {given!r}")
    for place in range(count):
        same = (spots[:place] == spots[place]).all(axis=1)
        if same.any():
            first = int(np.argmax(same))
            raise OptionError(f"clips {first + 1} and {place + 1} stand at the same place, {spots[place].tolist()}")
    return spots


def _radial(x: np.ndarray) -> np.ndarray:
    """The cubic B-spline on knots -2 ... 2, as high as 1 in its middle."""
    x = np.abs(x)
    return np.where(x < 1.0, 1.0 - 1.5 * x * x + 0.75 * x**3, 0.25 * np.maximum(2.0 - x, 0.0) ** 3)
