"""Denoising and reducing in one step: the tolerance from the noise, held against the clean clip."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import mocurve as mc
from mocurve import KeyedMotion, Motion, OptionError


def apart(clip: Motion, samples: np.ndarray) -> np.ndarray:
    """(F, C) how far samples are from the clip's values; rotations up to whole turns."""
    off = samples - clip.values
    return np.abs(off - 360.0 * np.where(clip.skeleton.rotation_channels, np.rint(off / 360.0), 0.0))


@pytest.fixture(scope="session")
def noisy(jump: Path) -> Motion:
    """The jump with half a degree of white noise on every rotation, and a spike."""
    clip = mc.read(jump)[:240]
    values = np.array(clip.values)
    turning = clip.skeleton.rotation_channels & (np.ptp(values, axis=0) > 0)
    values[:, turning] += 0.5 * np.random.default_rng(5).standard_normal((clip.frames, int(turning.sum())))
    values[100, clip.skeleton.channel("LeftArm.Xrotation")] += 25.0
    return replace(clip, values=values)


@pytest.fixture(scope="session")
def freed(noisy: Motion) -> KeyedMotion:
    return mc.reduce(noisy, denoise=True)


def test_denoising_in_the_same_step_follows_the_clean_clip_within_a_part_of_the_noise(noisy, freed):
    clean = mc.denoise(noisy)
    assert clean.report.noise is not None
    sigma = {row.name: row.sigma for row in clean.report.noise.channels}
    off = apart(clean, freed.sample().values)
    for channel, name in enumerate(noisy.skeleton.channel_names):
        if noisy.skeleton.rotation_channels[channel]:
            assert off[:, channel].max() <= 0.3 * max(sigma.get(name, 0.5), 0.05) * (1 + 1e-9)


def test_denoising_in_the_same_step_needs_fewer_keys_and_is_told(noisy, freed):
    assert freed.keys < mc.reduce(noisy, tolerance="0.15deg").keys / 3
    assert freed.report.tolerance == "0.3sigma"
    assert freed.history[:-1] == noisy.history
    assert (freed.history[-1]["verb"], freed.history[-1]["denoise"]) == ("reduce", True)
    spikes = [(row.first, row.last) for row in freed.report.noise.artefacts if row.joint == "LeftArm"]
    assert (100, 100) in spikes


def test_another_tolerance_is_held_against_the_clean_clip(noisy):
    clean = mc.denoise(noisy)
    keys = mc.reduce(noisy, denoise=True, tolerance="2deg", method="split")
    assert apart(clean, keys.sample().values)[:, 3:].max() <= 2.0 + 1e-9


def test_a_part_of_the_noise_is_refused_where_nobody_measured_it(noisy):
    with pytest.raises(OptionError, match="which nobody measured: reduce with denoise"):
        mc.reduce(noisy, tolerance="0.3sigma")
    assert mc.reduce(mc.denoise(noisy), tolerance="3sigma", method="split").report.tolerance == "3sigma"
