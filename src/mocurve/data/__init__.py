"""The capture that ships with the package: two forward jumps of CMU's clip 01_01. Its terms: LICENSE.txt beside it."""

from __future__ import annotations

from pathlib import Path


def example() -> Path:
    """Where jump.bvh is: 420 frames at 120 fps, 96 channels. A plain file; copy it wherever it is to be worked on."""
    return Path(__file__).with_name("jump.bvh")
