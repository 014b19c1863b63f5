"""A run of the crane from events: what is commanded, how it moves, what remains."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from design.analysis.warnings import DesignWarning
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.commands import convolve
from design.model.impulses import Impulses
from design.model.reference_ramps import reference
from design.rig.crane import AXES, AxisName, Crane, LimitSwitch, SlackCable
from design.rig.machine import Machine
from design.rig.scenario import Drive, HoistTo, Played, command_of, raise_beside_events
from design.rig.track import Track
from design.rig.whole_moves import WholeMove, with_moves
from design.types import FloatArray

SETTLED = 40.0
"""Time constants of a lag after which e^-40 of its transient is left [-]."""

MAX_DECAY = 12.0
"""Decay over which a swing is followed back: an error of 1e-12 becomes one of 2e-7 [-]."""

FULL_SPEED = 1.0 + 1e-9
"""Level above which a command is beyond full speed, rounding aside [-]."""

AFTERMATH_PERIODS = 3.0
"""How long a run goes on after the last switch if no end is given [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scenario:
    """What is done with the crane.

    Attributes
    ----------
    crane, drive, speed_m_s
        The machine; one drive as that of x and of y, and full speed [m/s].
    drives, moves, hoists
        What events command, in any order; moves are not shaped, as they are designed as a whole.
    played
        Courses in place of events.
    shaper
        What each command is convolved with; None if nothing shapes it.
    solved
        Commands in place of those of the events, shaped already; None if there are none.
    """

    crane: Crane
    drive: Actuator
    speed_m_s: float
    drives: Sequence[Drive] = ()
    moves: Sequence[WholeMove] = ()
    hoists: Sequence[HoistTo] = ()
    played: dict[AxisName, Played] | None = None
    shaper: Impulses | None = None
    solved: dict[AxisName, Impulses] | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Run:
    """A run, seen at n times.

    Attributes
    ----------
    commands
        Of each axis that is driven.
    track
        The motion.
    command_m_s
        What is commanded at these times, shape (n, 2) [m/s].
    last_switch_s
        When the last command changes, or the last hoist ends [s].
    residual
        Amplitude of what swings after the last switch, ramp and hoist over that of an unshaped step
        at full speed and the cable length at the end: the root of their energies; None where it has
        died away before the drive has settled [-].
    switches
        Limit switches that were met.
    warnings
        What to know of it.
    """

    commands: dict[AxisName, Impulses]
    track: Track
    command_m_s: FloatArray
    last_switch_s: float
    residual: float | None
    switches: tuple[LimitSwitch, ...]
    warnings: tuple[DesignWarning, ...]


def run(scenario: Scenario, until_s: float | None, points: int) -> Run:
    """Run a scenario.

    Parameters
    ----------
    scenario
        What is done.
    until_s
        Last time that is seen; three periods after the last switch if None [s].
    points
        How many times are seen, evenly spaced from 0 on.

    Returns
    -------
    Run
        What happened.

    Raises
    ------
    InvalidInputError
        If buttons contradict each other, whole moves overlap, or the machine cannot do it: see
        `Machine`.
    """
    crane, drive = scenario.crane, scenario.drive

    def shape(command: Impulses) -> Impulses:
        return command if scenario.shaper is None else convolve(command, scenario.shaper)

    commands = dict(scenario.solved or {})
    for axis in AXES if scenario.solved is None else ():
        course = (scenario.played or {}).get(axis)
        if course is not None and any(move.axis == axis for move in scenario.moves):
            raise_beside_events(axis)
        found = command_of(scenario.drives, course, axis, scenario.speed_m_s, shape)
        found = with_moves(found, scenario.moves, axis, drive)
        if found is not None:
            commands[axis] = found
    machine = Machine(crane, (drive, drive), scenario.speed_m_s)
    beyond = 0.0
    for axis, command in commands.items():
        levels = _levels(command)
        beyond = max(beyond, float(np.abs(levels).max()))
        for time_s, level in zip(command.times_s.tolist(), levels.tolist(), strict=True):
            machine.command(axis, level, time_s)
    for hoist in scenario.hoists:
        machine.hoist(hoist.cable_length_m, hoist.over_s, hoist.at_s)
    ends = [hoist.at_s + hoist.over_s for hoist in scenario.hoists]
    last = max([0.0, *ends, *(float(command.times_s[-1]) for command in commands.values())])
    period = math.tau / crane.slowest_rad_s
    end = last + drive.dead_time_s + AFTERMATH_PERIODS * period if until_s is None else until_s
    times = np.linspace(0.0, end, points)
    track = machine.advance(end, times)
    switches, slack = tuple(machine.switches), machine.slack
    steady = max([0.0, *ends, *(_steady_s(command, drive) for command in commands.values())])
    return Run(
        commands=commands,
        track=track,
        command_m_s=scenario.speed_m_s * _seen_levels(commands, times),
        last_switch_s=last,
        residual=_residual(machine, drive, steady),
        switches=switches,
        warnings=_warnings(beyond, switches, slack),
    )


def _levels(command: Impulses) -> FloatArray:
    """Return the levels of a command, without the rounding of their sum."""
    levels = np.cumsum(command.amplitudes)
    levels[np.abs(levels) <= 1e-12 * np.abs(command.amplitudes).sum()] = 0.0
    return levels


def _seen_levels(commands: dict[AxisName, Impulses], times_s: FloatArray) -> FloatArray:
    seen = np.zeros((times_s.size, len(AXES)))
    for axis, command in commands.items():
        levels = np.concatenate(([0.0], _levels(command)))
        seen[:, AXES.index(axis)] = levels[np.searchsorted(command.times_s, times_s, side="right")]
    return seen


def _steady_s(command: Impulses, drive: Actuator) -> float:
    """Return when the reference of a drive is steady [s]."""
    changes = reference(command, drive)
    return float((changes.times_s + changes.ramps_s).max()) + drive.dead_time_s


def settling_s(drive: Actuator) -> float:
    """Return after how long e^-40 of a lag's transient is left [s]."""
    lags = (drive.accel_lag, drive.decel_lag)
    return SETTLED * max(lag.first_s + math.sqrt(lag.second_s2) for lag in lags)


def unshaped_energy_j(crane: Crane, drive: Actuator, speed_m_s: float) -> float:
    """Return the energy of the swing after an unshaped step.

    Parameters
    ----------
    crane, drive
        The machine; of a drive with limits what it does without them.
    speed_m_s
        Full speed, to which the step goes [m/s].

    Returns
    -------
    float
        Once the drive has settled [J].
    """
    plain = drive.then if isinstance(drive, RateLimited) else drive
    step = Machine(replace(crane, strokes=(None, None)), (plain, plain), speed_m_s)
    step.open_bounds()
    step.command("x", 1.0)
    return float(step.advance(settling_s(drive) + plain.dead_time_s).swing_energy_j[0])


def _residual(machine: Machine, drive: Actuator, steady_s: float) -> float | None:
    """Return the amplitude that remains after a time, as a share of an unshaped step's [-]."""
    machine.open_bounds()
    settled = settling_s(drive)
    remains = machine.advance(max(machine.now_s, steady_s + settled))
    length = float(remains.cable_length_m[0])
    decay = float(machine.crane.decays_s(np.array([length]))[0])
    since = float(remains.times_s[0]) - steady_s
    if decay * max(settled, since) > MAX_DECAY:
        return None
    crane = replace(machine.crane, cable_length_m=length)
    unshaped = math.sqrt(unshaped_energy_j(crane, drive, machine.speed_m_s))
    left = math.sqrt(max(float(remains.swing_energy_j[0]), 0.0))
    return left / unshaped * math.exp(decay * (since - settled))


def _warnings(
    beyond: float, switches: tuple[LimitSwitch, ...], slack: tuple[SlackCable, ...]
) -> tuple[DesignWarning, ...]:
    told = []
    if beyond > FULL_SPEED:
        told.append(
            DesignWarning(
                code="command_over_full_speed",
                detail=f"the shaped command reaches {beyond:.4g} times full speed: presses "
                "shorter than the shaper overlap in its delay line",
            )
        )
    for switch in switches:
        told.append(
            DesignWarning(
                code="limit_switch",
                detail=f"{switch.axis} met its limit switch at {switch.position_m:.6g} m, "
                f"{switch.at_s:.6g} s: its drive was commanded to stop",
            )
        )
    for one in slack:
        name = "cable" if one.cable == "upper" else "cable below the hook"
        told.append(
            DesignWarning(
                code="slack_cable",
                detail=f"the {name} would have to push from {one.at_s:.6g} s on, by up to "
                f"{one.push_n:.3g} N and for {one.duration_s:.3g} s in all: a real one is slack "
                "then, and the run keeps it taut",
            )
        )
    return tuple(told)
