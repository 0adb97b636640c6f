"""FBX, binary 7.4, without Autodesk's library: a skeleton of limb nodes and an animation. Written only.

Curves are in KTime, a whole number of 1/46186158000 s, and single precision. A joint's channels "ZYX" are FBX's
rotation order XYZ, the axis that turns first named first; nothing is pre-rotated: the curves are the clip's own.
"""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..errors import FileError, Mismatch, OptionError
from ..keyed import KeyedMotion
from ..motion import Clip, Motion
from ..skeleton import AXES
from ._fbx_nodes import CREATION_TIME, FILE_ID, VERSION, Node, Value, document, object_name
from ._files import Path, encoded, replacing
from ._rig import Curve, Joint, Rig, different, rig, single, stem

PROFILES = {
    "baked": "a key at every frame, straight lines between: the same in every program",
    "keys": "a reduced clip's curves, for Maya and MotionBuilder; Blender and three.js drop their tangents",
}

_FBX = "FBX"  # in messages
SECOND = 46186158000  # KTime
ORDERS = ("XYZ", "XZY", "YZX", "YXZ", "ZXY", "ZYX")  # FBX's numbers for them; the axis that turns first stands first
_RATES = {120: 1, 100: 2, 60: 3, 50: 4, 48: 5, 30: 6, 25: 10, 24: 11, 1000: 12, 96: 15, 72: 16}
_NTSC_RATES = {30: 9, 24: 13, 60: 17, 120: 18}  # times 1000/1001
_CUSTOM_RATE = 14
_LINEAR, _CUBIC, _USER, _BREAK = 0x4, 0x8, 0x400, 0x800
_THIRDS = np.array(3333 | 3333 << 16, np.int32).view(np.float32)  # both weights 1/3, in 1/9999, in the bits of a float
_FLOAT32_OFF = 1e-3  # degrees or length units that rounding to single precision may take before it is told
_PROPERTY_TYPES = {  # type and label that a property's line repeats
    "Lcl Translation": ("Lcl Translation", "", "A"),
    "Lcl Rotation": ("Lcl Rotation", "", "A"),
    "Lcl Scaling": ("Lcl Scaling", "", "A"),
    "RotationOrder": ("enum", "", ""),
    "RotationActive": ("bool", "", ""),
    "InheritType": ("enum", "", ""),
    "ScalingMax": ("Vector3D", "Vector", ""),
    "DefaultAttributeIndex": ("int", "Integer", ""),
    "TimeMode": ("enum", "", ""),
    "ActiveAnimStackName": ("KString", "", ""),
}


class _Scene(NamedTuple):
    """What is gathered on the way: the objects, and which hangs on which (and at which of its properties)."""

    objects: list[Node]
    links: list[Node]
    ids: Iterator[int]

    def add(self, kind: str, name: str, label: str, subtype: str, *inside: Node) -> np.int64:
        key = np.int64(next(self.ids))
        self.objects.append(Node(kind, (key, object_name(name, label), subtype), inside))
        return key

    def link(self, child: np.int64, parent: np.int64, where: str | None = None) -> None:
        values: tuple[Value, ...] = ("OO", child, parent) if where is None else ("OP", child, parent, where)
        self.links.append(Node("C", values))


def read(path: Path) -> Motion:
    """Always FileError: curves of another program's rig are no curves of a joint's channels."""
    raise FileError("FBX is only written; .bvh, .glb and .curves.json are read back", path)


def write(path: Path, clip: Clip, profile: str = "baked") -> None:
    """Write skeleton and curves; lengths are the clip's own, with their unit. OptionError for `keys` of a clip without.

    Warns where keys become samples, where a name had to change, where the unit is a guess, and where single precision
    is coarse.
    """
    if profile == "keys" and not isinstance(clip, KeyedMotion):
        raise OptionError(f"the profile keys of .fbx holds keys, a {type(clip).__name__} has none: reduce it first")
    names = different(clip.skeleton.names, _FBX)
    encoded("".join(names), path)
    body = rig(clip, names, sampled=profile == "baked")
    if profile == "baked" and isinstance(clip, KeyedMotion) and clip.keys:
        warnings.warn(f"{clip.keys} keys become samples at every frame: the profile keys keeps them", stacklevel=3)
    title = encoded(stem(path), path).decode()
    data = document(_file(body, title))
    with replacing(path) as file:
        file.write(data)


