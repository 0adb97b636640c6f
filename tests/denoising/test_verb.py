"""The verb: what comes back, what stays, what is told, what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gestures import PLACES, TURNS, jitter, legged, rmse, walk

import mocurve as mc
from mocurve import rotation
from mocurve.denoising.cleaning import SHORTEST
from mocurve.measure_noise import Artefact, Noise

SIGMA, FRAMES, FPS = 0.3, 400, 120.0


@pytest.fixture(scope="module")
def truth() -> mc.Motion:
    return walk(FRAMES, FPS)


@pytest.fixture(scope="module")
def noisy(truth: mc.Motion) -> mc.Motion:
    return replace(truth, values=jitter(truth.values, SIGMA))


def changed(motion: mc.Motion, **cells: float) -> mc.Motion:
    """Other values: column=((first, last), by) adds, NaN and all."""
    values = np.array(motion.values)
    for column, ((first, last), by) in cells.items():
        values[first:last, motion.skeleton.channel_names.index(column.replace("_", "."))] += by
    return replace(motion, values=values)


def told(clip: mc.Motion) -> list[tuple]:
    return [(row.kind, row.channels, row.first, row.last) for row in clip.report.noise.artefacts]


# -- what comes back ---------------------------------------------------------------------------------------------------


def test_noise_of_all_channels_goes(truth: mc.Motion, noisy: mc.Motion) -> None:
    clean = mc.denoise(noisy)
    errors = np.sqrt(((clean.values - truth.values) ** 2).mean(0))
    assert errors.max() < 0.5 * SIGMA
    assert clean.skeleton is noisy.skeleton
    assert clean.frame_time == noisy.frame_time
    assert clean.values.shape == noisy.values.shape


def test_the_shipped_clip_comes_nearer_to_itself_before_noise(jump: Path) -> None:
    """Where it is a motion: toes and fingers of this capture leap by more than any body does."""
    clip = mc.unroll(mc.read(jump))
    live = (np.ptp(clip.values, axis=0) > 0) & (np.abs(np.diff(clip.values, 2, axis=0)).max(0) < 7.0)
    assert live.sum() > 50
    clean = mc.denoise(replace(clip, values=jitter(clip.values, 0.5)))
    assert rmse(clean.values[:, live], clip.values[:, live]) < 0.6 * 0.5
    assert np.median([row.sigma for row in clean.report.noise.channels]) == pytest.approx(0.5, rel=0.1)


def test_the_same_comes_out_twice_and_the_clip_stays(noisy: mc.Motion) -> None:
    before = noisy.values.copy()
    one, other = mc.denoise(noisy), mc.denoise(noisy)
    np.testing.assert_array_equal(one.values, other.values)
    assert one.report.noise == other.report.noise
    np.testing.assert_array_equal(noisy.values, before)


def test_the_order_of_joints_does_not_matter() -> None:
    def two(names: tuple[str, str]) -> mc.Motion:
        clip = mc.Motion(
            mc.Skeleton(("Hips", *names), [-1, 0, 0], np.eye(3) * 30, ((), TURNS, TURNS)),
            np.zeros((FRAMES, 6)),
            1 / FPS,
        )
        values = {name: jitter(walk(FRAMES, FPS, seed).values[:, 3:6], SIGMA, seed) for seed, name in enumerate("AB")}
        return replace(clip, values=np.hstack([values[name] for name in names]))

    one, other = mc.denoise(two(("A", "B"))), mc.denoise(two(("B", "A")))
    np.testing.assert_allclose(other.values[:, [3, 4, 5, 0, 1, 2]], one.values, atol=1e-9)


def test_keys_are_sampled(truth: mc.Motion) -> None:
    keys = mc.reduce(truth, tolerance="0.5deg")
    clean = mc.denoise(keys)
    assert isinstance(clean, mc.Motion)
    assert [step["verb"] for step in clean.history] == ["reduce", "denoise"]


# -- what stays --------------------------------------------------------------------------------------------------------


def test_channels_that_never_change_come_back_identical(noisy: mc.Motion) -> None:
    values = np.array(noisy.values)
    values[:, [1, 5, 7]] = [0.1 + 0.2, 7.25, 0.0]
    clean = mc.denoise(replace(noisy, values=values))
    np.testing.assert_array_equal(clean.values[:, [1, 5, 7]], values[:, [1, 5, 7]])
    assert len(clean.report.noise.channels) == 9


@pytest.mark.parametrize(
    ("only", "columns"),
    [("Knee", [6, 7, 8]), ("Hips.Yposition", [1]), (["*Foot", "Hips.X*"], [0, 4, 9, 10, 11]), ([], range(12))],
)
def test_channels_that_were_not_chosen_come_back_identical(noisy: mc.Motion, only, columns) -> None:
    broken = changed(noisy, Foot_Xrotation=((30, 31), 25.0), Hips_Zposition=((50, 60), np.nan))
    clean = mc.denoise(broken, only=only)
    same = [np.array_equal(a, b, equal_nan=True) for a, b in zip(clean.values.T, broken.values.T, strict=True)]
    assert np.flatnonzero(~np.array(same)).tolist() == list(columns)


@pytest.mark.parametrize("frames", [0, 1, 2, 3, SHORTEST - 1])
def test_clips_too_short_to_tell_noise_from_motion_stay(frames: int) -> None:
    clip = replace(walk(frames, FPS), values=jitter(walk(frames, FPS).values, SIGMA))
    clean = mc.denoise(clip)
    np.testing.assert_array_equal(clean.values, clip.values)
    assert clean.report.noise.channels == ()
    assert "no channel moves and has the samples that would tell" in str(clean.report.noise)


@pytest.mark.parametrize("frames", [SHORTEST, 10, 12])
def test_clips_of_few_frames_are_smoothed(frames: int) -> None:
    clip = replace(walk(frames, FPS), values=jitter(walk(frames, FPS).values, SIGMA))
    clean = mc.denoise(clip)
    assert 0 < rmse(clean.values, clip.values) < 2 * SIGMA


def test_a_clip_without_channels_stays() -> None:
    clean = mc.denoise(mc.Motion(mc.Skeleton(("A",), [-1], np.zeros((1, 3)), ((),)), np.zeros((20, 0)), 1 / FPS))
    assert clean.values.shape == (20, 0)


def test_whole_turns_and_twin_triples_are_no_artefacts(noisy: mc.Motion) -> None:
    rng, values = np.random.default_rng(3), np.array(noisy.values)
    values[1:, 3:] += 360.0 * rng.integers(-1, 2, (FRAMES - 1, 9))
    twins = np.flatnonzero(rng.random(FRAMES) < 0.3)[1:]
    values[twins, 6:9] = values[twins, 6:9] * [1, -1, 1] + 180.0  # the same rotation in ZXY
    clean, plain = mc.denoise(replace(noisy, values=values)), mc.denoise(noisy)
    assert not told(clean)
    np.testing.assert_allclose(clean.values, plain.values, atol=1e-6)


@pytest.mark.parametrize("sigma", [0.0, 0.05, 0.3])
def test_gimbal_lock_is_no_artefact(truth: mc.Motion, sigma: float) -> None:
    """The knee turns smoothly through X = 90 degrees, where Z and Y leap by 60 degrees a frame and nothing does."""
    t = np.arange(FRAMES) / FPS
    parts = 90 + 40 * np.sin(5 * t), 2 * np.sin(3 * t), 2 * np.cos(4.4 * t)
    q = rotation.exp(np.radians(np.stack(parts, 1)))
    shaken = rotation.mul(q, rotation.exp(np.radians(jitter(np.zeros((FRAMES, 3)), sigma))))
    values = np.array(truth.values)
    values[:, 6:9] = rotation.unroll_euler(rotation.to_euler(shaken, "ZXY"), "ZXY")
    assert np.abs(np.diff(values[:, 6:9], axis=0)).max() > 30
    clean = mc.denoise(replace(truth, values=values))
    assert not told(clean)
    assert rotation.angle(rotation.from_euler(clean.values[:, 6:9], "ZXY"), q).max() < 0.5 + 12 * sigma


# -- artefacts ---------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def broken(noisy: mc.Motion) -> mc.Motion:
    """One artefact of each kind."""
    values = np.array(
        changed(
            noisy,
            Hips_Xrotation=((100, 101), 30.0),
            Knee_Zrotation=((150, 156), -25.0),
            Knee_Xrotation=((200, 204), np.nan),
            Hips_Xposition=((60, 61), 30.0),
            Foot_Zrotation=((250, 340), 30.0),
        ).values
    )
    values[220:227, 6:9] = values[219, 6:9]
    return replace(noisy, values=values)


KINDS = [
    ("spike", ("Hips.Xposition",), 60, 60),
    ("spike", ("Hips.Xrotation",), 100, 100),
    ("run", ("Knee.Zrotation",), 150, 155),
    ("lost", ("Knee.Xrotation",), 200, 203),
    ("frozen", ("Knee.Zrotation", "Knee.Xrotation", "Knee.Yrotation"), 220, 226),
    ("offset", ("Foot.Zrotation",), 250, 339),
]


def test_every_artefact_is_told_with_its_kind_and_frames(truth: mc.Motion, broken: mc.Motion) -> None:
    clean = mc.denoise(broken)
    assert told(clean) == KINDS
    noise = clean.report.noise
    assert noise.samples == 1 + 1 + 6 + 4 + 3 * 7
    assert noise.artefacts[-1].by == pytest.approx(30.0, abs=1.0)
    assert [row.by for row in noise.artefacts[:-1]] == [None] * 5
    assert rmse(clean.values, truth.values) < 0.6 * SIGMA
    assert np.abs(clean.values - truth.values).max() < 2.0


def test_mark_tells_artefacts_and_keeps_them(truth: mc.Motion, broken: mc.Motion) -> None:
    clean, marked = mc.denoise(broken), mc.denoise(broken, mark=True)
    assert told(marked) == KINDS
    assert (marked.report.noise.marked, clean.report.noise.marked) == (True, False)
    for _, channels, first, last in (KINDS[0], KINDS[1], KINDS[2], KINDS[4]):
        columns = [broken.skeleton.channel_names.index(name) for name in channels]
        frames = slice(first, last + 1)
        np.testing.assert_array_equal(marked.values[frames, columns], broken.values[frames, columns])
    assert np.abs(marked.values - truth.values)[200:204, 7].max() < 1.0  # gaps are filled all the same
    np.testing.assert_allclose((marked.values - clean.values)[250:340, 9], clean.report.noise.artefacts[-1].by)
    elsewhere = marked.values == clean.values
    assert elsewhere.sum() == marked.values.size - 29 - 90


def test_gaps_are_filled_and_told_frame_by_frame(truth: mc.Motion, noisy: mc.Motion) -> None:
    gaps = {
        "Hips_Xposition": ((0, 5), np.nan),
        "Hips_Yposition": ((0, 5), np.nan),
        "Foot_Yrotation": ((390, 400), np.nan),
    }
    clean = mc.denoise(changed(noisy, **gaps, Knee_Xrotation=((77, 78), np.nan)))
    assert told(clean) == [
        ("lost", ("Hips.Xposition", "Hips.Yposition"), 0, 4),
        ("lost", ("Knee.Xrotation",), 77, 77),
        ("lost", ("Foot.Yrotation",), 390, 399),
    ]
    assert np.abs(clean.values - truth.values).max() < 6.0
    assert np.isfinite(clean.report.max_error_world)


def test_gaps_of_channels_with_few_samples_are_filled_and_told(noisy: mc.Motion) -> None:
    clip = changed(noisy, Knee_Xrotation=((0, 397), np.nan))
    clean = mc.denoise(clip)
    assert told(clean) == [("lost", ("Knee.Xrotation",), 0, 396)]
    assert clean.report.noise.samples == 397
    assert (clean.values[:397, 7] == clip.values[397, 7]).all()
    short = mc.denoise(changed(noisy[:6], Knee_Xrotation=((2, 4), np.nan)))
    assert told(short) == [("lost", ("Knee.Xrotation",), 2, 3)]
    np.testing.assert_allclose(np.diff(short.values[1:5, 7], 2), 0.0, atol=1e-12)


def test_a_channel_without_any_sample_is_warned_of_and_stays(noisy: mc.Motion) -> None:
    clip = changed(noisy, Knee_Yrotation=((0, FRAMES), np.nan))
    with pytest.warns(UserWarning, match=r"^Knee\.Yrotation has no sample at all and stays empty$"):
        clean = mc.denoise(clip)
    assert np.flatnonzero(np.isnan(clean.values).any(0)).tolist() == [8]
    assert np.isnan(clean.values[:, 8]).all()
    assert "nan" not in json.dumps(clean.report.to_json()).lower()


def test_positions_of_a_body_without_height_are_smoothed(noisy: mc.Motion, truth: mc.Motion) -> None:
    """Nobody knows its unit, so no leap of it is too large."""
    alone = mc.Skeleton(("A",), [-1], np.zeros((1, 3)), ((*PLACES, *TURNS),))
    clip = mc.Motion(alone, noisy.values[:, :6], 1 / FPS)
    clean = mc.denoise(clip)
    assert not told(clean)
    assert rmse(clean.values, truth.values[:, :6]) < 0.5 * SIGMA


@pytest.mark.parametrize("unit", [0.001, 0.01, 1.0])
def test_what_bodies_do_is_told_in_the_clip_s_own_unit(noisy: mc.Motion, unit: float) -> None:
    """A body of any unit, whose hips are at another place for one frame."""
    values = np.array(noisy.values)
    values[:, :3] *= 0.01 / unit
    values[200, 0] += 0.3 / unit
    body = replace(legged(unit), offsets=legged().offsets * 0.01 / unit)
    clean = mc.denoise(mc.Motion(body, values, 1 / FPS))
    assert told(clean) == [("spike", ("Hips.Xposition",), 200, 200)]


def test_a_t_pose_is_dropped_where_that_is_asked_and_there_is_one(noisy: mc.Motion) -> None:
    pose = np.zeros((1, 12))
    clip = replace(noisy, values=np.concatenate([pose, changed(noisy, Hips_Xposition=((9, 12), np.nan)).values]))
    clean = mc.denoise(clip, drop_t_pose=True)
    assert (clean.frames, clean.report.noise.dropped) == (FRAMES, 1)
    assert told(clean) == [("lost", ("Hips.Xposition",), 9, 11)]
    kept = mc.denoise(clip)
    assert (kept.frames, kept.report.noise.dropped) == (FRAMES + 1, 0)
    without = mc.denoise(noisy, drop_t_pose=True)
    assert (without.frames, without.report.noise.dropped) == (FRAMES, 0)


# -- what is told ------------------------------------------------------------------------------------------------------


def test_the_step_is_part_of_the_history_and_json(noisy: mc.Motion) -> None:
    clean = mc.denoise(noisy, strength=1.4, limit=12.0, only=("Knee", "Foot"), mark=True)
    step = {"verb": "denoise", "strength": 1.4, "limit": 12.0, "only": ["Knee", "Foot"], "mark": True}
    assert clean.history == ({**step, "drop_t_pose": False},)
    assert json.loads(json.dumps(clean.history)) == list(clean.history)
    again = mc.denoise(clean, only="Knee")
    assert [s["only"] for s in again.history] == [["Knee", "Foot"], "Knee"]


def test_the_report_has_a_row_a_channel_that_moves(noisy: mc.Motion) -> None:
    clean = mc.denoise(noisy)
    rows = clean.report.noise.channels
    assert [row.name for row in rows] == list(noisy.skeleton.channel_names)
    assert [row.unit for row in rows] == ["units"] * 3 + ["degrees"] * 9
    np.testing.assert_allclose([row.sigma for row in rows], SIGMA, rtol=0.2)
    assert all(row.floor and 0.5 < row.cutoff < 20 for row in rows)
    assert clean.report.clips[1].values is not None
    np.testing.assert_array_equal(clean.report.clips[0].values, noisy.values)
    np.testing.assert_array_equal(clean.report.noise.captured.values, noisy.values)
    off = np.abs(clean.values - noisy.values)
    assert clean.report.max_error_degrees == pytest.approx(off[:, 3:].max())
    assert clean.report.max_error_length == pytest.approx(off[:, :3].max())


def test_the_findings_are_the_same_read_back_from_json(broken: mc.Motion) -> None:
    noise = mc.denoise(broken).report.noise
    assert Noise.from_json(json.loads(json.dumps(noise.to_json()))) == noise
    assert isinstance(noise.artefacts[0], Artefact)


def test_a_channel_without_a_noise_floor_is_told(truth: mc.Motion) -> None:
    """A shake from frame to frame as far as cross-validation can tell is motion."""
    rng, values = np.random.default_rng(0), np.array(truth.values)
    values[:, 7] = np.cumsum(np.cumsum(np.cumsum(rng.normal(size=FRAMES))))
    values[:, 7] *= 50 / np.ptp(values[:, 7])
    noise = mc.denoise(replace(truth, values=values), only="Knee").report.noise
    assert "Knee.Xrotation" in noise.no_floor()


# -- options -----------------------------------------------------------------------------------------------------------


def test_a_limit_takes_a_shake_of_20_hz_out(truth: mc.Motion) -> None:
    shake = 2.0 * np.sin(2 * np.pi * 20 * np.arange(FRAMES) / FPS)
    clip = replace(truth, values=truth.values + shake[:, None])
    inner = slice(20, -20)
    assert rmse(mc.denoise(clip).values[inner], truth.values[inner]) > 1.0
    assert rmse(mc.denoise(clip, limit=6.0).values[inner], truth.values[inner]) < 0.1


def test_more_strength_never_leaves_more_noise(noisy: mc.Motion) -> None:
    shaking = [np.linalg.norm(np.diff(mc.denoise(noisy, strength=s).values, 3, axis=0)) for s in (1, 1.4, 1.8, 4)]
    assert (np.diff(shaking) < 1e-9).all()


@pytest.mark.parametrize("times", [1e30, 1e97])
def test_huge_values_work(noisy: mc.Motion, times: float) -> None:
    """Positions of some 1e99 file units."""
    values = np.array(noisy.values)
    values[:, :3] *= times
    clean = mc.denoise(replace(noisy, values=values), only="Hips.?position")
    assert rmse(clean.values[:, :3] / times, walk(FRAMES, FPS).values[:, :3]) < 0.5 * SIGMA


@pytest.mark.parametrize(("value", "written"), [(1e101, "1e+101"), (-np.inf, "-inf")])
def test_values_that_are_no_motion_are_refused(noisy: mc.Motion, value: float, written: str) -> None:
    values = np.array(noisy.values)
    values[13, 7] = value
    with pytest.raises(mc.Mismatch) as refused:
        mc.denoise(replace(noisy, values=values), drop_t_pose=True)
    assert str(refused.value) == f"channel 'Knee.Xrotation' has the value {written} at frame 13: that is no motion"


@pytest.mark.parametrize("strength", [0.4, 4.1, -1, np.nan, "much", None])
def test_a_strength_out_of_range_is_refused(noisy: mc.Motion, strength) -> None:
    with pytest.raises(mc.OptionError) as refused:
        mc.denoise(noisy, strength=strength)
    assert str(refused.value) == f"strength is a number from 0.5 to 4, 1 is what the data ask for, not {strength!r}"


@pytest.mark.parametrize("limit", [0, -3.0, 60.0, np.nan, "6"])
def test_a_limit_out_of_range_is_refused(noisy: mc.Motion, limit) -> None:
    with pytest.raises(mc.OptionError) as refused:
        mc.denoise(noisy, limit=limit)
    assert str(refused.value) == f"limit is a frequency in Hz below 60, half the frame rate, not {limit!r}"


@pytest.mark.parametrize(("only", "near"), [("Kne", "Knee"), (["Foot", "Foot.Xrotatoin"], "Foot.Xrotation")])
def test_an_unknown_name_is_answered_with_the_nearest(noisy: mc.Motion, only, near: str) -> None:
    name = only if isinstance(only, str) else only[-1]
    with pytest.raises(mc.UnknownName) as refused:
        mc.denoise(noisy, only=only)
    assert str(refused.value) == f"no joint or channel {name!r}. Did you mean {near!r}?"
