"""Files: one module a format, each with `read(path) -> clip` and `write(path, clip, lossless)`."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from os import PathLike, fsdecode
from typing import TYPE_CHECKING, Protocol, cast

from ..errors import OptionError

if TYPE_CHECKING:
    from ..keyed import KeyedMotion
    from ..motion import Clip, Motion

FORMATS = {".bvh": "bvh", ".curves.json": "curves_json", ".csv": "csv", ".npz": "npz"}  # modules, loaded when needed
UNITS = {"mm": 0.001, "cm": 0.01, "m": 1.0, "in": 0.0254, "inch": 0.0254, "ft": 0.3048}  # metres


def read(path: str | PathLike[str], *, unit: str | float | None = None) -> Motion | KeyedMotion:
    """Read a clip; the extension says which format.

    unit: what one length unit is, "mm" "cm" "m" "in" "ft" or metres as a number; None keeps what the file says.
    OptionError for an extension or unit that is not known, FileError for a file that cannot be read.

        walk = mc.read("walk.bvh", unit="inch")
    """
    clip = format_of(path).read(path)
    return clip if unit is None else replace(clip, skeleton=replace(clip.skeleton, unit=metres(unit)))


def write(path: str | PathLike[str], clip: Clip, *, lossless: bool = False) -> None:
    """Write a clip; the extension says which format. An existing file is replaced only when all is written.

    lossless: numbers with all their digits, where the format otherwise rounds (BVH and CSV: to six decimals).

        mc.write("walk.curves.json", keys)
    """
    format_of(path).write(path, clip, lossless)


def metres(unit: str | float) -> float:
    """Metres in a unit of length, given by name or as a number."""
    if isinstance(unit, str) and unit.lower() in UNITS:
        return UNITS[unit.lower()]
    try:
        number = float(unit)
    except (TypeError, ValueError):
        number = -1.0
    if not 0 < number < float("inf"):
        raise OptionError(f"unit is one of {', '.join(UNITS)} or a positive number of metres, not {unit!r}")
    return number


class Format(Protocol):
    """What the module of a format has."""

    def read(self, path: str | PathLike[str]) -> Motion | KeyedMotion: ...
    def write(self, path: str | PathLike[str], clip: Clip, lossless: bool) -> None: ...


def format_of(path: str | PathLike[str]) -> Format:
    """The module that reads and writes files of that name; OptionError where none does."""
    name = fsdecode(path).lower()
    for extension in sorted(FORMATS, key=len, reverse=True):
        if name.endswith(extension):
            return cast(Format, import_module(f".{FORMATS[extension]}", __name__))
    raise OptionError(f"no format known for {fsdecode(path)!r}; a file name ends in {', '.join(FORMATS)}")
