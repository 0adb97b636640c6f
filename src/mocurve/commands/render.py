"""`mocurve render`: pictures."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from .. import draw
from ..formats import read
from ._options import Source, check_outputs, with_options_of
from ._terminal import told_when_compiling

Output = Annotated[Path, Parameter(name=("--output", "-o"), help="The picture: .png or .gif.")]


@with_options_of(draw.render)
@told_when_compiling()
def render(file: Source, second: Source | None = None, /, *, output: Output, **options: Any) -> None:
    """A picture (.png) or an animation (.gif) of the moving figure.

    A second clip is drawn over the first, to see where they differ.

    For example:
      mocurve render jump.bvh -o jump.gif
      mocurve render jump.bvh -o way.png --poses 12 --view side
      mocurve render jump.bvh jump.curves.json -o both.png --view side
    """
    check_outputs(file, output)
    if second is not None:
        check_outputs(second, output)
    draw.render(read(file), output, None if second is None else read(second), **options)
    print(f"wrote {output}")
