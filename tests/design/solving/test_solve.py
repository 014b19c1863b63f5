"""Solutions have no impulse that is rounding, whatever solver they come from."""

import itertools
from typing import Any, get_args

import numpy as np
import pytest

from design.formulations.formulation import Formulation
from design.model.actuators.ideal import Ideal
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.pipeline import design
from design.shapers.negative import NegativeOptions
from design.shapers.positive import MzvOptions
from design.shapers.registry import SHAPERS
from design.solving.by_formulation import SOLVERS, solver_of
from design.solving.distinct_steps import distinct_steps

MIN_STEP_SHARE = 1e-12
"""Share of all steps' sizes that no step has to be below where no mode is damped [-]."""

HARMONICS = [
    *((1, odd) for odd in (3, 5, 7, 9, 11, 27)),
    *itertools.combinations((1, 3, 5, 9, 15), 3),
    (1, 3, 5, 7, 9, 11),
    (1, 2, 4),
    (1, 2, 4, 8),
]
"""Frequencies for which fewer impulses do than there are equations."""


@pytest.mark.parametrize("formulation", get_args(Formulation), ids=lambda cls: cls.__name__)
def test_every_formulation_has_its_solver(formulation: type) -> None:
    assert callable(solver_of(formulation))
    assert len(SOLVERS) == len(get_args(Formulation))


def _smallest(impulses: Impulses) -> float:
    sizes = np.abs(impulses.amplitudes)
    return float(sizes.min() / sizes.sum())


@pytest.mark.parametrize("kind", ["multi_zv", "multi_umzv", "convolved"])
@pytest.mark.parametrize("ratios", HARMONICS, ids=str)
def test_plants_of_harmonics_have_no_impulse_that_is_rounding(
    kind: str, ratios: tuple[int, ...]
) -> None:
    plant = Modes(modes=tuple(Mode(natural_frequency_rad_s=15.0 * one) for one in ratios))
    made = design(plant, Ideal(), SHAPERS[kind])
    assert made.certificate.verified
    assert _smallest(made.impulses) > MIN_STEP_SHARE
    assert np.diff(made.impulses.times_s).min() > 1e-6 * made.impulses.duration_s


@pytest.mark.parametrize("odd", [3, 5, 7, 9, 11, 27])
def test_two_impulses_serve_a_mode_and_its_odd_multiple(odd: int) -> None:
    """Half a period of the slower mode is an odd number of half periods of the faster."""
    plant = Modes(
        modes=(Mode(natural_frequency_rad_s=15.0), Mode(natural_frequency_rad_s=15.0 * odd))
    )
    made = design(plant, Ideal(), SHAPERS["multi_zv"]).impulses
    assert np.abs(made.times_s - [0, np.pi / 15]).max() < 1e-12
    assert np.abs(made.amplitudes - 0.5).max() < 1e-12


@pytest.mark.parametrize(
    ("kind", "options"),
    [("mzv", MzvOptions(n=3, t=0.5)), ("sna_zv", NegativeOptions(negative_amplitude=1e-17))],
)
def test_impulses_that_parameters_make_vanish_are_left_out(kind: str, options: Any) -> None:
    made = design(Mode(natural_frequency_rad_s=2.0), Ideal(), SHAPERS[kind], options).impulses
    assert made.times_s.size == 2
    assert np.abs(made.amplitudes - 0.5).max() < 1e-12


def test_steps_that_are_rounding_are_left_out_and_those_at_one_time_joined() -> None:
    given = Impulses(
        times_s=np.array([0.0, 1.0, 2.0, 2.0 + 1e-13, 3.0]),
        amplitudes=np.array([1e-17, 0.5, 0.25, 0.25, -3e-16]),
    )
    found = distinct_steps(given)
    assert np.abs(found.times_s - [0, 1]).max() < 1e-12
    assert np.abs(found.amplitudes - 0.5).max() < 1e-12


def test_small_steps_that_end_a_command_in_heavily_damped_modes_stay() -> None:
    """Without the last of them, 2e-14 of the command, 3e-7 would be left."""
    of_modes = ((1.848, 0.965), (3.0, 0.565), (5.57, 0.279), (9.059, 0.982))
    plant = Modes(
        modes=tuple(Mode(natural_frequency_rad_s=w, damping_ratio=z) for w, z in of_modes)
    )
    made = design(plant, Ideal(), SHAPERS["convolved"])
    assert made.certificate.verified
    assert made.impulses.times_s.size == 16
    assert _smallest(made.impulses) < 1e-12


def test_many_small_steps_that_are_together_more_than_rounding_stay() -> None:
    small = np.full(1000, 1e-16)
    amplitudes = np.concatenate(([0.5], small, [0.5 - small.sum()]))
    given = Impulses(times_s=np.linspace(0.0, 1.0, amplitudes.size), amplitudes=amplitudes)
    assert distinct_steps(given).times_s.size >= amplitudes.size - 10
