"""trim: a piece of a clip, exactly as it was, whatever kind of clip."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from chains import keys
from hypothesis import given
from hypothesis import strategies as st
from turning import ALONG, spline, turning

import mocurve as mc
from mocurve import HermiteCurve, Mismatch, OptionError


def clips() -> list[mc.Clip]:
    body = turning(90 * ALONG, 12.0).skeleton
    return [turning(90 * ALONG, 12.0), keys(), *(spline(body, 30, degree, 1) for degree in (1, 3, 5))]


def test_the_whole_clip_is_the_clip() -> None:
    for clip in clips():
        assert mc.trim(clip) is clip
        assert mc.trim(clip, start=0, end=clip.duration) is clip


@given(st.floats(0, 1), st.floats(0, 1))
def test_a_piece_is_what_it_was(one: float, other: float) -> None:
    for clip in clips():
        first, last = sorted(round(share * (clip.frames - 1)) for share in (one, other))
        if first == last:
            last += 1 if last < clip.frames - 1 else 0
            first -= 1 if first == last else 0
        made = mc.trim(clip, start=first * clip.frame_time, end=last * clip.frame_time)
        assert type(made) is type(clip)
        assert made.frames == last - first + 1
        finer = clip.frame_time / 4 if not isinstance(clip, mc.Motion) else clip.frame_time
        piece = clip.sample(finer).values[round(first * clip.frame_time / finer) :][: made.sample(finer).frames]
        np.testing.assert_allclose(made.sample(finer).values, piece, atol=1e-10)


def test_samples_stay_to_the_last_digit(jump: Path) -> None:
    motion = mc.read(jump)
    made = mc.trim(motion, start=1.0, end=2.0)
    assert made.values.tobytes() == motion.values[120:241].tobytes("F") or np.array_equal(
        made.values, motion.values[120:241]
    )
    assert made.history[-1] == {"verb": "trim", "start": 1.0, "end": 2.0}
    assert motion[120:241].history == made.history


def test_a_broken_tangent_and_a_curve_that_begins_late_are_divided_exactly() -> None:
    body = turning(90 * ALONG, 12.0).skeleton
    times = np.array([0.3, 0.6, 0.9])
    curve = HermiteCurve(times, np.array([1.0, -2.0, 4.0]), np.array([5.0, 1.0, 2.0]), np.array([3.0, -9.0, 7.0]))
    clip = mc.KeyedMotion(body, (curve,) * body.channel_count, 0.01, 101)
    for start, end in [(0.1, 0.95), (0.45, 0.75), (0.6, 1.0), (0.0, 0.2), (0.3, 0.6)]:
        made = mc.trim(clip, start=start, end=end)
        at = np.linspace(start, end, 97)
        np.testing.assert_allclose(made.curves[0].at(at - start), curve.at(at), atol=1e-12)


def test_one_moment_is_a_pose() -> None:
    for clip in clips():
        if isinstance(clip, mc.SplineMotion):
            with pytest.warns(UserWarning, match="splines become samples: one moment is no curve"):
                made = mc.trim(clip, start=0.1, end=0.1)
        else:
            made = mc.trim(clip, start=0.1, end=0.1)
        assert made.frames == 1
        np.testing.assert_allclose(
            made.sample().values[0], clip.sample().values[round(0.1 / clip.frame_time)], atol=1e-12
        )


def test_a_report_of_the_whole_is_not_told_of_a_piece(jump: Path) -> None:
    made = mc.trim(mc.reduce(mc.read(jump)[:60], tolerance="3deg", quality="fast"), end=0.3)
    assert made.report is None


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"start": 3.0}, "the start at 3 s lies outside of the clip, which goes from 0 to"),
        ({"end": -1.0}, "the end at -1 s lies outside"),
        ({"start": 1.0, "end": 0.5}, "ends at 0.5 s, before its start at 1 s"),
        ({"start": float("nan")}, "start is a number of seconds, not nan"),
        ({"end": "late"}, "end is a number of seconds, not 'late'"),
    ],
)
def test_what_cannot_be_is_refused(options: dict, message: str) -> None:
    with pytest.raises(OptionError, match=message):
        mc.trim(turning(90 * ALONG, 12.0), **options)


def test_a_clip_without_frames_is_refused() -> None:
    motion = turning(90 * ALONG, 12.0)
    with pytest.raises(Mismatch, match="without frames has no piece"):
        mc.trim(replace(motion, values=motion.values[:0]))
