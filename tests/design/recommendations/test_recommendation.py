"""Which shaper is recommended, and why."""

from dataclasses import replace

import numpy as np
import pytest

from design.errors import InfeasibleDesignError
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.recommendations import candidates, recommendation
from design.recommendations.recommendation import recommend
from design.recommendations.requirements import Requirements
from design.shapers.positive import ZVD
from design.shapers.registry import SHAPERS
from tests.design.recommendations.recommended import TWO_MODES, asked, everything
from tests.refusals import refused
from tests.second_route import largest_in_band_by_formula
from tests.shaper_table import CRANE, IDEAL, THESIS

PERIOD_S = CRANE.mode.period_s
CLASSICAL = ("zv", "zvd", "zvdd", "zvddd", "ei", "two_hump_ei", "three_hump_ei")
BANDS = (0.03, 0.06, 0.14, 0.19, 0.3, 0.45)


@pytest.mark.parametrize(
    ("half_width", "kind"),
    [(0.03, "zv"), (0.14, "zvd"), (0.19, "ei"), (0.3, "two_hump_ei"), (0.45, "three_hump_ei")],
)
def test_of_the_classical_positive_shapers_the_known_one_is_fastest(
    half_width: float, kind: str
) -> None:
    # Widths at 5 %: zv .0637, zvd .2871, ei .3995 as fast as zvd, 2 humps .7245, 3 humps .9639.
    found = asked(half_width=half_width, sign="positive")
    names = [one.name for one in found.candidates if one.name in CLASSICAL]
    expected = "ei" if kind == "zvd" else kind  # as fast as zvd, and insensitive over more
    assert names[0] == expected
    if kind == "zvd":
        assert names[1] == "zvd"


@pytest.mark.parametrize("half_width", BANDS)
@pytest.mark.parametrize("z", [0.0, 0.1])
def test_specified_insensitivity_is_as_fast_as_any_positive_shaper_up_to_its_gap(
    half_width: float, z: float
) -> None:
    found = asked(replace(CRANE, damping_ratio=z), half_width=half_width, sign="positive")
    best = everything(found)["si"]
    assert not best.missed
    bound = best.designed.lower_bound_s
    assert bound is not None
    for one in found.candidates:
        assert one.duration_s >= bound
    assert found.recommended.duration_s <= best.duration_s


def test_where_a_step_alone_serves_nothing_is_a_share_of_its_time() -> None:
    damped = Mode(natural_frequency_rad_s=6.0, damping_ratio=0.02)
    found = asked(damped, tolerance=np.nextafter(1.0, 0.0))
    assert found.recommended.end_s == 0.0
    assert found.why[1] == f"the next, si, takes {found.candidates[1].end_s:.4g} s"


def test_behind_the_asymmetric_drive_of_the_thesis_its_own_shapers_win() -> None:
    found = asked(actuator=THESIS, half_width=0.12)
    told = everything(found)
    assert not told["numzvd"].missed
    assert told["umzvd"].missed == ("tolerance",)
    assert told["numzvd"].designed.worst_residual < told["umzvd"].designed.worst_residual
    assert found.recommended.name == "num_si"
    assert found.recommended.duration_s < told["numzvd"].duration_s


def test_candidates_are_ranked_by_duration_and_the_first_of_equals_bears_more() -> None:
    found = asked(actuator=THESIS)
    for ranked in (found.candidates, found.others):
        durations = [one.duration_s for one in ranked]
        assert durations == sorted(durations)
    names = [one.name for one in found.candidates]
    told = everything(found)
    # Four impulses half a period apart, both: the humps make the band wider.
    assert told["zvdd"].duration_s == pytest.approx(told["two_hump_ei"].duration_s, rel=1e-12)
    assert told["two_hump_ei"].width > told["zvdd"].width
    assert names.index("two_hump_ei") < names.index("zvdd")


def test_every_kind_of_the_registry_is_told_of() -> None:
    found = asked()
    told = {one.designed.choice.kind.name for one in everything(found).values()}
    told |= {one.choice.kind.name for one in found.refused}
    assert told == {
        name for name, kind in SHAPERS.items() if not kind.serves_several and not kind.large_swings
    }


def test_a_new_kind_shows_up_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    one_more = replace(ZVD, name="one_more")
    monkeypatch.setattr(recommendation, "SHAPERS", {**SHAPERS, "one_more": one_more})
    found = everything(asked(half_width=0.1))
    assert found["one_more"].duration_s == found["zvd"].duration_s
    assert found["one_more"].same_as == "zvd"


def scaled(plant: Mode, actuator: SecondOrder, factor: float) -> tuple[Mode, SecondOrder]:
    def faster(one: SecondOrderSet) -> SecondOrderSet:
        return replace(one, natural_frequency_rad_s=factor * one.natural_frequency_rad_s)

    return (
        replace(plant, natural_frequency_rad_s=factor * plant.natural_frequency_rad_s),
        replace(actuator, accel=faster(actuator.accel), decel=faster(actuator.decel)),
    )


