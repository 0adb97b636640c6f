"""USD as text (.usda): joints as transforms with splines, or a UsdSkel animation. Written only, without USD's library.

A time code is a frame. Knots are Bézier with tangents of a third of the interval, (width in frames, slope per frame),
which makes a spline the clip's own Hermite curve. A joint's operations are its place and then its rotations in the
order of its channels, which is how USD applies them too. Source: OpenUSD's documents of UsdGeomXformable, UsdSkel, Ts.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator, Sequence

import numpy as np

from .. import kinematics, rotation
from ..errors import FileError, Mismatch
from ..keyed import KeyedMotion
from ..motion import Clip, Motion
from ..skeleton import AXES, Skeleton
from ._files import Path, encoded, replacing
from ._rig import Curve, Joint, Rig, frame_numbers, identifier, identifiers, rig, scaled, single, stem

PROFILES = {
    "splines": "a transform for each joint, a reduced clip's curves as splines, exact (USD 25.05 and later)",
    "skel": "a UsdSkel skeleton, its joints at every frame in single precision",
}
_DEPTH = 1000  # joints below one another: paths and readers' stacks grow with it
_INDENT = 40  # blanks at most
_A_LINE = 8  # samples
_SKEL = "UsdSkel"  # in messages


def read(path: Path) -> Motion:
    """Always FileError: a stage of another program is no skeleton of channels."""
    raise FileError("USD is only written; .bvh, .glb and .curves.json are read back", path)


def write(path: Path, clip: Clip, profile: str = "splines") -> None:
    """Write keys as splines and samples as time samples, or with the profile `skel` a UsdSkel animation of all frames.

    Warns where keys become samples, where a name had to change, and where the length unit is a guess. Mismatch for a
    chain of more than 1,000 joints.
    """
    names = identifiers(clip.skeleton.names, "USD")
    prim = identifier(stem(path))
    originals = [_quoted(encoded(name, path).decode()) for name in clip.skeleton.names]
    _check_depth(clip.skeleton)
    body = rig(clip, names, sampled=profile == "skel")
    if profile == "skel" and isinstance(clip, KeyedMotion) and clip.keys:
        warnings.warn(f"{clip.keys} keys become samples at every frame: the profile splines keeps them", stacklevel=3)
    inside = _skel(body, clip.sample(), prim, originals) if profile == "skel" else _joints(body, originals)
    with replacing(path) as file:
        file.write(_head(body, prim, "SkelRoot" if profile == "skel" else "Xform").encode())
        for text in inside:
            file.write(text.encode())
        file.write(b"}\n")


def _check_depth(body: Skeleton) -> None:
    depths: list[int] = []
    for parent in body.parents.tolist():
        depths.append(depths[parent] + 1 if parent >= 0 else 1)
    if max(depths, default=0) > _DEPTH:
        raise Mismatch(
            f"a chain of {max(depths)} joints: USD files are written with at most {_DEPTH} below one another"
        )


def _head(body: Rig, prim: str, kind: str) -> str:
    fps, last = repr(1.0 / body.frame_time), max(body.frames - 1, 0)
    return (
        f'#usda 1.0\n(\n    defaultPrim = "{prim}"\n    doc = "written by mocurve"\n    endTimeCode = {last}\n'
        f"    framesPerSecond = {fps}\n    metersPerUnit = {body.metres!r}\n    startTimeCode = 0\n"
        f'    timeCodesPerSecond = {fps}\n    upAxis = "Y"\n)\n\ndef {kind} "{prim}"\n{{\n'
    )


# -- joints as transforms ------------------------------------------------------------------------------
def _joints(body: Rig, originals: Sequence[str]) -> Iterator[str]:
    open_joints: list[int] = []
    for index, joint in enumerate(body.joints):
        while open_joints and open_joints[-1] != joint.parent:
            open_joints.pop()
            yield f"{_blanks(len(open_joints) + 1)}}}\n"
        outer, inner = _blanks(len(open_joints) + 1), _blanks(len(open_joints) + 2)
        changed = originals[index] != f'"{joint.name}"'
        note = f" (\n{inner}customData = {{ string name = {originals[index]} }}\n{outer})" if changed else ""
        yield f'\n{outer}def Xform "{joint.name}"{note}\n{outer}{{\n'
        for line in _operations(joint, body.frame_time):
            yield f"{inner}{line}\n"
        open_joints.append(index)
    for depth in range(len(open_joints), 0, -1):
        yield f"{_blanks(depth)}}}\n"


def _operations(joint: Joint, frame_time: float) -> Iterator[str]:
    """The attributes that place and turn a joint, and last their order."""
    names = []
    if "position" in joint.moves:
        for axis, value in zip(AXES, joint.offset, strict=True):
            names.append(f"xformOp:translate{axis}")
            yield f"double {names[-1]} = {value!r}"
            if f"{axis}position" in joint.curves:
                yield from _animated(names[-1], joint.curves[f"{axis}position"], frame_time)
    else:
        names.append("xformOp:translate")
        yield f"double3 {names[-1]} = {joint.offset!r}"
    for kind, curve in joint.curves.items():
        if kind.endswith("rotation"):
            names.append(f"xformOp:rotate{kind[0]}")
            yield f"double {names[-1]} = 0"
            yield from _animated(names[-1], curve, frame_time)
    listed = ", ".join(f'"{name}"' for name in names)
    yield f"uniform token[] xformOpOrder = [{listed}]"


def _animated(name: str, curve: Curve, frame_time: float) -> Iterator[str]:
    frames = [f"{frame:.17g}" for frame in frame_numbers(curve.times, frame_time).tolist()]
    if curve.straight:
        yield f"double {name}.timeSamples = {{"
        pairs = [f"{frame}: {value!r}," for frame, value in zip(frames, curve.values.tolist(), strict=True)]
        yield from (" ".join(pairs[i : i + _A_LINE]) for i in range(0, len(pairs), _A_LINE))
    else:
        yield f"double {name}.spline = {{"
        yield "bezier,"
        yield from _knots(frames, curve, frame_time)
    yield "}"


def _knots(frames: list[str], curve: Curve, frame_time: float) -> Iterator[str]:
    """A line a knot: arriving tangent but for the first, leaving tangent but for the last."""
    widths = (np.diff(frame_numbers(curve.times, frame_time)) / 3.0).tolist()
    arriving, leaving = (scaled(slopes, frame_time).tolist() for slopes in (curve.in_slopes, curve.slopes))
    for i, (frame, value) in enumerate(zip(frames, curve.values.tolist(), strict=True)):
        before = f"; pre ({widths[i - 1]!r}, {arriving[i]!r})" if i else ""
        after = f"; post curve ({widths[i]!r}, {leaving[i]!r})" if i < len(widths) else ""
        yield f"{frame}: {value!r}{before}{after},"


# -- UsdSkel ---------------------------------------------------------------------------------------------
def _skel(body: Rig, motion: Motion, prim: str, originals: Sequence[str]) -> Iterator[str]:
    paths: list[str] = []
    places = np.array([joint.offset for joint in body.joints]).reshape(-1, 3)
    for i, joint in enumerate(body.joints):
        paths.append(f"{paths[joint.parent]}/{joint.name}" if joint.parent >= 0 else joint.name)
        if joint.parent >= 0:
            with np.errstate(over="ignore"):  # is looked for below
                places[i] += places[joint.parent]
    single(places, _SKEL)
    joints = ", ".join(f'"{path}"' for path in paths)
    rests = [joint.offset for joint in body.joints]
    yield '    def Skeleton "skeleton" (\n        prepend apiSchemas = ["SkelBindingAPI"]\n    )\n    {\n'
    yield f"        uniform token[] joints = [{joints}]\n"
    yield f"        uniform token[] jointNames = [{', '.join(originals)}]\n"
    yield f"        uniform matrix4d[] bindTransforms = [{', '.join(map(_matrix, places.tolist()))}]\n"
    yield f"        uniform matrix4d[] restTransforms = [{', '.join(map(_matrix, rests))}]\n"
    yield f"        rel skel:animationSource = </{prim}/animation>\n    }}\n\n"
    yield f'    def SkelAnimation "animation"\n    {{\n        uniform token[] joints = [{joints}]\n'
    yield f"        half3[] scales = [{', '.join(['(1, 1, 1)'] * len(paths))}]\n"
    turns = rotation.unroll(kinematics.rotations(motion))
    shifts = np.empty((motion.frames, len(paths), 3))
    shifts[:] = motion.skeleton.offsets
    moving = ~motion.skeleton.rotation_channels
    shifts[:, motion.skeleton.channel_joints[moving], motion.skeleton.channel_axes[moving]] = motion.values[:, moving]
    yield from _samples("quatf[] rotations", turns)
    yield from _samples("float3[] translations", single(shifts, _SKEL))
    yield "    }\n"


def _samples(title: str, rows: np.ndarray) -> Iterator[str]:
    """Rows (F, J, n) as a line a frame."""
    form = ", ".join([f"({', '.join(['%.9g'] * rows.shape[2])})"] * rows.shape[1])
    yield f"        {title}.timeSamples = {{\n"
    for frame, row in enumerate(rows):
        yield f"            {frame}: [{form % tuple(row.ravel().tolist())}],\n"
    yield "        }\n"


def _matrix(place: Sequence[float]) -> str:
    x, y, z = place
    return f"( (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), ({x!r}, {y!r}, {z!r}, 1) )"


# -- words -------------------------------------------------------------------------------------------------
def _blanks(depth: int) -> str:
    return " " * min(4 * depth, _INDENT)


def _quoted(text: str) -> str:
    escaped = re.sub(r'[\\"]', r"\\\g<0>", text)
    return '"' + re.sub(r"[\0-\x1f\x7f]", lambda found: f"\\x{ord(found[0]):02x}", escaped) + '"'
