"""The residual of a shaper in each of several modes."""

from collections.abc import Iterable
from itertools import zip_longest

from design.analysis.sensitivity import Sensitivity
from design.model.plants.mode import Mode
from schemas.sensitivity import ModeOut


def of_modes(
    modes: tuple[Mode, ...], residuals: Iterable[float], curves: list[Sensitivity]
) -> list[ModeOut]:
    """Return the residual vibration in each mode.

    Parameters
    ----------
    modes
        The modes of the plant.
    residuals
        Residual vibration in each of them [-].
    curves
        Sensitivity curve of each mode; empty where none was asked for.

    Returns
    -------
    list of ModeOut
        An entry for each mode.
    """
    each = zip_longest(modes, residuals, curves)
    return [ModeOut.from_design(mode, residual, curve) for mode, residual, curve in each]
