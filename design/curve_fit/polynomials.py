"""The answer of a fit: polynomials for the times of a shaper, and what they cost."""

from dataclasses import dataclass

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
    worst_timing_error_s
        Largest distance from the exact times on the checked grid [s].
    worst_residual
        Largest residual vibration that the fitted times leave there with the actuator given [-].
    checked_points
        Size of that grid.
    formula
        How to get times from them.
    frequency_unit_rad_s
        What the plant's frequency is divided by to give x [rad/s]; None where x is not that.
    """

    variable: Variable
    value: str
    coefficients: FloatArray
    degree: int
    worst_timing_error_s: float
    worst_residual: float
    checked_points: int
    formula: str
    frequency_unit_rad_s: float | None

    @property
    def in_phases(self) -> bool:
        """Whether the polynomials give phases in place of times.

        The plant's frequency turns phases into times.
        """
        return self.value != "time_s"
