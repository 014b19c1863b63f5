"""A command waits for nothing that it does not use."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from service.operations.table import TABLE
from tests.conftest import CRANE

PROGRAM = """
import atexit, sys
atexit.register(lambda: print("", *sys.modules, sep="\\n", file=sys.stderr))
from shapersmith.__main__ import main
main(sys.argv[1:])
"""
"""Run a command, then print every module that it has imported."""

OF_TABLES = {"sqlalchemy", "alembic", "pyarrow", "numba", "distributed"}
BEHIND_LIMITS = {"design.solving.ramps", "design.solvers.ramps.search", "design.solvers.jerk_ramps"}
OVER_BANDS = {"design.solving.optima", "clarabel", "design.solvers.convex_band"}


def _imported(*arguments: str) -> set[str]:
    command = [sys.executable, "-c", PROGRAM, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return set(done.stderr.split())


@pytest.mark.parametrize("arguments", [(), *((row.command,) for row in TABLE.values())], ids=str)
def test_help_waits_for_no_library(arguments: tuple[str, ...]) -> None:
    imported = _imported(*arguments, "--help")
    assert "service.cli.main" in imported
    assert not imported & {"numpy", "scipy", "casadi", "pydantic", "dataclasses"}


@pytest.mark.parametrize("operation", ["design", "sensitivity"])
def test_a_command_waits_for_no_other_nor_for_what_other_requests_need(
    tmp_path: Path, operation: str
) -> None:
    body = {
        "design": CRANE,
        "sensitivity": {
            "plant": CRANE["plant"],
            "actuator": CRANE["actuator"],
            "impulses": {"times_s": [0, 0.9], "amplitudes": [0.5, 0.5]},
        },
    }[operation]
    request = tmp_path / "request.json"
    request.write_text(json.dumps(body))
    imported = _imported(TABLE[operation].command, str(request))
    # A design may have a fit.
    others = {f"service.operations.{name}" for name in TABLE if name not in {operation, "fit"}}
    assert f"service.operations.{operation}" in imported
    assert not imported & (others | OF_TABLES | BEHIND_LIMITS | OVER_BANDS)
