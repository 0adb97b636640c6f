"""The verb `denoise`: jitter, spikes and dropouts of a capture go, kicks and heel strikes stay, nothing is tuned by
hand.

The other half of Önder 2007 (combined filtering and keyframe reduction): what is to be reduced is first freed of what
is no motion.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .. import rotation
from ..errors import Mismatch, OptionError
from ..info import first_frame_is_t_pose, unit_of
from ..measure import compare
from ..measure_noise import Artefact, ChannelNoise, Noise
from ..motion import Clip, Motion
from ..skeleton import Skeleton, matching
from .artefacts import Body, runs
from .cleaning import SHORTEST, Cleaned, bridged, clean

LARGEST = 1e100  # beyond, squares overflow
SPIKE = 2  # frames


def denoise(
    clip: Clip,
    *,
    strength: float = 1.0,
    limit: float | None = None,
    only: str | Sequence[str] = (),
    mark: bool = False,
    drop_t_pose: bool = False,
) -> Motion:
    """The motion without its noise: jitter smoothed away, spikes, dropouts and gaps filled in, displaced parts moved
    back.

    Parameters
    ----------
    clip
        Samples with noise; NaN where a sample is missing.
    strength
        1 is what the data ask for; up to 1.8 takes more out, for sensors whose noise is not white (depth cameras).
    limit
        Frequency in Hz above which nothing is motion; it is taken out whatever the data say.
    only
        Joints or channels to clean, * stands for anything: LeftHand, *Arm, Hips.Yposition. Others stay as they are.
    mark
        Tell the frames that are no motion, but keep them (gaps are filled all the same).
    drop_t_pose
        Take the first frame away where it is a T-pose in front of the motion.

    Returns a Motion whose `report` tells the noise of every channel and every artefact. Errors: OptionError for an
    option's value, UnknownName for a joint, Mismatch for samples beyond 1e100.

    Source: Craven and Wahba 1979 for the strength of smoothing; artefacts by a path that may skip frames are mocurve's
    own, docs/denoise.md tells how.

    >>> walk = mc.denoise(mc.read("walk.bvh"))
    """
    _check(strength, limit, clip.frame_time)
    motion = clip.sample()
    dropped = int(drop_t_pose and first_frame_is_t_pose(motion))
    motion = motion[dropped:]
    chosen = _chosen(motion, [only] if isinstance(only, str) else list(only))
    captured = _unrolled(motion, chosen)
    step = {"verb": "denoise", "strength": strength, "limit": limit, "only": only, "mark": mark}
    values = np.array(captured.values, order="F")
    told: tuple[list[ChannelNoise], list[Artefact], int] = ([], [], 0)
    live = np.flatnonzero(_live(captured, chosen))
    if len(live):
        body = captured.skeleton
        groups, pools = _groups(body, live), _pools(body, live)
        limits = Body.of_degrees(len(live), 1 / captured.frame_time)
        limits = limits.in_lengths(~body.rotation_channels[live], _metres(captured))
        data = captured.values[:, live]
        turns = _turns(captured, live, groups)
        options = {"pools": pools, "body": limits, "turns": turns, "strength": strength, "limit": limit}
        cleaned = clean(data, 1 / captured.frame_time, groups, **options)  # type: ignore[arg-type]
        kept = cleaned.masked & ~cleaned.lost if mark else np.zeros(cleaned.masked.shape, bool)
        for channel, first, last, by in cleaned.offsets if mark else ():
            cleaned.values[first:last, channel] += by
        values[:, live] = np.where(kept, data, cleaned.values)
        told = (
            _channels(body, live, cleaned, captured.frame_time),
            _artefacts(body, live, cleaned),
            cleaned.masked.sum(),
        )
    values = _few_filled(values, captured)
    made = replace(captured, values=values, history=(*clip.history, {**step, "drop_t_pose": drop_t_pose}), report=None)
    before = replace(captured, values=np.where(np.isfinite(captured.values), captured.values, values), report=None)
    report = compare(before, made)
    noise = Noise(tuple(told[0]), tuple(told[1]), int(told[2]), mark, dropped, before)
    return replace(made, report=replace(report, clips=(before, made), noise=noise))


# -- in call order ---------------------------------------------------------------------------------


def _check(strength: float, limit: float | None, frame_time: float) -> None:
    if not (isinstance(strength, int | float) and 0.5 <= strength <= 4.0):
        raise OptionError(f"strength is a number from 0.5 to 4, 1 is what the data ask for, not {strength!r}")
    if limit is not None and not (isinstance(limit, int | float) and 0 < limit < 0.5 / frame_time):
        raise OptionError(f"limit is a frequency in Hz below {0.5 / frame_time:g}, half the frame rate, not {limit!r}")


def _chosen(motion: Motion, names: Sequence[str]) -> np.ndarray:
    """(C,) the channels to clean."""
    skeleton = motion.skeleton
    chosen = np.full(skeleton.channel_count, not names)
    owners = [skeleton.names[joint] for joint in skeleton.channel_joints]
    for name in names:
        chosen[matching(name, skeleton.channel_names, owners, "joint or channel")] = True
    return chosen


def _unrolled(motion: Motion, chosen: np.ndarray) -> Motion:
    """The rotations of joints with a chosen channel without jumps of notation, looking past missing samples."""
    values = np.array(motion.values, order="F")
    bad = ~(np.abs(values) <= LARGEST) & ~np.isnan(values)
    if bad.any():
        frame, channel = np.argwhere(bad)[0]
        name, value = motion.skeleton.channel_names[channel], values[frame, channel]
        raise Mismatch(f"channel {name!r} has the value {value} at frame {frame}: that is no motion")
    first = 0
    for kinds in motion.skeleton.channels:
        turning = [first + i for i, kind in enumerate(kinds) if kind.endswith("rotation")]
        order = "".join(kinds[k - first][0] for k in turning)
        first += len(kinds)
        there = np.isfinite(values[:, turning]).all(1)
        if turning and chosen[turning].any() and there.sum() > 1:
            values[np.ix_(there, turning)] = rotation.unroll_euler(values[np.ix_(there, turning)], order)
    return replace(motion, values=values)


def _live(motion: Motion, chosen: np.ndarray) -> np.ndarray:
    """(C,) chosen channels that move and have enough samples to tell noise from motion."""
    values = motion.values
    if not motion.frames:
        return np.zeros(values.shape[1], bool)
    there = np.isfinite(values)
    for channel in np.flatnonzero(chosen & ~there.any(0)):
        warnings.warn(f"{motion.skeleton.channel_names[channel]} has no sample at all and stays empty", stacklevel=3)
    low = np.where(there, values, np.inf).min(0)
    high = np.where(there, values, -np.inf).max(0)
    return chosen & (there.sum(0) >= SHORTEST) & (high > low)


def _groups(skeleton: Skeleton, live: np.ndarray) -> list[np.ndarray]:
    """Places in `live` of the channels of each joint, rotations and positions apart."""
    owner = skeleton.channel_joints[live] * 2 + skeleton.rotation_channels[live]
    return [np.flatnonzero(owner == one) for one in np.unique(owner)]


def _pools(skeleton: Skeleton, live: np.ndarray) -> list[np.ndarray]:
    turning = skeleton.rotation_channels[live]
    return [np.flatnonzero(turning), np.flatnonzero(~turning)]


def _turns(motion: Motion, live: np.ndarray, groups: list[np.ndarray]) -> np.ndarray:
    """(groups, F) second difference of the rotation of a group's joint, degrees; -1 for positions."""
    body, values = motion.skeleton, bridged(motion.values.T, ~np.isfinite(motion.values.T))
    turns = np.full((len(groups), motion.frames), -1.0)
    for group, turn in zip(groups, turns, strict=True):
        joint = body.channel_joints[live[group[0]]]
        turning = np.flatnonzero((body.channel_joints == joint) & body.rotation_channels)
        if not body.rotation_channels[live[group[0]]]:
            continue
        order = "".join("XYZ"[axis] for axis in body.channel_axes[turning])
        q = rotation.from_euler(values[turning].T, order)
        steps = rotation.log(rotation.mul(rotation.inv(q[:-1]), q[1:]))
        turn[:] = 0.0
        turn[1:-1] = np.degrees(np.linalg.norm(np.diff(steps, axis=0), axis=1))
    return turns


