"""Cut the shipped capture out of CMU's clip 01_01, as Debian's package assimp-testmodels carries it.

    python scripts/cut_example.py /usr/share/assimp/models/BVH/01_01.bvh src/mocurve/data/jump.bvh

The text of the rows is kept as it is, so every number stays the source's own. Two jumps forward, 420 frames at 120 fps;
frame 0 of the source, a T-pose that the conversion to BVH put in, is not among them.
"""

from __future__ import annotations

import sys
from pathlib import Path

FIRST, COUNT = 520, 420


def cut(source: str, first: int = FIRST, count: int = COUNT) -> str:
    """The text of a BVH with `count` of its frames, from frame `first` on."""
    lines = source.splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("Frame Time:")) + 1
    header = [f"Frames: {count}" if line.startswith("Frames:") else line.rstrip() for line in lines[:start]]
    rows = [line.rstrip() for line in lines[start + first : start + first + count]]
    if len(rows) < count:
        raise SystemExit(f"the source has no {first + count} frames")
    return "\n".join([*header, *rows]) + "\n"


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    Path(sys.argv[2]).write_text(cut(Path(sys.argv[1]).read_text(encoding="ascii")), encoding="ascii", newline="\n")
