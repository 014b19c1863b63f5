"""A stop from a state: what remains after its switches, and how far it goes."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from design.live.stop_kernel import ends
from design.types import BoolArray, ComplexArray, FloatArray

Pulse = tuple[float, float]
"""When the command is at full speed: from, to [s]."""


class Left(NamedTuple):
    """What remains after switches.

    Attributes
    ----------
    vibration, by_times
        Modal coordinates at the end, shape (m,) [-], and their derivatives by each time, shape
        (k, m) [1/s].
    way_s, way_by_times
        The way at full speed 1 from the event until all is at rest [s], and its derivatives by each
        time, shape (k,) [-].
    """

    vibration: ComplexArray
    by_times: ComplexArray
    way_s: float
    way_by_times: FloatArray


class Switches(NamedTuple):
    """Switches of a command, shapes (k,): times [s], levels [-], and which times may change."""

    times_s: FloatArray
    levels: FloatArray
    free: BoolArray


@dataclass(frozen=True, kw_only=True, eq=False)
class StopCase:
    """Drive, modes and their state, of motion in +x, and until when all is to be at rest.

    Attributes
    ----------
    level
        Of the command in force, 0 to 1 [-].
    force
        The set in force: 0 accelerates, 1 decelerates.
    lag
        Error and rate, shape (2, 2): row 0 of a switched drive, else a row for each set.
    vibration
        Modal coordinates, what the lags will still leave added, shape (m,) [-].
    lags
        ``first, second`` of either set, shape (2, 2) [s], [s^2].
    poles_rad_s
        Upper poles of the modes, shape (m,) [rad/s].
    switched
        Whether both sets share one state.
    end_s
        After the last moment of the stop, from the event on [s].
    """

    level: float
    force: int
    lag: FloatArray
    vibration: ComplexArray
    lags: FloatArray
    poles_rad_s: ComplexArray
    switched: bool
    end_s: float

    @cached_property
    def gains(self) -> ComplexArray:
        """G of either set at the poles, shape (2, m) [-]."""
        s = self.poles_rad_s
        return np.array([1 / (1 + first * s + second * s * s) for first, second in self.lags])

    @cached_property
    def quickest_rad_s(self) -> float:
        """Frequency of the quickest mode [rad/s]."""
        return float(np.abs(self.poles_rad_s).max())

    @cached_property
    def slowest_rad_s(self) -> float:
        """Frequency of the slowest mode [rad/s]."""
        return float(np.abs(self.poles_rad_s).min())

    @cached_property
    def _lag_state(self) -> FloatArray:
        error, rate = self.lag[0] if self.switched else (0.0, 0.0)
        return np.array([float(self.force), error, rate])

    @cached_property
    def _coasting_s(self) -> float:
        """What superposed lags still add to the way [s]."""
        return 0.0 if self.switched else float((self.lags * self.lag).sum())

    def left_by(self, times_s: FloatArray, levels: FloatArray) -> Left:
        """Return what remains after switches.

        Parameters
        ----------
        times_s, levels
            When the command switches, from the event on and ascending, and to what; 0 at last,
            shape (k,) each [s], [-].

        Returns
        -------
        Left
            With derivatives by the times.
        """
        count, modes = times_s.size, self.poles_rad_s.size
        vibration = np.zeros(modes, dtype=np.complex128)
        by_times = np.zeros((count, modes), dtype=np.complex128)
        way = np.zeros(count + 1)
        ends(
            times_s, levels, self.end_s, self.level, self._lag_state, self.vibration, self.lags,
            self.poles_rad_s, self.gains, self.switched, vibration, by_times, way,
        )  # fmt: skip
        return Left(vibration, by_times, float(way[0]) + self._coasting_s, way[1:])

    def switches_of(self, pulses: list[Pulse]) -> Switches:
        """Return the switches of a command that is off except during pulses.

        Parameters
        ----------
        pulses
            From, to, ascending. Times at 0 and at the end stay there.

        Returns
        -------
        Switches
            The first is at 0 unless the command stays as it is.
        """
        rows: list[tuple[float, float, bool]] = []
        if self.level != 0.0 and (not pulses or pulses[0][0] > 0.0):
            rows.append((0.0, 0.0, False))
        for on, off in pulses:
            if on > 0.0 or self.level != 1.0:
                rows.append((on, 1.0, on > 0.0))
            rows.append((off, 0.0, off < self.end_s))
        return Switches(
            np.array([row[0] for row in rows]),
            np.array([row[1] for row in rows]),
            np.array([row[2] for row in rows], dtype=np.bool_),
        )

    def pulses_of(self, times_s: FloatArray, levels: FloatArray) -> list[Pulse]:
        """Return the pulses of switches: the inverse of `switches_of`.

        Parameters
        ----------
        times_s, levels
            As of `left_by`.

        Returns
        -------
        list of Pulse
            From, to, ascending.
        """
        pulses: list[Pulse] = []
        stays = self.level == 1.0 and not (times_s.size and times_s[0] == 0.0 and levels[0] == 0.0)
        on = 0.0 if stays else None
        for time, level in zip(times_s.tolist(), levels.tolist(), strict=True):
            if level == 1.0:
                on = time
            elif on is not None:
                pulses.append((on, time))
                on = None
        return pulses
