"""Unity magnitude for several modes behind a drive that brakes at another pace."""

import re
from dataclasses import replace

import numpy as np
import pytest

from design.errors import InfeasibleDesignError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.double_pendulum import DoublePendulum
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.registry import Plant
from design.pipeline import Design, design
from design.shapers.num_multi import SeveralModesOptions
from design.shapers.registry import SHAPERS
from tests.integration_route import residual_by_integration
from tests.refusals import refused
from tests.second_route import derivatives_by_series
from tests.shaper_table import CRANE, DAMPED, THESIS

SLUNG = DoublePendulum(
    hook_mass_kg=0.385,
    load_mass_kg=0.6,
    cable_length_m=0.8,
    load_length_m=0.25,
    gravity_m_s2=9.81,
)

SWITCHED = replace(THESIS, model="switched")
DRIVES: dict[Model, SecondOrder] = {"superposed": THESIS, "switched": SWITCHED}
FIRST = FirstOrder(accel_time_constant_s=0.05, decel_time_constant_s=0.02, model="switched")

SLOPE = SeveralModesOptions(slope=True)


def made(plant: Plant, actuator: Actuator, options: SeveralModesOptions | None = None) -> Design:
    return design(plant, actuator, SHAPERS["num_multi"], options)


def modes_of(*frequencies: float, damping: float = 0.0) -> Modes:
    return Modes(
        modes=tuple(Mode(natural_frequency_rad_s=one, damping_ratio=damping) for one in frequencies)
    )


def scaled(plant: Modes, drive: SecondOrder, scale: float) -> tuple[Modes, SecondOrder]:
    """Return the same plant and drive, so many times faster."""
    modes = tuple(
        replace(one, natural_frequency_rad_s=scale * one.natural_frequency_rad_s)
        for one in plant.modes
    )
    sets = [
        SecondOrderSet(
            natural_frequency_rad_s=scale * one.natural_frequency_rad_s,
            damping_ratio=one.damping_ratio,
        )
        for one in (drive.accel, drive.decel)
    ]
    return Modes(modes=modes), SecondOrder(accel=sets[0], decel=sets[1], model=drive.model)


@pytest.mark.parametrize(
    ("model", "times_s"),
    [
        ("superposed", [0.24151108, 0.37154208, 0.54229003, 0.74122034]),
        ("switched", [0.2421622, 0.37058803, 0.54579808, 0.74026527]),
    ],
)
def test_five_steps_stop_both_swings_of_a_load_below_a_hook(
    model: Model, times_s: list[float]
) -> None:
    found = made(SLUNG, DRIVES[model])
    assert found.impulses.amplitudes.tolist() == [1, -1, 1, -1, 1]
    # Figures of eight decimals.
    assert found.impulses.times_s[1:] == pytest.approx(times_s, abs=5e-9)
    assert found.residual <= 1e-10
    assert not found.for_ideal
    for mode in SLUNG.modes:
        # The integrator is asked for 1e-11.
        assert residual_by_integration(found.impulses, mode, DRIVES[model]) < 1e-8


@pytest.mark.parametrize(
    ("frequencies", "times_s"),
    [
        ((2.5, 6.5), [0.25429831, 0.54489017, 0.87566424, 1.08718357]),
        ((3.5, 9.4), [0.19249851, 0.3846448, 0.61716809, 0.76467128]),
        ((1.8, 4.2), [0.32782078, 0.80115463, 1.31475064, 1.6011675]),
        ((3.0, 4.0), [0.19197721, 0.66260612, 1.17525074, 1.32505793]),
    ],
)
def test_pairs_have_the_fastest_steps_of_four_hundred_starts(
    frequencies: tuple[float, float], times_s: list[float]
) -> None:
    found = made(modes_of(*frequencies), THESIS)
    assert found.impulses.times_s[1:] == pytest.approx(times_s, abs=1e-6)


@pytest.mark.parametrize(
    ("model", "left"), [("superposed", (0.117, 0.057)), ("switched", (0.135, 0.074))]
)
def test_steps_for_an_ideal_drive_leave_a_tenth_of_a_step_behind_a_real_one(
    model: Model, left: tuple[float, float]
) -> None:
    told = design(SLUNG, DRIVES[model], SHAPERS["multi_umzv"]).residuals
    assert told == pytest.approx(left, abs=5e-4)


