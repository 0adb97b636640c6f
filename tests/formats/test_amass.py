"""AMASS: poses on named joints mean what the models say, and come back; files that are odd or made to hurt."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import mocurve as mc
from mocurve import kinematics, rotation
from mocurve.formats._amass import MODELS

# parents of the joints of SMPL, SMPL-H and SMPL-X in their order, as the models publish them
_22 = [-1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19]
PARENTS = {
    66: _22,
    72: [*_22, 20, 21],
    156: [*_22, *(20 if i % 3 == 0 else 21 + i for i in range(15)), *(21 if i % 3 == 0 else 36 + i for i in range(15))],
    165: [*_22, 15, 15, 15, *(20 if i % 3 == 0 else 24 + i for i in range(15)), *(21 if i % 3 == 0 else 39 + i for i in range(15))],  # noqa: E501
}  # fmt: skip
MEAN_BODY = "no bones in the file: those of a mean body of 1.7 m are taken; skeleton= names other ones"


def save(path, width: int = 156, frames: int = 5, **changes) -> dict[str, np.ndarray]:
    """Write such a file as the data set has; its arrays. A change to None leaves one out."""
    rng = np.random.default_rng(width)
    arrays = {
        "poses": rng.normal(0.0, 0.8, (frames, width)),
        "trans": rng.normal(0.0, 2.0, (frames, 3)),
        "mocap_framerate": np.array(60.0),
        "gender": np.array("female"),
        "betas": rng.normal(size=16),
        **changes,
    }
    np.savez(path, **{name: array for name, array in arrays.items() if array is not None})
    return arrays


def read(path, **options) -> mc.Motion:
    with pytest.warns(UserWarning, match=MEAN_BODY):
        return mc.read(path, **options)


def write(path, clip) -> None:
    with pytest.warns(UserWarning, match="bone lengths, end sites, rotation orders and history are not in AMASS files"):
        mc.write(path, clip, profile="amass")


def matrix(vector: np.ndarray) -> np.ndarray:
    """Rodrigues' formula."""
    angle = np.linalg.norm(vector)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


@pytest.mark.parametrize("width", MODELS)
def test_joints_stand_where_the_poses_turn_them(tmp_path, width):
    data = save(tmp_path / "a.npz", width)
    motion = read(tmp_path / "a.npz")
    offsets = {name: motion.skeleton.offsets[motion.skeleton.joint(name)] for name in MODELS[width]}
    world = kinematics.world(motion)
    for frame in range(motion.frames):
        turns, places = [], []
        for joint, (name, parent) in enumerate(zip(MODELS[width], PARENTS[width], strict=True)):
            own = matrix(data["poses"][frame, 3 * joint : 3 * joint + 3])
            turns.append(turns[parent] @ own if parent >= 0 else own)
            places.append(places[parent] + turns[parent] @ offsets[name] if parent >= 0 else data["trans"][frame])
            assert world[frame, motion.skeleton.joint(name)] == pytest.approx(places[-1], abs=1e-9)


@pytest.mark.parametrize("width", MODELS)
def test_what_is_written_comes_back_as_the_same_rotations(tmp_path, width):
    save(tmp_path / "a.npz", width)
    motion = read(tmp_path / "a.npz")
    write(tmp_path / "b.npz", motion)
    with np.load(tmp_path / "b.npz") as data:
        assert data["poses"].shape == (5, width)
        assert data["mocap_framerate"] == 60.0
    back = read(tmp_path / "b.npz")
    away = rotation.angle(kinematics.rotations(motion), kinematics.rotations(back))
    assert away.max() < 1e-6
    assert back.values[:, :3].tolist() == motion.values[:, :3].tolist()
    assert back.frame_time == motion.frame_time
    assert back.skeleton.channel_names == motion.skeleton.channel_names


def test_the_mean_body_has_the_lengths_of_its_source(tmp_path):
    save(tmp_path / "a.npz")
    body = read(tmp_path / "a.npz").skeleton
    lengths = {name: np.linalg.norm(body.offsets[body.joint(name)]) / 1.7 for name in body.names}
    assert lengths["left_knee"] == pytest.approx(0.245)  # thigh
    assert lengths["right_ankle"] == pytest.approx(0.246)  # shank
    assert lengths["left_elbow"] == pytest.approx(0.186)  # upper arm
    assert lengths["right_wrist"] == pytest.approx(0.146)  # forearm
    middle = [f"left_middle{i}" for i in (2, 3)]
    assert sum(lengths[name] for name in middle) + lengths["left_middle3_End"] == pytest.approx(0.054)
    places = np.zeros((len(body.names), 3))
    for joint, parent in enumerate(body.parents):
        places[joint] = body.offsets[joint] + (places[parent] if parent >= 0 else 0.0)
    assert places[:, 1].min() == pytest.approx(0.0, abs=1e-12)
    assert places[body.joint("head_End")].tolist() == pytest.approx([0.0, 1.7, 0.0])
    left, right = (body.names.index(f"{side}_thumb3_End") for side in ("left", "right"))
    assert places[left].tolist() == (places[right] * [-1, 1, 1]).tolist()
    assert body.unit == 1.0
    assert body.names[:6] == ("pelvis", "left_hip", "left_knee", "left_ankle", "left_foot", "left_foot_End")


