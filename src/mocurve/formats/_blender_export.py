"""The part of the Blender script that takes edited keys back, and its commands.

SPDX-License-Identifier: MIT
"""

from __future__ import annotations

import argparse
import json
import math
import os
import sys
from typing import Any, NoReturn

import bpy
import numpy as np
from bpy_extras.io_utils import ExportHelper

from ._blender_keys import KINDS, Keys, curve_of, keys_of, restored, same_keys
from ._blender_maths import Curve, as_angles, constant, in_basis, mixed, sampled, scaled, turned
from ._blender_scene import (
    NAME,
    Clip,
    Part,
    Trouble,
    fit,
    lock_the_rest,
    new_action,
    new_armature,
    parts,
    select,
    set_time,
    tell,
)

PAYLOAD = ""

# --- part of the script ---
TOLERANCE_DEGREES = 1e-3  # where handles were moved in time: how far the exported curve may be from the edited one
TOLERANCE_LENGTH = 1e-5  # of the body's largest extent
NUDGE = 1e-3  # frames; rates of angles are differences over twice this


class Edited:
    """The curves of an action, on their way back to the channels of the clip."""

    def __init__(self, clip: Clip, rig: Any, action: Any):
        self.clip, self.rig = clip, rig
        bag = _channelbag(rig, action)
        self.found = {(curve.data_path, curve.array_index): curve for curve in bag.fcurves} if bag else {}
        self.rows = [dict(row) for row in clip.data["curves"]]
        self.changed: set[int] = set()
        self.odd: list[str] = []
        ends = [curve.range()[1] for curve in self.found.values() if not curve.is_empty]
        self.frames = max([clip.frames, *(math.ceil(end - 1e-3) + 1 for end in ends)])
        self.length = TOLERANCE_LENGTH * (float(np.ptp(clip.places(), axis=0).max()) or 1.0)

    def take(self) -> None:
        fitted = fit(self.clip, self.rig, quiet=False)
        bones = self.rig.pose.bones
        modes = {k: bones[self.clip.names[k]].rotation_mode for k in fitted.joints}
        for part in parts(self.clip, self.rig, fitted, modes):
            if part.mode and part.mode != modes[part.joint]:
                self._turned_otherwise(part, modes[part.joint])
            elif part.channels is None:
                self._together(part)
            else:
                self._each(part)
        if self.found:
            names = sorted({f"{path}[{index}]" for path, index in self.found})
            tell(f"the clip has no channel for {len(names)} curves, which are left out: {', '.join(names)}")
        if self.odd:
            tell(f"modifiers or easing became a key a frame: {', '.join(self.odd)}")

    def _each(self, part: Part) -> None:
        """Each F-curve stands for a channel of its own."""
        tolerance = math.radians(TOLERANCE_DEGREES) if part.path == "rotation_euler" else self.length
        given, step = part.keys(), self.clip.step
        for index, keys in self._keys(part.joint, part.path, sorted(part.curves)).items():
            if index not in (part.channels or {}) or same_keys(keys, given[index]):
                continue
            channel, factor, origin = part.channels[index]  # type: ignore[index]
            curve, source = curve_of(keys, tolerance if part.path != "location" else tolerance * abs(factor))
            plain = scaled(curve, 1.0 / factor, origin)
            seconds = Curve(plain.frames * step, plain.values, plain.leaving / step, plain.arriving / step)
            row = self.clip.data["curves"][channel]
            slopes = np.array(row["slopes"], float)
            original = Curve(
                np.array(row["times"], float),
                np.array(row["values"], float),
                slopes,
                np.array(row.get("in_slopes", slopes), float),
            )
            self._put(channel, restored(seconds, source, keys, given[index], original))

    def _together(self, part: Part) -> None:
        """All F-curves of the property make all of its channels."""
        now = self._keys(part.joint, part.path, sorted(part.curves))
        given = part.keys()
        if all(same_keys(now[index], given[index]) for index in given):
            return
        if part.path == "location":
            back = np.linalg.inv(part.matrix)
            curves = [curve_of(keys, self.length)[0] for keys in now.values()]
            for axis, channel in self.clip.moves[part.joint].items():
                self._put_frames(channel, mixed(curves, back[axis], float(-back[axis] @ part.shift)))
        else:
            self._angles(part, [curve_of(keys, 1e-6)[0] for keys in now.values()], [])

    def _turned_otherwise(self, part: Part, mode: str) -> None:
        """The bone turns in another way than the script had set."""
        name = self.clip.names[part.joint]
        if mode == "AXIS_ANGLE":
            return tell(f"{name} turns by axis and angle, which is not taken back; let it turn by Euler or quaternion")
        path, count = ("rotation_quaternion", 4) if mode == "QUATERNION" else ("rotation_euler", 3)
        now = self._keys(part.joint, path, list(range(count)))
        axes = ["XYZ".index(axis) for axis in reversed(mode)] if count == 3 else []
        curves = [curve_of(keys, 1e-6)[0] for keys in now.values()]
        return self._angles(part, [curves[axis] for axis in axes] or curves, axes)

    def _angles(self, part: Part, curves: list[Curve], axes: list[int]) -> None:
        """A key a frame: angles are no sums of the curves of a quaternion or of other angles."""
        clip, name = self.clip, self.clip.names[part.joint]
        tell(f"{name} was turned in another way than by the clip's channels: it comes back with a key at every frame")
        frames = np.unique(np.concatenate([np.arange(max(self.frames, 1.0)), *(curve.frames for curve in curves)]))
        near = (frames[:, None] + [-NUDGE, 0.0, NUDGE]).ravel()
        values, rates = (np.column_stack(part) for part in zip(*(sampled(c, near, near) for c in curves), strict=True))
        q = turned(values, rates, axes)[0] if axes else values
        channels = clip.turns[part.joint]
        order = [*channels, *(axis for axis in range(3) if axis not in channels)]
        first = [clip.curves[channels[axis]].values[0] if axis in channels else 0.0 for axis in order]
        angles = np.degrees(as_angles(in_basis(q, part.matrix.T), order, np.radians(first))).reshape(-1, 3, 3)
        lost = np.abs(angles[:, 1, len(channels) :])
        if lost.size and lost.max() > TOLERANCE_DEGREES:
            tell(f"{name} has no channel for a turn of up to {lost.max():.3g} degrees, which is left out")
        slopes = (angles[:, 2] - angles[:, 0]) / (2.0 * NUDGE)
        for i, channel in enumerate(channels.values()):
            self._put_frames(channel, Curve(frames, angles[:, 1, i], slopes[:, i], slopes[:, i]))

    def _keys(self, joint: int, path: str, indices: list[int]) -> dict[int, Keys]:
        """Keys of the F-curves, or the bone's own value where there is none; they count as used."""
        bone = self.rig.pose.bones[self.clip.names[joint]]
        found = {}
        for index in indices:
            curve = self.found.pop((bone.path_from_id(path), index), None)
            if curve is None or curve.mute or curve.is_empty:
                found[index] = keys_of(constant(getattr(bone, path)[index]), "BEZIER")
                continue
            found[index], odd = _keys_of(curve, self.frames)
            if odd:
                self.odd.append(f"{bone.name}.{path}[{index}]")
        return found

    def _put_frames(self, channel: int, curve: Curve) -> None:
        step = self.clip.step
        self._put(channel, Curve(curve.frames * step, curve.values, curve.leaving / step, curve.arriving / step))

    def _put(self, channel: int, curve: Curve) -> None:
        """Seconds and the clip's own units; keys that 64 bits cannot tell apart are one."""
        keep = np.append(True, np.diff(curve.frames) > 0)
        row = self.rows[channel]
        for name, part in zip(("times", "values", "slopes", "in_slopes"), curve, strict=True):
            row[name] = part[keep].tolist()
        if row["in_slopes"] == row["slopes"]:
            del row["in_slopes"]
        self.changed.add(channel)

    def json(self, action: str) -> dict[str, Any]:
        data = {**self.clip.data, "frames": self.frames, "curves": self.rows}
        if self.changed:  # what the reduction had measured is no longer true
            step = {"verb": "blender", "action": action, "curves": len(self.changed)}
            data |= {"report": None, "history": [*data.get("history", []), step]}
        return data


