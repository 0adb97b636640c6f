"""The verb `bands`: the fine and the slow of a motion, each made more or less (Bruderlin and Williams 1995,
multiresolution filtering)."""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from .. import kinematics
from ..errors import OptionError
from ..info import first_frame_is_t_pose
from ..motion import Clip, Motion, complete
from ..skeleton import Skeleton, matching
from . import _bank
from ._pair import recorded, tell_sampled
from ._turns import free_joints

Gains = Mapping[int | str, float] | Sequence[float] | Sequence[str] | str
LARGEST = np.finfo(np.float64).max
HERTZ = re.compile(r"\s*([0-9.eE+-]+)\s*hz\s*", re.IGNORECASE)


@dataclass(frozen=True)
class Band:
    """One band: Hz from and to, how large it is in the clip that came in, and its gain.

    degrees: root mean square of the angles of the chosen joints over all frames; units: of the position channels.
    """

    band: int
    from_hertz: float
    to_hertz: float
    degrees: float
    units: float
    gain: float

    def __str__(self) -> str:
        size = f"{self.degrees:10.4g} degrees{self.units:10.4g} units"
        period = f"{1.0 / self.to_hertz:7.3g} to {1.0 / self.from_hertz:<6.3g} s"
        return f"{self.band:5}{self.from_hertz:9.3g} to {self.to_hertz:<6.3g} Hz{period:>19}{size}   gain {self.gain:g}"


def bands(clip: Clip, gains: Gains = (), *, only: str | Sequence[str] = ()) -> Clip:
    """The clip with each of its frequency bands times a gain: 0 takes it away, 2 doubles it, 1 leaves it.

    Parameters
    ----------
    gains
        By band, 0 being the finest: [0, 0.5] or {0: 0, 1: 0.5}; or by a frequency that lies in the band, {"6Hz": 1.5}.
        A band that is not named has gain 1.
    only
        Joints whose channels change, * stands for anything: Spine, *Arm. By default all.

    Bands are an octave wide. The last step of the `history` tells them under "measured": Hz, and how large each is in
    the clip. Angles of joints are multiplied as rotations, and what turns on and on as an angle. Joints whose motion
    stays come back to the last digit. Keys and splines become samples, unless all gains are 1. Amplified legs slide and
    leave the ground. Errors: OptionError for a gain or for a band that the clip does not have, UnknownName for a joint.

    >>> calm = mc.bands(walk, {0: 0, 1: 0, 2: 0.5})
    """
    own = complete(clip.sample())
    joints = _chosen(own.skeleton, only)
    asked = parse(gains)
    wanted = _resolved(asked, _bank.count(own.frames), own)
    made, sizes = _filtered(own, joints, wanted)
    result: Clip = clip
    if (wanted != 1.0).any():
        tell_sampled((clip,), "bands are filtered frame by frame")
        if first_frame_is_t_pose(own):
            warnings.warn("frame 0 is a T-pose and spreads into the motion: drop it first", stacklevel=2)
        result = made
    edges = _bank.edges(len(wanted), own.frame_time)
    found = [
        Band(k, float(edges[k + 1]), float(edges[k]), float(sizes[k, 0]), float(sizes[k, 1]), float(gain))
        for k, gain in enumerate(wanted)
    ]
    step = {"verb": "bands", "gains": asked, "only": only if isinstance(only, str) else list(only)}
    return recorded(result, (*clip.history, {**step, "measured": [asdict(band) for band in found]}))