def test_the_bones_of_another_file_are_taken_in_metres(tmp_path):
    save(tmp_path / "a.npz", 66)
    motion = read(tmp_path / "a.npz")
    body = motion.skeleton
    other = replace(
        motion, skeleton=replace(body, offsets=body.offsets * 120.0, unit=0.01)
    )  # 1.2 times as large, in cm
    mc.write(tmp_path / "body.npz", other)
    large = mc.read(tmp_path / "a.npz", skeleton=tmp_path / "body.npz")
    assert large.skeleton.offsets == pytest.approx(body.offsets * 1.2)
    assert large.skeleton.unit == 1.0
    assert large.skeleton.names == body.names
    assert large.values.tolist() == motion.values.tolist()
    mc.write(tmp_path / "body.bvh", other)
    with pytest.warns(UserWarning, match=r"body\.bvh: the unit of its bones is guessed: cm"):
        guessed = mc.read(tmp_path / "a.npz", skeleton=tmp_path / "body.bvh")
    assert guessed.skeleton.offsets == pytest.approx(body.offsets * 1.2)


def test_a_body_that_does_not_fit_names_the_first_joint(tmp_path, small, jump):
    save(tmp_path / "a.npz", 66)
    with (
        pytest.raises(mc.Mismatch, match="the joints of SMPL, and there is no 'pelvis' among those of the skeleton"),
        pytest.warns(UserWarning, match="the unit of its bones is guessed"),
    ):
        mc.read(tmp_path / "a.npz", skeleton=jump)
    motion = read(tmp_path / "a.npz")
    names = tuple("left_toe" if name == "left_foot" else name for name in motion.skeleton.names)
    with pytest.raises(mc.Mismatch, match="there is no 'left_foot'"):
        mc.write(tmp_path / "b.npz", replace(motion, skeleton=replace(motion.skeleton, names=names)), profile="amass")
    swap = {"left_knee": "right_knee", "right_knee": "left_knee"}
    names = tuple(swap.get(name, name) for name in motion.skeleton.names)
    with pytest.raises(mc.Mismatch, match="'left_knee' hangs on 'left_hip' in AMASS, not so in the skeleton"):
        mc.write(tmp_path / "b.npz", replace(motion, skeleton=replace(motion.skeleton, names=names)), profile="amass")
    with pytest.raises(mc.Mismatch, match="there is no 'pelvis'"):
        mc.write(tmp_path / "b.npz", small, profile="amass")
    assert not (tmp_path / "b.npz").exists()


def test_writing_warns_of_joints_positions_and_units_that_are_lost(tmp_path):
    save(tmp_path / "a.npz", 66)
    motion = read(tmp_path / "a.npz")
    body = motion.skeleton
    channels = list(body.channels)
    channels[body.joint("head_End")] = ("Xrotation",)
    channels[body.joint("left_knee")] = ("Xposition", *channels[body.joint("left_knee")])
    odd = replace(body, channels=tuple(channels), unit=None, end_sites=[False] * len(body.names))
    clip = mc.Motion(odd, np.zeros((2, odd.channel_count)), 1 / 60)
    with pytest.warns(UserWarning, match="are lost") as caught:
        mc.write(tmp_path / "b.npz", clip, profile="amass")
    told = str(caught[0].message)
    for lost in ("joints that it does not know: head_End", "position channels below the root", "unit is guessed: m"):
        assert lost in told


def test_values_that_are_not_finite_are_not_written(tmp_path):
    save(tmp_path / "a.npz", 66)
    motion = read(tmp_path / "a.npz")
    odd = np.where(np.arange(69) == 1, np.nan, motion.values)
    with pytest.raises(mc.Mismatch, match="a value of the clip is not finite"):
        mc.write(tmp_path / "b.npz", replace(motion, values=odd), profile="amass")


def test_keys_are_sampled_and_lengths_become_metres(tmp_path):
    save(tmp_path / "a.npz", 66)
    motion = replace(read(tmp_path / "a.npz"), values=np.tile(np.arange(69.0), (3, 1)))
    inches = replace(motion, skeleton=replace(motion.skeleton, unit=0.0254))
    curves = tuple(mc.HermiteCurve([0.0], [value], [0.0]) for value in inches.values[0])
    with pytest.warns(UserWarning, match="keys become samples"):
        write(tmp_path / "b.npz", mc.KeyedMotion(inches.skeleton, curves, 1 / 60, 3))
    assert read(tmp_path / "b.npz").values[2, :3].tolist() == [0, 0.0254, 0.0508]


