"""Biovision Hierarchy: skeleton and samples as text. What is read, refused and written is told in docs/formats.md."""

from __future__ import annotations

import os
import warnings

from ..motion import Clip, Motion
from . import _bvh_rows as rows
from ._bvh_source import Source
from ._bvh_text import hierarchy
from ._files import Path, encoded, opened, replacing
from ._frame_time import snapped, written
from ._text import table

OF_SAMPLES = True


def read(path: Path) -> Motion:
    """The motion in a BVH file, its numbers bit for bit and its channels in the order of the file.

    The frame time becomes k/fps where that lies within its digits. Another count of frames than announced, and names in
    an old encoding, are warned of. FileError, with the line, for all that is not surely a BVH file.
    """
    with opened(path) as file:
        source = Source(file, path)
        head, newline, encoding = source.head()
        left = max(os.fstat(file.fileno()).st_size - file.tell(), 0) + len(source.held)
        place = rows.Place(path, head.lines + 1, newline.encode(), left)
        values = rows.read_rows(source.read, place, head.skeleton.channel_count, head.frames)
    if encoding != "UTF-8":
        warnings.warn(f"{os.fspath(path)}: the names are not UTF-8; they are read as {encoding}", stacklevel=3)
    if len(values) != head.frames:
        warnings.warn(f"{os.fspath(path)}: {head.frames} frames announced, {len(values)} found and read", stacklevel=3)
    return Motion(head.skeleton, values, snapped(head.frame_time))


def write(path: Path, clip: Clip, lossless: bool = False) -> None:
    """Write the samples of a clip: six decimals, or with `lossless` the shortest digits that give the same numbers."""
    motion = clip.sample()
    timing = f"MOTION\nFrames: {motion.frames}\nFrame Time: {written(motion.frame_time)}\n"
    head = encoded(hierarchy(motion.skeleton, lossless) + timing, path)
    with replacing(path) as file:
        file.write(head)
        for text in table(motion.values, lossless, " "):
            file.write(text)
