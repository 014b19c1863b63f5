"""The exact times of a shaper along a variable, and polynomials for them."""

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial
from numpy.polynomial import polynomial as power

from design.analysis.residuals_of_many import residuals_of_many
from design.curve_fit.polynomials import Checks, Fit
from design.curve_fit.variable import FitAxis
from design.errors import InfeasibleDesignError, InvalidInputError, SolverFailedError
from design.formulations.bands import BandProblem, BandSearch
from design.formulations.equations import GapProblem
from design.formulations.formulation import ClosedForm, Convolution, JointProblem
from design.formulations.large_swing import LargeSwingProblem
from design.formulations.ramped import RampedProblem
from design.formulations.ramped_band import RampedBandProblem
from design.formulations.ramped_humps import RampedHumpsProblem
from design.formulations.steps_for_modes import StepsProblem
from design.formulations.unequal_band import UnequalBandProblem
from design.formulations.unequal_humps import UnequalHumpsProblem
from design.formulations.unequal_ramps import UnequalRampsProblem
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.pipeline import design
from design.shapers.kind import ShaperKind
from design.shapers.options import ShaperOptions
from design.solvers.budget import Budget
from design.solvers.newton import roots
from design.solvers.ramps.course import Slopes
from design.solvers.ramps.functionals import Functionals
from design.solvers.ramps.optimality import solve_conditions
from design.solvers.ramps.unequal_course import TwoLags
from design.solvers.ramps.unequal_program import solve_near
from design.types import FloatArray

CHECKED_POINTS = 1001
"""Points of the grid, ends included, on which a fit is judged."""

SAME_AMPLITUDE = 1e-12
"""Difference of two amplitudes that is rounding [-]."""

STARTING_DEGREE = 8
"""Of the fit that the exact curve is found from, by Newton's method."""

RAMPED_WORK = 1_000.0
"""Work of Newton's method behind limits, from a start nearby [units]."""

UNSERVED = (
    BandProblem
    | BandSearch
    | RampedBandProblem
    | RampedHumpsProblem
    | UnequalBandProblem
    | UnequalHumpsProblem
    | JointProblem
    | LargeSwingProblem
    | Convolution
)
"""Formulations whose amplitudes and their number may change along a range."""

Ramps = RampedProblem | UnequalRampsProblem
"""What is formulated behind limits."""

DESIGN_WORK = 3_000.0
"""Work of a design without a search: of its certificate [units]."""


