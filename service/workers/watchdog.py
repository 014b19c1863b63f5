"""How a worker process ends with those it works for, in the middle of a solve too."""

import multiprocessing
import os
import threading
from multiprocessing.connection import Connection, wait


def end_with_parent(*lifelines: Connection) -> None:
    """End this process when its parent ends or a lifeline breaks.

    Parameters
    ----------
    lifelines
        Ends of pipes; one breaks when whoever holds its other end is gone.
    """
    watched: list[Connection | int] = [*lifelines]
    parent = multiprocessing.parent_process()
    if parent is not None:
        watched.append(parent.sentinel)
    if watched:
        threading.Thread(target=_end_with, args=(watched,), daemon=True).start()


def _end_with(watched: list[Connection | int]) -> None:
    wait(watched)
    os._exit(0)
