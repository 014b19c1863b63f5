"""How processes that live long collect what they have used."""

import gc

YOUNG = 10_000
"""New objects, less those gone, at which Python looks for circles of dead ones: this many are made
within a few requests, and hardly any in a circle."""

KEPT_BYTES = 256 * 1024**2
"""Free memory that a process of tables keeps for its next rows [bytes]."""


def variables_to_keep_memory() -> dict[str, str]:
    """Return the environment of a process that uses its memory again.

    To fetch fresh memory for each run of rows would hold up the whole of a virtual machine. They
    are of glibc and Arrow; elsewhere they mean nothing.
    """
    return {
        "MALLOC_MMAP_MAX_": "0",
        "MALLOC_TRIM_THRESHOLD_": str(KEPT_BYTES),
        "ARROW_DEFAULT_MEMORY_POOL": "system",
    }


def settle() -> None:
    """Let all that has been built stay, and seldom look at what is new.

    The garbage collector never looks at what stays.
    """
    gc.freeze()
    _, middle, old = gc.get_threshold()
    gc.set_threshold(YOUNG, middle, old)