class ExactCurve:
    """The exact times of a shaper along an axis, and polynomials for them."""

    def __init__(
        self,
        axis: FitAxis,
        actuator: Actuator,
        kind: ShaperKind,
        options: ShaperOptions | None,
    ) -> None:
        if isinstance(actuator, RateLimited):
            actuator.require_straight_ramps()
        self.axis = axis
        self.actuator = actuator
        self.kind = kind
        self.options = kind.options() if options is None else options
        self.checked = np.linspace(axis.variable.start, axis.variable.stop, CHECKED_POINTS)
        modes = [axis.plant_at(float(x)).mode for x in self.checked]
        self.poles_rad_s = np.array([mode.pole_rad_s for mode in modes])
        self.frequencies_rad_s = np.array([mode.natural_frequency_rad_s for mode in modes])
        self.budget = Budget()
        self.formulations: list[GapProblem | Ramps | ClosedForm] = []
        for mode in modes:
            form = kind.formulate(kind.case((mode,), actuator, self.options))
            if isinstance(form, UNSERVED):
                raise InvalidInputError(
                    "shaper.kind",
                    kind.name,
                    f"a kind whose amplitudes stay: {kind.name} cannot be fitted, its amplitudes "
                    "and their number may change",
                    code="fit_not_served",
                )
            self.formulations.append(form.gaps if isinstance(form, StepsProblem) else form)
        self.amplitudes, last = (self._amplitudes_at(place) for place in (0, -1))
        if self.amplitudes.size != last.size:
            raise self._impulses_change(float(self.checked[-1]), last.size)
        if np.abs(self.amplitudes - last).max() > SAME_AMPLITUDE:
            raise InvalidInputError(
                "over",
                axis.variable.meaning,
                f"a field on which the amplitudes of {kind.name} do not depend: a fit is of times; "
                "a table holds both",
                code="fitted_amplitudes_depend",
            )
        self.exact_times_s = self._exact_times_s()

    @property
    def exact_worst_residual(self) -> float:
        """Largest residual of the exact times where the fit is checked [-]."""
        exact = residuals_of_many(
            self.exact_times_s, self.amplitudes, self.poles_rad_s, self.actuator
        )
        return float(exact.max())

    def _amplitudes_at(self, place: int) -> FloatArray:
        """Return the amplitudes at one of the points that are checked."""
        form = self.formulations[place]
        if isinstance(form, ClosedForm):
            return form.impulses.amplitudes
        if isinstance(form, GapProblem):
            return form.amplitudes
        return self._design_at(float(self.checked[place])).amplitudes

    def _impulses_change(self, x: float, impulses: int) -> InvalidInputError:
        """Return the refusal of a range over which the number of impulses changes."""
        return InvalidInputError(
            "over",
            self.axis.variable.meaning,
            f"a range over which the number of impulses stays: it is {self.amplitudes.size} at "
            f"{self.checked[0]:.6g} and {impulses} at {x:.6g}",
            code="fitted_impulses_change",
        )

    def design_at(self, x: float) -> Impulses:
        """Design at one x, by the pipeline.

        Parameters
        ----------
        x
            Value of the variable, within the range of the fit.

        Returns
        -------
        Impulses
            Of the curve at x.

        Raises
        ------
        InvalidInputError
            If it has another number of impulses there than where the range starts.
        InfeasibleDesignError
            If there is no such shaper at x; the error says which x.
        """
        found = self._design_at(x)
        if found.times_s.size != self.amplitudes.size:
            raise self._impulses_change(x, found.times_s.size)
        return found

    def _design_at(self, x: float) -> Impulses:
        self.budget.spend(DESIGN_WORK)
        plant = self.axis.plant_at(x)
        try:
            return design(plant, self.actuator, self.kind, self.options, self.budget).impulses
        except InfeasibleDesignError as error:
            raise InfeasibleDesignError(
                f"at {self.axis.variable.meaning} = {x:.6g}: {error}", code=error.code
            ) from None

    def fit(self, degree: int) -> Fit:
        """Fit one degree and judge it.

        Parameters
        ----------
        degree
            Degree of the polynomials, >= 0.

        Returns
        -------
        Fit
            Coefficients, and the largest error of time and residual at the points that are checked.

        Raises
        ------
        InfeasibleDesignError
            If there is no shaper at one of the fit's nodes.
        SolverFailedError
            If the fitted times leave the range of numbers.
        """
        nodes = self.axis.nodes(degree)
        values = np.array([
            self.design_at(x).times_s * self.axis.scale_at(x) for x in nodes.tolist()
        ])
        coefficients = self._power_basis(nodes, values, degree)
        fitted = power.polyval(self.checked, coefficients.T).T
        times = fitted / self.frequencies_rad_s[:, None] if self.axis.in_phases else fitted
        with np.errstate(over="ignore", invalid="ignore"):  # what is no number is refused below
            residuals = residuals_of_many(times, self.amplitudes, self.poles_rad_s, self.actuator)
        if not np.isfinite(residuals).all():
            raise SolverFailedError(
                f"the fitted times of degree {degree} exceed the range of numbers",
                code="fit_overflows",
            )
        return Fit(
            variable=self.axis.variable,
            value=self.axis.value,
            coefficients=coefficients,
            degree=degree,
            checks=Checks(
                x=self.checked,
                amplitudes=self.amplitudes,
                times_s=times,
                exact_times_s=self.exact_times_s,
                residuals=residuals,
            ),
            formula=f"t_i = {self.axis.formula(degree)}",
            frequency_unit_rad_s=self.axis.frequency_unit_rad_s,
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
        to be judged; by the pipeline where that is out of bounds.
        """
        nodes = self.axis.nodes(STARTING_DEGREE).tolist()
        frequencies = [self.axis.plant_at(x).mode.natural_frequency_rad_s for x in nodes]
        gaps = np.array([np.diff(self.design_at(x).times_s) for x in nodes])
        phases = gaps * np.array(frequencies)[:, None]
        curves = self._power_basis(np.array(nodes), phases, STARTING_DEGREE)
        starts = power.polyval(self.checked, curves.T).T
        times = np.zeros((CHECKED_POINTS, starts.shape[1] + 1))
        solved = [
            index for index, form in enumerate(self.formulations) if isinstance(form, GapProblem)
        ]
        for index, form in enumerate(self.formulations):
            if isinstance(form, ClosedForm):
                times[index] = form.impulses.times_s
            if isinstance(form, Ramps):
                times[index] = self._ramped_times_s(index, form, starts[index])
        if not solved:
            return times
        problems = [form for form in self.formulations if isinstance(form, GapProblem)]
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
                times[index] = self.design_at(float(self.checked[index])).times_s
        return times

    def _ramped_times_s(self, index: int, form: Ramps, gaps: FloatArray) -> FloatArray:
        """Return the times behind limits from gaps near them, shape (n,) [s]."""
        if (gaps > 0).all():
            self.budget.spend(RAMPED_WORK)
            switches = _switches_near(form, np.append(0.0, np.cumsum(gaps)))
            if switches is not None:
                return switches / form.natural_frequency_rad_s
        return self.design_at(float(self.checked[index])).times_s


def _switches_near(form: Ramps, switches: FloatArray) -> FloatArray | None:
    """Return the switches of the fastest course near some; None where there is none so near."""
    if isinstance(form, UnequalRampsProblem):
        behind_two = solve_near(TwoLags(form), switches)
        return None if behind_two is None else behind_two.switches
    slopes = Slopes(up=1 / form.ramps_rad[0], down=1 / form.ramps_rad[1])
    functionals = Functionals(form.unit_poles, form.orders)
    found = solve_conditions(switches, functionals, form.targets, slopes)
    return None if found is None else found.course.switches
