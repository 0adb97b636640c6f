"""bands: gains of 1 change nothing, a band is what it says in Hz, a steady turn is no band at all."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from chains import samples
from turning import ALONG, FRAMES, apart, spline, turning, widest_step

import mocurve as mc
from mocurve import OptionError, UnknownName, kinematics, rotation
from mocurve.edit import _bank

FPS = 100.0


@pytest.fixture(scope="module")
def motion(jump: Path) -> mc.Motion:
    return mc.read(jump)


def wave(hertz: float, frames: int = 801) -> mc.Motion:
    """One position channel that swings."""
    body = mc.Skeleton(("Hips",), [-1], [[0, 0, 0]], (("Yposition",),))
    return mc.Motion(body, np.sin(2 * np.pi * hertz * np.arange(frames)[:, None] / FPS), 1 / FPS)


def tumbling(frames: int = 300) -> np.ndarray:
    """Rotations (F, 4) that turn several times, now about one axis, now about another."""
    vectors = np.stack([np.sin(np.linspace(0, 9, frames) + k) for k in range(3)], axis=1) * [0.2, 0.5, 0.3]
    track = [np.array([1.0, 0.0, 0.0, 0.0])]
    for vector in vectors[1:]:
        track.append(rotation.mul(track[-1], rotation.exp(vector)))
    return np.array(track)


# -- nothing -----------------------------------------------------------------------------------------
@pytest.mark.parametrize("gains", [(), {}, {0: 1, 3: 1.0}, [1, 1], "2=1"])
def test_gains_of_1_change_nothing(motion: mc.Motion, gains: object) -> None:
    made = mc.bands(motion, gains)
    assert made.values.tobytes() == motion.values.tobytes()


def test_keys_and_splines_stay_where_all_gains_are_1(motion: mc.Motion) -> None:
    keys = mc.reduce(motion[:120], tolerance="3deg")
    assert mc.bands(keys).curves == keys.curves
    curves = spline(motion.skeleton, 20, 3, 1)
    assert mc.bands(curves, {0: 1}).values.tobytes() == curves.values.tobytes()


@pytest.mark.parametrize("track", [tumbling(), rotation.from_euler(np.outer(ALONG, [720.0, 90.0, 5.0]), "YXZ")])
def test_the_bands_and_the_rest_are_the_rotations_again(track: np.ndarray) -> None:
    made, bands = _bank.turned(track, np.ones(_bank.count(len(track))))
    assert rotation.angle(made, track).max() < 1e-12 * 180
    assert bands.any()


def test_the_bands_and_the_rest_add_up() -> None:
    values = np.random.default_rng(1).normal(0, 30, (257, 3))
    rest, bands = _bank.shaped(values, np.zeros(_bank.count(257)))
    np.testing.assert_allclose(rest + bands.sum(axis=0), values, atol=1e-12)


@pytest.mark.parametrize("gains", [[0], [0.0, 3.0], [2] * 7])
def test_what_goes_on_evenly_is_no_band(gains: list[float]) -> None:
    still = samples(FRAMES)
    straight = replace(still, values=np.outer(np.arange(FRAMES), np.linspace(-0.4, 0.4, still.values.shape[1])))
    moves = ~straight.skeleton.rotation_channels
    np.testing.assert_allclose(mc.bands(straight, gains).values[:, moves], straight.values[:, moves], atol=1e-9)
    spinning = turning(1500 * ALONG, 0.0)
    assert apart(mc.bands(spinning, gains), spinning) < 1e-9


def test_joints_that_are_not_named_come_back_to_the_last_digit(motion: mc.Motion) -> None:
    made = mc.bands(motion, [0, 0, 2], only=["*Arm", "Head"])
    joints = np.array(motion.skeleton.names)[motion.skeleton.channel_joints]
    named = np.char.endswith(joints, "Arm") | (joints == "Head")
    assert made.values[:, ~named].tobytes() == motion.values[:, ~named].tobytes()
    assert (made.values[:, named] != motion.values[:, named]).any()


# -- what a band is ----------------------------------------------------------------------------------
def test_the_highest_frequency_of_a_clip_is_in_its_finest_band() -> None:
    assert mc.bands(wave(9.0), {"50Hz": 0}).history[-1]["measured"][0]["gain"] == 0


@pytest.mark.parametrize("band", [0, 1, 2, 3])
def test_a_swing_is_found_in_the_band_that_has_its_frequency_and_takes_its_gain(band: int) -> None:
    edges = _bank.edges(6, 1 / FPS)
    hertz = float(np.sqrt(edges[band] * edges[band + 1]))
    clip = wave(hertz)
    told = mc.bands(clip).history[-1]["measured"]
    assert max(told, key=lambda row: row["units"])["band"] == band
    assert (told[band]["from_hertz"], told[band]["to_hertz"]) == (edges[band + 1], edges[band])
    # what the kernels let through, in closed form
    passes = [np.prod([np.cos(np.pi * hertz / FPS * 2**k) ** 4 for k in range(n)]) for n in (band, band + 1)]
    made = mc.bands(clip, {f"{hertz}Hz": 3.0}).values[200:-200, 0]
    expected = (1 + 2 * (passes[0] - passes[1])) * clip.values[200:-200, 0]
    np.testing.assert_allclose(made, expected, atol=1e-9)


def test_at_an_edge_half_has_been_smoothed_away() -> None:
    for band, edge in enumerate(_bank.edges(5, 1 / FPS)[1:]):
        smooth = mc.bands(wave(edge, 1601), dict.fromkeys(range(band + 1), 0)).values[400:-400, 0]
        np.testing.assert_allclose(np.abs(smooth).max(), 0.5, rtol=0.02)


def test_a_gain_multiplies_angles() -> None:
    angle = np.radians(8.0) * np.sin(2 * np.pi * 9 * ALONG)
    axis = np.array([0.6, 0.0, 0.8])
    made, _ = _bank.turned(rotation.exp(angle[:, None] * axis), np.full(_bank.count(FRAMES), 2.0))
    vectors = rotation.log(made)
    assert np.abs(np.cross(vectors, axis)).max() < 1e-12
    inside = slice(40, -40)
    np.testing.assert_allclose((vectors @ axis)[inside], 2.0 * angle[inside], atol=np.radians(0.1))


@pytest.mark.parametrize("heading", [1500 * ALONG, 400 * np.sin(6 * ALONG)])
def test_a_body_that_turns_several_times_is_smoothed_without_flips(heading: np.ndarray) -> None:
    clip = turning(heading, 25.0)
    for gains in ([0], [0, 0, 0], {3: 0}, {5: 2}):
        made = mc.bands(clip, gains)
        assert widest_step(made) < 1.5 * widest_step(clip)
        assert np.abs(np.diff(made.values[:, 3:], axis=0)).max() < 30
    assert apart(mc.bands(clip, [0]), clip) < 1.0


def test_gimbal_lock_is_passed() -> None:
    body = turning(0 * ALONG, 0.0)
    angles = np.stack([30 * np.sin(7 * ALONG), 90 + 3 * np.sin(20 * ALONG), 40 * ALONG], axis=1)  # X is in the middle
    clip = replace(body, values=np.hstack([body.values[:, :3], angles]))
    assert apart(mc.bands(clip, [1 + 1e-9] * 7), clip) < 1e-6
    assert widest_step(mc.bands(clip, [0, 0])) <= widest_step(clip) + 1e-9


def test_no_fine_band_is_smoothing(motion: mc.Motion) -> None:
    made = mc.bands(motion, [0, 0])
    shakes = [np.abs(np.diff(kinematics.world(clip), 3, axis=0)).mean() for clip in (motion, made)]
    assert shakes[1] < 0.3 * shakes[0]
    first, second = (mc.bands(clip).history[-1]["measured"][0] for clip in (motion, made))
    assert second["degrees"] < 0.25 * first["degrees"]


# -- around ------------------------------------------------------------------------------------------
@pytest.mark.parametrize("frames", [0, 1, 2, 3, 4, 7])
def test_short_clips_have_few_bands_or_none(motion: mc.Motion, frames: int) -> None:
    short = motion[:frames]
    told = mc.bands(short).history[-1]["measured"]
    assert len(told) == {0: 0, 1: 0, 2: 0, 3: 1, 4: 1, 7: 2}[frames]
    if told:
        assert np.isfinite(mc.bands(short, {len(told) - 1: 0}).values).all()
    with pytest.raises(OptionError, match=f"there is no band {len(told)}: a clip of {frames} frames has"):
        mc.bands(short, {len(told): 0})


def test_the_step_can_be_run_again(motion: mc.Motion) -> None:
    made = mc.bands(motion, "0=0,6Hz=1.5", only=["*Arm"])
    step = {k: v for k, v in made.history[-1].items() if k not in ("verb", "measured")}
    assert step == {"gains": {"0": 0.0, "6Hz": 1.5}, "only": ["*Arm"]}
    assert mc.bands(motion, **step).values.tobytes() == made.values.tobytes()


def test_keys_become_samples_and_that_is_said(motion: mc.Motion) -> None:
    keys = mc.reduce(motion[:120], tolerance="3deg")
    with pytest.warns(UserWarning, match="keys become samples: bands are filtered frame by frame"):
        made = mc.bands(keys, [0])
    assert made.values.tobytes() == mc.bands(keys.sample(), [0]).values.tobytes()


def test_a_t_pose_before_the_motion_is_told(clips: Path) -> None:
    clip = mc.read(clips / "cmu" / "cmu_12_01_walk.bvh")[:100]
    with pytest.warns(UserWarning, match="frame 0 is a T-pose and spreads into the motion"):
        mc.bands(clip, [0])


@pytest.mark.parametrize(
    ("gains", "text"),
    [
        ({9: 0}, "there is no band 9: a clip of 420 frames has bands 0 to 7, 0.149 to 60 Hz"),
        ({"70Hz": 0}, "there is no band 70Hz"),
        ({"0.01Hz": 0}, "there is no band 0.01Hz"),
        ({0: "loud"}, "a gain is a number for a band, such as 0=0.5, or 6Hz=2; not 0=loud"),
        ({0: float("nan")}, "a gain is a number"),
        ({"low": 1}, "not low=1"),
        ({-1: 1}, "not -1=1"),
        ({"30Hz": 0, 0: 2}, "two gains are given for band 0: by 30Hz and by 0"),
        (["0=1", 2], "gains are a list from band 0 on, or BAND=GAIN each; not both"),
        ([0] * 9, "there is no band 8"),
    ],
)
def test_wrong_gains_are_refused(motion: mc.Motion, gains: object, text: str) -> None:
    with pytest.raises(OptionError, match=text):
        mc.bands(motion, gains)


def test_a_joint_that_is_not_there_is_named(motion: mc.Motion) -> None:
    with pytest.raises(UnknownName, match=r"no joint 'LeftHnd'. Did you mean 'LeftHand'"):
        mc.bands(motion, only="LeftHnd")
