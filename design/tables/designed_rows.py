"""Rows of a table in the making: single designs entered one by one."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from design.analysis.certificate import certify
from design.analysis.large_swing_certificate import certify_large_swing
from design.claims import zeros
from design.errors import SolverFailedError
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.model.plants.spring_mass import SpringMass
from design.pipeline import Design
from design.tables.rows import VERIFIED, VERIFIED_IDEAL
from design.types import BoolArray, FloatArray


@dataclass(slots=True, kw_only=True, eq=False)
class DesignedRows:
    """Rows in the making, of m rows and n impulses."""

    times_s: FloatArray  # (m, n)
    amplitudes: FloatArray  # (m, n)
    natural_frequencies_rad_s: FloatArray  # (m,)
    residuals: FloatArray  # (m,)
    slopes: FloatArray  # (m,)
    designed: BoolArray  # (m,), what they claim is proven
    for_ideal: BoolArray  # (m,), but not with the actuator given
    wants_slopes: bool
    sample_times_s: FloatArray | None = None  # (m,); None of rows between samples

    def take(self, row: int, plant: Plant, actuator: Actuator, found: Design) -> None:
        """Enter a single design.

        Parameters
        ----------
        row
            Number of the row.
        plant, actuator, found
            What the row is a design of, and the design.

        Raises
        ------
        SolverFailedError
            If it has another number of impulses than the rest; on samples it may have fewer.
        """
        wanted, has = self.times_s.shape[1], found.impulses.times_s.size
        if has != wanted and (self.sample_times_s is None or has > wanted):
            raise SolverFailedError(
                f"the design has {has} impulses, the table's rows {wanted}",
                code="impulses_unlike_rows",
            )
        self.times_s[row, :has] = found.impulses.times_s
        self.amplitudes[row, :has] = found.impulses.amplitudes
        if isinstance(plant, Mode | Pendulum | SpringMass):  # only there a phase is asked for
            self.natural_frequencies_rad_s[row] = plant.mode.natural_frequency_rad_s
        self.residuals[row] = found.residual
        if self.wants_slopes:
            self.slopes[row] = _slope_of(plant, actuator, found)
        self.designed[row] = True
        self.for_ideal[row] = found.for_ideal

    def status(self) -> NDArray[np.int8]:
        """Return what has become of the rows that have a design, shape (m,)."""
        return np.where(self.for_ideal, VERIFIED_IDEAL, VERIFIED).astype(np.int8)

    def results(self, columns: tuple[str, ...]) -> FloatArray:
        """Return the columns asked for, shape (m, r)."""
        of_name: dict[str, Callable[[], FloatArray]] = {
            "times_s": lambda: self.times_s,
            "amplitudes": lambda: self.amplitudes,
            "phases_rad": lambda: self.natural_frequencies_rad_s[:, None] * self.times_s,
            "duration_s": self._durations_s,
            "residual": lambda: self.residuals[:, None],
            "slope": lambda: self.slopes[:, None],
            "samples": lambda: self._in_samples(self.times_s),
            "duration_samples": lambda: self._in_samples(self._durations_s()),
        }
        results = np.concatenate([of_name[name]() for name in columns], axis=1)
        results[~self.designed] = np.nan
        return results

    def _durations_s(self) -> FloatArray:
        if not self.times_s.shape[1]:
            return np.full((len(self.times_s), 1), np.nan)
        last: FloatArray = np.fmax.reduce(self.times_s, axis=1, keepdims=True)
        return last - self.times_s[:, :1]

    def _in_samples(self, times_s: FloatArray) -> FloatArray:
        """Return times as whole numbers of samples."""
        sample_times_s = np.nan if self.sample_times_s is None else self.sample_times_s[:, None]
        samples: FloatArray = np.rint(times_s / sample_times_s)
        return samples


def _slope_of(plant: Plant, actuator: Actuator, found: Design) -> float:
    """Return the largest slope of a design in any mode, of large swings that of these [-]."""
    slope = zeros(["slope"])
    if found.large_swing is not None:
        swing = found.large_swing.swing
        return certify_large_swing(found.impulses, swing, actuator, slope).claims[0].value
    return max(
        certify(found.impulses, mode, actuator, slope).claims[0].value for mode in plant.modes
    )


def empty_rows(
    rows: int,
    impulses: int,
    columns: tuple[str, ...],
    sample_times_s: FloatArray | None = None,
) -> DesignedRows:
    """Return rows into which no design is entered.

    Parameters
    ----------
    rows, impulses
        Their number, and the most impulses that one has.
    columns
        What is asked of them.
    sample_times_s
        On samples the sample time of each row, shape (rows,) [s].

    Returns
    -------
    DesignedRows
        Not a number all over.
    """
    return DesignedRows(
        times_s=np.full((rows, impulses), np.nan),
        amplitudes=np.full((rows, impulses), np.nan),
        natural_frequencies_rad_s=np.full(rows, np.nan),
        residuals=np.full(rows, np.nan),
        slopes=np.full(rows, np.nan),
        designed=np.zeros(rows, dtype=np.bool_),
        for_ideal=np.zeros(rows, dtype=np.bool_),
        wants_slopes="slope" in columns,
        sample_times_s=sample_times_s,
    )
