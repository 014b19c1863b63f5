"""What is proven of times between rows holds at every point, and is not much more than happens."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from design.export.lookup import LookupAxis, lookup_remarks, times_by_lookup
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.tables.coordinates import coordinates
from design.tables.interpolation import OneMode, actuator_at, interpolant, mode_of
from design.tables.proven_bound.bound import ResidualBound, residual_bound
from design.tables.proven_bound.chebyshev import between_zeros, truncation, zeros
from design.tables.proven_bound.stencils import GridAxis, cells_of
from design.tables.rows import subject_of
from design.types import BoolArray, FloatArray
from tests.design.export.test_lookup import TABLES, lookup, random_values, table
from tests.design.tables.proven_bound.random_tables import RandomTable, random_table
from tests.expm_route import outcome
from tests.second_route import claims_by_formula

RANDOM_POINTS = 10_000

BY_THE_OTHER_ROUTE = 20
"""Of the largest, found once more by a route that shares no code with the package."""


def bound_of(one: RandomTable, found: float = 0.0) -> ResidualBound:
    return residual_bound(
        one.axes,
        one.times_s,
        ~one.made.closed,
        one.made.plant,
        one.made.actuator,
        one.made.amplitudes,
        found,
    )


def times_of_a_program(one: RandomTable, points: FloatArray) -> FloatArray:
    axes = [LookupAxis(field=axis.field, name="one", values=axis.values) for axis in one.axes]
    return times_by_lookup(axes, one.times_s, points, np.float64)


def residual_once_more(one: RandomTable, point: FloatArray, times: FloatArray) -> float:
    frequency, damping = mode_of(one.made.plant, list(one.made.names), point[None])
    mode = Mode(natural_frequency_rad_s=float(frequency[0]), damping_ratio=float(damping[0]))
    actuator = actuator_at(one.made, point.tolist())
    command = Impulses(times_s=times, amplitudes=one.made.amplitudes)
    if actuator.model == "switched" or isinstance(actuator, RateLimited):
        return outcome(command, mode, actuator).residual
    return claims_by_formula(command, mode, actuator)["residual"]


@pytest.mark.parametrize("model", ["superposed", "switched"])
@pytest.mark.parametrize("seed", range(24))
def test_the_bound_holds_at_every_point_of_random_tables(model: Any, seed: int) -> None:
    random = np.random.default_rng([seed, model == "switched"])
    one = random_table(random, model)
    proven = bound_of(one)
    assert not proven.unproven.any()
    varied_drive = any(name.startswith("actuator") for name in one.made.names)
    points = one.points(random, RANDOM_POINTS // (10 if varied_drive else 1))
    times = times_of_a_program(one, points)
    residuals = one.made.residuals(points, times)
    assert residuals.max() <= proven.largest
    worst = np.argsort(residuals)[-BY_THE_OTHER_ROUTE:]
    again = [residual_once_more(one, points[row], times[row]) for row in worst.tolist()]
    assert max(again) <= proven.largest
    # Between two values of 10,000 there is little, on one axis or two.
    assert proven.largest <= 1.2 * residuals.max()


@pytest.mark.parametrize("model", ["superposed", "switched"])
@pytest.mark.parametrize("seed", range(8))
def test_behind_limits_it_holds_whichever_ramps_are_turned(model: Any, seed: int) -> None:
    random = np.random.default_rng([seed, 7, model == "switched"])
    one = random_table(random, model, limits=True)
    first = one.points(random, 300)
    known = float(one.made.residuals(first, times_of_a_program(one, first)).max())
    proven = bound_of(one, found=known)
    assert not proven.unproven.any()
    points = one.points(random, 1_000)
    times = times_of_a_program(one, points)
    residuals = one.made.residuals(points, times)
    worst = int(np.argmax(residuals))
    assert residuals[worst] <= proven.largest
    assert residual_once_more(one, points[worst], times[worst]) <= proven.largest
    assert proven.largest <= 1.5 * residuals[worst]


@pytest.mark.parametrize("which", TABLES)
def test_of_designs_the_bound_is_close_to_what_is_found(which: str) -> None:
    made = lookup(which)
    head, _ = table(which)
    subject = subject_of(head)
    assert isinstance(subject.plant, OneMode)
    axes = [GridAxis(field=axis.field, values=axis.values) for axis in made.axes]
    known = made.residual / 1.1
    proven = residual_bound(
        axes, made.times_s, made.usable, subject.plant, subject.actuator, made.amplitudes, known
    )
    assert not proven.unproven.any()
    rounding = 2e-12  # of terms whose sum is the residual
    assert proven.found <= proven.largest <= 1.1 * proven.found + rounding
    assert made.residual == pytest.approx(proven.largest, rel=0.1, abs=rounding)


@pytest.mark.parametrize("which", TABLES)
def test_cells_are_polynomials_of_what_programs_and_interpolants_compute(which: str) -> None:
    made = lookup(which)
    head, _ = table(which)
    plant, names = subject_of(head).plant, [axis.field for axis in made.axes]
    axes = [GridAxis(field=axis.field, values=axis.values) for axis in made.axes]
    points = random_values(which)
    frequencies, _ = mode_of(plant, names, points)
    found = [coordinates(axis.field, column) for axis, column in zip(axes, points.T, strict=True)]
    scales = [one for one, axis in zip(found, axes, strict=True) if axis.scales]
    scale = frequencies / np.prod(scales, axis=0) if scales else frequencies
    np.testing.assert_allclose(scale, scale[0], rtol=1e-14)
    cells = cells_of(axes, made.times_s, float(scale[0]), made.usable)
    assert made.usable.all()
    places = [
        np.clip(np.searchsorted(axis.values, column, side="right") - 1, 0, axis.values.size - 2)
        for axis, column in zip(axes, points.T, strict=True)
    ]
    those = cells.take(np.ravel_multi_index(places, made.usable.shape))
    u = (np.column_stack(found) - those.middles) / those.halves
    assert np.abs(u).max() <= 1
    powers = u[:, :, None] ** np.arange(4)
    across = powers[:, 1] if len(axes) > 1 else np.ones_like(powers[:, 0])
    phases = np.einsum("mnde,md,me->mn", those.phases, powers[:, 0], across)
    times = times_by_lookup(made.axes, made.times_s, points, np.float64)
    distance = np.abs(times * frequencies[:, None] - phases)
    assert np.all(distance <= those.off)
    assert those.off.max() < 1e-12
    np.testing.assert_allclose(
        interpolant(*table(which)).times_s(points), times, rtol=1e-13, atol=1e-13
    )
    # A half is the same polynomial about its own middle.
    halves = cells.halved()
    wholes, parts = cells.values(np.zeros(1)), halves.values(np.array([1.0, -1.0]))
    for whole, part in zip(wholes[0], parts[0], strict=True):
        ends = part.reshape(2 ** len(axes), len(whole), -1)
        nearest = np.abs(ends - whole).min(axis=2)
        assert np.all(nearest <= 1e-13 * (1 + np.abs(whole[:, 0])))


def test_a_spike_between_the_points_that_are_tried_is_bounded() -> None:
    # Two steps eight periods apart, more or less: at every eighth of the cell they cancel.
    axis = GridAxis(field="plant.natural_frequency_rad_s", values=np.array([1.0, 2.0]))
    times = np.array([[0.0, 16 * np.pi]] * 2)
    plant = Mode(natural_frequency_rad_s=1.0, damping_ratio=0.0)
    amplitudes = np.array([1.0, -1.0])
    tried = 1 + np.arange(9) / 8
    assert np.abs(1 - np.exp(-1j * tried * times[0, 1])).max() < 1e-12
    proven = residual_bound((axis,), times, np.array([True]), plant, Ideal(), amplitudes)
    assert not proven.unproven.any()
    assert 2 <= proven.largest < 2.1


def test_steps_that_may_change_places_are_not_proven() -> None:
    axis = GridAxis(field="plant.natural_frequency_rad_s", values=np.array([1.0, 2.0, 3.0, 4.0]))
    times = np.array([[0.0, gap, 2.0] for gap in (0.5, 0.01, 0.01, 0.5)])
    plant = Mode(natural_frequency_rad_s=1.0, damping_ratio=0.0)
    usable = np.ones(3, dtype=np.bool_)
    proven = residual_bound((axis,), times, usable, plant, Ideal(), np.array([1.0, -1.0, 1.0]))
    # The cubic through the phases 0.5, 0.02, 0.03, 2 goes below 0.
    assert proven.unproven.any()
    nothing = residual_bound((axis,), times * 0, usable, plant, Ideal(), np.array([1.0, -1.0, 1.0]))
    assert nothing.unproven.all()
    assert nothing.largest == 0


def test_a_polynomial_is_not_larger_between_the_zeros_than_is_said() -> None:
    random = np.random.default_rng(54)
    dense = np.cos(np.linspace(0, np.pi, 4001))
    for degree, count in ((3, 6), (5, 7), (8, 9), (10, 80)):
        coefficients = random.normal(size=(200, degree + 1, 2)) @ [1, 1j]
        chebyshev = np.polynomial.chebyshev.chebval
        at_zeros = np.abs(chebyshev(zeros(count), coefficients.T)).max(axis=1)
        largest = np.abs(chebyshev(dense, coefficients.T)).max(axis=1)
        assert np.all(largest <= between_zeros(degree, count, 1) * at_zeros)
    # Chebyshev's own polynomial, seen at the zeros of one of a multiple degree, is the worst.
    worst = np.abs(np.cos(4 * np.arccos(zeros(8)))).max()
    assert between_zeros(4, 8, 1) == pytest.approx(1 / worst, rel=1e-12)


def test_what_polynomials_lack_is_within_the_tail() -> None:
    u = np.cos(np.linspace(0, np.pi, 400))
    chebyshev = np.polynomial.chebyshev.chebval
    for pole in (1.5, 2.0, 5.0):
        # Of 1 / (pole - u) the coefficients are a geometric series (Trefethen 2013, chapter 8).
        root = np.sqrt(pole**2 - 1)
        series = 2 / root * (pole + root) ** -np.arange(80.0)
        series[0] /= 2
        np.testing.assert_allclose(chebyshev(u, series), 1 / (pole - u), rtol=1e-12)
        reach = np.array([[0.9 * pole]])
        largest = np.array([1 / (0.1 * pole)])
        for degree in (3, 8, 22):
            here = chebyshev(u, series[: degree + 1])
            lacking = np.abs(1 / (pole - u) - here).max()
            assert lacking <= truncation(largest, reach, degree)[0] + 1e-14
            across = np.abs(np.outer(1 / (pole - u), 1 / (pole - u)) - np.outer(here, here)).max()
            tail = truncation(largest**2, np.hstack((reach, reach)), degree)[0]
            assert across <= tail + 1e-13


def test_a_head_says_what_is_proven_and_what_is_sampled() -> None:
    proven = lookup("two")
    assert not proven.unproven.any()
    some = np.zeros_like(proven.usable)
    some.flat[0] = True

    def head(unproven: BoolArray, *, in_single: bool = False) -> str:
        return " ".join(
            lookup_remarks(replace(proven, unproven=unproven), "crane", in_single=in_single)
        )

    assert "it is proven for every value there" in head(proven.unproven)
    assert "sampled" not in head(proven.unproven)
    assert "what single precision adds is sampled" in head(proven.unproven, in_single=True)
    assert "it is proven in 31 of 32 cells between rows, and sampled in the others" in head(some)
    assert "it is sampled, not proven between these points" in head(proven.usable)
