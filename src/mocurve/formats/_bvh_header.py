"""The head of a BVH file: HIERARCHY, and MOTION up to the frame time."""

from __future__ import annotations

import re
from typing import NamedTuple, NoReturn

from ..errors import FileError
from ..skeleton import CHANNEL_KINDS, Skeleton
from ._files import Path

MAX_JOINTS = 20_000  # far more than any body; keeps a hostile file from filling the memory with joints
MAX_NAME = 1000  # characters
MAX_WORD = 100_000
_OF_NUMBERS = frozenset("0123456789.eE+-")
_INFINITY, _NAN = float("inf"), float("nan")
_BLANK = " \t\r\n\f\v"
_TOKEN = re.compile(rf"[{_BLANK}]*([{{}}]|[^{_BLANK}{{}}]+|\Z)")
_NAME = re.compile(r"[^\r\n{}]*")
_KINDS = {kind.lower(): kind for kind in CHANNEL_KINDS}


class NeedsMore(Exception):
    """The text ends before the head of the file does."""


class Header(NamedTuple):
    skeleton: Skeleton
    frames: int
    frame_time: str  # as written
    length: int  # characters of the text up to the end of the line of the frame time
    lines: int  # line ends among them


def parse(text: str, whole: bool, path: Path) -> Header:
    """Read the head of a file. `whole` says that the text is all there is; else NeedsMore asks for more of it."""
    scanner = Scanner(text, whole, path)
    skeleton = _Hierarchy(scanner).read()
    frames = _frames(scanner)
    frame_time = _frame_time(scanner, frames)
    return Header(skeleton, frames, frame_time, scanner.at, scanner.line(scanner.at) - 1)


class Scanner:
    """Words of a text one after the other; knows the line for what it complains about."""

    def __init__(self, text: str, whole: bool, path: Path):
        self.text, self.whole, self.path = text, whole, path
        self.at = self.start = 0  # behind, and at the start of, the word read last
        self.newline = newline_of(text)

    def line(self, at: int) -> int:
        return self.text.count(self.newline, 0, at) + 1

    def fail(self, message: str, at: int | None = None) -> NoReturn:
        raise FileError(message, self.path, self.line(self.start if at is None else at))

    def word(self) -> str:
        """The next brace or blank-separated word, "" at the end of the file."""
        match = _TOKEN.match(self.text, self.at)
        assert match is not None  # the pattern matches the end of the text too
        self.start, self.at = match.span(1)
        if self.at - self.start > MAX_WORD:
            self.fail(f"a word of at most {MAX_WORD} characters expected")
        if self.at == len(self.text) and not self.whole:
            raise NeedsMore
        return match[1]

    def name(self) -> str:
        """What stands between here and the end of the line or the next brace."""
        match = _NAME.match(self.text, self.at)
        assert match is not None  # the pattern matches nothing too
        if match.end() == len(self.text) and not self.whole and len(match[0]) <= MAX_NAME:
            raise NeedsMore
        if len(match[0]) > MAX_NAME:
            self.fail(f"a name of at most {MAX_NAME} characters expected")
        if "\0" in match[0]:
            self.fail("NUL bytes in a name: this is no text file", self.at)
        self.at = match.end()
        return match[0].strip(_BLANK)

    def expect(self, *words: str) -> str:
        """The next word, in lower case, where it is one of these."""
        word = self.word()
        if word.lower() not in [allowed.lower() for allowed in words]:
            self.fail(f"{' or '.join(words)} expected, {found(word)}")
        return word.lower()

    def number(self) -> float:
        word = self.word()
        value = number(word)
        if not -_INFINITY < value < _INFINITY:
            self.fail(f"a number expected, {found(word)}{hint(word)}")
        return value


