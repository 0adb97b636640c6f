"""`mocurve convert`: another format."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from ..formats import read, write
from ._options import Source, Unit, check_outputs

Lossless = Annotated[bool, Parameter(show_default=False, help="Write all digits of every number, not six decimals.")]


def convert(source: Source, target: Path, /, *, unit: Unit = None, lossless: Lossless = False) -> None:
    """The same clip in another format.

    The extensions say which. Keys become samples where the format knows only
    samples. Samples do not become keys: that is `mocurve reduce`.

    For example:
      mocurve convert jump.curves.json jump.bvh
    """
    check_outputs(source, target)
    write(target, read(source, unit=unit), lossless=lossless)
    print(f"wrote {target}")
