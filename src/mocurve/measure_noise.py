"""What denoising found in a clip: the noise of every channel, and the frames that were no motion."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

from .motion import Motion

KINDS = {
    "lost": "samples that were missing (NaN)",
    "frozen": "a joint that repeats a frame, or is zero, while it should move",
    "spike": "one or two frames that stand out",
    "run": "several frames that leave and come back as no body does",
    "offset": "a longer part that is displaced as a whole, moved back",
}


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
