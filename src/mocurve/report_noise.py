"""What the report's page shows of noise: the captured curves, the frames that were no motion, and spectra."""

from __future__ import annotations

from typing import Any

import numpy as np

from .measure import side_by_side
from .measure_noise import KINDS, Noise
from .motion import Motion
from .report_curves import bridged, packed, thinned

SPAN = 2.0  # seconds of a piece that a spectrum is averaged from: resolves half a Hz
LEAST, MOST = 16, 512  # frames of such a piece


def noise_data(noise: Noise, cleaned: Motion, shown: Motion, stride: int) -> dict[str, Any]:
    """What was found, ready for JSON. shown: the clip that the page ends with, the cleaned one or the keys' samples."""
    place = {name: channel for channel, name in enumerate(cleaned.skeleton.channel_names)}
    rows: list[dict[str, Any] | None] = [None] * len(place)
    for row in noise.channels:
        if row.name in place:
            rows[place[row.name]] = {"sigma": row.sigma, "floor": row.floor, "cutoff": row.cutoff}
    artefacts = [
        {
            "joint": row.joint,
            "channels": [place[name] for name in row.channels if name in place],
            "kind": row.kind,
            "first": row.first,
            "last": row.last,
            "by": row.by,
        }
        for row in noise.artefacts
    ]
    before = _captured(noise, cleaned)
    return {
        "lines": noise.lines(),
        "captured": None if before is None else _curves(noise, before, cleaned, stride),
        "channels": rows,
        "artefacts": artefacts,
        "kinds": KINDS,
        "samples": noise.samples,
        "marked": noise.marked,
        "spectra": None if before is None else _spectra(bridged(before), shown),
    }


# -- in call order -----------------------------------------------------------------------------------------------------


def _captured(noise: Noise, cleaned: Motion) -> Motion | None:
    """The clip before, written like the cleaned one; None where it is not known, or has other channels or frames."""
    before = noise.captured
    if (
        before is None
        or before.skeleton.channel_names != cleaned.skeleton.channel_names
        or (before.frames, before.frame_time) != (cleaned.frames, cleaned.frame_time)
    ):
        return None
    return side_by_side(before, cleaned)[0]


def _curves(noise: Noise, before: Motion, cleaned: Motion, stride: int) -> str:
    """The captured curves (C, K), NaN where samples were lost."""
    values = np.array(before.values)
    place = {name: channel for channel, name in enumerate(cleaned.skeleton.channel_names)}
    for row in noise.artefacts:
        if row.kind == "lost":
            values[row.first : row.last + 1, [place[name] for name in row.channels if name in place]] = np.nan
    return packed(thinned(cleaned.values, values, stride)[1].T)


def _spectra(before: Motion, after: Motion) -> dict[str, Any] | None:
    """Amplitude densities (C, N), channel unit per root of Hz, at N frequencies: Welch 1967, averaged over pieces."""
    from scipy.signal import welch  # half a second to load

    fps = 1 / before.frame_time
    piece = min(before.frames, int(np.clip(round(SPAN * fps), 4 * LEAST, MOST)))
    if piece < LEAST:
        return None
    densities = [welch(motion.values, fps, nperseg=piece, detrend="linear", axis=0) for motion in (before, after)]
    hertz = densities[0][0]
    first, second = (packed(np.sqrt(density[1:].T)) for _, density in densities)
    return {"hertz": packed(hertz[1:]), "before": first, "after": second}
