"""What sensors and solvers do to a channel besides jitter: each kind puts artefacts into (F, C) and tells where.

A kind is a function of a generator, the values (F, C) and the columns of each joint, and returns the values with
artefacts and the mask (F, C) of what was changed. Artefacts come upon a joint; how many of its channels suffer is
drawn. Sizes are in degrees.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

Groups = list[np.ndarray]
Kind = Callable[[np.random.Generator, np.ndarray, Groups], tuple[np.ndarray, np.ndarray]]
EDGE = 4  # frames at both ends that only the kind `edge` touches


def correlated(rng: np.random.Generator, white: np.ndarray) -> np.ndarray:
    """The noise of depth cameras: first-order autoregression of 0.6 to 0.9 by channel, same variance as `white`."""
    rho = rng.uniform(0.6, 0.9, white.shape[1])
    noise = white.copy()
    for frame in range(1, len(white)):
        noise[frame] = rho * noise[frame - 1] + np.sqrt(1 - rho**2) * white[frame]
    return noise


def some(rng: np.random.Generator, joint: np.ndarray) -> np.ndarray:
    """Channels of a joint: each with probability 0.6, at least one."""
    chosen = rng.random(len(joint)) < 0.6
    chosen[rng.integers(len(joint))] = True
    return joint[chosen]


def signed(rng: np.random.Generator, size: tuple[float, float], count: int) -> np.ndarray:
    return rng.uniform(*size, count) * rng.choice([-1.0, 1.0], count)


def places(
    rng: np.random.Generator, frames: int, groups: Groups, lengths: tuple[int, int], share: float, least: int
) -> Iterator[tuple[np.ndarray, int, int]]:
    """(joint, first, end) of runs that start on `share` of a joint's frames, at least `least` in the clip."""
    counts = rng.binomial(frames, share, len(groups))
    while counts.sum() < least:
        counts[rng.integers(len(groups))] += 1
    for joint, count in zip(groups, counts, strict=True):
        taken = np.zeros(frames + 1, bool)
        for _ in range(count):
            length = int(rng.integers(lengths[0], lengths[1] + 1))
            if frames - length - 2 * EDGE < 1:
                continue
            first = int(rng.integers(EDGE, frames - length - EDGE + 1))
            if not taken[first - 1 : first + length + 1].any():
                taken[first : first + length] = True
                yield joint, first, first + length


def spikes(lengths: tuple[int, int], size: tuple[float, float], share: float) -> Kind:
    """Each frame of a run is off by its own amount; in half of the runs all to the same side."""

    def put(rng: np.random.Generator, values: np.ndarray, groups: Groups) -> tuple[np.ndarray, np.ndarray]:
        noisy, bad = values.copy(), np.zeros(values.shape, bool)
        for joint, first, end in places(rng, len(values), groups, lengths, share, 2):
            one_side = rng.random() < 0.5
            for channel in some(rng, joint):
                off = signed(rng, size, end - first)
                noisy[first:end, channel] += np.abs(off) * np.sign(off[0]) if one_side else off
                bad[first:end, channel] = True
        return noisy, bad

    return put


def bursts(forms: tuple[str, ...]) -> Kind:
    """Runs of 3 to 10 frames of one of the forms: *offset*, off by a constant; *curve*, another curve; both in some
    channels of the joint; *frozen*, the joint stands still."""

    def put(rng: np.random.Generator, values: np.ndarray, groups: Groups) -> tuple[np.ndarray, np.ndarray]:
        noisy, bad = values.copy(), np.zeros(values.shape, bool)
        for joint, first, end in places(rng, len(values), groups, (3, 10), 0.005, 2):
            form = forms[rng.integers(len(forms))]
            if form == "frozen":
                noisy[first:end, joint], bad[first:end, joint] = noisy[first - 1, joint], True
                continue
            for channel in some(rng, joint):
                off = signed(rng, (12, 40), 1)[0]
                wave = 8 * np.sin(np.arange(end - first) * rng.uniform(0.3, 1.0)) if form == "curve" else 0.0
                noisy[first:end, channel] += off + wave
                bad[first:end, channel] = True
        return noisy, bad

    return put


def flips(rng: np.random.Generator, values: np.ndarray, groups: Groups) -> tuple[np.ndarray, np.ndarray]:
    """180 degrees added or taken away for 1 to 6 frames in one channel."""
    noisy, bad = values.copy(), np.zeros(values.shape, bool)
    for joint, first, end in places(rng, len(values), groups, (1, 6), 0.005, 2):
        channel = rng.choice(joint)
        noisy[first:end, channel] += rng.choice([-180.0, 180.0])
        bad[first:end, channel] = True
    return noisy, bad


