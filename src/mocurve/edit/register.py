"""The verb `register`: a clip retimed so that it runs in step with another.

Source: Bruderlin and Williams 1995, Motion signal processing, section 4.2; the distance of poses is Kovar's (planar).
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any, TypeVar

import numpy as np

from .. import planar
from ..errors import OptionError
from ..info import first_frame_is_t_pose
from ..kinematics import world
from ..motion import Clip, Motion, complete
from . import _dtw
from ._pair import check
from ._seams import centimetres
from .retime import retime

MOST = 1500  # frames that are matched; of longer clips only every second, third ... one
WINDOW = 0.05  # seconds of motion that are compared as one pose
SAME = 1e-6  # of the largest distance: less is rounding

AnyClip = TypeVar("AnyClip", bound=Clip)


@dataclass(frozen=True)
class Registration:
    """How a clip was retimed to run with another, and how alike they are then.

    pairs:            (K, 2) old and new seconds of the map.
    slowest, fastest: new seconds per old one, at most and at least.
    unit:             of the distances: "cm", or "units" of the file where nobody knows how long these are.
    distance:         of the poses that are matched, mean over the cheapest way.
    even_distance:    the same where the clip is only stretched evenly to the other's length.
    usual_distance:   the same of any two moments.
    cost:             of the way, in the file's units: the sum of its distances.
    """

    pairs: list[list[float]]
    slowest: float
    fastest: float
    unit: str
    distance: float
    even_distance: float
    usual_distance: float
    cost: float

    def __str__(self) -> str:
        return (
            f"{self.pairs[-1][0]:.3f} s become {self.pairs[-1][1]:.3f} s, up to {self.slowest:.3g} times slower and "
            f"{1.0 / self.fastest:.3g} times faster\nmatched poses are {self.distance:.3g} {self.unit} apart, "
            f"{self.even_distance:.3g} {self.unit} if only stretched"
        )

    def to_json(self) -> dict[str, Any]:
        """The same as plain numbers, texts and lists."""
        return asdict(self)


def register(
    clip: AnyClip, reference: Clip, *, slope: int = 3, band: float | None = None, match: str = "exact"
) -> AnyClip:
    """The clip, faster here and slower there, so that at every moment it does what the reference does.

    Parameters
    ----------
    slope
        How many frames of one may go by while the other stands; 1 to 100.
    band
        Seconds by which a moment may be moved away from where an even stretch has it; by default as far as need be.
    match
        exact: both bodies have the same joints and channels. names: joints that are called the same are compared.

    Where and which way the two go does not matter. The result has the reference's duration and the clip's kind, body
    and frame time. The last step of its `history` has the numbers of `Registration` under "measured". Errors: Mismatch
    for bodies that do not match, OptionError where no way within slope and band leads from start to end.

    >>> in_step = mc.register(mc.read("slow.bvh"), mc.read("quick.bvh"))
    """
    if not (isinstance(slope, int) and 1 <= slope <= 100):
        raise OptionError(f"slope is a whole number of frames from 1 to 100, not {slope!r}")
    if band is not None and not band > 0:
        raise OptionError(f"band is a positive number of seconds, not {band!r}")
    check(clip.skeleton, reference.skeleton, match)
    found = matched(complete(clip.sample()), complete(reference.sample()), slope, band)
    made = retime(clip, [(before, after) for before, after in found.pairs])
    told = {"verb": "register", "slope": slope, "band": band, "match": match, "with": list(reference.history)}
    step = {**told, "measured": found.to_json()}
    return replace(made, history=(*clip.history, step))  # type: ignore[return-value, type-var]


def matched(own: Motion, other: Motion, slope: int = 3, band: float | None = None) -> Registration:
    """How the one has to be retimed to run with the other; a straight line where nothing is gained by bending it."""
    if min(own.frames, other.frames) < 2:
        raise OptionError("clips of fewer than two frames have no time to match")
    old, new, distances = _compared(own, other)
    step = old[1] - old[0]
    cost, way = _dtw.path(distances, slope, np.inf if band is None else band / step)
    if not len(way):
        near = "" if band is None else f" and a band of {band:g} s"
        raise OptionError(
            f"clips of {own.duration:.4g} and {other.duration:.4g} s do not match with a slope of {slope}{near}"
        )
    even = np.rint(np.linspace(0, len(new) - 1, len(old))).astype(np.int64)
    distance, even_distance = cost / len(way), float(distances[np.arange(len(old)), even].mean())
    if even_distance <= distance + SAME * float(distances.max()):
        pairs = np.array([[old[0], new[0]], [old[-1], new[-1]]])
    else:
        pairs = _dtw.smooth_map(old[way[:, 0]], new[way[:, 1]], max(step, new[1] - new[0]), slope)
    rates = np.diff(pairs[:, 1]) / np.diff(pairs[:, 0])
    length = centimetres(other)
    return Registration(
        pairs=pairs.tolist(),
        slowest=float(rates.max()),
        fastest=float(rates.min()),
        unit="cm" if length else "units",
        distance=(length or 1.0) * distance,
        even_distance=(length or 1.0) * even_distance,
        usual_distance=(length or 1.0) * float(distances.mean()),
        cost=cost,
    )


def _compared(own: Motion, other: Motion) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times (N,) and (M,) in both clips, from the first frame to the last, and the distances (N, M) of the motion
    around them; a T-pose in front is none."""
    names = set(own.skeleton.names) & set(other.skeleton.names)
    stride = max(1, int(np.ceil(max(own.duration, other.duration) / min(own.frame_time, other.frame_time) / MOST)))
    step = stride * min(own.frame_time, other.frame_time)
    half = max(1, round(0.5 * WINDOW / step))
    times, padded = [], []
    for clip in (own, other):
        joints = sorted((clip.skeleton.names.index(name) for name in names), key=clip.skeleton.names.__getitem__)
        count = max(2, round(clip.duration / step) + 1)
        at = np.linspace(0.0, clip.duration, count)
        own_places = world(clip)[:, joints]
        if first_frame_is_t_pose(clip):
            own_places[0] = own_places[1]
        places = _between(own_places, at / clip.frame_time)
        times.append(at)
        padded.append(np.pad(places, ((half, half), (0, 0), (0, 0)), "reflect", reflect_type="odd"))
    return times[0], times[1], planar.frame_distances(padded[0], padded[1], 2 * half + 1)


def _between(places: np.ndarray, frames: np.ndarray) -> np.ndarray:
    """Places (N, J, 3) at frames with fractions (N,), on straight lines."""
    low = np.clip(np.floor(frames + 1e-9).astype(np.int64), 0, len(places) - 2)
    part = (frames - low)[:, None, None]
    return places[low] + part * (places[low + 1] - places[low])
