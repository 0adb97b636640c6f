"""`mocurve example`: the shipped capture."""

from __future__ import annotations

import shutil
from pathlib import Path

from ..data import example as shipped
from ..errors import OptionError


def example(folder: Path = Path(), /) -> None:
    """Put a real capture, jump.bvh, into a folder to try things on.

    Two jumps forward: 420 frames at 120 fps, 31 joints, 96 channels. Cut from clip
    01_01 of CMU's motion capture database (mocap.cs.cmu.edu; created with funding
    from NSF EIA-0196217).

    For example:
      mocurve example
      mocurve info jump.bvh
    """
    target = folder / "jump.bvh"
    if target.exists() and target.read_bytes() != shipped().read_bytes():
        raise OptionError(f"{target} is there already and is another file")
    shutil.copyfile(shipped(), target)
    print(f"wrote {target}")
