"""The table of docs/live.md about a hoist: its example with each shaping."""

import json
import re
from typing import Any

import pytest

from schemas.runs import RunRequest
from service.operations.run import drive_crane
from tests.pages.reading import ROOT

PAGE = (ROOT / "docs" / "live.md").read_text(encoding="utf-8")
SECTION = PAGE.split("## While the cable is hoisted")[1].split("\n## ")[0]

SHAPINGS: dict[str, dict[str, Any]] = {
    "`none`": {"mode": "none"},
    "`delay_line`, `zv`": {"mode": "delay_line", "shaper": {"kind": "zv"}},
    "`delay_line`, `numzv`": {"mode": "delay_line", "shaper": {"kind": "numzv"}},
    "`delay_line`, `zvd` for 0.65 m": {
        "mode": "delay_line",
        "shaper": {"kind": "zvd"},
        "cable_length_m": 0.65,
    },
    "`live`, `numzv`": {"mode": "live", "shaper": {"kind": "numzv"}},
}


@pytest.mark.parametrize("name", SHAPINGS)
def test_what_a_hoist_leaves(name: str) -> None:
    (line,) = [one for one in SECTION.splitlines() if one.startswith(f"| {name} |")]
    known = [float(one) for one in re.findall(r"\| ([\d.]+) ", line)]
    (body,) = re.findall(r"```json\n(.*?)```", SECTION, re.DOTALL)
    request = json.loads(body) | {"shaping": SHAPINGS[name]}
    run = drive_crane(RunRequest.model_validate(request))
    assert run.residual is not None
    found = [100 * run.residual, run.events[-1].last_switch_s - request["events"][-1]["at_s"]]
    assert found[0] == pytest.approx(known[0], abs=0.51 if known[0] > 100 else 0.051)
    assert found[1] == pytest.approx(known[1], abs=0.0051)
    assert (found[0] < 1e-9) is (known[0] == 0)
