"""Samples as a table for spreadsheets: a line a frame, time in seconds, then a column a channel or a marker's axis."""

from __future__ import annotations

import csv
import io
import os
import re
import warnings
from collections.abc import Sequence

import numpy as np

from ..errors import FileError, Mismatch
from ..motion import Clip, Motion
from ..skeleton import AXES, CHANNEL_KINDS, Skeleton
from ._csv_rows import Rows
from ._files import Path, encoded, opened, replacing
from ._text import table

_TIME = re.compile(r"(?:time|t|seconds)(?:[ _]?[(\[]?(?:s|sec|seconds)[)\]]?)?", re.IGNORECASE)
_FRAME = re.compile(r"frame(?:[ _]?(?:#|no\.?|number|index))?s?|#", re.IGNORECASE)
_CHANNEL = re.compile(r"(.*)\.([xyz](?:position|rotation))", re.IGNORECASE | re.DOTALL)
_MARKER = re.compile(r"(.+)[.:_ ]([xyz])", re.IGNORECASE | re.DOTALL)
_KINDS = {kind.lower(): kind for kind in CHANNEL_KINDS}
_UNTIMED = 1 / 30


OF_SAMPLES = True


def read(path: Path, *, skeleton: Path | None = None) -> Motion:
    """A table with the columns time and "Hips.Xrotation" (channels) or "LASI.X", "LASI:X", "LASI_X" (markers).

    Empty cells are gaps, NaN. skeleton: a file with the body that the channels are of; Mismatch names the first that
    it has and the table has not, or the other way round. Without one each joint stands for itself, and a warning says
    so if there are rotations. FileError with line and column for all that is no such table.
    """
    with opened(path) as file:
        text = _text(file.read(), path)
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    head, taken, separator = _head(lines, path)
    rows = Rows(lines[taken:], taken + 1, separator, head, path)
    values = rows.values()
    time, channels = _columns(head, path)
    if len(values) > 1:
        frame_time = rows.frame_time(time, values[:, time])
    else:
        frame_time = _UNTIMED
        warnings.warn(f"{os.fsdecode(path)}: {len(values)} rows tell no frame time, 1/30 s is taken", stacklevel=3)
    if skeleton is not None:
        body, order = _given_body(skeleton, [head[column] for column in channels])
    else:
        body, order = _flat_body([channels[column] for column in channels], values[:, list(channels)], path)
    return Motion(body, values[:, np.array(list(channels), np.int64)[order]], frame_time)


def signals(path: Path) -> tuple[dict[str, np.ndarray], str | None]:
    """Any table of numbers, column by column, and which of them is the time (None: none is called so).

    Without a first line of names the columns are called 1, 2 ... The times need not be even. FileError with line and
    column for what is no number.
    """
    with opened(path) as file:
        text = _text(file.read(), path)
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    head, taken, separator = _head(lines, path)
    if not head:
        raise FileError("the table is empty", path)
    if all(_is_number(name) for name in head):
        head, taken = [str(column + 1) for column in range(len(head))], 0
    if len(set(head)) < len(head):
        twice = next(name for column, name in enumerate(head) if name in head[:column])
        raise FileError(f"two columns are called {twice[:60]!r}", path, 1)
    values = Rows(lines[taken:], taken + 1, separator, head, path).values()
    times = [name for name in head if _TIME.fullmatch(name)]
    return dict(zip(head, values.T, strict=True)), times[0] if times else None


def write(path: Path, clip: Clip, lossless: bool = False) -> None:
    """Write the samples of a clip: degrees and file length units, to six decimals or `lossless` to all digits.

    Gaps (NaN) become empty cells.
    """
    motion = clip.sample()
    head = io.StringIO()
    csv.writer(head, lineterminator="\n").writerow(["time", *motion.skeleton.channel_names])
    times = np.arange(motion.frames) * motion.frame_time
    title = encoded(head.getvalue(), path)
    with replacing(path) as file:
        file.write(title)
        for text in table(np.column_stack((times, motion.values)), lossless, ",", gaps=True):
            file.write(text)


