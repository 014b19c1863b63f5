"""Sensitivity curves and the edges of insensitivity."""

import math

import numpy as np
import pytest

from design.analysis.insensitivity import RATIO_LIMITS, Insensitivity, insensitivity
from design.analysis.residual import residual_vibration
from design.analysis.residuals_of_many import residual_curve
from design.analysis.sensitivity import SensitivityRange, sensitivity
from design.analysis.worst_mode import common_interval
from design.errors import InvalidInputError
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.types import FloatArray
from tests.refusals import refused
from tests.second_route import claims_by_formula
from tests.shaper_table import CRANE, FIRST_ORDER, IDEAL, THESIS

UNIT = Mode(natural_frequency_rad_s=1.0)


def impulses(times: list[float] | FloatArray, amplitudes: list[float] | FloatArray) -> Impulses:
    return Impulses(times_s=np.array(times), amplitudes=np.array(amplitudes))


ZV = impulses([0.0, math.pi], [0.5, 0.5])


def found(command: Impulses, mode: Mode, actuator: Actuator, tolerance: float) -> Insensitivity:
    result = insensitivity(command, mode, actuator, tolerance)
    assert result is not None
    return result


STEP = 2e-5
"""Between two points of the dense scan."""
DENSE = np.arange(STEP, 2.5, STEP)


def edges(curve: FloatArray, tolerance: float) -> tuple[float, float]:
    """Edges by looking at every point of a curve over `DENSE`."""
    outside = curve > tolerance * (1 + 1e-9)
    below, above = DENSE[outside & (DENSE < 1)], DENSE[outside & (DENSE > 1)]
    return (
        float(below[-1]) if below.size else 0.0,
        float(above[0]) if above.size else math.inf,
    )


@pytest.mark.parametrize("tolerance", [1e-3, 0.05, 0.1, 0.5, 0.99])
def test_the_edges_of_zv_have_a_closed_form(tolerance: float) -> None:
    # |cos(pi r / 2)| = V on either side of 1.
    result = found(ZV, UNIT, IDEAL, tolerance)
    reach = 2 / math.pi * math.asin(tolerance * (1 + 1e-9))
    assert result.lower_ratio == pytest.approx(1 - reach, abs=1e-12)  # root-found to 1e-13
    assert result.upper_ratio == pytest.approx(1 + reach, abs=1e-12)
    assert result.width == result.searched_to_ratio - result.searched_from_ratio
    assert result.tolerance == tolerance


def test_the_residual_at_an_edge_is_the_tolerance() -> None:
    shaper = design(CRANE, THESIS, SHAPERS["numzvd"]).impulses
    result = found(shaper, CRANE.mode, THESIS, 0.05)
    for edge in (result.lower_ratio, result.upper_ratio):
        assert edge is not None
        at_edge = claims_by_formula(shaper, CRANE.mode, THESIS, edge)["residual"]
        assert at_edge == pytest.approx(0.05, rel=2e-9)  # the margin, once


def test_there_is_no_interval_where_the_nominal_exceeds_the_tolerance() -> None:
    shaper = design(CRANE, THESIS, SHAPERS["umzvd"]).impulses  # leaves 2.45 % behind the thesis's
    assert insensitivity(shaper, CRANE.mode, THESIS, 0.024) is None
    assert insensitivity(shaper, CRANE.mode, THESIS, 0.025) is not None


@pytest.mark.parametrize("tolerance", [0.02, 0.05, 0.1])
def test_a_shaper_made_to_touch_the_tolerance_at_the_nominal_has_its_interval(
    tolerance: float,
) -> None:
    v = tolerance
    ei = impulses([0, math.pi, 2 * math.pi], [(1 + v) / 4, (1 - v) / 2, (1 + v) / 4])
    result = found(ei, UNIT, IDEAL, tolerance)
    # |(1 + V)/2 cos(pi r) + (1 - V)/2| = V where cos = -(1 - 3 V)/(1 + V): r = 1 ± acos(...)/pi.
    reach = math.acos((1 - 3 * v) / (1 + v)) / math.pi
    # The margin of 1e-9 moves an edge by itself over the slope there, below 1.
    assert result.upper_ratio == pytest.approx(1 + reach, abs=1e-9)
    assert result.lower_ratio == pytest.approx(1 - reach, abs=1e-9)


