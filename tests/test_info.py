"""What `inspect` finds in clips made to be odd, in real clips, and what it does not find in clean ones."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mocurve import Motion, OptionError, Skeleton, info, read

POSITIONS, ROTATIONS = ("Xposition", "Yposition", "Zposition"), ("Zrotation", "Xrotation", "Yrotation")


def body(
    *channels: tuple[str, ...], height: float = 170.0, frames: int = 60, fps: float = 120.0, **skeleton: object
) -> Motion:
    """A chain of joints along Y, height tall, that swings slowly and without any oddity."""
    count = len(channels)
    settings: dict[str, object] = {
        "names": [f"J{j}" for j in range(count)],
        "parents": range(-1, count - 1),
        "offsets": [[0.0, height / max(count - 1, 1) if j else 0.0, 0.0] for j in range(count)],
    }
    width = sum(map(len, channels))
    swing = 20.0 * np.sin(0.02 * np.arange(frames)[:, None] + np.arange(width)) + 30.0
    return Motion(Skeleton(channels=channels, **{**settings, **skeleton}), swing, 1.0 / fps)  # type: ignore[arg-type]


def oddities(motion: Motion) -> str:
    return "\n".join(info.inspect(motion).oddities)


CLEAN = body((*POSITIONS, *ROTATIONS), ROTATIONS, ROTATIONS)


# -- what it counts ----------------------------------------------------------------------------------
def test_a_clean_clip_has_nothing_odd() -> None:
    assert info.inspect(CLEAN).oddities == ()


def test_the_page_says_what_is_there() -> None:
    motion = replace(CLEAN, skeleton=replace(CLEAN.skeleton, end_sites=[False, False, False]))
    assert str(info.inspect(motion, Path("walk.bvh"))).splitlines() == [
        "walk.bvh",
        "  3 joints, 0 end sites, 12 channels",
        "  rotation orders: ZXY x 3",
        "  60 frames at 120 fps, 0.49 s",
        "  170 units tall at rest: 1.70 m, the unit being the cm (guessed from this height; the option unit says it)",
    ]


def test_the_example_that_ships_is_described(jump: Path) -> None:
    found = info.inspect(read(jump), jump)
    assert (found.joints, found.end_sites, found.channels, found.frames) == (31, 7, 96, 420)
    assert found.fps == pytest.approx(120)
    assert found.rotation_orders == {"ZYX": 31}
    assert found.unit is not None
    assert 1.4 < found.rest_height * found.unit.metres < 1.9
    assert any("bones of length zero (LHipJoint, RHipJoint, LowerBack and 7 more)" in text for text in found.oddities)


def test_the_steps_that_made_a_clip_are_told(jump: Path) -> None:
    motion = read(jump)
    assert "made by" not in str(info.inspect(motion))
    found = info.inspect(motion[10:20])
    assert str(found).splitlines()[-1] == f"made by: read {jump}, trim"
    assert found.to_json()["history"] == list(motion[10:20].history)


def test_it_is_json(jump: Path) -> None:
    told = json.loads(json.dumps(info.inspect(read(jump), jump).to_json()))
    assert told["path"] == str(jump)
    assert told["unit"] == {"metres": info.CMU_METRES, "name": "CMU unit of 5.6444 cm", "said": False}
    assert set(told) == set(info.Info.__dataclass_fields__)


def test_a_skeleton_without_anything_is_described_too() -> None:
    nothing = Motion(Skeleton(["Prop"], [-1], [[0, 0, 0]], [()]), np.zeros((0, 0)), 1 / 30)
    page = str(info.inspect(nothing))
    assert "rotation orders: none x 1" in page
    assert "0 units tall at rest: no length unit can be guessed" in page
    assert "odd: no frames" in page


# -- the length unit ---------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("height", "name"),
    [
        (1700.0, "mm"),
        (151.0, "cm"),
        (185.0, "cm"),
        (67.0, "inch"),
        (72.0, "inch"),
        (1.1, "m"),
        (26.1, "CMU unit of 5.6444 cm"),
    ],
)
def test_the_unit_is_guessed_from_the_height(height: float, name: str) -> None:
    unit = info.unit_of(body((*POSITIONS, *ROTATIONS), (), height=height))
    assert (unit.name, unit.metres, unit.said) == (name, info.UNITS[name], False)


@pytest.mark.parametrize(
    ("metres", "name"), [(0.01, "cm"), (0.0254, "inch"), (0.3048, "0.3048 m"), (0.056444, "CMU unit of 5.6444 cm")]
)
def test_a_unit_that_was_said_is_no_guess(metres: float, name: str) -> None:
    motion = body(ROTATIONS, (), unit=metres)
    assert info.unit_of(motion) == info.Unit(metres, name, True)
    assert f"the {name} (as said)" in str(info.inspect(motion))


def test_without_a_height_no_unit_is_guessed() -> None:
    flat = body(ROTATIONS, ROTATIONS, height=0.0)
    with pytest.raises(OptionError, match="no height to guess the length unit from: say it with the option unit"):
        info.unit_of(flat)
    assert info.inspect(flat).unit is None
    said = replace(flat, skeleton=replace(flat.skeleton, unit=1.0))
    assert info.inspect(said).unit == info.Unit(1.0, "m", True)


@pytest.mark.parametrize(
    ("clip", "name"),
    [
        ("cmu/cmu_12_01_walk", "CMU unit of 5.6444 cm"),
        ("cmu/cmu_02_03_run", "CMU unit of 5.6444 cm"),
        ("cmu/cmu_walk_daz19", "cm"),
        ("other/rokoko_dance_fingers", "cm"),
        ("other/spec_example_wisc", "inch"),
    ],
)
def test_the_unit_of_real_clips_is_found(clips: Path, clip: str, name: str) -> None:
    assert info.unit_of(read(clips / f"{clip}.bvh")).name == name


# -- the T-pose --------------------------------------------------------------------------------------
def test_a_rest_pose_before_the_motion_is_found_and_only_there() -> None:
    values = CLEAN.values.copy()
    values[0, 3:] = 0.0
    posed = replace(CLEAN, values=values)
    assert info.first_frame_is_t_pose(posed)
    assert "frame 0 is a T-pose, not part of the motion" in oddities(posed)
    assert not info.first_frame_is_t_pose(posed[1:])
    assert not info.first_frame_is_t_pose(posed[:3])


def test_whole_turns_do_not_hide_a_rest_pose() -> None:
    values = CLEAN.values.copy()
    values[0, 3:] = 360.0
    assert info.first_frame_is_t_pose(replace(CLEAN, values=values))


def test_a_motion_that_starts_near_the_rest_pose_is_no_t_pose() -> None:
    leaving = np.zeros((20, 12)) + 1.0 + 4.0 * np.arange(20)[:, None]
    assert not info.first_frame_is_t_pose(replace(CLEAN, values=leaving))


def test_the_leap_out_of_a_t_pose_is_not_told_twice() -> None:
    values = CLEAN.values.copy() + 80.0
    values[0, 3:] = 0.0
    assert oddities(replace(CLEAN, values=values)) == "frame 0 is a T-pose, not part of the motion"


def test_a_leap_into_another_pose_is_no_t_pose() -> None:
    values = CLEAN.values.copy()
    values[0, 3:] += 80.0
    assert not info.first_frame_is_t_pose(replace(CLEAN, values=values))


@pytest.mark.parametrize(
    ("clip", "posed"),
    [
        ("cmu_01_01_jump", True),
        ("cmu_05_20_dance_motionbuilder", True),
        ("cmu_12_01_walk", True),
        ("cmu_135_04_martial_daz", True),
        ("cmu_walk_daz19", True),
        ("cmu_run_filtered", True),
        ("cmu_02_01_walk_blender", False),
        ("cmu_02_03_run", False),
        ("cmu_94_01_dance_max", False),
        ("../other/hands_60_joints", False),
        ("../other/rokoko_dance_fingers", False),
    ],
)
def test_the_t_poses_of_real_clips_are_found(clips: Path, clip: str, posed: bool) -> None:
    motion = read(clips / "cmu" / f"{clip}.bvh")
    assert info.first_frame_is_t_pose(motion) is posed
    assert not info.first_frame_is_t_pose(motion[1:])


# -- what is odd -------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("motion", "said"),
    [
        (body(ROTATIONS, ROTATIONS, parents=[-1, -1]), "2 roots (J0, J1)"),
        (
            body(*[ROTATIONS] * 5, names=["Hips", "Bone", "Bone", "Tip", "Tip"]),
            "2 names given to several joints (Bone, Tip)",
        ),
        (body(*[ROTATIONS] * 6, offsets=np.zeros((6, 3))), "5 bones of length zero (J1, J2, J3 and 2 more)"),
        (body(ROTATIONS, ("Zrotation",), ROTATIONS[:2]), "2 joints with only one or two rotation channels (J1, J2)"),
        (body((*ROTATIONS, *POSITIONS), ROTATIONS), "1 joint with a rotation channel before a position channel (J0)"),
        (body(POSITIONS, POSITIONS[1:2], ()), "bones change their length in 1 channel (J1.Yposition)"),
        (CLEAN[:0], "no frames"),
        (CLEAN[:1], "a single frame: a pose, not a motion"),
        (body(ROTATIONS, ROTATIONS, fps=1000), "1000 frames a second is an unusual rate"),
        (body(ROTATIONS, ROTATIONS, fps=37.5), "37.5 frames a second is an unusual rate"),
        (body(ROTATIONS, ROTATIONS, fps=1), "1 frames a second is an unusual rate"),
    ],
)
def test_each_oddity_is_said(motion: Motion, said: str) -> None:
    assert said in info.inspect(motion).oddities


@pytest.mark.parametrize("fps", [24, 25, 30000 / 1001, 60, 100, 120, 240])
def test_usual_rates_are_not_odd(fps: float) -> None:
    assert "rate" not in oddities(body(ROTATIONS, ROTATIONS, fps=fps))


def test_samples_that_are_missing_are_counted() -> None:
    motion = body(ROTATIONS, ROTATIONS)
    values = np.array(motion.values)
    values[10:14, 2] = np.nan
    assert (
        "4 samples missing in 1 channel (J0.Yrotation): denoise fills them"
        in info.inspect(replace(motion, values=values)).oddities
    )


def test_channels_that_never_change_are_counted() -> None:
    values = CLEAN.values.copy()
    values[:, [0, 5, 7]] = 1.5
    assert oddities(replace(CLEAN, values=values)) == "3 of 12 channels never change"


def test_jumps_that_unroll_mends_are_told_from_those_that_stay() -> None:
    wrapped, leaping = CLEAN.values.copy(), CLEAN.values.copy()
    wrapped[20:, 4] -= 360.0
    leaping[40, 8] += 130.0
    mended = "jumps of more than 180 degrees in 1 channel (J0.Xrotation): unroll mends that"
    assert oddities(replace(CLEAN, values=wrapped)) == mended
    worst = "jumps of more than 90 degrees that stay at 2 frames, the worst 130 in J1.Yrotation at frame 41"
    assert oddities(replace(CLEAN, values=leaping)) == worst


def test_a_joint_that_passes_gimbal_lock_is_named() -> None:
    values = CLEAN.values.copy()
    values[30:, 9:12] = np.array([180.0, 180.0, 180.0]) + [1, -1, 1] * values[30:, 9:12]
    assert "gimbal lock passed by 1 joint (J2): unroll mends that" in oddities(replace(CLEAN, values=values))


def test_a_body_along_z_is_known_also_where_its_root_stays_behind() -> None:
    standing = np.stack([np.zeros(12), np.linspace(0.0, 170.0, 12), np.zeros(12)], axis=1)[None]
    walked = standing + np.array([0.0, 0.0, 900.0])
    walked[:, 0] = 0.0  # the root stays where it was
    assert not info.z_is_up(walked)
    assert info.z_is_up(walked[..., [0, 2, 1]])
