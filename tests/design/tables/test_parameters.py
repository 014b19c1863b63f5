"""Parameters of many rows are those of single designs."""

from dataclasses import replace

import numpy as np
import pytest

from design.analysis.workable import require_workable
from design.errors import InvalidInputError
from design.fields import Axis
from design.formulations.gaps import settling_gaps_rad
from design.formulations.lag_parameters import lag_parameters
from design.model.actuators.model import Model
from design.model.plants.pendulum import Pendulum
from design.shapers.settle_options import SettleOptions
from design.tables.kernel import rows_of_problems
from design.tables.parameters import row_parameters
from design.tables.specification import TableSpecification
from tests.shaper_table import CRANE, THESIS
from tests.table_cases import random_table

MODELS: tuple[Model, ...] = ("superposed", "switched")


@pytest.mark.parametrize("order", [0, 1, 2])
def test_rows_have_the_parameters_of_single_designs(order: int) -> None:
    table = random_table(50, 1, order=order)
    parameters = row_parameters(table, table.field_values(0, 50))
    assert parameters.workable.all()
    for row, values in enumerate(table.field_values(0, 50)):
        plant, actuator, _ = table.at(values)
        expected = lag_parameters(plant.mode, actuator)
        # A few roundings: squares and quotients are taken in another order.
        np.testing.assert_allclose(parameters.lags[row], expected, rtol=1e-15)
        assert parameters.natural_frequencies_rad_s[row] == plant.mode.natural_frequency_rad_s


def crane_table(*axes: Axis) -> TableSpecification:
    kind = random_table(1, 0, order=2).kind
    return TableSpecification(
        plant=CRANE, actuator=THESIS, kind=kind, options=SettleOptions(), axes=axes
    )


def test_a_pendulum_s_length_gravity_and_the_longest_shaper_may_vary() -> None:
    table = crane_table(
        Axis(path=("plant", "cable_length_m"), values=np.array([0.5, 0.8])),
        Axis(path=("plant", "gravity_m_s2"), values=np.array([1.62, 9.81])),
        Axis(path=("shaper", "max_duration_periods"), values=np.array([2.0, 5.0])),
    )
    values = table.field_values(0, 8)
    parameters = row_parameters(table, values)
    for row, (length, gravity, longest) in enumerate(values.tolist()):
        mode = Pendulum(cable_length_m=length, gravity_m_s2=gravity).mode
        assert parameters.natural_frequencies_rad_s[row] == mode.natural_frequency_rad_s
        np.testing.assert_allclose(parameters.lags[row], lag_parameters(mode, THESIS), rtol=1e-15)
        assert parameters.max_duration_periods[row] == longest


@pytest.mark.parametrize("order", [0, 1, 2])
def test_settling_takes_as_long_as_in_single_designs(order: int) -> None:
    table = random_table(50, 2, order=order)
    values = table.field_values(0, 50)
    parameters = row_parameters(table, values)
    rows = rows_of_problems(parameters.lags, parameters.max_duration_periods, settle=True)
    for row, one in enumerate(values):
        plant, actuator, _ = table.at(one)
        expected = settling_gaps_rad(plant.mode, actuator, 3, settle=True)
        np.testing.assert_allclose(rows[row, 5:7], expected, rtol=1e-11)  # bisected to 1e-12


def test_a_drive_out_of_proportion_to_its_plant_is_not_workable() -> None:
    """The same rows for which the single design refuses."""
    frequencies = np.geomspace(0.01, 1e5, 50)
    table = crane_table(
        Axis(path=("actuator", "accel", "natural_frequency_rad_s"), values=frequencies)
    )
    workable = row_parameters(table, table.field_values(0, 50)).workable
    for row, frequency in enumerate(frequencies.tolist()):
        accel = replace(THESIS.accel, natural_frequency_rad_s=frequency)
        try:
            require_workable(CRANE.mode, replace(THESIS, accel=accel))
        except InvalidInputError:
            assert not workable[row]
        else:
            assert workable[row]
    assert 0 < workable.sum() < 50


@pytest.mark.parametrize("value", [-0.1, 0.991, np.nan, np.inf])
def test_a_value_outside_its_rule_is_not_workable(value: float) -> None:
    table = random_table(3, 3, order=1)
    values = table.field_values(0, 3).copy()
    values[1, 1] = value
    assert row_parameters(table, values).workable.tolist() == [True, False, True]