@pytest.mark.parametrize("margin", [1e-2, 1e-4, 1e-6, 1e-8])
def test_a_hump_that_only_just_passes_the_tolerance_ends_the_interval(margin: float) -> None:
    # Steps .2 .3 .3 .2 half a period apart: |V| = |c (1.6 c^2 - .6)| with c = cos(pi r / 2). Its
    # first humps are at c^2 = 1/8, 0.4 / sqrt(8) high; at margin 1e-8 they are 2e-4 wide.
    command = impulses(math.pi * np.arange(4.0), [0.2, 0.3, 0.3, 0.2])
    top = 0.4 * math.sqrt(1 / 8)
    for tolerance in (top * (1 - margin), top * (1 + margin)):
        limit = tolerance * (1 + 1e-9)
        either_sign = [np.roots([1.6, 0.0, -0.6, sign * limit]) for sign in (1, -1)]
        crossings = np.concatenate(either_sign)
        first = min(c.real for c in crossings if abs(c.imag) < 1e-12 and c.real > 0)
        reach = 2 / math.pi * math.asin(first)
        result = found(command, UNIT, IDEAL, tolerance)
        # A hump's shoulder is flat: rounding moves its crossing by 1e-16 over a slope of 1e-4.
        assert result.upper_ratio == pytest.approx(1 + reach, abs=1e-9)
        assert result.lower_ratio == pytest.approx(1 - reach, abs=1e-9)


@pytest.mark.parametrize("seed", range(40))
def test_edges_are_those_of_a_dense_scan_for_any_command(seed: int) -> None:
    random = np.random.default_rng(seed)
    count = int(random.integers(2, 7))
    times = np.sort(random.uniform(0, 12, count))
    weights = random.dirichlet(np.ones(count))
    signs = random.choice([-1.0, 1.0], count) if seed % 2 else np.ones(count)
    command = impulses(times, weights * signs)
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=random.uniform(0, 0.3))
    actuators: tuple[Actuator, ...] = (IDEAL, FIRST_ORDER, THESIS)
    actuator = actuators[seed % 3]
    nominal = residual_vibration(command, mode, actuator)
    # Tolerances at random, and a hair to either side of every local maximum of the curve: the
    # narrowest peaks there are.
    curve = residual_curve(command, mode, actuator, DENSE)
    tops = curve[1:-1][(curve[1:-1] > curve[:-2]) & (curve[1:-1] > curve[2:])]
    tolerances = [random.uniform(0.02, 0.9)]
    tolerances += [top * (1 + hair) for top in tops.tolist() for hair in (-1e-3, -1e-4, 1e-4)]
    for tolerance in tolerances:
        if nominal <= tolerance < 1:
            low, high = edges(curve, tolerance)
            result = found(command, mode, actuator, tolerance)
            if low > 0.05:  # nearer to 0 than a step of the search is another test's matter
                assert result.lower_ratio == pytest.approx(low, abs=2 * STEP)
            if math.isfinite(high):
                assert result.upper_ratio == pytest.approx(high, abs=2 * STEP)
            else:
                assert result.searched_to_ratio > 2.5 - 2 * STEP


# Steps of 0.3 and 0.3 sum to 0.6 at most; 1 and 20 turns apart, and together.
@pytest.mark.parametrize("times", [[0.0], [0.0, 1.0], [0.0, 2 * math.pi], [0.0, 40 * math.pi]])
@pytest.mark.parametrize("actuator", [IDEAL, FIRST_ORDER], ids=lambda drive: drive.kind)
def test_an_edge_that_is_none_is_told_as_none(times: list[float], actuator: Actuator) -> None:
    result = found(impulses(times, [0.3] * len(times)), UNIT, actuator, 0.7)
    assert (result.lower_ratio, result.upper_ratio, result.width) == (None, None, None)
    assert (result.searched_from_ratio, result.searched_to_ratio) == RATIO_LIMITS


