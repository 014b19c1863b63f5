"""`python -m service.jobs.warming COMMAND…`: compile what tables and runs need, become the command.

Where a new machine begins with an empty volume, as a container does, the first table need not wait
for what is compiled. Where it is on disk already this takes a second.
"""

import json
import os
import signal
import sys
from collections.abc import Iterator
from typing import Any

from design.shapers.registry import SHAPERS
from design.shapers.settle_options import SettleOptions
from design.tables.kernel import calls_of_searches
from service.compiled_code import keep_in
from service.dispatch import respond
from service.jobs.plan import Plan, plan_table
from service.jobs.work import compute_chunk, pack
from service.settings import Settings


def tables() -> Iterator[dict[str, Any]]:
    """Yield a table for each kind and model whose rows are compiled.

    It has a row with and one without damping. Where steps can wait for the actuator to settle, they
    do so in one more table.
    """
    lags = {"accel_time_constant_s": 0.1, "decel_time_constant_s": 0.05}
    for kind in SHAPERS.values():
        for model in ("superposed", "switched"):
            if kind.compiled_rows is not None:
                actuator = {"kind": "first_order", "model": model, **lags}
                plant = {"kind": "mode", "natural_frequency_rad_s": 3.5, "damping_ratio": 0.01}
                settles = issubclass(kind.options, SettleOptions)
                for more in ({}, {"settle": True}) if settles else ({},):
                    shaper = {"kind": kind.name, **more}
                    yield {
                        "design": {"plant": plant, "actuator": actuator, "shaper": shaper},
                        "designs": [{}, {"plant": {"damping_ratio": 0.0}}],
                        "columns": ["times_s", "residual", "slope"],
                    }


RUN = {
    "plant": {"kind": "pendulum", "cable_length_m": 0.8},
    "actuator": {"kind": "ideal"},
    "speed_m_s": 0.2,
    "events": [{"at_s": 0.0, "direction": {"x": 1}, "for_s": 0.1}],
    "points": 2,
}
"""A short run: every run is moved by the same compiled code."""


def warm() -> None:
    """Compute all of them, what few rows need, and a run."""
    respond("run", json.dumps(RUN).encode())
    for table in tables():
        for columns in (table["columns"], ["times_s"]):
            plan = plan_table(json.dumps({**table, "columns": columns}).encode())
            if isinstance(plan, Plan):
                compute_chunk(pack(plan.job.specification), plan.job.impulses, 0)
    for function, arguments in calls_of_searches():
        function(*arguments)


def main(command: list[str]) -> None:
    """Compile, and become a command.

    Parameters
    ----------
    command
        A program and its arguments; it is found as a shell finds it.
    """
    # The first process of a container ends at no signal that it does not await.
    signal.signal(signal.SIGTERM, lambda *_: os._exit(0))
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    keep_in(Settings.from_environment(os.environ).data_dir)
    warm()
    os.execvp(command[0], command)


if __name__ == "__main__":
    main(sys.argv[1:])
