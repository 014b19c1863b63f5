"""Numbers of the literature and defects of other tools, for the shapers of machine firmware.

Defects are planted here by hand, and what would catch them in the designs is shown over the band.
"""

import math
from itertools import product

import numpy as np
import pytest

from design.analysis.certificate import certify
from design.analysis.insensitivity import insensitivity
from design.analysis.residual import residual_vibration
from design.analysis.residuals_of_many import residual_curve
from design.claims import Promise
from design.model.actuators.ideal import Ideal
from design.model.actuators.second_order import SecondOrder
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.positive import MzvOptions
from design.shapers.registry import SHAPERS
from tests.integration_route import residual_by_integration
from tests.reference.firmware_shapers import decayed, hertz, proven_band, shaper
from tests.refusals import refused
from tests.shaper_table import FIRST_ORDER, IDEAL, THESIS


@pytest.mark.parametrize(
    ("name", "at_5_percent", "at_10_percent"),
    [
        ("zv", 0.06369, 0.12754),
        ("mzv", 0.10350, 0.21438),
        ("zvd", 0.28713, 0.40967),
        ("zvdd", 0.48038, 0.61457),
        ("ei", 0.39945, 0.49350),
        ("two_hump_ei", 0.72454, 0.80601),
        ("three_hump_ei", 0.96389, 1.03141),
    ],
)
def test_designs_have_their_known_widths(
    name: str, at_5_percent: float, at_10_percent: float
) -> None:
    for tolerance, known in ((0.05, at_5_percent), (0.1, at_10_percent)):
        interval = insensitivity(shaper(name), hertz(), Ideal(), tolerance)
        assert interval is not None
        assert interval.width == pytest.approx(known, abs=0.51e-5)


@pytest.mark.parametrize(
    ("name", "published", "digits"),
    [("ei", 0.3992, 3e-4), ("two_hump_ei", 0.7262, 1.7e-3), ("three_hump_ei", 0.9654, 1.6e-3)],
)
def test_published_widths_are_of_rounded_shapers(
    name: str, published: float, digits: float
) -> None:
    interval = insensitivity(shaper(name), hertz(), Ideal(), 0.05)
    assert interval is not None
    assert interval.width == pytest.approx(published, abs=digits)


UM_EI_FITS = [
    (0.09374, 0.31903, 0.13582, 0.65274),
    (0.36798, -0.05894, 0.13641, 0.63266),
    (0.64256, 0.28595, 0.26334, 0.24999),
    (0.73664, 0.00162, 0.52749, 0.19208),
]
"""UM-EI at 5 %, times over T, ascending powers of z (Singhose, Seering, Singer 1997)."""


@pytest.mark.parametrize("z", [0.0, 0.05, 0.1, 0.2, 0.3])
def test_the_published_polynomials_of_um_ei_are_near_its_solution(z: float) -> None:
    fitted = [a + z * (b + z * (c + z * d)) for a, b, c, d in UM_EI_FITS]
    # As measured: off by 3.9e-4 T at most, undamped.
    assert shaper("um_ei", z).times_s[1:] == pytest.approx(fitted, abs=4e-4)


def test_the_published_polynomials_of_um_ei_miss_its_zeros() -> None:
    fitted = Impulses(
        times_s=np.array([0.0, *(row[0] for row in UM_EI_FITS)]),
        amplitudes=np.array([1.0, -1, 1, -1, 1]),
    )
    assert residual_vibration(fitted, hertz(), Ideal()) == pytest.approx(0.0482, abs=1e-4)
    exact = shaper("um_ei")
    below, above = 0.8703717, 1.12275826
    for ratio in (below, above):
        other = Mode(natural_frequency_rad_s=2 * math.pi * ratio)
        assert residual_vibration(exact, other, Ideal()) < 1e-7
        assert residual_vibration(fitted, other, Ideal()) > 2e-3


@pytest.mark.parametrize("z", [0.0, 0.05, 0.1, 0.2, 0.4])
@pytest.mark.parametrize("options", [None, MzvOptions(n=5, t=1.1), MzvOptions(n=4, tau=1.5)])
def test_mzv_decays_by_the_turn_of_each_impulse(z: float, options: MzvOptions | None) -> None:
    made = shaper("mzv", z, options)
    expected = decayed(shaper("mzv", 0.0, options), z)
    assert made.times_s == pytest.approx(expected.times_s, abs=1e-15)
    assert made.amplitudes == pytest.approx(expected.amplitudes, abs=1e-15)


