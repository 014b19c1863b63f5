"""What the comment of a program says of its move: of what it is, and what is left of it."""

import textwrap
from collections.abc import Iterator

import numpy as np

from design.analysis.residual import residual_vibration
from design.model.actuators.in_words import drive_line
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.moves.cycles import PlayedInCycles, played_in_cycles
from design.moves.later_stops import RIGHT, LaterStops
from design.moves.maneuvers import Maneuver
from design.moves.programs import Program
from design.tables.rows import Real

CYCLES_S = (0.001, 0.01)
"""Cycles of which a comment has figures: of motion tasks and of common ones [s]."""

LINE = 96
"""Letters of a line."""


def move_remarks(
    move: Maneuver,
    plant: Plant,
    actuator: Actuator,
    kind: str,
    program: Program | None,
) -> Iterator[str]:
    """Yield what a move is and what is proven of it.

    Parameters
    ----------
    move, plant, actuator
        The move, what moves, and what drives it.
    kind
        Name of the kind of shaper.
    program
        The move on samples; None of one between samples.

    Yields
    ------
    str
        Lines without marks of a comment.
    """
    mode = plant.mode
    cable = f"cable {plant.cable_length_m:g} m, " if isinstance(plant, Pendulum) else ""
    yield (
        f"plant: {cable}{1 / mode.period_s:.5g} Hz, period {mode.period_s:.5g} s, damping ratio "
        f"{mode.damping_ratio:g}"
    )
    yield from _lines(f"drive: {drive_line(actuator)}")
    steps = f"{move.start.times_s.size} steps up, {move.stop.times_s.size} steps down"
    yield (
        f"move: {move.distance_m:.9g} m at {move.speed_m_s:g} m/s in {move.duration_s:.9g} s by "
        f"{kind}, {'solved as one' if move.joint else steps}"
    )
    if move.ramps is not None:
        yield f"last ramp over: {move.ramps.end_s:.9g} s after the first step"
    yield from _lines(_certificate_in_words(move))
    yield from _lines(f"method of the certificate: {move.certificate.method}")
    yield f"residual with the drive given: {move.residual:.3g} of one unshaped step"
    if program is not None:
        yield from _lines(
            f"on samples of {program.times_s[1]:.9g} s: residual {program.residual:.3g}, "
            f"{program.distance_m:.9g} m. It is what was verified only in a task of that cycle"
        )
    else:
        yield from _lines(
            "a step between two cycles is shared by both. Where the residual below is too large, "
            "sample_time_s in the request designs the move on the cycles of one task"
        )
    if move.swing is not None:
        yield from _lines(
            "it begins with the swing of the request, which it cancels: from rest it swings"
        )


def remarks_on_parts(
    move: Maneuver,
    mode: Mode,
    actuator: Actuator,
    stops: LaterStops | None,
    program: Program | None,
) -> Iterator[str]:
    """Yield when start and stop may be called, or why they are no blocks.

    Parameters
    ----------
    move, mode, actuator
        The move, the plant's mode, and its drive.
    stops
        What start and stop leave with other cruises; None where they are not apart.
    program
        The move on samples; None of one between samples.

    Yields
    ------
    str
        Lines without marks of a comment.
    """
    why = "start and stop are no blocks: "
    if program is not None:
        yield from _lines(f"{why}the samples are those of the whole move")
    elif move.joint:
        yield from _lines(f"{why}the move was solved as one, and its halves leave a swing")
    elif stops is None:
        yield from _lines(f"{why}the start is one step, and the stop cancels its swing")
    elif stops.residual > RIGHT and not move.for_ideal:
        yield from _lines(
            f"{why}the stop is for a drive that has not settled, after a longer cruise the "
            f"residual is {stops.residual:.2g}. A longer move has both"
        )
    else:
        start = residual_vibration(move.start, mode, actuator, move.swing)
        yield from _lines(
            "start and stop are blocks too, for a cruise of any length. The residual of the start "
            f"is {start:.2g}, that of both at most {stops.residual:.2g} where the stop begins as "
            "soon as the start is done, or later"
        )
        if stops.wait_s:
            yield from _lines(
                f"done of the start waits {stops.wait_s:.3g} s for the drive to settle: with a "
                f"stop before that the residual is up to {stops.sooner:.2g}"
            )


def warnings_in_words(move: Maneuver, program: Program | None) -> Iterator[str]:
    """Yield the warnings of a move and its program in lines of a comment.

    Parameters
    ----------
    move, program
        The move, and it on samples; None of one between samples.

    Yields
    ------
    str
        Lines, those of its program first.
    """
    for warning in (*(() if program is None else program.warnings), *move.warnings):
        yield from _lines(f"warning {warning.code}: {warning.detail}")


def figures_in_words(
    move: Maneuver, mode: Mode, actuator: Actuator, of: Real, program: Program | None
) -> Iterator[str]:
    """Yield what is left of a move as a program plays it.

    Parameters
    ----------
    move, mode, actuator
        The move, the plant's mode, and its drive.
    of
        Type of the numbers of the program, to which its times are rounded.
    program
        The move on samples; None of one between samples.

    Yields
    ------
    str
        Lines without marks of a comment.
    """
    if program is not None:
        played = played_program(move, program)
        told = played_in_cycles(played, mode, actuator, float(program.times_s[1]), move.swing)
        if told is not None:
            yield from _lines(f"in {of}: {_jitter_in_words(told)}")
        return
    whole = _rounded(move.command, of)
    for cycle_s in CYCLES_S:
        told = played_in_cycles(whole, mode, actuator, cycle_s, move.swing)
        if told is not None:
            missed = f", {100 * told.missed:+.1g} % of the distance" if told.missed else ""
            yield from _lines(
                f"in {of}, cycles of {1000 * cycle_s:g} ms: residual {told.residual:.2g}{missed}; "
                f"{_jitter_in_words(told)}"
            )


def played_program(move: Maneuver, program: Program) -> Impulses:
    """Return a move on samples as steps, shares of the speed in its direction.

    Parameters
    ----------
    move, program
        The move, and it on samples.

    Returns
    -------
    Impulses
        A step for each sample on which the velocity changes.
    """
    changes = np.diff(program.velocity_m_s / (move.direction * move.speed_m_s), prepend=0.0)
    held = np.flatnonzero(changes)
    return Impulses(times_s=program.times_s[held], amplitudes=changes[held])


def _rounded(command: Impulses, of: Real) -> Impulses:
    """Return a command as numbers of a type have it."""
    if of == "LREAL":
        return command
    return Impulses(
        times_s=command.times_s.astype(np.float32).astype(np.float64),
        amplitudes=command.amplitudes,
    )


def _jitter_in_words(told: PlayedInCycles) -> str:
    return f"calls up to {1000 * told.jitter_s:g} ms early or late: at most {told.with_jitter:.2g}"


def _certificate_in_words(move: Maneuver) -> str:
    claims = ", ".join(
        f"{claim.quantity} {claim.value:.2g} <= {claim.limit:.2g}"
        for claim in move.certificate.claims
    )
    of = "an ideal drive only, not for the drive given" if move.for_ideal else "the drive given"
    return f"certificate: verified for {of}: {claims}"


def _lines(text: str) -> list[str]:
    """Return a remark in lines, indented from the second on."""
    return textwrap.wrap(text, LINE, subsequent_indent="   ", break_long_words=False)