def parse(gains: Any) -> dict[str, float]:
    """{"0": 0.5, "6Hz": 2} from any of the forms; also "0=0.5", "0=0.5,6Hz=2", "0,0.5,1" and lists of these."""
    if isinstance(gains, Mapping):
        pairs: list[Any] = list(gains.items())
    else:
        items = gains.split(",") if isinstance(gains, str) else list(gains) if np.iterable(gains) else [gains]
        texts = [part for item in items for part in (item.split(",") if isinstance(item, str) else [item])]
        named = [isinstance(text, str) and "=" in text for text in texts]
        if any(named) and not all(named):
            raise OptionError("gains are a list from band 0 on, or BAND=GAIN each; not both")
        pairs = [text.split("=", 1) for text in texts] if any(named) else list(enumerate(texts))
    found: dict[str, float] = {}
    for band, gain in pairs:
        name = str(band).strip()
        hertz = HERTZ.fullmatch(name)
        try:
            number = float(gain) if not isinstance(gain, bool) else np.nan
            place = float(hertz[1]) if hertz else int(name)
        except (TypeError, ValueError):
            number = place = np.nan
        if not np.isfinite([number, place]).all() or place < 0:
            raise OptionError(f"a gain is a number for a band, such as 0=0.5, or 6Hz=2; not {band}={gain}")
        found[f"{place:g}Hz" if hertz else str(place)] = number
    return found


# -- in call order ---------------------------------------------------------------------------------


def _chosen(skeleton: Skeleton, only: str | Sequence[str]) -> np.ndarray:
    """(J,) the joints that the names fit, all where there is none."""
    names = [only] if isinstance(only, str) else list(only)
    joints = np.full(len(skeleton.names), not names)
    for name in names:
        joints[matching(name, skeleton.names, skeleton.names, "joint")] = True
    return joints


def _resolved(asked: Mapping[str, float], count: int, motion: Motion) -> np.ndarray:
    """A gain for each band (K,)."""
    wanted = np.ones(count)
    edges = _bank.edges(count, motion.frame_time)
    there = f"a clip of {motion.frames} frames has {f'bands 0 to {count - 1}' if count else 'none'}"
    given: dict[int, str] = {}
    for name, gain in asked.items():
        hertz = HERTZ.fullmatch(name)
        band = int(np.searchsorted(-edges, -float(hertz[1]), "right")) - 1 if hertz else int(name)
        if not 0 <= band < count:
            low = f", {edges[-1]:.3g} to {edges[0]:.3g} Hz" if count else ""
            raise OptionError(f"there is no band {name}: {there}{low}")
        if band in given:
            raise OptionError(f"two gains are given for band {band}: by {given[band]} and by {name}")
        given[band], wanted[band] = name, gain
    return wanted


def _filtered(motion: Motion, joints: np.ndarray, gains: np.ndarray) -> tuple[Motion, np.ndarray]:
    """The motion with its bands times the gains, and (K, 2) how large they were: degrees, units."""
    skeleton, values = motion.skeleton, np.array(motion.values, order="F")
    free = [entry for entry in free_joints(skeleton) if joints[entry[0]]]
    turning = kinematics.rotations(motion)
    squares, counts = np.zeros((len(gains), 2)), np.zeros(2)
    turned = {}
    for joint, _, _ in free:
        turned[joint], found = _bank.turned(turning[:, joint], gains)
        squares[:, 0] += (np.degrees(found) ** 2).sum(axis=(1, 2))
        counts[0] += motion.frames
    rotates = skeleton.rotation_channels
    alone = np.setdiff1d(np.flatnonzero(joints[skeleton.channel_joints]), [c for _, own, _ in free for c in own])
    for column in alone:  # one by one: all bands of all channels of a long clip would not fit into memory
        kind, own = (
            (0, np.unwrap(values[:, [column]], period=360.0, axis=0)) if rotates[column] else (1, values[:, [column]])
        )
        made, found = _bank.shaped(own, gains)
        if (made != own).any():
            values[:, column] = made[:, 0]
        with np.errstate(over="ignore"):
            squares[:, kind] += (found**2).sum(axis=(1, 2))
        counts[kind] += motion.frames
    result = replace(motion, values=values, report=None)
    turning = kinematics.rotations(result)
    for joint, track in turned.items():
        turning[:, joint] = track
    return kinematics.with_rotations(result, turning), np.sqrt(np.minimum(squares, LARGEST) / np.maximum(counts, 1.0))
