"""`mocurve render`: pictures."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .. import draw
from ..formats import read
from ._options import keep_apart, with_options_of

Output = Annotated[
    Path, Parameter(name=("--output", "-o"), help="The picture: .png shows poses along the way, .gif plays.")
]


@with_options_of(draw.render)
def render(file: Path, /, *, output: Output, **options: object) -> None:
    """A picture (.png) or an animation (.gif) of the moving figure.

    Example:
      mocurve render jump.bvh -o jump.gif
    """
    keep_apart(file, output)
    draw.render(read(file), output, **options)
    print(f"wrote {output}")