def _file(body: Rig, title: str) -> list[Node]:
    scene = _Scene([], [], itertools.count(1_000_000))
    models = _skeleton(scene, body)
    moving = title if any(joint.curves for joint in body.joints) else ""
    if moving:
        _animation(scene, body, models, title)
    return [
        _header(),
        Node("FileId", (FILE_ID,)),
        Node("CreationTime", (CREATION_TIME,)),
        Node("Creator", ("mocurve",)),
        _settings(body),
        _documents(moving),
        Node("References"),
        _definitions(scene.objects),
        Node("Objects", (), scene.objects),
        Node("Connections", (), scene.links),
        _takes(body, moving),
    ]


# -- the objects -------------------------------------------------------------------------------------
def _skeleton(scene: _Scene, body: Rig) -> list[np.int64]:
    models: list[np.int64] = []
    for joint in body.joints:
        bone = scene.add("NodeAttribute", joint.name, "NodeAttribute", "LimbNode", Node("TypeFlags", ("Skeleton",)))
        model = scene.add("Model", joint.name, "Model", "LimbNode", *_model(joint))
        scene.link(model, models[joint.parent] if joint.parent >= 0 else np.int64(0))
        scene.link(bone, model)
        models.append(model)
    return models


def _model(joint: Joint) -> Iterator[Node]:
    yield Node("Version", (232,))
    yield _properties(
        ("RotationOrder", ORDERS.index(joint.order[::-1])),
        ("RotationActive", 1),
        ("InheritType", 1),
        ("ScalingMax", 0.0, 0.0, 0.0),
        ("DefaultAttributeIndex", 0),
        ("Lcl Translation", *joint.offset),
        ("Lcl Rotation", 0.0, 0.0, 0.0),
        ("Lcl Scaling", 1.0, 1.0, 1.0),
    )
    yield Node("Shading", (True,))
    yield Node("Culling", ("CullingOff",))


def _animation(scene: _Scene, body: Rig, models: list[np.int64], title: str) -> None:
    end = _ktime(np.array([body.end]))[0]
    span = [(f"{part}{edge}", at) for part in ("Local", "Reference") for edge, at in (("Start", 0), ("Stop", end))]
    spans = _properties(*[(name, np.int64(at)) for name, at in span])
    stack = scene.add("AnimationStack", title, "AnimStack", "", spans)
    layer = scene.add("AnimationLayer", "BaseLayer", "AnimLayer", "")
    scene.link(layer, stack)
    for joint, model in zip(body.joints, models, strict=True):
        for kind in joint.moves:
            node = _curve_node(scene, joint, kind, body.keyed)
            scene.link(node, layer)
            scene.link(node, model, "Lcl Translation" if kind == "position" else "Lcl Rotation")
    off = max(float(np.abs(single(c.values, _FBX) - c.values).max()) for j in body.joints for c in j.curves.values())
    if off > _FLOAT32_OFF:
        warnings.warn(f"FBX keeps single precision: values are off by up to {off:.2g} degrees or units", stacklevel=5)


def _curve_node(scene: _Scene, joint: Joint, kind: str, keyed: bool) -> np.int64:
    """The curves of a joint's positions or rotations, and what stands between them and the joint."""
    rest = [(f"d|{axis}", value) for axis, value in zip(AXES, joint.rest(kind), strict=True)]
    letter = "T" if kind == "position" else "R"
    node = scene.add("AnimationCurveNode", letter, "AnimCurveNode", "", _properties(*rest))
    for axis, (name, value) in zip(AXES, rest, strict=True):
        curve = joint.curves.get(axis + kind)
        if curve is None and not keyed:
            curve = _still(value, joint)
        if curve is not None:
            scene.link(scene.add("AnimationCurve", "", "AnimCurve", "", *_curve(curve, value)), node, name)
    return node


def _still(value: float, joint: Joint) -> Curve:
    """Three.js wants the three axes of sampled curves at the same times."""
    times = next(iter(joint.curves.values())).times
    return Curve(times, np.full(len(times), value))


