"""The JSON of a GLB or glTF file and the bytes of its buffers, with nothing in them believed unchecked."""

from __future__ import annotations

import base64
import binascii
import json
import os
import re
import struct
from typing import Any, NoReturn
from urllib.parse import unquote

from ..errors import FileError
from ._files import Path, opened

_HEADER = struct.Struct("<4sII")
_CHUNK = struct.Struct("<II")
_JSON, _BIN = 0x4E4F534A, 0x004E4942
_DATA_URI = re.compile(r"data:[^,]{0,200};base64,", re.IGNORECASE)


class Document:
    """Parsed JSON; whatever is not as it has to be is told by its place, "accessors[3].count: ..."."""

    def __init__(self, path: Path):
        self.path = path
        self.odd: list[str] = []  # what the user is to be warned of
        with opened(path) as file:
            raw = file.read()
        self.size = len(raw)
        text, self.chunk = self._parts(raw) if raw[:4] == b"glTF" else (raw, None)
        self.data = self._parsed(text)
        self.lists: dict[str, list[dict[str, Any]]] = {}
        self.buffers: dict[int, memoryview] = {}
        version = self.object(self.data.get("asset"), "asset").get("version")
        if not isinstance(version, str) or not re.match(r"2\.\d", version):
            self.fail("asset.version", f"'2.0' expected, {str(version)[:40]!r} found")

    def fail(self, place: str, what: str) -> NoReturn:
        raise FileError(f"{place}: {what}", self.path)

    # -- values --------------------------------------------------------------------------------
    def object(self, value: Any, place: str) -> dict[str, Any]:
        if not isinstance(value, dict):
            self.fail(place, "an object expected")
        return value

    def objects(self, value: Any, place: str) -> list[dict[str, Any]]:
        """A list of objects; none where it is missing."""
        if value is None:
            return []
        if not isinstance(value, list) or not all(isinstance(item, dict) for item in value):
            self.fail(place, "a list of objects expected")
        return value

    def all(self, kind: str) -> list[dict[str, Any]]:
        """What the file has of "nodes", "accessors" ..."""
        if kind not in self.lists:
            self.lists[kind] = self.objects(self.data.get(kind), kind)
        return self.lists[kind]

    def one(self, kind: str, index: Any, place: str) -> dict[str, Any]:
        """The object that an index means."""
        known = self.all(kind)
        if type(index) is not int or not 0 <= index < len(known):
            self.fail(place, f"the index of one of {len(known)} {kind} expected, {str(index)[:40]} found")
        return known[index]

    def whole(self, value: Any, place: str, least: int, most: int) -> int:
        if type(value) is not int or not least <= value <= most:
            self.fail(place, f"a whole number from {least} to {most} expected, {str(value)[:40]} found")
        return value

    def numbers(self, value: Any, place: str, count: int) -> list[float]:
        good = isinstance(value, list) and len(value) == count and set(map(type, value)) <= {int, float}
        if not good or not all(abs(number) < 1e30 for number in value):  # also what no float holds
            self.fail(place, f"{count} finite numbers expected")
        return [float(number) for number in value]

    def name(self, item: dict[str, Any], place: str) -> str:
        """Its name, or its place where it has none."""
        name = item.get("name", place)
        if not isinstance(name, str) or len(name) > 1000:
            self.fail(f"{place}.name", "a string of at most 1000 characters expected")
        return name or place

    # -- bytes ---------------------------------------------------------------------------------
    def buffer(self, index: Any, place: str) -> memoryview:
        """The bytes of a buffer: embedded, in a data URI, or of a file beside this one."""
        buffer, place = self.one("buffers", index, place), f"buffers[{index}]"
        if index not in self.buffers:
            length = self.whole(buffer.get("byteLength"), f"{place}.byteLength", 1, 1 << 53)
            uri = buffer.get("uri")
            if uri is not None and not isinstance(uri, str):
                self.fail(f"{place}.uri", "a string expected")
            data = self._embedded(index, place) if uri is None else self._from_uri(uri, place, length)
            if len(data) < length:
                self.fail(place, f"{length} bytes announced, {len(data)} there")
            self.buffers[index] = data[:length]
        return self.buffers[index]

    def _embedded(self, index: int, place: str) -> memoryview:
        if index == 0 and self.chunk is not None:
            return self.chunk
        if "meshopt" in str(self.data.get("extensionsUsed")):
            self.fail(place, "packed with EXT_meshopt_compression, which is not read; save it without compression")
        return self.fail(place, "neither a uri nor a binary chunk")

    def _from_uri(self, uri: str, place: str, length: int) -> memoryview:
        if uri[:5].lower() == "data:":
            found = _DATA_URI.match(uri)
            if not found:
                self.fail(f"{place}.uri", "data that is base64 expected")
            try:
                return memoryview(base64.b64decode(uri[found.end() :], validate=True))
            except (binascii.Error, ValueError) as error:
                self.fail(f"{place}.uri", f"not base64: {error}")
        name = unquote(uri)
        parts = name.split("/")
        if re.search(r"[:\\\0]", name) or ".." in parts or "" in parts:
            self.fail(f"{place}.uri", f"a file in the folder of this one expected, {uri[:100]!r} found")
        folder = os.path.realpath(os.path.dirname(os.path.abspath(os.fsdecode(self.path))))
        target = os.path.realpath(os.path.join(folder, name))
        if os.path.commonpath([folder, target]) != folder:  # through a link
            self.fail(f"{place}.uri", f"{uri[:100]!r} lies outside of the folder of this file")
        with opened(target) as file:
            return memoryview(file.read(min(length, os.fstat(file.fileno()).st_size)))

    # -- the container -------------------------------------------------------------------------
    def _parts(self, raw: bytes) -> tuple[bytes, memoryview | None]:
        """The JSON and the binary chunk of a GLB."""
        if len(raw) < _HEADER.size:
            raise FileError("a GLB file that ends within its header", self.path)
        _, version, length = _HEADER.unpack_from(raw)
        if version != 2:
            raise FileError(f"GLB version 2 expected, {version} found", self.path)
        if length > len(raw):
            raise FileError(f"cut: the header announces {length} bytes, {len(raw)} are there", self.path)
        if length < len(raw):
            self.odd.append(f"{len(raw) - length} bytes after the end of the GLB are left aside")
        chunks: list[tuple[int, memoryview]] = []
        at = _HEADER.size
        while at + _CHUNK.size <= length and len(chunks) < 2:
            size, kind = _CHUNK.unpack_from(raw, at)
            at += _CHUNK.size
            if size > length - at:
                raise FileError(f"chunk {len(chunks)} announces {size} bytes, {length - at} are there", self.path)
            chunks.append((kind, memoryview(raw)[at : at + size]))
            at += size
        if not chunks or chunks[0][0] != _JSON:
            raise FileError("the first chunk of a GLB is JSON, here it is not", self.path)
        return bytes(chunks[0][1]), chunks[1][1] if len(chunks) > 1 and chunks[1][0] == _BIN else None

    def _parsed(self, text: bytes) -> dict[str, Any]:
        try:
            data = json.loads(text, parse_constant=_no_constant)
        except json.JSONDecodeError as error:
            raise FileError(f"column {error.colno}: not JSON: {error.msg}", self.path, error.lineno) from error
        except RecursionError as error:
            raise FileError("not glTF: nested too deep", self.path) from error
        except ValueError as error:
            raise FileError(f"not JSON: {error}", self.path) from error
        return self.object(data, "glTF")


def _no_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is no number of JSON")
