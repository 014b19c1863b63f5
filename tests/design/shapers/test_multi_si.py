"""Bands around several modes: theory, bounds that nothing beats, a formulation by CVXPY."""

import importlib
import math
from typing import Any

import numpy as np
import pytest

from design.errors import InfeasibleDesignError
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.pipeline import Design, design
from design.shapers.multi_si import BandsOptions
from design.shapers.registry import SHAPERS
from design.shapers.specified_insensitivity import BandOptions
from design.types import FloatArray
from tests.integration_route import residual_by_integration
from tests.refusals import refused
from tests.shaper_table import FIRST_ORDER, IDEAL, THESIS

Case = tuple[Modes, tuple[float, ...], float]


def plant_of(*frequencies: float, damping: tuple[float, ...] | None = None) -> Modes:
    ratios = (0.0,) * len(frequencies) if damping is None else damping
    return Modes(
        modes=tuple(
            Mode(natural_frequency_rad_s=one, damping_ratio=z)
            for one, z in zip(frequencies, ratios, strict=True)
        )
    )


PAIR = plant_of(2 * math.pi, 2 * math.pi * 2.7)
"""1 and 2.7 Hz."""


def made(plant: Modes | Mode = PAIR, actuator: Any = IDEAL, **options: Any) -> Design:
    return design(plant, actuator, SHAPERS["multi_si"], BandsOptions(**options))


def of_one(mode: Mode, **options: Any) -> Design:
    return design(mode, IDEAL, SHAPERS["si"], BandOptions(**options))


def left(times_s: FloatArray, amplitudes: FloatArray, mode: Mode, ratios: FloatArray) -> FloatArray:
    """|sum A exp(s (t_n - t))|: the definition, ideal actuator."""
    turned = np.exp(np.multiply.outer(mode.pole_rad_s * ratios, times_s[-1] - times_s))
    found: FloatArray = np.abs(turned @ amplitudes)
    return found


def random_cases(count: int, seed: int) -> list[Case]:
    rng = np.random.default_rng(seed)
    cases: list[Case] = []
    for number in range(count):
        modes = 2 + number % 2
        spread = np.cumprod(
            np.append(1.0, rng.uniform(1.05, 3.5 if modes == 2 else 2.2, modes - 1))
        )
        # Symmetric problems have the most degenerate optima.
        damping = rng.uniform(0, 0.1, modes) * (number % 3 > 0)
        halves = tuple(rng.uniform(0.03, 0.25, modes).tolist())
        frequencies = (rng.uniform(1.0, 5.0) * spread).tolist()
        plant = plant_of(*frequencies, damping=tuple(damping.tolist()))
        cases.append((plant, halves, float(rng.uniform(0.02, 0.1))))
    return cases


@pytest.mark.parametrize("options", [{}, {"half_width": 0.3}, {"amplitudes": "negative"}])
def test_one_mode_has_the_shaper_of_one_mode(options: Any) -> None:
    mode = Mode(natural_frequency_rad_s=3.0, damping_ratio=0.04)
    wanted = of_one(mode, **options).impulses
    found = made(mode, **options).impulses
    assert found.times_s.tolist() == wanted.times_s.tolist()
    assert found.amplitudes.tolist() == wanted.amplitudes.tolist()


@pytest.mark.parametrize("damping", [0.0, 0.05])
def test_bands_that_overlap_are_one_band(damping: float) -> None:
    """Modes of one damping ratio have their poles on one line."""
    plant = plant_of(1.0, 1.1, 1.3, damping=(damping,) * 3)
    wanted = of_one(plant.modes[0], lower_ratio=0.85, upper_ratio=1.3 * 1.15)
    found = made(plant)
    assert found.impulses.times_s == pytest.approx(wanted.impulses.times_s, rel=1e-9)
    assert [claim.mode for claim in found.certificate.claims] == [0, 1, 2]


def test_bands_that_nearly_coincide_are_kept_apart() -> None:
    plant = plant_of(1.0, 1.1, damping=(0.02, 0.0201))
    alike = plant_of(1.0, 1.1, damping=(0.02, 0.02))
    found, wanted = made(plant), made(alike)
    assert found.solver.gap is not None
    assert found.solver.gap <= 1e-4
    assert found.impulses.duration_s == pytest.approx(wanted.impulses.duration_s, rel=1e-3)


