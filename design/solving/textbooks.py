"""Shapers of an ideal drive behind limits to acceleration, to compare the fastest with.

They are what a textbook offers who knows the limits: the ramp itself shaped, or each step of the
shaper waiting for the ramp of the one before.
"""

from dataclasses import replace
from functools import reduce

import numpy as np

from design.analysis.certificate import Claim
from design.analysis.ramp_figures import RampFigures, Textbook, end_of_reference, ramp_figures
from design.analysis.residual import residual_vibration
from design.checks import MIN_VALUE
from design.claims import ZERO_LIMITS
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited, follows_one_lag
from design.model.commands import convolve, pulse, step
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.response.closed_form import travel
from design.shapers.registry import SHAPERS
from design.solving.solve import solve

SHORTEST = 1e-6
"""Shortest pulse that is tried, over the longest [-]."""

POSITIVE, UNITY = ("zv", "zvd"), ("umzv", "umzvd")
"""Kinds for no residual, and for no slope either."""


def figures_beside_textbooks(
    impulses: Impulses, modes: tuple[Mode, ...], actuator: RateLimited, claims: tuple[Claim, ...]
) -> RampFigures:
    """Return the figures of a shaper, beside those of textbooks.

    These claim the same behind the same limits.

    Parameters
    ----------
    impulses, modes, actuator
        The shaper, the plant's modes, and the limits.
    claims
        What is certified of it for this drive; nothing else is compared.

    Returns
    -------
    RampFigures
        Without textbooks where it does not claim zeros of residual, or of residual and slope.
    """
    figures = ramp_figures(impulses, modes, actuator)
    quantities = {claim.quantity for claim in claims}
    zero = all(claim.limit <= ZERO_LIMITS.get(claim.quantity, 0.0) for claim in claims)
    if not (zero and "residual" in quantities <= {"residual", "slope"}):
        return figures
    derivatives = len(quantities) - 1
    return replace(
        figures,
        textbooks=textbook_shapers(modes, actuator, derivatives=derivatives, end_s=figures.end_s),
    )


def figures_beside_textbook_moves(
    command: Impulses, mode: Mode, actuator: RateLimited, *, derivatives: int | None
) -> RampFigures:
    """Return the figures of a whole move, beside those of textbooks.

    Parameters
    ----------
    command, mode, actuator
        The move, the plant's mode, and the limits.
    derivatives
        How many derivatives of what is left vanish too; None if the move is not to be compared, as
        when it cancels a swing that it begins with.

    Returns
    -------
    RampFigures
        Without textbooks too where two lags follow the limits: shaped, they are not exact there.
    """
    figures = ramp_figures(command, (mode,), actuator)
    if derivatives is None or not follows_one_lag(actuator):
        return figures
    compared = textbook_moves(
        mode,
        actuator,
        derivatives=derivatives,
        travel_s=travel(command, actuator),
        end_s=figures.end_s,
    )
    return replace(figures, textbooks=compared)


def textbook_shapers(
    modes: tuple[Mode, ...], actuator: RateLimited, *, derivatives: int, end_s: float
) -> tuple[Textbook, ...]:
    """Return the shapers of an ideal drive that claim the same.

    Parameters
    ----------
    modes, actuator
        The plant's modes, and the limits.
    derivatives
        How many derivatives of what is left vanish too, 0 or 1.
    end_s
        When the last ramp of the command ends that is compared [s].

    Returns
    -------
    tuple of Textbook
        The ramp shaped; of a single mode also each shaper's steps. None of a kind that a mode is
        too damped for.
    """
    rise_s, _ = actuator.unit_ramps_s
    positive, unity = (
        [names[derivatives]] if _exists(names[derivatives], modes) else []
        for names in (POSITIVE, UNITY)
    )
    found = [_shaped(modes, actuator, name, step(), rise_s, end_s) for name in positive]
    for name in (*positive, *unity) if len(modes) == 1 else ():
        command = waiting(_designed(name, modes[0]), actuator)
        last_s = end_of_reference(command, actuator)
        found.append(
            Textbook(
                shaper=name,
                command="steps",
                ramp_end_s=last_s,
                residual=residual_vibration(command, modes[0], actuator),
                earlier=1 - end_s / last_s,
            )
        )
    return tuple(found)


