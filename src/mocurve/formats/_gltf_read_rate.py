"""The frames of a glTF animation: the format has none, its key times tell which rate was meant."""

from __future__ import annotations

import numpy as np

from ..motion import frame_count
from ._frame_time import USUAL
from ._gltf_read_tracks import Frames

_HIGHEST = 1000  # frames a second
_SAMPLE = 1000  # key times that each rate is tried on


def guessed(times: list[np.ndarray], odd: list[str]) -> Frames:
    """Frames from the first key to the last, at the lowest usual rate (else whole one) that has a frame at every key.

    Where no rate has, 30 or 60 frames a second, and `odd` gets the sentence.
    """
    keys = np.unique(np.concatenate(times))
    first, duration = float(keys[0]), float(keys[-1] - keys[0])
    frame_time = _step(keys) if len(keys) > 1 else 1 / 30
    if frame_time is None:
        rate = 60 if np.median(np.diff(keys)) < 0.03 else 30
        odd.append(f"its keys fit no frame rate: read at {rate} frames a second")
        frame_time = 1 / rate
        count = frame_count(duration, frame_time)
    else:
        count = round(duration / frame_time) + 1
    if first > 1.5 * frame_time:
        odd.append(f"the first key is at second {first:.6g}: frame 0 is there")
    return Frames(frame_time, count, first)


def _step(keys: np.ndarray) -> float | None:
    """Seconds a frame of the rate that all keys (sorted) fit, None where there is none."""
    since = keys - keys[0]
    slack = 1e-6 + 4.0 * 2.0**-24 * float(np.abs(keys).max())  # seconds: times are float32
    some = since[np.linspace(0, len(since) - 1, min(len(since), _SAMPLE)).astype(int)]
    lowest = min(rate for _, rate in USUAL)
    for k, rate in [*USUAL, *((1, whole) for whole in range(lowest, _HIGHEST + 1))]:
        if slack * rate / k > 0.1:  # of a frame: every time would do
            continue
        if _fit(some, k / rate, slack):
            return k / rate if _fit(since, k / rate, slack) else None
    return None


def _fit(since: np.ndarray, frame_time: float, slack: float) -> bool:
    return bool((np.abs(since - frame_time * np.rint(since / frame_time)) <= slack).all())