def test_random_bands_are_kept_at_20000_points_and_nothing_convolved_is_faster() -> None:
    rng = np.random.default_rng(12)
    for plant, halves, tolerance in random_cases(60, seed=4):
        found = made(plant, half_widths=halves, tolerance=tolerance)
        impulses, solver = found.impulses, found.solver
        assert found.certificate.verified
        assert [claim.quantity for claim in found.certificate.claims] == ["band"] * len(halves)
        assert (impulses.amplitudes > 0).all()
        assert impulses.amplitudes.sum() == pytest.approx(1, abs=1e-14)
        worst = []
        assert solver.lower_bound_s is not None
        assert solver.gap is not None
        assert solver.gap <= 1e-4
        squeezed = impulses.times_s * (solver.lower_bound_s / impulses.duration_s * (1 - 1e-6))
        squeezed[1:-1] += rng.normal(0, 1e-6, squeezed.size - 2)
        for mode, half in zip(plant.modes, halves, strict=True):
            ratios = np.linspace(1 - half, 1 + half, 20_000)
            # A peak between two of these is higher by less than (h / 10,000)^2 (w t)^2 / 8.
            assert left(impulses.times_s, impulses.amplitudes, mode, ratios).max() <= tolerance
            worst.append(left(squeezed, impulses.amplitudes, mode, ratios).max())
        # Below the bound a band must break: else the bound were wrong.
        assert max(worst) > tolerance
        # Shapers of the single modes keep all bands, convolved, and last as long as all together.
        convolved_s = sum(
            of_one(mode, half_width=half, tolerance=tolerance).impulses.duration_s
            for mode, half in zip(plant.modes, halves, strict=True)
        )
        assert impulses.duration_s <= convolved_s * (1 + 1e-9)


@pytest.mark.parametrize("levels", [(0.0, 1.0), (-0.5, 1.3)])
def test_random_bands_within_limits_of_the_command(levels: tuple[float, float]) -> None:
    for plant, halves, tolerance in random_cases(12, seed=6):
        found = made(
            plant,
            half_widths=halves,
            tolerance=tolerance,
            amplitudes="negative",
            lowest_command=levels[0],
            highest_command=levels[1],
        )
        command = np.cumsum(found.impulses.amplitudes)
        assert command.min() >= levels[0] - 1e-14
        assert command.max() <= levels[1] + 1e-14
        for mode, half in zip(plant.modes, halves, strict=True):
            ratios = np.linspace(1 - half, 1 + half, 20_000)
            impulses = found.impulses
            assert left(impulses.times_s, impulses.amplitudes, mode, ratios).max() <= tolerance
        assert found.solver.gap is not None
        assert found.solver.gap <= 1e-4
        positive = made(plant, half_widths=halves, tolerance=tolerance)
        assert found.impulses.duration_s < positive.impulses.duration_s


def by_cvxpy(case: Case, lags: FloatArray, *, positive: bool) -> float:
    """Return the least largest residual over a grid of the bands, as CVXPY is told of it."""
    cp: Any = importlib.import_module("cvxpy")  # its own types leave half of it out
    plant, halves, _ = case
    poles = [
        mode.pole_rad_s * np.linspace(1 - half, 1 + half, 61)
        for mode, half in zip(plant.modes, halves, strict=True)
    ]
    turned = np.exp(np.multiply.outer(np.concatenate(poles), lags))
    steps = cp.Variable(lags.size)
    limits = [cp.sum(steps) == 1]
    if positive:
        limits.append(steps >= 0)
    else:
        # The command goes from the longest lag to 0; after the last step it is 1.
        command = cp.cumsum(steps[::-1])
        limits += [command[:-1] >= 0, command[:-1] <= 1]
    parts = cp.vstack([turned.real @ steps, turned.imag @ steps])
    program = cp.Problem(cp.Minimize(cp.max(cp.norm(parts, 2, axis=0))), limits)
    program.solve(solver=cp.CLARABEL)
    return float(program.value)


@pytest.mark.parametrize("positive", [True, False])
@pytest.mark.parametrize("case", random_cases(3, seed=9))
def test_cvxpy_on_a_fine_grid_agrees(case: Case, *, positive: bool) -> None:
    plant, halves, tolerance = case
    found = made(
        plant,
        half_widths=halves,
        tolerance=tolerance,
        amplitudes="positive" if positive else "negative",
    )
    own = found.impulses.duration_s - found.impulses.times_s
    lags = np.union1d(np.linspace(0, found.impulses.duration_s, 200), own)
    # With the impulses among its points the grid reaches the tolerance, and hardly less: what
    # it gains is that its frequencies miss the peaks, by (h / 60)^2 (w t)^2 / 2 at most.
    least = by_cvxpy(case, lags, positive=positive)
    assert 1 - 1e-2 <= least / tolerance <= 1 + 1e-6
    # A per cent shorter it cannot.
    assert by_cvxpy(case, 0.99 * lags, positive=positive) > tolerance


def test_neither_the_order_of_modes_nor_the_unit_of_time_matters() -> None:
    plant = plant_of(2.0, 5.4, damping=(0.02, 0.01))
    wanted = made(plant, half_widths=(0.1, 0.2)).impulses
    turned = made(Modes(modes=plant.modes[::-1]), half_widths=(0.2, 0.1)).impulses
    faster = made(plant_of(20.0, 54.0, damping=(0.02, 0.01)), half_widths=(0.1, 0.2)).impulses
    assert turned.times_s == pytest.approx(wanted.times_s, abs=1e-9)
    assert faster.times_s == pytest.approx(wanted.times_s / 10, abs=1e-10)


