"""Tables of numbers as text."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..errors import Mismatch
from ..progress import advance

_NUMBERS = 1 << 16  # turned into text at a time


def table(values: np.ndarray, lossless: bool, separator: str, gaps: bool = False) -> Iterator[bytes]:
    """The rows of values (F, C), a line each, some thousand numbers at a time: six decimals, or all digits.

    gaps: nothing stands for NaN. Mismatch where a value is not finite otherwise: no file can hold it.
    """
    gaps = gaps and bool(np.isnan(values).any())
    wrong = np.isinf(values) if gaps else ~np.isfinite(values)
    if wrong.any():
        row, column = np.argwhere(wrong)[0]
        raise Mismatch(
            f"the value in frame {row}, column {column} is {values[row, column]}, which no text file can hold"
        )
    step = max(_NUMBERS // max(values.shape[1], 1), 1)
    form = separator.join(["%r" if lossless else "%.6f"] * values.shape[1]) + "\n"
    for first in range(0, len(values), step):
        rows = values[first : first + step].tolist()
        text = "".join([form % tuple(row) for row in rows])
        yield (text.replace("nan", "") if gaps else text).encode()
        advance("writing", min(first + step, len(values)), len(values))
