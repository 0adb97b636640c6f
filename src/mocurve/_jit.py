"""How compiled kernels are made: one decorator, so that every kernel is cached, releases the GIL and never fails for
want of a cache."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba


def kernel(function: Callable[..., Any] | None = None, **options: Any) -> Any:
    """numba.njit for scalar loops on contiguous float64 arrays: lazy signatures, `nogil`, division as NumPy does it.

    Compiled code is kept beside the source or in the user's cache folder; where neither can be written it is compiled
    anew.
    """
    if function is None:
        return lambda inner: kernel(inner, **options)
    options = {"nogil": True, "error_model": "numpy", **options}
    try:
        return numba.njit(cache=True, **options)(function)
    except RuntimeError:  # numba found no folder to keep the compiled code in
        return numba.njit(**options)(function)
