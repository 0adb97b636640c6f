"""Feet on a path: `follow` against Blender's Follow Path constraint, same clip and same path (optional: needs bpy).

    python benchmarks/blender_follow.py

Blender as it is usually done: the clip walks on the spot (the straight line from its first to its last frame, at even
speed, is taken out of its root), its armature has a Follow Path constraint with Follow Curve on a NURBS curve with the
same control points, and the offset is keyed so that the body goes along the curve. "even": at the clip's mean speed,
what the root does before and behind that stays in the armature. "own": keyed on every frame, as far along as `follow`
has it, and only what lies aside of the clip's own path stays in the armature; nobody does that by hand, but it is the
most that the constraint can do. Both are read from the evaluated scene.

Paths are as long as the clip's own. Slide: how fast the balls of both feet go over the ground in the contacts of the
clip, cm/s (`feet.skate`); all three have the clip's frames.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import replace
from io import StringIO
from pathlib import Path as File
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from follow import CM, clip
from follow_cycles import tours

import mocurve as mc
from mocurve import kinematics, planar
from mocurve.edit._body import carried
from mocurve.feet.legs import legs
from mocurve.feet.skate import skate
from mocurve.path_fit import gone, roots

try:
    import bpy
except ImportError:
    sys.exit('this benchmark needs Blender as a Python module: with Python 3.11, pip install "bpy==4.5.*"')

CLIPS = ["12_01", "02_01", "16_15", "02_03"]  # that go straight: there is a line to take out
SPARE = 1.02  # paths are a little longer than the clip's way
NEAR = 1e-3  # file units: joints in Blender are where the armature's place says
FIRST = 1  # where Blender's import puts the first frame when it is asked for 0
GOAL = "slide of follow / Follow Path: least 1/20"


def paths(length: float) -> dict[str, mc.Path]:
    """Those of follow_cycles.py, and an arc of 1 m; metres."""
    around = np.linspace(0.0, length, max(24, round(8 * length)))
    arc = np.stack([1.0 - np.cos(around), np.sin(around)], axis=1)
    return {**tours(length), "arc of 1 m": mc.Path(100.0 / CM * arc)}


def on_the_spot(motion: mc.Motion) -> tuple[mc.Motion, float]:
    """The clip without the straight line that it goes, looking along +z, and how long that is."""
    ends = roots(motion)[[0, -1]][:, [0, 2]]
    ahead = ends[1] - ends[0]
    line = ends[0] + np.linspace(0.0, 1.0, motion.frames)[:, None] * ahead
    turn = np.full(motion.frames, -np.arctan2(ahead[0], ahead[1]))
    return carried(motion, _back(turn, line), np.zeros(motion.frames)), float(np.linalg.norm(ahead))


def beside(motion: mc.Motion, own: mc.Path) -> tuple[mc.Motion, np.ndarray]:
    """The clip without its own path, looking along +z, and how far along it every frame (F,) is."""
    distance = own.table().distance(gone(motion))
    place, heading = own.at(distance)
    return carried(motion, _back(-heading, place), np.zeros(motion.frames)), distance


def _back(turn: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Planar transforms (F, 3) that take places (F, 2) to the origin and turn by (F,)."""
    nothing = np.zeros(len(turn))
    shift = np.stack([nothing, -place[:, 0], -place[:, 1]], axis=1)
    return planar.compose(np.stack([turn, nothing, nothing], axis=1), shift)


