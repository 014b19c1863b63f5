"""A watched search reports what it did, and does nothing else than an unwatched one."""

import json
from typing import Any

import httpx
import pytest

from design.pictures.trace_sheet import MAX_ROWS, trace_sheet
from design.trace import TraceStep
from schemas.design_request import DesignRequest
from schemas.designs import DesignResponse
from service.catalogue import shaper_catalogue
from service.dispatch import respond
from service.problems import Problem
from tests.conftest import CRANE
from tests.service.cli.commands import shapersmith

EXAMPLES = {entry.kind: entry.example for entry in shaper_catalogue().shapers}

TOO_SHORT: dict[str, dict[str, Any]] = {
    "numzvd": {"max_duration_periods": 0.3},
    "num_si": {"max_duration_periods": 0.3},
    "si": {"max_duration_periods": 0.1},
}


def answer(request: dict[str, Any]) -> DesignResponse:
    found = respond("design", json.dumps(request).encode())
    assert isinstance(found, DesignResponse)
    return found


@pytest.mark.parametrize("kind", EXAMPLES)
def test_the_trace_ends_with_the_design_and_changes_nothing_of_it(kind: str) -> None:
    plain, watched = answer(EXAMPLES[kind]), answer({**EXAMPLES[kind], "trace": True})
    assert plain.trace is None
    assert "trace" not in plain.model_dump_json()
    assert watched.trace
    last = watched.trace[-1]
    assert (last.stage, last.outcome) == ("certify", "verified")
    assert last.duration_s == watched.shaper.duration_s
    assert last.start == watched.solver.seed
    assert {step.stage for step in watched.trace} > {"certify"}
    unwatched = watched.model_copy(update={"trace": None})
    assert unwatched.model_dump_json() == plain.model_dump_json()


def test_a_solve_reports_its_iterations_and_by_how_much_it_was_off() -> None:
    watched = answer({**CRANE, "trace": True})
    solves = [step for step in watched.trace or [] if step.method == "ipopt"]
    assert [step.iterations for step in solves] == [watched.solver.iterations]
    assert len(solves[0].misses) == watched.solver.iterations + 1
    assert solves[0].misses[-1] < 1e-12


@pytest.mark.parametrize(("kind", "options"), TOO_SHORT.items())
def test_a_refusal_reports_what_was_tried_and_why_it_was_rejected(
    kind: str, options: dict[str, Any]
) -> None:
    request = {**EXAMPLES[kind], "shaper": {"kind": kind, **options}, "trace": True}
    found = respond("design", json.dumps(request).encode())
    assert isinstance(found, Problem)
    document = found.document()
    assert document.trace
    assert not any(step.outcome == "verified" for step in document.trace)
    unwatched = respond("design", json.dumps({**request, "trace": False}).encode())
    assert isinstance(unwatched, Problem)
    assert (
        unwatched.document().model_dump_json()
        == document.model_copy(update={"trace": None}).model_dump_json()
    )


def test_what_is_longer_than_asked_is_said_to_be_rejected_for_it() -> None:
    request = {**CRANE, "shaper": {"kind": "numzvd", **TOO_SHORT["numzvd"]}}
    found = respond("design", json.dumps({**request, "trace": True}).encode())
    assert isinstance(found, Problem)
    rejected = [step for step in found.trace if step.outcome == "rejected"]
    assert any(step.method == "ipopt" for step in rejected)
    assert all("max_duration_periods" in step.detail for step in rejected)


def test_the_trace_comes_over_http_and_by_the_command_line(client: httpx.Client) -> None:
    over_http = client.post("/v1/designs", json={**CRANE, "trace": True})
    by_command = shapersmith("design", "-", "--trace", given=CRANE)
    assert json.loads(by_command.stdout) == over_http.json()
    assert over_http.json()["trace"][-1]["outcome"] == "verified"
    table = shapersmith("design", "-", "--trace", "--format", "table", given=CRANE).stdout
    assert "certify: certificate from umzvd_polynomials, verified" in table


def test_a_request_remembers_nothing_of_a_trace_that_is_not_asked_for() -> None:
    """Files hold their request: it is the same with the field left out and with false."""
    told = [DesignRequest.model_validate(one) for one in (CRANE, {**CRANE, "trace": False})]
    assert told[0].canonical() == told[1].canonical()
    assert "trace" not in told[0].canonical()


def test_the_picture_of_a_search_has_a_row_a_step_and_leaves_the_middle_of_long_ones_out() -> None:
    steps = [
        TraceStep(stage="solve", method="ipopt", start=f"seed_{n}", outcome="failed", misses=(1, 0))
        for n in range(3 * MAX_ROWS)
    ]
    for count in (0, 1, MAX_ROWS, 3 * MAX_ROWS):
        figure = trace_sheet("numzvd", steps[:count])
        panel = next(axes for axes in figure.axes if axes.get_label() == "steps")
        assert len(panel.get_yticks()) == min(count, MAX_ROWS)
        assert any(f"{count} steps" in text.get_text() for text in figure.texts)
