"""Curve coefficients: impulse times as polynomials, so that a controller needs no solver.

``t ~ 1/w`` is no polynomial in w, which is why the thesis's fit is off by a third of a second.
The phases ``w t`` behind an actuator depend on the ratio of the plant's frequency to the
actuator's alone, smoothly: a few coefficients do.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial
from numpy.polynomial import polynomial as power

from design.analysis.residual import residuals_of_many
from design.errors import InfeasibleDesignError, InvalidInputError, SolverFailedError
from design.formulations.bands import BandProblem, BandSearch
from design.formulations.equations import Problem
from design.formulations.formulation import ClosedForm, Convolution, JointProblem
from design.model.actuators import Actuator, FirstOrder, SecondOrder
from design.model.impulses import Impulses
from design.model.plants import Pendulum, Plant
from design.pipeline import design
from design.shapers.kind import ShaperKind
from design.solvers.budget import Budget
from design.solvers.newton import roots
from design.types import FloatArray, require_between

Field = Literal["natural_frequency_rad_s", "cable_length_m", "damping_ratio"]
Form = Literal["dimensionless", "time_in_frequency"]

HIGHEST_DEGREE = 20
"""Beyond it the power basis itself loses the digits that a degree adds."""

CHECKED_POINTS = 1001
"""Points of the grid, ends included, on which a fit is judged."""

TIMES_TIME = " * time_s"

SAME_AMPLITUDE = 1e-12
"""Difference of two amplitudes that is rounding [-]."""

STARTING_DEGREE = 8
"""Of the fit that the exact curve is found from, by Newton's method."""

DESIGN_WORK = 3_000.0
"""Work of a design without a search: of its certificate [units]."""

THESIS_POINTS = 31
"""Points of the thesis's least-squares fit: w = 1, 1.1 ... 4 rad/s (Kim 2011, table 3-2)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FitRange:
    """What to fit over, and how well.

    Attributes
    ----------
    over
        The plant's field.
    start, stop
        Its range, in its own unit.
    degree
        Degree of the polynomials, 0 to 20; or None,
    max_residual
        and the lowest degree is taken whose times leave at most this [-].
    form
        ``dimensionless``, or ``time_in_frequency``: the thesis's, for comparison.
    """

    over: Field
    start: float
    stop: float
    degree: int | None = None
    max_residual: float | None = None
    form: Form = "dimensionless"

    def __post_init__(self) -> None:
        if not (math.isfinite(self.stop) and self.stop > self.start):
            raise InvalidInputError(
                "to", self.stop, f"finite and greater than from, {self.start!r}"
            )
        if (self.degree is None) == (self.max_residual is None):
            both = {"degree": self.degree, "max_residual": self.max_residual}
            raise InvalidInputError("degree", both, "given, or max_residual in its place")
        if self.degree is not None:
            require_between("degree", self.degree, 0, HIGHEST_DEGREE)
        if self.max_residual is not None and not 0 < self.max_residual < 1:
            raise InvalidInputError(
                "max_residual", self.max_residual, "between 0 and 1, both excluded"
            )
        if self.form == "time_in_frequency" and self.over != "natural_frequency_rad_s":
            raise InvalidInputError("form", self.form, "'dimensionless' over any but the frequency")


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
    """

    variable: Variable
    value: str
    coefficients: FloatArray
    degree: int
    worst_timing_error_s: float
    worst_residual: float
    checked_points: int
    formula: str


def fit(
    plant: Plant,
    actuator: Actuator,
    kind: ShaperKind,
    wanted: FitRange,
    options: Any = None,  # noqa: ANN401
) -> Fit:
    """Fit the impulse times of a shaper over a range of the plant.

    Parameters
    ----------
    plant
        The plant; its own value of the fitted field does not matter.
    actuator, kind, options
        As for `design.pipeline.design`.
    wanted
        Field, range and quality.

    Returns
    -------
    Fit
        By interpolation at Chebyshev nodes in a dimensionless variable, or by the thesis's least
        squares; judged on a grid of its own by the residual that the fitted times leave.

    Raises
    ------
    InvalidInputError
        If the plant has no such field, or the range leaves its bounds.
    InfeasibleDesignError
        If some point of the range has no such shaper, or no degree up to 20 is good enough.
    """
    curve = _Curve(_axis(plant, actuator, wanted), actuator, kind, options)
    if wanted.degree is not None:
        return curve.fitted(wanted.degree)
    limit = wanted.max_residual or 0.0
    best = math.inf, 0
    for degree in range(HIGHEST_DEGREE + 1):
        tried = curve.fitted(degree)
        if tried.worst_residual <= limit:
            return tried
        best = min(best, (tried.worst_residual, degree))
        if curve.budget.spent:
            break
    raise InfeasibleDesignError(
        f"no degree up to {degree} leaves a residual of at most max_residual = {limit:g}; "
        f"the best, degree {best[1]}, leaves {best[0]:.3g}"
        f"{f'; {curve.budget.in_words}' if curve.budget.spent else ''}"
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Axis:
    """The variable x of a fit: which plant it stands for, and how times are scaled there."""

    variable: Variable
    plant_at: Callable[[float], Plant]
    value: str
    in_phases: bool

    def scale_at(self, x: float) -> float:
        """Return what turns a time into the fitted value [rad/s], or 1."""
        return self.plant_at(x).mode.natural_frequency_rad_s if self.in_phases else 1.0

    def formula(self, degree: int) -> str:
        """Return how to get times from the coefficients, in words."""
        powers = ["", " x", *(f" x^{k}" for k in range(2, degree + 1))]
        terms = " + ".join(f"c_i{k}{powers[k]}" for k in range(degree + 1))
        if not self.in_phases:
            return terms
        return f"({terms}) / {self.value.removesuffix(TIMES_TIME)}"

    def nodes(self, degree: int) -> FloatArray:
        """Where a polynomial of this degree is fitted."""
        first, last = self.variable.start, self.variable.stop
        if not self.in_phases:
            return np.linspace(first, last, max(THESIS_POINTS, degree + 1))
        angles = np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1)
        return (first + last) / 2 - (last - first) / 2 * np.cos(angles)


