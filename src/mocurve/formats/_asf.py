"""Acclaim skeletons (ASF): bones with a direction, a length, axes of their own and degrees of freedom.

Source: M. Schafer, Acclaim Skeleton File Definition V1.10, 1994-95. There, and in what Vicon writes, angles turn about
fixed axes in the order given: "axis 0 0 20 XYZ" is R = Rz Ry Rx, and so is "dof rx ry rz".
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Iterator
from itertools import islice
from typing import NamedTuple, NoReturn

import numpy as np

from .. import rotation
from ..errors import FileError, UnknownName
from ..info import CMU_METRES
from ._bvh_header import MAX_JOINTS, MAX_NAME, found, hint, number
from ._files import Path, opened

MAX_BYTES = 16 << 20  # a skeleton of MAX_JOINTS bones has a quarter of that
TURNS, SHIFTS, STRETCH = ("rx", "ry", "rz"), ("tx", "ty", "tz"), "l"
_CMU_LENGTH = 0.45  # ":units length" of the CMU database: its values are inches times that
_MOST_UNKNOWN = 20  # words of other programs that are left aside
_LARGEST = 1e100  # far from what a number holds, so that nothing overflows
_SEPARATORS = str.maketrans("(),", "   ")
_ENDLESS = ("inf", "+inf", "-inf")
Row = tuple[int, list[str]]  # line of the file, its words


class Bone(NamedTuple):
    """line: where it begins in the file; way: (3,) of length 1, where it points, 0 for the root; axis: (4,) wxyz, what
    turns the axes of the body to its own; dof: "rx" ... "tz", "l", in the order of the numbers in AMC; limits: the
    least and the largest of each, degrees or length units, empty where the file says none."""

    name: str
    line: int
    way: np.ndarray
    length: float
    axis: np.ndarray
    dof: tuple[str, ...]
    limits: tuple[tuple[float, float], ...] = ()

    @property
    def end(self) -> np.ndarray:
        """(3,) from where it starts to where it ends: there its children start."""
        return self.way * self.length


class Body(NamedTuple):
    """bones: depth first, the root first; parents: index of each one's parent, -1 for the root; place: (3,) of the
    root; unit: metres in a length unit, None where the file does not say; degrees: of angles in AMC that do not say;
    codec: of the names."""

    bones: list[Bone]
    parents: list[int]
    place: np.ndarray
    unit: float | None
    degrees: bool
    codec: str


def read(path: Path) -> Body:
    """The skeleton in an ASF file. FileError, with the line, for all that is not surely one."""
    with opened(path) as file:
        data = file.read(MAX_BYTES + 1)
    if len(data) > MAX_BYTES:
        raise FileError(f"a skeleton of at most {MAX_BYTES >> 20} MB expected", path)
    text, codec = _decoded(data, path)
    return _Reader(text, path).body(codec)


def no_bone(name: str, bones: Iterable[str]) -> str:
    """What is told of a name that no bone has; only some names are compared with it, which may be many and long."""
    return str(UnknownName("bone", name[:60], [known for known in islice(bones, 500) if len(known) <= 60]))


def _decoded(data: bytes, path: Path) -> tuple[str, str]:
    try:
        return data.decode("utf-8-sig"), "utf-8"
    except UnicodeDecodeError:
        warnings.warn(f"{os.fspath(path)}: the names are not UTF-8; they are read as Latin-1", stacklevel=6)
        return data.decode("latin-1"), "latin-1"


class _Reader:
    """One file: its sections, each read by the method of its name."""

    def __init__(self, text: str, path: Path):
        self.path, self.line = path, 1
        self.sections = self._split(text)
        self.degrees = True
        self.unknown: set[str] = set()

    def fail(self, message: str, line: int | None = None) -> NoReturn:
        raise FileError(message, self.path, self.line if line is None else line)

    def body(self, codec: str) -> Body:
        unit = self._units(self.sections.get(":units", []))
        root, place = self._root(self._section(":root"))
        bones = {bone.name: bone for bone in [root, *self._bones(self._section(":bonedata"))]}
        children = self._children(self._section(":hierarchy"), bones)
        order, parents = self._depth_first(bones, children)
        return Body([bones[name] for name in order], parents, place, unit, self.degrees, codec)

    # -- sections --------------------------------------------------------------------------------
    def _split(self, text: str) -> dict[str, list[Row]]:
        sections: dict[str, list[Row]] = {}
        rows: list[Row] | None = None
        for self.line, line in enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), 1):
            words = line.partition("#")[0].translate(_SEPARATORS).split()
            if words and words[0].startswith(":"):
                keyword = words[0].lower()
                if keyword in sections:
                    self.fail(f"{keyword} expected once, found again")
                rows = sections[keyword] = []
            elif words and rows is None:
                self.fail(f"a keyword such as :version expected, {found(words[0])}")
            elif words and rows is not None:
                rows.append((self.line, words))
        return sections

    def _section(self, keyword: str) -> list[Row]:
        if keyword not in self.sections:
            self.fail(f"{keyword} expected, the end of the file found")
        return self.sections[keyword]

    def _units(self, rows: list[Row]) -> float | None:
        unit = None
        for self.line, words in rows:
            key, given = words[0].lower(), words[1:]
            if key == "length":
                length = self._numbers(given, 1)[0]
                if not length > 0:
                    self.fail(f"a length above 0 expected, {found(given[0])}")
                unit = CMU_METRES if length == _CMU_LENGTH else None
            elif key == "angle":
                self.degrees = self._one(given, "deg", "rad", "degrees", "radians").startswith("deg")
            elif key != "mass":
                self._leave(key)
        return unit

    def _root(self, rows: list[Row]) -> tuple[Bone, np.ndarray]:
        dof: tuple[str, ...] | None = None
        order, place, angles = "xyz", np.zeros(3), np.zeros(3)
        start = self.line = rows[0][0] if rows else self.line
        for self.line, words in rows:
            key, given = words[0].lower(), words[1:]
            if key == "order":
                dof = self._dof(given, (*SHIFTS, *TURNS))
            elif key == "axis":
                order = self._order(given)
            elif key == "position":
                place = self._numbers(given, 3)
            elif key == "orientation":
                angles = self._numbers(given, 3)
            else:
                self._leave(key)
        if dof is None:
            self.fail("the order of the root's numbers expected in :root")
        return Bone("root", start, np.zeros(3), 0.0, self._turn(angles, order), dof), place

    def _bones(self, rows: list[Row]) -> Iterator[Bone]:
        names = {"root"}
        blocks = self._blocks(rows)
        for block in blocks:
            bone = self._bone(block)
            if bone.name in names:
                self.fail(f"bone {bone.name!r} again; each name stands for one bone, and root for the root", bone.line)
            names.add(bone.name)
            if len(names) > MAX_JOINTS:
                self.fail(f"at most {MAX_JOINTS} bones expected")
            yield bone

    def _blocks(self, rows: list[Row]) -> Iterator[list[Row]]:
        """What stands between each begin and its end, the begin included."""
        block: list[Row] = []
        for self.line, words in rows:
            word = words[0].lower()
            if (word == "begin") == bool(block):
                self.fail(f"{'end' if block else 'begin'} expected, {found(words[0])}")
            if word == "end":
                yield block
                block = []
            else:
                block.append((self.line, words))
        if block:
            self.fail("end expected, the end of the section found")

    def _bone(self, block: list[Row]) -> Bone:
        start, name = block[0][0], ""
        values: dict[str, np.ndarray] = {}
        dof: tuple[str, ...] = ()
        order, bounded = "xyz", False
        limits: list[float] = []
        for self.line, words in block[1:]:
            key, given = words[0].lower(), words[1:]
            if key == "limits" or (bounded and self._is_limit(words[0])):
                bounded, limits = True, limits + self._limits(given if key == "limits" else words)
                continue
            bounded = False
            if key == "name":
                name = self._name(given)
            elif key in ("direction", "length"):
                values[key] = self._numbers(given, 3 if key == "direction" else 1)
            elif key == "axis":
                values[key] = self._numbers(given[:3], 3)
                order = self._order(given[3:]) if given[3:] else order
            elif key == "dof":
                dof = self._dof(given, (*TURNS, *SHIFTS, STRETCH))
            elif key not in ("id", "bodymass", "cofmass"):
                self._leave(key)
        self.line = start
        if not name or "direction" not in values or "length" not in values:
            self.fail(f"name, direction and length expected in the bone {name!r}")
        if len(limits) not in (0, 2 * len(dof)):
            self.fail(
                f"two limits for each of {len(dof)} dof expected in the bone {name!r}, {len(limits)} numbers found"
            )
        length, far = float(values["length"][0]), float(np.linalg.norm(values["direction"]))
        if length < 0 or (length > 0 and far == 0):
            self.fail("a length of at least 0 and a direction that is not zero expected")
        way = values["direction"] / (far or 1.0)
        axis = self._turn(values.get("axis", np.zeros(3)), order)
        return Bone(name, start, way, length, axis, dof, self._ranges(name, dof, limits))

    def _ranges(self, name: str, dof: tuple[str, ...], limits: list[float]) -> tuple[tuple[float, float], ...]:
        pairs = list(zip(limits[::2], limits[1::2], strict=True))
        if any(low > high for low, high in pairs):
            warnings.warn(
                f"{os.fspath(self.path)}:{self.line}: the limits of bone {name!r} are left aside: a lower one is "
                "above the higher",
                stacklevel=7,
            )
            return ()
        turns = [kind in TURNS and not self.degrees for kind in dof]
        return tuple(
            (float(np.degrees(low)), float(np.degrees(high))) if turn else (low, high)
            for (low, high), turn in zip(pairs, turns, strict=False)
        )

    def _children(self, rows: list[Row], bones: dict[str, Bone]) -> dict[str, list[str]]:
        children: dict[str, list[str]] = {name: [] for name in bones}
        above: dict[str, str] = {"root": ""}
        blocks = list(self._blocks(rows))
        if len(blocks) != 1:
            self.fail("one begin and one end expected in :hierarchy")
        for self.line, names in blocks[0][1:]:
            for name in names:
                if name not in bones:
                    self.fail(no_bone(name, bones))
            for child in names[1:]:
                if child in above:
                    self.fail(
                        f"bone {child!r} hangs on {above[child]!r} already" if above[child] else "root is no child"
                    )
                above[child] = names[0]
                children[names[0]].append(child)
        return children

    def _depth_first(self, bones: dict[str, Bone], children: dict[str, list[str]]) -> tuple[list[str], list[int]]:
        order: list[str] = []
        parents: list[int] = []
        waiting = [("root", -1)]
        while waiting:
            name, parent = waiting.pop()
            waiting += [(child, len(order)) for child in reversed(children[name])]
            order.append(name)
            parents.append(parent)
        if len(order) < len(bones):
            hanging = set(order)
            name = next(name for name in bones if name not in hanging)  # left alone, or in a ring
            self.fail(f"bone {name!r} does not hang on the root in :hierarchy", bones[name].line)
        return order, parents

    # -- words -----------------------------------------------------------------------------------
    def _leave(self, key: str) -> None:
        if key not in self.unknown:
            self.unknown.add(key)
            if len(self.unknown) > _MOST_UNKNOWN:
                self.fail(f"{key[:40]!r} is not known, and neither are {_MOST_UNKNOWN} words before it")
            warnings.warn(f"{os.fspath(self.path)}:{self.line}: {key[:40]!r} is not known and left aside", stacklevel=7)

    def _one(self, given: list[str], *allowed: str) -> str:
        word = given[0].lower() if len(given) == 1 else ""
        if word not in allowed:
            self.fail(f"{' or '.join(allowed)} expected, {found(' '.join(given))}")
        return word

    def _name(self, given: list[str]) -> str:
        if len(given) != 1 or given[0].isdigit() or len(given[0]) > MAX_NAME:
            self.fail(f"a name of one word that is no number expected, {found(' '.join(given))}")
        if "\0" in given[0]:
            self.fail("NUL bytes in a name: this is no text file")
        return given[0]

    def _numbers(self, given: list[str], count: int) -> np.ndarray:
        values = np.array([number(word) for word in given[:count]])
        if len(given) != count:
            self.fail(f"{count} number{'s'[: count != 1]} expected, {len(given)} found")
        for word, value in zip(given, values, strict=True):
            if not abs(value) < _LARGEST:
                self.fail(f"a number expected, {found(word)}{hint(word)}")
        return values

    def _order(self, given: list[str]) -> str:
        word = "".join(given).lower()
        if sorted(word) != ["x", "y", "z"]:
            self.fail(f"an order of axes such as XYZ expected, {found(' '.join(given))}")
        return word

    def _dof(self, given: list[str], allowed: tuple[str, ...]) -> tuple[str, ...]:
        words = tuple(word.lower() for word in given)
        for word in words:
            if word not in allowed or words.count(word) > 1:
                self.fail(f"each of {' '.join(allowed)} at most once expected, {found(word)}")
        return words

    def _is_limit(self, word: str) -> bool:
        return word.lower() in _ENDLESS or np.isfinite(number(word))

    def _limits(self, words: list[str]) -> list[float]:
        """The numbers; infinite ones are allowed."""
        for word in words:
            if not self._is_limit(word):
                self.fail(f"a number or inf expected in limits, {found(word)}")
        return [float(word) if word.lower() in _ENDLESS else number(word) for word in words]

    def _turn(self, angles: np.ndarray, order: str) -> np.ndarray:
        """Quaternion (4,) of angles about x, y and z, as the file counts them, turned in the order of the axes."""
        degrees = angles if self.degrees else np.degrees(angles)
        last_first = order[::-1].upper()
        return rotation.from_euler(degrees[["XYZ".index(axis) for axis in last_first]], last_first)
