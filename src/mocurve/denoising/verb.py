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
        Joints or channels to clean, * stands for anything: LeftHand, *Arm, Hips.Yposition. Others stay as they are, but
        the rotations of one joint are written without jumps together.
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
    _check_values(motion)
    dropped = int(drop_t_pose and first_frame_is_t_pose(replace(motion, values=_filled(motion.values))))
    names = [only] if isinstance(only, str) else list(only)
    chosen = _chosen(motion, names)
    captured = _unrolled(motion[dropped:], chosen)
    live, few = _live(captured, chosen)
    values = np.array(captured.values, order="F")
    values[:, few] = _filled(values[:, few])
    missing = np.isnan(captured.values[:, few])
    rows: list[ChannelNoise] = []
    artefacts, samples = _artefacts(captured.skeleton, few, {"lost": missing}), missing.sum()
    if len(live):
        found = _cleaned(captured, live, strength, limit)
        values[:, live] = _marked(captured.values[:, live], found) if mark else found.values
        rows = _channels(captured.skeleton, live, found, captured.frame_time)
        plain = found.masked & ~found.lost & ~found.frozen
        kinds = {"lost": found.lost, "frozen": found.frozen, "run": plain}
        artefacts += _artefacts(captured.skeleton, live, kinds) + _offsets(captured.skeleton, live, found)
        samples += found.masked.sum()
    artefacts.sort(key=lambda row: (row.first, row.joint))
    step = {"strength": strength, "limit": limit, "only": only if isinstance(only, str) else names}
    step |= {"mark": mark, "drop_t_pose": drop_t_pose}
    made = replace(captured, values=values, history=(*clip.history, {"verb": "denoise", **step}), report=None)
    before = replace(captured, values=np.where(np.isnan(captured.values), values, captured.values), report=None)
    report = compare(*(replace(one, values=np.nan_to_num(one.values)) for one in (before, made)))
    noise = Noise(tuple(rows), tuple(artefacts), int(samples), mark, dropped, before)
    return replace(made, report=replace(report, clips=(before, made), noise=noise))


# -- in call order ---------------------------------------------------------------------------------


def _check(strength: float, limit: float | None, frame_time: float) -> None:
    if not (isinstance(strength, int | float) and 0.5 <= strength <= 4.0):
        raise OptionError(f"strength is a number from 0.5 to 4, 1 is what the data ask for, not {strength!r}")
    if limit is not None and not (isinstance(limit, int | float) and 0 < limit < 0.5 / frame_time):
        raise OptionError(f"limit is a frequency in Hz below {0.5 / frame_time:g}, half the frame rate, not {limit!r}")


def _check_values(motion: Motion) -> None:
    bad = ~(np.abs(motion.values) <= LARGEST) & ~np.isnan(motion.values)
    if bad.any():
        frame, channel = np.argwhere(bad)[0]
        name, value = motion.skeleton.channel_names[channel], motion.values[frame, channel]
        raise Mismatch(f"channel {name!r} has the value {value} at frame {frame}: that is no motion")


def _filled(values: np.ndarray) -> np.ndarray:
    """(F, C) with straight lines over missing samples; a channel without any other stays."""
    return bridged(values.T, np.isnan(values.T)).T


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
    for turning, order in motion.skeleton.eulers:
        there = np.isfinite(values[:, turning]).all(1)
        if turning and chosen[turning].any() and there.sum() > 1:
            values[np.ix_(there, turning)] = rotation.unroll_euler(values[np.ix_(there, turning)], order)
    return replace(motion, values=values)


