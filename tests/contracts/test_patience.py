"""No test judges how fast the machine is: each waits as long as `tests.patience` says."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.syntax import parsed

TESTS = Path(__file__).parents[1]

LIMITS = {
    "timeout",
    "time_limit_s",
    "batch_limit_s",
    "export_limit_s",
    "limit_s",
    "stalled_s",
    "database_wait_s",
    "deadline",
}
"""Arguments that end or judge what takes longer."""

WAITS = {"wait": 0, "join": 0, "result": 0, "wait_for": 1, "timeout": 0}
"""Calls that wait, with the place of their limit."""

MIN_COST_S = 60.0
"""A limit below is met on a busy machine."""

SHORT: dict[str, set[float]] = {
    # The limit itself is tested, by work that has no end. One thread is looked at in between.
    "service/http/test_leaving.py": {3.0},
    "service/http/test_server.py": {0.05, 0.5, 1.0},
    "service/workers/test_pool.py": {0.1},
    # Whoever leaves asks and leaves until a worker had begun; a writer is looked at in between.
    "service/http/test_tables_apart.py": {0.5, 1.0},
    # What a killed process had is given to another soon; who is late loses nothing but time.
    "acceptance/test_killed_jobs.py": {1.0},
    "service/http/test_tables_over_http.py": {1.0},
    "service/jobs/test_keeping.py": {1.0},
}
"""Limits that are short on purpose, by file."""


def given(node: ast.AST) -> Iterator[ast.expr]:
    """Yield what a call or a dictionary gives as a limit."""
    if isinstance(node, ast.Dict):
        for key, value in zip(node.keys, node.values, strict=True):
            if isinstance(key, ast.Constant) and str(key.value).lower() in LIMITS:
                yield value
    if isinstance(node, ast.Call):
        yield from (keyword.value for keyword in node.keywords if keyword.arg in LIMITS)
        if isinstance(node.func, ast.Attribute) and node.func.attr in WAITS:
            yield from node.args[WAITS[node.func.attr] :][:1]


def limits(tree: ast.AST) -> Iterator[float]:
    """Yield every limit that is a number."""
    for value in (value for node in ast.walk(tree) for value in given(node)):
        if isinstance(value, ast.Constant) and isinstance(value.value, int | float):
            yield float(value.value)


@pytest.mark.parametrize(
    "path",
    sorted({*TESTS.rglob("*.py")} - {Path(__file__)}),
    ids=lambda path: str(path.relative_to(TESTS)),
)
def test_no_limit_is_short_by_accident(path: Path) -> None:
    found = {one for one in limits(parsed(path)) if one < MIN_COST_S}
    assert found == SHORT.get(str(path.relative_to(TESTS)), set())