def test_mzv_that_decays_by_half_a_period_leaves_two_percent_and_a_half() -> None:
    z = 0.1
    made = shaper("mzv", z)
    decay = math.exp(-math.pi * z / math.sqrt(1 - z * z))
    wrong = shaper("mzv").amplitudes * decay ** np.arange(3)
    planted = Impulses(times_s=made.times_s, amplitudes=wrong / wrong.sum())
    assert residual_vibration(planted, hertz(z), Ideal()) == pytest.approx(0.025, abs=5e-4)
    mzv = SHAPERS["mzv"]
    promised = mzv.formulate(mzv.case((hertz(z),), IDEAL)).designed_for
    assert not certify(
        planted, hertz(z), promised, (Promise(quantity="residual", limit=1e-9),)
    ).verified


@pytest.mark.parametrize(("n", "t"), [(3, 0.75), (3, 0.6), (4, 1.0), (5, 1.2), (8, 2.0)])
def test_mzv_has_evenly_spaced_zeros(n: int, t: float) -> None:
    made = shaper("mzv", 0.0, MzvOptions(n=n, t=t))
    tau = t * (n - 2) / (n - 2 * t - 1)
    assert made.duration_s == pytest.approx(t, rel=1e-15)
    assert shaper("mzv", 0.0, MzvOptions(n=n, tau=tau)).times_s == pytest.approx(made.times_s)
    ratios = 1 + np.arange(n - 1) / tau
    assert residual_curve(made, hertz(), Ideal(), ratios) == pytest.approx(0.0, abs=1e-13)


def test_an_mzv_that_would_need_negative_impulses_is_refused() -> None:
    with refused("too_short_to_be_positive", "shaper.t", says="longer: 3 impulses"):
        shaper("mzv", 0.0, MzvOptions(t=0.4))


def test_ei_scaled_by_powers_of_k_keeps_every_limit_and_wastes_its_width() -> None:
    planted, exact = decayed(shaper("ei"), 0.1), shaper("ei", 0.1)
    assert certify(planted, hertz(0.1), Ideal(), proven_band("ei", 0.1)).verified
    widths = []
    for one in (planted, exact):
        interval = insensitivity(one, hertz(0.1), Ideal(), 0.05)
        assert interval is not None
        widths.append(interval.width or 0.0)
    assert widths[0] < 0.96 * widths[1]


@pytest.mark.parametrize("z", [0.05, 0.1, 0.2])
def test_mzv_that_decays_by_half_a_period_has_no_zero_anywhere_near(z: float) -> None:
    made = shaper("mzv", z)
    decay = math.exp(-math.pi * z / math.sqrt(1 - z * z))
    wrong = shaper("mzv").amplitudes * decay ** np.arange(3)
    planted = Impulses(times_s=made.times_s, amplitudes=wrong / wrong.sum())
    ratios = np.linspace(0.7, 1.3, 6001)
    assert residual_curve(made, hertz(z), Ideal(), ratios).min() < 1e-12
    assert residual_curve(planted, hertz(z), Ideal(), ratios).min() > 0.15 * z


def test_times_fitted_to_the_undamped_period_times_the_damped_one_are_off() -> None:
    z = 0.2
    exact = shaper("two_hump_ei", z)
    stretched = Impulses(times_s=exact.times_s / math.sqrt(1 - z * z), amplitudes=exact.amplitudes)
    assert residual_vibration(exact, hertz(z), Ideal()) < 1e-12
    assert residual_vibration(stretched, hertz(z), Ideal()) > 2e-3


@pytest.mark.parametrize(
    ("name", "z"), list(product(["zv", "zvd", "mzv", "ei", "three_hump_ei"], [0.0, 0.1]))
)
def test_a_positive_shaper_is_exact_behind_asymmetric_and_switched_actuators(
    name: str, z: float
) -> None:
    mode = Mode(natural_frequency_rad_s=3.5, damping_ratio=z)
    switched = SecondOrder(accel=THESIS.accel, decel=THESIS.decel, model="switched")
    nominal = 0.05 if "ei" in name else 0.0
    for actuator in (FIRST_ORDER, THESIS, switched):
        made = design(mode, actuator, SHAPERS[name])
        assert made.residual == pytest.approx(nominal, abs=1e-12)
        left = residual_by_integration(made.impulses, mode, actuator)
        assert left == pytest.approx(nominal, abs=1e-7)  # of the integrator


def test_the_number_of_impulses_of_mzv_is_whole() -> None:
    with refused("not_whole", "n"):
        MzvOptions(n=3.5)  # type: ignore[arg-type]
