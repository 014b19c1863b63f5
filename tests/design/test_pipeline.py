"""From request to proof: what a design tells, and what it refuses."""

import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from design.analysis.residual import residual_vibration
from design.formulations.formulation import ClosedForm, Formulation
from design.formulations.unity_magnitude import ZERO_VIBRATION
from design.formulations.unity_magnitude_problem import unity_magnitude_problem
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.pipeline import design
from design.shapers.kind import DesignCase, ShaperKind
from design.shapers.num_large import LargeSwingOptions
from design.shapers.registry import SHAPERS
from design.shapers.settle_options import SettleOptions
from tests.refusals import refused
from tests.shaper_table import CRANE, DAMPED, FIRST_ORDER, IDEAL, THESIS

NUMZV, NUMZVD, UMZV, UMZVC, UMZVD = (
    SHAPERS[name] for name in ("numzv", "numzvd", "umzv", "umzvc", "umzvd")
)


def pretending(formulate: Callable[[DesignCase[Any]], Formulation]) -> ShaperKind:
    """Return a kind that claims zero residual and slope whatever it formulates."""
    return dataclasses.replace(NUMZVD, name="pretender", formulation=formulate)


def test_a_closed_form_says_that_no_solver_ran() -> None:
    report = design(CRANE, THESIS, NUMZV).solver
    assert (report.name, report.status, report.iterations) == ("closed_form", "solve_succeeded", 0)
    assert (report.seed, report.starts) == ("none", 0)


def test_a_solved_design_says_how_it_was_found() -> None:
    report = design(CRANE, THESIS, NUMZVD).solver
    assert (report.name, report.status) == ("ipopt", "solve_succeeded")
    assert (report.seed, report.starts) == ("umzvd_polynomials", 1)
    assert report.iterations >= 0


def test_the_certificate_covers_exactly_the_claims() -> None:
    large = LargeSwingOptions(speed_m_s=1.0)
    for kind in SHAPERS.values():
        actuator = FIRST_ORDER
        made = design(CRANE, actuator, kind, large if kind.large_swings else None)
        assert tuple(claim.quantity for claim in made.certificate.claims) == kind.claims
        assert made.certificate.verified


@pytest.mark.parametrize("kind", [UMZV, UMZVD, NUMZV, NUMZVD], ids=lambda kind: kind.name)
@pytest.mark.parametrize("name", ["accel", "decel"])
def test_a_set_that_rings_with_the_plant_is_refused(kind: ShaperKind, name: str) -> None:
    mode = Mode(natural_frequency_rad_s=3.0, damping_ratio=0.2)
    twin = SecondOrderSet(natural_frequency_rad_s=3.0, damping_ratio=0.2)
    sets: dict[str, Any] = {"accel": THESIS.accel, "decel": THESIS.decel, name: twin}
    with refused("actuator_resonant", says=rf"^actuator\.{name} must be without a pole at the"):
        design(mode, SecondOrder(**sets), kind)


def test_the_residual_is_that_behind_the_actuator_given() -> None:
    blind, aware = design(CRANE, THESIS, UMZVD), design(CRANE, THESIS, NUMZVD)
    assert blind.certificate.verified  # for the ideal actuator it was designed for
    assert blind.residual == residual_vibration(blind.impulses, CRANE.mode, THESIS)
    assert blind.residual > 0.02
    assert aware.residual < 1e-12


def test_a_shaper_that_knows_no_actuator_is_the_same_behind_any() -> None:
    times = [design(DAMPED, one, UMZVD).impulses.times_s for one in (IDEAL, FIRST_ORDER, THESIS)]
    assert (times[0] == times[1]).all()
    assert (times[0] == times[2]).all()


def test_a_pendulum_is_designed_for_as_its_mode() -> None:
    crane = Pendulum(cable_length_m=1.3, damping_ratio=0.03)
    of_crane, of_mode = design(crane, THESIS, NUMZVD), design(crane.mode, THESIS, NUMZVD)
    assert of_crane.impulses.times_s.tolist() == of_mode.impulses.times_s.tolist()


def test_options_left_out_are_the_defaults() -> None:
    default = design(CRANE, THESIS, NUMZVD)
    given = design(CRANE, THESIS, NUMZVD, SettleOptions())
    assert default.impulses.times_s.tolist() == given.impulses.times_s.tolist()


def test_the_same_request_has_the_same_answer() -> None:
    one, other = design(DAMPED, THESIS, NUMZVD), design(DAMPED, THESIS, NUMZVD)
    assert one.impulses.times_s.tolist() == other.impulses.times_s.tolist()


def test_a_fast_actuator_and_its_settled_shaper_need_no_warning() -> None:
    assert design(CRANE, IDEAL, NUMZVD).warnings == ()
    assert design(CRANE, THESIS, NUMZV).warnings == ()


SLOW_STOP = FirstOrder(accel_time_constant_s=0.02, decel_time_constant_s=0.25)


