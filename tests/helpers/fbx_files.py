"""Binary FBX files taken apart, every byte of them looked at; played by three.js; and read by ufbx."""

from __future__ import annotations

import json
import struct
import subprocess
import sys
import zlib
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import node
import numpy as np
import pytest

SECOND = 46186158000
_NUMBERS = {"Y": "<h", "I": "<i", "L": "<q", "F": "<f", "D": "<d", "C": "<?"}
_ARRAYS = {"f": "<f4", "d": "<f8", "l": "<i8", "i": "<i4", "b": "?"}


class Record(NamedTuple):
    name: str
    values: list[Any]
    children: list[Record]

    def all(self, name: str) -> list[Record]:
        return [child for child in self.children if child.name == name]

    def one(self, name: str) -> Record:
        (found,) = self.all(name)
        return found

    @property
    def properties(self) -> dict[str, list[Any]]:
        """Values by name of its Properties70."""
        return {row.values[0]: row.values[4:] for row in self.one("Properties70").children}


class Curve(NamedTuple):
    """ticks (K,) of KTime, values (K,), flags (K,), data (K, 4): slope, next slope on the left, weights, velocities."""

    ticks: np.ndarray
    values: np.ndarray
    flags: np.ndarray
    data: np.ndarray


class Fbx(NamedTuple):
    """models: name to (parent's name or None, its properties), in file order; curves: by (model, property, axis)."""

    root: Record
    models: dict[str, tuple[str | None, dict[str, list[Any]]]]
    curves: dict[tuple[str, str, str], Curve]


def parse(data: bytes) -> Record:
    """The whole file as a record without a name; asserts that head, offsets, padding and foot are right."""
    assert data[:27] == b"Kaydara FBX Binary  \0\x1a\0" + struct.pack("<I", 7400)
    records, place = _records(data, 27, None)
    assert data[place : place + 16] == bytes.fromhex("fabcab09d0c8d466b176fb831cf7267e")
    assert data[place + 16 : place + 20] == bytes(4)
    foot = place + 20 + 16 - (place + 20) % 16
    assert data[place + 20 : foot] == bytes(foot - place - 20)
    assert data[foot:] == struct.pack("<I", 7400) + bytes(120) + bytes.fromhex("f85a8c6adef5d97eece90ce3758f290b")
    return Record("", [], records)


def read(path: Path) -> Fbx:
    """Models and curves of a file, put together by its connections."""
    root = parse(path.read_bytes())
    objects = {record.values[0]: record for record in root.one("Objects").children}
    assert len(objects) == len(root.one("Objects").children)
    names = {key: record.values[1].split("\0\1")[0] for key, record in objects.items()}
    up: dict[int, list[tuple[int, str]]] = {}
    for link in root.one("Connections").children:
        up.setdefault(link.values[1], []).append((link.values[2], "".join(link.values[3:])))
    models = {}
    curves = {}
    for key, record in objects.items():
        if record.name == "Model":
            ((parent, _),) = up[key]
            models[names[key]] = (names.get(parent), record.properties)
        if record.name == "AnimationCurve":
            ((curve_node, axis),) = up[key]
            (model, attribute) = next(link for link in up[curve_node] if link[1])
            curves[names[model], attribute, axis] = _curve(record)
    return Fbx(root, models, curves)


def played(path: Path, frame_time: float, frames: int) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """What three.js shows: places (F, J, 3) in file units, rotations (F, J, 4) wxyz, names of the animations."""
    node.require()
    command = ["node", "evaluate_fbx.mjs", str(path), repr(frame_time), str(frames)]
    done = subprocess.run(command, cwd=node.SCRIPTS, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    told = json.loads(done.stdout)
    return np.array(told["places"]), np.array(told["rotations"])[..., [3, 0, 1, 2]], told["clips"]


def told_by_ufbx(path: Path, times: Sequence[float] = ()) -> dict[str, Any]:
    """What the script ufbx_says.py prints: warnings, bones, fps, metres, curves with values at the times."""
    if find_spec("ufbx") is None:
        pytest.skip("needs ufbx: pip install ufbx==0.0.5")
    command = [sys.executable, str(Path(__file__).with_name("ufbx_says.py")), str(path), *map(repr, map(float, times))]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def _curve(record: Record) -> Curve:
    parts = {child.name: child.values[0] for child in record.children}
    repeats = parts["KeyAttrRefCount"]
    flags, data = parts["KeyAttrFlags"], parts["KeyAttrDataFloat"].reshape(-1, 4)
    assert len(flags) == len(data) == len(repeats)
    assert repeats.sum() == len(parts["KeyTime"]) == len(parts["KeyValueFloat"])
    return Curve(parts["KeyTime"], parts["KeyValueFloat"], np.repeat(flags, repeats), np.repeat(data, repeats, axis=0))


def _records(data: bytes, place: int, end: int | None) -> tuple[list[Record], int]:
    """Records from here to the null record; `end` is where that has to end."""
    records = []
    while any(data[place : place + 13]):
        after, count, size, length = struct.unpack_from("<IIIB", data, place)
        name = data[place + 13 : place + 13 + length].decode()
        inside = place + 13 + length
        values = list(_values(data[inside : inside + size], count))
        children: list[Record] = []
        if inside + size < after:
            children, reached = _records(data, inside + size, after)
            assert reached == after
        else:
            assert inside + size == after
            assert values  # programs expect a null record in what is otherwise empty
        records.append(Record(name, values, children))
        place = after
    place += 13
    assert end is None or place == end
    return records, place


def _values(data: bytes, count: int) -> Iterator[Any]:
    place = 0
    for _ in range(count):
        letter = chr(data[place])
        place += 1
        if letter in _NUMBERS:
            (value,) = struct.unpack_from(_NUMBERS[letter], data, place)
            place += struct.calcsize(_NUMBERS[letter])
        elif letter in "SR":
            (length,) = struct.unpack_from("<I", data, place)
            raw = data[place + 4 : place + 4 + length]
            value = raw.decode() if letter == "S" else raw
            place += 4 + length
        else:
            number, packed, length = struct.unpack_from("<III", data, place)
            raw = data[place + 12 : place + 12 + length]
            value = np.frombuffer(zlib.decompress(raw) if packed else raw, _ARRAYS[letter])
            assert len(value) == number
            place += 12 + length
        yield value
    assert place == len(data)
