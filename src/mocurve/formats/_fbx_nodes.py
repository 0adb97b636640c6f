"""Binary FBX 7.4: a tree of named records with values, as bytes.

Little endian. A record has the offset of its end, the count and size of its values, its name, values, records inside,
and 13 zero bytes after these; a value is a letter and its bytes. Autodesk keeps the format to itself: the layout is as
Blender's developers found it (code.blender.org, "FBX binary file format specification", 2013).
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..errors import Mismatch

MAGIC = b"Kaydara FBX Binary  \x00\x1a\x00"
VERSION = 7400
# Programs check the end of a file against its id and time of making; these three belong together.
FILE_ID = bytes.fromhex("28b32aebb624ccc2bfc8b02aa92bfcf1")
CREATION_TIME = "1970-01-01 10:00:00:000"
FOOT_ID = bytes.fromhex("fabcab09d0c8d466b176fb831cf7267e")
_LAST = bytes.fromhex("f85a8c6adef5d97eece90ce3758f290b")
_NO_RECORD = bytes(13)
_ALWAYS_OPEN = (
    "AnimationStack",
    "AnimationLayer",
)  # Blender and Maya end these with a null record, records inside or not
_WORTH_PACKING = 128  # bytes
_ARRAYS = {"float32": b"f", "float64": b"d", "int32": b"i", "int64": b"l"}

Value = bool | int | float | str | bytes | np.int64 | np.ndarray


class Node(NamedTuple):
    """A record. values: int is written as 32 bits, np.int64 as 64; float as 64; str as UTF-8; arrays as their type."""

    name: str
    values: Sequence[Value] = ()
    children: Sequence[Node] = ()


def document(nodes: Sequence[Node]) -> bytes:
    """A whole file; Mismatch where it would not fit the format's 32 bits for an offset."""
    head = MAGIC + struct.pack("<I", VERSION)
    parts, place = [head], len(head)
    for node in nodes:
        parts.append(_record(node, place))
        place += len(parts[-1])
    parts += [_NO_RECORD, FOOT_ID, bytes(4)]
    place += len(_NO_RECORD) + len(FOOT_ID) + 4
    parts += [bytes(16 - place % 16), struct.pack("<I", VERSION), bytes(120), _LAST]
    return b"".join(parts)


def object_name(name: str, kind: str) -> str:
    """How an object is called: "Hips", "Model"."""
    return f"{name}\0\1{kind}"


def _record(node: Node, place: int) -> bytes:
    """The bytes of a record that starts at this offset of the file."""
    name = node.name.encode()
    values = b"".join([_value(value) for value in node.values])
    inside, inner = [], place + 13 + len(name) + len(values)
    for child in node.children:
        inside.append(_record(child, inner))
        inner += len(inside[-1])
    if node.children or not node.values or node.name in _ALWAYS_OPEN:
        inside.append(_NO_RECORD)
        inner += len(_NO_RECORD)
    if inner >= 1 << 32:
        raise Mismatch("the clip is too long: an FBX 7.4 file holds at most 4 GB")
    head = struct.pack("<IIIB", inner, len(node.values), len(values), len(name))
    return b"".join([head, name, values, *inside])


def _value(value: Value) -> bytes:
    if isinstance(value, np.ndarray):
        return _array(value)
    if isinstance(value, str | bytes):
        raw = value.encode() if isinstance(value, str) else value
        return (b"S" if isinstance(value, str) else b"R") + struct.pack("<I", len(raw)) + raw
    if isinstance(value, bool):
        return b"C" + struct.pack("<?", value)
    if isinstance(value, np.int64):
        return b"L" + struct.pack("<q", value)
    return b"I" + struct.pack("<i", value) if isinstance(value, int) else b"D" + struct.pack("<d", value)


def _array(values: np.ndarray) -> bytes:
    letter = _ARRAYS[values.dtype.name]
    raw = values.astype(values.dtype.newbyteorder("<")).tobytes()
    packed = len(raw) > _WORTH_PACKING
    stored = zlib.compress(raw, 1) if packed else raw
    return letter + struct.pack("<III", values.size, packed, len(stored)) + stored