@pytest.mark.parametrize(("model", "left"), [("superposed", 1.2057), ("switched", 1.1997)])
def test_steps_for_the_first_mode_leave_the_second_more_than_one_step(
    model: Model, left: float
) -> None:
    slow, fast = SLUNG.modes
    found = design(slow, DRIVES[model], SHAPERS["numzvd"]).impulses
    told = derivatives_by_series(found, fast, DRIVES[model], 0)[0]
    assert told == pytest.approx(left, abs=5e-5)


@pytest.mark.parametrize("drive", [FIRST, THESIS, SWITCHED, Ideal()], ids=repr)
@pytest.mark.parametrize("plant", [CRANE.mode, DAMPED], ids=repr)
def test_one_mode_has_the_steps_of_one_mode(plant: Mode, drive: Actuator) -> None:
    for options, single in ((None, "numzv"), (SLOPE, "numzvd")):
        found = made(plant, drive, options).impulses
        wanted = design(plant, drive, SHAPERS[single]).impulses
        assert found.times_s == pytest.approx(wanted.times_s, abs=1e-9)


@pytest.mark.parametrize("drive", [THESIS, SWITCHED], ids=["superposed", "switched"])
def test_slopes_vanish_too_where_they_are_asked_for(drive: SecondOrder) -> None:
    plain, flat = made(SLUNG, drive), made(SLUNG, drive, SLOPE)
    assert flat.impulses.times_s.size == 9
    assert flat.impulses.duration_s > plain.impulses.duration_s
    assert [one.quantity for one in flat.certificate.claims] == 2 * ["residual", "slope"]
    for mode in SLUNG.modes:
        residual, slope = derivatives_by_series(flat.impulses, mode, drive, 1)
        assert residual < 1e-9
        assert slope < 1e-7
        assert derivatives_by_series(plain.impulses, mode, drive, 1)[1] > 0.1


def test_behind_equal_sets_they_are_those_of_an_ideal_drive() -> None:
    """One lag is one factor of each mode, and no zero moves."""
    same = THESIS.accel
    alike = SecondOrder(accel=same, decel=same, model="switched")
    wanted = design(SLUNG, Ideal(), SHAPERS["multi_umzv"]).impulses
    for drive in (Ideal(), alike):
        assert made(SLUNG, drive).impulses.times_s == pytest.approx(wanted.times_s, abs=1e-9)


@pytest.mark.parametrize("model", DRIVES)
def test_neither_the_order_of_modes_nor_the_unit_of_time_matters(model: Model) -> None:
    plant, drive = modes_of(2.3, 7.1, damping=0.03), DRIVES[model]
    wanted = made(plant, drive).impulses.times_s
    turned = made(Modes(modes=plant.modes[::-1]), drive).impulses.times_s
    faster = made(*scaled(plant, drive, 8.0)).impulses.times_s
    assert turned == pytest.approx(wanted, abs=1e-10)
    assert faster == pytest.approx(wanted / 8, abs=1e-10)


@pytest.mark.parametrize("model", DRIVES)
@pytest.mark.parametrize("count", [3, 4, 6])
def test_more_modes_are_stopped_by_two_more_steps_each(count: int, model: Model) -> None:
    plant = modes_of(*(2.0, 5.0, 7.0, 10.0, 13.0, 17.0)[:count])
    found = made(plant, DRIVES[model])
    assert found.impulses.times_s.size == 2 * count + 1
    for mode in plant.modes:
        assert derivatives_by_series(found.impulses, mode, DRIVES[model], 0)[0] < 1e-9


def test_modes_far_apart_are_followed_from_an_ideal_drive() -> None:
    found = made(modes_of(1.04, 10.13), SWITCHED, SLOPE)
    assert found.solver.seed == "ideal_optimum"
    # From 1,024 starts over each duration the fastest takes 2.7 times as long.
    assert found.impulses.duration_s < 4.45


