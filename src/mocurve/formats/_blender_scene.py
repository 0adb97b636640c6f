"""The part of the Blender script that makes an armature and an action of the clip.

SPDX-License-Identifier: MIT
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import bpy
import numpy as np

from ._blender_keys import Keys, keys_of
from ._blender_maths import (
    Curve,
    alignment,
    as_quaternions,
    axes_of,
    bone_names,
    bone_vectors,
    constant,
    mixed,
    scaled,
    straight,
)

NAME = PROFILE = ""
METRES, LINEAR = 1.0, False

# --- part of the script ---
ODD_REST = 0.1  # of the length of all bones: more than this lies between the rest poses of two bodies


class Trouble(Exception):
    """What the user can mend; told in one line."""


def tell(text: str) -> None:
    print(f"mocurve: {text}")


class Clip:
    """The motion: its JSON, and what the script needs of it by joint.

    step: seconds a frame. names: of the bones, "" for an end site. origins (J, 3): places that the bones rest at, from
    the parent. curves: of each channel, in frames, degrees and lengths of the file. turns, moves: for each joint
    {axis: channel}, in the order of the channels.
    """

    def __init__(self, data: dict[str, Any]):
        joints = data["joints"]
        self.data = data
        self.step: float = data["frame_time"]
        self.frames: int = data["frames"]
        self.parents: list[int] = [joint["parent"] for joint in joints]
        self.bones = [k for k, joint in enumerate(joints) if not joint.get("end_site")]
        names = bone_names([joints[k]["name"] for k in self.bones])
        self.names = dict(zip(self.bones, names, strict=True))
        self.curves = [self._curve(row) for row in data["curves"]]
        self.turns: list[dict[int, int]] = [{} for _ in joints]
        self.moves: list[dict[int, int]] = [{} for _ in joints]
        channels = iter(range(len(self.curves)))
        for k, joint in enumerate(joints):
            for kind in joint["channels"]:
                (self.turns if kind.endswith("rotation") else self.moves)[k]["XYZ".index(kind[0])] = next(channels)
        self.origins = np.array([joint["offset"] for joint in joints], float).reshape(-1, 3)
        for k, moves in enumerate(self.moves):  # some programs keep the bone lengths in channels that hardly change
            for axis, channel in moves.items():
                if self.parents[k] >= 0 and len(self.curves[channel].values):
                    self.origins[k, axis] = np.median(self.curves[channel].values)

    def _curve(self, row: dict[str, Any]) -> Curve:
        slopes = np.array(row["slopes"], float)
        arriving = np.array(row.get("in_slopes", slopes), float)
        frames, values = np.array(row["times"], float) / self.step, np.array(row["values"], float)
        return Curve(frames, values, slopes * self.step, arriving * self.step)

    def places(self) -> np.ndarray:
        """Where the joints rest (J, 3), seen from the armature."""
        places = self.origins.copy()
        for k, parent in enumerate(self.parents):
            places[k] += places[parent] if parent >= 0 else 0.0
        return places


# -- the armature ------------------------------------------------------------------------------------
def new_armature(clip: Clip) -> Any:
    """Bones of the clip's body, in lengths of the file with Y up; the object turns and scales them."""
    if bpy.context.object is not None and bpy.context.object.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    armature = bpy.data.armatures.new(NAME)
    rig = bpy.data.objects.new(NAME, armature)
    bpy.context.scene.collection.objects.link(rig)
    select(rig)
    bpy.ops.object.mode_set(mode="EDIT")
    places, vectors = clip.places(), bone_vectors(clip.parents, clip.origins)
    for k in clip.bones:
        bone = armature.edit_bones.new(clip.names[k])
        length = float(np.linalg.norm(vectors[k]))
        basis = straight(vectors[k] / length)
        along = vectors[k] if PROFILE == "quaternion" else length * basis[:, 1]
        bone.head, bone.tail = places[k], places[k] + along
        if PROFILE != "quaternion":
            bone.align_roll(basis[:, 2])
        if clip.parents[k] >= 0:
            bone.parent = armature.edit_bones[clip.names[clip.parents[k]]]
    bpy.ops.object.mode_set(mode="OBJECT")
    rig.rotation_euler, rig.scale = (math.pi / 2.0, 0.0, 0.0), (METRES,) * 3
    rig.show_in_front = True
    rig["mocurve"] = NAME
    return rig


def select(rig: Any) -> None:
    for other in bpy.context.selected_objects:
        other.select_set(False)
    rig.select_set(True)
    bpy.context.view_layer.objects.active = rig


