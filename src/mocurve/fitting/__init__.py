"""From dense samples to B-splines on few knots, with the same promise as `reduce`: it is checked at every frame.

How the knots are chosen is in a table: adding a way is a function and a line here.
"""

from __future__ import annotations

from .knots import bisected, by_curvature, fewest, uniform
from .verb import fit

KNOTS = {"fewest": fewest, "bisected": bisected, "curvature": by_curvature, "uniform": uniform}

__all__ = ["KNOTS", "fit"]
