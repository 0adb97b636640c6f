"""Maya ASCII: joints, and an animation curve for each channel. Written only.

Lengths are centimetres, which Maya calculates in whatever it shows; times are frames of the scene's time unit. A
tangent is a direction (seconds; radians or centimetres), kix and kiy where it arrives, kox and koy where it leaves; a
curve that is not weighted takes a third of the interval as its length, which makes it a Hermite curve. Source: Maya's
node reference, animCurve and joint.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator

import numpy as np

from ..errors import FileError
from ..motion import Clip, Motion
from ._files import Path, replacing
from ._rig import Curve, Joint, Rig, frame_numbers, identifiers, rig, scaled

ORDERS = ("xyz", "yzx", "zxy", "xzy", "yxz", "zyx")  # Maya's numbers for them; the axis that turns first stands first
_NAMED_RATES = {15: "game", 24: "film", 25: "pal", 30: "ntsc", 48: "show", 50: "palf", 60: "ntscf"}
_RATES = (2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 40, 75, 80, 100, 120, 125, 150, 200, 240, 250, 300, 375, 400, 500, 600, 750)
_FAST_RATES = (1200, 1500, 2000, 3000, 6000)
_NTSC_RATES = {"23.976fps": 24, "29.97fps": 30, "47.952fps": 48, "59.94fps": 60}  # times 1000/1001
TIME_UNITS = {  # frames a second
    **{name: float(rate) for rate, name in _NAMED_RATES.items()},
    **{f"{rate}fps": float(rate) for rate in _RATES + _FAST_RATES},
    **{name: rate * 1000 / 1001 for name, rate in _NTSC_RATES.items()},
    "millisec": 1000.0,
}
_FIXED, _LINEAR = 1, 2
_A_LINE = 8  # keys
_SCRIPT = "sceneConfigurationScriptNode"
_EVERY_SCENE = ("persp", "top", "front", "side", "time1", _SCRIPT)  # nodes that have these names already


def read(path: Path) -> Motion:
    """Always FileError: a Maya scene is a program, and only Maya runs it."""
    raise FileError("Maya scenes are only written; .bvh, .glb and .curves.json are read back", path)


def write(path: Path, clip: Clip) -> None:
    """Write joints and curves: keys with their tangents, samples as a key at every frame with straight lines between.

    Warns where a name had to change, where the unit is a guess, and where Maya has no time unit of the clip's rate.
    """
    names = identifiers(clip.skeleton.names, "Maya", _EVERY_SCENE)
    body = rig(clip, names)
    unit = _time_unit(1.0 / body.frame_time)
    with replacing(path) as file:
        for text in _scene(body, unit):
            file.write(text.encode())


def _time_unit(fps: float) -> str:
    """Maya's unit of that rate, else of the nearest that is a multiple of it, else the nearest by ratio."""
    for name, rate in TIME_UNITS.items():
        if abs(rate - fps) < 1e-6 * rate:
            return name
    steps = {name: rate / fps for name, rate in TIME_UNITS.items()}
    whole = [name for name, step in steps.items() if step > 1 and abs(step - round(step)) < 1e-6]
    name = min(whole or steps, key=lambda name: abs(np.log(steps[name])))
    places = "at parts of frames" if not whole else f"{round(steps[name])} frames apart"
    warnings.warn(
        f"Maya has no time unit of {fps:.6g} frames a second: in its {name} the keys lie {places}", stacklevel=4
    )
    return name


def _scene(body: Rig, unit: str) -> Iterator[str]:
    yield "//Maya ASCII 2018 scene\n//Codeset: UTF-8\n"
    yield f'requires maya "2018";\ncurrentUnit -l centimeter -a degree -t {unit};\nfileInfo "application" "mocurve";\n'
    cm = 100.0 * body.metres
    for joint in body.joints:
        yield _joint(joint, body.joints[joint.parent].name if joint.parent >= 0 else "", cm)
    taken = {joint.name for joint in body.joints}
    links = []
    frame = 1.0 / TIME_UNITS[unit]
    for joint in body.joints:
        for kind, curve in joint.curves.items():
            attribute = f"{'translate' if kind.endswith('position') else 'rotate'}{kind[0]}"
            node = f"{joint.name}_{attribute}"
            while node in taken:  # a joint of that name
                node += "_"
            taken.add(node)
            yield _curve(node, curve, cm if kind.endswith("position") else None, frame)
            links.append(f'connectAttr "{node}.o" "{joint.name}.{attribute[0]}{kind[0].lower()}";\n')
    last = frame_numbers(np.array([body.end]), frame)[0]
    span = f"playbackOptions -min 0 -max {last:.17g} -ast 0 -aet {last:.17g} "
    yield 'createNode script -n "' + _SCRIPT + '";\n'
    yield f'\tsetAttr ".b" -type "string" "{span}";\n\tsetAttr ".st" 6;\n'
    yield "".join(links)
    yield "// End\n"


def _joint(joint: Joint, parent: str, cm: float) -> str:
    """Rest place and rotation order; no orientation of its own, and no compensation for its parent's scale."""
    place = " ".join(map(repr, scaled(np.array(joint.offset), cm).tolist()))
    title = f'createNode joint -n "{joint.name}"' + (f' -p "{parent}"' if parent else "")
    return (
        f'{title};\n\tsetAttr ".t" -type "double3" {place} ;\n'
        f'\tsetAttr ".ro" {ORDERS.index(joint.order[::-1].lower())};\n\tsetAttr ".ssc" no;\n'
    )


def _curve(node: str, curve: Curve, cm: float | None, frame: float) -> str:
    """A curve node; cm: centimetres in a length unit, None for degrees. frame: seconds in a frame of Maya's."""
    count = len(curve.times)
    values = curve.values if cm is None else scaled(curve.values, cm)
    keys = np.column_stack((frame_numbers(curve.times, frame), values))
    pairs = [f"{time:.17g} {value!r}" for time, value in keys.tolist()]
    lines = [
        f'createNode animCurve{"TA" if cm is None else "TL"} -n "{node}";',
        f'\tsetAttr ".tan" {_LINEAR if curve.straight else _FIXED};',
        '\tsetAttr ".wgt" no;',
        _array("ktv", pairs, count),
    ]
    if not curve.straight:
        broken = curve.slopes != curve.in_slopes
        if broken.any():
            lines.append(_array("ktl", ["no" if b else "yes" for b in broken], count))
        for letter, slopes in (("i", curve.in_slopes), ("o", curve.slopes)):
            away = _directions(np.radians(slopes) if cm is None else scaled(slopes, cm))
            lines += [
                _array(f"k{letter}{axis}", map(repr, column), count) for axis, column in zip("xy", away, strict=True)
            ]
    return "\n".join(lines) + "\n"


def _directions(slopes: np.ndarray) -> list[list[float]]:
    """Unit vectors (x, y) of slopes y/x."""
    length = np.hypot(1.0, slopes)
    return [(1.0 / length).tolist(), (slopes / length).tolist()]


def _array(name: str, items: Iterator[str] | list[str] | map[str], count: int) -> str:
    """A setAttr of `count` elements, some on each line: Maya reads no line longer than its buffer."""
    items = list(items)
    rows = [" ".join(items[i : i + _A_LINE]) for i in range(0, count, _A_LINE)]
    index = f"0:{count - 1}" if count > 1 else "0"
    return f'\tsetAttr -s {count} ".{name}[{index}]" ' + "\n\t\t".join(rows) + ";"