def test_scaling_time_scales_durations_and_nothing_else() -> None:
    plant = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.02)
    slow = asked(plant, THESIS, half_width=0.13)
    quick = asked(*scaled(plant, THESIS, 8.0), half_width=0.13)
    for before, after in ((slow.candidates, quick.candidates), (slow.others, quick.others)):
        assert [one.name for one in before] == [one.name for one in after]
        for one, other in zip(before, after, strict=True):
            assert other.duration_s == pytest.approx(one.duration_s / 8, rel=1e-6)
            assert other.smoothing.delay_s == pytest.approx(one.smoothing.delay_s / 8, rel=1e-6)
            assert other.smoothing.smoothing_s2 == pytest.approx(
                one.smoothing.smoothing_s2 / 64, rel=1e-5
            )
            assert other.high_mode_gain == pytest.approx(one.high_mode_gain, rel=1e-5)
            assert other.width == pytest.approx(one.width, abs=1e-6)
            assert other.missed == one.missed


def test_a_band_off_the_nominal_frequency_is_served_from_its_middle() -> None:
    off = asked(lower_ratio=0.7, upper_ratio=1.1, sign="positive")
    (middle,) = off.question.designed_for
    assert middle.natural_frequency_rad_s == pytest.approx(0.9 * CRANE.mode.natural_frequency_rad_s)
    centred = asked(middle, half_width=0.2 / 0.9, sign="positive")
    assert [one.name for one in off.candidates] == [one.name for one in centred.candidates]
    assert off.recommended.duration_s == pytest.approx(centred.recommended.duration_s, rel=1e-9)
    # Ratios are of the frequency that the user gave.
    interval = off.recommended.insensitivity
    assert interval is not None
    assert interval.lower_ratio == pytest.approx(0.7, abs=1e-6)


def test_what_is_asked_of_sign_and_command_is_kept() -> None:
    positive = asked(sign="positive")
    assert all((one.impulses.amplitudes > 0).all() for one in positive.candidates)
    unity = asked(sign="unity")
    for one in unity.candidates:
        signs = np.where(np.arange(one.impulses.amplitudes.size) % 2 == 0, 1.0, -1.0)
        np.testing.assert_allclose(one.impulses.amplitudes, signs, atol=1e-9)
    assert "ps_zv" not in {one.name for one in asked(half_width=0.02).candidates}
    both = asked(half_width=0.02, lowest_command=-1.0)
    assert "ps_zv" in {one.name for one in both.candidates}
    # A wider range of the command never makes the answer slower, and here faster.
    assert both.recommended.duration_s < asked(half_width=0.02).recommended.duration_s


def test_a_first_pulse_above_the_cruise_speed_is_used_where_it_is_allowed() -> None:
    found = asked(actuator=THESIS, half_width=0.02, highest_command=1.25)
    told = everything(found)
    higher = told["numzv (max_velocity_ratio 1.25)"]
    assert not higher.missed
    assert higher.peak_command == pytest.approx(1.25)
    assert higher.duration_s < told["numzv"].duration_s


def test_a_limit_to_high_modes_brings_positive_shapers() -> None:
    found = asked(max_high_mode_gain=1.0)
    assert found.recommended.name == "si"
    assert all(one.high_mode_gain <= 1 + 1e-9 for one in found.candidates)


def test_smoothing_is_the_deviation_of_an_accelerating_path() -> None:
    told = everything(asked())
    for name in ("ei", "umzvd", "ps_zv", "sna_zv"):
        one = told[name]
        acceleration, late = 3.0, 50.0
        path = sum(
            a * acceleration * (late - t) ** 2 / 2
            for t, a in zip(
                one.impulses.times_s.tolist(), one.impulses.amplitudes.tolist(), strict=True
            )
        )
        unshaped = acceleration * (late - one.smoothing.delay_s) ** 2 / 2
        assert path - unshaped == pytest.approx(acceleration * one.smoothing.smoothing_s2, rel=1e-9)
    assert told["zv"].smoothing.delay_s == pytest.approx(PERIOD_S / 4)
    assert told["zv"].smoothing.smoothing_s2 == pytest.approx(PERIOD_S**2 / 32)


def test_on_samples_every_candidate_lies_on_them() -> None:
    for sample_time_s, tolerance in ((0.01, 0.05), (0.2, 0.3)):
        found = asked(
            actuator=THESIS, half_width=0.1, sample_time_s=sample_time_s, tolerance=tolerance
        )
        kinds = everything(found)
        assert {"zvd", "ei", "umzv", "numzv", "num_ei"} <= set(kinds)
        for one in kinds.values():
            samples = one.impulses.times_s / sample_time_s
            np.testing.assert_allclose(samples, np.rint(samples), atol=1e-9)


