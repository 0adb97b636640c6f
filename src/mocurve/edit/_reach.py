"""What locked feet took, and where it was too much: by how much, in which frames, and which stride would mend it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..errors import OptionError
from ..feet.contacts import runs

# what may be asked of a body: cm, degrees, and degrees a second; nobody was captured who turns a standing foot faster
LIMITS = {
    "drop": 2.5,
    "shift": 4.0,
    "twist": 45.0,
    "pivot": 540.0,
    "miss": 0.05,
    "short": 8.0,  # the swing is lower and nearer to the body for it; ankles and knees stay as calm
    "hip": 5.0,
    "ankle": 5.0,
}
SAID = {
    "drop": "the hips sink {value:.1f} cm (most {limit:g})",
    "shift": "the hips go {value:.1f} cm aside (most {limit:g})",
    "twist": "the body turns {value:.0f} degrees over a standing foot (most {limit:g})",
    "pivot": "a standing foot turns on the spot at {value:.0f} degrees a second (most {limit:g})",
    "miss": "a standing foot is {value:.1f} cm out of reach (most {limit:g})",
    "short": "a swinging foot falls {value:.1f} cm short (most {limit:g})",
    "hip": "a hip is turned {value:.0f} degrees further than it can be (most {limit:g})",
    "ankle": "an ankle is turned {value:.0f} degrees further than it can be (most {limit:g})",
}
AIMED = 0.8  # of a limit: what shorter steps are to come down to
# cm more of something for steps twice as long, where little is too much; where much is, twice as much more of it
GROWS = {"drop": 14.0, "shift": 28.0, "miss": 14.0, "short": 28.0}
TURNS = ("twist", "pivot")  # grow as the steps
SHORTEST = 0.4  # times as long: shorter steps than that are another motion
APART = 0.5  # seconds: spans nearer than that are told as one
TOLD = 3  # problems in one sentence


@dataclass(frozen=True)
class Problem:
    """Too much of something: which of LIMITS, its largest value in a span, first and last frame of that, and how many
    times as long as they are the steps there should be; None where that would not help. side: which leg, -1: both.
    peak: the frame of the largest value."""

    kind: str
    value: float
    first: int
    last: int
    stride: float | None
    side: int = -1
    peak: int = 0

    def sentence(self, frame_time: float) -> str:
        """What is wrong and where, in words."""
        told = SAID[self.kind].format(value=self.value, limit=LIMITS[self.kind])
        mend = "" if self.stride is None else f"; steps about {self.stride:.2f} times as long would do"
        where = f"frames {self.first} to {self.last}, {self.first * frame_time:.2f} to {self.last * frame_time:.2f} s"
        return f"{told} at {where}{mend}"


@dataclass(frozen=True)
class Strain:
    """What locked feet took, cm and degrees, largest over all frames.

    stances: how many. changed: how many of them were not held as they are.
    drop:  how far the body sinks. shift: how far it goes over the ground. twist: how far it is turned against a
    standing foot, more than it ever is in the source. pivots: how many standing feet turn on the spot; pivoted: how
    far, pivot: how fast, a second. miss: how far a standing ball is from its place. short: how far a swinging ankle is
    from where it was meant to be. hip, ankle: how far beyond what they can do. sunk: how far a slope takes the body
    down besides, which is no strain.
    """

    stances: int
    changed: int
    drop: float
    shift: float
    twist: float
    pivot: float
    miss: float
    short: float
    hip: float
    ankle: float
    pivots: int = 0
    pivoted: float = 0.0
    problems: tuple[Problem, ...] = ()
    sunk: float = 0.0

    @classmethod
    def none(cls, stances: int) -> Strain:
        """Nothing was to be done."""
        return cls(stances, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

    @classmethod
    def of(
        cls,
        stances: int,
        changed: int,
        tracks: Mapping[str, np.ndarray],
        wholes: np.ndarray,
        even: bool,
        frame_time: float,
    ) -> Strain:
        """From what was taken of each kind in every frame: (F,) of the body, or (2, F) of the legs; by how much (N,)
        standing feet turn, radians. even: whether all frames are carried alike."""
        found = {kind: float(max(track.max(initial=0.0), 0.0)) for kind, track in tracks.items()}
        problems = [
            problem
            for kind, track in tracks.items()
            if found[kind] > LIMITS[kind]
            for side, one in ([(-1, track)] if track.ndim == 1 else enumerate(track))
            for problem in _problems(kind, one, even, frame_time, side)
        ]
        problems.sort(key=lambda problem: -problem.value / LIMITS[problem.kind])
        count, whole = int((wholes > 0).sum()), float(np.degrees(wholes.max(initial=0.0)))
        drop, shift, twist, pivot, miss, short, hip, ankle = (found[kind] for kind in LIMITS)
        return cls(stances, changed, drop, shift, twist, pivot, miss, short, hip, ankle, count, whole, tuple(problems))

    def refuse(self, frame_time: float, mend: str) -> None:
        """OptionError with the worst problems, if there are any, and what can be done instead."""
        if self.problems:
            told = [problem.sentence(frame_time) for problem in self.problems[:TOLD]]
            more = len(self.problems) - len(told)
            rest = f"; and {more} more such span{'' if more == 1 else 's'}" if more else ""
            raise OptionError(f"feet cannot be held: {'; '.join(told)}{rest}. {mend}")

    def later(self, frames: int) -> Strain:
        """The same of a clip with so many frames in front."""
        moved = (replace(p, first=p.first + frames, last=p.last + frames, peak=p.peak + frames) for p in self.problems)
        return replace(self, problems=tuple(moved))


# -- in call order ---------------------------------------------------------------------------------


def _problems(kind: str, track: np.ndarray, even: bool, frame_time: float, side: int) -> list[Problem]:
    """The spans in which a track (F,) is beyond its limit. even: whether all frames are carried alike; then the steps
    are as long as they ever were."""
    spans: list[tuple[int, int]] = []
    for first, end in runs(track > LIMITS[kind]).tolist():
        if spans and (first - spans[-1][1]) * frame_time < APART:
            first = spans.pop()[0]
        spans.append((first, end))
    values = [float(track[first:end].max()) for first, end in spans]
    return [
        Problem(
            kind,
            value,
            first,
            end - 1,
            None if even else _stride(kind, value),
            side,
            first + int(np.argmax(track[first:end])),
        )
        for value, (first, end) in zip(values, spans, strict=True)
    ]


def _stride(kind: str, value: float) -> float | None:
    """How many times as long the steps should be. The turn of a foot grows as the step; how the others do was measured
    on walks and runs with stretched steps. None where no other length is known to help."""
    if kind not in GROWS and kind not in TURNS:
        return None
    aim = AIMED * LIMITS[kind]
    over = value - aim
    return max(SHORTEST, aim / value if kind in TURNS else 1.0 - over / (GROWS[kind] + 2.0 * over))