def _channelbag(rig: Any, action: Any) -> Any:
    data = rig.animation_data
    slot = data.action_slot if data is not None and data.action == action else None
    if slot is None:
        slot = next((slot for slot in action.slots if slot.target_id_type in ("OBJECT", "UNSPECIFIED")), None)
    strips = [strip for layer in action.layers for strip in layer.strips]
    return strips[0].channelbag(slot) if strips and slot else None


def _keys_of(curve: Any, frames: int) -> tuple[Keys, bool]:
    """The keys; and whether they had to be made, one a frame, since the curve is no Bézier curve."""
    points = curve.keyframe_points
    kinds = [point.interpolation for point in points]
    if not kinds or not set(kinds[:-1]) <= set(KINDS) or any(not modifier.mute for modifier in curve.modifiers):
        return _lines(np.arange(max(frames, 1)), curve), True
    values = np.empty((len(points), 3, 2), np.float32)
    for k, name in enumerate(("handle_left", "co", "handle_right")):
        part = np.empty(2 * len(points), np.float32)
        points.foreach_get(name, part)
        values[:, k] = part.reshape(-1, 2)
    held = ("ALIGNED", "AUTO", "AUTO_CLAMPED")
    smooth = [point.handle_left_type in held and point.handle_right_type in held for point in points]
    keys = Keys(values, kinds, np.array(smooth))
    if curve.extrapolation == "LINEAR":
        start, end = values[0, 1, 0], values[-1, 1, 0]
        before = _lines(np.arange(0, min(start, 1)), curve)
        after = _lines(np.arange(frames - 1, max(end, frames - 2), -1), curve)
        keys = Keys(
            np.concatenate([before.points, values, after.points]),
            [*before.kinds, *kinds[:-1], "LINEAR" if after.kinds else kinds[-1], *after.kinds],
            np.concatenate([before.smooth, keys.smooth, after.smooth]),
        )
    return keys, False


