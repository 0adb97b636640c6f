"""Tables of numbers as text."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..errors import Mismatch
from ..progress import advance

_NUMBERS = 1 << 16  # turned into text at a time


def table(values: np.ndarray, lossless: bool, separator: str) -> Iterator[bytes]:
    """The rows of values (F, C), a line each, some thousand numbers at a time: six decimals, or all digits.

    Mismatch where a value is not finite: no file can hold it.
    """
    if not np.isfinite(values).all():
        row, column = np.argwhere(~np.isfinite(values))[0]
        raise Mismatch(
            f"the value in frame {row}, column {column} is {values[row, column]}, which no text file can hold"
        )
    step = max(_NUMBERS // max(values.shape[1], 1), 1)
    form = separator.join(["%r" if lossless else "%.6f"] * values.shape[1]) + "\n"
    for first in range(0, len(values), step):
        rows = values[first : first + step].tolist()
        yield "".join([form % tuple(row) for row in rows]).encode()
        advance("writing", min(first + step, len(values)), len(values))
