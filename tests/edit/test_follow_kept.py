"""follow with heading kept: residuals are absolute, the body is shifted to the new path and not turned."""

from __future__ import annotations

import numpy as np
import pytest
from paths import FITS, MOVED, bent, laid, measured, off, table, walking
from turning import heading

import mocurve as mc
from mocurve.kinematics import world
from mocurve.path import Path
from mocurve.path_fit import gone

MODES = ["arclength", "time", "scaled", "span"]
CASES = [(fit, mode) for fit in FITS for mode in MODES if (fit, mode) != ("polynomial", "span")]


@pytest.mark.parametrize(("fit", "mode"), CASES)
def test_a_heading_that_is_kept_keeps_the_laws(fit: str, mode: str) -> None:
    clip = walking()
    path = Path.of(clip, **FITS[fit])
    assert laid(clip, path, mode=mode, heading="kept").values.tobytes() == clip.values.tobytes()
    shifted = path.moved(MOVED * (0, 1, 1))
    kept, turned = (laid(clip, shifted, mode=mode, heading=heading) for heading in ("kept", "tangent"))
    np.testing.assert_allclose(world(kept), world(clip) + np.insert(MOVED[1:], 1, 0.0), atol=1e-9)
    assert off(kept, turned) < 1e-9
    there = laid(clip, bent(path, 8.0), mode=mode, heading="kept")
    assert off(there, clip) > 2
    assert off(laid(there, path, mode=mode, heading="kept"), clip) < 1e-9


def test_residuals_of_a_heading_that_is_kept_stay_in_the_axes_of_the_world() -> None:
    clip = walking()
    own, new = Path.of(clip), mc.Path([(0, 0), (300, 100), (300, 400), (0, 500)])
    made = laid(clip, new, heading="kept")
    before = clip.values[:, [0, 2]] - own.place(gone(clip))
    np.testing.assert_allclose(made.values[:, [0, 2]] - new.at(table(made)["distance"])[0], before, atol=1e-9)
    rest = np.delete(np.arange(clip.values.shape[1]), [0, 2])
    assert made.values[:, rest].tobytes() == clip.values[:, rest].tobytes()
    assert measured(made)["turned"] == 0


def test_cycles_keep_their_heading_too_and_ends_are_as_else() -> None:
    clip, path = walking(4, 0.0), mc.Path([(0, 0), (900, 100), (900, 900)])
    made = laid(clip, path, at_end="cycle", heading="kept")
    assert measured(made)["cycles"] > 5
    assert np.abs(heading(made) - heading(clip)[0]).max() < 30  # as the clip sways
    stopped = [table(laid(clip, mc.Path([(0, 0), (200, 0)]), at_end="stop", heading=h)) for h in ("kept", "tangent")]
    np.testing.assert_array_equal(stopped[0]["distance"], stopped[1]["distance"])