def _curve(curve: Curve, rest: float) -> Iterator[Node]:
    times = _ktime(curve.times)
    if (np.diff(times) <= 0).any():
        raise Mismatch("two keys of a curve are less than FBX's 1/46186158000 s apart")
    yield Node("Default", (rest,))
    yield Node("KeyVer", (4008,))
    yield Node("KeyTime", (times,))
    yield Node("KeyValueFloat", (single(curve.values, _FBX),))
    flags, data = _attributes(curve)
    yield Node("KeyAttrFlags", (flags,))
    yield Node("KeyAttrDataFloat", (data.reshape(-1),))
    yield Node("KeyAttrRefCount", (np.full(len(flags), len(times) // len(flags), np.int32),))


def _attributes(curve: Curve) -> tuple[np.ndarray, np.ndarray]:
    """Flags (N,) and data (N, 4) of N sets: one for all where all is straight, else one for each key.

    The data are the slope on the right, the slope on the left of the next key, both their weights, no velocities.
    """
    if curve.straight:
        return np.array([_LINEAR], np.int32), np.array([[0, 0, _THIRDS, 0]], np.float32)
    broken = curve.slopes != curve.in_slopes
    flags = np.where(broken, _CUBIC | _USER | _BREAK, _CUBIC | _USER).astype(np.int32)
    data = np.zeros((len(flags), 4), np.float32)
    data[:, 0] = single(curve.slopes, _FBX)
    data[:-1, 1] = single(curve.in_slopes[1:], _FBX)
    data[:, 2] = _THIRDS
    return flags, data


def _ktime(seconds: np.ndarray) -> np.ndarray:
    ticks = np.rint(seconds * SECOND)
    if np.abs(ticks).max() >= 2.0**63:
        raise Mismatch(f"a time of {np.abs(seconds).max():g} s is more than FBX can hold")
    return ticks.astype(np.int64)


# -- what stands around them ---------------------------------------------------------------------------
def _properties(*rows: tuple[str | Value, ...]) -> Node:
    return Node(
        "Properties70", (), [Node("P", (name, *_kind(str(name), values[0]), *values)) for name, *values in rows]
    )


def _kind(name: str, value: Value) -> tuple[str, str, str]:
    if name in _PROPERTY_TYPES:
        return _PROPERTY_TYPES[name]
    if name.startswith("d|"):
        return "Number", "", "A"
    if isinstance(value, np.int64):
        return "KTime", "Time", ""
    return ("double", "Number", "") if isinstance(value, float) else ("int", "Integer", "")


def _header() -> Node:
    stamp = [
        Node("Version", (1000,)),
        Node("Year", (1970,)),
        Node("Month", (1,)),
        Node("Day", (1,)),
        Node("Hour", (10,)),
    ]
    stamp += [Node(name, (0,)) for name in ("Minute", "Second", "Millisecond")]
    inside = [
        Node("FBXHeaderVersion", (1003,)),
        Node("FBXVersion", (VERSION,)),
        Node("EncryptionType", (0,)),
        Node("CreationTimeStamp", (), stamp),
        Node("Creator", ("mocurve",)),
    ]
    return Node("FBXHeaderExtension", (), inside)


def _settings(body: Rig) -> Node:
    """Y is up, Z to the front; a length unit in centimetres; frames a second."""
    centimetres, fps = 100.0 * body.metres, 1.0 / body.frame_time
    rows: list[tuple[str | Value, ...]] = [
        ("UpAxis", 1),
        ("UpAxisSign", 1),
        ("FrontAxis", 2),
        ("FrontAxisSign", 1),
        ("CoordAxis", 0),
        ("CoordAxisSign", 1),
        ("OriginalUpAxis", 1),
        ("OriginalUpAxisSign", 1),
        ("UnitScaleFactor", centimetres),
        ("OriginalUnitScaleFactor", centimetres),
        ("TimeMode", _time_mode(fps)),
        ("TimeSpanStart", np.int64(0)),
        ("TimeSpanStop", np.int64(_ktime(np.array([body.end]))[0])),
        ("CustomFrameRate", fps),
    ]
    return Node("GlobalSettings", (), [Node("Version", (1000,)), _properties(*rows)])


def _time_mode(fps: float) -> int:
    for rates, scale in ((_RATES, 1.0), (_NTSC_RATES, 1000 / 1001)):
        for rate, number in rates.items():
            if abs(fps - rate * scale) < 1e-6 * rate:
                return number
    return _CUSTOM_RATE


def _documents(title: str) -> Node:
    rows = [_properties(("ActiveAnimStackName", title)), Node("RootNode", (np.int64(0),))]
    scene = Node("Document", (np.int64(999_999), "Scene", "Scene"), rows)
    return Node("Documents", (), [Node("Count", (1,)), scene])


def _definitions(objects: list[Node]) -> Node:
    kinds = ["GlobalSettings", *(node.name for node in objects)]
    rows = [Node("ObjectType", (kind,), [Node("Count", (kinds.count(kind),))]) for kind in dict.fromkeys(kinds)]
    return Node("Definitions", (), [Node("Version", (100,)), Node("Count", (len(kinds),)), *rows])


def _takes(body: Rig, title: str) -> Node:
    takes = [Node("Current", (title,))]
    if title:
        end = np.int64(_ktime(np.array([body.end]))[0])
        times = [Node(name, (np.int64(0), end)) for name in ("LocalTime", "ReferenceTime")]
        takes.append(Node("Take", (title,), [Node("FileName", (f"{title}.tak",)), *times]))
    return Node("Takes", (), takes)
