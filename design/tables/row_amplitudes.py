"""Which amplitudes the rows of a table have, and how many."""

import math
from dataclasses import replace

from design.errors import InvalidInputError
from design.formulations.bands import BandProblem, BandSearch
from design.formulations.formulation import ClosedForm, Convolution, JointProblem
from design.formulations.large_swing import LargeSwingProblem
from design.formulations.ramped import RampedProblem
from design.formulations.ramped_band import RampedBandProblem
from design.formulations.ramped_humps import RampedHumpsProblem
from design.formulations.steps_for_modes import StepsProblem
from design.formulations.unequal_band import UnequalBandProblem
from design.formulations.unequal_humps import UnequalHumpsProblem
from design.formulations.unequal_ramps import UnequalRampsProblem
from design.formulations.unity_magnitude_problem import alternating
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant, SeveralModes
from design.shapers.kind import ShaperKind
from design.shapers.num_large import LargeSwingOptions
from design.shapers.options import ShaperOptions
from design.shapers.several_modes import BASES, ConvolvedOptions

SOME_DAMPING = 0.01
"""A damping ratio at which every kind of shaper exists [-]."""


def amplitudes_of(
    kind: ShaperKind, options: ShaperOptions | None, damping_ratio: float = 0.0
) -> tuple[float, ...]:
    """Return a kind's amplitudes behind a symmetric actuator [-].

    Those of unity magnitude do not depend on plant and actuator, and all rows of a table share
    them; others do, and stand in columns of their own.

    Parameters
    ----------
    kind
        Kind of the shaper.
    options
        Its parameters.
    damping_ratio
        Of the mode [-].

    Returns
    -------
    tuple of float
        In order of time; of unity magnitude, or as they are for this damping ratio [-].

    Raises
    ------
    InvalidInputError
        If the kind's number of impulses changes with plant or band, or an option breaks its rule.
    """
    options = kind.options() if options is None else options
    if isinstance(options, LargeSwingOptions):
        return tuple(alternating(options.steps).tolist())
    actuator: Actuator = Ideal()
    if actuator.kind not in kind.actuators:
        actuator = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.1)
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=damping_ratio)
    formulation = kind.formulate(kind.case((mode,), actuator, options))
    if isinstance(
        formulation,
        JointProblem
        | Convolution
        | LargeSwingProblem
        | RampedProblem
        | RampedHumpsProblem
        | UnequalRampsProblem
        | UnequalHumpsProblem,
    ):
        raise InvalidInputError(
            "design.shaper.kind",
            kind.name,
            "one with the same number of impulses in every row: those for several modes change "
            "with the plant",
            code="impulses_vary_with_plant",
        )
    if isinstance(formulation, BandProblem | BandSearch | RampedBandProblem | UnequalBandProblem):
        raise InvalidInputError(
            "design.shaper.kind",
            kind.name,
            "one with the same number of impulses in every row: those of a band change with "
            "plant and band",
            code="impulses_vary_with_band",
        )
    if isinstance(formulation, ClosedForm):
        return tuple(formulation.impulses.amplitudes.tolist())
    steps = formulation.gaps if isinstance(formulation, StepsProblem) else formulation
    return tuple(steps.amplitudes.tolist())


def impulses_of(plant: Plant, kind: ShaperKind, options: ShaperOptions | None) -> int:
    """Return how many impulses each design of a table has.

    Parameters
    ----------
    plant
        What moves.
    kind
        Kind of the shaper.
    options
        Its parameters; None for the kind's own.

    Returns
    -------
    int
        Number of impulses.

    Raises
    ------
    InvalidInputError
        If that changes with the plant.
    """
    options = kind.options() if options is None else options
    if kind.large_swings:  # refuses a plant, or parameters, of no row
        kind.formulate(replace(kind.case(plant.modes, Ideal(), options), plant=plant))
    if isinstance(options, ConvolvedOptions):
        base = BASES[options.base]
        of_one = len(amplitudes_of(base, base.options()))
        return math.prod(of_one for _ in plant.modes)
    if isinstance(plant, SeveralModes):
        formulation = kind.formulate(kind.case(plant.modes, Ideal(), options))
        if isinstance(formulation, StepsProblem):
            return int(formulation.gaps.amplitudes.size)
        raise InvalidInputError(
            "design.shaper.kind",
            kind.name,
            "one with the same number of impulses in every row: of those for several modes, "
            "num_multi and convolved",
            code="joint_kind_in_table",
        )
    return len(amplitudes_of(kind, options))


def undamped_amplitudes(kind: ShaperKind, options: ShaperOptions | None) -> tuple[float, ...]:
    """Return `amplitudes_of` an undamped mode, or none.

    Parameters
    ----------
    kind
        Kind of the shaper.
    options
        Its parameters.

    Returns
    -------
    tuple of float
        Empty where not even their number is known [-].
    """
    try:
        return amplitudes_of(kind, options)
    except InvalidInputError:
        return ()


def shared_amplitudes(kind: ShaperKind, options: ShaperOptions | None) -> tuple[float, ...]:
    """Return the amplitudes that all rows of a table share, or none.

    Parameters
    ----------
    kind
        Kind of the shaper.
    options
        Its parameters.

    Returns
    -------
    tuple of float
        Empty where each row has its own [-].
    """
    try:
        undamped, damped = (amplitudes_of(kind, options, ratio) for ratio in (0.0, SOME_DAMPING))
    except InvalidInputError:  # not even their number is the same
        return ()
    return undamped if undamped == damped else ()
