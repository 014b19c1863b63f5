"""Several modes that change alike: the worst residual of any, and the interval common to all."""

from collections.abc import Sequence

import numpy as np

from design.analysis.insensitivity import Insensitivity
from design.analysis.sensitivity import Sensitivity


def worst_of(curves: Sequence[Sensitivity]) -> Sensitivity:
    """Return the largest residuals of several modes that change alike.

    The frequencies of all modes are off by the same ratio.

    Parameters
    ----------
    curves
        One a mode, over the same ratios and at the same tolerance; at least one.

    Returns
    -------
    Sensitivity
        Its insensitivity is the interval common to all modes; None where one mode has none.
    """
    damped = [curve.damping for curve in curves if curve.damping is not None]
    over_damping = None
    if damped:
        over_damping = damped[0][0], np.max([residuals for _, residuals in damped], axis=0)
    return Sensitivity(
        frequency_ratios=curves[0].frequency_ratios,
        residuals=np.max([curve.residuals for curve in curves], axis=0),
        tolerance=curves[0].tolerance,
        insensitivity=common_interval([curve.insensitivity for curve in curves]),
        damping=over_damping,
    )


def common_interval(intervals: Sequence[Insensitivity | None]) -> Insensitivity | None:
    """Return the interval common to several modes at one tolerance.

    Parameters
    ----------
    intervals
        One a mode, all at the same tolerance; None where a mode's nominal is above it.

    Returns
    -------
    Insensitivity or None
        None where one mode has none.
    """
    known = [interval for interval in intervals if interval is not None]
    if len(known) < len(intervals):
        return None
    first = max(known, key=lambda interval: interval.searched_from_ratio)
    last = min(known, key=lambda interval: interval.searched_to_ratio)
    return Insensitivity(
        tolerance=first.tolerance,
        lower_ratio=first.lower_ratio,
        upper_ratio=last.upper_ratio,
        searched_from_ratio=first.searched_from_ratio,
        searched_to_ratio=last.searched_to_ratio,
    )
