"""The bytes of a BVH file as UTF-8, whatever they are, and the search for where its head ends."""

from __future__ import annotations

import codecs
from typing import BinaryIO

from ..errors import FileError
from . import _bvh_header as header
from ._files import Path

_FIRST = 1 << 16  # bytes that the head is looked for in first
_NO_LATIN = frozenset(range(128, 160))
_OLD = {"cp932": "Shift-JIS", "latin-1": "Latin-1"}


class Source:
    """A file's bytes; those of UTF-16, told by its byte order mark, become UTF-8. `held` is what was read too much."""

    def __init__(self, file: BinaryIO, path: Path):
        self.file, self.path = file, path
        self.decoder: codecs.IncrementalDecoder | None = None
        start = file.read(4)
        if start[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE) and start != codecs.BOM_UTF32_LE:
            self.decoder = codecs.getincrementaldecoder("utf-16")()
            start = self._as_utf8(start)
        self.held = memoryview(start.removeprefix(codecs.BOM_UTF8))

    def read(self, size: int) -> bytes:
        """At most about `size` bytes, none only at the end of the file."""
        if len(self.held):
            data, self.held = self.held[:size].tobytes(), self.held[size:]
            return data
        data = self.file.read(size)
        while self.decoder and data and not (text := self._as_utf8(data)):
            data = self.file.read(size)
        return (text if data else self._as_utf8(b"")) if self.decoder else data

    def _as_utf8(self, data: bytes) -> bytes:
        assert self.decoder is not None  # asked for in UTF-16 files only
        try:
            return self.decoder.decode(data, final=not data).encode()
        except UnicodeError as error:
            raise FileError(f"not valid UTF-16: {error.reason}", self.path) from error  # type: ignore[attr-defined]

    def head(self) -> tuple[header.Header, str, str]:
        """The head of the file, its line end, and its encoding: "UTF-8", or an old one that is guessed."""
        data, size, whole = bytearray(), _FIRST, False
        while True:
            while len(data) < size and not whole:
                more = self.read(size - len(data))
                data += more
                whole = not more
            text, codec = _decoded(bytes(data), whole)
            try:
                head = header.parse(text, whole, self.path)
            except header.NeedsMore:
                size *= 8
                continue
            self.held = memoryview(bytes(data))[len(text[: head.length].encode(codec)) :]
            return head, header.newline_of(text), _OLD.get(codec, "UTF-8")


def _decoded(data: bytes, whole: bool) -> tuple[str, str]:
    """The text and its codec. No UTF-8: Shift-JIS if that fits and some bytes are no Latin-1 letters, else Latin-1."""
    for codec in ("utf-8", "cp932"):
        try:
            if codec == "utf-8" or not _NO_LATIN.isdisjoint(data):
                return codecs.getincrementaldecoder(codec)().decode(data, whole), codec
        except UnicodeDecodeError:
            continue
    return data.decode("latin-1"), "latin-1"
