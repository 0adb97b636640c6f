"""How compiled kernels are made: one decorator, so that every kernel is cached, releases the GIL and never fails for
want of a cache."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba


def _sources() -> str:
    """One number for the text of all files with kernels."""
    texts = (path.read_bytes() for path in sorted(Path(__file__).parent.rglob("*.py")))
    return hashlib.sha256(b"".join(text for text in texts if b"_jit import kernel" in text)).hexdigest()


# Numba keeps a compiled kernel until its own file changes; one that calls it from another file would go on with the old
# one. So every kernel is kept until any file with kernels changes.
SOURCES = _sources()


def kernel(function: Callable[..., Any] | None = None, **options: Any) -> Any:
    """numba.njit for scalar loops on contiguous float64 arrays: lazy signatures, `nogil`, division as NumPy does it.

    Compiled code is kept beside the source or in the user's cache folder; where neither can be written it is compiled
    anew.
    """
    if function is None:
        return lambda inner: kernel(inner, **options)
    options = {"nogil": True, "error_model": "numpy", **options}
    try:
        compiled = numba.njit(cache=True, **options)(function)
    except RuntimeError:  # numba found no folder to keep the compiled code in
        return numba.njit(**options)(function)
    index: Any = getattr(getattr(compiled, "_cache", None), "_cache_file", None)
    if hasattr(index, "_source_stamp"):  # numba's own affair: should it go, only who edits kernels is in danger
        index._source_stamp = SOURCES
    return compiled