@pytest.mark.parametrize(
    "then", [Ideal(), THESIS, SWITCHED], ids=["ideal", "superposed", "switched"]
)
@pytest.mark.parametrize("options", [None, SLOPE], ids=["residual", "slope"])
def test_behind_limits_a_course_of_the_reference_does(
    then: Ideal | SecondOrder, options: SeveralModesOptions | None
) -> None:
    limited = RateLimited(accel_limit_m_s2=1.6, decel_limit_m_s2=2.5, speed_m_s=0.2, then=then)
    found = made(SLUNG, limited, options)
    assert found.certificate.verified
    claims = [one.quantity for one in found.certificate.claims]
    assert claims == (["residual"] if options is None else ["residual", "slope"]) * 2
    for mode in SLUNG.modes:
        assert residual_by_integration(found.impulses, mode, limited) < 1e-8


def test_no_gap_is_below_the_least_pulse() -> None:
    usual = made(SLUNG, THESIS).impulses
    assert np.diff(usual.times_s).min() == pytest.approx(0.130031, abs=1e-6)
    slower = made(SLUNG, THESIS, SeveralModesOptions(least_pulse_s=0.14)).impulses
    assert np.diff(slower.times_s).min() >= 0.14
    assert slower.duration_s > usual.duration_s
    fast = min(mode.period_s for mode in SLUNG.modes)
    told = made(SLUNG, THESIS, SeveralModesOptions(least_pulse_s=fast / 100)).impulses
    assert told.times_s.tolist() == usual.times_s.tolist()


def test_a_least_pulse_that_cannot_be_kept_is_refused_by_name() -> None:
    with refused("least_pulse_too_long", "shaper.least_pulse_s", says=r"below 1\.4813 s"):
        made(SLUNG, THESIS, SeveralModesOptions(least_pulse_s=1.5))
    with refused("out_of_range", "least_pulse_s"):
        SeveralModesOptions(least_pulse_s=-0.1)
    limited = RateLimited(accel_limit_m_s2=1.6, decel_limit_m_s2=2.5, speed_m_s=0.2)
    with refused("least_pulse_behind_limits", "shaper.least_pulse_s"):
        made(SLUNG, limited, SeveralModesOptions(least_pulse_s=0.1))


@pytest.mark.parametrize("model", DRIVES)
def test_slopes_of_three_modes_are_found_from_the_optimum_of_an_ideal_drive(model: Model) -> None:
    plant = modes_of(4.829, 5.787, 7.717)
    ideal = made(plant, Ideal(), SLOPE).impulses.duration_s
    found = made(plant, DRIVES[model], SLOPE)
    for mode in plant.modes:
        residual, slope = derivatives_by_series(found.impulses, mode, DRIVES[model], 1)
        assert residual < 1e-9
        assert slope < 1e-7
    # A switched drive has a solution near by; of superposed steps two would coincide there, and
    # the next solution takes 2.879 periods, as found from 1,024 starts over each duration.
    if model == "switched":
        assert found.impulses.duration_s == pytest.approx(ideal, rel=0.01)
    else:
        periods = found.impulses.duration_s * 4.829 / (2 * np.pi)
        assert periods < 2.8786


def test_where_a_longer_one_is_found_it_says_how_long() -> None:
    each = ((4.923, 0.075), (6.713, 0.028), (9.569, 0.0485))
    plant = Modes(modes=tuple(Mode(natural_frequency_rad_s=w, damping_ratio=z) for w, z in each))
    told = r"<= 3 periods in \d+ starts; nearest miss: .*; max_duration_periods = 3\.2"
    with refused("no_solution_found", says=told) as caught:
        made(plant, THESIS, SLOPE)
    (enough,) = re.findall(r"max_duration_periods = (3\.\d+) can be met", str(caught.value))
    options = SeveralModesOptions(slope=True, max_duration_periods=float(enough))
    assert made(plant, THESIS, options).certificate.verified


def test_where_none_is_found_it_says_how_far_was_searched() -> None:
    short = SeveralModesOptions(max_duration_periods=0.3)
    told = r"no ordered solution with duration <= 0\.3 periods in 192 starts; nearest miss: "
    with refused("no_solution_found", says=told) as caught:
        made(SLUNG, THESIS, short)
    assert isinstance(caught.value, InfeasibleDesignError)
