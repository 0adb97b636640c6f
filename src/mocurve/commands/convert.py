"""`mocurve convert`: another format."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from ..formats import read, write
from ._options import Unit, keep_apart

Lossless = Annotated[bool, Parameter(help="Write numbers so that they read back bit for bit, not with six decimals.")]


def convert(source: Path, target: Path, /, *, unit: Unit = None, lossless: Lossless = False) -> None:
    """The same clip in another format; the extensions say which: .bvh .csv .npz .curves.json

    Keys become samples where the format knows only samples. Samples do not become keys: that is `mocurve reduce`.

    Example:
      mocurve convert jump.curves.json jump.bvh
    """
    keep_apart(source, target)
    write(target, read(source, unit=unit), lossless=lossless)
    print(f"wrote {target}")
