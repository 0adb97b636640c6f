"""Noise out, motion kept: a capture is made worse on purpose, cleaned, and compared with what it was.

python examples/05_clean.py [CLIP]
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

import mocurve as mc
from mocurve.data import example

clip = Path(sys.argv[1]) if len(sys.argv) > 1 else example()
truth = mc.unroll(mc.read(clip))
turning = np.flatnonzero(truth.skeleton.rotation_channels & (np.ptp(truth.values, axis=0) > 1))
rng = np.random.default_rng(1)

# What a capture suffers from: half a degree of jitter, spikes on 1 % of the samples, a joint that is lost for a while.
values = np.array(truth.values)
values[:, turning] += rng.normal(0, 0.5, (truth.frames, len(turning)))
spikes = np.zeros(values.shape, bool)
spikes[:, turning] = rng.random((truth.frames, len(turning))) < 0.01
values[spikes] += rng.choice([-1, 1], spikes.sum()) * rng.uniform(12, 28, spikes.sum())
lost = truth.skeleton.channel_joints == truth.skeleton.channel_joints[turning[-1]]
values[truth.frames // 2 : truth.frames // 2 + 12, lost] = np.nan
noisy = replace(truth, values=values)

clean = mc.denoise(noisy)  # nothing to set
noise = clean.report.noise
print("\n".join(noise.lines()))


def error(motion: mc.Motion) -> float:
    """Degrees that the middle one of the channels is away from the truth, RMS."""
    return float(np.median(np.sqrt(np.nanmean((motion.values - truth.values)[:, turning] ** 2, axis=0))))


found = np.zeros(values.shape, bool)
for row in noise.artefacts:
    found[row.first : row.last + 1, [truth.skeleton.channel(name) for name in row.channels]] = True
print(f"{error(noisy):.2f} degrees off before, {error(clean):.2f} after")
print(f"{(found & spikes).sum()} of {spikes.sum()} spikes were found")

clean.report.save("clean.html")  # captured and clean curves, spectra, and every artefact to click
