"""Processes of the service find its packages, whatever modules the working folder holds.

An interpreter that is started by `-m` or `-c` searches the working folder first. A user's own
folder `service` there would take the place of ours.
"""

import os
from collections.abc import Sequence
from pathlib import Path

from service.workers.system import HAS_FORK_SERVER

HOME = Path(__file__).parents[2]
"""The folder that holds our packages."""


def variables() -> dict[str, str]:
    """Return the environment by which Python finds our packages first.

    The variables ``PYTHONSAFEPATH`` and ``PYTHONPATH``; the latter keeps what this process has in
    it.
    """
    inherited = os.environ.get("PYTHONPATH")
    return {
        "PYTHONSAFEPATH": "1",
        "PYTHONPATH": os.pathsep.join([str(HOME), *([inherited] if inherited else [])]),
    }


def ensure_fork_server(preloaded: Sequence[str]) -> None:
    """Start the process that workers are forked from, unless it runs already.

    Where there can be none each worker is started by itself, and imports what it needs.

    Parameters
    ----------
    preloaded
        Names of the modules that it imports.
    """
    # One thread of BLAS a worker: the workers are the parallelism.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if not HAS_FORK_SERVER:
        return
    from multiprocessing import forkserver  # noqa: PLC0415 - Windows has none

    forkserver.set_forkserver_preload(list(preloaded))
    # It inherits the environment and takes no other; this process keeps its own.
    kept = {name: os.environ.get(name) for name in variables()}
    os.environ.update(variables())
    try:
        forkserver.ensure_running()
    finally:
        for name, value in kept.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
