"""The stop of a move after a cruise of another length: from when on it is right."""

from dataclasses import dataclass

import numpy as np

from design.analysis.residual import residual_vibration
from design.model.actuators.registry import Actuator, unit_ramps_s
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.moves.cycles import reached_s
from design.moves.maneuvers import Maneuver

TRIED = 64
"""Cruises that are tried [-]."""

REST_TIME_CONSTANTS = 16.0
"""Time constants of the drive within which they are: e^-16 is 1e-7 [-]."""

SHORTEST = 1e-3
"""Of the longest of these cruises the shortest [-]."""

RIGHT = 1e-3
"""Residual from which on a stop is right: what cycles of 1 ms that jitter leave of a crane [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LaterStops:
    """Residual of start and stop, by the cruise between them.

    Attributes
    ----------
    wait_s
        Cruise from which on the residual is at most `RIGHT`; 0 where it is so at once, or is so
        after none [s].
    residual
        Largest residual of the cruises tried from there on, a share of one unshaped step [-].
    sooner
        Largest residual of those tried before; 0 where there are none [-].
    """

    wait_s: float
    residual: float
    sooner: float


def later_stops(move: Maneuver, mode: Mode, actuator: Actuator) -> LaterStops:
    """Return the residual of start and stop, with cruises of other lengths.

    The stop was solved for the state that the drive has at that of the move. A drive whose steps
    superpose is met by it at any time; a switched one that has not settled is not.

    Parameters
    ----------
    move
        A move whose start and stop are apart.
    mode, actuator
        The plant's mode and its drive.

    Returns
    -------
    LaterStops
        By the residual of cruises from the end of the start until the drive is at rest, and to
        that of the move.
    """
    end_s = reached_s(move.start, actuator)
    lags = (actuator.accel_lag, actuator.decel_lag)
    slowest_s = max(lag.first_s + lag.second_s2**0.5 for lag in lags)
    at_rest_s = REST_TIME_CONSTANTS * slowest_s + max(unit_ramps_s(actuator))
    longest_s = max(at_rest_s, move.pulse_s - end_s, SHORTEST * mode.period_s)
    cruises_s = np.geomspace(SHORTEST * longest_s, longest_s, TRIED)
    stop = move.stop.times_s - move.stop.times_s[0]
    amplitudes = np.concatenate((move.start.amplitudes, move.stop.amplitudes))
    left = np.array([
        residual_vibration(
            Impulses(
                times_s=np.concatenate((move.start.times_s, end_s + cruise_s + stop)),
                amplitudes=amplitudes,
            ),
            mode,
            actuator,
            move.swing,
        )
        for cruise_s in cruises_s.tolist()
    ])
    above = np.flatnonzero(left > RIGHT)
    first = 0 if not above.size or above[-1] == TRIED - 1 else int(above[-1]) + 1
    return LaterStops(
        wait_s=float(cruises_s[first]) if first else 0.0,
        residual=float(left[first:].max()),
        sooner=float(left[:first].max(initial=0.0)),
    )
