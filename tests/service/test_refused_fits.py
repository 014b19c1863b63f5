"""A fit is refused with its field from the root of the request, and with why."""

import json
from typing import Any

import pytest

from service.dispatch import respond
from service.jobs.plan import head_of, plan_table
from service.problems import Problem
from shapersmith import InvalidInputError, fit
from tests.conftest import CRANE
from tests.refusals import refused

FIT = {"over": "/plant/cable_length_m", "from": 0.7, "to": 0.8, "degree": 2}
LAG = {"kind": "first_order", "accel_time_constant_s": 0.1, "decel_time_constant_s": 0.05}
BARE = {"plant": CRANE["plant"], "actuator": LAG, "shaper": {"kind": "zv"}}


def fault_of(operation: str, request: dict[str, Any]) -> tuple[str, str, str]:
    problem = respond(operation, json.dumps(request).encode())
    assert isinstance(problem, Problem)
    if not problem.errors:
        return "", problem.code or "", problem.detail
    (fault,) = problem.errors
    return fault.pointer, fault.code, fault.detail


REFUSED = [
    ({"fit": {**FIT, "max_residual": 0.01}}, "/fit/degree", "degree_or_residual"),
    ({"fit": {**FIT, "to": 0.6}}, "/fit/to", "range_not_finite"),
    ({"fit": {**FIT, "over": "cable_length_m"}}, "/fit/over", "not_a_number_of_plant"),
    ({"shaper": {"kind": "num_si"}}, "/shaper/kind", "fit_not_served"),
    ({"shaper": {"kind": "si", "half_width": 0.1}}, "/shaper/kind", "fit_not_served"),
    (
        {
            "plant": {**CRANE["plant"], "damping_ratio": 0.1},
            "fit": {**FIT, "over": "/plant/damping_ratio", "from": 0.01, "to": 0.3},
        },
        "/fit/over",
        "fitted_amplitudes_depend",
    ),
]


@pytest.mark.parametrize("operation", ["fit", "design"])
@pytest.mark.parametrize(("changed", "pointer", "code"), REFUSED)
def test_a_fault_of_a_fit_is_pointed_at_from_the_root(
    operation: str, changed: dict[str, Any], pointer: str, code: str
) -> None:
    found = fault_of(operation, {**BARE, "fit": FIT, **changed})
    assert found[:2] == (pointer, code)


def test_a_fault_of_a_tables_fit_is_pointed_at_from_the_root() -> None:
    axes = [{"field": "/plant/cable_length_m", "values": [0.7]}]
    spec: dict[str, Any] = {"design": {**BARE, "shaper": {"kind": "si"}}, "axes": axes, "fit": FIT}
    spec["columns"] = ["times_s", "amplitudes"]
    plan = plan_table(json.dumps(spec).encode())
    assert not isinstance(plan, Problem)
    with refused("fit_not_served", "design.shaper.kind"):
        head_of(plan.job, fitted=True)


def test_both_and_neither_of_degree_and_residual_are_called_so() -> None:
    bare = {name: value for name, value in FIT.items() if name != "degree"}
    for given, said in (({**FIT, "max_residual": 0.01}, "both"), (bare, "neither")):
        detail = fault_of("fit", {**BARE, "fit": given})[2]
        assert detail.endswith(f"give one of degree and max_residual, got '{said}'")


def test_a_kind_that_cannot_be_fitted_is_named_in_python_too() -> None:
    with pytest.raises(InvalidInputError, match=r"/shaper/kind: .* num_si cannot be fitted, its"):
        fit(**{**BARE, "shaper": "num_si"}, fit=FIT)


@pytest.mark.parametrize("tolerance", [0.05, 0.1])
def test_no_residual_below_that_of_the_exact_times_is_looked_for_in_vain(tolerance: float) -> None:
    wanted = {"over": FIT["over"], "from": 0.7, "to": 0.8, "max_residual": tolerance / 5}
    _, code, detail = fault_of(
        "fit",
        {
            **BARE,
            "actuator": {"kind": "ideal"},
            "shaper": {"kind": "ei", "tolerance": tolerance},
            "fit": wanted,
        },
    )
    assert code == "no_degree_suffices"
    assert f"; the exact times of ei have {tolerance:g} themselves" in detail
