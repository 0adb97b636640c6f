"""C3D: places of markers, each a joint of its own without a bone; only read.

Read here and not by a library: what a file says of its own size has to be checked before it is believed, and once its
head is taken apart for that, the rest is one array. Source: the C3D file format user guide, c3d.org.
"""

from __future__ import annotations

import os
import warnings

import numpy as np

from ..errors import FileError
from ..motion import Clip, Motion
from ..skeleton import AXES, Skeleton
from . import UNITS
from . import _c3d_parameters as parameters
from ._c3d_parameters import BLOCK, MOST, Head
from ._files import Path, opened
from ._frame_time import USUAL

_NO_PLACES = ("ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS")  # POINT:ANGLES lists the points that are angles ...
_SAME_RATE = 2e-6  # relative: more than float32 needs, less than 1/1001


def read(path: Path) -> Motion:
    """The markers as roots with three position channels each, in the axes of the file; NaN where one was not seen.

    Unit and rate are those of the file. A warning names points that are no places and markers that are never seen:
    they are left out. FileError for a file that is cut or lies.
    """
    with opened(path) as file:
        size = os.fstat(file.fileno()).st_size
        head = parameters.head(file.read(MOST + 256 * BLOCK), path)
        frames = _frames(head, path)
        if not np.isfinite(head.scale):
            raise FileError(f"a scale of {head.scale}", path)
        integers, width = head.scale > 0, 4 * head.points + head.analog
        start, needed = (head.start - 1) * BLOCK, frames * width * (2 if integers else 4)
        if not head.points or not frames:
            raise FileError(f"{head.points} points in {frames} frames: there is nothing to read", path)
        if start < 0 or start + needed > size:
            raise FileError(f"{frames} frames of {head.points} points end at byte {start + needed} of {size}", path)
        file.seek(start)
        rows = file.read(needed)
    if len(rows) < needed:
        raise FileError("became shorter while it was read", path)
    values = (head.numbers.integers if integers else head.numbers.floats)(rows).reshape(frames, width)
    return _motion(head, values[:, : 4 * head.points].reshape(frames, head.points, 4), path)


def write(path: Path, clip: Clip) -> None:
    """Always FileError: a clip has bones, C3D has markers."""
    raise FileError("C3D files are only read; .csv keeps markers and their gaps", path)


def _frames(head: Head, path: Path) -> int:
    """How many frames; the first block counts only to 65535, and newer parameters go on from there."""
    counted = head.last - head.first + 1
    said = head.values.get("POINT:FRAMES", np.zeros(0))
    if head.last < 0xFFFF and counted > 0:
        if len(said) == 1 and 0 < said[0] != counted:
            told = f"{counted} frames by the first block, {said[0]:g} by POINT:FRAMES: the first are read"
            warnings.warn(f"{os.fsdecode(path)}: {told}", stacklevel=4)
        return counted
    fields = [head.values.get(f"TRIAL:ACTUAL_{end}_FIELD", np.zeros(0)) for end in ("START", "END")]
    if all(len(field) == 2 for field in fields):  # the lower 16 bits and the upper ones, stored with a sign
        first, last = (int(low) % 65536 + 65536 * (int(high) % 65536) for low, high in fields)
        counted = last - first + 1
    for name in ("POINT:LONG_FRAMES", "POINT:FRAMES"):
        said = head.values.get(name, np.zeros(0))
        if len(said) == 1 and np.isfinite(said[0]):
            counted = max(counted, int(said[0]) if said[0] >= 0 else int(said[0]) % 65536)
    return max(counted, 0)


def _motion(head: Head, points: np.ndarray, path: Path) -> Motion:
    """Points (F, P, 4): X, Y, Z, and a residual that is negative where the marker was not seen."""
    places = points[:, :, :3].astype(np.float64)
    if head.scale > 0:
        places *= head.scale
    unseen = (points[:, :, 3] < 0) | ~np.isfinite(places).all(axis=2) | ~places.any(axis=2)
    places[unseen] = np.nan
    names, seen = np.array(_names(head), object), ~unseen.all(axis=0)
    other = {name for kind in _NO_PLACES for name in head.texts.get(f"POINT:{kind}", [])}
    marker = np.array([name not in other for name in names])
    _tell(path, "are no places but angles or forces", names[~marker].tolist())
    _tell(path, "are seen in no frame", names[marker & ~seen].tolist())
    places = places[:, marker & seen]
    body = Skeleton(
        tuple(names[marker & seen].tolist()),
        np.full(places.shape[1], -1),
        np.nanmedian(places, axis=0) if places.size else np.zeros((0, 3)),
        (tuple(f"{axis}position" for axis in AXES),) * places.shape[1],
        unit=_unit(head, path),
    )
    return Motion(body, places.reshape(len(places), -1), _frame_time(head, path))


def _names(head: Head) -> list[str]:
    """POINT:LABELS, and LABELS2 ... where there are more than 255; numbers for markers that have none."""
    labels = list(head.texts.get("POINT:LABELS", []))
    number = 2
    while f"POINT:LABELS{number}" in head.texts:
        labels += head.texts[f"POINT:LABELS{number}"]
        number += 1
    labels += [""] * (head.points - len(labels))
    return [label or f"Marker{place + 1}" for place, label in enumerate(labels[: head.points])]


def _unit(head: Head, path: Path) -> float | None:
    said = "".join(head.texts.get("POINT:UNITS", [])).strip().lower()
    if said and said not in UNITS:
        warnings.warn(f"{os.fsdecode(path)}: the length unit {said[:40]!r} is not known", stacklevel=5)
    return UNITS.get(said)


def _frame_time(head: Head, path: Path) -> float:
    said = head.values.get("POINT:RATE", np.zeros(0))
    rate = float(said[0]) if len(said) and said[0] > 0 else head.rate
    if not 1e-6 < rate < 1e6:
        raise FileError(f"a rate of {rate:g} frames a second", path)
    near = [k / fps for k, fps in USUAL if abs(rate * k / fps - 1.0) < _SAME_RATE]
    return near[0] if near else 1.0 / rate


def _tell(path: Path, what: str, names: list[str]) -> None:
    if names:
        some = ", ".join(names[:5]) + (" …" if len(names) > 5 else "")
        warnings.warn(f"{os.fsdecode(path)}: {len(names)} of its points {what} and are left out: {some}", stacklevel=5)
