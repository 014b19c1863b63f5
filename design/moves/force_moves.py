"""Moves of a free body by an on-off force, from rest to rest."""

import math
from dataclasses import dataclass

import numpy as np

from design.analysis.certificate import Certificate, certify_modes
from design.analysis.claims_found import shortfall_of
from design.analysis.force_bound import least_burn_s, least_duration_s
from design.analysis.residual import residual_vibration
from design.checks import MAX_VALUE, MIN_VALUE, require_scale
from design.claims import ZERO_LIMITS, Promise
from design.errors import InfeasibleDesignError, InvalidInputError, SolverFailedError
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.free_body import FreeBody
from design.shapers.kind import ShaperKind
from design.shapers.options import ShaperOptions
from design.solvers.force_pulses import ForceSteps, ForceTask, least_force, least_time

MAX_PERIODS = 60.0
"""Longest move of a rigid body of the mass, in periods of the fastest mode: up to it the search
found the switches of every random body [-]."""

MAX_DURATION_SHARE = 20.0
"""Longest move over the fastest one [-]."""

AT_REST = 1e-12
"""What of the speed and of the way counts as rounding, over their largest [-]."""

DERIVATIVES = {("residual",): 0, ("residual", "slope"): 1}
"""Claims of the kinds that are served, and how many derivatives vanish."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ForceMove:
    """A verified move of a free body.

    Attributes
    ----------
    command
        Steps of the force over its largest, in the direction of the way, the last at the end.
    direction
        +1 in +x, -1 in -x.
    force_n
        The largest force, > 0 [N].
    distance_m
        How far it goes, signed, as recomputed from the steps [m].
    residual
        Largest residual vibration of any mode, over what one step of the force excites [-].
    certificate
        The claims of the kind for every mode, recomputed.
    burn_s
        How long the force is on [s].
    lower_bound_s
        No move is as short, proven [s].
    least_burn_s
        No move of the duration that was given has the force on so shortly, proven; None of those in
        minimum time [s].
    """

    command: Impulses
    direction: int
    force_n: float
    distance_m: float
    residual: float
    certificate: Certificate
    burn_s: float
    lower_bound_s: float
    least_burn_s: float | None

    @property
    def duration_s(self) -> float:
        """Time from the first step to the last [s]."""
        return self.command.duration_s


def force_move(
    plant: FreeBody,
    actuator: Actuator,
    kind: ShaperKind,
    *,
    force_n: float,
    distance_m: float,
    duration_s: float | None = None,
    options: ShaperOptions | None = None,
) -> ForceMove:
    """Design a move of a free body by an on-off force, and prove it.

    Parameters
    ----------
    plant
        The body and its modes.
    actuator
        An ideal one: the force follows its command at once.
    kind
        Entry of the registry: what it claims is kept in every mode, no residual (``umzv``) or no
        residual and no slope (``umzvd``).
    force_n
        Largest force, > 0 [N]; for a turn the torque.
    distance_m
        How far, not 0; negative moves in -x [m]. For a turn the angle.
    duration_s
        Time of the move, in which the force is on as shortly as may be; minimum time if not given
        [s].
    options
        Parameters of the kind, which has none here but its defaults.

    Returns
    -------
    ForceMove
        With a proven bound.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule, or the kind or the drive is not served here.
    InfeasibleDesignError
        If the duration is below the least.
    SolverFailedError
        If no force was found, or it was not verified.

    Examples
    --------
    Two masses of 1 kg and a spring of 1 N/m, moved by 1 m [1]_:

    >>> from design.model.plants.mode import Mode
    >>> from design.shapers.registry import SHAPERS
    >>> body = FreeBody(mass_kg=2.0, vibration=Mode(natural_frequency_rad_s=2**0.5))
    >>> move = force_move(body, Ideal(), SHAPERS["umzv"], force_n=1.0, distance_m=1.0)
    >>> move.command.times_s.round(3).tolist(), move.command.amplitudes.tolist()
    ([0.0, 1.003, 2.109, 3.215, 4.218], [1.0, -2.0, 2.0, -2.0, 1.0])

    References
    ----------
    .. [1] Q. Liu, B. Wie, "Robust time-optimal control of uncertain flexible spacecraft",
       J. Guidance, Control, and Dynamics 15 (1992).
    """
    derivatives = _derivatives(actuator, kind, options)
    require_scale("force_n", force_n)
    if not MIN_VALUE <= abs(distance_m) <= MAX_VALUE:
        raise InvalidInputError(
            "distance_m",
            distance_m,
            f"between {MIN_VALUE:g} and {MAX_VALUE:g} either way, not 0",
            code="out_of_range",
        )
    modes = plant.excited
    way_s2 = abs(distance_m) * plant.mass_kg / force_n
    fastest_s = min(mode.period_s for mode in modes)
    rigid_s = 2 * math.sqrt(way_s2)
    if not rigid_s <= MAX_PERIODS * fastest_s:
        raise InvalidInputError(
            "distance_m",
            distance_m,
            f"no longer by this force than {MAX_PERIODS:g} periods of the fastest mode",
            code="force_move_too_long",
        )
    task = ForceTask(modes=modes, way_s2=way_s2, derivatives=derivatives)
    steps = _found(least_time(task))
    bound_s = least_duration_s(modes, steps.weights, way_s2)
    burn_bound_s = None
    if duration_s is not None:
        steps = _in_time(task, steps, duration_s)
        burn_bound_s = least_burn_s(modes, steps.weights, way_s2, duration_s)
    command = Impulses(times_s=steps.times_s, amplitudes=steps.amplitudes)
    promises = tuple(
        Promise(quantity=quantity, limit=ZERO_LIMITS[quantity], mode=number)
        for number, _ in enumerate(modes)
        for quantity in kind.claims
    )
    certificate = certify_modes(command, modes, Ideal(), promises)
    moved_s2 = _way_s2(command)
    if not certificate.verified or abs(moved_s2 - way_s2) > 1e3 * AT_REST * way_s2:
        raise SolverFailedError(
            f"the move by force of {kind.name} was not verified: its way is off by "
            f"{abs(moved_s2 / way_s2 - 1):.1g}, {shortfall_of(certificate)}",
            code="force_move_not_verified",
        )
    direction = 1 if distance_m > 0 else -1
    levels = np.cumsum(command.amplitudes)[:-1]
    return ForceMove(
        command=command,
        direction=direction,
        force_n=force_n,
        distance_m=direction * force_n / plant.mass_kg * moved_s2,
        residual=max(residual_vibration(command, mode, Ideal()) for mode in modes),
        certificate=certificate,
        burn_s=float(np.abs(levels) @ np.diff(command.times_s)),
        lower_bound_s=bound_s,
        least_burn_s=burn_bound_s,
    )


def _derivatives(actuator: Actuator, kind: ShaperKind, options: ShaperOptions | None) -> int:
    """Check kind and drive; return how many derivatives vanish."""
    if not isinstance(actuator, Ideal):
        raise InvalidInputError(
            "actuator.kind", actuator.kind, "ideal for a free body", code="force_through_drive"
        )
    derivatives = DERIVATIVES.get(kind.claims)
    if derivatives is None or (options is not None and options != kind.options()):
        raise InvalidInputError(
            "shaper.kind",
            kind.name,
            "umzv (no residual) or umzvd (no slope too), without parameters, for a free body",
            code="kind_not_by_force",
        )
    return derivatives


def _found(steps: ForceSteps | None) -> ForceSteps:
    if steps is None:
        raise SolverFailedError(
            "the search for the switches of the force ended before they were found",
            code="force_switches_not_found",
        )
    return steps


def _in_time(task: ForceTask, fastest: ForceSteps, duration_s: float) -> ForceSteps:
    """Return the steps of a duration."""
    least_s = float(fastest.times_s[-1])
    if duration_s < least_s:
        raise InfeasibleDesignError(
            f"no force of this size makes the way in {duration_s:.6g} s; the least time is "
            f"{least_s:.9g} s",
            code="duration_below_force_time",
            faults=(("duration_s", f"{least_s:.9g} s or more"),),
        )
    if duration_s > MAX_DURATION_SHARE * least_s:
        raise InvalidInputError(
            "duration_s",
            duration_s,
            f"at most {MAX_DURATION_SHARE:g} times the least, {least_s:.6g} s",
            code="out_of_range",
        )
    return _found(least_force(task, duration_s))


def _way_s2(command: Impulses) -> float:
    """Return the way over force and mass; the body must be at rest at the end [s^2]."""
    left_s = command.times_s[-1] - command.times_s
    duration_s = command.duration_s
    speed_s = float(command.amplitudes @ left_s)
    if abs(speed_s) > 1e3 * AT_REST * duration_s:
        raise SolverFailedError(
            f"the body moves on: its speed is {speed_s / duration_s:.1g} of the largest",
            code="force_leaves_speed",
        )
    return float(command.amplitudes @ left_s**2) / 2
