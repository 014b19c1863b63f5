"""The variable of the polynomials: which plant it stands for, and how times are scaled there."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from design.curve_fit.fit_range import FitRange, plants_at_ends
from design.curve_fit.polynomials import Variable
from design.fields import vary
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.types import FloatArray

TIMES_TIME = " * time_s"

THESIS_POINTS = 31
"""Points of the thesis's least-squares fit: w = 1, 1.1 ... 4 rad/s (Kim 2011, table 3-2)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FitAxis:
    """The variable x of a fit: which plant it stands for, and how times are scaled there."""

    variable: Variable
    plant_at: Callable[[float], Plant]
    value: str
    in_phases: bool
    frequency_unit_rad_s: float | None

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


def axis_of_fit(plant: Plant, actuator: Actuator, wanted: FitRange) -> FitAxis:
    """Return the variable of a fit.

    Parameters
    ----------
    plant, actuator
        What moves, and what drives it.
    wanted
        Range of one field of the plant.

    Returns
    -------
    FitAxis
        What x is, and how times are scaled along it.

    Raises
    ------
    InvalidInputError
        If the plant has no such field, or an end of the range breaks its rule.
    """
    first, last = sorted(end.mode.natural_frequency_rad_s for end in plants_at_ends(plant, wanted))
    frequency = "natural_frequency_rad_s"
    if isinstance(plant, Pendulum):
        frequency = "sqrt(gravity_m_s2 / cable_length_m)"

    def plant_with(value: float) -> Plant:
        changed: Plant = vary(plant, (wanted.over,), value)
        return changed

    if wanted.form == "time_in_frequency":
        return FitAxis(
            variable=Variable(name="x", meaning=frequency, start=first, stop=last),
            plant_at=plant_with,
            value="time_s",
            in_phases=False,
            frequency_unit_rad_s=1.0,
        )
    plant_at: Callable[[float], Plant] = plant_with
    unit: float | None = None
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
    return FitAxis(
        variable=variable,
        plant_at=plant_at,
        value=f"{frequency}{TIMES_TIME}",
        in_phases=True,
        frequency_unit_rad_s=unit,
    )


def _unit_of_frequency(actuator: Actuator, fastest_rad_s: float) -> tuple[float, str]:
    """Return what frequencies are measured by: the actuator's own, or the fastest of the range."""
    if isinstance(actuator, SecondOrder):
        return actuator.accel.natural_frequency_rad_s, "/ accel.natural_frequency_rad_s"
    if isinstance(actuator, FirstOrder) and actuator.accel_time_constant_s > 0:
        return 1 / actuator.accel_time_constant_s, "* accel_time_constant_s"
    return fastest_rad_s, f"/ {fastest_rad_s!r}"