def test_a_long_search_without_an_edge_says_where_it_ended() -> None:
    # Of steps through either set nothing is proven; 20 turns are looked at for 20,000 points.
    command = impulses([0.0, 40 * math.pi], [0.4, -0.2])
    result = found(command, UNIT, FIRST_ORDER, 0.9)
    assert (result.lower_ratio, result.upper_ratio, result.width) == (None, None, None)
    assert result.searched_from_ratio == RATIO_LIMITS[0]
    assert 15 < result.searched_to_ratio < RATIO_LIMITS[1]
    ratios = np.linspace(0.01, result.searched_to_ratio, 10_001)
    assert residual_curve(command, UNIT, FIRST_ORDER, ratios).max() <= 0.9


def test_an_interval_with_an_edge_on_one_side_has_no_width() -> None:
    # Steps of 1 and -0.55 leave 0.45 near no frequency at all, and 1.55 half a turn apart.
    result = found(impulses([0.0, 0.3], [1.0, -0.55]), UNIT, IDEAL, 0.8)
    assert result.lower_ratio is None
    assert result.searched_from_ratio == RATIO_LIMITS[0]
    assert result.upper_ratio == result.searched_to_ratio
    # |1 - 0.55 exp(-j 0.3 r)|^2 = 1 + 0.55^2 - 1.1 cos(0.3 r) = 0.8^2, and the margin
    limit = 0.8 * (1 + 1e-9)
    edge = math.acos((1 + 0.55**2 - limit**2) / 1.1) / 0.3
    assert result.upper_ratio == pytest.approx(edge, rel=1e-12)
    assert result.width is None


def test_what_is_common_to_several_modes_ends_where_the_first_ends() -> None:
    def interval(
        lower: float | None, upper: float | None, low: float, high: float
    ) -> Insensitivity:
        return Insensitivity(
            tolerance=0.05,
            lower_ratio=lower,
            upper_ratio=upper,
            searched_from_ratio=low,
            searched_to_ratio=high,
        )

    edged, open_above = interval(0.8, 1.4, 0.8, 1.4), interval(0.7, None, 0.7, 100.0)
    assert common_interval([edged, open_above]) == edged
    # An edge at 1.4 is none of both where the other was not searched as far.
    short = interval(0.9, None, 0.9, 1.3)
    assert common_interval([edged, short]) == short
    assert common_interval([edged, None]) is None


@pytest.mark.parametrize("scale", [0.01, 300.0])
def test_edges_do_not_depend_on_the_unit_of_time(scale: float) -> None:
    slow_actuator = SecondOrder(
        accel=SecondOrderSet(natural_frequency_rad_s=20.0 / scale, damping_ratio=0.8),
        decel=SecondOrderSet(natural_frequency_rad_s=50.0 / scale, damping_ratio=1.5),
    )
    shaper = design(CRANE, THESIS, SHAPERS["numzvd"]).impulses
    slow = impulses(scale * shaper.times_s, shaper.amplitudes)
    slow_mode = Mode(natural_frequency_rad_s=CRANE.mode.natural_frequency_rad_s / scale)
    plain = found(shaper, CRANE.mode, THESIS, 0.05)
    scaled = found(slow, slow_mode, slow_actuator, 0.05)
    assert scaled.lower_ratio == pytest.approx(plain.lower_ratio, abs=1e-11)  # root-found to 1e-13
    assert scaled.upper_ratio == pytest.approx(plain.upper_ratio, abs=1e-11)


def test_edges_depend_neither_on_waiting_nor_on_the_direction() -> None:
    shaper = design(CRANE, THESIS, SHAPERS["numzvd"]).impulses
    plain = found(shaper, CRANE.mode, THESIS, 0.05)
    for other in (
        impulses(shaper.times_s + 3.0, shaper.amplitudes),
        impulses(shaper.times_s, -shaper.amplitudes),
    ):
        result = found(other, CRANE.mode, THESIS, 0.05)
        assert result.width == pytest.approx(plain.width, abs=1e-11)  # root-found to 1e-13


