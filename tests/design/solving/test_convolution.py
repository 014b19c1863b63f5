"""Shapers of several modes by convolution: claims, ranges, sizes."""

from itertools import product

import numpy as np
import pytest

from design.model.actuators.ideal import Ideal
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.shapers.several_modes import BASES, ConvolvedOptions
from design.types import FloatArray
from tests.modes_cases import LARGER, PAIR, PAIRS, left_by_formula, made, plant
from tests.refusals import refused
from tests.second_route import claims_by_formula, curve_by_formula, largest_in_band_by_formula
from tests.shaper_table import IDEAL


@pytest.mark.parametrize("base", [name for name in BASES if not name.startswith("umzv")])
def test_convolved_positive_shapers_keep_what_each_claims(base: str) -> None:
    subject = PAIRS[4]
    found = made(subject, "convolved", ConvolvedOptions(base=base))  # type: ignore[arg-type]
    assert found.impulses.amplitudes.sum() == pytest.approx(1, abs=1e-14)
    for claim in found.certificate.claims:
        mode = subject.modes[claim.mode]
        if claim.quantity == "band":
            assert claim.band is not None
            value = largest_in_band_by_formula(found.impulses, mode, Ideal(), claim.band, 300)
        elif claim.quantity in {"residual", "slope"}:
            value = claims_by_formula(found.impulses, mode, Ideal())[claim.quantity]
        else:
            continue
        assert value <= claim.limit * (1 + 1e-9)
    parts = [design(mode, IDEAL, SHAPERS[base]).impulses for mode in subject.modes]
    assert found.impulses.duration_s == pytest.approx(sum(part.duration_s for part in parts))
    assert found.impulses.times_s.size == parts[0].times_s.size * parts[1].times_s.size


def test_steps_of_convolved_shapers_at_the_same_time_are_one() -> None:
    found = made(plant((1.0, 0.0), (2.0, 0.0)), "convolved", ConvolvedOptions(base="zvd")).impulses
    assert found.times_s == pytest.approx([0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5])
    assert 16 * found.amplitudes == pytest.approx([1, 2, 3, 4, 3, 2, 1])


def levels_of_both(first: FloatArray, second: FloatArray) -> tuple[float, float]:
    """Return the range of two commands of unity magnitude convolved, from their times alone."""
    steps = sorted(
        (float(a + b), (-1) ** (i + j))
        for (i, a), (j, b) in product(enumerate(first), enumerate(second))
    )
    levels = np.cumsum([step for _, step in steps])
    return float(levels.min()), float(levels.max())


def test_convolved_negative_shapers_are_served_within_range_and_refused_beyond() -> None:
    served = beyond = 0
    for subject in PAIRS:
        parts = [design(mode, IDEAL, SHAPERS["umzv"]).impulses.times_s for mode in subject.modes]
        low, high = levels_of_both(parts[0], parts[1])
        if low < 0 or high > 1:
            with refused(
                "convolved_beyond_full_speed",
                says=f"from {low:g} to {high:g} of full speed, beyond 0 to 1",
            ):
                made(subject, "convolved", ConvolvedOptions(base="umzv"))
            beyond += 1
        else:
            found = made(subject, "convolved", ConvolvedOptions(base="umzv"))
            assert left_by_formula(found, subject) <= 1e-11
            # The joint one is never slower.
            assert made(subject, "multi_umzv").impulses.duration_s < found.impulses.duration_s
            served += 1
    assert served > 0
    assert beyond > 0


def test_a_tolerance_is_refused_for_a_base_without_and_an_unknown_base_by_name() -> None:
    with refused("base_takes_no_tolerance", "tolerance"):
        ConvolvedOptions(base="zv", tolerance=0.1)
    with refused("base_not_served", "base"):
        ConvolvedOptions(base="numzv")  # type: ignore[arg-type]
    tight = made(PAIR, "convolved", ConvolvedOptions(base="ei", tolerance=0.02))
    assert {claim.limit for claim in tight.certificate.claims} == {0.02}


def test_a_band_of_too_many_convolved_impulses_is_refused() -> None:
    six = LARGER[-1]
    with refused("too_many_convolved", "shaper.base", says="of fewer .* they are 15625"):
        made(six, "convolved", ConvolvedOptions(base="three_hump_ei"))
    # As many that claim zeros are no matter.
    assert made(six, "convolved", ConvolvedOptions(base="zvddd")).impulses.times_s.size == 15625


def test_bands_of_hundreds_of_convolved_impulses_are_proven() -> None:
    four = LARGER[3]
    found = made(four, "convolved", ConvolvedOptions(base="three_hump_ei"))
    assert found.impulses.times_s.size == 625
    for claim in found.certificate.claims:
        if claim.band is not None:
            mode = four.modes[claim.mode]
            ratios = np.linspace(*claim.band, 700)
            told = float(curve_by_formula(found.impulses, mode, IDEAL, ratios).max())
            # Peaks of a turn of 100 rad or so lie within 1e-3 of one of 700 ratios.
            assert told <= claim.value * (1 + 1e-9)
            assert told == pytest.approx(claim.value, rel=2e-2)
