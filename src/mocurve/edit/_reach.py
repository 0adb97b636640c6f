"""What locked feet took, and where it was too much: how many frames, by how much, and which stride would mend it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .. import planar
from ..feet.contacts import runs
from ..feet.legs import Leg
from ..kinematics import world
from ..motion import Motion
from ._footprints import Targets
from ._stances import Stances

# what may be asked of a body, cm and degrees
LIMITS = {"drop": 2.5, "shift": 4.0, "twist": 45.0, "miss": 0.05, "short": 4.0}
SAID = {
    "drop": "the hips sink {value:.1f} cm (most {limit:g})",
    "shift": "the hips go {value:.1f} cm aside (most {limit:g})",
    "twist": "the body turns {value:.0f} degrees over a standing foot (most {limit:g})",
    "miss": "a standing foot is {value:.1f} cm out of reach (most {limit:g})",
    "short": "a swinging foot falls {value:.1f} cm short (most {limit:g})",
}
USUAL_STRETCH = 1.15  # strides up to so much longer than the source's can be reached
AROUND = 0.5  # seconds on both sides over which the stretch of the way is measured


@dataclass(frozen=True)
class Problem:
    """Too much of something: which of LIMITS, its value there, first and last frame of the worst span, and how many times
    as long as they are the steps there should be, or None where that would not help."""

    kind: str
    value: float
    first: int
    last: int
    stride: float | None

    def sentence(self, frame_time: float) -> str:
        """What is wrong and where, in words."""
        told = SAID[self.kind].format(value=self.value, limit=LIMITS[self.kind])
        mend = "" if self.stride is None else f"; steps {self.stride:.2f} times as long there would do"
        where = f"frames {self.first} to {self.last}, {self.first * frame_time:.2f} to {self.last * frame_time:.2f} s"
        return f"{told} ({where}){mend}"


@dataclass(frozen=True)
class Strain:
    """What locked feet took, cm and degrees, largest over all frames.

    stances: how many. changed: of them. frames: that may differ from the source.
    drop:  how far the body sinks. shift: how far it goes over the ground. twist: how far it is turned against a standing
    foot, more than in the source. miss: how far a standing ball is from its place. short: how far a swinging ankle is
    from where it was meant to be.
    """

    stances: int
    changed: int
    drop: float
    shift: float
    twist: float
    miss: float
    short: float
    problems: tuple[Problem, ...] = ()

    @classmethod
    def none(cls, stances: int) -> Strain:
        """Nothing was to be done."""
        return cls(stances, 0, 0.0, 0.0, 0.0, 0.0, 0.0)

    @classmethod
    def of(
        cls, made: Motion, scale: float, shift: np.ndarray, carry: np.ndarray, stood: Sequence[Stances],
        aims: Sequence[Targets], short: np.ndarray, legs: Sequence[Leg], changed: Sequence[np.ndarray],
    ) -> Strain:
        """Measured on the motion that was made."""
        places = world(made)
        tracks: dict[str, np.ndarray] = {
            "drop": -shift[:, 1],
            "shift": np.linalg.norm(shift[:, [0, 2]], axis=1),
            "twist": np.zeros(len(shift)),
            "miss": np.zeros(len(shift)),
            "short": np.zeros(len(shift)),
        }
        for stance, aim, lacking, leg, held in zip(stood, aims, short, legs, changed, strict=True):
            off = np.linalg.norm(scale * places[:, leg.ball] - aim.ball, axis=1)
            tracks["miss"] = np.maximum(tracks["miss"], np.where(held, off, 0.0))
            turned = np.degrees(np.abs(aim.yaw - carry[:, 0]))
            tracks["twist"] = np.maximum(tracks["twist"], np.where(held, turned, 0.0))
            tracks["short"] = np.maximum(tracks["short"], np.where(stance.of < 0, np.abs(lacking), 0.0))
        found = {kind: float(max(track.max(initial=0.0), 0.0)) for kind, track in tracks.items()}
        problems = [
            _problem(kind, track, scale * places, shift, carry, made.frame_time)
            for kind, track in tracks.items()
            if found[kind] > LIMITS[kind]
        ]
        some = [int(held[stance.spans[:, 0]].sum()) if len(stance.spans) else 0 for stance, held in zip(stood, changed, strict=True)]
        return cls(sum(len(s.spans) for s in stood), sum(some), **found, problems=tuple(problems))

    def later(self, frames: int) -> Strain:
        """The same of a clip with so many frames in front."""
        moved = (replace(p, first=p.first + frames, last=p.last + frames) for p in self.problems)
        return replace(self, problems=tuple(moved))


# -- in call order ---------------------------------------------------------------------------------


def _problem(
    kind: str, track: np.ndarray, places: np.ndarray, shift: np.ndarray, carry: np.ndarray, frame_time: float
) -> Problem:
    worst = int(np.argmax(track))
    first, last = next((a, b - 1) for a, b in runs(track > LIMITS[kind]) if a <= worst < b)
    value = float(track[worst])
    if kind == "twist":  # it grows with the step
        return Problem(kind, value, int(first), int(last), LIMITS[kind] / value)
    around = round(AROUND / frame_time)
    span = slice(max(int(first) - around, 0), int(last) + around + 1)
    now = places[span, 0] - shift[span]
    before = planar.move(planar.inverse(carry[span]), now)
    ways = [np.linalg.norm(np.diff(track[:, [0, 2]], axis=0), axis=1).sum() for track in (now, before)]
    stretch = ways[0] / ways[1] if ways[1] > 0 else 1.0
    stride = USUAL_STRETCH / stretch if stretch > 1.01 * USUAL_STRETCH else None
    return Problem(kind, value, int(first), int(last), stride)
