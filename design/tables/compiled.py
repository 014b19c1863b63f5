"""How the loops over rows are compiled: by numba, cached on disk where that can be written."""

import zlib
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

import numba
import numpy as np

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function) -> Function:
    """Return a function compiled at its first call.

    It runs without the interpreter's lock.

    The machine code is kept beside the source or, where that is read-only, in the user's cache
    directory; NUMBA_CACHE_DIR names another. Without any it is compiled anew in every process.

    Numba sees changes of the file only that a function stands in. So that compiled functions may
    call those of other files, the name of each, by which its machine code is filed, ends in a
    digest of itself and of all that it calls.

    Products and sums are rounded one by one as written, on every kind of machine: without
    ``fastmath`` they are neither reordered nor contracted.
    """
    return _compile(function, forceinline=False)


def inlined(function: Function) -> Function:
    """Return a function compiled as part of those that call it.

    The rest is as in `compiled`.

    Only so do loops over it become vector instructions.
    """
    return _compile(function, forceinline=True)


def is_kept(function: Callable[..., Any], arguments: Iterable[Any]) -> bool:
    """Return whether machine code for arguments of such types is on disk.

    Parameters
    ----------
    function
        A compiled function.
    arguments
        Arguments of the types that matter.

    Returns
    -------
    bool
        Whether this machine would run the function without compiling it. False where nothing can be
        kept on disk.
    """
    dispatcher: Any = function
    # Numba has no public word for its index: a test of each kind of table holds this against it.
    index = getattr(dispatcher._cache, "_cache_file", None)
    if index is None:
        return False
    types = tuple(map(dispatcher.typeof_pyval, arguments))
    key = dispatcher._cache._index_key(types, dispatcher.targetctx.codegen())
    return key in index._load_index()


def is_kept_for_some(function: Callable[..., Any]) -> bool:
    """Return whether machine code for arguments of any types is on disk.

    Parameters
    ----------
    function
        A compiled function.

    Returns
    -------
    bool
        False where nothing can be kept on disk.
    """
    index = getattr(function._cache, "_cache_file", None)  # type: ignore[attr-defined]
    return index is not None and bool(index._load_index())


def _compile(function: Function, *, forceinline: bool) -> Function:
    options = {
        "nogil": True,
        "error_model": "numpy",
        "forceinline": forceinline,
        "no_cfunc_wrapper": True,
    }
    function.__qualname__ = f"{function.__qualname__}_{_digest(function):08x}"
    try:
        fast: Function = numba.njit(cache=True, **options)(function)
    except RuntimeError:  # numba's word for "no directory to cache in"
        fast = numba.njit(**options)(function)
    return fast


def _digest(function: Callable[..., Any]) -> int:
    """Return a checksum of a function's code, and of the compiled functions and constants in it."""
    code: Any = function.__code__
    digest = zlib.crc32(code.co_code + repr(code.co_consts).encode())
    for name in code.co_names:
        value: Any = function.__globals__.get(name)
        if isinstance(value, np.ndarray):
            digest = zlib.crc32(value.tobytes(), digest)
        elif isinstance(value, int | float | tuple | np.generic):
            digest = zlib.crc32(repr(value).encode(), digest)
        elif hasattr(value, "py_func"):
            digest = zlib.crc32(value.py_func.__qualname__.encode(), digest)
    return digest
