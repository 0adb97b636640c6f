"""Where the benchmarks find clips."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def folder() -> Path:
    """MOCURVE_CLIPS, or shared/clips beside the repository (cmu, other, ...); ends the program if it is not there."""
    found = Path(os.environ.get("MOCURVE_CLIPS") or Path(__file__).resolve().parents[2] / "shared" / "clips")
    if not found.is_dir():
        sys.exit("no shared clips: set MOCURVE_CLIPS to their folder")
    return found
