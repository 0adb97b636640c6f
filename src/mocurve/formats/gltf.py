"""glTF 2.0: .glb, and .gltf with its buffer inside, so that it too is one file.

A clip becomes an armature (nodes, and a skin that lists all joints, end sites too, in the skeleton's order), a figure
of octahedra around the bones, and an animation. Lengths are metres; joints rest unturned at their offsets; quaternions
are xyzw and turn the joint against its parent. Source: the Khronos glTF 2.0 specification, sections 3.7 and 3.11.

What glTF has no place for stands in two objects `extras.mocurve`, which `read` takes and other programs leave aside.
Of the skin, `skins[0].extras.mocurve`:
    version:    1.
    names:      J joint names as in the clip; a node's name has a number after it where it would stand twice.
    channels:   J lists, "Xposition" ... "Zrotation" in file order.
    offsets:    J x 3, file units; a joint that is moved by constant position channels rests elsewhere.
    end_sites:  indices of the joints that are end sites.
    unit:       metres that somebody said a file unit is, or null.
    scale:      metres that a file unit was written as (the unit, or a guess).
Of each animation, `animations[i].extras.mocurve`:
    frame_time: seconds; key times are times of frames, rounded to float32.
    frames:     how many there are, from time 0.
    start:      C channel values at the first frame, degrees and file units: which whole turns, and which of the two
                Euler triples, the rotations are meant to start with.
    history:    the steps that made the clip, a list of objects.
A path without a channel in the animation stays at the node's rest.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..errors import Mismatch, OptionError, UnknownName
from ..info import unit_of
from ..keyed import KeyedMotion
from ..motion import Clip, Motion
from ._files import Path, replacing

if TYPE_CHECKING:
    from ..skeleton import Skeleton

PROFILES = {
    "linear": "few keys, straight between them, chosen for each joint so that the clip stays within the tolerance",
    "cubic": "the curves of a reduced clip, exact; Blender drops their tangents",
    "baked": "a key at every frame",
}
SEVERAL = True


def read(path: Path, *, animation: str | None = None) -> Motion | KeyedMotion:
    """An animation of a skeleton, the first or the one of that name; FileError where there is none to read."""
    from . import _gltf_read  # the writer has no use for it

    return _gltf_read.read(path, animation=animation)


def write(
    path: Path,
    clip: Clip | Mapping[str, Clip],
    *,
    profile: str = "linear",
    tolerance: str | None = None,
    mesh: bool = True,
) -> None:
    """Write a clip, or {name: clip} of one body, each an animation.

    profile: linear, cubic or baked, as PROFILES tells. tolerance: how far `linear` may leave the clip; None: what the
    clip was reduced with, else the default of `reduce`. mesh: whether there is a figure for viewers to show.

    OptionError for `cubic` without keys, for a tolerance that the profile has no use for, for numbers too large for 32
    bits and for a skeleton without joints; Mismatch where a number is not finite or the clips differ in their bodies.
    Warns where keys lose their tangents or frames are left out unasked, where the length unit is a guess, where a name
    stands twice, and where a clip has no frames.
    """
    if profile not in PROFILES:
        raise UnknownName("profile of glTF", profile, PROFILES)
    if tolerance is not None and profile != "linear":
        raise OptionError(f"the {profile} profile chooses no keys of its own and has no use for a tolerance")
    from . import _gltf_buffer, _gltf_write, _gltf_write_tracks  # what reading needs none of

    title = os.path.splitext(os.path.basename(os.fsdecode(path)))[0].encode(errors="replace").decode()
    clips = dict(clip) if isinstance(clip, Mapping) else {title: clip}
    motions = {name: _checked(name, each) for name, each in clips.items()}
    body = _one_body(motions)
    names = _node_names(body.skeleton.names, title)
    document = _gltf_write.Document(title, body, names, _scale(body), mesh)
    for name, each in clips.items():
        if not motions[name].frames:
            warnings.warn(f"{name!r} has no frames: an animation of glTF cannot be empty, it is left out", stacklevel=3)
            continue
        _gltf_buffer.key_times(np.arange(each.frames) * each.frame_time, each.frame_time)  # refuses before the search
        document.animate(name, _gltf_write_tracks.joint_tracks(each, motions[name], profile, tolerance), motions[name])
    if profile == "linear":
        _tell_losses(clips.values(), tolerance)
    binary = os.fsdecode(path).lower().endswith(".glb")
    data = (_gltf_write.glb if binary else _gltf_write.embedded)(document, path)
    with replacing(path) as file:
        file.write(data)


def _checked(name: str, clip: Clip) -> Motion:
    """The samples of a clip; Mismatch that names the first channel and frame without a finite number."""
    motion = clip.sample()
    odd = ~np.isfinite(motion.values.T)
    if odd.any():
        channel, frame = (int(found[0]) for found in np.nonzero(odd))
        value = motion.values[frame, channel]
        raise Mismatch(f"{motion.skeleton.channel_names[channel]} of {name!r} is {value} at frame {frame}")
    return motion


def _one_body(motions: Mapping[str, Motion]) -> Motion:
    """The first of the clips; OptionError where there is none or it has no joint, Mismatch where bodies differ."""
    if not motions:
        raise OptionError("no clip is given to write")
    (first, motion), *others = motions.items()
    body = motion.skeleton
    if not body.names:
        raise OptionError("a skeleton without joints cannot be written: an armature of glTF has at least one")
    for name, other in others:
        difference = _difference(body, other.skeleton)
        if difference:
            raise Mismatch(f"the clips {first!r} and {name!r} have different bodies: {difference}")
    return motion


def _difference(a: Skeleton, b: Skeleton) -> str:
    """The first difference of two bodies, "" where there is none."""
    if len(a.names) != len(b.names):
        return f"{len(a.names)} and {len(b.names)} joints"
    for joint, name in enumerate(a.names):
        if name != b.names[joint]:
            return f"joint {joint} is {name!r} in one, {b.names[joint]!r} in the other"
        if a.parents[joint] != b.parents[joint]:
            return f"{name!r} hangs on another joint"
        if a.channels[joint] != b.channels[joint]:
            return f"{name!r} has the channels {a.channels[joint]} and {b.channels[joint]}"
        if not np.allclose(a.offsets[joint], b.offsets[joint], rtol=1e-5, atol=1e-6 * np.abs(a.offsets).max()):
            return f"{name!r} has the offsets {a.offsets[joint]} and {b.offsets[joint]}"
    return "" if a.unit == b.unit else f"a length unit is {a.unit} m in one, {b.unit} m in the other"


def _scale(motion: Motion) -> float:
    """Metres that a file unit is written as; a warning where nobody has said it."""
    if motion.skeleton.unit is not None:
        return motion.skeleton.unit
    try:
        unit = unit_of(motion)
        metres, name = unit.metres, f"{unit.name}, by the height of the body"
    except OptionError:  # a body without height
        metres, name = 1.0, "m"
    warnings.warn(
        f"glTF is in metres and nobody has said the clip's length unit: taken for {name} (the option unit says it)",
        stacklevel=4,
    )
    return metres


def _tell_losses(clips: Iterable[Clip], tolerance: str | None) -> None:
    from ..reduction.tolerance import DEFAULT

    if any(isinstance(clip, KeyedMotion) for clip in clips):
        lost = "the keys become straight ones within the tolerance: tangents are lost, the profile cubic keeps them"
    elif tolerance is None:
        lost = f"only the keys that hold the clip within {DEFAULT} are written: the profile baked has every frame"
    else:
        return
    warnings.warn(lost, stacklevel=4)


def _node_names(names: Sequence[str], title: str) -> list[str]:
    """Of the armature, the figure and the joints, no two the same: tools find joints by the names of their nodes."""
    given: dict[str, None] = {}
    for joint, name in enumerate(names):
        wanted = name or f"joint{joint}"
        given[_free(wanted, given)] = None
    changed = [(old, new) for old, new in zip(names, given, strict=True) if old != new]
    if changed:
        told = ", ".join(f"{old!r} is {new!r}" for old, new in changed[:3])
        more = f" and {len(changed) - 3} more" if len(changed) > 3 else ""
        warnings.warn(f"joints need names of their own in glTF: {told}{more}", stacklevel=4)
    armature = _free(title, given)
    return [armature, _free("Figure", {**given, armature: None}), *given]


def _free(name: str, taken: Mapping[str, None]) -> str:
    """The name, with the first number after it that makes it another than those taken."""
    number = 2
    free = name
    while free in taken:
        free, number = f"{name}{number}", number + 1
    return free
