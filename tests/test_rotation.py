"""Rotations: the laws, a part of the cases at or near the places where formulas break."""

from __future__ import annotations

from itertools import permutations, product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocurve import OptionError, kinematics, read, rotation, unroll

TRIPLES = ["".join(axes) for axes in permutations("XYZ")]
PROPER = ["".join(axes) for axes in product("XYZ", repeat=3) if axes[0] == axes[2] != axes[1]]
tiny = st.sampled_from([0.0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-4, -1e-15, -1e-9, -1e-7])
# half of the angles are a multiple of 90 degrees, or nearly
angle = st.floats(-720, 720) | st.builds(lambda turns, off: 90.0 * turns + off, st.integers(-8, 8), tiny)
triple = st.tuples(angle, angle, angle).map(np.array)
rotations = st.builds(rotation.from_euler, triple, st.just("ZYX"))
vectors = st.tuples(*[st.floats(-10, 10)] * 3).map(np.array)
IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])


def axis_matrix(axis: str, degrees: float) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    matrix = {"X": [[1, 0, 0], [0, c, -s], [0, s, c]], "Y": [[c, 0, s], [0, 1, 0], [-s, 0, c]]}
    return np.array(matrix.get(axis, [[c, -s, 0], [s, c, 0], [0, 0, 1]]))


def same(a: np.ndarray, b: np.ndarray, degrees: float = 1e-9) -> bool:
    return bool((rotation.angle(a, b) <= degrees).all())


# -- quaternions -------------------------------------------------------------------------------------
@given(rotations)
def test_a_rotation_times_its_inverse_is_none(q: np.ndarray) -> None:
    np.testing.assert_allclose(rotation.mul(q, rotation.inv(q)), IDENTITY, atol=1e-14)
    np.testing.assert_allclose(rotation.mul(rotation.inv(q), q), IDENTITY, atol=1e-14)


