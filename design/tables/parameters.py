"""From the varied fields of many rows to the parameters of their dimensionless problems.

By sums, products, quotients and roots alone, which every machine rounds alike.
"""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from design.analysis.workable import RESONANCE, SLOWEST
from design.checks import MAX_VALUE, MIN_VALUE
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.second_order import MAX_DAMPING_RATIO as MAX_LAG_DAMPING
from design.model.actuators.second_order import MIN_DAMPING_RATIO as MIN_LAG_DAMPING
from design.model.actuators.second_order import SecondOrder
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.shapers.settle_options import MAX_HORIZON_PERIODS, MIN_HORIZON_PERIODS
from design.shapers.umzv import MAX_PERIODS
from design.tables.specification import TableSpecification
from design.types import BoolArray, FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RowParameters:
    """Parameters of m rows.

    Attributes
    ----------
    natural_frequencies_rad_s
        Of the plants, shape (m,) [rad/s].
    lags
        Damping ratio of the plant, ``first, second`` of the acceleration and of the deceleration
        set, in units of the plant's frequency, shape (m, 5): as
        `design.formulations.lag_parameters.lag_parameters` [-].
    max_duration_periods
        Longest shaper, shape (m,) [-].
    workable
        Rows whose values obey every rule, of each field and of all together, shape (m,).
    """

    natural_frequencies_rad_s: FloatArray
    lags: FloatArray
    max_duration_periods: FloatArray
    workable: BoolArray


class _Fields:
    """Values of named fields, varied or constant, and whether they obey their rules."""

    def __init__(self, specification: TableSpecification, values: FloatArray) -> None:
        self._specification = specification
        self._values = values
        self.lawful = np.ones(len(values), dtype=np.bool_)

    def __call__(
        self, *path: str, least: float = MIN_VALUE, most: float = MAX_VALUE, zero: bool = False
    ) -> FloatArray:
        """Return one field of every row, shape (m,)."""
        if path in self._specification.fields:
            column = self._values[:, self._specification.fields.index(path)]
        else:
            record: Any = {
                "plant": self._specification.plant,
                "actuator": self._specification.actuator,
                "shaper": self._specification.options,
            }[path[0]]
            for name in path[1:]:
                record = getattr(record, name)
            column = np.full(len(self._values), float(record))
        self.lawful &= ((column >= least) & (column <= most)) | (zero & (column == 0.0))
        return column


def row_parameters(specification: TableSpecification, values: FloatArray) -> RowParameters:
    """Return the parameters of rows of a table.

    Parameters
    ----------
    specification
        Of a plant with one mode and an actuator of lags.
    values
        Varied fields of the rows, shape (m, f).

    Returns
    -------
    RowParameters
        Of m rows; those that break a rule are marked.
    """
    field = _Fields(specification, values)
    with np.errstate(all="ignore"):  # unlawful rows are marked, not computed with
        w = _natural_frequencies(specification, field)
        most = specification.kind.damping.most
        z = field("plant", "damping_ratio", least=0.0, most=most)
        lags = np.stack([z, *_lags(specification, field, w)], axis=1)
        options = specification.options
        names = () if options is None else [one.name for one in fields(options)]
        if "max_duration_periods" in names:
            longest = field(
                "shaper",
                "max_duration_periods",
                least=MIN_HORIZON_PERIODS,
                most=MAX_HORIZON_PERIODS,
            )
        else:
            longest = MAX_PERIODS / np.sqrt(1 - z * z)
        workable = field.lawful & (w >= MIN_VALUE) & (w <= MAX_VALUE)
        for first, second in ((lags[:, 1], lags[:, 2]), (lags[:, 3], lags[:, 4])):
            workable &= (first <= SLOWEST) & (second <= SLOWEST**2)
            # 1/G at the plant's pole -z + j sqrt(1 - z^2).
            real = 1 - z * first + (2 * z * z - 1) * second
            turned = first - 2 * z * second
            workable &= real * real + (1 - z * z) * turned * turned >= RESONANCE**2
    return RowParameters(
        natural_frequencies_rad_s=w,
        lags=lags,
        max_duration_periods=longest,
        workable=workable,
    )


def _natural_frequencies(specification: TableSpecification, field: _Fields) -> FloatArray:
    if isinstance(specification.plant, Pendulum):
        length = field("plant", "cable_length_m")
        frequencies: FloatArray = np.sqrt(field("plant", "gravity_m_s2") / length)
        return frequencies
    return field("plant", "natural_frequency_rad_s")


def _lags(specification: TableSpecification, field: _Fields, w: FloatArray) -> list[FloatArray]:
    """Return ``first, second`` of either set at w = 1."""
    actuator = specification.actuator
    if isinstance(actuator, Ideal):
        return [np.zeros(w.size) for _ in range(4)]
    field("actuator", "dead_time_s", least=0.0)
    lags: list[FloatArray] = []
    for name in ("accel", "decel"):
        if isinstance(actuator, FirstOrder):
            lags += [field("actuator", f"{name}_time_constant_s", zero=True) * w, np.zeros(w.size)]
        else:
            corner = field("actuator", name, "natural_frequency_rad_s")
            damping = field(
                "actuator",
                name,
                "damping_ratio",
                least=MIN_LAG_DAMPING,
                most=MAX_LAG_DAMPING,
            )
            slowness = w / corner
            lags += [2 * damping * slowness, slowness * slowness]
    return lags


def of_one_mode_and_lags(specification: TableSpecification) -> bool:
    """Return whether `row_parameters` serves a table.

    It serves one mode and an actuator of lags, without further fields.
    """
    known = type(specification.actuator) in {Ideal, FirstOrder, SecondOrder}
    return known and type(specification.plant) in {Mode, Pendulum}
