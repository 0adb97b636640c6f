"""Maya ASCII as far as our scenes use it, taken apart and evaluated as Maya's reference says."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import NamedTuple

import numpy as np

import mocurve as mc
from mocurve import rotation

ORDERS = ["xyz", "yzx", "zxy", "xzy", "yxz", "zyx"]  # the enumeration of .rotateOrder
RATES = {"game": 15, "film": 24, "pal": 25, "ntsc": 30, "show": 48, "palf": 50, "ntscf": 60, "millisec": 1000}
NTSC = {"23.976fps": 24, "29.97fps": 30, "59.94fps": 60}


class Curve(NamedTuple):
    """times: seconds. values: degrees or centimetres. slopes, arriving: per second, None for straight lines."""

    frames: np.ndarray
    times: np.ndarray
    values: np.ndarray
    slopes: np.ndarray | None
    arriving: np.ndarray | None
    locked: list[str]


class Scene(NamedTuple):
    """nodes: name to (kind, parent or "", {attribute: words}); curves: by plug, "Hips.tx"."""

    units: list[str]
    nodes: dict[str, tuple[str, str, dict[str, list[str]]]]
    curves: dict[str, Curve]


def read(path: Path) -> Scene:
    text = path.read_text(encoding="utf-8")
    assert text.startswith("//Maya ASCII ")
    assert text.endswith("// End\n")
    assert max(map(len, text.splitlines())) < 1000
    code = "\n".join(line for line in text.splitlines() if not line.startswith("//"))
    nodes: dict[str, tuple[str, str, dict[str, list[str]]]] = {}
    units, links, node = [], {}, ""
    for command in code.split(";\n"):
        words = shlex.split(command.strip().rstrip(";"))
        if words[:1] == ["currentUnit"]:
            units = words[1:]
        elif words[:1] == ["createNode"]:
            node = words[words.index("-n") + 1]
            assert node not in nodes
            nodes[node] = (words[1], words[words.index("-p") + 1] if "-p" in words else "", {})
        elif words[:1] == ["setAttr"]:
            _set(nodes[node][2], words[1:])
        elif words[:1] == ["connectAttr"]:
            links[words[2]] = words[1].removesuffix(".o")
    rate = units[units.index("-t") + 1]
    fps = NTSC[rate] / 1.001 if rate in NTSC else RATES.get(rate) or float(rate.removesuffix("fps"))
    assert set(links.values()) == {name for name, (kind, *_) in nodes.items() if kind.startswith("animCurve")}
    return Scene(units, nodes, {plug: _curve(nodes[name], fps) for plug, name in links.items()})


def places(scene: Scene, times: np.ndarray) -> np.ndarray:
    """(T, J, 3) centimetres of the joints, in the file's order."""
    joints = {name: node for name, node in scene.nodes.items() if node[0] == "joint"}
    placed: dict[str, np.ndarray] = {}
    turned: dict[str, np.ndarray] = {}
    for name, (_, parent, attributes) in joints.items():
        assert attributes[".ssc"] == ["no"]
        shift = np.tile(np.array(attributes[".t"], float), (len(times), 1))
        angles = np.zeros_like(shift)
        for rows, letter in ((shift, "t"), (angles, "r")):
            for axis in range(3):
                curve = scene.curves.get(f"{name}.{letter}{'xyz'[axis]}")
                if curve is not None:
                    rows[:, axis] = _at(curve, times)
        order = ORDERS[int(attributes[".ro"][0])][::-1].upper()  # the last one turns first, about axes that stand still
        turn = rotation.from_euler(angles[:, ["XYZ".index(axis) for axis in order]], order)
        placed[name] = placed[parent] + rotation.rotate(turned[parent], shift) if parent else shift
        turned[name] = rotation.mul(turned[parent], turn) if parent else turn
    return np.stack(list(placed.values()), axis=1)


def _set(attributes: dict[str, list[str]], words: list[str]) -> None:
    count = int(words[1]) if words[0] == "-s" else None
    words = words[2:] if count is not None else words
    name, _, span = words[0].partition("[")
    values = words[3:] if words[1:2] == ["-type"] else words[1:]
    if count is not None:
        assert span == (f"0:{count - 1}]" if count > 1 else "0]")
        assert len(values) == count * (2 if name == ".ktv" else 1)
    attributes[name] = values


def _curve(node: tuple[str, str, dict[str, list[str]]], fps: float) -> Curve:
    kind, _, attributes = node
    assert re.fullmatch("animCurveT[AL]", kind)
    assert attributes[".wgt"] == ["no"]
    frames, values = np.array(attributes[".ktv"], float).reshape(-1, 2).T
    slopes = []
    for letter in "oi":
        if f".k{letter}x" in attributes:
            x, y = (np.array(attributes[f".k{letter}{axis}"], float) for axis in "xy")
            assert np.allclose(np.hypot(x, y), 1.0, rtol=1e-12)
            slopes.append(np.degrees(y / x) if kind == "animCurveTA" else y / x)
    assert attributes[".tan"] == ["1" if slopes else "2"]
    return Curve(frames, frames / fps, values, *(slopes or (None, None)), attributes.get(".ktl", []))


def _at(curve: Curve, times: np.ndarray) -> np.ndarray:
    if curve.slopes is None:
        return np.interp(times, curve.times, curve.values)
    return mc.HermiteCurve(curve.times, curve.values, curve.slopes, curve.arriving).at(times)