def test_a_switch_before_the_last_has_settled_is_warned_of_by_number() -> None:
    made = design(CRANE, SLOW_STOP, NUMZVD)
    gaps = np.diff(made.impulses.times_s)
    shares = [1 - math.exp(-gaps[1] / 0.25), 1 - math.exp(-gaps[3] / 0.25)]
    assert shares[0] > 0.8 > shares[1]  # the second switch has time to settle, the fourth has not
    (warning,) = [one for one in made.warnings if one.code == "actuator_not_settled"]
    assert warning.detail == (
        f"the decel set has made {100 * shares[1]:.3g} % of switch 4 when the next one follows, "
        f"{gaps[3]:.4g} s after it; the design counts on it, and is right where the model of the "
        "drive is"
    )


def test_a_slow_set_is_warned_of_by_name() -> None:
    actuator = SecondOrder(
        accel=SecondOrderSet(natural_frequency_rad_s=20.0, damping_ratio=0.8),
        decel=SecondOrderSet(natural_frequency_rad_s=6.9, damping_ratio=0.8),
    )
    slow = [one for one in design(CRANE, actuator, UMZV).warnings if one.code == "actuator_slow"]
    assert [one.detail for one in slow] == [
        "the decel set's corner frequency, 6.9 rad/s, is below twice the plant's natural "
        "frequency, 3.502 rad/s"
    ]


def test_at_twice_the_plants_frequency_a_set_is_not_slow() -> None:
    actuator = FirstOrder(accel_time_constant_s=0.25, decel_time_constant_s=0.125)
    codes = {one.code for one in design(Mode(natural_frequency_rad_s=2.0), actuator, UMZV).warnings}
    assert "actuator_slow" not in codes


def test_settling_on_request_takes_the_warning_away_and_time() -> None:
    settled = design(CRANE, SLOW_STOP, NUMZVD, SettleOptions(settle=True))
    assert [one.code for one in settled.warnings] == ["actuator_slow"]
    hasty = design(CRANE, SLOW_STOP, NUMZVD)
    assert settled.impulses.duration_s > hasty.impulses.duration_s


@pytest.mark.parametrize("actuator", [IDEAL, THESIS])
def test_a_shaper_refuses_an_actuator_that_it_does_not_serve(actuator: Actuator) -> None:
    message = r"^actuator\.kind must be one that umzvc serves: first_order, got '"
    with refused("actuator_not_served", "actuator.kind", says=message + actuator.kind):
        design(CRANE, actuator, UMZVC)


def test_a_diagram_that_does_not_close_is_infeasible() -> None:
    actuator = FirstOrder(accel_time_constant_s=1.0, decel_time_constant_s=0.0)
    with refused("alpha_above_two"):
        design(CRANE, actuator, NUMZV)


def test_damping_closes_what_alpha_says_is_open() -> None:
    # Damped vectors shrink by themselves: alpha <= 2 is no test of existence there.
    actuator = FirstOrder(accel_time_constant_s=0.65, decel_time_constant_s=0.0)
    mode = Mode(natural_frequency_rad_s=3.5, damping_ratio=0.15)
    pole = mode.pole_rad_s
    assert abs(1 + 0.65 * pole) > 2
    made = design(mode, actuator, NUMZV)
    assert made.certificate.verified


def test_a_horizon_too_near_is_infeasible() -> None:
    options = SettleOptions(max_duration_periods=0.5)
    with refused("no_solution_found", says=r"duration <= 0\.5 periods in 1026 starts"):
        design(CRANE, THESIS, NUMZVD, options)


def test_a_wrong_closed_form_does_not_leave_as_a_design() -> None:
    wrong = Impulses(times_s=np.array([0.0, 0.3, 0.6]), amplitudes=np.array([1.0, -1.0, 1.0]))
    kind = pretending(lambda *_: ClosedForm(impulses=wrong, designed_for=Ideal()))
    with refused(
        "none_verified", says=r"^no solution of pretender was verified; of the last one the res"
    ):
        design(CRANE, IDEAL, kind)


def test_solutions_that_miss_a_claim_do_not_leave_as_designs() -> None:
    # Three impulses, whose slope is not zero, under a name that claims it is.
    kind = pretending(
        lambda case: unity_magnitude_problem(
            ZERO_VIBRATION, case.mode, case.actuator, settle=False, max_duration_periods=3.0
        )
    )
    with refused("none_verified", says=r"of the last one the slope is 1\.66, allowed 1e-07$"):
        design(DAMPED, THESIS, kind)


@pytest.mark.parametrize("periods", [-1.0, math.nan])
def test_a_horizon_must_be_positive(periods: float) -> None:
    with refused("out_of_range", "max_duration_periods"):
        SettleOptions(max_duration_periods=periods)


def test_a_set_a_thousand_times_slower_than_the_plant_is_refused() -> None:
    slow = FirstOrder(accel_time_constant_s=1000.0, decel_time_constant_s=0.1)
    message = r"^actuator\.accel_time_constant_s must be at most 100 times slower than the plant, "
    message += r"got 1000\.0$"
    with refused("actuator_too_slow", "actuator.accel_time_constant_s", says=message):
        design(Mode(natural_frequency_rad_s=1.0), slow, NUMZVD)


def test_a_search_that_ends_without_a_solution_or_a_proof_is_a_failure(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("design.pipeline.solve", lambda *_: iter(()))
    says = r"^no solution of numzv was found; that there is none is not proven$"
    with refused("none_found_nor_excluded", says=says):
        design(CRANE, THESIS, NUMZV)
