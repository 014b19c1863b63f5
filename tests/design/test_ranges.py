"""Plants whose frequency is anywhere in a range: claims over it, and over the damping ratio."""

import math

import numpy as np
import pytest

from design.analysis.damping_curve import DampingRange
from design.analysis.sensitivity import SensitivityRange, sensitivity
from design.analysis.worst_mode import worst_of
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.model.plants.scheduled import Scheduled
from design.model.plants.spring_mass import SpringMass
from design.pipeline import Design, design
from design.shapers.ei import ToleranceOptions
from design.shapers.registry import SHAPERS
from design.shapers.several_modes import ConvolvedOptions
from design.shapers.specified_insensitivity import BandOptions
from tests.refusals import refused
from tests.second_route import claims_by_formula
from tests.shaper_table import IDEAL, THESIS


def hoist(shortest_m: float, longest_m: float, damping_ratio: float = 0.0) -> Scheduled:
    return Scheduled(
        first=Pendulum(cable_length_m=shortest_m, damping_ratio=damping_ratio),
        last=Pendulum(cable_length_m=longest_m, damping_ratio=damping_ratio),
    )


def worst_over_lengths(found: Design, lengths_m: tuple[float, float], actuator: Actuator) -> float:
    """Return the most left at any of many lengths, each a plant of its own, by the formula."""
    return max(
        claims_by_formula(found.impulses, Pendulum(cable_length_m=length).mode, actuator)[
            "residual"
        ]
        for length in np.linspace(*lengths_m, 801).tolist()
    )


@pytest.mark.parametrize(
    ("name", "lengths_m"),
    [("ei", (0.5, 1.0)), ("two_hump_ei", (0.4, 1.2)), ("three_hump_ei", (0.3, 1.4))],
)
@pytest.mark.parametrize("actuator", [IDEAL, THESIS])
def test_one_shaper_keeps_its_tolerance_at_every_length_of_the_range(
    name: str, lengths_m: tuple[float, float], actuator: Actuator
) -> None:
    found = design(hoist(*lengths_m), actuator, SHAPERS[name])
    claim = found.certificate.claims[-1]
    assert claim.quantity == "band"
    assert claim.holds
    assert found.worst_in_range is not None
    assert found.worst_in_range <= 0.05 * (1 + 1e-9)
    # Between two of 801 lengths a hump hides less than a millionth.
    assert worst_over_lengths(found, lengths_m, actuator) == pytest.approx(
        found.worst_in_range, rel=1e-4
    )


@pytest.mark.parametrize(("name", "actuator"), [("si", IDEAL), ("num_si", THESIS)])
def test_kinds_over_a_band_take_the_range_as_theirs(name: str, actuator: Actuator) -> None:
    subject = hoist(0.6, 1.0)
    found = design(subject, actuator, SHAPERS[name])
    bands = [claim.band for claim in found.certificate.claims if claim.band is not None]
    assert bands
    for band in bands:
        assert band == pytest.approx(subject.band)
    assert worst_over_lengths(found, (0.6, 1.0), actuator) <= 0.05 * (1 + 1e-9)
    assert found.impulses.duration_s < design(subject, actuator, SHAPERS["ei"]).impulses.duration_s


def test_a_range_too_wide_for_a_kind_is_refused_with_what_it_leaves() -> None:
    with refused("range_above_tolerance", says=r"of ei is 0\.\d+ within the range of freq"):
        design(hoist(0.3, 1.4), IDEAL, SHAPERS["ei"])
    looser = ToleranceOptions(tolerance=0.2)
    assert design(hoist(0.4, 1.2), IDEAL, SHAPERS["ei"], looser).certificate.verified


def test_a_kind_without_tolerance_claims_its_zero_and_tells_the_range() -> None:
    found = design(hoist(0.5, 1.0), IDEAL, SHAPERS["zvd"])
    assert {claim.quantity for claim in found.certificate.claims} == {"residual", "slope"}
    assert found.worst_in_range == pytest.approx(
        worst_over_lengths(found, (0.5, 1.0), Ideal()), rel=1e-6
    )


def test_convolved_shapers_claim_the_tolerance_of_their_base_if_it_has_one() -> None:
    subject = hoist(0.5, 1.0)
    zero = design(subject, IDEAL, SHAPERS["convolved"], ConvolvedOptions(base="zvd"))
    assert {claim.quantity for claim in zero.certificate.claims} == {"residual", "slope"}
    found = design(subject, IDEAL, SHAPERS["convolved"], ConvolvedOptions(base="ei"))
    claim = found.certificate.claims[-1]
    assert (claim.band, claim.limit) == (subject.band, 0.05)
    assert claim.holds


