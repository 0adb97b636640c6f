"""The promise in space, by exact tubes: no point of the body leaves its limit at any frame, and few keys are left.

Turning one channel moves all that hangs on it on circles, so at each frame the changes of a channel that keep every
point within its limit are an interval with a closed form: the channel's tube, given all other channels as they are.
Each channel starts alone in a share of what its lever arm allows. Then rounds, leaves first: draw every curve to the
middle of its tube (children make up for their parents' error), and find fewer keys inside the tube. Every step goes
from curves inside their tubes to curves inside their tubes, so the promise holds all the time. How far a channel may
stray grows from round to round, lest one takes all the room early.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import NamedTuple

import numpy as np

from .. import progress
from ..errors import OptionError
from ..kinematics import rest_height, rest_offsets
from ..motion import Motion
from ._scene import Scene, centre, prune, put, sampled, tube
from ._tubes import Body, pose, reach_of_limits, worst_of_limits
from .keys import Keys
from .tolerance import Limits

SHELL = 0.05  # of the rest height: how far from its bone a joint's shell points lie, so that twist counts
RESERVE = 1e-5  # part of every limit kept for rounding, that of a file with six decimals included
SHARE = 0.15  # of what a channel's lever arm allows: where it starts
LEAST_SHARE = 1e-9  # below, a limit of nothing is asked: the check of the promise gives every frame its key
REST = 1  # rounds that a group is left alone after one that found nothing

Solve = Callable[[np.ndarray, np.ndarray, str], Keys]  # middle, half (M, F), quality
Better = Callable[[Keys, np.ndarray, np.ndarray], Keys]  # keys, middle, half (M, F)
Tube = tuple[np.ndarray, np.ndarray]  # middle and half-width (M, F)


class Round(NamedTuple):
    """One round of the search."""

    stray: float  # how far a channel may be from its original, in what its lever arm allows it
    sweeps: int  # towards the middle of the tubes, before the search
    search: str  # quality of the search for fewer keys


ROUNDS = {
    "fast": [Round(0.45, 1, "fast"), Round(1.2, 1, "default"), Round(2.4, 1, "default")],
    "default": [Round(0.4, 2, "fast"), Round(1.6, 2, "default"), *[Round(2.4, 2, "good")] * 4],
    "good": [*(Round(stray, 3, "good") for stray in (0.3, 0.6, 1.2)), *[Round(2.4, 3, "good")] * 6],
    "best": [*(Round(stray, 4, "best") for stray in (0.3, 0.6, 1.2)), *[Round(2.4, 4, "best")] * 12],
}


def body_of(motion: Motion, shell: float = SHELL) -> Body:
    """The skeleton as flat arrays for the kernels. A joint that turns carries shell points beside its bone."""
    skeleton = motion.skeleton
    count, joint = len(skeleton.names), skeleton.channel_joints
    moving = np.zeros(count, bool)
    if motion.frames:
        live = (np.ptp(motion.values, axis=0) > 0.0) & skeleton.rotation_channels
        moving[joint[live]] = True
    offsets, radius = rest_offsets(motion), shell * rest_height(motion)
    places: list[np.ndarray] = []
    first_point = [0]
    for j in range(count):
        places.append(np.zeros(3))
        if moving[j] and radius > 0.0:
            bone = offsets[skeleton.parents == j].sum(axis=0)
            # a bone as long as the radius feels every turn but that about itself, which one point beside it feels
            enough = 1 if np.linalg.norm(bone) >= radius else 2
            places += [side * radius for side in _across(bone)[:enough]]
        first_point.append(len(places))
    first_channel = np.concatenate([[0], np.cumsum([len(kinds) for kinds in skeleton.channels], dtype=np.int64)])
    last_channel, last_point = first_channel[1:].copy(), np.array(first_point[1:])
    for j in range(count - 1, -1, -1):
        parent = skeleton.parents[j]
        if parent >= 0:
            last_channel[parent] = max(last_channel[parent], last_channel[j])
            last_point[parent] = max(last_point[parent], last_point[j])
    return Body(
        skeleton.parents.copy(),
        skeleton.offsets.copy(),
        first_channel,
        last_channel,
        np.array(first_point),
        last_point,
        np.array(places).reshape(-1, 3),
        joint,
        skeleton.rotation_channels,
        skeleton.channel_axes,
    )


def _across(bone: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors square to a bone (3,) and to each other; a joint without a bone counts as pointing up."""
    length = np.linalg.norm(bone)
    along = bone / length if length > 1e-9 else np.array([0.0, 1.0, 0.0])
    side = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    side /= np.linalg.norm(side)
    return side, np.cross(along, side)


