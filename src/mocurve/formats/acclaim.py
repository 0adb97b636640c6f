"""Acclaim: a skeleton (ASF) and its motion (AMC), two text files. Read only; docs/formats.md tells how.

A bone turns about axes of its own, C M C^-1 against its parent, where M is the product of the rotations in AMC and C
turns the axes of the body to the bone's (J. Lander, Working with motion capture file formats, Game Developer, January
1998). Here every joint's axes are those of the body at rest, as in BVH.
"""

from __future__ import annotations

import os
import warnings
from typing import NamedTuple

import numpy as np

from .. import rotation
from ..errors import FileError, OptionError
from ..motion import Clip, Motion
from ..skeleton import AXES, JointLimits, Skeleton
from . import _amc, _asf
from ._bvh_header import end_site_name
from ._files import Path, opened

FPS = 120  # of nearly all clips of the CMU database; AMC has no place for it
_ALIGNED = 1e-12  # entries of C off 0 and 1 by less are axes that only change places
_MOST = 50_000_000  # channel values that need not be in the file
_GENERAL = "ZYX"  # order of a joint whose own axes are oblique


def read(path: Path, *, skeleton: Path | None = None) -> Motion:
    """The motion in an AMC file; of an ASF file alone, the body and no frames.

    The skeleton is `skeleton`; or is named before it, "x.asf+x.amc"; or is found beside it by its name. A frame rate
    of 120 is taken, with a warning. FileError, with the line, for all that is not surely such a file.
    """
    asf, amc = _pair(path, skeleton)
    body = _asf.read(asf)
    if amc is None:
        frames = _amc.Frames({}, 0, None)
    else:
        with opened(amc) as file:
            frames = _amc.read(file, amc, {bone.name: len(bone.dof) for bone in body.bones}, body.codec)
        _warn(body, frames, amc)
    if np.any(body.bones[0].axis[1:]):
        warnings.warn(
            f"{os.fspath(asf)}: the root has an orientation, which programs take in different ways; here all "
            f"of the motion is turned by it",
            stacklevel=3,
        )
    joints = _joints(body)
    numbers = frames.total * sum(len(joint.channels) for joint in joints)
    if numbers > _MOST and numbers > 4 * sum(values.size for values in frames.values.values()):
        raise FileError(f"{frames.total} frames of {len(joints)} joints, most of which it says nothing of", amc)
    degrees = body.degrees if frames.degrees is None else frames.degrees
    with np.errstate(over="ignore", invalid="ignore"):
        columns = [column for joint in joints for column in _columns(joint, frames, degrees)]
    values = np.column_stack(columns) if columns else np.empty((frames.total, 0))
    if not np.isfinite(values).all():
        raise FileError("its numbers are too large for a motion", amc)
    return Motion(_skeleton(joints, body.unit), values, 1.0 / FPS)


def write(path: Path, clip: Clip) -> None:
    """Always FileError: a motion does not say the axes and limits that an Acclaim skeleton has."""
    raise FileError("Acclaim files are only read; .bvh holds the same body and is written", path)


# -- which two files -----------------------------------------------------------------------------
def _pair(path: Path, skeleton: Path | None) -> tuple[Path, Path | None]:
    """The files of the skeleton and of the motion, None where a skeleton alone is asked for."""
    text = os.fsdecode(path)
    cut = text.lower().find(".asf+")
    if skeleton is not None and (cut >= 0 or text.lower().endswith(".asf")):
        raise OptionError(f"{text!r} names a skeleton already: skeleton= goes with an .amc file alone")
    if cut >= 0:
        asf, amc = text[: cut + 4], text[cut + 5 :]
        beside = os.path.join(os.path.dirname(asf), amc)
        return asf, beside if not os.path.exists(amc) and os.path.exists(beside) else amc
    if text.lower().endswith(".asf"):
        return path, None
    return skeleton if skeleton is not None else _beside(text, path), path


def _beside(text: str, path: Path) -> str:
    """The .asf file in the folder of an .amc file that is meant for it: walk.asf, cmu_01.asf for cmu_01_01.amc, or the
    only one there."""
    with opened(path):  # what is missing is the motion, not a skeleton for it
        folder, name = os.path.split(text)
    known = [entry for entry in sorted(os.listdir(folder or ".")) if entry.lower().endswith(".asf")]
    stem = name[:-4].lower()
    fits = [entry for entry in known if f"{stem}_".startswith(f"{entry[:-4].lower()}_")]
    if not fits and len(known) != 1:
        there = f"none of the {len(known)} .asf files beside it is called like it" if known else "no .asf file is there"
        raise FileError(f"{there}: give skeleton=, or both names as x.asf+x.amc", path)
    return os.path.join(folder, max(fits or known, key=len))


def _warn(body: _asf.Body, frames: _amc.Frames, amc: Path) -> None:
    told = f"{os.fspath(amc)}: no frame rate in the file, {FPS} frames a second assumed"
    still = [bone.name for bone in body.bones if bone.dof and bone.name not in frames.values]
    if still:
        told += f"; no numbers for {', '.join(map(repr, still[:3]))}{' …' if len(still) > 3 else ''}: at rest"
    warnings.warn(told, stacklevel=4)


# -- bones to joints -----------------------------------------------------------------------------
class _Dof(NamedTuple):
    """Number `place` in the line of `bone` turns about, or moves along, `way` (3,), an axis of the body at rest."""

    bone: str
    place: int
    way: np.ndarray