@pytest.mark.parametrize(
    ("options", "match"),
    [
        (BandOptions(half_width=0.3), r"shaper\.half_width must be left out for a scheduled"),
        (
            BandOptions(lower_ratio=0.8, upper_ratio=1.3),
            r"shaper\.lower_ratio must be left out for a scheduled",
        ),
    ],
)
def test_a_band_beside_the_range_is_refused(options: BandOptions, match: str) -> None:
    with refused("band_of_scheduled_plant", says=match):
        design(hoist(0.6, 1.0), IDEAL, SHAPERS["si"], options)


def test_a_range_that_a_kind_cannot_take_as_its_band_is_refused_by_its_own_name() -> None:
    match = r"plant\.to must be such that the range's frequencies reach .* between 0\.001 and 0\.6"
    with refused("range_one_sided", "plant.to", says=match):
        design(hoist(0.1, 2.0), THESIS, SHAPERS["num_si"])


def test_a_range_of_mass_is_the_range_of_its_frequencies() -> None:
    masses = Scheduled(
        first=SpringMass(mass_kg=4.0, stiffness_n_m=100.0),
        last=SpringMass(mass_kg=6.25, stiffness_n_m=100.0),
    )
    assert masses.middle == Mode(natural_frequency_rad_s=4.5)
    assert masses.band == pytest.approx((4 / 4.5, 5 / 4.5))
    turned = Scheduled(first=masses.last, last=masses.first)
    assert turned.band == masses.band
    found = design(masses, IDEAL, SHAPERS["ei"]).impulses
    single = design(Mode(natural_frequency_rad_s=4.5), IDEAL, SHAPERS["ei"]).impulses
    assert (found.times_s == single.times_s).all()


def test_bad_ranges_are_refused() -> None:
    with refused("range_too_wide", "to"):
        hoist(0.5, 0.5)
    with refused("range_too_wide", "to", says="at most 10 times as high"):
        hoist(0.01, 5.0)
    with refused("range_of_damping", "over"):
        Scheduled(
            first=Pendulum(cable_length_m=1.0), last=Pendulum(cable_length_m=1.0, damping_ratio=0.1)
        )
    with refused("single_frequency_only", "plant.kind"):
        _ = hoist(0.5, 1.0).mode


@pytest.mark.parametrize("actuator", [IDEAL, THESIS])
def test_a_curve_over_damping_is_that_of_plants_so_damped(actuator: Actuator) -> None:
    mode = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.05)
    shaper = design(mode, actuator, SHAPERS["zvd"]).impulses
    wanted = SensitivityRange(damping=DampingRange(start=0.0, stop=0.2, points=9))
    found = sensitivity(shaper, mode, actuator, wanted).damping
    assert found is not None
    ratios, residuals = found
    assert ratios == pytest.approx(np.arange(9) * 0.025)
    for ratio, residual in zip(ratios.tolist(), residuals.tolist(), strict=True):
        other = Mode(natural_frequency_rad_s=3.5, damping_ratio=ratio)
        told = claims_by_formula(shaper, other, actuator)["residual"]
        assert residual == pytest.approx(told, abs=1e-12)
    assert residuals[2] < 1e-12


def test_the_worst_of_curves_is_the_larger_and_common_to_both() -> None:
    shaper = design(Mode(natural_frequency_rad_s=3.5), IDEAL, SHAPERS["zvd"]).impulses
    wanted = SensitivityRange(damping=DampingRange(start=0.0, stop=0.2, points=5))
    curves = [
        sensitivity(shaper, Mode(natural_frequency_rad_s=w), IDEAL, wanted) for w in (3.4, 3.6)
    ]
    both = worst_of(curves)
    assert both.insensitivity is not None
    assert curves[0].insensitivity is not None
    assert curves[1].insensitivity is not None
    assert both.insensitivity.lower_ratio == curves[0].insensitivity.lower_ratio
    assert both.insensitivity.upper_ratio == curves[1].insensitivity.upper_ratio
    assert (both.residuals == np.maximum(curves[0].residuals, curves[1].residuals)).all()
    assert both.damping is not None
    far = sensitivity(shaper, Mode(natural_frequency_rad_s=7.0), IDEAL, wanted)
    assert worst_of([curves[0], far]).insensitivity is None
    assert math.isclose(far.residuals.max(), worst_of([curves[0], far]).residuals.max())


@pytest.mark.parametrize(
    ("start", "stop", "code", "field"),
    [
        (0.2, 0.1, "range_reversed", "damping.to"),
        (0.0, 1.0, "out_of_range", "damping.to"),
        (-0.1, 0.1, "out_of_range", "damping.from"),
    ],
)
def test_bad_ranges_of_damping_are_refused(
    start: float, stop: float, code: str, field: str
) -> None:
    with refused(code, field):
        DampingRange(start=start, stop=stop)
