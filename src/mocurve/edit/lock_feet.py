"""The verb `lock_feet`: feet that slide while they should stand are held still.

Source: Kovar, Schreiner and Gleicher 2002, Footskate cleanup for motion capture editing; how it is done here tells
`_locking`.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..feet.contacts import HEIGHT, Contact, found, positive, read_contacts, slowness
from ..feet.legs import Leg, feet_of, legs
from ..feet.skate import skate
from ..info import tell_up
from ..motion import Clip, Motion, complete
from ._locking import held, source_of
from ._pair import recorded, tell_sampled
from ._reach import Strain
from ._release import released


@dataclass(frozen=True)
class Locked:
    """What was held, and what it took; centimetres. How feet slide is measured in all contacts of the clip that was
    given, after it by forward kinematics of the result (`feet.skate`).

    stances: of both feet, ball and heel together. changed: those that slid.
    speed, drift: of balls in contact, mean over the ground a second, and mean of the largest distance to the middle of
    a contact; each as it was and as it is. kept: part of the contact that is still one.
    drop, shift: how far the hips go down and aside at most.
    contacts: all, given or found, as JSON has them: to be changed and given again. released: those that were let go.
    """

    stances: int
    changed: int
    speed_before: float
    speed: float
    drift_before: float
    drift: float
    kept: float
    drop: float
    shift: float
    contacts: Sequence[dict[str, Any]] = ()
    released: Sequence[dict[str, Any]] = ()

    def __str__(self) -> str:
        lines = [
            f"{self.stances} stances, {self.changed} of them held anew",
            f"feet in contact slide {self.speed_before:.2f} -> {self.speed:.2f} cm/s, {self.drift_before:.2f} -> "
            f"{self.drift:.2f} cm a contact; {100 * self.kept:.1f} % of the contact is kept",
            f"the hips go down by at most {self.drop:.2f} cm and aside by {self.shift:.2f} cm",
        ]
        if self.released:
            lines.append(f"{len(self.released)} contacts were let go")
        return "\n".join(lines)

    def to_json(self) -> dict[str, Any]:
        """The same as plain numbers, texts and lists."""
        return asdict(self) | {"contacts": list(self.contacts), "released": list(self.released)}


def lock_feet(
    clip: Clip,
    contacts: Sequence[Contact | Mapping[str, Any]] | None = None,
    *,
    feet: str | Sequence[str] | None = None,
    speed: float | None = None,
    height: float = HEIGHT,
    release: bool = False,
) -> Motion:
    """The motion with its feet held still where they stand; as little as can be is changed elsewhere.

    contacts: when and where, as `contacts` finds them, or its JSON, changed by hand or not; by default they are found.
    A ball whose contact has another place than it has in the clip goes there.

    Parameters
    ----------
    feet
        The ball (toe base) of each foot; by default found by name and shape.
    speed
        Centimetres a second: slower than this a foot comes to stand, at twice the speed it leaves. By default 15, or 45
        where the body runs.
    height
        Centimetres above the floor that a standing foot may be.
    release
        Let go of contacts that cannot be held without pulling the body out of shape, with a warning. Without it such a
        clip is refused.

    The ball of a standing foot does not move over the ground; its height and the tilt of the foot stay the source's. A
    contact that is held already is not touched, nor is any frame 0.6 s away from contacts that slide, or any joint but
    hips, knees, ankles and the place of the body. The last step of the `history` has the numbers of `Locked` under
    "measured". Errors: Mismatch where there are no two legs or samples are missing, OptionError for contacts that are
    not in the clip, and where the body would have to sink by 2.5 cm, to go aside by 4 cm, a foot is out of reach, or a
    hip or ankle would go further than it can: the message names the frames.

    >>> still = mc.lock_feet(mc.read("walk.bvh"))
    """
    positive(speed=speed, height=height)
    motion = complete(clip.sample())
    tell_sampled([clip], "feet are locked frame by frame")
    both = legs(motion, feet)
    tell_up(motion, "feet stand")
    slow = slowness(motion) if speed is None else speed
    listed = found(motion, both, slow, height) if contacts is None else read_contacts(contacts, motion, both)
    if contacts is None and not listed:
        warnings.warn(
            "no foot stands anywhere: nothing is locked; the option speed says how slow is standing", stacklevel=2
        )
    made, strain, gone = _held(motion, listed, both, release)
    strain.refuse(motion.frame_time, "Contacts can be changed, or let go with the option release")
    measured = _measured(motion, made, listed, both, slow, strain, gone)
    given = None if contacts is None else [contact.to_json() for contact in listed]
    named = feet if feet is None or isinstance(feet, str) else list(feet)
    told = {"verb": "lock_feet", "contacts": given, "feet": named, "speed": speed, "height": height, "release": release}
    return recorded(made, (*clip.history, {**told, "measured": measured.to_json()}))  # type: ignore[return-value]


# -- in call order ---------------------------------------------------------------------------------


def _held(
    motion: Motion, listed: Sequence[Contact], both: Sequence[Leg], release: bool
) -> tuple[Motion, Strain, tuple[Contact, ...]]:
    """The motion with its feet held in these contacts, without those that are let go, if that is asked for."""
    source, still = source_of(motion, listed, both), np.zeros((motion.frames, 3))
    if not release:
        return *held(source, still), ()
    made, strain, gone, _ = released(
        listed,
        feet_of(motion, both),
        lambda kept: held(source if len(kept) == len(listed) else source.standing(kept), still),
    )
    if gone:
        warnings.warn(
            f"{len(gone)} of {len(listed)} contacts cannot be held and are let go, the first of {gone[0].joint!r} at "
            f"frame {gone[0].first}",
            stacklevel=3,
        )
    return made, strain, gone


def _measured(
    motion: Motion,
    made: Motion,
    listed: Sequence[Contact],
    both: Sequence[Leg],
    speed: float,
    strain: Strain,
    gone: Sequence[Contact],
) -> Locked:
    names = {motion.skeleton.names[leg.ball] for leg in both}
    balls = [contact for contact in listed if contact.joint in names]
    before, after = (skate(clip, balls, both, motion, speed) for clip in (motion, made))
    return Locked(
        stances=strain.stances,
        changed=strain.changed,
        speed_before=before.speed if before else 0.0,
        speed=after.speed if after else 0.0,
        drift_before=before.drift if before else 0.0,
        drift=after.drift if after else 0.0,
        kept=after.kept if after else 1.0,
        drop=strain.drop,
        shift=strain.shift,
        contacts=[contact.to_json() for contact in listed],
        released=[contact.to_json() for contact in gone],
    )
