"""Which version of the product answers."""

import functools
import importlib.metadata


@functools.cache
def version() -> str:
    """Return the version of the installed product."""
    return importlib.metadata.version("shapersmith")
