"""Whole poses: which frames say most of a clip, for every number of keys, and the keys made of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from .. import progress
from ..errors import Mismatch, OptionError
from ..feet.contacts import contacts
from ..motion import Clip, Motion
from . import broken, cluster, posture, probe, salient
from .choices import Choices
from .inbetweens import centred, fitted, given, keys_of, stage_of
from .keys import Keys
from .problem import known, numbers
from .tolerance import Limits
from .whole_poses import best_poses, evenly, fewer, moved

CHOOSERS: dict[str, Callable[[Motion, np.ndarray, int], Choices]] = {
    "salient": salient.choose,
    "broken": broken.choose,
    "posture": posture.choose,
    "probe": probe.choose,
    "cluster": cluster.choose,
}
STARTS_FROM_SALIENT = 2048  # frames: in longer clips the search for optimal poses starts from `posture`
CONTACTS = "contacts"

Pins = Sequence[int | str]


@dataclass(frozen=True, eq=False)
class Poses:
    """Which frames of a clip are keys, for every number of keys that there is a choice for: slide from few to all.

    choices: key frames, each with one key more than the one before. errors: (N,) of each, in the method's own measure,
    which `measure` tells."""

    motion: Motion
    method: str
    measure: str
    choices: tuple[np.ndarray, ...]
    errors: np.ndarray

    def __repr__(self) -> str:
        return f"<Poses by {self.method}: {self.fewest} to {self.most} keys of {self.motion.frames} frames>"

    @property
    def fewest(self) -> int:
        return len(self.choices[0]) if self.choices else 0

    @property
    def most(self) -> int:
        return len(self.choices[-1]) if self.choices else 0

    def frames(self, keys: int) -> np.ndarray:
        """The key frames (keys,). OptionError where there is no choice with so many keys."""
        return self.choices[self._place(keys)]

    def error(self, keys: int) -> float:
        """What so many keys leave, in the method's own measure."""
        return float(self.errors[self._place(keys)])

    def within(self, error: float) -> int:
        """The fewest keys whose error is at most this, in the method's own measure: all that follow keep it too."""
        over = np.flatnonzero(~(self.errors <= error))
        return self.fewest if len(over) == 0 else min(int(over[-1]) + 1 + self.fewest, self.most)

    def weights(self, keys: int) -> np.ndarray:
        """W (F, keys): each frame as a linear combination of the key poses, as key probe and clusters have it; of the
        places of joints and end sites, counted from the root."""
        return probe.weights(self.motion, self.frames(keys))

    def _place(self, keys: int) -> int:
        if isinstance(keys, bool) or not isinstance(keys, int | np.integer) or not self.fewest <= keys <= self.most:
            raise OptionError(f"{self.method} has a choice of {self.fewest} to {self.most} keys, not {keys!r}")
        return int(keys) - self.fewest


def poses(clip: Clip, *, method: str = "salient", pin: Pins | None = None) -> Poses:
    """Which frames say most of a clip, for every number of keys at once.

    Parameters
    ----------
    method
        salient (Roberts et al. 2019), broken (least error in space, broken tangents), posture (Lim and Thalmann 2001),
        probe (Huang et al. 2005) or cluster (Park and Shin 2004).
    pin
        Keys that every choice has: frames (40), times (1.2s), or contacts, where a foot comes to stand and where it
        stands last.

    Errors: UnknownName for a method, OptionError for a pin that is not in the clip, or a clip too long for tables of
    all pairs of frames (4096). The curves through a choice are made by `reduce` with `keys`.

    >>> range_of_poses = mc.poses(walk)
    >>> range_of_poses.frames(12), range_of_poses.error(12)
    """
    known("method", method, CHOOSERS)
    motion = numbers(clip)
    if motion.frames < 2:
        alone = (np.arange(motion.frames),) if motion.frames else ()
        return Poses(motion, method, "nothing is left out", alone, np.zeros(len(alone)))
    found = CHOOSERS[method](motion, pins(pin, motion), motion.frames)
    return Poses(motion, method, found.measure, tuple(found.frames), found.errors)


