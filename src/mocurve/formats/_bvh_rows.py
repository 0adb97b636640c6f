"""The rows of a BVH file: a stream of text turned into the array of values, and the rule of what a row is."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from typing import NamedTuple, NoReturn

import numpy as np

from ..errors import FileError
from ..progress import advance
from . import _numbers
from ._bvh_header import found, hint
from ._files import Path

CHUNK = 1 << 17  # characters that are turned into numbers at a time: few enough for a processor's cache
COMPILED_FROM = 64 << 20  # bytes from which compiled code pays the 0.4 s that numba takes to start
_TAIL, _LAST = 8192, 64  # characters kept, and numbers of the last row looked at when the file has ended
Read = Callable[[int], bytes]


class Place(NamedTuple):
    """Where the rows of a file begin, and what is known of the rest of it."""

    path: Path
    line: int  # that the rows begin in
    newline: bytes
    size: int  # bytes left: a row takes at least two a number


def read_rows(read: Read, place: Place, channels: int, frames: int) -> np.ndarray:
    """The values (F, channels), stored channel after channel, of the rest of a file that `read(size)` gives.

    `frames` is what the file says; another number of whole rows is given back as it is.
    """
    if channels == 0:
        return np.empty((min(frames, _count_blank_lines(read, place)), 0))
    rows = _Rows(channels, min(frames, (place.size + 1) // (2 * channels)))
    lines = Lines(place.line)
    tail, done = b"", 0
    for chunk, block in _blocks(read, place):
        rows.add(block.values)
        lines.add(block)
        done += len(chunk)
        advance("reading", min(done, place.size), place.size)
        tail = chunk[-_TAIL:] if len(chunk) >= _TAIL else tail[-_TAIL:] + chunk
    lines.finish()
    check_lines(lines, channels, frames, place.path)
    if tail and not tail.endswith(_numbers.BLANKS):
        if rows.count < frames:
            told = f"{frames} frames announced, but the file ends without a line end in frame {rows.count}"
            raise FileError(told, place.path, lines.last_line)
        _check_last_number(tail.split()[-min(channels, _LAST) :], lines.last_line, place.path)
    return rows.finish()


class _Rows:
    """The array of values, filled row by row; grows only where there are more rows than the file says."""

    def __init__(self, channels: int, capacity: int):
        self.values = np.empty((capacity, channels), order="F")
        self.count = 0
        self.rest = np.empty(0)  # numbers of a row that is not yet whole

    def add(self, numbers: np.ndarray) -> None:
        channels = self.values.shape[1]
        if len(self.rest):
            numbers = np.concatenate((self.rest, numbers))
        more = len(numbers) // channels
        if self.count + more > len(self.values):
            grown = np.empty((max(self.count + more, self.count * 3 // 2), channels), order="F")
            grown[: self.count] = self.values[: self.count]
            self.values = grown
        self.values[self.count : self.count + more] = numbers[: more * channels].reshape(more, channels)
        self.count += more
        self.rest = numbers[more * channels :]

    def finish(self) -> np.ndarray:
        return self.values if self.count == len(self.values) else self.values[: self.count].copy(order="F")


class Lines:
    """How many numbers each line has, blank lines left out, as runs of like lines: a regular file is one run.

    starts: the line of the file where a run begins; counts: the numbers in each of its lines;
    ordinals: how many lines with numbers stand before it (finish() adds their total).
    """

    def __init__(self, line: int):
        self.line, self.last_line = line, line
        self.numbers = self.total = 0  # in the current line, and in all
        self.starts: list[int] = []
        self.counts: list[int] = []
        self.ordinals: list[int] = []
        self.seen = 0

    def add(self, block: _numbers.Block) -> None:
        self.total += len(block.values)
        counts = block.counts
        counts[0] += self.numbers
        self.numbers, counts = int(counts[-1]), counts[:-1]
        filled = np.flatnonzero(counts)
        self._append(filled + self.line, counts[filled])
        self.line += len(counts)

    def finish(self) -> None:
        if self.numbers:
            self._append(np.array([self.line]), np.array([self.numbers]))
        self.ordinals.append(self.seen)

    def _append(self, lines: np.ndarray, counts: np.ndarray) -> None:
        if len(lines) == 0:
            return
        new = np.ones(len(lines), bool)
        new[1:] = (counts[1:] != counts[:-1]) | (lines[1:] != lines[:-1] + 1)
        new[0] = not self.counts or self.counts[-1] != counts[0] or self.last_line != lines[0] - 1
        changes = np.flatnonzero(new)
        self.starts += lines[changes].tolist()
        self.counts += counts[changes].tolist()
        self.ordinals += (changes + self.seen).tolist()
        self.seen += len(lines)
        self.last_line = int(lines[-1])

    def runs(self) -> Iterator[tuple[int, int, int]]:
        """(line, numbers in it, how many lines like it)."""
        for i, line in enumerate(self.starts):
            yield line, self.counts[i], self.ordinals[i + 1] - self.ordinals[i]


def check_lines(lines: Lines, channels: int, frames: int, path: Path) -> None:
    """FileError unless the lines of numbers make rows of `channels` numbers beyond doubt.

    Either each line holds whole rows. Or rows are wrapped: then there are exactly as many numbers as the file says, and
    each row begins on a line of its own or no line has the length of a row by chance. All else is a row that was cut.
    """
    if all(count % channels == 0 for count in lines.counts):
        return
    cut = _first_cut_row(lines, channels)
    exact = lines.total == frames * channels
    if exact and (cut is None or channels not in lines.counts):
        return
    if cut is not None and (lines.counts[0] % channels == 0 or channels in lines.counts or exact):
        line, numbers = cut
        raise FileError(f"{channels} numbers expected, {numbers} found", path, line)
    told = (
        f"{frames} frames of {channels} numbers announced, {lines.total} numbers found in lines that hold no whole rows"
    )
    raise FileError(told, path, lines.last_line)


def _first_cut_row(lines: Lines, channels: int) -> tuple[int, int] | None:
    """Line and count of the first row that does not end where a line does, if each row begins on its own line."""
    begin = have = 0
    for first, count, times in lines.runs():
        if have == 0 and count % channels == 0:
            continue
        for line in range(first, first + times):
            if have + count > channels:
                return (begin, have) if have else (line, count)
            begin, have = begin if have else line, (have + count) % channels
    return (begin, have) if have else None


def _check_last_number(row: list[bytes], line: int, path: Path) -> None:
    """FileError where the file ends within a number: fewer decimals there than all the others of the row have alike."""
    decimals = [len(number.partition(b".")[2]) for number in row]
    *others, last = decimals
    if len(others) >= 3 and len(set(others)) == 1 and last < others[0]:
        word = row[-1].decode("latin-1")
        raise FileError(f"the file ends within a number: {others[0]} decimals expected, {found(word)}", path, line)


def _count_blank_lines(read: Read, place: Place) -> int:
    lines = 0
    for _, block in _blocks(read, place):
        if len(block.values):
            raise FileError("no numbers expected, since no joint has channels", place.path, place.line + lines)
        lines += len(block.counts) - 1
    return lines


def _blocks(read: Read, place: Place) -> Iterator[tuple[bytes, _numbers.Block]]:
    """The numbers of each chunk of the file, in order."""
    parse, line, column = parser(place.size), place.line, 0
    for chunk in _chunks(read, place):
        try:
            block = parse(chunk, place.newline)
        except _numbers.NotANumber as error:
            _complain(chunk, error, place._replace(line=line), column)
        yield chunk, block
        begin = chunk.rfind(place.newline) + 1
        line, column = line + len(block.counts) - 1, len(chunk) - begin + (0 if begin else column)


def parser(size: int) -> Callable[[bytes, bytes], _numbers.Block]:
    """What reads the numbers of so many bytes: compiled, or as it is."""
    if size < (COMPILED_FROM // 8 if "numba" in sys.modules else COMPILED_FROM):
        return _numbers.parse
    from . import _numbers_kernel  # not needed, and not loaded, for small files

    return _numbers_kernel.parse


def _chunks(read: Read, place: Place) -> Iterator[bytes]:
    """The rest of a file in pieces that end behind a blank."""
    rest = b""
    while data := read(CHUNK):
        data = rest + data
        cut = data.rfind(place.newline) + 1 or max(data.rfind(blank) for blank in _numbers.BLANKS) + 1
        if cut == 0 and len(data) > CHUNK:
            word = found(data[:100].decode("latin-1"))
            raise FileError(f"a number expected, {word}", place.path, place.line)
        if cut:
            yield data[:cut]
        rest = data[cut:]
    if rest:
        yield rest


def _complain(chunk: bytes, error: _numbers.NotANumber, place: Place, column: int) -> NoReturn:
    """FileError for a word of a chunk that begins in that line and column."""
    before = chunk[: error.at]
    begin = before.rfind(place.newline) + 1
    line, column = place.line + before.count(place.newline), len(before) - begin + (0 if begin else column)
    word = error.word.decode("utf-8", "replace")
    told = f"column {column + 1}: a number expected, {found(word)}{hint(word)}"
    raise FileError(told, place.path, line) from None