def test_several_modes_are_served_by_the_kinds_for_several() -> None:
    found = asked(TWO_MODES, THESIS, half_width=0.05)
    kinds = {one.designed.choice.kind.name for one in everything(found).values()}
    assert kinds == {"multi_zv", "multi_umzv", "num_multi", "multi_si", "convolved"}
    for one in found.candidates:
        for mode in TWO_MODES.modes:
            left = largest_in_band_by_formula(one.impulses, mode, THESIS, (0.95, 1.05), 201)
            assert left <= 0.05
    exact = asked(TWO_MODES, IDEAL, half_width=0.0)
    assert exact.recommended.name == "multi_umzv"


def test_reasons_are_given_in_words() -> None:
    found = asked(actuator=THESIS, max_duration_s=1.75)
    told = everything(found)
    reasons = {verdict.requirement: verdict.reason for verdict in told["zv"].verdicts}
    assert reasons["tolerance"] == (
        "has a residual of up to 23.3 % from 0.85 to 1.15 of the frequency (0.4737 to 0.6409 Hz), "
        "above 5 %"
    )
    assert reasons["max_duration_s"] == "takes 0.8971 s, within 1.75 s"
    late = {verdict.requirement: verdict.reason for verdict in told["ei"].verdicts}
    assert late["max_duration_s"] == "takes 1.794 s, longer than 1.75 s"
    assert f"num_si is the fastest of {len(found.candidates)} shapers designed" in found.why[0]
    second = found.candidates[1]
    share = 100 * (second.duration_s / found.recommended.duration_s - 1)
    assert found.why[1] == (
        f"the next, {second.name}, takes {second.duration_s:.4g} s, {share:.3g} % more"
    )
    assert (
        "no positive shaper that keeps 5 % over the band takes less than 1.689 s" in found.why[-1]
    )
    assert any("where such modes matter, that of si" in reason for reason in found.why)


def test_limits_that_nothing_meets_are_told_with_the_nearest() -> None:
    with refused("none_meets_all", says=r"max_duration_s 1:.* takes 1\.271 s") as told:
        asked(actuator=THESIS, max_duration_s=1.0)
    assert isinstance(told.value, InfeasibleDesignError)
    faults = dict(told.value.faults)
    assert set(faults) == {"tolerance", "max_duration_s"}
    assert "the shortest found that meets the other limits takes 1.271 s, num_si" in str(told.value)
    assert "takes less than 1.689 s (proven)" in str(told.value)
    # What is told can be had.
    left = float(faults["tolerance"].split("residual found is ")[1].split(" %")[0]) / 100
    again = asked(actuator=THESIS, max_duration_s=1.0, tolerance=1.01 * left)
    assert again.recommended.duration_s <= 1.0
    longer = asked(actuator=THESIS, max_duration_s=1.272)
    assert longer.recommended.name == "num_si"


def test_a_drive_a_hundred_times_slower_anywhere_in_the_band_is_refused() -> None:
    slow = SecondOrderSet(natural_frequency_rad_s=0.037, damping_ratio=1.0)
    with refused("actuator_too_slow", "actuator.accel"):
        asked(actuator=SecondOrder(accel=slow, decel=slow), half_width=0.3)


def test_what_takes_too_long_to_find_is_said_to_be_left_out() -> None:
    found = asked(half_width=0.75, sign="positive")
    reasons = {one.choice.name: one.reason for one in found.refused}
    assert "is not searched: over this band" in reasons["si (amplitudes negative)"]
    assert found.recommended.name == "si"
    left_out = r"smallest residual found is .*; si is not searched: over this band"
    with refused("none_meets_all", says=left_out):
        asked(half_width=0.9, tolerance=0.001)


def test_of_six_modes_no_more_impulses_are_convolved_than_can_be_proven() -> None:
    modes = [Mode(natural_frequency_rad_s=w, damping_ratio=0.02) for w in (5, 8, 11, 14, 19, 23)]
    wanted = Requirements(half_width=0.0, tolerance=0.05)
    found = recommend(Modes(modes=tuple(modes)), IDEAL, wanted)
    # Within the tolerance it may be faster than the fastest without residual.
    assert found.recommended.name == "multi_si (amplitudes negative)"
    assert "multi_umzv" in {one.name for one in found.candidates}
    reasons = {one.choice.name: one.reason for one in found.refused}
    assert "convolved for 6 modes it has 729 impulses" in reasons["convolved (base zvd)"]


@pytest.mark.parametrize(("half_width", "tolerance"), [(0.3, 0.05), (0.6, 0.05), (0.3, 0.005)])
def test_the_expected_duration_over_a_band_is_near_that_found(
    half_width: float, tolerance: float
) -> None:
    si = everything(asked(half_width=half_width, tolerance=tolerance, sign="positive"))["si"]
    assert candidates._periods(half_width, tolerance) == pytest.approx(
        si.duration_s / PERIOD_S, rel=0.33
    )