def test_a_wider_tolerance_has_a_wider_interval() -> None:
    shaper = design(CRANE, FIRST_ORDER, SHAPERS["numzvd"]).impulses
    intervals = [found(shaper, CRANE.mode, FIRST_ORDER, v) for v in (1e-6, 1e-3, 0.01, 0.05, 0.2)]
    widths = [interval.width for interval in intervals if interval.width is not None]
    assert len(widths) == len(intervals)
    assert widths == sorted(widths)
    assert widths[0] > 0


def test_the_curve_is_the_residual_at_evenly_spaced_ratios() -> None:
    shaper = design(CRANE, THESIS, SHAPERS["numzv"]).impulses
    wanted = SensitivityRange(from_ratio=0.4, to_ratio=1.9, points=37, tolerance=0.1)
    result = sensitivity(shaper, CRANE.mode, THESIS, wanted)
    assert result.frequency_ratios == pytest.approx(np.linspace(0.4, 1.9, 37), rel=1e-15)
    expected = [
        claims_by_formula(shaper, CRANE.mode, THESIS, ratio)["residual"]
        for ratio in result.frequency_ratios.tolist()
    ]
    assert result.residuals == pytest.approx(np.array(expected), abs=1e-13)  # roundings
    assert result.insensitivity == insensitivity(shaper, CRANE.mode, THESIS, 0.1)


def test_the_interval_does_not_depend_on_what_is_plotted() -> None:
    wide = sensitivity(ZV, UNIT, IDEAL, SensitivityRange())
    narrow = sensitivity(ZV, UNIT, IDEAL, SensitivityRange(from_ratio=0.99, to_ratio=1.0, points=2))
    assert wide.insensitivity == narrow.insensitivity


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"from_ratio": 0.0}, r"^from_ratio must be between 1e-06 and 1e\+06, got 0\.0"),
        ({"to_ratio": math.inf}, r"^to_ratio must be between 1e-06 and 1e\+06, got inf"),
        ({"from_ratio": 1.5}, r"^to_ratio must be greater than from_ratio, 1\.5, got 1\.5"),
        ({"points": 1}, r"^points must be between 2 and 20001, got 1"),
        ({"points": 20_002}, r"^points must be between 2 and 20001, got 20002"),
        ({"tolerance": 0.0}, r"^tolerance must be between 0 and 1, both excluded, got 0\.0"),
        ({"tolerance": 1.0}, r"^tolerance must be between 0 and 1, both excluded, got 1\.0"),
        ({"tolerance": math.nan}, r"^tolerance must be between 0 and 1, both excluded, got nan"),
    ],
)
def test_a_range_out_of_its_rules_is_refused(values: dict[str, float], message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        SensitivityRange(**values)  # type: ignore[arg-type]


def test_a_narrow_peak_of_the_actuator_far_below_the_nominal_is_seen() -> None:
    # Both sets have their corner at 0.12 of the plant's frequency and differ in damping: the
    # residual of a short pulse peaks there, on a stretch narrower than a step of 0.05.
    actuator = SecondOrder(
        accel=SecondOrderSet(natural_frequency_rad_s=0.12, damping_ratio=0.12),
        decel=SecondOrderSet(natural_frequency_rad_s=0.12, damping_ratio=0.1),
    )
    pulse = impulses([0.0, 0.01], [1.0, -1.0])
    low, _ = edges(residual_curve(pulse, UNIT, actuator, DENSE), 0.15)
    assert low == pytest.approx(0.1312, abs=1e-4)
    assert found(pulse, UNIT, actuator, 0.15).lower_ratio == pytest.approx(low, abs=2 * STEP)


def test_no_edge_lies_beyond_the_widest_ratios() -> None:
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=0.5)
    result = found(impulses([0.0, 0.3], [0.5, 0.48]), mode, Ideal(), 0.981)
    assert result.searched_from_ratio >= RATIO_LIMITS[0]


