"""Files: one module a format, each with `read(path, ...)` and `write(path, clip, ...)`.

A format takes only the options that its own two functions name; `PROFILES`, where a module has them, are the ways that
it can be written, the first by default; OF_SAMPLES tells that keys are lost, SEVERAL that it holds several clips.
"""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib import import_module
from os import PathLike, fsdecode
from types import ModuleType
from typing import TYPE_CHECKING, Any

from ..errors import OptionError, UnknownName

if TYPE_CHECKING:
    from ..keyed import KeyedMotion
    from ..motion import Clip, Motion
    from ..spline import SplineMotion

FORMATS = {  # modules, loaded when needed
    ".bvh": "bvh",
    ".curves.json": "curves_json",
    ".spline.json": "spline_json",
    ".blend.py": "blender",
    ".csv": "csv",
    ".npz": "npz",
    ".c3d": "c3d",
    ".glb": "gltf",
    ".gltf": "gltf",
    ".amc": "acclaim",
    ".asf": "acclaim",
    ".fbx": "fbx",
    ".ma": "maya",
    ".usda": "usd",
}
UNITS = {"mm": 0.001, "cm": 0.01, "m": 1.0, "in": 0.0254, "inch": 0.0254, "ft": 0.3048}  # metres


def read(
    path: str | PathLike[str],
    *,
    unit: str | float | None = None,
    skeleton: str | PathLike[str] | None = None,
    animation: str | None = None,
) -> Motion | KeyedMotion | SplineMotion:
    """Read a clip; the extension says which format.

    Parameters
    ----------
    unit
        What one length unit is: mm, cm, m, in, ft or metres as a number; by default what the file says.
    skeleton
        File that holds the body where the clip's own file has only the motion: x.asf for x.amc.
    animation
        Which animation of a file that holds several, by name; by default the first.

    The `history` is the one that the file carries; where it has none, it begins with what was read. OptionError for an
    extension, a unit or an option that the format does not know, FileError for a file that cannot be read.

    >>> walk = mc.read("walk.bvh", unit="inch")
    """
    form, extension = _format(path)
    clip = form.read(path, **_taken(form.read, extension, skeleton=skeleton, animation=animation))
    if unit is not None:
        clip = replace(clip, skeleton=replace(clip.skeleton, unit=metres(unit)))
    if clip.history:
        return clip
    told = {"file": fsdecode(path), "unit": unit, "skeleton": skeleton and fsdecode(skeleton), "animation": animation}
    step = {"verb": "read", **{name: value for name, value in told.items() if value is not None}}
    return replace(clip, history=(step,))


def write(
    path: str | PathLike[str],
    clip: Clip | Mapping[str, Clip],
    *,
    profile: str | None = None,
    tolerance: str | None = None,
    mesh: bool = True,
    lossless: bool = False,
) -> None:
    """Write a clip; the extension says which format. An existing file is replaced only when all is written.

    Parameters
    ----------
    clip
        One clip, or {name: clip} of one body for a format that holds several animations (.glb, .gltf). Splines become
        the same curves as keys for a format that takes keys (degree 3 at most), else samples.
    profile
        How, where a format knows several ways; `mocurve convert --help` tells them.
    tolerance
        How far a profile that chooses keys of its own may leave the clip (as of `reduce`); by default what the clip was
        reduced with, else the default of `reduce`.
    mesh
        Put a figure of octahedra around the bones, so that every viewer shows something (.glb, .gltf).
    lossless
        Numbers with all their digits, where the format otherwise rounds (BVH, CSV: six decimals).

    >>> mc.write("walk.curves.json", keys)
    """
    form, extension = _format(path)
    options = {
        "profile": profile,
        "tolerance": tolerance,
        "lossless": lossless or None,
        "mesh": None if mesh else False,
    }
    taken = _taken(form.write, extension, **options)
    if profile is not None and profile not in form.PROFILES:
        raise UnknownName(f"profile of {extension}", profile, form.PROFILES)
    if isinstance(clip, Mapping) and not getattr(form, "SEVERAL", False):
        raise OptionError(f"a {extension} file holds one clip; write {len(clip)} files")
    from .. import spline  # numbers and nothing heavy, for who writes

    of_samples = getattr(form, "OF_SAMPLES", False)
    if isinstance(clip, spline.SplineMotion) and extension != ".spline.json" and not of_samples:
        clip = spline.to_keys(clip)
    lost = "keys" if hasattr(clip, "curves") else "splines" if hasattr(clip, "knots") else None
    if of_samples and lost:
        warnings.warn(f"{lost} become samples: {extension} files have one at every frame", stacklevel=2)
    form.write(path, clip, **taken)


def _taken(function: Callable[..., Any], extension: str, **options: Any) -> dict[str, Any]:
    """The options that were given; OptionError for one that this format has no use for."""
    given = {name: value for name, value in options.items() if value is not None}
    for name in given:
        if name not in inspect.signature(function).parameters:
            raise OptionError(f"{extension} files have no option {name}")
    return given


def metres(unit: str | float) -> float:
    """Metres in a unit of length, given by name or as a number."""
    if isinstance(unit, str) and unit.lower() in UNITS:
        return UNITS[unit.lower()]
    try:
        number = float(unit)
    except (TypeError, ValueError):
        number = -1.0
    if not 0 < number < float("inf"):
        raise OptionError(f"unit is one of {', '.join(UNITS)} or a positive number of metres, not {unit!r}")
    return number


def format_of(path: str | PathLike[str]) -> ModuleType:
    """The module that reads and writes files of that name; OptionError where none does."""
    return _format(path)[0]


def _format(path: str | PathLike[str]) -> tuple[ModuleType, str]:
    name = fsdecode(path).lower()
    for extension in sorted(FORMATS, key=len, reverse=True):
        if name.endswith(extension):
            return import_module(f".{FORMATS[extension]}", __name__), extension
    raise OptionError(f"no format known for {fsdecode(path)!r}; a file name ends in {', '.join(FORMATS)}")
