"""Samples and skeleton as NumPy arrays in a zip file, and the poses of AMASS, which have the same extension.

What is in them is told in docs/formats.md.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import FileError, Mismatch, MocurveError, OptionError
from ..motion import Clip, Motion
from ..skeleton import Skeleton
from ._clip_json import limits_of, limits_row
from ._files import Path, opened, replacing

if TYPE_CHECKING:
    from zipfile import ZipFile

PROFILES = {
    "mocurve": "everything of a motion",
    "amass": "poses of SMPL joints as axis-angle, metres; the body is not in it",
}
VERSION = 1
OF_SAMPLES = True
_POSES = {"poses": ("f", 2), "trans": ("f", 2)}  # AMASS
_RATES = ("mocap_framerate", "mocap_frame_rate")
_KINDS = {  # member: allowed NumPy kinds, dimensions
    "version": ("iu", 0),
    "values": ("f", 2),
    "frame_time": ("f", 0),
    "unit": ("f", 0),
    "joint_names": ("U", 1),
    "joint_channels": ("U", 1),
    "parents": ("i", 1),
    "offsets": ("f", 2),
    "end_sites": ("b", 1),
    "history": ("U", 0),
}
_LIMITS = {"limits": ("U", 0)}  # only of a body that has any
_BOMB, _RATIO = 1 << 28, 100  # more bytes than this from a hundredth of them in the file is no motion
_MAX_HEADER = 10_000


def read(path: Path, *, skeleton: Path | None = None) -> Motion:
    """The motion in an NPZ file that `write` made, or one of AMASS; nothing in it is ever executed.

    `skeleton` is a clip whose joints have the bones that AMASS does not: without it a mean body, with a warning.
    FileError for all other files, OptionError for a skeleton where the file has one.
    """
    import zipfile  # loaded only where there is an NPZ file to read

    with opened(path) as file, _refusing(path), zipfile.ZipFile(file) as archive:
        _check_sizes(archive, os.fstat(file.fileno()).st_size, path)
        posed = "poses.npy" in archive.namelist()
        kinds = _POSES if posed else _KINDS
        if not posed and "limits.npy" in archive.namelist():
            kinds = kinds | _LIMITS
        data = {name: _member(archive, name, kind, path) for name, kind in kinds.items()}
        given = [name for name in _RATES if f"{name}.npy" in archive.namelist()] if posed else []
        rate = float(_member(archive, given[0], ("iuf", 0), path)) if given else None
        own = None if posed else _motion(data, path)
    if own is None:
        from . import _amass  # not needed for our own files

        return _amass.motion(data["poses"], data["trans"], rate, skeleton, path)
    if skeleton is not None:
        raise OptionError(f"{os.fspath(path)!r} has a skeleton; skeleton= is for files of AMASS")
    return own


@contextmanager
def _refusing(path: Path) -> Iterator[None]:
    """FileError for what goes wrong with a zip file, or with arrays that no motion can have."""
    from struct import error as struct_error
    from zipfile import BadZipFile
    from zlib import error as zlib_error

    unreadable = (BadZipFile, struct_error, zlib_error, ValueError, TypeError, OSError, EOFError, SyntaxError)
    try:
        yield
    except FileError:
        raise
    except MocurveError as error:
        raise FileError(f"its arrays make no motion: {error}", path) from error
    except (*unreadable, RuntimeError, OverflowError) as error:
        raise FileError(f"not an NPZ file of a motion: {error}", path) from error


def write(path: Path, clip: Clip, *, profile: str = "mocurve", lossless: bool = False) -> None:
    """Write the samples of a clip, always with all digits; by the profile "amass" as that data set has them.

    Mismatch where the joints are not those of an AMASS file. What that loses is warned of.
    """
    motion = clip.sample()
    if profile == "amass":
        from . import _amass  # not needed for our own files

        arrays = _amass.arrays(motion)
    else:
        arrays = _own(motion, path)
    with replacing(path) as file:
        np.savez(file, **arrays)  # type: ignore[arg-type]  # its stubs take the arrays for its own options


def _own(motion: Motion, path: Path) -> dict[str, np.ndarray]:
    body, wrong = motion.skeleton, _impossible(motion)
    if wrong.any():
        frame, channel = (int(place[0]) for place in np.nonzero(wrong))
        told = f"{body.channel_names[channel]} is {motion.values[frame, channel]} at frame {frame}"
        raise Mismatch(f"{told}: only positions can be unknown, and nothing infinite")
    return {
        "version": np.array(VERSION),
        "values": motion.values,
        "frame_time": np.array(motion.frame_time),
        "unit": np.array(np.nan if body.unit is None else body.unit),
        "joint_names": _strings(body.names, path),
        "joint_channels": _strings([" ".join(kinds) for kinds in body.channels], path),
        "parents": body.parents,
        "offsets": body.offsets,
        "end_sites": body.end_sites,
        "history": np.array(json.dumps(list(motion.history))),
        **(
            {"limits": np.array(json.dumps([{"joint": own.joint, **limits_row(own)} for own in body.limits]))}
            if body.limits
            else {}
        ),
    }


def _strings(texts: Any, path: Path) -> np.ndarray:
    for text in texts:
        if text.endswith("\0"):  # NumPy would drop it
            raise FileError(f"cannot write: the name {text!r} ends in NUL", path)
    return np.array(texts, np.str_).reshape(-1)


def _check_sizes(archive: ZipFile, size: int, path: Path) -> None:
    """FileError where the members say that they unpack to far more than a file of this size holds."""
    unpacked = sum(member.file_size for member in archive.infolist())
    if unpacked > _BOMB and unpacked > _RATIO * size:
        raise FileError(f"unpacks to {unpacked} bytes from {size}: a motion does not", path)


def _member(archive: ZipFile, name: str, kind: tuple[str, int], path: Path) -> np.ndarray:
    """One array, after its own account of its size has been checked against the zip's."""
    try:
        info = archive.getinfo(f"{name}.npy")
    except KeyError:
        raise FileError(f"the array {name!r} is not in it: no NPZ file of a motion", path) from None
    with archive.open(info) as stream:
        shape, dtype = _header(stream)
        kinds, dimensions = kind
        if dtype.kind not in kinds or len(shape) != dimensions:
            raise FileError(
                f"{name}: {dimensions} dimensions of kind {kinds!r} expected, {len(shape)} of {dtype} found", path
            )
        said = int(np.prod([float(n) for n in shape])) * dtype.itemsize
        if said > info.file_size:
            raise FileError(f"{name}: says {said} bytes, {info.file_size} are there", path)
    with archive.open(info) as stream:
        return np.lib.format.read_array(stream, allow_pickle=False, max_header_size=_MAX_HEADER)