def _lines(frames: np.ndarray, curve: Any) -> Keys:
    """Keys at the frames with straight lines between."""
    values = np.array([curve.evaluate(frame) for frame in frames])
    none = np.zeros(len(frames))
    return keys_of(Curve(frames.astype(float), values, none, none), "LINEAR") if len(frames) else _NO_KEYS


_NO_KEYS = Keys(np.empty((0, 3, 2), np.float32), [], np.zeros(0, bool))


# -- commands ---------------------------------------------------------------------------------------
def build(rig_name: str | None = None) -> None:
    """The clip as an action: of the armature of that name, or of one of the clip's own body."""
    clip = Clip(json.loads(PAYLOAD))
    own = _own(clip) if rig_name is None else None
    rig = _named(rig_name) if rig_name is not None else own or new_armature(clip)
    new = rig_name is None and own is None
    fitted = fit(clip, rig, quiet=new)
    before = {bone.name: bone.rotation_mode for bone in rig.pose.bones}
    made = parts(clip, rig, fitted)
    action = new_action(clip, rig, made)
    if new:
        lock_the_rest(clip, rig, made)
    elif changed := [bone.name for bone in rig.pose.bones if bone.rotation_mode != before[bone.name]]:
        tell(f"{len(changed)} bones turn in another way now (rotation mode): {', '.join(changed)}")
    select(rig)
    set_time(clip)
    render, keys = bpy.context.scene.render, sum(len(c.frames) for part in made for c in part.curves.values())
    rate = f"{clip.frames} frames at {render.fps / render.fps_base:.6g} frames a second"
    tell(f"made the action {action.name!r} of the armature {rig.name!r}: {keys} keys, {rate}")


def export(path: str, rig_name: str | None = None, action_name: str | None = None) -> None:
    """Write the keys of the armature's action, or of the action of that name, to a .curves.json file."""
    clip = Clip(json.loads(PAYLOAD))
    rig = _named(rig_name) if rig_name is not None else _own(clip)
    if rig is None:
        raise Trouble(f"no armature here has the bones of {NAME!r}: open the file with it, or name it with --armature")
    action = rig.animation_data.action if rig.animation_data else None
    if action_name is not None:
        action = bpy.data.actions.get(action_name)
    if action is None:
        what = "no action" if action_name is None else f"there is no action {action_name!r}"
        known = ", ".join(action.name for action in bpy.data.actions) or "none"
        raise Trouble(f"{rig.name!r}: {what} to export; this file has {known}")
    edited = Edited(clip, rig, action)
    edited.take()
    _write(path, edited.json(action.name))
    keys = sum(len(row["times"]) for row in edited.rows)
    tell(f"wrote {path}: {keys} keys; {len(edited.changed)} of {len(edited.rows)} curves differ from the clip's")