class _Hierarchy:
    """Joints in the order of the file; a stack instead of recursion, so that no nesting is too deep."""

    def __init__(self, scanner: Scanner):
        self.scan = scanner
        self.names: list[str] = []
        self.parents: list[int] = []
        self.offsets: list[tuple[float, float, float] | None] = []
        self.channels: list[tuple[str, ...] | None] = []
        self.ends: list[bool] = []
        self.sites: list[int] = []  # end sites of each joint, counted

    def read(self) -> Skeleton:
        if self.scan.word().lower() != "hierarchy":
            word = self.scan.text[self.scan.start : self.scan.at]
            pointer = self.scan.text.startswith("version https://git-lfs")
            self.scan.fail(
                f"HIERARCHY expected, {found(word)}{' (a Git LFS pointer, not the file)' if pointer else ''}"
            )
        while self.scan.expect(*(("ROOT", "MOTION") if self.names else ("ROOT",))) == "root":
            self._tree()
        channels = tuple(kinds or () for kinds in self.channels)
        offsets = [offset or (0.0, 0.0, 0.0) for offset in self.offsets]  # all are there: _close sees to it
        return Skeleton(tuple(self.names), self.parents, offsets, channels, self.ends)  # type: ignore[arg-type]

    def _tree(self) -> None:
        open_joints = [self._open(-1, self.scan.name())]
        while open_joints:
            joint = open_joints[-1]
            given, childless = self.scan.word(), joint == len(self.names) - 1
            word = given.lower()
            if word == "}":
                self._close(joint)
                open_joints.pop()
            elif word == "offset" and self.offsets[joint] is None and childless:
                self.offsets[joint] = (self.scan.number(), self.scan.number(), self.scan.number())
            elif self.ends[joint]:
                self.scan.fail(f"{'}' if self.offsets[joint] else 'OFFSET'} expected in an End Site, {found(given)}")
            elif word == "channels" and self.channels[joint] is None and childless:
                self.channels[joint] = self._channels()
            elif word == "joint":
                open_joints.append(self._open(joint, self.scan.name()))
            elif word == "end":
                open_joints.append(self._end_site(joint))
            else:
                self.scan.fail(f"OFFSET, CHANNELS, JOINT, End Site or }} expected, {found(given)}")

    def _open(self, parent: int, name: str) -> int:
        if len(self.names) >= MAX_JOINTS:
            self.scan.fail(f"at most {MAX_JOINTS} joints expected")
        self.scan.expect("{")
        self.names.append(name)
        self.parents.append(parent)
        self.offsets.append(None)
        self.channels.append(None)
        self.ends.append(False)
        self.sites.append(0)
        return len(self.names) - 1

    def _end_site(self, joint: int) -> int:
        self.scan.expect("Site")
        self.sites[joint] += 1
        name = self.scan.name() or end_site_name(self.names[joint], self.sites[joint])
        site = self._open(joint, name)
        self.ends[site] = True
        return site

    def _channels(self) -> tuple[str, ...]:
        count = self.scan.word()
        if count not in ("0", "1", "2", "3", "4", "5", "6"):
            self.scan.fail(f"a number of channels from 0 to 6 expected, {found(count)}")
        kinds: list[str] = []
        for _ in range(int(count)):
            word = self.scan.word()
            kind = _KINDS.get(word.lower())
            if kind is None:
                self.scan.fail(f"{count} channels of {', '.join(CHANNEL_KINDS)} expected, {found(word)}")
            if kind in kinds:
                self.scan.fail(f"each channel once expected, {found(word)} again")
            kinds.append(kind)
        return tuple(kinds)

    def _close(self, joint: int) -> None:
        if self.offsets[joint] is None:
            self.scan.fail(f"an OFFSET for {self.names[joint]!r} expected before }}")


def _frames(scanner: Scanner) -> int:
    word = scanner.word()
    head, colon, count = word.partition(":")
    if head.lower() != "frames":
        scanner.fail(f"Frames: expected, {found(word)}")
    count = count or scanner.word()
    if not colon:
        count = count.removeprefix(":") or scanner.word()
    if not re.fullmatch("[0-9]{1,30}", count):
        scanner.fail(f"a number of frames expected, {found(count)}")
    return int(count)


def _frame_time(scanner: Scanner, frames: int) -> str:
    """The digits of the frame time, as written; the scanner then stands behind the end of their line."""
    words = scanner.word()
    if words.lower() == "frame":
        words += scanner.word()
    head, colon, digits = words.partition(":")
    if head.lower() != "frametime":
        scanner.fail(f"Frame Time: expected, {found(words)}")
    digits = digits or scanner.word()
    if not colon:
        digits = digits.removeprefix(":") or scanner.word()
    if len(digits) > 400 or not 0 < number(digits) < _INFINITY:
        scanner.fail(f"a frame time in seconds, above 0, expected, {found(digits)}{hint(digits)}")
    rest = scanner.text.find(scanner.newline, scanner.at)
    if rest < 0 and not scanner.whole:
        raise NeedsMore
    if rest < 0 and frames:
        scanner.fail(f"a line end and {frames} frames expected after the frame time, the end of the file found")
    rest = len(scanner.text) if rest < 0 else rest + 1
    if scanner.text[scanner.at : rest].strip(_BLANK):
        scanner.fail(f"the end of the line expected after the frame time, {found(scanner.word())}")
    scanner.at = rest
    return digits


def newline_of(text: str) -> str:
    """What ends a line: "\\n", or "\\r" in files of the old Macintosh."""
    return "\n" if "\n" in text else "\r"


def end_site_name(parent: str, number: int) -> str:
    """What an end site is called: after its parent; the second one of a joint is "_End2"."""
    return f"{parent}_End" if number == 1 else f"{parent}_End{number}"


def found(word: str) -> str:
    if "\0" in word:
        return f"{word[:40]!r} found (NUL bytes: no text, or UTF-16 without its byte order mark)"
    if not word:
        return "the end of the file found"
    return f"{word!r} found" if len(word) <= 40 else f"{word[:40]!r}… found"


def hint(word: str) -> str:
    """What may be meant by a word that is no number."""
    if "," in word:
        return " (decimal points, not commas, are read)"
    return " (too large)" if abs(number(word)) == _INFINITY else ""


def number(word: str) -> float:
    """The number that a word is, NaN for any other: inf, nan and 1_000 are numbers to Python, not in a file."""
    try:
        return float(word) if _OF_NUMBERS.issuperset(word) else _NAN
    except ValueError:
        return _NAN