class _Joint(NamedTuple):
    """A joint, at the start of its bone. turns: the first one first, about axes that stay; base: (4,) wxyz, the
    rotation before all of them."""

    name: str
    parent: int
    offset: np.ndarray
    shifts: list[_Dof]
    turns: list[_Dof]
    base: np.ndarray = rotation.exp(np.zeros(3))
    end_site: bool = False
    bone: _asf.Bone | None = None

    @property
    def moved(self) -> list[int]:
        """Axes that a shift moves along."""
        return [axis for axis in range(3) if any(dof.way[axis] for dof in self.shifts)]

    @property
    def oblique(self) -> bool:
        """Whether a turn is not about an axis of the body."""
        return bool(np.any(self.base[1:])) or any(np.count_nonzero(dof.way) > 1 for dof in self.turns)

    @property
    def order(self) -> str:
        """Axes of the rotation channels, as BVH lists them: what turns last stands first."""
        return _GENERAL if self.oblique else "".join(AXES[np.flatnonzero(dof.way)[0]] for dof in reversed(self.turns))

    @property
    def channels(self) -> tuple[str, ...]:
        return (*(f"{AXES[axis]}position" for axis in self.moved), *(f"{axis}rotation" for axis in self.order))


def _joints(body: _asf.Body) -> list[_Joint]:
    """Joints of the bones, depth first, with an end behind each bone that has no child."""
    joints: list[_Joint] = []
    places: list[int] = []  # of each bone among the joints
    inner = set(body.parents)
    for index, (bone, parent) in enumerate(zip(body.bones, body.parents, strict=True)):
        above = body.bones[parent] if parent >= 0 else None
        axes = _axes(bone.axis)
        own = [
            _Dof(bone.name, i, axes[:, "xyz".index(dof[1])]) for i, dof in enumerate(bone.dof) if dof != _asf.STRETCH
        ]
        moves = [dof for dof in own if bone.dof[dof.place] in _asf.SHIFTS]
        turns = [dof for dof in own if bone.dof[dof.place] in _asf.TURNS]
        places.append(len(joints))
        if above is None:
            joints.append(_Joint(bone.name, -1, body.place, moves, turns, bone.axis))
            continue
        joints.append(_Joint(bone.name, places[parent], above.end, _stretch(above) + moves, turns, bone=bone))
        if index not in inner:
            shifts = _stretch(bone)  # an end that moves is a joint: end sites have no channels
            end = _Joint(end_site_name(bone.name, 1), places[index], bone.end, shifts, [], end_site=not shifts)
            joints.append(end)
    return joints


def _axes(wxyz: np.ndarray) -> np.ndarray:
    """(3, 3) the columns are the axes that the rotation makes of x, y and z; exactly 0 and 1 where nearly so."""
    columns = rotation.rotate(wxyz, np.eye(3)).T if wxyz[1:].any() else np.eye(3)
    whole = np.rint(columns)
    return np.where(np.abs(columns - whole) < _ALIGNED, whole, columns)


def _stretch(bone: _asf.Bone) -> list[_Dof]:
    """What "l" of a bone does to all at its end: so many length units along the bone."""
    return [_Dof(bone.name, i, bone.way) for i, dof in enumerate(bone.dof) if dof == _asf.STRETCH]


def _skeleton(joints: list[_Joint], unit: float | None) -> Skeleton:
    return Skeleton(
        tuple(joint.name for joint in joints),
        np.array([joint.parent for joint in joints]),
        np.array([joint.offset for joint in joints]),
        tuple(joint.channels for joint in joints),
        np.array([joint.end_site for joint in joints]),
        unit,
        tuple(limits for place, joint in enumerate(joints) if (limits := _limits(place, joint)) is not None),
    )


def _limits(place: int, joint: _Joint) -> JointLimits | None:
    """How far the joint may turn about the axes of its bone; of a bone that shifts or stretches, only its turns."""
    bone = joint.bone
    if bone is None or not bone.limits or not joint.turns:
        return None
    turns = [(kind, *ends) for kind, ends in zip(bone.dof, bone.limits, strict=True) if kind in _asf.TURNS]
    axes, low, high = zip(*turns[::-1], strict=True)
    order = "".join(kind[1] for kind in axes).upper()
    return JointLimits(place, bone.axis, order, np.array(low), np.array(high))


def _columns(joint: _Joint, frames: _amc.Frames, degrees: bool) -> list[np.ndarray]:
    """The values (F,) of each channel of a joint."""

    def said(dof: _Dof) -> np.ndarray:
        return frames.values[dof.bone][:, dof.place] if dof.bone in frames.values else np.zeros(frames.total)

    columns = [sum((said(dof) * dof.way[axis] for dof in joint.shifts), joint.offset[axis]) for axis in joint.moved]
    angles = [said(dof) if degrees else np.degrees(said(dof)) for dof in joint.turns]
    if not joint.oblique:
        return columns + [angle * dof.way.sum() for angle, dof in zip(angles[::-1], joint.turns[::-1], strict=True)]
    turned = np.broadcast_to(joint.base, (frames.total, 4))
    for angle, dof in zip(angles, joint.turns, strict=True):
        turned = rotation.mul(rotation.exp(np.radians(angle)[:, None] * dof.way), turned)
    return [*columns, *rotation.unroll_euler(rotation.to_euler(turned, _GENERAL), _GENERAL).T]