@given(rotations, rotations, rotations)
def test_products_may_be_bracketed_anyhow(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> None:
    left = rotation.mul(rotation.mul(a, b), c)
    np.testing.assert_allclose(left, rotation.mul(a, rotation.mul(b, c)), atol=1e-14)


@given(rotations, rotations, vectors)
def test_a_product_turns_by_the_second_then_by_the_first(a: np.ndarray, b: np.ndarray, v: np.ndarray) -> None:
    one_by_one = rotation.rotate(a, rotation.rotate(b, v))
    np.testing.assert_allclose(rotation.rotate(rotation.mul(a, b), v), one_by_one, atol=1e-12)


@given(vectors)
def test_the_logarithm_undoes_the_exponential_up_to_a_half_turn(v: np.ndarray) -> None:
    length = np.linalg.norm(v)
    v = v / max(length, 1e-300) * (length % np.pi)
    np.testing.assert_allclose(rotation.log(rotation.exp(v)), v, rtol=1e-12, atol=1e-14)


@given(vectors, st.sampled_from([0.0, 1e-300, 1e-20, 1e-13, 1e-12, 1e-11, 1e-8, 1e-4]))
def test_logarithm_and_exponential_are_exact_near_none_and_near_a_half_turn(v: np.ndarray, off: float) -> None:
    axis = v / max(np.linalg.norm(v), 1e-9) if np.linalg.norm(v) > 1e-6 else np.array([0.0, 0.6, 0.8])
    np.testing.assert_allclose(rotation.log(rotation.exp(axis * off)), axis * off, rtol=1e-12, atol=1e-307)
    half_turn = rotation.exp(axis * (np.pi - off))
    assert np.linalg.norm(rotation.log(half_turn)) == pytest.approx(np.pi - off, rel=1e-14)
    assert same(rotation.exp(rotation.log(half_turn)), half_turn, 1e-12)


@given(rotations)
def test_the_logarithm_goes_the_shorter_way(q: np.ndarray) -> None:
    assert np.linalg.norm(rotation.log(q)) <= np.pi + 1e-12
    assert same(rotation.exp(rotation.log(q)), q)
    assert same(rotation.exp(rotation.log(-q)), q)


@given(rotations, rotations, st.floats(0, 1))
def test_slerp_goes_from_one_to_the_other_at_constant_speed(a: np.ndarray, b: np.ndarray, t: float) -> None:
    between = rotation.slerp(a, b, t)
    assert np.linalg.norm(between) == pytest.approx(1.0, abs=1e-12)
    assert rotation.angle(a, between) == pytest.approx(t * rotation.angle(a, b), abs=1e-6)
    assert same(rotation.slerp(a, b, 0.0), a)
    assert same(rotation.slerp(a, b, 1.0), b)


@pytest.mark.parametrize("off", [0.0, 1e-12, 1e-9, 3e-8, 1e-6])
def test_slerp_between_nearly_equal_rotations_keeps_its_digits(off: float) -> None:
    a, b = rotation.exp(np.array([0.3, 0.0, 0.0])), rotation.exp(np.array([0.3 + off, 0.0, 0.0]))
    turned = rotation.log(rotation.mul(rotation.inv(a), rotation.slerp(a, b, 0.25)))
    np.testing.assert_allclose(turned, [0.25 * off, 0.0, 0.0], atol=1e-15)


def test_slerp_takes_a_time_for_each_rotation() -> None:
    a, b = np.broadcast_to(IDENTITY, (3, 4)), rotation.from_euler(np.full((3, 1), 80.0), "X")
    halfway = rotation.slerp(a, -b, np.array([0.0, 0.5, 1.0]))
    np.testing.assert_allclose(rotation.to_euler(halfway, "X")[:, 0], [0.0, 40.0, 80.0], atol=1e-12)


@given(st.lists(rotations, min_size=1, max_size=8), st.lists(st.booleans(), min_size=8, max_size=8))
def test_unrolled_quaternions_are_the_same_rotations_and_neighbours(qs: list[np.ndarray], flips: list[bool]) -> None:
    q = np.array([-one if flip else one for one, flip in zip(qs, flips, strict=False)])
    unrolled = rotation.unroll(q)
    assert ((unrolled == q).all(axis=1) | (unrolled == -q).all(axis=1)).all()
    assert (np.sum(unrolled[1:] * unrolled[:-1], axis=1) >= 0).all()
    assert (unrolled[0] == q[0]).all()


# -- Euler angles ------------------------------------------------------------------------------------
@pytest.mark.parametrize("order", [*TRIPLES, *PROPER, "X", "ZY", "XXZ", "YXZYXZ", ""])
def test_euler_angles_turn_like_the_product_of_matrices_in_file_order(order: str) -> None:
    angles = np.linspace(-200, 130, len(order))
    matrix = np.eye(3)
    for axis, degrees in zip(order, angles, strict=True):
        matrix = matrix @ axis_matrix(axis, degrees)
    turned = rotation.rotate(rotation.from_euler(angles, order), np.eye(3))
    np.testing.assert_allclose(turned.T, matrix, atol=1e-14)


@pytest.mark.parametrize("order", [*TRIPLES, *PROPER])
@given(angles=triple)
def test_euler_angles_there_and_back_are_the_same_rotation(order: str, angles: np.ndarray) -> None:
    q = rotation.from_euler(angles, order)
    back = rotation.to_euler(q, order)
    assert same(rotation.from_euler(back, order), q)
    assert np.abs(back).max() <= 180.0 + 1e-9
    if order in TRIPLES:
        assert abs(back[1]) <= 90.0 + 1e-9


@pytest.mark.parametrize("order", TRIPLES)
@given(a=st.floats(-179, 179), b=st.floats(-89.9, 89.9), c=st.floats(-179, 179))
def test_euler_angles_away_from_gimbal_lock_come_back(order: str, a: float, b: float, c: float) -> None:
    angles = np.array([a, b, c])
    np.testing.assert_allclose(rotation.to_euler(rotation.from_euler(angles, order), order), angles, atol=1e-9)


@pytest.mark.parametrize(
    ("order", "lock"), [*product(TRIPLES, [90.0, -90.0]), *product(PROPER, [0.0, 180.0])], ids=lambda case: f"{case}"
)
def test_in_gimbal_lock_the_last_angle_is_none(order: str, lock: float) -> None:
    q = rotation.from_euler(np.array([[35.0, lock, -20.0], [170.0, lock, 170.0]]), order)
    angles = rotation.to_euler(q, order)
    np.testing.assert_allclose(angles[:, 2], 0.0, atol=1e-9)
    assert same(rotation.from_euler(angles, order), q)


@pytest.mark.parametrize("order", ["XY", "ZY", "YX", "XZ", "X", "Y", "Z", "", "XX", "XXY", "XYY", "YXZYXZ"])
@given(angles=st.lists(angle, min_size=6, max_size=6).map(np.array))
def test_any_number_of_axes_comes_back_as_the_same_rotation(order: str, angles: np.ndarray) -> None:
    q = rotation.from_euler(angles[: len(order)], order)
    assert same(rotation.from_euler(rotation.to_euler(q, order), order), q)


@pytest.mark.parametrize("order", ["XY", "ZY", "Y", "ZZ"])
@given(q=rotations, other=st.lists(angle, min_size=2, max_size=2).map(np.array))
def test_axes_that_cannot_express_a_rotation_give_the_nearest(order: str, q: np.ndarray, other: np.ndarray) -> None:
    nearest = rotation.from_euler(rotation.to_euler(q, order), order)
    assert rotation.angle(q, nearest) <= rotation.angle(q, rotation.from_euler(other[: len(order)], order)) + 1e-6


def test_batches_have_any_shape() -> None:
    angles = np.random.default_rng(0).uniform(-80, 80, (2, 5, 3))
    q = rotation.from_euler(angles, "YZX")
    assert q.shape == (2, 5, 4)
    np.testing.assert_allclose(rotation.to_euler(q, "YZX"), angles, atol=1e-9)
    np.testing.assert_allclose(rotation.to_euler(3.0 * q[1, 2], "YZX"), angles[1, 2], atol=1e-9)


@pytest.mark.parametrize(
    ("angles", "order"), [(np.zeros((4, 3)), "ZY"), (np.zeros((4, 3)), "ZYW"), (np.array(1.0), "X")]
)
def test_an_order_that_does_not_fit_is_refused(angles: np.ndarray, order: str) -> None:
    for function in (rotation.from_euler, rotation.unroll_euler):
        with pytest.raises(OptionError, match=f"one axis of XYZ for each .*, not {order!r}"):
            function(angles, order)


# -- unrolling ---------------------------------------------------------------------------------------
clip = st.lists(triple, min_size=0, max_size=12).map(lambda rows: np.array(rows).reshape(-1, 3))


def jumps(angles: np.ndarray) -> np.ndarray:
    return np.abs(np.diff(angles, axis=0)).max(axis=1, initial=0.0)


@pytest.mark.parametrize("order", ["ZYX", "XZY", "YXY"])
@given(angles=clip)
def test_unrolling_keeps_every_rotation_and_worsens_no_jump(order: str, angles: np.ndarray) -> None:
    unrolled = rotation.unroll_euler(angles, order)
    assert same(rotation.from_euler(unrolled, order), rotation.from_euler(angles, order))
    assert (jumps(unrolled) <= np.minimum(jumps(angles), 180.0) + 1e-9).all()
    np.testing.assert_array_equal(unrolled[:1], angles[:1])
    # not the angles: a jump of half a turn is as large either way
    np.testing.assert_allclose(jumps(rotation.unroll_euler(unrolled, order)), jumps(unrolled), atol=1e-9)


@given(clip.map(lambda angles: angles * 0.01))
def test_angles_that_do_not_jump_come_back_to_the_last_digit(angles: np.ndarray) -> None:
    np.testing.assert_array_equal(rotation.unroll_euler(angles, "ZXY"), angles)


def test_whole_turns_are_taken_out_exactly() -> None:
    turning = np.linspace(0.0, 2000.0, 100)[:, None]
    wrapped = np.remainder(turning + 180.0, 360.0) - 180.0
    unrolled = rotation.unroll_euler(wrapped, "Y")
    np.testing.assert_allclose(unrolled, turning, atol=1e-9)
    turns = (unrolled - wrapped) / 360.0
    np.testing.assert_array_equal(turns, np.rint(turns))


@pytest.mark.parametrize("order", TRIPLES)
def test_a_way_through_gimbal_lock_is_smooth_again(order: str) -> None:
    through = np.linspace([10.0, 20.0, -30.0], [15.0, 160.0, -25.0], 50)
    wrapped = rotation.to_euler(rotation.from_euler(through, order), order)
    assert jumps(wrapped).max() > 150.0
    np.testing.assert_allclose(rotation.unroll_euler(wrapped, order), through, atol=1e-9)


def test_a_leap_of_the_rotation_itself_exchanges_no_triple() -> None:
    # a T-pose before the motion: the other triple of what follows is a little nearer, and wrong for the whole clip
    angles = np.array([[0.0, 0.0, 0.0], [154.4, -36.8, -111.4], [154.3, -36.9, -111.3]])
    np.testing.assert_array_equal(rotation.unroll_euler(angles, "ZYX"), angles)


@pytest.mark.parametrize(
    ("name", "worst"),
    [("cmu/cmu_135_04_martial_daz", 85), ("other/rokoko_dance_fingers", 32), ("cmu/cmu_12_01_walk", 60)],
)
def test_real_clips_keep_their_rotations_and_lose_their_jumps(clips: Path, name: str, worst: float) -> None:
    motion = read(clips / f"{name}.bvh")[1:]  # most have a T-pose before the motion
    smooth = unroll(motion)
    assert same(kinematics.rotations(smooth), kinematics.rotations(motion))
    assert np.abs(np.diff(smooth.values, axis=0)).max() < worst
