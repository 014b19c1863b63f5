"""How the loops over rows are compiled: by numba, cached on disk where that can be written."""

from collections.abc import Callable
from typing import Any, TypeVar

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function) -> Function:
    """Return a function compiled at its first call, without the interpreter's lock.

    The machine code is kept beside the source or, where that is read-only, in the user's cache
    directory; NUMBA_CACHE_DIR names another. Without any it is compiled anew in every process.
    Numba sees changes of the file only that a function stands in: compiled functions call none of
    other files.
    """
    options = {"nogil": True, "error_model": "numpy"}
    try:
        fast: Function = numba.njit(cache=True, **options)(function)
    except RuntimeError:  # numba's word for "no directory to cache in"
        fast = numba.njit(**options)(function)
    return fast