def dropouts(rng: np.random.Generator, values: np.ndarray, groups: Groups) -> tuple[np.ndarray, np.ndarray]:
    """A joint is frozen, or zero, for 3 to 10 frames."""
    noisy, bad = values.copy(), np.zeros(values.shape, bool)
    for joint, first, end in places(rng, len(values), groups, (3, 10), 0.005, 2):
        noisy[first:end, joint] = noisy[first - 1, joint] if rng.random() < 0.5 else 0.0
        bad[first:end, joint] = True
    return noisy, bad


def lasting(rng: np.random.Generator, values: np.ndarray, groups: Groups) -> tuple[np.ndarray, np.ndarray]:
    """One joint is off by 15 to 60 degrees for over 30 frames in the middle, or for up to a third of the clip at an
    end, as where markers are swapped."""
    noisy, bad = values.copy(), np.zeros(values.shape, bool)
    frames = len(values)
    joint = groups[rng.integers(len(groups))]
    length = int(rng.integers(min(31, frames // 4), max(32, frames // 3)))
    first = int(rng.choice([0, frames - length, rng.integers(8, max(9, frames - length - 8))]))
    for channel in some(rng, joint):
        noisy[first : first + length, channel] += signed(rng, (15, 60), 1)[0]
        bad[first : first + length, channel] = True
    return noisy, bad


def tpose(rng: np.random.Generator, values: np.ndarray, groups: Groups) -> tuple[np.ndarray, np.ndarray]:
    """The first frame, or the first two, are zero in all joints."""
    noisy, bad = values.copy(), np.zeros(values.shape, bool)
    count = int(rng.integers(1, 3))
    noisy[:count], bad[:count] = 0.0, True
    return noisy, bad


def edge(rng: np.random.Generator, values: np.ndarray, groups: Groups) -> tuple[np.ndarray, np.ndarray]:
    """Spikes of 1 or 2 frames among the first and the last four frames of every joint."""
    noisy, bad = values.copy(), np.zeros(values.shape, bool)
    for joint in groups:
        for last in (False, True):
            length = int(rng.integers(1, 3))
            first = int(rng.integers(0, EDGE - length + 1)) + (len(values) - EDGE if last else 0)
            for channel in some(rng, joint):
                noisy[first : first + length, channel] += signed(rng, (12, 28), length)
                bad[first : first + length, channel] = True
    return noisy, bad


def ramps(rng: np.random.Generator, values: np.ndarray, groups: Groups) -> tuple[np.ndarray, np.ndarray]:
    """A limb lost by the sensor: 100 to 170 degrees away within 3 to 6 frames, some frames there, and back."""
    noisy, bad = values.copy(), np.zeros(values.shape, bool)
    for joint, first, end in places(rng, len(values), groups, (6, 18), 0.0025, 1):
        up, down = (min(int(rng.integers(3, 7)), (end - first) // 2) for _ in range(2))
        rise = np.minimum(np.arange(1, end - first + 1) / up, np.arange(end - first, 0, -1) / down)
        for channel in some(rng, joint):
            noisy[first:end, channel] += signed(rng, (100, 170), 1)[0] * np.minimum(rise, 1.0)
            bad[first:end, channel] = True
    return noisy, bad


def gaps(rng: np.random.Generator, values: np.ndarray, groups: Groups) -> tuple[np.ndarray, np.ndarray]:
    """A joint is missing (NaN) for 3 to 20 frames."""
    noisy, bad = values.copy(), np.zeros(values.shape, bool)
    for joint, first, end in places(rng, len(values), groups, (3, 20), 0.005, 2):
        noisy[first:end, joint] = np.nan
        bad[first:end, joint] = True
    return noisy, bad


KINDS: dict[str, Kind] = {
    "spikes": spikes((1, 1), (12, 28), 0.01),
    "spikes 1-3": spikes((1, 3), (8, 30), 0.01),
    "bursts": bursts(("offset", "curve", "frozen")),
    "leaps": bursts(("offset", "curve")),  # bursts without frozen ones
    "flips": flips,
    "dropouts": dropouts,
    "lasting": lasting,
    "tpose": tpose,
    "edge": edge,
    "ramps": ramps,
    "gaps": gaps,
}
