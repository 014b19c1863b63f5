"""The first of the random designs of every kind; `tests.acceptance.random_kinds` runs more."""

from dataclasses import replace

import pytest

from design.analysis.claims_found import zeros_of
from design.errors import DesignError
from design.model.actuators.ideal import Ideal
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.shapers.specified_insensitivity import BandOptions
from tests.acceptance.judges import wrong_in_design
from tests.acceptance.random_kinds import report, verdicts
from tests.acceptance.refusal_judges import wrong_in_refusal
from tests.random_cases import ROUND, Case, case

CASES = 186
PARTS = 3


@pytest.mark.parametrize("part", range(PARTS))
def test_random_designs_of_every_kind_are_proven_or_refused_for_a_true_reason(part: int) -> None:
    size = CASES // PARTS
    found = list(verdicts(range(part * size, (part + 1) * size)))
    assert not any(one.wrong for one in found), "\n".join(report(found))
    # Some options ask for what there is not; most do not.
    assert sum(bool(one.refusal) for one in found) <= 0.3 * size


def test_every_kind_of_the_registry_comes_up_in_a_round() -> None:
    assert set(ROUND) == {name for name, kind in SHAPERS.items() if not kind.large_swings}
    assert 2 * len(ROUND) <= CASES


def test_a_last_impulse_that_comes_late_and_a_residual_that_is_off_are_told() -> None:
    """By a hundred thousandth of the duration, and by a millionth."""
    planted = 0
    for subject in map(case, range(24)):
        try:
            made = design(subject.plant, subject.actuator, subject.kind, subject.options)
        except DesignError:
            continue
        if "residual" not in zeros_of(made.certificate):
            continue
        planted += 1
        assert list(wrong_in_design(subject, made)) == []
        times = made.impulses.times_s.copy()
        times[-1] *= 1 + 1e-5
        late = Impulses(times_s=times, amplitudes=made.impulses.amplitudes)
        assert list(wrong_in_design(subject, replace(made, impulses=late))), subject.number
        off = tuple(residual + 1e-6 for residual in made.residuals)
        assert list(wrong_in_design(subject, replace(made, residuals=off))), subject.number
    assert planted >= 10


def test_a_bound_above_what_is_found_is_told() -> None:
    plant = Modes(
        modes=(Mode(natural_frequency_rad_s=1.0), Mode(natural_frequency_rad_s=2.7))
    )  # fmt: skip
    subject = Case(number=0, kind=SHAPERS["multi_zv"], plant=plant, actuator=Ideal(), options=None)
    made = design(plant, Ideal(), subject.kind)
    assert list(wrong_in_design(subject, made)) == []
    bound = made.impulses.duration_s * (1 + 1e-6)
    wrong = replace(made, solver=replace(made.solver, lower_bound_s=bound))
    assert any("bound" in one for one in wrong_in_design(subject, wrong))


def test_a_refusal_that_is_not_true_is_told() -> None:
    subject = Case(
        number=0,
        kind=SHAPERS["si"],
        plant=Mode(natural_frequency_rad_s=1.0),
        actuator=Ideal(),
        options=BandOptions(max_duration_periods=0.5),
    )
    refusal = "max_duration_periods = 0.5 is too short: none is as short (proven)"
    assert list(wrong_in_refusal(subject, f"{refusal}; a tolerance of 0.1 can be met"))
    assert list(wrong_in_refusal(subject, f"{refusal}; a tolerance of 0.7 can be met")) == []
