"""follow: the way back restores the motion, by its history, or by the path that it is said to be on."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path as File
from typing import Any

import numpy as np
import pytest
from paths import bent, laid, off, walking

import mocurve as mc
from mocurve.edit.path_edit import PathEdit
from mocurve.path import Path

MODES = ["arclength", "time", "scaled", "span"]
FITS: dict[str, dict[str, Any]] = {
    "usual": {},
    "heights": {"height": True},
    "polynomial": {"kind": "polynomial", "degree": 12},
}


@pytest.mark.parametrize("mode", MODES)
def test_the_way_back_restores_the_motion(mode: str) -> None:
    clip = walking()
    path = Path.of(clip)
    there = laid(clip, bent(path, 8.0), mode=mode)
    assert off(there, clip) > 5
    assert off(laid(there, path, mode=mode), clip) < 1e-9


@pytest.mark.parametrize("heading_of", ["tangent", "facing"])
@pytest.mark.parametrize("fit", FITS)
def test_the_way_back_from_a_file_restores_the_motion_by_the_path_that_it_is_on(
    fit: str, heading_of: str, tmp_path: File
) -> None:
    clip = walking()
    path = Path.of(clip, **FITS[fit])
    on = bent(path, 8.0)
    there = laid(clip, on, lock_feet=False, heading=heading_of)
    mc.write(tmp_path / "there.bvh", there)  # which keeps no history
    found = mc.read(tmp_path / "there.bvh")
    for back in (path, Path(path.points, path.degree, path.kind)):
        made = mc.follow(found, back, of=on, lock_feet=False, heading=heading_of)
        assert off(made, clip) < 1e-4  # six decimals of degrees
        assert off(mc.follow(replace(there, history=()), back, of=on, lock_feet=False), clip) < 1e-6


def test_another_path_than_the_one_before_is_no_way_back() -> None:
    clip = walking()
    path = Path.of(clip)
    on = bent(path, 8.0)
    there = replace(laid(clip, on, lock_feet=False), history=())
    for other in (bent(path, 20.0), Path([(0, 0), (50, 400)])):
        made = mc.follow(there, other, of=on, lock_feet=False)
        assert made.values.tobytes() == PathEdit.of(there, on, lock_feet=False).laid(other).values.tobytes()


@pytest.mark.parametrize(("name", "skeleton"), [("cmu_09_12.amc", "cmu_09.asf"), ("cmu_16_41.amc", "cmu_16.asf")])
@pytest.mark.filterwarnings("ignore:.*frame rate")
def test_the_way_back_of_real_captures_needs_no_history(clips: File, name: str, skeleton: str) -> None:
    clip = mc.read(clips / "cmu" / name, skeleton=clips / "cmu" / skeleton)
    path = Path.of(clip)
    points = np.array(path.points)
    points[len(points) // 2] += (6.0, 3.0)
    on = replace(path, points=points)
    there = replace(mc.follow(clip, on, lock_feet=False), history=())
    assert off(mc.follow(there, path, of=on, lock_feet=False), clip) < 1e-6