def _text(data: bytes, path: Path) -> str:
    for mark, codec in ((b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"), (b"", "utf-8-sig")):
        if data.startswith(mark):
            try:
                return data.decode(codec)
            except UnicodeDecodeError as error:
                raise FileError(f"no text in {codec.removesuffix('-sig').upper()}: {error.reason}", path) from error
    raise AssertionError("every file starts with nothing")


def _head(lines: list[str], path: Path) -> tuple[list[str], int, str]:
    """The names of the columns, how many lines they take, and what keeps cells apart."""
    unquoted = re.sub(r'"[^"]*"', "", lines[0])
    separator = max(",;\t", key=unquoted.count)
    reader = csv.reader((line + "\n" for line in lines), delimiter=separator)
    try:
        head = [name.strip() for name in next(reader)]
    except csv.Error as error:
        raise FileError(f"no head of a table: {error}", path, 1) from error
    return head, reader.line_num, separator


def _is_number(cell: str) -> bool:
    try:
        return bool(np.isfinite(float(cell)))
    except ValueError:
        return False


def _columns(head: Sequence[str], path: Path) -> tuple[int, dict[int, tuple[str, str]]]:
    """The column of the time, and the joint and the kind of channel of all columns that have one."""
    channels: dict[int, tuple[str, str]] = {}
    times = [column for column, name in enumerate(head) if _TIME.fullmatch(name)]
    if len(times) != 1:
        raise FileError(f"one column 'time' expected in the first line, {len(times)} found", path, 1)
    for column, name in enumerate(head):
        if found := _CHANNEL.fullmatch(name):
            channels[column] = found[1], _KINDS[found[2].lower()]
        elif column in times or _FRAME.fullmatch(name):
            continue
        elif found := _MARKER.fullmatch(name):
            channels[column] = found[1], f"{found[2].upper()}position"
        else:
            told = f"column {column + 1}: a channel (Hips.Xrotation), a marker's axis (LASI.X) or time expected"
            raise FileError(f"{told}, {name[:60]!r} found", path, 1)
    if not channels:
        raise FileError("no column beside the time: there is nothing to read", path, 1)
    return times[0], channels


def _given_body(skeleton: Path, names: list[str]) -> tuple[Skeleton, list[int]]:
    """The body of another file, and which of the columns each of its channels is."""
    from . import read as read_clip  # it is what loads this module

    body = read_clip(skeleton).skeleton
    wanted = list(body.channel_names)
    if names == wanted:  # also where two joints have one name
        return body, list(range(len(names)))
    places = {name: place for place, name in enumerate(names)}
    for kind, some, others in (
        ("table has no column", wanted, places),
        ("skeleton has no channel", names, set(wanted)),
    ):
        for name in some:
            if name not in others:
                raise Mismatch(f"the {kind} {name!r}")
    if not len(names) == len(wanted) == len(places):
        raise Mismatch(f"the skeleton has {len(wanted)} channels, the table {len(names)} of {len(places)} names")
    return body, [places[name] for name in wanted]


def _flat_body(channels: list[tuple[str, str]], values: np.ndarray, path: Path) -> tuple[Skeleton, list[int]]:
    """A root for each joint, and the order of the columns that puts those of one joint side by side."""
    markers = not any(kind.endswith("rotation") for _, kind in channels)
    joints: list[tuple[str, dict[str, int]]] = []  # name, column of each kind
    latest: dict[str, dict[str, int]] = {}
    for column, (name, kind) in enumerate(channels):
        if markers and kind in latest.get(name, {}):
            raise FileError(f"two columns are the {kind} of {name!r}", path, 1)
        if kind in latest.get(name, {kind: column}):  # the first joint of that name, or one more
            latest[name] = {}
            joints.append((name, latest[name]))
        latest[name][kind] = column
    if not markers:
        warnings.warn(
            f"{os.fsdecode(path)}: a table does not say how its {len(joints)} joints hang together; each stands for "
            "itself (the option skeleton names a file with the body)",
            stacklevel=4,
        )
    offsets = np.zeros((len(joints), 3))
    if markers:  # where they mostly are
        for joint, (_, mine) in enumerate(joints):
            for kind, column in mine.items():
                seen = values[~np.isnan(values[:, column]), column]
                offsets[joint, AXES.index(kind[0])] = np.median(seen) if len(seen) else 0.0
    kinds = tuple(tuple(mine) for _, mine in joints)
    body = Skeleton(tuple(name for name, _ in joints), np.full(len(joints), -1), offsets, kinds)
    return body, [column for _, mine in joints for column in mine.values()]
