"""Runs in Blender's own Python: exports a BVH clip as glTF in several ways, and says where Blender has the joints.

    python export_in_blender.py clip.bvh folder

Makes sampled.glb, keys.glb, beside.gltf and scaled.glb in the folder, and places.json: {file: {"names", "places"}}, the
places (F, J, 3) in metres with Y up.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import bpy

WAYS: dict[str, dict[str, Any]] = {  # file: options of the exporter
    "sampled.glb": {"export_format": "GLB"},
    "keys.glb": {"export_format": "GLB", "export_force_sampling": False},
    "beside.gltf": {"export_format": "GLTF_SEPARATE"},
    "scaled.glb": {"export_format": "GLB"},
}


def places(rig: Any) -> dict[str, Any]:
    scene = bpy.context.scene
    rows = []
    for frame in range(scene.frame_start, scene.frame_end + 1):
        scene.frame_set(frame)
        heads = [rig.matrix_world @ bone.head for bone in rig.pose.bones]
        rows.append([[x, z, -y] for x, y, z in heads])
    return {"names": [bone.name for bone in rig.pose.bones], "places": rows}


def only_some_keys(action: Any) -> None:
    """Every 7th key, with curves between them."""
    for curve in action.fcurves:
        for place in range(len(curve.keyframe_points) - 1, -1, -1):
            if place % 7:
                curve.keyframe_points.remove(curve.keyframe_points[place], fast=True)
        for key in curve.keyframe_points:
            key.interpolation = "BEZIER"
        curve.update()


def main(clip: str, folder: str) -> None:
    found = {}
    for name, options in WAYS.items():
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.import_anim.bvh(
            filepath=clip, frame_start=1, update_scene_fps=True, update_scene_duration=True, rotate_mode="QUATERNION"
        )
        rig = bpy.context.object
        if name == "keys.glb":
            only_some_keys(rig.animation_data.action)
        if name == "scaled.glb":
            rig.scale, rig.location, rig.rotation_euler = (0.02, 0.02, 0.02), (1, 2, 3), (0.1, 0.2, 0.3)
        bpy.ops.export_scene.gltf(filepath=str(Path(folder) / name), export_yup=True, **options)
        found[name] = places(rig)
    (Path(folder) / "places.json").write_text(json.dumps(found))


main(*sys.argv[1:])