def test_wider_bands_or_a_tighter_tolerance_take_longer() -> None:
    base = made(half_width=0.1).impulses.duration_s
    for wider in ((0.15, 0.1), (0.1, 0.15)):
        assert made(half_widths=wider).impulses.duration_s > base
    assert made(half_width=0.1, tolerance=0.04).impulses.duration_s > base
    for single in PAIR.modes:
        assert of_one(single, half_width=0.1).impulses.duration_s < base


def test_ways_to_say_bands_are_alike() -> None:
    wanted = made(half_width=0.15).impulses.times_s.tolist()
    assert made().impulses.times_s.tolist() == wanted
    assert made(half_widths=(0.15, 0.15)).impulses.times_s.tolist() == wanted
    ends = made(lower_ratios=(0.85, 0.85), upper_ratios=(1.15, 1.15)).impulses.times_s
    assert ends.tolist() == wanted
    assert made(lower_ratio=0.85, upper_ratio=1.15).impulses.times_s.tolist() == wanted


@pytest.mark.parametrize("actuator", [FIRST_ORDER, THESIS], ids=["first_order", "second_order"])
def test_positive_shapers_hold_behind_every_actuator(actuator: Any) -> None:
    found = made(actuator=actuator)
    assert found.impulses.times_s.tolist() == made().impulses.times_s.tolist()
    assert found.certificate.verified
    for mode in PAIR.modes:
        for ratio in (0.85, 1.0, 1.15):
            moved = Mode(natural_frequency_rad_s=ratio * mode.natural_frequency_rad_s)
            told = residual_by_integration(found.impulses, moved, actuator)
            # A drive of 20 rad/s is no tenth as fast as the swing: where the integration ends it
            # moves by some 1e-7 yet.
            assert told <= 0.05 + 1e-6


def test_six_modes_are_served() -> None:
    found = made(plant_of(2.0, 5.0, 7.0, 10.0, 13.0, 17.0, damping=(0.02,) * 6))
    assert found.certificate.verified
    assert len(found.certificate.claims) == 6
    assert found.solver.gap is not None
    assert found.solver.gap <= 1e-4


def test_both_signs_behind_an_asymmetric_actuator_are_refused() -> None:
    with refused("sets_differ", "shaper.amplitudes"):
        made(actuator=THESIS, amplitudes="negative")


@pytest.mark.parametrize(
    ("options", "code", "field"),
    [
        ({"half_widths": (0.1, 1.0)}, "out_of_range", "half_widths.1"),
        ({"half_widths": (math.nan,)}, "out_of_range", "half_widths.0"),
        ({"half_width": 0.1, "half_widths": (0.1, 0.1)}, "band_said_twice", "half_widths"),
        (
            {"lower_ratio": 0.9, "upper_ratio": 1.1, "half_widths": (0.1,)},
            "band_said_twice",
            "half_widths",
        ),
        (
            {"lower_ratio": 0.9, "upper_ratio": 1.1, "lower_ratios": (0.9,)},
            "band_said_twice",
            "lower_ratios",
        ),
        ({"lower_ratios": (0.9,)}, "band_half_said", "upper_ratios"),
        ({"upper_ratios": (1.1,)}, "band_half_said", "lower_ratios"),
        (
            {"lower_ratios": (0.9, 0.9), "upper_ratios": (1.1,)},
            "bands_differ_in_number",
            "upper_ratios",
        ),
        (
            {"lower_ratios": (0.9, 0.9), "upper_ratios": (1.1, 0.8)},
            "band_too_narrow_or_wide",
            "upper_ratios.1",
        ),
    ],
)
def test_bands_that_make_no_sense_are_refused(options: Any, code: str, field: str) -> None:
    with refused(code, field):
        BandsOptions(**options)


def test_bands_of_more_modes_or_of_fewer_are_refused() -> None:
    with refused("bands_of_other_modes", "shaper.half_widths", says="2 in all, got .0.1"):
        made(half_widths=(0.1,))
    with refused("bands_of_other_modes", "shaper.lower_ratios"):
        made(lower_ratios=(0.9,) * 3, upper_ratios=(1.1,) * 3)


def test_a_duration_too_short_is_named_with_what_can_be_met_instead() -> None:
    told = r"0\.9 is too short for a residual within 0\.05 over a band of each of 2 modes"
    with refused("duration_below_fastest", says=told) as caught:
        made(max_duration_periods=0.9)
    instead = str(caught.value).split("max_duration_periods = ")[2]
    longer, tolerance = (float(part.split()[0]) for part in instead.split("or a tolerance of "))
    assert made(max_duration_periods=longer).impulses.duration_s <= longer
    assert made(max_duration_periods=0.9, tolerance=tolerance).impulses.duration_s <= 0.9


def test_modes_too_far_apart_for_one_search_are_refused() -> None:
    with refused("modes_too_far_apart", says=r"211 half periods .* the limit is 50") as caught:
        made(plant_of(1.0, 100.0))
    assert isinstance(caught.value, InfeasibleDesignError)
    assert made(plant_of(1.0, 22.0)).certificate.verified
