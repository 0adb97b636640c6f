"""The rows of a CSV file as numbers, where they are wrong, and the frame time that their times tell."""

from __future__ import annotations

import csv
import re
from decimal import Decimal
from typing import NoReturn

import numpy as np

from ..errors import FileError
from ._files import Path
from ._frame_time import USUAL

_NUMBER = re.compile(r"[ \t]*[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?[ \t]*")
_GAP = re.compile(r"[ \t]*(?:[+-]?nan)?[ \t]*", re.IGNORECASE)
_LOOKED_AT = 50  # rows, to see how many decimals the times have
_NEAR_WHOLE = 0.01  # frames a second
_UNEVEN = 1e-6  # of a frame, besides the decimals of the times


class Rows:
    """The lines of a file below its head, each with as many cells as there are columns."""

    def __init__(self, lines: list[str], first: int, separator: str, columns: list[str], path: Path):
        self.columns, self.separator, self.path = columns, separator, path
        self.numbered = [(k, line) for k, line in enumerate(lines, first) if line.strip(" \t") or separator in line]

    def values(self) -> np.ndarray:
        """(F, columns) numbers, NaN for a cell that is empty or says nan. FileError with line and column."""
        if not self.numbered:
            return np.empty((0, len(self.columns)))
        lines = [line for _, line in self.numbered]
        values = self._table(lines)
        if values is None:  # perhaps for empty cells
            edge, blank = f"[^{self.separator}]", " " if self.separator == "\t" else "[ \t]"
            empty = re.compile(f"(?<!{edge}){blank}*(?!{edge})")
            values = self._table([empty.sub("nan", line) for line in lines])
        return self._refuse() if values is None else values

    def _table(self, lines: list[str]) -> np.ndarray | None:
        """None where not all cells are finite numbers or nan, one for each column."""
        try:
            values = np.loadtxt(lines, delimiter=self.separator, comments=None, ndmin=2, quotechar='"')
        except ValueError:
            return None
        return values if values.shape[1] == len(self.columns) and not np.isinf(values).any() else None

    def frame_time(self, column: int, times: np.ndarray) -> float:
        """Seconds from frame to frame of evenly spaced times (F,), at least two; FileError with the line if uneven.

        Decimal digits are taken for what they are digits of: 0.000000, 0.008333, 0.016667 are frames of 1/120 s.
        """
        if np.isnan(times).any():
            self._fail(int(np.argmax(np.isnan(times))), column, "a time expected, the cell is empty")
        last = len(times) - 1
        decimals = max(self._decimals(row, column) for row in [*range(min(last, _LOOKED_AT)), last])
        unit, steps = 10.0**-decimals, np.diff(times)
        frame_time = _meant((times[-1] - times[0]) / last, decimals, last)
        if abs(frame_time - steps[0]) <= 1e-12 * steps[0] and np.array_equal(times, _even(times, float(steps[0]))):
            return float(steps[0])  # to the last digit
        away = times - _even(times, frame_time)
        odd = (steps <= 0) | (np.abs(steps - frame_time) >= 0.5 * frame_time)
        odd |= (np.maximum.accumulate(away) - np.minimum.accumulate(away) > 2 * unit + _UNEVEN * frame_time)[1:]
        if odd.any():
            usual = float(np.median(steps))
            first = (steps <= 0) | (np.abs(steps - usual) > unit + _UNEVEN * usual)
            row = int(np.argmax(first if first.any() else odd)) + 1
            told = f"{times[row]:.9g} s, {steps[row - 1]:.6g} s after the row before, where {usual:.6g} s are usual"
            self._fail(row, column, told)
        return frame_time

    def _decimals(self, row: int, column: int) -> int:
        cell = self._cells(row)[column].strip()
        return max(-int(Decimal(cell).as_tuple().exponent), 0)

    def _cells(self, row: int) -> list[str]:
        number, line = self.numbered[row]
        try:
            return next(csv.reader([line], delimiter=self.separator, strict=True))
        except csv.Error as error:
            raise FileError(f"no row of a table: {error}", self.path, number) from error

    def _fail(self, row: int, column: int, what: str) -> NoReturn:
        told = f"column {column + 1} ({self.columns[column]}): {what}"
        raise FileError(told, self.path, self.numbered[row][0])

    def _refuse(self) -> NoReturn:
        """FileError for the first cell that is wrong."""
        for row, (number, _) in enumerate(self.numbered):
            cells = self._cells(row)
            if len(cells) != len(self.columns):
                hint = "; numbers have decimal points, not commas" if len(cells) > len(self.columns) else ""
                raise FileError(f"{len(self.columns)} cells expected, {len(cells)} found{hint}", self.path, number)
            for column, cell in enumerate(cells):
                if not _GAP.fullmatch(cell) and not (_NUMBER.fullmatch(cell) and np.isfinite(float(cell))):
                    hint = " with a decimal point, not a comma," if "," in cell else ""
                    self._fail(row, column, f"a number{hint} expected, {cell[:40]!r} found")
        raise FileError("its rows are no table of numbers", self.path)


def _even(times: np.ndarray, step: float) -> np.ndarray:
    return times[0] + np.arange(len(times)) * step


def _meant(mean: float, decimals: int, steps: int) -> float:
    """The rate that a mean of rounded steps is of: the first usual one, or a whole one, within what rounding can do."""
    within = min(1.01 * 10.0**-decimals / steps, 0.005 * mean)
    near = [k / fps for k, fps in USUAL if abs(k / fps - mean) <= within]
    rate = round(1.0 / mean) if 1e-6 < mean < 1e3 else 0
    if not near and rate and abs(1.0 / rate - mean) <= within and abs(1.0 / mean - rate) < _NEAR_WHOLE:
        near = [1.0 / rate]
    return near[0] if near else float(f"{mean:.{min(decimals + len(str(steps)), 25)}f}")
