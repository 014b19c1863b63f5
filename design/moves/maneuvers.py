"""Whole moves of one mode from rest to rest: start, cruise, stop, over an exact distance."""

from collections.abc import Iterator
from dataclasses import dataclass

from design.analysis.certificate import Certificate, certify
from design.analysis.claims_found import shortfall_of
from design.analysis.drive_warnings import drive_warnings
from design.analysis.judge import judge
from design.analysis.ramp_figures import RampFigures
from design.analysis.warnings import DesignWarning
from design.checks import MAX_VALUE, MIN_VALUE, require_scale
from design.claims import ZERO_LIMITS, zeros
from design.errors import InfeasibleDesignError, InvalidInputError, SolverFailedError
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.initial_state import FreeSwing, InitialSwing, free_swing
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.moves.designed_parts import designed_parts
from design.moves.parts import Parts, with_swing
from design.moves.rest_to_rest import WholeCommand, faster_as_one, over_distance, over_pulse
from design.moves.slower import slower
from design.moves.speed import require_speed
from design.response.closed_form import travel
from design.shapers.kind import ShaperKind
from design.shapers.options import ShaperOptions
from design.solving.textbooks import figures_beside_textbook_moves

MAX_PERIODS = 500.0
"""Longest pulse: up to it the certificate's slope, by differencing, stays clear of rounding [-]."""

