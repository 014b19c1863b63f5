"""Shapers for several modes: theory and published numbers."""

from itertools import product

import numpy as np
import pytest

from design.analysis.sensitivity import SensitivityRange, sensitivity
from design.errors import InfeasibleDesignError
from design.model.actuators.second_order import SecondOrder
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.shapers.several_modes import BASES, ConvolvedOptions
from tests.integration_route import residual_by_integration
from tests.modes_cases import PAIR, PAIRS, left_by_formula, made, plant
from tests.refusals import refused
from tests.second_route import claims_by_formula, curve_by_formula
from tests.shaper_table import IDEAL, LIMITED, THESIS


def test_the_direct_two_mode_zv_has_its_known_numbers() -> None:
    found = made(PAIR, "multi_zv").impulses
    assert found.amplitudes == pytest.approx([0.443648708, 0.112702583, 0.443648708], abs=6e-10)
    assert found.times_s == pytest.approx([0, 0.27027027, 0.54054054], abs=6e-9)


def test_one_mode_of_several_is_the_shaper_of_one() -> None:
    for damping in (0.0, 0.1, 0.3):
        mode = Mode(natural_frequency_rad_s=3.0, damping_ratio=damping)
        for joint, single in (("multi_zv", "zv"), ("multi_umzv", "umzv")):
            wanted = design(mode, IDEAL, SHAPERS[single]).impulses
            found = design(mode, IDEAL, SHAPERS[joint]).impulses
            assert found.times_s == pytest.approx(wanted.times_s, abs=1e-10)
            assert found.amplitudes == pytest.approx(wanted.amplitudes, abs=1e-10)


def test_a_mode_of_three_times_the_frequency_costs_a_positive_shaper_nothing() -> None:
    found = made(plant((1.0, 0.0), (3.0, 0.0)), "multi_zv").impulses
    assert found.duration_s == pytest.approx(0.5, abs=1e-9)


@pytest.mark.parametrize("name", ["multi_zv", "multi_umzv", "convolved"])
def test_neither_the_order_of_modes_nor_the_unit_of_time_matters(name: str) -> None:
    subject = PAIRS[3]
    wanted = made(subject, name).impulses
    turned = made(Modes(modes=subject.modes[::-1]), name).impulses
    slower = made(
        Modes(
            modes=tuple(
                Mode(
                    natural_frequency_rad_s=mode.natural_frequency_rad_s / 8,
                    damping_ratio=mode.damping_ratio,
                )
                for mode in subject.modes
            )
        ),
        name,
    ).impulses
    assert turned.times_s == pytest.approx(wanted.times_s, abs=1e-10)
    assert turned.amplitudes == pytest.approx(wanted.amplitudes, abs=1e-10)
    assert slower.times_s == pytest.approx(8 * wanted.times_s, abs=1e-9)


def test_positive_shapers_are_exact_behind_every_actuator_that_follows_steps() -> None:
    switched = SecondOrder(accel=THESIS.accel, decel=THESIS.decel, model="switched")
    subject = plant((0.55, 0.01), (1.3, 0.02))
    for name, actuator in product(("multi_zv", "convolved"), (THESIS, switched)):
        found = made(subject, name, actuator=actuator)
        assert max(found.residuals) < 1e-12
        for mode in subject.modes:
            # The integrator is asked for 1e-11.
            assert residual_by_integration(found.impulses, mode, actuator) < 1e-8
    limited = made(subject, "multi_zv", actuator=LIMITED)
    assert limited.certificate.verified
    assert limited.residual > 1e-6


def test_what_is_left_behind_an_actuator_is_told_of_each_mode() -> None:
    subject = plant((0.55, 0.01), (1.3, 0.02))
    found = made(subject, "multi_umzv", actuator=THESIS)
    told = [claims_by_formula(found.impulses, mode, THESIS)["residual"] for mode in subject.modes]
    assert found.residuals == pytest.approx(told, abs=1e-12)
    assert found.residual == max(found.residuals) > 1e-3


@pytest.mark.parametrize("name", ["umzv", "numzvd", "zv", "ei"])
def test_a_shaper_of_one_mode_refuses_two_by_name(name: str) -> None:
    with refused(
        "kind_of_one_mode", "plant.modes", says=f"{name} serves a single mode.*got '2 modes'"
    ):
        made(PAIR, name)


def test_equal_modes_too_many_and_too_far_ones_are_refused_by_name() -> None:
    with refused("modes_too_near", "modes.2", says=r"another mode than modes\.0"):
        plant((1.0, 0.1), (2.0, 0.1), (1.0, 0.1))
    with refused("wrong_count_of_modes", "modes", says="2 to 6 here, got '7 modes'"):
        plant(*((1.0 + number, 0.0) for number in range(7)))
    with refused("modes_too_far", "modes.1.natural_frequency_rad_s"):
        plant((1.0, 0.0), (1001.0, 0.0))
    with refused("single_mode_only", "plant.modes"):
        _ = PAIR.mode


WIDE = [
    ((1.0, 1000.0), 0.0),
    ((1.0, 30.0, 1000.0), 0.002),
    ((1.0, 4.0, 9.0, 16.0, 25.0, 36.0), 0.05),
    ((0.5, 1.1, 7.0, 40.0, 300.0), 0.001),
]
"""Frequencies [rad/s], damping ratio."""


@pytest.mark.parametrize("name", ["convolved", "multi_zv", "multi_umzv"])
@pytest.mark.parametrize(("frequencies", "damping"), WIDE, ids=str)
def test_modes_far_apart_are_shaped(
    name: str, frequencies: tuple[float, ...], damping: float
) -> None:
    """Residuals by formula, beside the frequency too, and a bound that is below the duration."""
    subject = Modes(
        modes=tuple(Mode(natural_frequency_rad_s=w, damping_ratio=damping) for w in frequencies)
    )
    found = made(subject, name)
    assert found.certificate.verified
    assert left_by_formula(found, subject) < 1e-9
    if name == "convolved":
        assert found.impulses.times_s.size == 2 ** len(frequencies)
    else:
        assert found.solver.gap is not None
        assert 0 <= found.solver.gap < 0.01
    wanted = SensitivityRange(from_ratio=0.99, to_ratio=1.01, points=101)
    for mode in subject.modes:
        curve = sensitivity(found.impulses, mode, IDEAL, wanted)
        told = curve_by_formula(found.impulses, mode, IDEAL, curve.frequency_ratios)
        assert np.abs(told - curve.residuals).max() < 1e-10


def test_modes_too_far_apart_for_doubles_are_refused_in_words() -> None:
    require_words_where_modes_are_far_apart(each=6)


def require_words_where_modes_are_far_apart(*, each: int) -> None:
    """Require so many random designs of each base to be verified or refused in words."""
    rng = np.random.default_rng(11)
    words = []
    for base in sorted(BASES) * each:
        ratio = 10 ** rng.uniform(1, 3)
        subject = plant((1.0, rng.uniform(0, 0.1)), (ratio, rng.choice([0.0, 0.02])))
        try:
            found = made(subject, "convolved", ConvolvedOptions(base=base))  # type: ignore[arg-type]
        except InfeasibleDesignError as error:
            words.append((ratio, error.code, str(error)))
            continue
        assert found.certificate.verified
    beyond = [(ratio, text) for ratio, code, text in words if code == "rounding_above_claim"]
    assert beyond
    assert all(ratio > 30 and "rounding of double precision" in text for ratio, text in beyond)
