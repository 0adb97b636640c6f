"""The head of a C3D file: its first block, and the parameters in their groups (the C3D user guide, c3d.org)."""

from __future__ import annotations

from typing import NamedTuple, NoReturn

import numpy as np

from ..errors import FileError
from ._files import Path

BLOCK = 512  # bytes; all places in a file are counted in blocks, from 1
MOST = 255 * BLOCK  # bytes that the parameters can take
_MAGIC = 0x50
_CHARACTERS, _BYTES, _INTEGERS, _FLOATS = -1, 1, 2, 4
_SIZES = {_CHARACTERS: 1, _BYTES: 1, _INTEGERS: 2, _FLOATS: 4}


class Numbers(NamedTuple):
    """How a processor stores numbers: byte order, and whether its floats are those of a VAX."""

    order: str
    vax: bool

    def integers(self, data: bytes) -> np.ndarray:
        return np.frombuffer(data, f"{self.order}i2")

    def floats(self, data: bytes) -> np.ndarray:
        if not self.vax:
            return _wide(np.frombuffer(data, f"{self.order}f4"))
        words = np.frombuffer(data, "<u2").reshape(-1, 2)  # the upper half comes first
        bits = words[:, 0].astype(np.uint32) << 16 | words[:, 1]
        result = _wide(bits.view(np.float32)) / 4.0  # another bias, and a point before the hidden bit
        return np.where(bits & 0x7F800000 == 0, 0.0, result)


def _wide(numbers: np.ndarray) -> np.ndarray:
    with np.errstate(invalid="ignore"):  # a NaN that signals is a NaN
        return numbers.astype(np.float64)


PROCESSORS = {84: Numbers("<", False), 85: Numbers("<", True), 86: Numbers(">", False)}


class Head(NamedTuple):
    """What the first block says, and the parameters: numbers, or texts, by "POINT:RATE"."""

    numbers: Numbers
    points: int
    analog: int  # numbers a frame that follow the points
    first: int
    last: int
    scale: float
    start: int  # block of the data
    rate: float
    values: dict[str, np.ndarray]
    texts: dict[str, list[str]]


def head(data: bytes, path: Path) -> Head:
    """The head from the first bytes of a file, as many as BLOCK + MOST and more if its parameters begin later."""
    if len(data) < BLOCK:
        raise FileError(f"no C3D file: {len(data)} bytes, its first block has {BLOCK}", path)
    if data[1] != _MAGIC:
        raise FileError("no C3D file: its second byte is not 50 (hexadecimal)", path)
    at = (data[0] - 1) * BLOCK
    if at < 0 or at + 4 > len(data):
        raise FileError(f"the parameters begin at block {data[0]}, which is not there", path)
    if data[at + 3] not in PROCESSORS:
        raise FileError(f"processor 84, 85 or 86 expected at block {data[0]}, {data[at + 3]} found", path)
    numbers = PROCESSORS[data[at + 3]]
    words = numbers.integers(data[:48]).view(f"{numbers.order}u2").tolist()
    floats = numbers.floats(data[:48]).tolist()
    values, texts = _Parameters(data[at : at + MOST], numbers, path).read()
    return Head(numbers, words[1], words[2], words[3], words[4], floats[3], words[8], floats[5], values, texts)


class _Parameters:
    """Walks through the section of the parameters; never back, so that it ends."""

    def __init__(self, data: bytes, numbers: Numbers, path: Path):
        self.data, self.numbers, self.path = data, numbers, path
        self.groups: dict[int, str] = {}
        self.found: list[tuple[int, str, np.ndarray | list[str]]] = []

    def read(self) -> tuple[dict[str, np.ndarray], dict[str, list[str]]]:
        at = 4
        while self.taken(at, 1) != b"\0":
            length, group = (int(number) for number in np.frombuffer(self.taken(at, 2), np.int8))
            at += 2
            name = self.taken(at, abs(length)).decode("latin-1").strip().upper()
            at += abs(length)
            step = int(self.numbers.integers(self.taken(at, 2))[0])
            if step < 0:
                self.fail(at, f"{name!r} points back by {-step} bytes")
            if group < 0:
                self.groups[-group] = name
            else:
                self.found.append((group, name, self.value(at + 2, name)))
            if step == 0:
                break
            at += step
        values: dict[str, np.ndarray] = {}
        texts: dict[str, list[str]] = {}
        for group, name, value in self.found:
            full = f"{self.groups.get(group, group)}:{name}"
            if isinstance(value, list):
                texts.setdefault(full, value)
            else:
                values.setdefault(full, value)
        return values, texts

    def value(self, at: int, name: str) -> np.ndarray | list[str]:
        kind, count = (int(number) for number in np.frombuffer(self.taken(at, 2), np.int8))
        if kind not in _SIZES or not 0 <= count <= 7:
            self.fail(at, f"{name!r} has type {kind} and {count} dimensions")
        sizes = list(self.taken(at + 2, count))
        number = int(np.prod(sizes, dtype=object))  # at most 255^7, not yet believed
        data = self.taken(at + 2 + count, number * _SIZES[kind])
        if kind == _CHARACTERS:
            width = sizes[0] if sizes else 1
            return [data[k : k + width].decode("latin-1").strip(" \0") for k in range(0, number, max(width, 1))]
        if kind == _FLOATS:
            return self.numbers.floats(data)
        return (self.numbers.integers(data) if kind == _INTEGERS else np.frombuffer(data, np.int8)).astype(np.float64)

    def taken(self, at: int, size: int) -> bytes:
        if at + size > len(self.data):
            self.fail(at, f"{size} bytes expected, {max(len(self.data) - at, 0)} are there")
        return self.data[at : at + size]

    def fail(self, at: int, what: str) -> NoReturn:
        raise FileError(f"parameters, byte {at}: {what}", self.path)