def _live(motion: Motion, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Chosen channels that move and have enough samples to tell noise from motion; others that have gaps."""
    values = motion.values
    if not motion.frames:
        return np.zeros(0, int), np.zeros(0, int)
    there = np.isfinite(values)
    for channel in np.flatnonzero(chosen & ~there.any(0)):
        warnings.warn(f"{motion.skeleton.channel_names[channel]} has no sample at all and stays empty", stacklevel=3)
    low = np.where(there, values, np.inf).min(0)
    high = np.where(there, values, -np.inf).max(0)
    live = chosen & (there.sum(0) >= SHORTEST) & (high > low)
    return np.flatnonzero(live), np.flatnonzero(chosen & ~live & there.any(0) & ~there.all(0))


def _cleaned(motion: Motion, live: np.ndarray, strength: float, limit: float | None) -> Cleaned:
    body, fps = motion.skeleton, 1 / motion.frame_time
    groups, pools = _groups(body, live), _pools(body, live)
    limits = Body.of_degrees(len(live), fps).in_lengths(~body.rotation_channels[live], _metres(motion))
    data, turns = motion.values[:, live], _turns(motion, live, groups)
    return clean(data, fps, groups, pools=pools, body=limits, turns=turns, strength=strength, limit=limit)


def _groups(skeleton: Skeleton, live: np.ndarray) -> list[np.ndarray]:
    """Places in `live` of the channels of each joint, rotations and positions apart."""
    owner = skeleton.channel_joints[live] * 2 + skeleton.rotation_channels[live]
    return [np.flatnonzero(owner == one) for one in np.unique(owner)]


def _pools(skeleton: Skeleton, live: np.ndarray) -> list[np.ndarray]:
    turning = skeleton.rotation_channels[live]
    return [np.flatnonzero(turning), np.flatnonzero(~turning)]


def _turns(motion: Motion, live: np.ndarray, groups: list[np.ndarray]) -> np.ndarray:
    """(groups, F) second difference of the rotation of a group's joint, degrees; -1 for positions."""
    body, values = motion.skeleton, _filled(motion.values)
    turns = np.full((len(groups), motion.frames), -1.0)
    for group, turn in zip(groups, turns, strict=True):
        joint = body.channel_joints[live[group[0]]]
        turning = np.flatnonzero((body.channel_joints == joint) & body.rotation_channels)
        if not body.rotation_channels[live[group[0]]]:
            continue
        order = "".join("XYZ"[axis] for axis in body.channel_axes[turning])
        q = rotation.from_euler(values[:, turning], order)
        steps = rotation.log(rotation.mul(rotation.inv(q[:-1]), q[1:]))
        turn[:] = 0.0
        turn[1:-1] = np.degrees(np.linalg.norm(np.diff(steps, axis=0), axis=1))
    return turns


def _metres(motion: Motion) -> float | None:
    try:
        return unit_of(motion).metres
    except OptionError:  # a body without height
        return None


def _marked(captured: np.ndarray, found: Cleaned) -> np.ndarray:
    """The clean values (F, C) with the artefacts as they were; gaps are filled all the same."""
    values = found.values.copy()
    for channel, first, last, by in found.offsets:
        values[first:last, channel] += by
    return np.where(found.masked & ~found.lost, captured, values)


def _channels(skeleton: Skeleton, live: np.ndarray, found: Cleaned, frame_time: float) -> list[ChannelNoise]:
    rows = []
    for place, channel in enumerate(live):
        unit = "degrees" if skeleton.rotation_channels[channel] else "units"
        hertz = None if found.cutoff[place] >= 0.5 else float(found.cutoff[place] / frame_time)
        sigma, floor = float(found.sigma[place]), bool(found.floor[place])
        rows.append(ChannelNoise(skeleton.channel_names[channel], unit, sigma, floor, hertz))
    return rows


def _artefacts(skeleton: Skeleton, channels: np.ndarray, marked: dict[str, np.ndarray]) -> list[Artefact]:
    """Runs of frames (F, C) marked by kind, those of a joint's channels at the same frames as one."""
    joints, named = skeleton.channel_joints, skeleton.channel_names
    rows: dict[tuple[int, str, int, int], list[str]] = {}
    for place, channel in enumerate(channels):
        for kind, frames in marked.items():
            for first, last in runs(frames[:, place]):
                told = "spike" if kind == "run" and last - first <= SPIKE else kind
                of = (int(joints[channel]), told, first, last - 1)
                rows.setdefault(of, []).append(named[channel])
    return [Artefact(skeleton.names[of[0]], tuple(names), *of[1:]) for of, names in rows.items()]


def _offsets(skeleton: Skeleton, live: np.ndarray, found: Cleaned) -> list[Artefact]:
    joints, names = skeleton.channel_joints[live], [skeleton.channel_names[channel] for channel in live]
    return [
        Artefact(skeleton.names[joints[place]], (names[place],), "offset", first, last - 1, by)
        for place, first, last, by in found.offsets
    ]
