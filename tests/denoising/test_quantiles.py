"""Quantiles by one partition against NumPy's."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocurve.denoising._quantiles import median_of_windows, quantile


@given(st.integers(0, 2**32), st.integers(1, 40), st.sampled_from([0.0, 0.3, 0.5, 0.9, 0.98, 1.0]))
def test_a_quantile_is_numpy_s(seed: int, n: int, part: float) -> None:
    a = np.random.default_rng(seed).normal(size=(3, n)).round(1)
    np.testing.assert_allclose(quantile(a, part), np.quantile(a, part, axis=1), atol=1e-12)


@pytest.mark.parametrize("shape", [(1,), (5, 8), (2, 3, 9)])
def test_medians_leave_nan_out(shape: tuple[int, ...]) -> None:
    rng = np.random.default_rng(0)
    a = rng.normal(size=shape)
    a[..., 1:][rng.random(a[..., 1:].shape) < 0.4] = np.nan
    np.testing.assert_allclose(median_of_windows(a), np.nanmedian(a, axis=-1))
