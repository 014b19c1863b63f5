"""EI, two- and three-hump EI, UM-EI and UM-2EI: the residual of a shaper may reach a tolerance.

At the price of that the band of frequencies is wider than that of a shaper without vibration at the
nominal one. The equations and their solution are those of `design.formulations.humps`.
"""

import functools
from dataclasses import dataclass

from design.checks import require_between
from design.claims import ZERO_LIMITS, Promise, within
from design.formulations.formulation import ClosedForm, Formulation
from design.formulations.humps import Humps, follow_from_undamped
from design.model.actuators.ideal import Ideal
from design.model.impulses import Impulses
from design.shapers.actuators import EVERY_ACTUATOR_BY_ITS_LAG
from design.shapers.kind import DesignCase, KindOf, ShaperKind
from design.shapers.options import (
    MAX_TOLERANCE,
    MIN_TOLERANCE,
    ShaperOptions,
    tolerance_field,
)
from design.shapers.positive import exact_actuator


@dataclass(frozen=True, slots=True, kw_only=True)
class ToleranceOptions(ShaperOptions):
    """Parameters of the extra-insensitive shapers.

    Attributes
    ----------
    tolerance
        Largest residual vibration between the outermost zeros [-].
    """

    tolerance: float = tolerance_field("Residual vibration that each hump of the curve reaches.")

    def __post_init__(self) -> None:
        require_between("tolerance", self.tolerance, MIN_TOLERANCE, MAX_TOLERANCE)


def extra_insensitive(case: DesignCase[ToleranceOptions], *, seed: str) -> Formulation:
    """Formulate an extra-insensitive shaper by its undamped form.

    Parameters
    ----------
    case
        Mode and options.
    seed
        Name of its undamped form, as in `design.formulations.humps.UNDAMPED`.

    Returns
    -------
    Formulation
        A closed form.

    Raises
    ------
    InfeasibleDesignError
        If the mode is damped too much for the tolerance.
    """
    mode, options = case.mode, case.options
    found = follow_from_undamped(seed, mode.damping_ratio, options.tolerance)
    return ClosedForm(
        impulses=Impulses(
            times_s=found.phases_rad / mode.natural_frequency_rad_s, amplitudes=found.amplitudes
        ),
        designed_for=Ideal() if found.unity else exact_actuator(case.actuator),
        claims=_promises(found, options.tolerance),
        method="newton" if mode.damping_ratio > 0 or found.unity else "closed_form",
    )


def _promises(found: Humps, tolerance: float) -> tuple[Promise, ...]:
    """Return what the curve keeps: a hump or a zero at the nominal frequency, and all humps."""
    nominal = tolerance if 1.0 in found.peaks else ZERO_LIMITS["residual"]
    band = (float(found.zeros[0]), float(found.zeros[-1]))
    return (
        Promise(quantity="residual", limit=nominal),
        within(tolerance, band),
    )


def _kind(name: str, summary: str, source: str) -> ShaperKind:
    return KindOf(
        name=name,
        summary=summary,
        source=source,
        claims=("residual", "band"),
        options=ToleranceOptions,
        actuators=EVERY_ACTUATOR_BY_ITS_LAG,
        formulation=functools.partial(extra_insensitive, seed=name),
    )


MULTI_HUMP = (
    'W. Singhose, L. Porter, T. Tuttle, N. Singer, "Vibration reduction using multi-hump input '
    'shapers", J. Dyn. Sys., Meas., Control 119 (1997)'
)
NEGATIVE = (
    'W. Singhose, W. Seering, N. Singer, "Time-optimal negative input shapers", '
    "J. Dyn. Sys., Meas., Control 119 (1997)"
)

EI = _kind(
    "ei",
    "Three positive impulses, one hump of the tolerance at the nominal frequency, zeros beside it.",
    'W. Singhose, W. Seering, N. Singer, "Residual vibration reduction using vector diagrams to '
    'generate shaped inputs", J. Mech. Des. 116 (1994); damped: its equations, solved',
)
TWO_HUMP_EI = _kind(
    "two_hump_ei",
    "Four positive impulses, zero at the nominal frequency, a hump of the tolerance on either "
    "side.",
    f"{MULTI_HUMP}; damped: its equations, solved",
)
THREE_HUMP_EI = _kind(
    "three_hump_ei",
    "Five positive impulses, three humps of the tolerance, one at the nominal frequency.",
    f"{MULTI_HUMP}; damped: its equations, solved",
)
UM_EI = _kind(
    "um_ei",
    "Five impulses of unity magnitude, one hump of the tolerance at the nominal frequency, for an "
    "actuator that follows its command.",
    f"{NEGATIVE}; its equations, solved",
)
UM_2EI = _kind(
    "um_2ei",
    "Seven impulses of unity magnitude, zero at the nominal frequency, a hump of the tolerance on "
    "either side, for an actuator that follows its command.",
    f"{NEGATIVE}; its equations, solved",
)