def by_number(
    clip: Clip, numbers_of_keys: Sequence[int], *, pin: Pins | None = None, quality: str = "default"
) -> dict[str, list[float]]:
    """For every method and for keys evenly in time: the largest error in space (file units) of the curves that `reduce`
    makes of so many whole poses, one for each number of keys."""
    motion = numbers(clip)
    stage, pinned = stage_of(motion), pins(pin, motion)
    told: dict[str, list[float]] = {name: [] for name in ("optimal", *CHOOSERS, "even")}
    for number, keys in enumerate(numbers_of_keys):
        for method, row in told.items():
            progress.advance("comparing methods", number * len(told) + len(row) // len(told), len(numbers_of_keys) * 7)
            if method == "even":
                row.append(centred(fitted(stage, pinned, evenly(motion.frames, keys, pinned))).worst)
            elif method == "broken":
                row.append(broken.error_of(stage, with_number(motion, method, pinned, keys, quality).frames))
            else:
                row.append(given(stage, pinned, with_number(motion, method, pinned, keys, quality)).worst)
    return told


def pins(pin: Pins | None, motion: Motion) -> np.ndarray:
    """(F,) True where a key has to be: at the first and the last frame, and where `pin` says."""
    pin = () if pin is None else pin
    if isinstance(pin, str | int) or not isinstance(pin, Sequence):
        raise OptionError(f"pin is a list of frames and times, like [40, '1.2s'], not {pin!r}")
    chosen = np.zeros(motion.frames, bool)
    chosen[[0, -1] if motion.frames else []] = True
    for one in pin:
        if one == CONTACTS:
            chosen |= _contacts(motion)
        else:
            chosen[_frame(one, motion)] = True
    return chosen


def with_number(motion: Motion, method: str, pinned: np.ndarray, keys: int, quality: str) -> Keys:
    """So many whole poses, at least error in space."""
    frames = motion.frames
    if keys >= frames:
        return at_every_frame(motion)
    if keys < pinned.sum():
        also = f" and {pinned.sum() - 2} pinned ones" if pinned.sum() > 2 else ""
        raise OptionError(
            f"keys stand on the first and the last frame{also}: at least {pinned.sum()} are needed, not {keys}"
        )
    if method != "optimal":
        return _through(motion, method, pinned, _chosen(motion, method, pinned, int(keys)), quality)
    others = [_chosen(motion, name, pinned, int(keys)) for name in ("posture", "probe")]
    start = _chosen(motion, "salient", pinned, int(keys)) if frames <= STARTS_FROM_SALIENT else others[0]
    starts = [start, evenly(frames, int(keys), pinned)]
    return keys_of(best_poses(stage_of(motion), pinned, starts, others, quality))


def within_limits(motion: Motion, method: str, pinned: np.ndarray, limits: Limits) -> Keys:
    """The fewest whole poses that the method finds to keep the limits; where it finds none, as many as it has."""
    if motion.frames < 2:
        return at_every_frame(motion)
    stage = stage_of(motion, limits)
    choices = CHOOSERS[method](motion, pinned, motion.frames).frames
    low, high = 0, len(choices) - 1
    while low < high:
        middle = (low + high) // 2
        progress.advance("looking for the number of poses", len(choices) - (high - low), len(choices))
        if method == "broken":
            holds = broken.error_of(stage, choices[middle]) <= 1.0
        else:
            holds = fitted(stage, pinned, choices[middle]).worst <= 1.0
        low, high = (low, middle) if holds else (middle + 1, high)
    if len(choices[high]) == motion.frames:
        return at_every_frame(motion)
    return broken.keys_at(stage, choices[high]) if method == "broken" else keys_of(fitted(stage, pinned, choices[high]))


def with_fewer(motion: Motion, pinned: np.ndarray, limits: Limits, keys: Keys, quality: str) -> Keys:
    """Fewer whole poses that keep the limits in space, where some are found; keys: such as keep them, pins included."""
    if limits.joints is None or len(keys.frames) <= pinned.sum() or keys.in_slopes is not None:
        return keys
    found = fewer(given(stage_of(motion, limits), pinned, keys), quality)
    return keys_of(found) if len(found.frames) < len(keys.frames) else keys


def within_span(motion: Motion, method: str, pinned: np.ndarray, part: float, quality: str) -> Keys:
    """The fewest poses of which every posture is a linear combination but for this part of it."""
    if motion.frames < 2:
        return at_every_frame(motion)
    found = CHOOSERS[method](motion, pinned, motion.frames)
    choices = Poses(motion, method, found.measure, tuple(found.frames), found.errors)
    return _through(motion, method, pinned, choices.frames(choices.within(part)), quality)


def nearer(motion: Motion, pinned: np.ndarray, keys: Keys) -> Keys:
    """As many whole poses, moved until they leave no more in space than they do now; broken tangents stay."""
    if len(keys.frames) < 3 or keys.in_slopes is not None:
        return keys
    now = given(stage_of(motion), pinned, keys)
    moved(now)
    return keys_of(centred(now))


def at_every_frame(motion: Motion) -> Keys:
    """A key at every frame."""
    samples = motion.values
    slopes = np.gradient(samples, axis=0) if motion.frames > 1 else np.zeros_like(samples)
    return Keys(np.arange(motion.frames), np.ascontiguousarray(samples.T), np.ascontiguousarray(slopes.T))


# -- in call order ---------------------------------------------------------------------------------


def _contacts(motion: Motion) -> np.ndarray:
    """(F,) True where the ball or the heel of a foot comes to stand, and where it stands last."""
    chosen = np.zeros(motion.frames, bool)
    for contact in contacts(motion):
        chosen[[contact.first, contact.last]] = True
    return chosen


def _frame(one: int | str, motion: Motion) -> int:
    text = str(one).strip() if isinstance(one, str | int | np.integer) and not isinstance(one, bool) else ""
    try:
        frame = round(float(text[:-1]) / motion.frame_time) if text.endswith("s") else int(text)
    except (ValueError, OverflowError):
        raise OptionError(f"a pin is a frame (40), a time (1.2s) or {CONTACTS}, not {one!r}") from None
    if not 0 <= frame < motion.frames:
        end = f"{motion.frames - 1}, which is at {motion.duration:g} s" if motion.frames else "none: it is empty"
        raise OptionError(f"the pin {one!r} lies outside the clip, whose last frame is {end}")
    return frame


def _chosen(motion: Motion, method: str, pinned: np.ndarray, keys: int) -> np.ndarray:
    if method == "broken":
        found = broken.choose(motion, pinned, keys, keys).frames
    else:
        found = CHOOSERS[method](motion, pinned, keys).frames
    if len(found[-1]) != keys:  # pragma: no cover  (every method goes up to as many keys as are asked for)
        raise Mismatch(f"{method} found {len(found[-1])} keys in place of {keys}")
    return found[-1]


def _through(motion: Motion, method: str, pinned: np.ndarray, frames: np.ndarray, quality: str) -> Keys:
    """Curves through the poses at the frames (K,); quality fast is plain least squares."""
    if len(frames) == motion.frames:
        return at_every_frame(motion)
    stage = stage_of(motion)
    if method == "broken":
        return broken.keys_at(stage, frames)
    if quality == "fast":
        return keys_of(fitted(stage, pinned, frames, sweeps=0))
    return keys_of(centred(fitted(stage, pinned, frames)))