def _header(stream: Any) -> tuple[tuple[int, ...], np.dtype]:
    version = np.lib.format.read_magic(stream)
    read_header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, _, dtype = read_header(stream, max_header_size=_MAX_HEADER)
    return shape, dtype


def _motion(data: dict[str, np.ndarray], path: Path) -> Motion:
    if int(data["version"]) != VERSION:
        raise FileError(f"version {VERSION} expected, {data['version']} found", path)
    unit = float(data["unit"])
    history = json.loads(str(data["history"]))
    if not isinstance(history, list) or not all(isinstance(step, dict) for step in history):
        raise FileError("history: a list of objects expected", path)
    if not np.isfinite(data["offsets"]).all():
        raise FileError("offsets: finite numbers expected", path)
    body = Skeleton(
        tuple(data["joint_names"].tolist()),
        data["parents"],
        data["offsets"],
        tuple(tuple(kinds.split()) for kinds in data["joint_channels"].tolist()),
        data["end_sites"],
        None if np.isnan(unit) else unit,
        tuple(limits_of(row["joint"], row) for row in json.loads(str(data["limits"]))) if "limits" in data else (),
    )
    values = np.asfortranarray(data["values"], np.float64)
    motion = Motion(body, values, float(data["frame_time"]), tuple(history))
    if _impossible(motion).any():
        raise FileError("values: finite numbers expected, or NaN where a position is not known", path)
    return motion


def _impossible(motion: Motion) -> np.ndarray:
    """(F, C) True where a value is not finite; NaN is allowed for positions: markers have gaps."""
    return ~np.isfinite(motion.values) & (motion.skeleton.rotation_channels | ~np.isnan(motion.values))