def textbook_moves(
    mode: Mode, actuator: RateLimited, *, derivatives: int, travel_s: float, end_s: float
) -> tuple[Textbook, ...]:
    """Return the fastest unshaped move, shaped for an ideal drive.

    Parameters
    ----------
    mode, actuator
        The plant's mode, and the limits.
    derivatives, end_s
        As of `textbook_shapers`, of the whole move.
    travel_s
        Distance over full speed [s].

    Returns
    -------
    tuple of Textbook
        One: a trapezoid, or a triangle that does not reach full speed, convolved; none if the mode
        is too damped for its shaper.
    """
    if not _exists(POSITIVE[derivatives], (mode,)):
        return ()
    unshaped = unshaped_move(actuator, travel_s)
    unshaped_s = end_of_reference(unshaped, actuator)
    return (_shaped((mode,), actuator, POSITIVE[derivatives], unshaped, unshaped_s, end_s),)


def unshaped_move(actuator: RateLimited, travel_s: float) -> Impulses:
    """Return the fastest move within limits, whatever then swings.

    Parameters
    ----------
    actuator
        The limits.
    travel_s
        Distance over full speed [s].

    Returns
    -------
    Impulses
        One pulse: a trapezoid of the reference, or a triangle that does not reach full speed.
    """
    rise_s, fall_s = actuator.unit_ramps_s
    if actuator.jerk_limit_m_s3 is not None:
        from scipy.optimize import brentq  # noqa: PLC0415 - takes longer to import than a design

        longest_s = travel_s + rise_s + fall_s

        def missed_s(pulse_s: float) -> float:
            return travel(pulse(pulse_s), actuator) - travel_s

        return pulse(brentq(missed_s, SHORTEST * longest_s, longest_s, xtol=1e-15, rtol=1e-14))
    highest = min(1.0, (2 * travel_s / (rise_s + fall_s)) ** 0.5)
    # At the height of a triangle the step down comes as its ramp up ends.
    return pulse(travel_s / highest + highest * (rise_s - fall_s) / 2)


def waiting(shaper: Impulses, actuator: RateLimited) -> Impulses:
    """Return the steps of a shaper, each waiting for the ramp before it.

    What is put off puts off all that follows.

    Parameters
    ----------
    shaper
        Its levels are never negative.
    actuator
        The limits.

    Returns
    -------
    Impulses
        The first at 0.
    """
    # A step of a share of full speed is full speed itself of a drive of as much; below the least
    # speed that a drive may have its ramp takes no time.
    speeds = np.maximum(actuator.speed_m_s * np.abs(shaper.amplitudes), MIN_VALUE)
    drives = [replace(actuator, speed_m_s=speed).unit_ramps_s for speed in speeds.tolist()]
    rises_s, falls_s = np.array(drives).T
    ramps_s = np.where(shaper.accelerates, rises_s, falls_s)
    gaps_s = np.maximum(np.diff(shaper.times_s), ramps_s[:-1])
    return Impulses(
        times_s=np.concatenate(([0.0], np.cumsum(gaps_s))), amplitudes=shaper.amplitudes
    )


def _shaped(
    modes: tuple[Mode, ...],
    actuator: RateLimited,
    name: str,
    unshaped: Impulses,
    unshaped_s: float,
    end_s: float,
) -> Textbook:
    """Return the ramps of a command convolved with a shaper for each mode."""
    each = [_designed(name, mode) for mode in modes]
    shaper = reduce(convolve, each)
    last_s = unshaped_s + shaper.duration_s
    left = max(
        residual_vibration(shaper, mode, Ideal()) * residual_vibration(unshaped, mode, actuator)
        for mode in modes
    )
    return Textbook(
        shaper=name,
        command="shaped_ramp",
        ramp_end_s=last_s,
        residual=left,
        earlier=1 - end_s / last_s,
    )


def _exists(name: str, modes: tuple[Mode, ...]) -> bool:
    return all(mode.damping_ratio <= SHAPERS[name].damping.most for mode in modes)


def _designed(name: str, mode: Mode) -> Impulses:
    kind = SHAPERS[name]
    return next(solve(kind.formulate(kind.case((mode,), Ideal())))).impulses