def plants_at_ends(plant: Plant, wanted: FitRange) -> tuple[Plant, Plant]:
    """Return the plant at either end of the range.

    Raises
    ------
    InvalidInputError
        If the plant has no such field, or an end breaks its rule.
    """
    if not hasattr(plant, wanted.over):
        raise InvalidInputError("over", wanted.over, "a field of the plant")
    ends = []
    for name, value in (("from", wanted.start), ("to", wanted.stop)):
        try:
            ends.append(_plant_with(plant, wanted.over, value))
        except InvalidInputError as error:
            raise InvalidInputError(name, value, error.rule) from None
    return ends[0], ends[1]


def _plant_with(plant: Plant, field: Field, value: float) -> Plant:
    changed: dict[str, Any] = {field: value}
    return replace(plant, **changed)


def _axis(plant: Plant, actuator: Actuator, wanted: FitRange) -> _Axis:
    first, last = sorted(end.mode.natural_frequency_rad_s for end in plants_at_ends(plant, wanted))
    frequency = "natural_frequency_rad_s"
    if isinstance(plant, Pendulum):
        frequency = "sqrt(gravity_m_s2 / cable_length_m)"

    def plant_with(value: float) -> Plant:
        return _plant_with(plant, wanted.over, value)

    if wanted.form == "time_in_frequency":
        return _Axis(
            variable=Variable(name="x", meaning=frequency, start=first, stop=last),
            plant_at=plant_with,
            value="time_s",
            in_phases=False,
        )
    plant_at: Callable[[float], Plant] = plant_with
    variable = Variable(name="x", meaning="damping_ratio", start=wanted.start, stop=wanted.stop)
    if wanted.over != "damping_ratio":
        unit, in_words = _unit_of_frequency(actuator, last)
        variable = Variable(
            name="x", meaning=f"{frequency} {in_words}", start=first / unit, stop=last / unit
        )

        def plant_of_frequency(x: float) -> Plant:
            if isinstance(plant, Pendulum):
                return plant_with(plant.gravity_m_s2 / (x * unit) ** 2)
            return plant_with(x * unit)

        plant_at = plant_of_frequency
    return _Axis(
        variable=variable,
        plant_at=plant_at,
        value=f"{frequency}{TIMES_TIME}",
        in_phases=True,
    )


def _unit_of_frequency(actuator: Actuator, fastest_rad_s: float) -> tuple[float, str]:
    """Return what frequencies are measured by: the actuator's own, or the fastest of the range."""
    if isinstance(actuator, SecondOrder):
        return actuator.accel.natural_frequency_rad_s, "/ accel.natural_frequency_rad_s"
    if isinstance(actuator, FirstOrder) and actuator.accel_time_constant_s > 0:
        return 1 / actuator.accel_time_constant_s, "* accel_time_constant_s"
    return fastest_rad_s, f"/ {fastest_rad_s!r}"


