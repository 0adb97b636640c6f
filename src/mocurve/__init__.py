"""Motion capture into clean, compact, editable animation curves."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .edit.path_edit import PathEdit
    from .errors import FileError, Mismatch, MocurveError, OptionError, UnknownName
    from .feet.contacts import Contact
    from .keyed import HermiteCurve, KeyedMotion
    from .motion import Clip, Motion, unroll
    from .path import Path
    from .skeleton import Skeleton
    from .spline import SplineMotion

# public name -> module; loaded at first use, so that `mocurve --help` does not pay for kernels
_HOME = {
    "FileError": "errors",
    "Mismatch": "errors",
    "MocurveError": "errors",
    "OptionError": "errors",
    "UnknownName": "errors",
    "Skeleton": "skeleton",
    "Clip": "motion",
    "Motion": "motion",
    "unroll": "motion",
    "HermiteCurve": "keyed",
    "KeyedMotion": "keyed",
    "SplineMotion": "spline",
    "Path": "path",
    "read": "formats",
    "write": "formats",
    "denoise": "denoising",
    "reduce": "reduction",
    "fit": "fitting",
    "refine": "reduction",
    "poses": "reduction",
    "compare": "measure",
    "trim": "edit.trim",
    "axes": "edit.axes",
    "blend": "edit.blend",
    "mix": "edit.mix",
    "interpolate": "edit.interpolate",
    "difference": "edit.difference",
    "add": "edit.add",
    "scale": "edit.scale",
    "warp": "edit.warp",
    "retime": "edit.retime",
    "loop": "edit.loop",
    "join": "edit.join",
    "register": "edit.register",
    "bands": "edit.bands",
    "waveshape": "edit.waveshape",
    "limit": "edit.limit",
    "act_out": "edit.act_out",
    "follow": "edit.follow",
    "PathEdit": "edit.path_edit",
    "Contact": "feet.contacts",
    "contacts": "feet.contacts",
    "lock_feet": "edit.lock_feet",
    "render": "draw",
    "sheet": "draw",
    "run": "recipe",
}
__all__ = ["__version__", *_HOME]
__version__ = "0.4.0"


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'mocurve' has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted(__all__)
