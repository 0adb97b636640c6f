"""What denoising found in a clip: the noise of every channel, and the frames that were no motion."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass, field
from statistics import median
from typing import Any

from .measure_text import table
from .motion import Motion

KINDS = {
    "lost": "samples that were missing (NaN)",
    "frozen": "a joint that repeats a frame, or is zero, while it should move",
    "spike": "one or two frames that stand out",
    "run": "several frames that leave and come back as no body does",
    "offset": "a longer part that is displaced as a whole, moved back",
}
NAMED = {"lost": "lost run", "frozen": "frozen run"}  # others are called as their kind
NO_FLOOR = "what shakes there cannot be told from motion; a higher strength or a limit in Hz takes it out"
FEW = 4  # names in a sentence


@dataclass(frozen=True)
class ChannelNoise:
    """Noise of one channel, in `unit` ("degrees", or "units" for the file's length unit).

    sigma: standard deviation of its white noise; floor: False where no white noise was found, so that what shakes there
    cannot be told from motion and is left; cutoff: Hz at which the usual strength halves an oscillation, None where
    nothing was smoothed.
    """

    name: str
    unit: str
    sigma: float
    floor: bool
    cutoff: float | None = None


@dataclass(frozen=True)
class Artefact:
    """Frames first ... last (both included) of some channels of a joint; kind: one of KINDS; by: the offset that was
    taken out, for the kind "offset"."""

    joint: str
    channels: tuple[str, ...]
    kind: str
    first: int
    last: int
    by: float | None = None

    @property
    def frames(self) -> int:
        return self.last - self.first + 1


@dataclass(frozen=True)
class Noise:
    """What denoising found.

    channels:  one row a channel that was looked at.
    artefacts: in the order of their first frames.
    samples:   how many samples (frames x channels) the artefacts are, offsets not counted.
    marked:    True where they were marked and kept.
    dropped:   frames taken away at the start, a T-pose.
    captured:  the clip before, without the dropped frames, for the pictures; not part of the JSON.
    """

    channels: tuple[ChannelNoise, ...]
    artefacts: tuple[Artefact, ...] = ()
    samples: int = 0
    marked: bool = False
    dropped: int = 0
    captured: Motion | None = field(default=None, repr=False, compare=False)

    def __str__(self) -> str:
        return "\n".join(self.lines() + self.rows())

    def lines(self) -> list[str]:
        """What was found, in a few lines of text."""
        told = [self._sigma(unit) for unit in ("degrees", "units") if self._noisiest(unit)]
        told = told or ["no channel moves and has the samples that would tell"]
        lines = [f"{'' if place else 'noise':<11}{text}" for place, text in enumerate(told)]
        lines += [f"artefacts  {self._artefacts()}"]
        if self.dropped:
            lines += [f"T-pose     {_count(self.dropped, 'frame')} taken away at the start"]
        sentence = self.no_floor()
        return [*lines, f"no floor   {sentence}"] if sentence else lines

    def rows(self, count: int = 5) -> list[str]:
        """Tables of the noisiest channels of each unit and of the longest artefacts; frames count from 0."""
        noisy = [row for unit in ("degrees", "units") for row in self._noisiest(unit)[:count]]
        cells = [
            [row.name, f"{row.sigma:.3g} {row.unit}", "" if row.cutoff is None else f"{row.cutoff:.3g} Hz"]
            for row in noisy
        ]
        longest = sorted(self.artefacts, key=lambda row: (-row.frames, row.first))[:count]
        step = None if self.captured is None else self.captured.frame_time
        units = {row.name: row.unit for row in self.channels}
        told = [[_where(row), _what(row, units), _span(row.first, row.last), _seconds(row, step)] for row in longest]
        return table(["noisiest channels", "sigma", "halved at"], cells) + table(
            ["longest artefacts", "kind", "frames", "seconds"], told
        )

    def no_floor(self) -> str:
        """The sentence on channels whose noise is not white; empty where all of them have a floor."""
        names = [row.name for row in self.channels if not row.floor]
        if not names:
            return ""
        where = _listed(names) if len(names) <= FEW else f"{len(names)} channels, such as {_listed(names[:FEW])}"
        return f"no white noise floor found in {where}: {NO_FLOOR}"

    def _noisiest(self, unit: str) -> list[ChannelNoise]:
        return sorted((row for row in self.channels if row.unit == unit), key=lambda row: -row.sigma)

    def _sigma(self, unit: str) -> str:
        rows = self._noisiest(unit)
        middle, most = median(row.sigma for row in rows), rows[0]
        return f"{middle:.3g} {unit} (median of {_count(len(rows), 'channel')}), most {most.sigma:.3g} in {most.name}"

    def _artefacts(self) -> str:
        counts = Counter(row.kind for row in self.artefacts)
        if not counts:
            return "none"
        done = dict.fromkeys(KINDS, "marked and kept" if self.marked else "filled in")
        done["lost"] = "filled in"
        done["offset"] = "marked and kept" if self.marked else "moved back"
        parts = []
        for what in dict.fromkeys(done.values()):
            told = [
                _count(counts[kind], NAMED.get(kind, kind)) for kind in KINDS if counts[kind] and done[kind] == what
            ]
            parts += [f"{', '.join(told)} {what}"] if told else []
        apart = ", offsets not counted" if counts["offset"] else ""
        return f"{'; '.join(parts)}; {_count(self.samples, 'sample')}{apart}"

    def to_json(self) -> dict[str, Any]:
        """Plain dict for json.dumps; `Noise.from_json` reads it back."""
        return {
            "channels": [asdict(row) for row in self.channels],
            "artefacts": [asdict(row) for row in self.artefacts],
            "samples": self.samples,
            "marked": self.marked,
            "dropped": self.dropped,
        }

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Noise:
        """The findings that `to_json` told."""
        channels = tuple(ChannelNoise(**row) for row in data["channels"])
        artefacts = tuple(Artefact(**{**row, "channels": tuple(row["channels"])}) for row in data["artefacts"])
        return cls(channels, artefacts, data["samples"], data["marked"], data["dropped"])


# -- in call order -----------------------------------------------------------------------------------------------------


def _count(number: int, name: str) -> str:
    return f"{number:,} {name}{'' if number == 1 else 's'}"


def _where(row: Artefact) -> str:
    """The joint and the kinds of its channels: "Hips Xposition Yposition"."""
    return " ".join([row.joint, *(name.removeprefix(f"{row.joint}.") for name in row.channels)])


def _what(row: Artefact, units: dict[str, str]) -> str:
    return row.kind if row.by is None else f"{row.kind} by {row.by:.3g} {units.get(row.channels[0], '')}".rstrip()


def _span(first: int, last: int) -> str:
    return str(first) if first == last else f"{first}-{last}"


def _seconds(row: Artefact, step: float | None) -> str:
    """When it begins and how long it lasts; empty where the frame time is not known."""
    return "" if step is None else f"{row.first * step:.2f} for {row.frames * step:.3f}"


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
