"""PS-ZVD and SNA-ZVD: limits, theory and second routes."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import fsolve

from design.analysis.insensitivity import insensitivity
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.model import Model
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.negative import NegativeOptions
from design.shapers.registry import SHAPERS
from design.types import FloatArray
from tests.integration_route import residual_by_integration
from tests.refusals import refused
from tests.shaper_table import IDEAL, THESIS


def hertz(damping_ratio: float = 0.0) -> Mode:
    """Return a mode of one hertz: times are periods."""
    return Mode(natural_frequency_rad_s=2 * math.pi, damping_ratio=damping_ratio)


def of_amplitude(b: float, z: float = 0.0, name: str = "sna_zvd") -> Impulses:
    return design(hertz(z), IDEAL, SHAPERS[name], NegativeOptions(negative_amplitude=b)).impulses


def plain(name: str, z: float = 0.0) -> Impulses:
    return design(hertz(z), IDEAL, SHAPERS[name]).impulses


@pytest.mark.parametrize("z", [0.0, 0.05, 0.1, 0.2])
def test_given_negative_amplitudes_lead_from_zvd_to_unity_magnitude(z: float) -> None:
    durations = []
    for b in (1e-6, 0.05, 0.2, 0.4, 0.6, 0.8, 1.0):
        made = of_amplitude(b, z)
        assert made.amplitudes[[1, 3]].tolist() == [-b, -b]
        levels = np.cumsum(made.amplitudes)
        assert levels.min() >= 0
        assert levels.max() <= 1 + 1e-15
        durations.append(made.duration_s)
    assert durations == sorted(durations, reverse=True)
    # As b goes to 0 its square root is the largest of what it moves.
    assert durations[0] == pytest.approx(plain("zvd", z).duration_s, abs=2e-3)
    tiny, zvd = of_amplitude(1e-6, z), plain("zvd", z)
    assert tiny.amplitudes[[0, 2, 4]] == pytest.approx(zvd.amplitudes, abs=1e-5)
    assert tiny.times_s[[0, 2, 4]] == pytest.approx(zvd.times_s, abs=2e-3)
    umzvd = plain("umzvd", z)
    assert of_amplitude(1.0, z).amplitudes == pytest.approx(umzvd.amplitudes, abs=1e-15)
    assert of_amplitude(1.0, z).times_s == pytest.approx(umzvd.times_s, abs=1e-11)


@pytest.mark.parametrize("b", [0.01, 0.3, 0.7, 1.0])
def test_undamped_it_is_its_own_mirror_image(b: float) -> None:
    made = of_amplitude(b)
    outer, inner = (1 + 3 * b) / 4, (1 + b) / 2
    assert made.amplitudes == pytest.approx([outer, -b, inner, -b, outer], abs=1e-15)
    gaps = np.diff(made.times_s)
    assert gaps == pytest.approx(gaps[::-1], abs=1e-11)


def shortest_of_shares(b: float, a: float, near: FloatArray) -> FloatArray | None:
    """Solve the undamped mirror image of any outer amplitude a: x and y, its middle at 0."""

    def equations(v: FloatArray) -> list[float]:
        x, y = v
        flat = a * y * math.sin(y) - b * x * math.sin(x)
        return [1 + 2 * b - 2 * a - 2 * b * math.cos(x) + 2 * a * math.cos(y), flat]

    end, _, flag, _ = fsolve(equations, near, full_output=True, xtol=1e-13)
    ordered = flag == 1 and 0 < end[0] < end[1]
    return np.asarray(end) if ordered else None


@pytest.mark.parametrize("b", [0.1, 0.3, 0.5, 0.7, 0.9])
def test_no_other_share_is_faster_by_more_than_0_7_percent(b: float) -> None:
    made = of_amplitude(b)
    middle = 2 * math.pi * made.times_s[2]
    own = np.array([2 * math.pi * made.times_s[3] - middle, middle])
    best = math.inf
    for end in (max(b, 0.25), (1 + 2 * b) / 2):
        near: FloatArray | None = own
        for a in np.linspace((1 + 3 * b) / 4, end, 60).tolist():
            near = shortest_of_shares(b, a, own if near is None else near)
            if near is not None and a <= 1 and 1 + 2 * b - 2 * a <= 1:
                best = min(best, float(near[1]))
    assert best <= own[1] <= 1.007 * best


@pytest.mark.parametrize("model", ["superposed", "switched"])
@pytest.mark.parametrize("z", [0.0, 0.1])
@pytest.mark.parametrize("b", [0.2, 0.7, 1.0])
def test_it_is_exact_behind_an_asymmetric_actuator(model: Model, z: float, b: float) -> None:
    mode = Mode(natural_frequency_rad_s=3.5, damping_ratio=z)
    drives: list[Actuator] = [
        FirstOrder(accel_time_constant_s=0.03, decel_time_constant_s=0.012, model=model),
        SecondOrder(accel=THESIS.accel, decel=THESIS.decel, model=model),
    ]
    for actuator in drives:
        made = design(
            mode, actuator, SHAPERS["sna_zvd"], NegativeOptions(negative_amplitude=b)
        ).impulses
        assert made.amplitudes[1] == -b
        # Flat as well: a thousandth of the frequency off, a square of that and a curvature of 30.
        for ratio in (1.0, 0.999, 1.001):
            off = Mode(natural_frequency_rad_s=3.5 * ratio, damping_ratio=z)
            assert residual_by_integration(made, off, actuator) < (1e-7 if ratio == 1 else 3e-5)


@pytest.mark.parametrize("b", [0.2, 0.6, 1.0])
def test_zero_slope_widens_the_band(b: float) -> None:
    widths = []
    for name in ("sna_zv", "sna_zvd"):
        found = insensitivity(of_amplitude(b, 0.0, name), hertz(), IDEAL, 0.05)
        assert found is not None
        assert found.width is not None
        widths.append(found.width)
    # .0637 and .2871 for the positive ones, .0552 and .2586 at unity magnitude.
    assert widths[1] > 4 * widths[0]
    assert 0.2585 <= widths[1] <= 0.2872


def test_heavy_damping_and_small_negative_impulses_are_refused() -> None:
    with refused("no_solution_found", says=r"^no ordered solution .* in 2049 starts"):
        of_amplitude(0.02, 0.3)


def test_partial_sums_are_one_in_magnitude_and_faster_than_unity_magnitude() -> None:
    for z in (0.0, 0.05, 0.1, 0.3, 0.5):
        made = plain("ps_zvd", z)
        assert np.abs(np.cumsum(made.amplitudes)).tolist() == [1] * 5
        assert made.duration_s < plain("umzvd", z).duration_s
        assert made.duration_s > plain("ps_zv", z).duration_s


def equations(times: FloatArray, z: float) -> list[float]:
    """Return V and dV/ds of impulses 1, -2, 2, -2, 2 at w = 1, written anew."""
    s = complex(-z, math.sqrt(1 - z * z))
    full = np.concatenate(([0.0], times))
    swing = np.array([1, -2, 2, -2, 2]) * np.exp(s * (full[-1] - full))
    value, slope = complex(swing.sum()), complex((swing * full).sum())
    return [value.real, value.imag, slope.real, slope.imag]


@pytest.mark.parametrize("z", [0.0, 0.1, 0.3])
def test_no_random_start_finds_a_faster_shaper_of_partial_sums(z: float) -> None:
    made = 2 * math.pi * plain("ps_zvd", z).duration_s
    rng = np.random.default_rng(3)
    found = []
    for _ in range(200):
        with np.errstate(over="ignore", invalid="ignore"):  # of starts that run away
            end, _, flag, _ = fsolve(
                equations, np.sort(rng.uniform(0, 5, 4)), args=(z,), full_output=True
            )
        if flag == 1 and all(b - a > 1e-3 for a, b in pairwise([0.0, *end.tolist()])):
            found.append(float(end[3]))
    assert found
    assert min(found) == pytest.approx(made, abs=1e-7)


def test_an_impulse_that_a_slower_start_makes_too_strong_is_refused() -> None:
    kind = SHAPERS["sna_zv"]
    slow = FirstOrder(accel_time_constant_s=1.0, decel_time_constant_s=0.01)
    mode = Mode(natural_frequency_rad_s=2 * math.pi)
    with refused("negative_impulse_too_strong"):
        design(mode, slow, kind, kind.options(negative_amplitude=0.5))