def point_limits(body: Body, joints: np.ndarray) -> np.ndarray:
    """(F, P) the limit of every point from those of the joints (J, F): shell points share their joint's.

    A joint that never leaves its parent's place adds nothing where it may move as far as the parent: inf.
    """
    owner = np.repeat(np.arange(len(body.parents)), np.diff(body.first_point))
    limits = joints.T[:, owner].copy()
    placed = np.zeros(len(body.parents), bool)
    placed[body.joint[~body.rotates]] = True
    for j, parent in enumerate(body.parents):
        if parent >= 0 and not placed[j] and not body.offsets[j].any() and (joints[j] >= joints[parent]).all():
            limits[:, body.first_point[j]] = np.inf
    return limits


def scene_of(motion: Motion, limits: Limits) -> Scene:
    """The clip with its curves as they were given."""
    assert limits.joints is not None
    body = body_of(motion)
    original = np.ascontiguousarray(motion.values.T)
    target = np.empty((motion.frames, 3, len(body.shell)))
    axes = np.zeros((motion.frames, 3, len(original)))
    pose(body, original.T, target, axes)
    allowed = point_limits(body, limits.joints) * (1.0 - RESERVE)
    return Scene(body, original, original.copy(), target, target.copy(), axes, allowed)


def allowance(scene: Scene, floor: float) -> np.ndarray:
    """(C, F) how far each channel alone may go from its original, to first order, no lever arm shorter than `floor`."""
    alone = np.empty_like(scene.original)
    for k in range(len(alone)):
        reach_of_limits(scene.body, k, scene.target, scene.axes, scene.limits, floor, alone[k])
    return alone


def take(scene: Scene, groups: list[np.ndarray], keys: list[Keys]) -> float:
    """Make these the curves of the scene; returns how far its worst point is from its target, in limits."""
    for group, found in zip(groups, keys, strict=True):
        for member, k in enumerate(group):
            scene.samples[k] = samples_of(found, member, scene.samples.shape[1])
    pose(scene.body, scene.samples.T, scene.points, scene.axes)
    return float(worst_of_limits(scene.points, scene.target, scene.limits))


def samples_of(keys: Keys, member: int, frames: int) -> np.ndarray:
    """Samples (F,) of one member's curve."""
    out = np.empty(frames)
    arriving = keys.slopes if keys.in_slopes is None else keys.in_slopes
    sampled(keys.frames, keys.values[member], keys.slopes[member], arriving[member], out)
    return out


def fit(
    motion: Motion, groups: list[np.ndarray], limits: Limits, solve: Solve, again: bool, quality: str
) -> tuple[list[Keys], list[Tube]]:
    """Keys for groups of channels (each shares its key times) that keep every joint and every channel in its limits.

    solve: a method's; again: whether it is to be run again inside the tubes in every round. Returns with each group's
    keys the tube that it ended with: how far its channels might still go, all others as they are."""
    scene, alone, cap = problem(motion, limits)
    parts = limbs(motion, groups)
    rest = np.zeros(len(groups), int)  # rounds for which a group is left alone, after a search in vain

    def search(step: Round, near: np.ndarray, g: int) -> None:
        rest[g] -= 1
        before = len(keys[g].frames)
        if before <= 2 or rest[g] >= 0:
            return
        if again:
            keys[g] = _search(scene, groups[g], keys[g], near, solve, step.search)
        if not again or len(groups[g]) > 1:  # what a search inside the tubes leaves, taking out keys does not improve
            keys[g] = _prune(scene, groups[g], keys[g], near)
        if len(keys[g].frames) == before:
            rest[g] = REST

    with ThreadPoolExecutor(cores()) as threads:
        keys = _start(scene, groups, alone, cap, solve, threads)
        for number, step in enumerate(ROUNDS[quality]):
            progress.advance("fitting inside the tubes", number, len(ROUNDS[quality]))
            near = np.minimum(step.stray * alone, cap)
            for _ in range(step.sweeps):
                _side_by_side(threads, parts, partial(_centre, scene, groups, keys, near))
            _side_by_side(threads, parts, partial(search, step, near))
        progress.advance("fitting inside the tubes", len(ROUNDS[quality]), len(ROUNDS[quality]))
    return keys, [tubes(scene, group, cap) for group in groups]


