"""What a row's status says, and for which actuator."""

from typing import Any

import numpy as np
import pytest

from design.analysis.certificate import certify_modes
from design.claims import Promise
from design.export.program import name_of
from design.export.registry import EXPORTS
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.pipeline import design
from design.tables.compute import compute_rows
from design.tables.rows import STATUSES, VERIFIED, VERIFIED_IDEAL
from schemas.tables import TableRequest
from service.jobs.plan import head_of, plan_of
from tests.structured_text import Block

LAG = {"natural_frequency_rad_s": 20.0, "damping_ratio": 0.8}
SLOW = {"natural_frequency_rad_s": 50.0, "damping_ratio": 1.5}
ONE, OTHER = SecondOrderSet(**LAG), SecondOrderSet(**SLOW)

ACTUATORS: dict[str, tuple[dict[str, Any], Actuator]] = {
    "ideal": ({"kind": "ideal"}, Ideal()),
    "alike": (
        {"kind": "second_order", "accel": LAG, "decel": LAG},
        SecondOrder(accel=ONE, decel=ONE),
    ),
    "apart": (
        {"kind": "second_order", "accel": LAG, "decel": SLOW},
        SecondOrder(accel=ONE, decel=OTHER),
    ),
    "switched": (
        {"kind": "second_order", "accel": LAG, "decel": SLOW, "model": "switched"},
        SecondOrder(accel=ONE, decel=OTHER, model="switched"),
    ),
    "first": (
        {"kind": "first_order", "accel_time_constant_s": 0.1, "decel_time_constant_s": 0.05},
        FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05),
    ),
    "limited": (
        {
            "kind": "rate_limited",
            "accel_limit_m_s2": 3.0,
            "decel_limit_m_s2": 5.0,
            "speed_m_s": 0.2,
            "then": {"kind": "ideal"},
        },
        RateLimited(accel_limit_m_s2=3.0, decel_limit_m_s2=5.0, speed_m_s=0.2, then=Ideal()),
    ),
}

KINDS = ("umzv", "umzvd", "um_ei", "um_2ei", "ps_zv", "zv", "zvd", "ei", "numzv", "numzvd")
IGNORE_ACTUATORS = {"umzv", "umzvd", "um_ei", "um_2ei", "ps_zv"}
KNOW_LIMITS = {"umzv", "umzvd"}
LENGTHS = [0.6, 0.8, 1.0]


def request_of(kind: str, actuator: str) -> TableRequest:
    return TableRequest.model_validate({
        "design": {
            "plant": {"kind": "pendulum", "cable_length_m": 0.8, "damping_ratio": 0.01},
            "actuator": ACTUATORS[actuator][0],
            "shaper": {"kind": kind},
        },
        "axes": [{"field": "/plant/cable_length_m", "values": LENGTHS}],
        "columns": ["times_s", "amplitudes", "residual"],
    })


@pytest.mark.parametrize("actuator", ACTUATORS)
@pytest.mark.parametrize("kind", KINDS)
def test_a_row_is_verified_if_all_it_claims_holds_with_the_actuator_given(
    kind: str, actuator: str
) -> None:
    specification = request_of(kind, actuator).to_design()
    assert specification.actuator == ACTUATORS[actuator][1]
    rows = compute_rows(specification, 0, len(LENGTHS))
    for index, values in enumerate(rows.fields):
        plant, given, options = specification.at(values)
        found = design(plant, given, specification.kind, options)
        promises = tuple(
            Promise(quantity=one.quantity, limit=one.limit, band=one.band)
            for one in found.certificate.claims
        )
        holds = certify_modes(found.impulses, plant.modes, given, promises).verified
        assert rows.status[index] == (VERIFIED if holds else VERIFIED_IDEAL)
    unaware = {"apart", "switched", "first"} | ({"limited"} if kind not in KNOW_LIMITS else set())
    if kind in IGNORE_ACTUATORS and actuator in unaware:
        assert set(rows.status) == {VERIFIED_IDEAL}
        assert rows.results[:, -1].min() > 1e-3
    if actuator == "ideal":
        assert set(rows.status) == {VERIFIED}
    assert not rows.reasons


def test_codes_of_old_files_stay() -> None:
    assert STATUSES[:3] == ("verified", "infeasible", "failed")


def test_files_say_for_which_actuator_and_count_each_status() -> None:
    request = request_of("umzv", "apart")
    head = head_of(plan_of(request).job, fitted=True)
    rows = compute_rows(request.to_design(), 0, len(LENGTHS))
    worst = f"{rows.results[:, -1].max():.3g}"
    for name in ("c", "st"):
        text = b"".join(EXPORTS[name].write(head, [rows])).decode()
        assert "3 verified for an ideal actuator only" in text
        assert "rows: 0 verified, 0 infeasible, 0 failed, 3 verified_ideal" in text
        assert f"{worst} of one unshaped step, with the actuator given" in text
    assert b"verified_ideal" in b"".join(EXPORTS["csv"].write(head, [rows]))
    # The impulses are in the program all the same: its status tells.
    block = Block(text, f"{name_of(head)}_table")
    told = block(row=1)
    assert told["status"] == VERIFIED_IDEAL
    np.testing.assert_array_equal(told["times_s"].values, rows.results[1, :3])
    np.testing.assert_array_equal(told["amplitudes"].values, [1.0, -1.0, 1.0])


def test_firmware_that_takes_impulses_is_told_that_they_are_for_an_ideal_actuator() -> None:
    request = request_of("zvd", "limited")
    head = head_of(plan_of(request).job, fitted=True)
    rows = compute_rows(request.to_design(), 0, len(LENGTHS))
    assert set(rows.status) == {VERIFIED_IDEAL}
    text = b"".join(EXPORTS["rrf"].write(head, [rows])).decode()
    assert text.count("; verified for an ideal actuator only\n") == len(LENGTHS)
    assert text.count("\nM593 ") == len(LENGTHS)