MUCH_STEEPER = 10.0
"""Slope of a move solved as one over that of start and stop apart from which on it is worth a
warning [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Maneuver:
    """A verified move from rest to rest.

    Attributes
    ----------
    start
        Its steps up to the speed, the first at 0; amplitudes +1, -1, ..., +1, shares of the speed
        in the direction of travel. With a ``max_velocity_ratio`` v: v, -v, 1. At a lower speed
        each is that share of full speed. One step where there is no start without vibration.
    stop
        The steps back to rest, times from the first step of the start; amplitudes -1, +1, ..., -1,
        or -1, v, -v.
    command
        Both, in order of time; the level stays within 0 and 1, or v. Solved as one, it is 0 or v.
        At a lower speed it stays within 0 and that.
    direction
        +1 in +x, -1 in -x: the command, the velocity and the swing are all mirrored.
    speed_m_s
        Full speed, > 0 [m/s].
    pulse_s
        From the first step of the start to the first step of the stop [s]. Where ``joint``, start
        and stop are the halves of the command, and this is not the pulse that was asked for.
    distance_m
        How far it goes, signed, as recomputed from the command [m].
    residual
        Residual vibration with the actuator given, a share of one unshaped step [-].
    certificate
        The claims of the shaper, recomputed for the whole move: for the actuator given if they
        hold there.
    for_ideal
        Whether they are for an ideal actuator, as they do not all hold with the one given.
    swing
        What the payload swings already at the first step; None where it hangs still.
    joint
        Whether the move was solved as one: where start and stop would overlap, where the start
        alone cannot cancel the swing, where there is no stop without vibration, or where it was
        asked for and is faster.
    ramps
        When its last ramp ends; None without limits to acceleration.
    lower_bound_s
        Solved as one behind such limits: no move ends its last ramp as early [s]; None of others.
    warnings
        What to know besides.
    """

    start: Impulses
    stop: Impulses
    command: Impulses
    direction: int
    speed_m_s: float
    pulse_s: float
    distance_m: float
    residual: float
    certificate: Certificate
    for_ideal: bool
    swing: FreeSwing | None
    joint: bool
    ramps: RampFigures | None
    lower_bound_s: float | None
    warnings: tuple[DesignWarning, ...]

    @property
    def duration_s(self) -> float:
        """Time from the first step to the last [s]."""
        return self.command.duration_s


def maneuver(
    plant: Plant,
    actuator: Actuator,
    kind: ShaperKind,
    *,
    speed_m_s: float,
    pulse_s: float | None = None,
    distance_m: float | None = None,
    initial: InitialSwing | None = None,
    joint: bool = False,
    options: ShaperOptions | None = None,
) -> Maneuver:
    """Design a move from rest to rest and prove it as a whole.

    The first step of a stop decreases the command: the stop is the start of an actuator whose sets
    are swapped. Superposed, start and stop may then be put one after the other; a switched
    actuator may not be at rest between them, and the stop is solved for the state it finds.

    Parameters
    ----------
    plant
        What moves.
    actuator
        What drives it.
    kind
        Entry of the registry: a shaper of unity magnitude.
    speed_m_s
        Full speed, > 0; with ``pulse_s`` a negative one moves in -x [m/s].
    pulse_s
        Time from the first step of the start to the first step of the stop, > 0 [s]. A pulse so
        short that they overlap stands for its travel: that which start and stop, superposed,
        would make.
    distance_m
        How far, not 0; negative moves in -x [m]. Exactly one of ``pulse_s`` and ``distance_m``.
    initial
        Swing of the payload at the first step, in +x whatever the direction; none if not given. The
        start cancels it, or the whole move where the start cannot.
    joint
        Whether start and stop are solved as one wherever that is faster, and not only where they
        overlap.
    options
        Parameters of the shaper, an instance of ``kind.options``; its defaults if not given.

    Returns
    -------
    Maneuver
        The first candidate that the certificate verifies.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule.
    InfeasibleDesignError
        If no such move was found; says how far was searched, and how large the swing is.
    SolverFailedError
        If the certificate did not verify the whole.

    Examples
    --------
    >>> from design.model.actuators.ideal import Ideal
    >>> from design.model.plants.pendulum import Pendulum
    >>> from design.shapers.registry import SHAPERS
    >>> crane = Pendulum(cable_length_m=0.8)
    >>> move = maneuver(crane, Ideal(), SHAPERS["umzvd"], speed_m_s=0.2, distance_m=-0.42)
    >>> move.direction, round(move.distance_m, 12), round(move.pulse_s, 12), move.joint
    (-1, -0.42, 2.1, False)
    """
    require_speed(actuator, speed_m_s)
    direction = direction_of(plant.mode, speed_m_s, pulse_s, distance_m)
    swing = free_swing(plant, initial, direction * abs(speed_m_s), actuator.dead_time_s)
    if swing is not None and swing.delay_s > MAX_PERIODS * plant.mode.period_s:
        raise InvalidInputError(
            "actuator.dead_time_s",
            swing.delay_s,
            f"at most {MAX_PERIODS:g} periods of the plant where it swings already",
            code="dead_time_too_long",
        )
    options = kind.options() if options is None else options
    parts = designed_parts(plant, actuator, kind, options)
    if joint and parts.peak != 1:
        raise InvalidInputError(
            "joint",
            joint,
            "left out where max_velocity_ratio is not 1",
            code="joint_beyond_unit_velocity",
        )
    if swing is not None:
        parts = with_swing(parts, swing)
    way_s = abs(distance_m or 0.0) / speed_m_s if pulse_s is None else pulse_s + parts.lead_s()
    try:
        whole = over_distance(parts, way_s) if pulse_s is None else over_pulse(parts, pulse_s)
    except InfeasibleDesignError as error:
        slow = slower(parts, way_s, plant, kind, options)
        if slow is None and parts.no_stop:
            raise InfeasibleDesignError(f"{parts.no_stop}; {error}", code=error.code) from error
        if slow is None:
            raise
        whole = slow
    warnings = tuple(_warnings(parts, whole, kind.name))
    if joint and not whole.joint and whole.share == 1:
        faster = faster_as_one(parts, whole.command)
        if faster is not None:
            warnings = tuple(_robustness_warnings(parts, whole.command, faster.command))
            whole = faster
    command = whole.command
    judged = judge(
        command,
        (parts.mode,),
        actuator,
        parts.claims,
        name=f"the move by {kind.name}",
        designed_for=parts.designed_for,
        swing=swing,
    )
    if not judged.certificate.verified:
        raise SolverFailedError(
            f"the whole move of {kind.name} was not verified: {shortfall_of(judged.certificate)}",
            code="move_not_verified",
        )
    # The start ends at level 1, so its steps are odd in number: half of them, or one more.
    split = whole.start_steps or (command.times_s.size // 2) | 1
    start, stop = (
        Impulses(times_s=command.times_s[part], amplitudes=command.amplitudes[part])
        for part in (slice(None, split), slice(split, None))
    )
    return Maneuver(
        start=start,
        stop=stop,
        command=command,
        direction=direction,
        speed_m_s=abs(speed_m_s),
        pulse_s=float(stop.times_s[0] - start.times_s[0]),
        distance_m=direction * abs(speed_m_s) * travel(command, actuator),
        residual=judged.residual,
        certificate=judged.certificate,
        for_ideal=judged.for_ideal,
        swing=swing,
        joint=whole.joint,
        ramps=figures_beside_textbook_moves(
            command,
            parts.mode,
            actuator,
            derivatives=None if judged.for_ideal or swing is not None else parts.derivatives,
        )
        if isinstance(actuator, RateLimited)
        else None,
        lower_bound_s=whole.lower_bound_s,
        warnings=(
            *judged.warnings,
            *warnings,
            *drive_warnings(command, (parts.mode,), actuator),
        ),
    )


def _warnings(parts: Parts, whole: WholeCommand, name: str) -> Iterator[DesignWarning]:
    """Yield what a move is that is not as usual."""
    if parts.starts_at_once and not whole.joint:
        yield DesignWarning(
            code="start_swings",
            detail=f"no start of {name} without vibration was found: the move starts by one step, "
            "and its payload swings until the stop cancels what is left",
        )
    if whole.share < 1:
        yield DesignWarning(
            code="lower_speed",
            detail=f"no move this short was found at full speed: it is made at "
            f"{100 * whole.share:.3g} % of that",
        )


def _robustness_warnings(parts: Parts, apart: Impulses, one: Impulses) -> Iterator[DesignWarning]:
    """Yield that a move solved as one is much more sensitive than start and stop apart."""
    slopes = [
        max(claim.value, ZERO_LIMITS["slope"])
        for command in (apart, one)
        for claim in certify(
            command, parts.mode, parts.designed_for, zeros(["slope"]), parts.swing
        ).claims
    ]
    if slopes[1] > MUCH_STEEPER * slopes[0]:
        gained = 1 - one.duration_s / apart.duration_s
        yield DesignWarning(
            code="less_robust",
            detail=f"solved as one the move is {100 * gained:.3g} % faster. With an error of 1 % "
            f"in the frequency its residual is some {slopes[1]:.3g} % of a step, "
            f"{slopes[1] / slopes[0]:.3g} times that of start and stop apart",
        )


def direction_of(
    mode: Mode, speed_m_s: float, pulse_s: float | None, distance_m: float | None
) -> int:
    """Check the numbers of a move; return its sign.

    Parameters
    ----------
    mode, speed_m_s, pulse_s, distance_m
        The mode that sets how long a move may be, and numbers as of `maneuver`.

    Raises
    ------
    InvalidInputError
        If a number breaks its rule.

    Returns
    -------
    int
        +1 in +x, -1 in -x.
    """
    if (pulse_s is None) == (distance_m is None):
        given = "neither" if pulse_s is None else "both"
        raise InvalidInputError(
            "pulse_s", given, "given, or distance_m in its place", code="pulse_or_distance"
        )
    if pulse_s is not None:
        require_scale("pulse_s", pulse_s)
        if not MIN_VALUE <= abs(speed_m_s) <= MAX_VALUE:
            raise InvalidInputError(
                "speed_m_s",
                speed_m_s,
                f"{MIN_VALUE:g} to {MAX_VALUE:g}, or minus",
                code="speed_out_of_range",
            )
        _require_provable("pulse_s", pulse_s, pulse_s, mode)
        return 1 if speed_m_s > 0 else -1
    require_scale("speed_m_s", speed_m_s)
    distance = 0.0 if distance_m is None else distance_m
    if not MIN_VALUE <= abs(distance) <= MAX_VALUE:
        raise InvalidInputError(
            "distance_m",
            distance_m,
            f"between {MIN_VALUE:g} and {MAX_VALUE:g} either way, not 0",
            code="out_of_range",
        )
    _require_provable("distance_m", distance, abs(distance) / speed_m_s, mode)
    return 1 if distance > 0 else -1


def _require_provable(name: str, value: float, travel_s: float, mode: Mode) -> None:
    if travel_s > MAX_PERIODS * mode.period_s:
        raise InvalidInputError(
            name,
            value,
            f"no longer at this speed than {MAX_PERIODS:g} periods of the plant",
            code="move_too_long",
        )
