"""Input shapers for flexible machines whose actuators are not ideal.

The packages `design`, `schemas` and `service` belong to it. `import shapersmith` raises an
`ImportError` that names the clash where one of these names stands for another module.
"""

from shapersmith.name_clash import import_own_packages

import_own_packages()


def __getattr__(name: str) -> str:
    """Return ``__version__``: what reads it takes longer than the help of the command line."""
    if name != "__version__":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib.metadata import version  # noqa: PLC0415

    return version("shapersmith")
