"""How processes that live long collect what they have used."""

import gc

YOUNG = 10_000
"""New objects, less those gone, at which Python looks for circles of dead ones: this many are made
within a few requests, and hardly any in a circle."""


def settle() -> None:
    """Let all that has been built stay, and seldom look at what is new.

    The garbage collector never looks at what stays.
    """
    gc.freeze()
    _, middle, old = gc.get_threshold()
    gc.set_threshold(YOUNG, middle, old)