def cores() -> int:
    """Processor cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def limbs(motion: Motion, groups: list[np.ndarray]) -> list[list[int]]:
    """The groups by number, leaves first: of each limb, and last of the trunk. No two limbs move a point in common.

    A limb is all that hangs on a joint, with at most a third of all channels; a group over several limbs is trunk's."""
    skeleton = motion.skeleton
    owners = skeleton.channel_joints
    below = np.bincount(owners, minlength=len(skeleton.names))
    for joint in range(len(below) - 1, 0, -1):
        if skeleton.parents[joint] >= 0:
            below[skeleton.parents[joint]] += below[joint]
    limb = np.full(len(below), -1)
    for joint, parent in enumerate(skeleton.parents):
        if parent >= 0 and limb[parent] >= 0:
            limb[joint] = limb[parent]
        elif 3 * below[joint] <= len(owners):
            limb[joint] = joint
    parts: dict[int, list[int]] = {-1: []}
    for g in range(len(groups) - 1, -1, -1):
        of_group = np.unique(limb[owners[groups[g]]])
        parts.setdefault(int(of_group[0]) if len(of_group) == 1 else -1, []).append(g)
    return [*(part for joint, part in parts.items() if joint >= 0), parts[-1]]


def _side_by_side(threads: ThreadPoolExecutor, parts: list[list[int]], work: Callable[[int], None]) -> None:
    """work(g) for every group: limbs in threads, then the trunk. The result is the same however the threads run."""

    def in_turn(part: list[int]) -> None:
        for g in part:
            work(g)

    for running in [threads.submit(in_turn, part) for part in parts[:-1]]:
        running.result()
    in_turn(parts[-1])


def problem(motion: Motion, limits: Limits) -> tuple[Scene, np.ndarray, np.ndarray]:
    """The scene, and (C, F) twice how far a channel may go from its original: by its lever arm, by its own limit."""
    scene = scene_of(motion, limits)
    alone = allowance(scene, 0.5 * SHELL * rest_height(motion))
    cap = limits.channels * (1.0 - RESERVE)
    _refuse_unlimited(motion, alone, cap)
    # where nothing limits a constant channel its tube still has ends
    return scene, alone, np.minimum(cap, np.ptp(scene.original, axis=1, keepdims=True) + 180.0)


def polish(motion: Motion, groups: list[np.ndarray], limits: Limits, keys: list[Keys], better: Better) -> list[Keys]:
    """The keys, group after group made better inside its tube: better(keys, middle, half) -> Keys, with as many keys.
    As they are where the limits do not hold to begin with. Groups of several channels are left: their tubes hold for
    one channel at a time."""
    scene, _, cap = problem(motion, limits)
    if take(scene, groups, keys) > 1.0:
        return keys
    polished = list(keys)
    for g in range(len(groups) - 1, -1, -1):
        if len(groups[g]) == 1:
            polished[g] = better(keys[g], *tubes(scene, groups[g], cap))
            put(scene, groups[g][0], samples_of(polished[g], 0, motion.frames), 0, motion.frames)
    return polished


def ended_with(motion: Motion, groups: list[np.ndarray], limits: Limits, keys: list[Keys]) -> list[Tube]:
    """The tubes of groups that have these keys; bands where no joint is limited."""
    if limits.joints is None:
        return [(np.ascontiguousarray(motion.values.T[group]), limits.channels[group]) for group in groups]
    scene, _, cap = problem(motion, limits)
    take(scene, groups, keys)
    return [tubes(scene, group, cap) for group in groups]