def _metres(motion: Motion) -> float | None:
    try:
        return unit_of(motion).metres
    except OptionError:  # a body without height
        return None


def _channels(skeleton: Skeleton, live: np.ndarray, found: Cleaned, frame_time: float) -> list[ChannelNoise]:
    rows = []
    for place, channel in enumerate(live):
        unit = "degrees" if skeleton.rotation_channels[channel] else "units"
        hertz = float(found.cutoff[place] / frame_time)
        sigma, floor = float(found.sigma[place]), bool(found.floor[place])
        rows.append(ChannelNoise(skeleton.channel_names[channel], unit, sigma, floor, hertz))
    return rows


def _artefacts(skeleton: Skeleton, live: np.ndarray, found: Cleaned) -> list[Artefact]:
    """Runs of masked frames, those of a joint's channels at the same frames as one, and offsets."""
    joints, names = skeleton.channel_joints[live], [skeleton.channel_names[channel] for channel in live]
    rows: dict[tuple[int, str, int, int], list[str]] = {}
    plain = found.masked & ~found.lost & ~found.frozen
    for place, joint in enumerate(joints):
        for kind, marked in (("lost", found.lost), ("frozen", found.frozen), ("run", plain)):
            for first, last in runs(marked[:, place]):
                told = "spike" if kind == "run" and last - first <= SPIKE else kind
                rows.setdefault((int(joint), told, first, last - 1), []).append(names[place])
    made = [
        Artefact(skeleton.names[joint], tuple(channels), kind, first, last)
        for (joint, kind, first, last), channels in rows.items()
    ]
    made += [
        Artefact(skeleton.names[joints[channel]], (names[channel],), "offset", first, last - 1, by)
        for channel, first, last, by in found.offsets
    ]
    return sorted(made, key=lambda row: (row.first, row.joint))


def _few_filled(values: np.ndarray, motion: Motion) -> np.ndarray:
    """Gaps of channels with too few samples to be cleaned: straight lines."""
    frames = np.arange(len(values))
    for channel in np.flatnonzero(~np.isfinite(values).all(0)):
        there = np.isfinite(motion.values[:, channel])
        if there.any():
            values[:, channel] = np.interp(frames, frames[there], motion.values[there, channel])
    return values
