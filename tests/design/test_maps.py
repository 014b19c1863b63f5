"""Maps against single cells."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from design.actuators import SecondOrder
from design.analysis.residual import residual_vibration, residuals_of_cases
from design.errors import InvalidInputError
from design.maps import Axis, residual_map, varied
from design.pictures.design_sheet import figure_bytes
from design.pictures.map_sheet import map_sheet
from design.pipeline import design
from design.plants import Pendulum
from design.shapers.registry import SHAPERS
from tests.design.test_switched import SWITCHED, random_case
from tests.shaper_table import CRANE, THESIS

LENGTH = Axis(path=("plant", "cable_length_m"), values=np.linspace(0.5, 1.2, 7))
CORNER = Axis(
    path=("actuator", "accel", "natural_frequency_rad_s"), values=np.linspace(12.0, 40.0, 5)
)


@pytest.mark.parametrize("model", ["superposed", "switched"])
@pytest.mark.parametrize("seed", range(60))
def test_many_cases_at_once_are_each_alone(seed: int, model: str) -> None:
    command, mode, actuator = random_case(seed)
    changed: Any = {"model": model}
    actuator = replace(actuator, **changed)
    lags = (actuator.accel_lag, actuator.decel_lag)
    told = residuals_of_cases(
        command,
        np.array([mode.pole_rad_s] * 2),
        np.array([[lag.first_s for lag in lags]] * 2),
        np.array([[lag.second_s2 for lag in lags]] * 2),
        actuator.model,
    )
    alone = residual_vibration(command, mode, actuator)
    assert told == pytest.approx([alone, alone], abs=1e-12)  # rounding


@pytest.mark.parametrize("actuator", [THESIS, SWITCHED], ids=["superposed", "switched"])
def test_a_held_shaper_is_judged_in_each_cell(actuator: SecondOrder) -> None:
    shaper = design(CRANE, actuator, SHAPERS["numzvd"]).impulses
    found = residual_map(CRANE, actuator, shaper, CORNER, LENGTH).residuals
    assert found.shape == (7, 5)
    for row, length in enumerate(LENGTH.values.tolist()):
        for column, corner in enumerate(CORNER.values.tolist()):
            plant = Pendulum(cable_length_m=length, gravity_m_s2=CRANE.gravity_m_s2)
            drive = replace(actuator, accel=replace(actuator.accel, natural_frequency_rad_s=corner))
            expected = residual_vibration(shaper, plant.mode, drive)
            assert found[row, column] == pytest.approx(expected, abs=1e-13)


def test_a_shaper_designed_anew_leaves_nothing_in_any_cell() -> None:
    kind = SHAPERS["numzv"]
    anew = residual_map(CRANE, THESIS, (kind, kind.options()), CORNER, LENGTH).residuals
    assert np.all(anew < 1e-12)


def test_one_that_knows_no_actuator_leaves_more_behind_a_slower_one() -> None:
    # Kim 2011, fig. 3-18: the difference of the two sets is what matters.
    kind = SHAPERS["umzv"]
    left = residual_map(CRANE, THESIS, (kind, kind.options()), CORNER, LENGTH).residuals
    assert np.all(np.diff(left[:, :3], axis=1) < 0)


def test_a_cell_without_a_shaper_is_not_a_number() -> None:
    kind = SHAPERS["numzvd"]
    short = kind.options(max_duration_periods=0.735)  # about the crane's own, 0.736
    found = residual_map(CRANE, THESIS, (kind, short), CORNER, LENGTH).residuals
    assert np.isnan(found).any()
    assert not np.isnan(found).all()


def test_a_number_is_replaced_by_its_path_and_no_other() -> None:
    changed = varied(THESIS, ("decel", "damping_ratio"), 0.9)
    assert changed == replace(THESIS, decel=replace(THESIS.decel, damping_ratio=0.9))


@pytest.mark.parametrize(
    ("path", "message"),
    [
        (("mass_kg",), r"^field must be one of cable_length_m, damping_ratio, gravity_m_s2, got"),
        (("cable_length_m", "x"), r"^field must be one of none, got"),
    ],
)
def test_a_field_that_is_not_there_is_refused(path: tuple[str, ...], message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        varied(CRANE, path, 1.0)


def test_words_are_no_numbers() -> None:
    with pytest.raises(InvalidInputError, match=r"^field must be the name of a number"):
        varied(THESIS, ("model",), 1.0)


def test_two_axes_over_one_field_and_a_map_too_large_are_refused() -> None:
    shaper = design(CRANE, THESIS, SHAPERS["numzv"]).impulses
    with pytest.raises(InvalidInputError, match=r"^y\.field must be another field than that of x"):
        residual_map(CRANE, THESIS, shaper, LENGTH, LENGTH)
    wide = Axis(path=LENGTH.path, values=np.linspace(0.5, 1.0, 2000))
    deep = Axis(path=CORNER.path, values=np.linspace(10, 20, 2000))
    with pytest.raises(InvalidInputError, match=r"of a map of at most 20000 cells"):
        residual_map(CRANE, THESIS, shaper, wide, deep)


def test_a_picture_of_a_map_has_units_and_equal_bytes() -> None:
    shaper = design(CRANE, THESIS, SHAPERS["numzvd"]).impulses
    found = residual_map(CRANE, THESIS, shaper, CORNER, LENGTH)
    figure = map_sheet("numzvd", CORNER, LENGTH, found)
    assert figure.axes[0].get_xlabel() == "accel natural frequency [rad/s]"
    assert figure.axes[0].get_ylabel() == "cable length [m]"
    first, second = (
        figure_bytes(map_sheet("numzvd", CORNER, LENGTH, found), "png") for _ in range(2)
    )
    assert first == second