@pytest.mark.parametrize(
    "change", [{"mocap_framerate": None, "mocap_frame_rate": np.array(60)}, {}, {"extra": np.ones(3)}]
)
def test_either_name_of_the_rate_is_read_and_what_is_not_needed_is_left_aside(tmp_path, change):
    save(tmp_path / "a.npz", 66, gender=np.array({"male": 1}, object), **change)
    assert read(tmp_path / "a.npz").frame_time == 1 / 60


@pytest.mark.parametrize(("rate", "seconds"), [(119.99999, 1 / 120), (59.94, 1 / 59.94), (np.float32(100), 0.01)])
def test_the_rate_is_the_whole_one_that_is_meant(tmp_path, rate, seconds):
    save(tmp_path / "a.npz", 66, mocap_framerate=np.array(rate))
    assert read(tmp_path / "a.npz").frame_time == seconds


def test_a_file_without_a_rate_is_read_at_120_with_a_warning(tmp_path):
    save(tmp_path / "a.npz", 66, mocap_framerate=None)
    with pytest.warns(UserWarning, match="no frame rate in the file, 120 frames a second assumed"):
        assert mc.read(tmp_path / "a.npz").frame_time == 1 / 120


def test_float32_and_no_frames_are_read(tmp_path):
    data = save(tmp_path / "a.npz", 66, poses=np.full((2, 66), 0.1, np.float32), trans=np.ones((2, 3), np.float32))
    assert read(tmp_path / "a.npz").values.dtype == np.float64
    assert data["poses"].dtype == np.float32
    save(tmp_path / "a.npz", frames=0)
    assert read(tmp_path / "a.npz").values.shape == (0, 159)


def test_angles_run_on_where_the_vectors_jump(tmp_path):
    poses = np.zeros((40, 66))
    poses[:, 1] = np.linspace(0.0, 9.0, 40)  # the pelvis turns once and a half about Y
    poses[:, 1] -= 2 * np.pi * np.rint(poses[:, 1] / (2 * np.pi))
    save(tmp_path / "a.npz", 66, poses=poses, trans=np.zeros((40, 3)))
    assert np.abs(np.diff(read(tmp_path / "a.npz").values, axis=0)).max() < 14.0


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"poses": np.zeros((5, 63))}, "poses: 165, 156, 72, 66 columns expected, 63 found"),
        ({"poses": np.zeros((5, 22, 3))}, "poses: 2 dimensions of kind 'f' expected, 3 of float64 found"),
        ({"poses": np.zeros((5, 156), int)}, "poses: 2 dimensions of kind 'f' expected, 2 of int64 found"),
        ({"poses": np.full((5, 156), {}, object)}, "of object found"),
        ({"poses": np.full((5, 156), np.nan)}, "poses, trans: finite numbers expected"),
        ({"trans": np.full((5, 3), np.inf)}, "poses, trans: finite numbers expected"),
        ({"poses": np.full((5, 156), -1e300)}, "no angles beyond sense"),
        ({"trans": np.zeros((4, 3))}, "trans: the shape (5, 3) expected, as of poses, (4, 3) found"),
        ({"trans": None}, "the array 'trans' is not in it"),
        ({"mocap_framerate": np.array(0.0)}, "a frame rate above 0 expected, 0.0 found"),
        ({"mocap_framerate": np.array(np.nan)}, "a frame rate above 0 expected, nan found"),
        ({"mocap_framerate": np.array("60")}, "mocap_framerate: 0 dimensions of kind 'iuf' expected"),
        ({"mocap_framerate": np.array({}, object)}, "mocap_framerate: 0 dimensions of kind 'iuf' expected"),
    ],
)
def test_what_is_wrong_is_told(tmp_path, changes, told):
    save(tmp_path / "a.npz", **changes)
    with pytest.raises(mc.FileError) as caught:
        mc.read(tmp_path / "a.npz")
    assert told in str(caught.value)


def test_every_cut_of_a_file_is_refused(tmp_path):
    save(tmp_path / "a.npz", 66)
    data = (tmp_path / "a.npz").read_bytes()
    for length in range(0, len(data), 97):
        (tmp_path / "a.npz").write_bytes(data[:length])
        with pytest.raises(mc.FileError):
            mc.read(tmp_path / "a.npz")


def test_our_own_files_have_a_skeleton_already(tmp_path, small):
    mc.write(tmp_path / "a.npz", small)
    with pytest.raises(mc.OptionError, match=r"a\.npz' has a skeleton; skeleton= is for files of AMASS"):
        mc.read(tmp_path / "a.npz", skeleton=tmp_path / "a.npz")


def test_an_unknown_profile_names_the_known_ones(tmp_path, small):
    with pytest.raises(mc.UnknownName, match=r"no profile of \.npz 'amas'\. Did you mean 'amass'"):
        mc.write(tmp_path / "a.npz", small, profile="amas")
