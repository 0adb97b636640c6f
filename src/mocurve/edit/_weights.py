"""Weights as a person gives them: a number, one per joint, or one that changes in time.

0.3, "0.3", "0:0,2:1" (0 at second 0, 1 at second 2, straight between), "Left*=0.3", "LeftArm=0:0,2:1", a list of such,
[(0, 0), (2, 1)], {"Left*": 0.3}. Of two that speak of the same joint the later one counts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..errors import OptionError
from ..skeleton import Skeleton, matching

Weight = float | str | Sequence[str] | Sequence[tuple[float, float]] | Mapping[str, float | str]
Points = list[tuple[float, float]]


class Rule(NamedTuple):
    """Weights at times (seconds; a constant one has the time 0 alone) of the joints that a name fits (None: all)."""

    name: str | None
    times: np.ndarray
    weights: np.ndarray


def parse(weight: Weight, what: str = "weight") -> tuple[Rule, ...]:
    """Rules from any of the forms; OptionError where it is none of them. `what` is how the option is called."""
    found: dict[str | None, Points] = {}
    for name, value in _entries(weight, what):
        points = _points(value, what)
        timed = isinstance(value, tuple) or (isinstance(value, str) and ":" in value)
        found[name] = [*(found.pop(name, []) if timed else []), *points]
    return tuple(Rule(name, *_curve(points, what)) for name, points in found.items())


def resolve(rules: Sequence[Rule], skeleton: Skeleton, times: np.ndarray, rest: float) -> np.ndarray:
    """(F, J) weights at the times (F,); `rest` where no rule speaks of a joint. UnknownName for a name that fits
    none."""
    weights = np.full((len(times), len(skeleton.names)), float(rest))
    for rule in rules:
        joints = slice(None) if rule.name is None else matching(rule.name, skeleton.names, skeleton.names, "joint")
        weights[:, joints] = np.interp(times, rule.times, rule.weights)[:, None]
    return weights


def constant(rules: Sequence[Rule]) -> bool:
    """Whether no weight changes in time."""
    return all(len(rule.times) == 1 for rule in rules)


def told(rules: Sequence[Rule]) -> float | list[str]:
    """The rules as a step of a history can say them."""
    if len(rules) == 1 and rules[0].name is None and constant(rules):
        return float(rules[0].weights[0])
    return [_text(rule) for rule in rules]


def _text(rule: Rule) -> str:
    points = ",".join(f"{time!r}:{w!r}" for time, w in zip(rule.times.tolist(), rule.weights.tolist(), strict=True))
    value = points if len(rule.times) > 1 else repr(float(rule.weights[0]))
    return value if rule.name is None else f"{rule.name}={value}"


def _entries(weight: Weight, what: str) -> list[tuple[str | None, object]]:
    if isinstance(weight, Mapping):
        return list(weight.items())
    if isinstance(weight, str):
        name, equals, value = weight.rpartition("=")
        if equals and not name.strip():
            raise _odd(weight, what)
        return [(name.strip() or None, value)]
    if isinstance(weight, Sequence | np.ndarray):
        if len(weight) == 0:
            raise _odd(weight, what)
        return [entry for item in weight for entry in _item(item, what)]
    return [(None, weight)]


def _item(item: object, what: str) -> list[tuple[str | None, object]]:
    """What one of several weights says: a text as it would alone, or a pair of time and weight."""
    if isinstance(item, str):
        return _entries(item, what)
    if isinstance(item, Sequence | np.ndarray) and len(item) == 2:
        return [(None, tuple(item))]
    raise _odd(item, what)


def _points(value: object, what: str) -> Points:
    """[(time, weight)] of a number, a pair, or a text of either."""
    if isinstance(value, str) and ":" in value:
        return [point for part in value.split(",") for point in _points(tuple(part.split(":")), what)]
    pair: Any = value if isinstance(value, Sequence | np.ndarray) and not isinstance(value, str) else (0.0, value)
    try:
        time, weight = (float(number) for number in pair)
    except (TypeError, ValueError):
        raise _odd(value, what) from None
    if not np.isfinite([time, weight]).all():
        raise _odd(value, what)
    return [(time, weight)]


def _curve(points: Points, what: str) -> tuple[np.ndarray, np.ndarray]:
    times, weights = np.array(sorted(points)).T
    twice = times[1:][np.diff(times) == 0]
    if len(twice):
        raise OptionError(f"{what}: two values are given at {twice[0]:g} s")
    return times, weights


def _odd(given: object, what: str) -> OptionError:
    return OptionError(
        f"a {what} is a number, or numbers at times as in 0:0,2:1, with NAME= before it for some joints, not {given!r}"
    )
