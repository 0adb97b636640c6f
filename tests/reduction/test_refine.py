"""Refined keys: better, as many, and where they were pinned. That every promise still holds: test_verb."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import mocurve as mc
from mocurve import HermiteCurve, KeyedMotion, Mismatch, Motion, Skeleton


@pytest.fixture(scope="session")
def cut(jump: Path) -> Motion:
    """Sixty frames of a jump, from the ground into the air."""
    return mc.read(jump)[100:160]


def lines(frames: int = 50) -> Motion:
    """Two joints; a constant channel, one that rises evenly, one that swings."""
    skeleton = Skeleton(("A", "B"), [-1, 0], [[0, 0, 0], [0, 10, 0]], [("Xposition", "Zrotation", "Xrotation"), ()])
    at = np.arange(frames)
    return Motion(skeleton, np.stack([np.full(frames, 3.0), 0.5 * at, 30 * np.sin(0.2 * at)], axis=1), 0.02)


def key_frames(keys: KeyedMotion) -> list[int]:
    """Of every channel, the same."""
    frames = {tuple(np.rint(curve.times / keys.frame_time).astype(int)) for curve in keys.curves}
    assert len(frames) == 1
    return list(frames.pop())


def test_refining_coarse_keys_makes_them_better(cut: Motion) -> None:
    keys = mc.reduce(cut, method="split", tolerance="0.05ratio")
    better, whole = mc.refine(keys, cut), mc.unroll(cut, triples=False).values
    before, after = (np.mean((each.sample().values - whole) ** 2) for each in (keys, better))
    assert after < 0.9 * before


def test_refine_refuses_what_does_not_fit(cut: Motion) -> None:
    keys = mc.reduce(lines(), tolerance="1deg")
    with pytest.raises(Mismatch, match=r"are not the same motion: channels or frames differ$"):
        mc.refine(keys, cut)
    with pytest.raises(Mismatch, match=r"are not the same motion: channels or frames differ$"):
        mc.refine(keys, lines(49))
    shifted = HermiteCurve([0.0, 0.031, 0.98], [3.0, 3.0, 3.0], [0.0, 0.0, 0.0])
    with pytest.raises(Mismatch, match=r"the keys of 'A.Xposition' do not lie on frames"):
        mc.refine(replace(keys, curves=(shifted, *keys.curves[1:])), lines())
    short = HermiteCurve([0.0, 0.5], [3.0, 3.0], [0.0, 0.0])
    with pytest.raises(Mismatch, match=r"the keys of 'A.Xposition' do not reach from the first frame to the last"):
        mc.refine(replace(keys, curves=(short, *keys.curves[1:])), lines())


@pytest.mark.parametrize("method", ["salient", "broken"])
def test_refined_poses_leave_less_and_keep_their_pins(cut: Motion, method: str) -> None:
    keys = mc.reduce(cut, keys=9, method=method, pin=[17], quality="fast")
    better = mc.refine(keys, cut)
    assert len(key_frames(better)) == 9
    assert 17 in key_frames(better)
    assert better.report is not None
    assert keys.report is not None
    if method == "broken":
        assert better.report.max_error_world == pytest.approx(keys.report.max_error_world)
    else:
        assert better.report.max_error_world < 0.9 * keys.report.max_error_world


@pytest.mark.parametrize("tolerance", ["1%height", "3deg"])
def test_refined_keys_keep_their_pins(cut: Motion, tolerance: str) -> None:
    better = mc.refine(mc.reduce(cut, tolerance=tolerance, pin=[17, 44]), cut)
    for curve in better.curves:
        assert {17, 44} <= set(np.rint(curve.times / cut.frame_time).astype(int))
