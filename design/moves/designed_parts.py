"""Start and stop of a move, each designed apart; where one of them does not exist, one step."""

from dataclasses import replace

import numpy as np

from design.claims import zeros
from design.errors import InfeasibleDesignError, InvalidInputError, SolverFailedError
from design.formulations.equations import GapProblem
from design.formulations.gaps import PERIOD_RAD
from design.model.actuators.registry import Actuator
from design.model.actuators.swapped import swap_directions
from design.model.impulses import Impulses
from design.model.plants.registry import Plant
from design.moves.parts import Parts, mirrored_stop
from design.pipeline import design
from design.shapers.kind import ShaperKind
from design.shapers.options import ShaperOptions
from design.shapers.peak_options import PeakOptions
from design.shapers.refusals import require_small_swings
from design.shapers.settle_options import SettleOptions
from design.solvers.budget import Budget
from design.solving.solve import solve

ONE_STEP = Impulses(times_s=np.zeros(1), amplitudes=np.ones(1))
"""Stands for a start where there is none without vibration."""


def designed_parts(
    plant: Plant,
    actuator: Actuator,
    kind: ShaperKind,
    options: ShaperOptions,
    budget: Budget | None = None,
) -> Parts:
    """Return a start and a stop, one of which may be a single step.

    A damped payload forgets early steps. Where those of one set are too weak to cancel the last
    step of a start, those of a stop may still do, or the other way round.

    Parameters
    ----------
    plant, actuator
        What moves, and what drives it.
    kind, options
        A shaper of unity magnitude, and its parameters.
    budget
        What both searches may do; each that of one design if not given.

    Returns
    -------
    Parts
        Without a start, the stop cancels the vibration of one step; without a stop, the move must
        be solved as one.

    Raises
    ------
    InvalidInputError
        If the kind does not serve the actuator, or is not one of unity magnitude.
    InfeasibleDesignError
        If neither start nor stop was found.
    SolverFailedError
        If none of those found was verified.
    """
    require_small_swings(kind, "moves")
    no_start: InfeasibleDesignError | None = None
    of_start = Budget() if budget is None else budget
    try:
        start = design(plant, actuator, kind, options, of_start).impulses
    except InfeasibleDesignError as error:
        no_start, start, budget = error, ONE_STEP, of_start
    formulation = kind.formulate(kind.case(plant.modes, actuator, options))
    peak = options.max_velocity_ratio if isinstance(options, PeakOptions) else 1.0
    if not set(np.cumsum(start.amplitudes[:-1]).tolist()) <= {0.0, peak} or formulation.claims:
        raise InvalidInputError(
            "shaper.kind",
            kind.name,
            "one of unity magnitude without residual, as umzv, numzv or numzvd: moves are "
            "solved on levels 0 and 1",
            code="move_not_served",
        )
    if no_start is not None and (peak != 1 or not isinstance(formulation, GapProblem)):
        raise no_start
    settling = options if isinstance(options, SettleOptions) else SettleOptions()
    parts = Parts(
        mode=plant.mode,
        actuator=actuator,
        designed_for=formulation.designed_for,
        claims=formulation.claims or zeros(kind.claims),
        settle=settling.settle,
        horizon_rad=2 * settling.max_duration_periods * PERIOD_RAD,
        start=start,
        stop=mirrored_stop(start),
        peak=peak,
    )
    try:
        return _with_stop(parts, plant, kind, options, budget)
    except InfeasibleDesignError as error:
        if no_start is not None:
            raise no_start from error
        return replace(parts, apart=False, no_stop=f"the start exists, the stop does not: {error}")


def _with_stop(
    parts: Parts, plant: Plant, kind: ShaperKind, options: ShaperOptions, budget: Budget | None
) -> Parts:
    """Return the parts with a stop without residual, begun at rest at full speed."""
    turned = swap_directions(parts.actuator)
    if parts.peak == 1:
        found = design(plant, turned, kind, options, budget)
        return replace(parts, stop=_negative(found.impulses))
    stop = replace(kind.case((parts.mode,), turned, options), is_stop=True)
    for one in solve(kind.formulate(stop), budget):
        # By itself it is no start: above twice the speed its second step would increase |command|.
        tried = replace(parts, stop=_negative(one.impulses))
        if tried.verified(tried.whole(tried.rest_pulse_s)):
            return tried
    raise SolverFailedError(f"the stop of {kind.name} was not verified", code="stop_not_verified")


def _negative(impulses: Impulses) -> Impulses:
    return Impulses(times_s=impulses.times_s, amplitudes=-impulses.amplitudes)