# -- what moves its bones ----------------------------------------------------------------------------
class Part(NamedTuple):
    """The F-curves of one property of a bone.

    curves: by index, in the bone's units. channels: {index: (channel, factor, origin)} where bone value = factor *
    (channel value - origin); None where the curves stand for the channels only together. matrix: (3, 3) from the
    clip's axes to the bone's. mode: how the bone has to turn.
    """

    joint: int
    path: str
    mode: str
    curves: dict[int, Curve]
    channels: dict[int, tuple[int, float, float]] | None
    matrix: np.ndarray
    shift: np.ndarray

    def keys(self) -> dict[int, Keys]:
        kind = "LINEAR" if LINEAR and self.path != "rotation_quaternion" else "BEZIER"
        return {index: keys_of(curve, kind) for index, curve in self.curves.items()}


class Fit(NamedTuple):
    """How the clip's body lies in an armature: joints that have a bone, the turn (3, 3) of the axes, and the scale."""

    joints: list[int]
    turn: np.ndarray
    scale: float


def fit(clip: Clip, rig: Any, quiet: bool = True) -> Fit:
    """Finds the bones by their names; Trouble where there is none."""
    bones = rig.data.bones
    joints = [k for k in clip.bones if clip.names[k] in bones]
    if not joints:
        raise Trouble(
            f"no bone of {rig.name!r} has the name of a joint ({', '.join(list(clip.names.values())[:4])}...)"
        )
    heads = {k: np.array(bones[clip.names[k]].head_local) for k in joints}
    pairs = [k for k in joints if clip.parents[k] in heads]
    theirs = np.array([heads[k] - heads[clip.parents[k]] for k in pairs]).reshape(-1, 3)
    turn, scale, left = alignment(clip.origins[pairs], theirs)
    if not quiet:
        _tell_differences(clip, bones, joints, left)
    return Fit(joints, turn, scale)


def _tell_differences(clip: Clip, bones: Any, joints: list[int], left: float) -> None:
    missing = [name for k, name in clip.names.items() if k not in joints]
    if missing:
        tell(f"no bone for {len(missing)} of {len(clip.bones)} joints, whose motion is left out: {', '.join(missing)}")
    parents = [bones[clip.names[k]].parent for k in joints]
    moved = [
        clip.names[k]
        for k, parent in zip(joints, parents, strict=True)
        if clip.parents[k] in joints and (parent is None or parent.name != clip.names[clip.parents[k]])
    ]
    if moved:
        tell(f"these bones hang on another bone than in the clip, and turn otherwise: {', '.join(moved)}")
    if left > ODD_REST:
        tell(f"the rest pose differs from the clip's by {left:.0%} of the bones' lengths: the poses will differ too")


def parts(clip: Clip, rig: Any, fitted: Fit, modes: dict[int, str] | None = None) -> list[Part]:
    """Everything that the clip says about the armature's bones. modes: how each joint's bone turns; None: as it is best
    for the profile."""
    found = []
    for k in fitted.joints:
        rest = np.array(rig.data.bones[clip.names[k]].matrix_local.to_3x3())
        if clip.moves[k]:
            found.append(_location(clip, rig, k, rest, fitted))
        if clip.turns[k]:
            want = modes[k] if modes else "QUATERNION" if PROFILE == "quaternion" else "EULER"
            found.append(_rotation(clip, k, fitted.turn.T @ rest, want == "QUATERNION"))
    return [part for part in found if part.curves]


def _rotation(clip: Clip, joint: int, basis: np.ndarray, quaternions: bool) -> Part:
    axes = list(clip.turns[joint])
    curves = [clip.curves[channel] for channel in clip.turns[joint].values()]
    order = axes + [axis for axis in range(3) if axis not in axes]
    seen = axes_of(basis)
    if not all(len(curve.frames) for curve in curves):
        return Part(joint, "", "XYZ", {}, None, basis, np.zeros(3))
    if quaternions or seen is None:
        radians = [scaled(curve, math.pi / 180.0) for curve in curves]
        four = dict(enumerate(as_quaternions(radians, axes, basis)))
        return Part(joint, "rotation_quaternion", "QUATERNION", four, None, basis, np.zeros(3))
    mode = "".join("XYZ"[seen[axis][0]] for axis in reversed(order))
    factors = {axis: math.copysign(math.pi / 180.0, seen[axis][1]) for axis in axes}
    three = {seen[axis][0]: scaled(curve, factors[axis]) for axis, curve in zip(axes, curves, strict=True)}
    channels = {seen[axis][0]: (channel, factors[axis], 0.0) for axis, channel in clip.turns[joint].items()}
    return Part(joint, "rotation_euler", mode, three, channels, basis, np.zeros(3))