def test_an_actuator_alone_shapes_the_curve_of_a_short_command() -> None:
    # Two steps at nearly one time turn no phase; the slow braking set alone decides.
    actuator = FirstOrder(accel_time_constant_s=0.0, decel_time_constant_s=1.0)
    both = impulses([0.0, 1e-12], [1.0, -0.7])
    # |1 - 0.7 / (1 + j r)| = V
    result = found(both, UNIT, actuator, 0.75)
    for edge in (result.lower_ratio, result.upper_ratio):
        if edge is not None:
            assert abs(1 - 0.7 / (1 + 1j * edge)) == pytest.approx(0.75, rel=1e-8)
    low, high = edges(residual_curve(both, UNIT, actuator, DENSE), 0.75)
    assert (result.lower_ratio, low) == (None, 0.0)
    assert result.upper_ratio == pytest.approx(high, abs=2 * STEP)


def test_a_long_quiet_command_ends_its_search() -> None:
    # Never above the tolerance: without a bound the search would take 2e8 points to its end.
    quiet = impulses([0.0, 1e5], [1e-3, -1e-3])
    result = found(quiet, UNIT, FIRST_ORDER, 0.05)
    assert (result.lower_ratio, result.upper_ratio) == (None, None)
    assert RATIO_LIMITS[0] <= result.searched_from_ratio < 1
    assert 1 < result.searched_to_ratio <= RATIO_LIMITS[1]


def test_a_command_beyond_the_digits_of_its_phase_is_refused() -> None:
    with refused("phases_lose_digits", "impulses.times_s", says=r"at most 1e\+06 rad"):
        found(impulses([0.0, 1e9], [0.5, 0.5]), UNIT, Ideal(), 0.05)


@pytest.mark.parametrize("periods", [0.4, 1.0, 1.9, 3.0])
def test_a_step_behind_a_long_ramp_has_the_edges_of_the_ramp(periods: float) -> None:
    # |sin x| / x with x = pi periods ratio: its lobes are the ramp's, however short the command.
    limit = 1 / (2 * math.pi * periods)
    drive = RateLimited(accel_limit_m_s2=limit, decel_limit_m_s2=limit, speed_m_s=1.0)
    step = impulses([0.0], [1.0])
    ratios = np.linspace(0.05, 4.0, 400_001)
    shares = np.abs(np.sinc(periods * ratios))
    for tolerance in (0.02, 0.1, 0.22):
        if shares[np.searchsorted(ratios, 1.0)] > tolerance:
            assert insensitivity(step, UNIT, drive, tolerance) is None
            continue
        within = found(step, UNIT, drive, tolerance)
        above = ratios[shares > tolerance]
        lower, upper = above[above < 1].max(), above[above > 1].min(initial=math.inf)
        assert within.lower_ratio == pytest.approx(lower, abs=2e-5)
        if upper < math.inf:
            assert within.upper_ratio == pytest.approx(upper, abs=2e-5)
        else:
            assert within.upper_ratio is None


def test_a_curve_beyond_all_numbers_is_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    # A drive with its pole on the curve comes near: 1e12 times an unshaped step.
    set_there = SecondOrderSet(natural_frequency_rad_s=2.0, damping_ratio=0.1)
    drive = SecondOrder(accel=THESIS.accel, decel=set_there)
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=0.1)
    command = impulses([0.0, 1.0, 3.0], [1.0, -1.0, 1.0])
    wanted = SensitivityRange(from_ratio=0.5, to_ratio=2.0, points=4)
    assert 1e9 < sensitivity(command, mode, drive, wanted).residuals[-1] < math.inf
    module = "design.analysis.sensitivity.evenly_spaced_vectors"
    monkeypatch.setattr(module, lambda *_: np.array([0.5, np.nan]))
    with refused("curve_overflows"):
        sensitivity(command, mode, drive, wanted)
