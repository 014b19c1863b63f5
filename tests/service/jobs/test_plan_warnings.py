"""A table of values that are hardly meant is planned, and says so."""

import json
from typing import Any

import pytest

from service.jobs.plan import Plan, plan_table
from tests.conftest import CRANE

LENGTH = "/plant/cable_length_m"
LENGTH_MM = "/plant/cable_length_mm"

SLIPS: list[tuple[dict[str, Any], list[tuple[str, str]]]] = [
    (
        {"axes": [{"field": LENGTH, "from": 300, "to": 1400, "points": 5}]},
        [("/axes/0/from", "300 m"), ("/axes/0/to", "1400 m")],
    ),
    (
        {"axes": [{"field": LENGTH_MM, "from": 0.3, "to": 1.4, "points": 5}]},
        [("/axes/0/from", "0.0003 m"), ("/axes/0/to", "0.0014 m")],
    ),
    (
        {"axes": [{"field": LENGTH, "values": [0.5, 800, 0.7]}]},
        [("/axes/0/values/1", "800 m")],
    ),
    (
        {"designs": [{"plant": {"cable_length_m": one}} for one in (0.5, 600, 0.7, 800)]},
        [("/designs/3/plant/cable_length_m", "800 m")],
    ),
    ({"axes": [{"field": LENGTH, "from": 0.3, "to": 1.4, "points": 5}]}, []),
    ({"designs": [{"plant": {"cable_length_m": 0.5}}]}, []),
]


@pytest.mark.parametrize(("varied", "told"), SLIPS)
def test_the_values_that_vary_are_looked_at(
    varied: dict[str, Any], told: list[tuple[str, str]]
) -> None:
    plan = plan_table(json.dumps({"design": CRANE, **varied}).encode())
    assert isinstance(plan, Plan)
    assert {one.code for one in plan.warnings} <= {"implausible_value"}
    assert len(plan.warnings) == len(told)
    for warning, (pointer, figure) in zip(plan.warnings, told, strict=True):
        assert warning.detail.startswith(f"{pointer}: {figure}")


def test_the_design_in_a_table_is_looked_at() -> None:
    design = {**CRANE, "plant": {**CRANE["plant"], "gravity_m_s2": 9810}}
    body = {"design": design, "axes": [{"field": LENGTH, "values": [0.5]}]}
    plan = plan_table(json.dumps(body).encode())
    assert isinstance(plan, Plan)
    assert [one.detail.split(":")[0] for one in plan.warnings] == ["/design/plant/gravity_m_s2"]