def _location(clip: Clip, rig: Any, joint: int, rest: np.ndarray, fitted: Fit) -> Part:
    """Location is what the bone's place differs from where it rests, along the bone's own axes."""
    matrix = fitted.scale * rest.T @ fitted.turn
    origin = clip.origins[joint]
    if clip.parents[joint] < 0:  # there a body of other axes and size may stand elsewhere
        head = fitted.turn.T @ np.array(rig.data.bones[clip.names[joint]].head_local) / fitted.scale
        origin = np.where(np.isclose(head, origin, rtol=1e-6, atol=1e-9), origin, head)
    three = [constant(value) for value in clip.origins[joint]]
    for axis, channel in clip.moves[joint].items():
        three[axis] = clip.curves[channel]
    shift = -matrix @ origin
    seen = axes_of(matrix.T)
    if not all(len(curve.frames) for curve in three):
        return Part(joint, "", "", {}, None, matrix, shift)
    if seen is None:
        curves = {i: mixed(three, matrix[i], shift[i]) for i in range(3)}
        return Part(joint, "location", "", curves, None, matrix, shift)
    curves = {i: scaled(three[axis], factor, -factor * origin[axis]) for axis, (i, factor) in enumerate(seen)}
    channels = {seen[axis][0]: (channel, seen[axis][1], origin[axis]) for axis, channel in clip.moves[joint].items()}
    still = [i for i, curve in curves.items() if i not in channels and not curve.values.any()]
    return Part(joint, "location", "", {i: c for i, c in curves.items() if i not in still}, channels, matrix, shift)


# -- the action -------------------------------------------------------------------------------------
def new_action(clip: Clip, rig: Any, made: list[Part]) -> Any:
    """An action with the keys; the armature's bones are set to turn as they need."""
    action = bpy.data.actions.new(NAME)
    slot = action.slots.new("OBJECT", rig.name)
    bag = action.layers.new("Layer").strips.new(type="KEYFRAME").channelbag(slot, ensure=True)
    for part in made:
        bone = rig.pose.bones[clip.names[part.joint]]
        if part.mode:
            bone.rotation_mode = part.mode
        group = bag.groups.get(bone.name) or bag.groups.new(bone.name)
        for index, keys in part.keys().items():
            curve = bag.fcurves.new(bone.path_from_id(part.path), index=index)
            curve.group = group
            _fill(curve, keys)
    data = rig.animation_data_create()
    if data.action is not None:
        data.action.use_fake_user = True  # else the action of before is lost when the file is saved
    data.action, data.action_slot = action, slot
    action.use_fake_user = True
    return action


def _fill(curve: Any, keys: Keys) -> None:
    points, values = curve.keyframe_points, keys.points
    points.add(len(values))
    numbers = {name: _numbers(name) for name in ("interpolation", "handle_left_type")}
    kinds = [numbers["interpolation"][kind] for kind in keys.kinds]
    handles = [numbers["handle_left_type"]["ALIGNED" if smooth else "FREE"] for smooth in keys.smooth]
    points.foreach_set("interpolation", kinds)
    for side in ("handle_left_type", "handle_right_type"):
        points.foreach_set(side, [numbers["handle_left_type"]["FREE"]] * len(handles))
    for k, name in enumerate(("handle_left", "co", "handle_right")):
        points.foreach_set(name, np.ascontiguousarray(values[:, k]).ravel())
    curve.update()
    for side in ("handle_left_type", "handle_right_type"):  # not before: update puts handles in line, and rounds them
        points.foreach_set(side, handles)


def _numbers(name: str) -> dict[str, int]:
    return {item.identifier: item.value for item in bpy.types.Keyframe.bl_rna.properties[name].enum_items}


def lock_the_rest(clip: Clip, rig: Any, made: list[Part]) -> None:
    """What the clip has no channel for is locked, since it could not come back."""
    for k in clip.bones:
        bone = rig.pose.bones[clip.names[k]]
        bone.lock_scale = (True, True, True)
        has = {part.path: set(part.curves) for part in made if part.joint == k}
        bone.lock_location = [index not in has.get("location", ()) for index in range(3)]
        if "rotation_quaternion" not in has:
            bone.lock_rotation = [index not in has.get("rotation_euler", ()) for index in range(3)]


def set_time(clip: Clip) -> None:
    """The scene's frames a second, and its range: frame n is sample n, the first of them 0."""
    scene = bpy.context.scene
    rate = 1.0 / clip.step
    scene.render.fps = min(max(round(rate), 1), 32767)
    scene.render.fps_base = min(max(scene.render.fps * clip.step, 1e-5), 1e6)
    if clip.frames:
        scene.frame_start, scene.frame_end = 0, min(clip.frames - 1, 1048574)
    scene.frame_set(scene.frame_start)
