"""How much the feet of a clip slide, before and after: where they stand in the first of two clips."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from .errors import MocurveError
from .feet.contacts import HEIGHT, found, slowness
from .feet.legs import legs
from .feet.skate import Skate, skate
from .motion import Motion


@dataclass(frozen=True)
class FootSkate:
    """Contacts of both balls in the first clip, and how these slide there (`before`) and in the second (`after`)."""

    contacts: int
    before: Skate
    after: Skate

    def __str__(self) -> str:
        before, after = self.before, self.after
        return (
            f"slide {before.speed:.2f} -> {after.speed:.2f} cm/s in {self.contacts} contacts, drift "
            f"{before.drift:.2f} -> {after.drift:.2f} cm; {100 * after.kept:.1f} % of the contact is kept"
        )

    def to_json(self) -> dict[str, Any]:
        """Plain dict for json.dumps."""
        return asdict(self)

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> FootSkate:
        """What `to_json` told."""
        return cls(data["contacts"], Skate(**data["before"]), Skate(**data["after"]))


def foot_skate(before: Motion, after: Motion) -> FootSkate | None:
    """How feet slide in two clips of as many frames; None for a body without two legs, or without feet that stand."""
    try:
        both, speed = legs(before), slowness(before)
        balls = {before.skeleton.names[leg.ball] for leg in both}
        listed = [contact for contact in found(before, both, speed, HEIGHT) if contact.joint in balls]
        own, now = skate(before, listed, both, None, speed), skate(after, listed, both, before, speed)
    except MocurveError:  # no legs, no unit, gaps
        return None
    return None if own is None or now is None else FootSkate(len(listed), own, now)