def _own(clip: Clip) -> Any:
    """The armature that has all bones of the clip: the active one, or that which the script made, or another."""
    names = set(clip.names.values())
    rigs = [rig for rig in bpy.data.objects if rig.type == "ARMATURE" and names <= set(rig.data.bones.keys())]
    rigs = [rig for rig in rigs if rig.get("mocurve") == NAME] or rigs
    active = bpy.context.view_layer.objects.active
    return active if active in rigs else next(iter(rigs), None)


def _named(name: str) -> Any:
    rig = bpy.data.objects.get(name)
    if rig is None or rig.type != "ARMATURE":
        known = ", ".join(repr(rig.name) for rig in bpy.data.objects if rig.type == "ARMATURE") or "none"
        raise Trouble(f"no armature {name!r} here; there is {known}")
    return rig


def _write(path: str, data: dict[str, Any]) -> None:
    """As mocurve writes it: a line a joint and a line a curve."""
    parts = [
        f'"{key}": [\n' + ",\n".join(map(json.dumps, value)) + "\n]"
        if key in ("joints", "curves") and value
        else f'"{key}": {json.dumps(value)}'
        for key, value in data.items()
    ]
    try:
        with open(f"{path}.part", "w", encoding="utf-8") as file:
            file.write("{\n" + ",\n".join(parts) + "\n}\n")
        os.replace(f"{path}.part", path)
    except OSError as error:
        raise Trouble(f"cannot write {path}: {(error.strerror or str(error)).lower()}") from error


class ExportCurves(bpy.types.Operator, ExportHelper):
    """Write the edited keys for mocurve"""

    bl_idname = "export_anim.mocurve_curves"
    bl_label = "Keys for mocurve"
    filename_ext = ".curves.json"

    def execute(self, context: Any) -> set[str]:
        try:
            export(self.filepath)
        except Trouble as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


def _menu(menu: Any, context: Any) -> None:
    menu.layout.operator(ExportCurves.bl_idname, text=f"Keys of {NAME} (.curves.json)")


def add_to_menu() -> None:
    """File > Export; the entry of a script that ran before is replaced."""
    old = getattr(bpy.types, "EXPORT_ANIM_OT_mocurve_curves", None)
    if old is not None:
        bpy.utils.unregister_class(old)
    bpy.utils.register_class(ExportCurves)
    menus = bpy.types.TOPBAR_MT_file_export
    for draw in [draw for draw in getattr(menus.draw, "_draw_funcs", []) if draw.__name__ == _menu.__name__]:
        menus.remove(draw)
    menus.append(_menu)


class Arguments(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise Trouble(message)


def arguments() -> argparse.Namespace:
    parser = Arguments(prog=f"blender --python {NAME}.blend.py --", description="The keys of a motion, in Blender.")
    parser.add_argument("--armature", metavar="NAME", help="the armature that is to move, or that has moved")
    parser.add_argument("--export", metavar="FILE", help="write the edited keys to this .curves.json file")
    parser.add_argument("--action", metavar="NAME", help="the action to export; else the armature's own")
    parser.add_argument("--open", metavar="FILE", help="open this .blend file first")
    parser.add_argument("--save", metavar="FILE", help="write a .blend file when all is done")
    words = sys.argv[1:]  # of `python walk.blend.py`; Blender leaves what stands behind -- to scripts
    if "--" in words:
        words = words[words.index("--") + 1 :]
    elif not sys.argv[0].endswith(".py"):
        words = []
    return parser.parse_args(words)


def main() -> None:
    try:
        if bpy.app.version < (4, 4):
            raise Trouble(f"needs Blender 4.4 or newer, this is {bpy.app.version_string}")
        given = arguments()
        if given.open:
            _file(bpy.ops.wm.open_mainfile, given.open)
        if given.export:
            export(given.export, given.armature, given.action)
        else:
            build(given.armature)
        if given.save:
            _file(bpy.ops.wm.save_as_mainfile, given.save)
        if not bpy.app.background:
            add_to_menu()
    except Trouble as error:
        print(f"mocurve: error: {error}", file=sys.stderr)
        if bpy.app.background:
            sys.exit(2)


def _file(operator: Any, path: str) -> None:
    try:
        operator(filepath=os.path.abspath(path))
    except RuntimeError as error:
        raise Trouble(" ".join(str(error).split())) from error
