"""Runs in Blender's own Python: does the jobs of a file and writes what it found beside it.

    python in_blender.py jobs.json

A job is {"do": name of a function here, ...}; its answer is a dictionary of numbers and lists.
"""

from __future__ import annotations

import json
import os
import runpy
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np

TO_Z_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


def fresh() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)


def script(path: str) -> dict[str, Any]:
    """What a .blend.py file defines; nothing of it has run yet."""
    return runpy.run_path(path, run_name="loaded")


def only_armature() -> Any:
    return next(thing for thing in bpy.data.objects if thing.type == "ARMATURE")


def quaternions(matrices: np.ndarray) -> np.ndarray:
    """wxyz (N, 4) of rotations (N, 3, 3)."""
    from mathutils import Matrix

    return np.array([Matrix(m.tolist()).to_quaternion() for m in matrices])


def poses(rig: Any, names: list[str], frames: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rotations away from rest (F, J, 3, 3) and places (F, J, 3) of bones, in the axes and units of the armature."""
    rests = np.array([rig.data.bones[name].matrix_local.to_3x3() for name in names])
    matrices = np.empty((len(frames), len(names), 4, 4))
    bones = [rig.pose.bones[name] for name in names]
    for row, frame in enumerate(frames):
        bpy.context.scene.frame_set(int(np.floor(frame)), subframe=float(frame % 1.0))
        matrices[row] = [bone.matrix for bone in bones]
    turns = matrices[..., :3, :3]
    size = np.linalg.norm(turns, axis=-2, keepdims=True)
    return np.einsum("fjab,jcb->fjac", turns / size, rests), matrices[..., :3, 3]


def degrees_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(...) between rotation matrices (..., 3, 3)."""
    sine = np.linalg.norm(a - b, axis=(-2, -1)) / np.sqrt(8.0)
    return np.degrees(2.0 * np.arcsin(np.clip(sine, 0.0, 1.0)))


def compared(rig: Any, job: dict[str, Any], axes: np.ndarray, scale: float, first: float = 0.0) -> dict[str, float]:
    """Largest difference of rotations (degrees, seen from the clip's origin) and places (units of the clip)."""
    said = np.load(job["reference"])
    have = [k for k, name in enumerate(job["bones"]) if name in rig.data.bones]
    turns, places = poses(rig, [job["bones"][k] for k in have], said["frames"] + first)
    turns = np.einsum("ba,fjbc,cd->fjad", axes, turns, axes)
    return {
        "compared": len(have),
        "degrees": float(degrees_between(turns, said["turns"][:, have]).max(initial=0.0)),
        "units": float(np.abs(places @ axes / scale - said["places"][:, have]).max(initial=0.0)),
    }


# -- jobs ----------------------------------------------------------------------------------------------
def native(job: dict[str, Any]) -> dict[str, Any]:
    """The script's own armature and action."""
    fresh()
    code = script(job["script"])
    code["build"]()
    rig, scene = only_armature(), bpy.context.scene
    answer: dict[str, Any] = compared(rig, job, np.eye(3), 1.0)
    action = rig.animation_data.action
    curves = action.layers[0].strips[0].channelbag(rig.animation_data.action_slot).fcurves
    points = [point for curve in curves for point in curve.keyframe_points]
    answer |= {
        "fps": scene.render.fps / scene.render.fps_base,
        "range": [scene.frame_start, scene.frame_end],
        "names": rig.data.bones.keys(),
        "keys": len(points),
        "modes": sorted({bone.rotation_mode for bone in rig.pose.bones}),
        "kinds": sorted({point.interpolation for point in points}),
        "handles": sorted({point.handle_left_type for point in points}),
        "world": [list(rig.matrix_world @ rig.pose.bones[name].head) for name in job["bones"]],
    }
    code["export"](job["script"] + ".curves.json")
    return answer


def menu(job: dict[str, Any]) -> dict[str, Any]:
    """The script run twice, as from the text editor; File > Export; what is locked; a curve of the user's own."""
    fresh()
    for _ in range(2):
        code = script(job["script"])
        code["build"]()
        code["add_to_menu"]()
    rig = only_armature()
    rig.pose.bones[0].keyframe_insert("scale", frame=3)
    entries = [draw for draw in bpy.types.TOPBAR_MT_file_export.draw._draw_funcs if draw.__name__ == "_menu"]
    done = bpy.ops.export_anim.mocurve_curves(filepath=job["out"])
    try:
        bpy.ops.export_anim.mocurve_curves(filepath=job["out"] + "/no/folder")
    except RuntimeError as error:
        refused = str(error)
    locks = {b.name: [list(b.lock_location), list(b.lock_rotation), list(b.lock_scale)] for b in rig.pose.bones}
    answer = {"armatures": [r.name for r in bpy.data.objects if r.type == "ARMATURE"], "locks": locks}
    return {**answer, "actions": bpy.data.actions.keys(), "menu": len(entries), "done": list(done), "refused": refused}


def edited(job: dict[str, Any]) -> dict[str, Any]:
    """Edits as job["edits"] says, [path of the F-curve, index, name in EDITS, ...]; export, and the values of the
    edited F-curves at every half frame."""
    fresh()
    code = script(job["script"])
    code["build"]()
    rig = only_armature()
    bag = rig.animation_data.action.layers[0].strips[0].channelbag(rig.animation_data.action_slot)
    values = []
    for path, index, edit, *rest in job["edits"]:
        curve = bag.fcurves.find(path, index=index)
        EDITS[edit](curve, *rest)
        curve.update()
        values.append([curve.evaluate(frame) for frame in np.arange(0, job["frames"] - 0.5, 0.5)])
    code["export"](job["out"])
    return {"values": values}


def _move(curve: Any, key: int, frames: float, value: float) -> None:
    """As the graph editor moves a selected key: its handles go with it."""
    point = curve.keyframe_points[key]
    for part in (point.co, point.handle_left, point.handle_right):
        part[0] += frames
        part[1] += value


def _kind(curve: Any, key: int, kind: str) -> None:
    curve.keyframe_points[key].interpolation = kind


def _lengthen(curve: Any, key: int, factor: float) -> None:
    point = curve.keyframe_points[key]
    point.handle_right_type = point.handle_left_type = "FREE"
    point.handle_right = [c + factor * (h - c) for c, h in zip(point.co, point.handle_right, strict=True)]


def _remove(curve: Any, key: int) -> None:
    curve.keyframe_points.remove(curve.keyframe_points[key])


def _noise(curve: Any) -> None:
    curve.modifiers.new("NOISE")


EDITS = {"move": _move, "kind": _kind, "lengthen": _lengthen, "remove": _remove, "noise": _noise}


def read_in(job: dict[str, Any]) -> Any:
    """The armature that Blender's own importer makes of a file of another format."""
    fresh()
    bpy.context.scene.render.fps, bpy.context.scene.render.fps_base = job["fps"]
    kind, path = job["format"], job["file"]
    if kind == "bvh":
        bpy.ops.import_anim.bvh(filepath=path, frame_start=1, use_fps_scale=False, update_scene_fps=False)
    elif kind == "fbx":
        bpy.ops.import_scene.fbx(filepath=path, anim_offset=0.0)
    else:
        bpy.ops.import_scene.gltf(filepath=path)
    return only_armature()


def imported(job: dict[str, Any]) -> dict[str, Any]:
    """A file of another format as Blender shows it."""
    rig = read_in(job)
    world = np.array(rig.matrix_world)[:3, :3]
    scale = float(np.cbrt(np.linalg.det(world)))
    axes = (world / scale).T @ TO_Z_UP  # clip to armature
    first = 1.0 if job["format"] == "bvh" else 0.0  # that importer knows no frame 0
    return compared(rig, job, axes, job["metres"] / scale, first)


def existing(job: dict[str, Any]) -> dict[str, Any]:
    """The clip on an armature that an importer made, and that was scaled; then an edit of its root."""
    rig = read_in({**job, "fps": [30, 1.0]})
    for other in bpy.context.selected_objects:
        other.select_set(False)
    rig.select_set(True)
    bpy.context.view_layer.objects.active = rig
    rig.scale *= job["size"]
    bpy.ops.object.transform_apply(location=False, rotation=True, scale=True)
    code = script(job["script"])
    code["build"](rig.name)
    size = job["size"] * (0.01 if job["format"] == "glb" else 1.0)
    answer = compared(rig, job, TO_Z_UP, size)
    out = job["script"] + ".back.json"
    code["export"](out, rig.name)
    action = rig.animation_data.action
    bag = action.layers[0].strips[0].channelbag(rig.animation_data.action_slot)
    root = job["bones"][0]
    mode = rig.pose.bones[root].rotation_mode
    turning = "rotation_quaternion" if mode == "QUATERNION" else "rotation_euler"
    for name, index in ((turning, 1), ("location", 0)):
        _move(bag.fcurves.find(f'pose.bones["{root}"].{name}', index=index), -1, 0.0, 0.125)
    edited = job["script"] + ".edited.curves.json"
    code["export"](edited, rig.name, action.name)
    turns, places = poses(rig, job["bones"], np.arange(0.0, bpy.context.scene.frame_end + 1))
    shown = job["script"] + ".shown.npz"
    np.savez(shown, turns=np.einsum("ba,fjbc,cd->fjad", TO_Z_UP, turns, TO_Z_UP), places=places @ TO_Z_UP / size)
    return {**answer, "actions": len(bpy.data.actions), "out": out, "edited": edited, "shown": shown, "mode": mode}


def main() -> None:
    jobs = Path(sys.argv[1])
    answers = []
    for job in json.loads(jobs.read_text("utf-8")):
        try:
            answers.append(globals()[job["do"]](job))
        except Exception as error:  # told by the test that reads the answer
            answers.append({"error": f"{type(error).__name__}: {error}"})
    jobs.with_suffix(".answers.json").write_text(json.dumps(answers), "utf-8")
    sys.stdout.flush()
    os._exit(0)  # Blender as a module may hang where it cleans up after operators of a script


main()
