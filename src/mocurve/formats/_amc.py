"""Acclaim motion (AMC): for each frame its number, then a line a bone with the numbers of its degrees of freedom."""

from __future__ import annotations

import io
import os
import warnings
from array import array
from collections.abc import Iterable, Mapping
from math import isfinite
from typing import BinaryIO, NamedTuple, NoReturn

import numpy as np

from ..errors import FileError
from ..progress import advance
from ._asf import no_bone
from ._bvh_header import found, hint, number
from ._files import Path

_OF_NUMBERS = b"0123456789.eE+- \t\r\n\f\v"
_BOM = b"\xef\xbb\xbf"
_STEP = 1 << 14  # lines between two words on how far it is


class Frames(NamedTuple):
    """values: (F, n) of each bone that the file has, as in the file; degrees: what its angles are, None where it does
    not say."""

    values: dict[str, np.ndarray]
    total: int
    degrees: bool | None


def read(file: BinaryIO, path: Path, widths: Mapping[str, int], codec: str) -> Frames:
    """The frames of an AMC file, of a skeleton whose bones have so many numbers each.

    A bone is in every frame or in none. Frame numbers that are left out, and a last line without an end, are warned of.
    FileError, with the line, for all that is not surely such a file.
    """
    return _Reader(path, {name.encode(codec): width for name, width in widths.items()}).read(file, codec)


class _Reader:
    """One file, line by line: it takes the memory of the numbers, whatever the lines say."""

    def __init__(self, path: Path, widths: Mapping[bytes, int]):
        self.path, self.widths = path, widths
        self.line = 1
        self.columns = {name: array("d") for name in widths}
        self.seen = dict.fromkeys(widths, 0)  # the frame that a bone was in last, counted from 1
        self.frame = self.number = self.first = 0  # frames begun; what the file calls this one and the first
        self.inside = self.usual = 0  # bones in this frame, and in each
        self.degrees: bool | None = None

    def fail(self, message: str) -> NoReturn:
        raise FileError(message, self.path, self.line)

    def warn(self, message: str) -> None:
        warnings.warn(f"{os.fspath(self.path)}: {message}", stacklevel=6)

    def read(self, file: BinaryIO, codec: str) -> Frames:
        size, done, line = os.fstat(file.fileno()).st_size, 0, b"\n"
        widths = self.widths
        for self.line, line in enumerate(_lines(file), 1):
            words = line.split(None, 1)
            if words and words[0] in widths:
                self._bone(words[0], words[1] if len(words) > 1 else b"")
            elif words:
                self._other(line.partition(b"#")[0].split())
            done += len(line)
            if self.line % _STEP == 0:
                advance("reading", min(done, size), size)
        self._close()
        if not self.frame:
            self.fail("the number of a frame expected, the end of the file found")
        if not line.endswith(b"\n"):
            self.warn("the file ends without a line end; its last number may be cut")
        missing = self.number - self.first + 1 - self.frame
        if missing:
            self.warn(f"{missing} frame numbers are left out; the frames are read as following at once")
        here = [name for name in widths if self.seen[name]]
        values = {name.decode(codec): np.array(self.columns[name]).reshape(-1, widths[name]) for name in here}
        return Frames(values, self.frame, self.degrees)

    def _bone(self, name: bytes, rest: bytes) -> None:
        if self.seen[name] == self.frame:
            self.fail(f"{_text(name)!r} again in frame {self.number}" if self.frame else _unnumbered(name))
        if self.frame > 1 and not self.seen[name]:
            self.fail(f"{_text(name)!r} is in frame {self.number}, but not in the first")
        if rest.translate(None, _OF_NUMBERS):  # nan, inf and 1_000 are numbers to Python, not to us
            rest = rest.partition(b"#")[0]
            if rest.translate(None, _OF_NUMBERS):
                self._complain(rest)
        width = self.widths[name]
        words = rest.split(None, width)
        if len(words) != width:
            there = "more" if len(words) > width else len(words)
            self.fail(f"{width} numbers for {_text(name)!r} expected, {there} found")
        try:
            values = [float(word) for word in words]
        except ValueError:
            self._complain(rest)
        if not isfinite(sum(values)) and not all(map(isfinite, values)):
            self._complain(rest)
        self.columns[name].extend(values)
        self.seen[name] = self.frame
        self.inside += 1

    def _other(self, words: list[bytes]) -> None:
        """A line that is no bone's: a comment, a keyword or the number of a frame."""
        if not words:
            return
        word = words[0]
        if word.startswith(b":") and not self.frame:
            self._keyword(_text(word))
        elif len(words) == 1 and word.isdigit() and len(word) <= 18:
            self._begin(int(word))
        elif self.frame and len(words) > 1:
            self.fail(no_bone(_text(word), map(_text, self.widths)))
        else:
            self.fail(f"the number of a frame expected, {found(_text(b' '.join(words)))}")

    def _keyword(self, word: str) -> None:
        if word.upper() in (":DEGREES", ":RADIANS"):
            self.degrees = word.upper() == ":DEGREES"
        elif word.upper() != ":FULLY-SPECIFIED":
            self.warn(f"{word[:60]!r} in line {self.line} is not known and left aside")

    def _begin(self, name: int) -> None:
        """A frame of that number."""
        self._close()
        if self.frame and name <= self.number:
            self.fail(f"a frame number above {self.number} expected, {name} found")
        self.number, self.first, self.inside = name, self.first if self.frame else name, 0
        self.frame += 1

    def _close(self) -> None:
        """The end of a frame: it has to have the bones of the first one."""
        if self.frame and not self.inside:
            self.fail(f"the bones of frame {self.number} expected, none found")
        if self.frame == 1:
            self.usual = self.inside
        if self.inside < self.usual:
            missing = next(name for name, frame in self.seen.items() if 0 < frame < self.frame)
            self.fail(f"{_text(missing)!r} is missing in frame {self.number}")

    def _complain(self, rest: bytes) -> NoReturn:
        for word in map(_text, rest.split()):
            if not isfinite(number(word)):
                self.fail(f"a number expected, {found(word)}{hint(word)}")
        raise AssertionError("every word is a finite number")


def _lines(file: BinaryIO) -> Iterable[bytes]:
    """Lines without a byte order mark; those of the old Macintosh, which end in CR alone, too."""
    start = file.read(1 << 16)
    file.seek(len(_BOM) if start.startswith(_BOM) else 0)
    if b"\r" in start and b"\n" not in start:
        return io.BytesIO(file.read().replace(b"\r", b"\n"))
    return file


def _text(word: bytes) -> str:
    return word.decode("utf-8", "replace")


def _unnumbered(name: bytes) -> str:
    return f"the number of a frame expected, {_text(name)!r} found"
