"""Motion taken elsewhere and its legs set anew, channel by channel: what is not changed keeps its last digit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise

import numpy as np

from .. import planar, rotation
from ..errors import Mismatch
from ..feet.contacts import runs
from ..kinematics import EXPRESSIBLE_DEGREES, world_rotations
from ..motion import Motion
from ..skeleton import Skeleton


def carried(motion: Motion, carry: np.ndarray, lift: np.ndarray | None = None) -> Motion:
    """The motion with the roots of each frame taken elsewhere by a planar transform (F, 3), angle, x, z in file units,
    and lifted by (F,).

    Frames for which nothing is asked keep their values. Mismatch where a root has no channels to go or turn by.
    """
    up = np.zeros(len(carry)) if lift is None else lift
    asked = np.flatnonzero(carry.any(axis=1) | (up != 0))
    if not len(asked):
        return replace(motion, report=None)
    skeleton, values = motion.skeleton, np.array(motion.values, order="F")
    whole = len(asked) == np.ptp(asked) + 1
    moves: slice | np.ndarray = slice(int(asked[0]), int(asked[-1]) + 1) if whole else asked
    carry, up, eulers = carry[moves], up[moves], skeleton.eulers
    for root in np.flatnonzero(skeleton.parents < 0).tolist():
        if root not in skeleton.parents and not skeleton.channels[root]:
            continue
        columns, order = eulers[root]
        shifts = shifting(skeleton, root)
        turning = bool(carry[:, 0].any())
        lacking = "position" if shifts is None else "rotation" if turning and len(columns) < 3 else None
        if lacking is not None and root in skeleton.parents:
            raise Mismatch(
                f"the root {skeleton.names[root]!r} lacks {lacking} channels, so it cannot be taken elsewhere"
            )
        if shifts is not None:
            for axis, there in zip(shifts, planar.move(carry, values[moves][:, shifts]).T, strict=True):
                values[moves, axis] = there
            values[moves, shifts[1]] += up
        if turning and len(columns) == 3:
            _turn(values, motion, (root, columns, order), np.arange(len(values))[moves], carry)
    return replace(motion, values=values, report=None)


def shifting(skeleton: Skeleton, joint: int) -> list[int] | None:
    """Columns of a joint's X, Y and Z position channels, None where it lacks one."""
    own = np.flatnonzero((skeleton.channel_joints == joint) & ~skeleton.rotation_channels)
    places = {int(skeleton.channel_axes[column]): int(column) for column in own}
    return [places[axis] for axis in range(3)] if len(places) == 3 else None


def bearer(skeleton: Skeleton, joint: int) -> int:
    """The joint itself or the nearest above it that has position channels for all axes; Mismatch where none has."""
    place = joint
    while place >= 0:
        if shifting(skeleton, place) is not None:
            return place
        place = int(skeleton.parents[place])
    raise Mismatch(
        f"no joint above {skeleton.names[joint]!r} has position channels: the body cannot be moved to its feet"
    )


def set_anew(
    motion: Motion, joint: int, shift: np.ndarray, turns: Mapping[int, np.ndarray], frames: np.ndarray
) -> Motion:
    """The motion with other poses at some frames (N,): `joint` moved by shifts (N, 3) in the world, file units, and the
    rotations (N, 4) wxyz of some joints against their parents.

    Angles are written as near as they can be to those that were there.
    """
    skeleton, values = motion.skeleton, np.array(motion.values, order="F")
    columns = shifting(skeleton, joint)
    parent = int(skeleton.parents[joint])
    if parent >= 0:
        above = world_rotations(replace(motion, values=motion.values[frames]), [parent])[:, 0]
        shift = rotation.rotate(rotation.inv(above), shift)
    values[frames[:, None], columns] += shift
    eulers = skeleton.eulers
    for place, wxyz in turns.items():
        own, order = eulers[place]
        if own:
            before = values[frames[:, None], own]
            values[frames[:, None], own] = rotation.near_euler(rotation.to_euler(wxyz, order), order, before)
    return replace(motion, values=values, report=None)


# -- in call order ---------------------------------------------------------------------------------


def _turn(
    values: np.ndarray, motion: Motion, joint: tuple[int, list[int], str], frames: np.ndarray, carry: np.ndarray
) -> None:
    """Turn a root (with its columns and their order) in `values` about the vertical, at frames (N,) by carries (N, 3),
    where these do."""
    root, columns, order = joint
    turns = carry[:, 0] != 0
    before = motion.values[frames][:, columns]
    turned = rotation.mul(planar.quaternion(carry), rotation.from_euler(before, order))
    angles = rotation.to_euler(turned, order)
    if (rotation.angle(rotation.from_euler(angles, order), turned)[turns] > EXPRESSIBLE_DEGREES).any():
        raise Mismatch(
            f"the rotation channels of the root {motion.skeleton.names[root]!r} cannot turn it about the vertical"
        )
    jumps = np.diff(frames, prepend=frames[0] - 1) > 1
    for first, end in runs(turns):
        for start, stop in pairwise([first, *(first + np.flatnonzero(jumps[first:end][1:]) + 1).tolist(), end]):
            last = values[max(frames[start] - 1, 0), columns]
            unrolled = rotation.unroll_euler(np.vstack([last, angles[start:stop]]), order)[1:]
            for column, angle in zip(columns, unrolled.T, strict=True):
                values[frames[start:stop], column] = angle
