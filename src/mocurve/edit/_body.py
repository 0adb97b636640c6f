"""Motion taken elsewhere and its legs set anew, channel by channel: what is not changed keeps its last digit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from .. import planar, rotation
from ..errors import Mismatch
from ..feet.contacts import runs
from ..kinematics import EXPRESSIBLE_DEGREES, world_rotations
from ..motion import Motion
from ..skeleton import Skeleton


def carried(motion: Motion, carry: np.ndarray) -> Motion:
    """The motion with the root of each frame taken elsewhere by a planar transform (F, 3): angle, x, z in file units.

    Frames whose transform does nothing keep their values. Mismatch where a root has no channels to go or turn by.
    """
    if not carry.any():
        return motion
    skeleton, values = motion.skeleton, np.array(motion.values, order="F")
    moves, turns = np.flatnonzero(carry.any(axis=1)), carry[:, 0] != 0
    for root in np.flatnonzero(skeleton.parents < 0).tolist():
        if root not in skeleton.parents and not skeleton.channels[root]:
            continue
        columns, order = skeleton.eulers[root]
        shifts = shifting(skeleton, root)
        lacking = "position" if shifts is None else "rotation" if turns.any() and len(columns) < 3 else None
        if lacking is not None and root in skeleton.parents:
            raise Mismatch(
                f"the root {skeleton.names[root]!r} lacks {lacking} channels, so it cannot be taken elsewhere"
            )
        if shifts is not None:
            values[moves[:, None], shifts] = planar.move(carry[moves], values[moves[:, None], shifts])
        if len(columns) < 3:
            continue
        turned = rotation.mul(planar.quaternion(carry), rotation.from_euler(motion.values[:, columns], order))
        angles = rotation.to_euler(turned, order)
        if (rotation.angle(rotation.from_euler(angles, order), turned) > EXPRESSIBLE_DEGREES).any():
            raise Mismatch(
                f"the rotation channels of the root {skeleton.names[root]!r} cannot turn it about the vertical"
            )
        for first, end in runs(turns):
            before = values[max(first - 1, 0), columns]
            values[first:end, columns] = rotation.unroll_euler(np.vstack([before, angles[first:end]]), order)[1:]
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
    for place, wxyz in turns.items():
        own, order = skeleton.eulers[place]
        if own:
            before = values[frames[:, None], own]
            values[frames[:, None], own] = rotation.near_euler(rotation.to_euler(wxyz, order), order, before)
    return replace(motion, values=values, report=None)