class _Curve:
    """The exact times of a shaper along an axis, and polynomials for them."""

    def __init__(
        self,
        axis: _Axis,
        actuator: Actuator,
        kind: ShaperKind,
        options: Any,  # noqa: ANN401
    ) -> None:
        self.axis = axis
        self.actuator = actuator
        self.kind = kind
        self.options = kind.options() if options is None else options
        self.checked = np.linspace(axis.variable.start, axis.variable.stop, CHECKED_POINTS)
        modes = [axis.plant_at(float(x)).mode for x in self.checked]
        self.poles_rad_s = np.array([mode.pole_rad_s for mode in modes])
        self.frequencies_rad_s = np.array([mode.natural_frequency_rad_s for mode in modes])
        self.formulations: list[Problem | ClosedForm] = []
        for mode in modes:
            form = kind.formulate(kind.case((mode,), actuator, self.options))
            if isinstance(form, BandProblem | BandSearch | JointProblem | Convolution):
                raise InvalidInputError(
                    "over",
                    axis.variable.meaning,
                    f"left out for {kind.name}: its amplitudes and their number may change",
                )
            self.formulations.append(form)
        self.amplitudes, last = (
            form.impulses.amplitudes if isinstance(form, ClosedForm) else form.amplitudes
            for form in (self.formulations[0], self.formulations[-1])
        )
        if np.abs(self.amplitudes - last).max() > SAME_AMPLITUDE:
            raise InvalidInputError(
                "over",
                axis.variable.meaning,
                f"a field on which the amplitudes of {kind.name} do not depend: a fit is of times; "
                "a table holds both",
            )
        self.budget = Budget()
        self.exact_times_s = self._exact_times_s()

    def designed(self, x: float) -> Impulses:
        """Design at one x, by the pipeline."""
        self.budget.spend(DESIGN_WORK)
        plant = self.axis.plant_at(x)
        try:
            return design(plant, self.actuator, self.kind, self.options, self.budget).impulses
        except InfeasibleDesignError as error:
            raise InfeasibleDesignError(
                f"at {self.axis.variable.meaning} = {x:.6g}: {error}"
            ) from None

    def fitted(self, degree: int) -> Fit:
        """Fit one degree and judge it."""
        nodes = self.axis.nodes(degree)
        values = np.array([
            self.designed(x).times_s * self.axis.scale_at(x) for x in nodes.tolist()
        ])
        coefficients = self._power_basis(nodes, values, degree)
        fitted = power.polyval(self.checked, coefficients.T).T
        times = fitted / self.frequencies_rad_s[:, None] if self.axis.in_phases else fitted
        residuals = residuals_of_many(
            times,
            self.amplitudes,
            self.poles_rad_s,
            self.actuator,
        )
        worst_residual = float(residuals.max())
        if not math.isfinite(worst_residual):
            raise SolverFailedError(
                f"the fitted times of degree {degree} leave the range of numbers"
            )
        return Fit(
            variable=self.axis.variable,
            value=self.axis.value,
            coefficients=coefficients,
            degree=degree,
            worst_timing_error_s=float(np.abs(times - self.exact_times_s).max()),
            worst_residual=worst_residual,
            checked_points=CHECKED_POINTS,
            formula=f"t_i = {self.axis.formula(degree)}",
        )

    def _power_basis(self, nodes: FloatArray, values: FloatArray, degree: int) -> FloatArray:
        """Coefficients of each column of values, shape (columns, degree + 1)."""
        domain = [self.axis.variable.start, self.axis.variable.stop]
        rows = [
            Chebyshev.fit(nodes, column, degree, domain=domain).convert(kind=Polynomial).coef
            for column in values.T
        ]
        return np.array([np.pad(row, (0, degree + 1 - row.size)) for row in rows])

    def _exact_times_s(self) -> FloatArray:
        """Return the times at every checked point, shape (points, n) [s].

        By closed form where there is one; else by Newton's method from a fit, which is not the one
        to be judged; by the pipeline where that leaves the bounds.
        """
        nodes = self.axis.nodes(STARTING_DEGREE).tolist()
        frequencies = [self.axis.plant_at(x).mode.natural_frequency_rad_s for x in nodes]
        gaps = np.array([np.diff(self.designed(x).times_s) for x in nodes])
        phases = gaps * np.array(frequencies)[:, None]
        curves = self._power_basis(np.array(nodes), phases, STARTING_DEGREE)
        starts = power.polyval(self.checked, curves.T).T
        times = np.zeros((CHECKED_POINTS, starts.shape[1] + 1))
        solved = [
            index for index, form in enumerate(self.formulations) if isinstance(form, Problem)
        ]
        for index, form in enumerate(self.formulations):
            if isinstance(form, ClosedForm):
                times[index] = form.impulses.times_s
        if not solved:
            return times
        problems = [form for form in self.formulations if isinstance(form, Problem)]
        ends = roots(
            problems[0].model,
            np.array([
                form.start(gaps) for form, gaps in zip(problems, starts[solved], strict=True)
            ]),
            np.array([form.parameters for form in problems]),
        )
        for index, problem, unknowns, root in zip(
            solved, problems, ends.unknowns, ends.converged, strict=True
        ):
            gaps, _ = problem.split(unknowns)
            if root and (gaps >= problem.shortest_gaps_rad).all():
                times[index, 1:] = np.cumsum(gaps) / problem.natural_frequency_rad_s
            else:
                times[index] = self.designed(float(self.checked[index])).times_s
        return times
