"""Samples as a table for spreadsheets: a line a frame, time in seconds first, then every channel. Written only."""

from __future__ import annotations

import csv
import io

import numpy as np

from ..errors import FileError
from ..motion import Clip, Motion
from ._files import Path, encoded, replacing
from ._text import table


def read(path: Path) -> Motion:
    """Always FileError: a table of channels does not say how the joints hang together."""
    raise FileError("CSV holds no skeleton and is only written; .npz and .bvh are read back", path)


def write(path: Path, clip: Clip, lossless: bool = False) -> None:
    """Write the samples of a clip: degrees and file length units, to six decimals or `lossless` to all digits."""
    motion = clip.sample()
    head = io.StringIO()
    csv.writer(head, lineterminator="\n").writerow(["time", *motion.skeleton.channel_names])
    times = np.arange(motion.frames) * motion.frame_time
    title = encoded(head.getvalue(), path)
    with replacing(path) as file:
        file.write(title)
        for text in table(np.column_stack((times, motion.values)), lossless, ","):
            file.write(text)