def constrained(still: mc.Motion, path: mc.Path, distance: np.ndarray, folder: File) -> mc.Motion:
    """What a Follow Path constraint makes of a clip on the spot whose frames are so far (F,) along a path."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    mc.write(folder / "still.bvh", with_all_axes(still))
    with redirect_stdout(StringIO()):
        bpy.ops.import_anim.bvh(filepath=str(folder / "still.bvh"), frame_start=0, update_scene_duration=True)
    armature = bpy.context.object
    constraint = armature.constraints.new("FOLLOW_PATH")
    constraint.target = curve_of(path)
    constraint.use_curve_follow = constraint.use_fixed_location = True
    constraint.forward_axis, constraint.up_axis = "TRACK_NEGATIVE_Y", "UP_Z"  # +z of the file
    for frame, along in enumerate(distance.tolist()):
        constraint.offset_factor = min(max(along / path.length, 0.0), 1.0)
        constraint.keyframe_insert("offset_factor", frame=FIRST + frame)
    by, joints = np.zeros((still.frames, 3)), []
    for frame in range(still.frames):
        bpy.context.scene.frame_set(FIRST + frame)
        placed = armature.evaluated_get(bpy.context.evaluated_depsgraph_get())
        matrix = np.array(placed.matrix_world)
        by[frame] = np.arctan2(matrix[1, 0], matrix[0, 0]), matrix[0, 3], -matrix[1, 3]
        joints.append([placed.matrix_world @ placed.pose.bones[name].head for name in still.skeleton.names[:3]])
    made = carried(still, by, np.zeros(still.frames))
    there = np.array(joints)[..., [0, 2, 1]] * [1.0, 1.0, -1.0]
    assert np.abs(kinematics.world(made)[:, :3] - there).max() < NEAR
    return made


def with_all_axes(motion: mc.Motion) -> mc.Motion:
    """The same with three rotations a joint: Blender reads no BVH with fewer, as Acclaim skeletons have them."""
    skeleton = motion.skeleton
    kinds = [
        () if end else own if parent < 0 else ("Zrotation", "Xrotation", "Yrotation")
        for own, parent, end in zip(skeleton.channels, skeleton.parents, skeleton.end_sites, strict=True)
    ]
    full = replace(skeleton, channels=tuple(kinds), limits=())
    values = np.zeros((motion.frames, full.channel_count))
    values[:, full.parents[full.channel_joints] < 0] = motion.values[:, skeleton.parents[skeleton.channel_joints] < 0]
    return kinematics.with_rotations(mc.Motion(full, values, motion.frame_time), kinematics.rotations(motion))


def curve_of(path: mc.Path) -> Any:
    """A NURBS curve with the path's control points: the same curve."""
    curve = bpy.data.curves.new("path", "CURVE")
    curve.dimensions, curve.twist_mode, curve.use_path, curve.resolution_u = "3D", "Z_UP", True, 64
    spline = curve.splines.new("NURBS")
    spline.points.add(len(path.points) - 1)
    points = np.column_stack(
        [path.points[:, 0], -path.points[:, 1], 0.0 * path.points[:, 0], 0.0 * path.points[:, 0] + 1.0]
    )
    spline.points.foreach_set("co", points.ravel())
    spline.order_u, spline.use_endpoint_u, spline.resolution_u = path.degree + 1, True, 64
    made = bpy.data.objects.new("path", curve)
    bpy.context.scene.collection.objects.link(made)
    return made


def sliding(motion: mc.Motion) -> Callable[[mc.Motion], float]:
    """How fast the balls of both feet go over the ground in the contacts of a clip, for what became of the clip."""
    both = legs(motion)
    balls = {motion.skeleton.names[leg.ball] for leg in both}
    listed = [contact for contact in mc.contacts(motion) if contact.joint in balls]

    def slide(made: mc.Motion) -> float:
        found = skate(made, listed, both, motion)
        assert found is not None
        return found.speed

    return slide


def main() -> None:
    warnings.simplefilter("ignore")  # no frame rate in Acclaim files
    print(f"Blender {bpy.app.version_string}; {GOAL}")
    print(f"{'slide, cm/s':22}{'clip':>8}{'even':>8}{'own':>8}{'follow':>8}{'let go':>8}")
    worst = 0.0
    for name in CLIPS:
        motion = replace(clip(name), history=())
        motion = motion[1:] if name in ("02_01", "16_15") else motion
        slide = sliding(motion)
        edit = mc.PathEdit.of(motion)
        (even, way), (own, distance) = on_the_spot(motion), beside(motion, edit.path)
        for shape, path in paths(SPARE * CM / 100.0 * edit.path.length).items():
            with TemporaryDirectory() as folder:
                theirs = [
                    slide(constrained(still, path, along, File(folder)))
                    for still, along in ((even, np.linspace(0.0, way, motion.frames)), (own, distance))
                ]
            made = edit.laid(path)
            ours = slide(made)
            worst = max(worst, ours / min(theirs))
            numbers = "".join(f"{value:8.2f}" for value in (slide(motion), *theirs, ours))
            feet = made.history[-1]["measured"]["feet"]
            print(f"{name:10}{shape:12}{numbers}{feet['released']:8}", flush=True)
    print(f"follow / the better of both, at most: {worst:.4f}")


if __name__ == "__main__":
    main()
