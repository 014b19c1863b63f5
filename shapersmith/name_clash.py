"""Whether `design`, `schemas` and `service` are those of shapersmith."""

import importlib
import importlib.util
import sys
from collections.abc import Sequence
from pathlib import Path

HOME = Path(__file__).resolve().parents[1]
"""The folder that holds shapersmith and its three packages."""

OWN_PACKAGES = ("design", "schemas", "service")


def import_own_packages() -> None:
    """Import the three packages, so that `sys.path` may change later.

    Raises
    ------
    ImportError
        If one of the names is taken by a foreign module, whether that is imported already or
        would be found first on `sys.path`. The foreign module is not imported.
    """
    for name in OWN_PACKAGES:
        imported = name in sys.modules
        places = _places_of(name)
        if str(HOME / name / "__init__.py") not in places:
            # A class of ours could be neither caught nor pickled by a worker: to import it is to
            # import shapersmith, which has just failed.
            raise ImportError(_message(name, places, imported=imported), name=name)
    for name in OWN_PACKAGES:
        importlib.import_module(name)


def _places_of(name: str) -> Sequence[str]:
    """Return the file of a module, or the folders of a namespace package; empty if unknown."""
    module = sys.modules.get(name)
    if module is None:
        spec = importlib.util.find_spec(name)
        file = None if spec is None else spec.origin
        folders = [] if spec is None else spec.submodule_search_locations or []
    else:
        file = getattr(module, "__file__", None)
        folders = getattr(module, "__path__", [])
    return [str(Path(place).resolve()) for place in ([file] if file else folders)]


def _message(name: str, places: Sequence[str], *, imported: bool) -> str:
    where = ", ".join(places) or "a module without a file"
    how = "is imported already" if imported else "comes first on sys.path"
    return (
        f"shapersmith needs its own package {name!r} in {HOME}, but the name stands for {where}, "
        f"which {how}. Ways out: use shapersmith in a fresh interpreter that does not import that "
        f"module; put {HOME} ahead of that module's folder on sys.path; call shapersmith over HTTP "
        f"(`shapersmith serve`); or rename that module."
    )
