"""From dense samples to few keys, with a promise.

The methods are in two tables: METHODS find keys for curves, whichever channels share their times; CHOOSERS choose
whole poses. Adding one is a file with `solve` or `choose` and a line. Whatever a method returns, `reduce` checks the
promise itself, at every frame, and repairs it.
"""

from __future__ import annotations

from . import dynamic, linear, optimal, split
from .poses import CHOOSERS, Poses, poses
from .problem import ALIGNMENTS
from .refine import refine
from .verb import Method, reduce

METHODS = {
    "optimal": Method(optimal.solve, again=True),
    "split": Method(split.solve),
    "dynamic": Method(dynamic.solve),
    "linear": Method(linear.solve, again=True),
}
QUALITIES = ("fast", "default", "good", "best")

__all__ = ["ALIGNMENTS", "CHOOSERS", "METHODS", "QUALITIES", "Method", "Poses", "poses", "reduce", "refine"]