def tubes(scene: Scene, group: np.ndarray, near: np.ndarray) -> Tube:
    """Middle and half-width (M, F) of the tubes of a group's channels, each given all others as they are."""
    frames = scene.samples.shape[1]
    middle, half = np.empty((len(group), frames)), np.empty((len(group), frames))
    for member, k in enumerate(group):
        tube(scene, k, near, 0, frames, middle[member], half[member])
    return middle, half


def _start(
    scene: Scene,
    groups: list[np.ndarray],
    alone: np.ndarray,
    cap: np.ndarray,
    solve: Solve,
    threads: ThreadPoolExecutor,
) -> list[Keys]:
    """Every group in a share of its allowance, which is lowered until the promise holds."""
    share = SHARE
    while True:
        room = np.minimum(share * alone, cap)
        samples, bands = [scene.original[group] for group in groups], [room[group] for group in groups]
        keys = list(threads.map(partial(group_keys, solve=solve, quality="fast"), samples, bands))
        worst = take(scene, groups, keys)
        if worst <= 1.0 or share < LEAST_SHARE:
            return keys
        share = max(
            share * 0.9 / worst, np.finfo(float).tiny
        )  # at 0 what has no limit would have none that is a number


def _centre(scene: Scene, groups: list[np.ndarray], keys: list[Keys], near: np.ndarray, g: int) -> None:
    """Draw the curves of a group to the middle of their tubes; not constants, nor straight segments."""
    frames, values, slopes, arriving = keys[g]
    if arriving is not None or len(frames) == 1:
        return
    for member in range(len(values) - 1, -1, -1):
        centre(scene, groups[g][member], frames, values[member], slopes[member], near)


def _search(scene: Scene, group: np.ndarray, keys: Keys, near: np.ndarray, solve: Solve, quality: str) -> Keys:
    """Solve again inside the tubes; taken where it has fewer keys. Members of a group get a part of their tube each,
    about where they are: to first order all of them may move so far at once. What the second order spoils is seen
    member by member, and undone."""
    frames = scene.samples.shape[1]
    middle, half = tubes(scene, group, near)
    now = scene.samples[group]
    middle = now + (middle - now) / len(group)
    found = group_keys(middle, half / len(group), solve, quality)
    if len(found.frames) >= len(keys.frames):
        return keys
    for member in range(len(group) - 1, -1, -1):
        k = group[member]
        new = samples_of(found, member, frames)
        if len(group) > 1:
            tube(scene, k, near, 0, frames, middle[member], half[member])
        if not (np.abs(new - middle[member]) <= half[member]).all():
            for back in range(member + 1, len(group)):
                put(scene, group[back], now[back], 0, frames)
            return keys
        put(scene, k, new, 0, frames)
    return found


def _prune(scene: Scene, group: np.ndarray, keys: Keys, near: np.ndarray) -> Keys:
    if keys.in_slopes is not None:
        return keys
    frames, values, slopes = keys.frames.copy(), keys.values.copy(), keys.slopes.copy()
    count = prune(scene, group, frames, values, slopes, near)
    return Keys(frames[:count], values[:, :count].copy(), slopes[:, :count].copy())


def group_keys(middle: np.ndarray, half: np.ndarray, solve: Solve, quality: str) -> Keys:
    """Keys of channels that share their times: a single one where constants will do, else what the method finds."""
    low, high = (middle - half).max(axis=1), (middle + half).min(axis=1)
    if (low <= high).all():
        return Keys(np.zeros(1, np.int64), 0.5 * (low + high)[:, None], np.zeros((len(low), 1)))
    return solve(middle, half, quality)


def _refuse_unlimited(motion: Motion, alone: np.ndarray, cap: np.ndarray) -> None:
    free = (np.isinf(alone) & np.isinf(cap)).any(axis=1) & (np.ptp(motion.values, axis=0) > 0.0)
    if free.any():
        name = motion.skeleton.channel_names[int(np.flatnonzero(free)[0])]
        raise OptionError(f"nothing hangs on channel {name!r}, so this tolerance leaves it free; add one like '0.5deg'")
