"""The frames of a glTF animation: the format has none, its key times tell which rate was meant."""

from __future__ import annotations

import numpy as np

from ._frame_time import USUAL
from ._gltf_read_tracks import Frames

_HIGHEST = 1000  # frames a second
_TRIED = 200  # key times that a rate is tried on first
_OFF = 3e-4  # relative: how far a program's own rounding of the frame time may be from the rate that it means


def guessed(times: list[np.ndarray], odd: list[str]) -> tuple[Frames, float]:
    """Frames from the first key to the last, and the frame time that is meant: the lowest usual rate (else whole one)
    that has a frame at every key. The frames lie at the keys also where these are a bit off that rate.

    Where no rate has, 30 or 60 frames a second, and `odd` gets the sentence.
    """
    keys = np.unique(np.concatenate(times))
    first, duration = float(keys[0]), float(keys[-1] - keys[0])
    found = _steps(keys) if len(keys) > 1 else (1 / 30, 1 / 30)
    if found is None:
        rate = 60 if np.median(np.diff(keys)) < 0.03 else 30
        odd.append(f"its keys fit no frame rate: read at {rate} frames a second")
        step = meant = 1 / rate
        total = int(duration / step + 1e-6) + 1  # who reads holds it against the size of the file
    else:
        step, meant = found
        total = round(duration / step) + 1
    if first > 1.5 * step:
        odd.append(f"the first key is at second {first:.6g}: frame 0 is there")
    return Frames(step, total, first), meant


def _steps(keys: np.ndarray) -> tuple[float, float] | None:
    """Seconds a frame of the keys (sorted), as they are and as they are meant; None where they fit no rate."""
    since = keys - keys[0]
    slack = 1e-6 + 4.0 * 2.0**-24 * float(np.abs(keys).max())  # seconds: times are float32
    lowest = min(rate for _, rate in USUAL)
    for k, rate in [*USUAL, *((1, whole) for whole in range(lowest, _HIGHEST + 1))]:
        if slack * rate / k > 0.1:  # of a frame: every time would do
            continue
        if _fitted(since[:_TRIED], k / rate, slack):
            step = _fitted(since, k / rate, slack)
            return None if step is None else (step, k / rate)
    return None


def _fitted(since: np.ndarray, step: float, slack: float) -> float | None:
    """The step, or the one near it that all the times are whole numbers of."""
    if (np.abs(since - step * np.rint(since / step)) <= slack).all():
        return step
    near, count = step, 2
    while count < 2 * len(since):  # twice as many each time, so that none is counted a frame too much
        some = since[:count]
        whole = np.rint(some / near)
        if not whole.any():
            return None
        near = float(whole @ some / (whole @ whole))
        count *= 2
    fits = np.abs(since - near * np.rint(since / near)).max() <= slack and abs(near / step - 1.0) <= _OFF
    return near if fits else None
