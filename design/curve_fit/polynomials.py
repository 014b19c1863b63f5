"""The answer of a fit: polynomials for the times of a shaper, and what they cost."""

from dataclasses import dataclass

import numpy as np

from design.types import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Variable:
    """The variable of the polynomials.

    Attributes
    ----------
    name
        ``x``.
    meaning
        What x is, in names of fields.
    start, stop
        Its range.
    """

    name: str
    meaning: str
    start: float
    stop: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Checks:
    """What was found at the points at which a fit is judged.

    Attributes
    ----------
    x
        Values of the variable, shape (m,).
    amplitudes
        Of the impulses, shape (n,) [-].
    times_s, exact_times_s
        Fitted times of the impulses and the exact ones, shape (m, n) [s].
    residuals
        Residual vibration that the fitted times leave, shape (m,) [-].
    """

    x: FloatArray
    amplitudes: FloatArray
    times_s: FloatArray
    exact_times_s: FloatArray
    residuals: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fit:
    """Polynomials for the times of a shaper, and what they cost.

    Attributes
    ----------
    variable
        The variable x.
    value
        What the polynomials give: times, or phases.
    coefficients
        A row for each impulse, ascending powers of x, shape (n, degree + 1).
    degree
        Their degree.
    checks
        What the fit is judged by.
    formula
        How to get times from them.
    frequency_unit_rad_s
        What the plant's frequency is divided by to give x [rad/s]; None where x is not that.
    """

    variable: Variable
    value: str
    coefficients: FloatArray
    degree: int
    checks: Checks
    formula: str
    frequency_unit_rad_s: float | None

    @property
    def worst_timing_error_s(self) -> float:
        """Largest distance from the exact times where both are checked [s]."""
        return float(np.abs(self.checks.times_s - self.checks.exact_times_s).max())

    @property
    def worst_residual(self) -> float:
        """Largest residual of the fitted times there, with the actuator given [-]."""
        return float(self.checks.residuals.max())

    @property
    def checked_points(self) -> int:
        """Number of points at which it is judged [-]."""
        return self.checks.x.size

    @property
    def in_phases(self) -> bool:
        """Whether the polynomials give phases in place of times.

        The plant's frequency turns phases into times.
        """
        return self.value != "time_s"
