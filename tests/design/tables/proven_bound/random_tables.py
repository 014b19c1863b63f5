"""Tables of smooth times that are no designs, over any fields: large residuals of any shape."""

from dataclasses import dataclass

import numpy as np

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited, Unlimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.model.plants.spring_mass import SpringMass
from design.tables.coordinates import coordinates
from design.tables.interpolation import Interpolant, OneMode, mode_of
from design.tables.proven_bound.stencils import GridAxis
from design.types import FloatArray

Drive = tuple[Actuator, dict[str, tuple[float, float]]]

PLANTS: tuple[tuple[OneMode, dict[str, tuple[float, float]]], ...] = (
    (Pendulum(cable_length_m=0.8), {"cable_length_m": (0.3, 1.4), "gravity_m_s2": (9.0, 10.0)}),
    (SpringMass(mass_kg=3.0, stiffness_n_m=50.0), {"mass_kg": (1, 4), "stiffness_n_m": (20, 90)}),
    (
        Mode(natural_frequency_rad_s=3.5, damping_ratio=0.04),
        {"natural_frequency_rad_s": (2.5, 4.5), "damping_ratio": (0.0, 0.3)},
    ),
)
"""Plants, and ranges of their fields."""


def unlimited(model: Model) -> tuple[tuple[Unlimited, dict[str, tuple[float, float]]], ...]:
    """Return actuators without limits, and ranges of their fields."""
    return (
        (Ideal(), {}),
        (
            FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.04, model=model),
            {"accel_time_constant_s": (0.05, 0.2), "decel_time_constant_s": (0.02, 0.1)},
        ),
        (
            SecondOrder(
                accel=SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=0.8),
                decel=SecondOrderSet(natural_frequency_rad_s=50.0, damping_ratio=1.5),
                model=model,
            ),
            {
                "accel.natural_frequency_rad_s": (15, 30),
                "decel.natural_frequency_rad_s": (30, 60),
                "accel.damping_ratio": (0.6, 1.4),  # through critical damping
                "decel.damping_ratio": (1.0, 1.8),
            },
        ),
    )


def limited(then: Unlimited, ranges: dict[str, tuple[float, float]]) -> Drive:
    """Return limits before an actuator, under which some ramps are over and others are turned."""
    behind = {f"then.{name}": ends for name, ends in ranges.items()}
    own = {"accel_limit_m_s2": (0.6, 2.0), "decel_limit_m_s2": (0.7, 3.0), "speed_m_s": (0.1, 0.4)}
    limits = RateLimited(accel_limit_m_s2=1.0, decel_limit_m_s2=1.6, speed_m_s=0.3, then=then)
    return limits, own | behind


AMPLITUDES = ((1.0, -1.0, 1.0), (1.0, -1.0, 1.0, -1.0, 1.0), (0.3, 0.4, 0.3), (1.0, -2.0, 2.0))


@dataclass(frozen=True)
class RandomTable:
    """A table over a grid."""

    axes: tuple[GridAxis, ...]
    times_s: FloatArray
    made: Interpolant

    def points(self, random: np.random.Generator, count: int) -> FloatArray:
        """Return random points of its range, ends and rows among them."""
        columns = [random.uniform(axis.values[0], axis.values[-1], count) for axis in self.axes]
        for axis, column in zip(self.axes, columns, strict=True):
            column[: axis.values.size] = axis.values
        return np.column_stack(columns)


def random_table(random: np.random.Generator, model: Model, *, limits: bool = False) -> RandomTable:
    """Return a table over one or two fields of a random plant and actuator."""
    plant, plant_ranges = PLANTS[random.integers(len(PLANTS))]
    choices = unlimited(model)
    drive: Drive = choices[random.integers(len(choices))]
    if limits:
        drive = limited(*choices[random.integers(len(choices))])
    actuator, own_ranges = drive
    ranges: dict[str, tuple[float, float]] = {
        f"plant.{name}": ends for name, ends in plant_ranges.items()
    }
    ranges |= {f"actuator.{name}": ends for name, ends in own_ranges.items()}
    names = random.permutation(list(ranges))[: random.integers(1, 3)].tolist()
    sizes = random.integers(2, 12 if len(names) == 1 else 8, len(names)).tolist()
    axes = tuple(
        GridAxis(field=name, values=np.sort(random.uniform(ranges[name][0], ranges[name][1], size)))
        for name, size in zip(names, sizes, strict=True)
    )
    grid = np.stack(np.meshgrid(*(axis.values for axis in axes), indexing="ij"), axis=-1)
    points = grid.reshape(-1, len(axes))
    amplitudes = np.array(AMPLITUDES[random.integers(len(AMPLITUDES))])
    # Gaps between a tenth and most of a turn, as smooth waves of the coordinates.
    shares = np.column_stack([
        np.interp(coordinates(axis.field, column), *_ends(axis))
        for axis, column in zip(axes, points.T, strict=True)
    ])
    waves = random.normal(0, 1, (amplitudes.size - 1, len(axes)))
    turns = np.cos(shares @ waves.T + random.uniform(0, 6, amplitudes.size - 1))
    gaps = random.uniform(0.8, 2.0, amplitudes.size - 1) * (1 + 0.3 * turns)
    phases = np.column_stack((np.zeros(len(points)), np.cumsum(gaps, axis=1)))
    frequencies, _ = mode_of(plant, names, points)
    made = Interpolant(
        names=tuple(names),
        axes=tuple(axis.values for axis in axes),
        phases=phases.reshape(*sizes, -1),
        amplitudes=amplitudes,
        plant=plant,
        actuator=actuator,
        closed=np.zeros([size - 1 for size in sizes], dtype=np.bool_),
        residual_bound=np.nan,
    )
    return RandomTable(axes=axes, times_s=phases / frequencies[:, None], made=made)


def _ends(axis: GridAxis) -> tuple[FloatArray, FloatArray]:
    ends = np.sort(axis.nodes[[0, -1]])
    return ends, np.array([0.0, 1.0])
