"""Accessors of a glTF file as arrays: every count is checked against the bytes that are there before it is believed."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._gltf_read_json import Document

_FLOAT = 5126
_COMPONENTS: dict[Any, str] = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", _FLOAT: "<f4"}
_LARGEST = {5120: 127, 5121: 255, 5122: 32767, 5123: 65535}  # what stands for 1 where integers are normalized
_WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}
_MOST = 1 << 53


def floats(document: Document, index: Any, place: str, kind: str, count: int | None = None) -> np.ndarray:
    """An accessor as (N, width) float64, finite; normalized integers become -1..1 or 0..1.

    kind:  the type that is expected, "SCALAR", "VEC3", "VEC4" (which may be of normalized integers).
    count: how many elements are expected. None: as many as it says, where bytes stand behind them.
    """
    accessor, place = document.one("accessors", index, place), f"accessors[{index}]"
    said = document.whole(accessor.get("count"), f"{place}.count", 1, _MOST)
    if accessor.get("type") != kind:
        document.fail(f"{place}.type", f"{kind} expected, {str(accessor.get('type'))[:40]} found")
    if count is not None and said != count:
        document.fail(f"{place}.count", f"{count} expected, {said} found")
    component = accessor.get("componentType")
    integers = kind == "VEC4" and accessor.get("normalized") is True
    if type(component) is not int or not (component == _FLOAT or (integers and component in _LARGEST)):
        expected = "5126 (float)" + (" or normalized integers" if kind == "VEC4" else "")
        document.fail(f"{place}.componentType", f"{expected} expected, {str(component)[:40]} found")
    dtype, width = np.dtype(_COMPONENTS[component]), _WIDTHS[kind]
    values = _dense(document, accessor, place, dtype, width, said, count is not None)
    if "sparse" in accessor:
        values = values.copy()
        _put_sparse(document, accessor["sparse"], f"{place}.sparse", values)
    with np.errstate(invalid="ignore"):  # a NaN that signals: told below
        result = values.astype(np.float64)
    if component != _FLOAT:
        result = np.maximum(result / _LARGEST[component], -1.0)
    bad = ~np.isfinite(result).all(axis=1)
    if bad.any():
        at = int(np.argmax(bad))
        document.fail(place, f"finite numbers expected, {result[at].tolist()} found in element {at}")
    return result


def _dense(
    document: Document, accessor: dict[str, Any], place: str, dtype: np.dtype, width: int, count: int, known: bool
) -> np.ndarray:
    if "bufferView" in accessor:
        start = document.whole(accessor.get("byteOffset", 0), f"{place}.byteOffset", 0, _MOST)
        return _elements(document, accessor["bufferView"], place, start, dtype, width, count)
    if not known:  # zeros for which no byte of the file stands
        document.fail(f"{place}.bufferView", "expected, there is none")
    return np.zeros((count, width), dtype)


def _elements(
    document: Document, index: Any, place: str, start: int, dtype: np.dtype, width: int, count: int
) -> np.ndarray:
    """A view (count, width) of a buffer view from byte `start` on."""
    view, its = document.one("bufferViews", index, f"{place}.bufferView"), f"bufferViews[{index}]"
    number = view.get("buffer")
    data = document.buffer(number, f"{its}.buffer")
    offset = document.whole(view.get("byteOffset", 0), f"{its}.byteOffset", 0, _MOST)
    size = document.whole(view.get("byteLength"), f"{its}.byteLength", 1, _MOST)
    if offset + size > len(data):
        document.fail(its, f"ends at byte {offset + size} of buffers[{number}], which has {len(data)}")
    element = dtype.itemsize * width
    stride = document.whole(view.get("byteStride", element), f"{its}.byteStride", element, 255)
    end = start + stride * (count - 1) + element
    if end > size:
        document.fail(place, f"{count} elements end at byte {end} of {its}, which has {size}")
    return np.ndarray((count, width), dtype, data, offset + start, (stride, dtype.itemsize))


def _put_sparse(document: Document, sparse: Any, place: str, values: np.ndarray) -> None:
    """Put the elements that are told one by one in their places."""
    sparse = document.object(sparse, place)
    count = document.whole(sparse.get("count"), f"{place}.count", 1, len(values))
    told = document.object(sparse.get("indices"), f"{place}.indices")
    component = told.get("componentType")
    if component not in (5121, 5123, 5125):
        document.fail(f"{place}.indices.componentType", f"5121, 5123 or 5125 expected, {str(component)[:40]} found")
    indices = _part(document, told, f"{place}.indices", np.dtype(_COMPONENTS[component]), 1, count)[:, 0].astype(
        np.int64
    )
    if (np.diff(indices) <= 0).any() or indices[-1] >= len(values):
        document.fail(f"{place}.indices", f"rising indices below {len(values)} expected")
    told = document.object(sparse.get("values"), f"{place}.values")
    values[indices] = _part(document, told, f"{place}.values", values.dtype, values.shape[1], count)


def _part(document: Document, told: dict[str, Any], place: str, dtype: np.dtype, width: int, count: int) -> np.ndarray:
    start = document.whole(told.get("byteOffset", 0), f"{place}.byteOffset", 0, _MOST)
    return _elements(document, told.get("bufferView"), place, start, dtype, width, count)
