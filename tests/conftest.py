"""A real service for the tests, in a process of its own."""

import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import hypothesis
import pytest

from design.solvers import clarabel, ipopt_setup, trust_region_step
from tests.patience import PATIENT_S
from tests.pointers import require_pointers

hypothesis.settings.register_profile(
    "patient",
    derandomize=True,
    deadline=None,
    suppress_health_check=[hypothesis.HealthCheck.too_slow],
)
hypothesis.settings.load_profile("patient")

PATIENT = {"time_limit_s": PATIENT_S, "batch_limit_s": PATIENT_S, "export_limit_s": PATIENT_S}
"""Settings of a service whose limits no test meets."""

CRANE: dict[str, Any] = {
    "plant": {"kind": "pendulum", "cable_length_m": 0.8, "gravity_m_s2": 9.81},
    "actuator": {
        "kind": "second_order",
        "accel": {"natural_frequency_rad_s": 20, "damping_ratio": 0.8},
        "decel": {"natural_frequency_rad_s": 50, "damping_ratio": 1.5},
    },
    "shaper": {"kind": "numzvd"},
}
"""The crane of the thesis, as a request."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the tests of the service, which take seconds each.

    What is left for the end is short: no processor waits long for another. And a processor that has
    nothing left takes over tests of the mathematics, not those that share a service.
    """
    items.sort(key=lambda item: not item.nodeid.startswith("tests/service/"))


@dataclass(frozen=True)
class Running:
    """A service and how to reach it."""

    process: "subprocess.Popen[bytes]"
    port: int
    log: Path

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    @property
    def data(self) -> Path:
        """Its data folder."""
        return self.log.parent / "data"

    def client(self) -> httpx.Client:
        return httpx.Client(base_url=self.address, timeout=PATIENT_S, trust_env=False)


def changed(**constants: float) -> tuple[str, ...]:
    """Return the command of a service with some of its constants changed.

    Each is named by its module, with ``__`` for a dot: ``service__jobs__keeping__RESTART_PAUSE_S``.
    """
    lines = ["import sys", "from importlib import import_module"]
    for name, value in constants.items():
        module, _, constant = name.rpartition("__")
        found = f"import_module({module.replace('__', '.')!r})"
        lines.append(f"{found}.{constant}; setattr({found}, {constant!r}, {value!r})")
    lines.append("from service.__main__ import main; sys.exit(main())")
    return (sys.executable, "-c", "\n".join(lines))


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port: int = probe.getsockname()[1]
        return port


@contextmanager
def running_service(
    log: Path, *, command: tuple[str, ...] = (sys.executable, "-m", "service"), **settings: Any
) -> Iterator[Running]:
    """Start a service, wait until it is ready, and end it.

    What is tested is an answer, not when it comes: it has all the time that settings leave it.
    """
    port = free_port()
    settings = PATIENT | settings
    environment = {
        **os.environ,
        "SHAPERSMITH_DATA_DIR": str(log.parent / "data"),
        **{f"SHAPERSMITH_{name.upper()}": str(value) for name, value in settings.items()},
    }
    with log.open("wb") as stderr:
        process = subprocess.Popen(
            [*command, "serve", "--port", str(port)], stderr=stderr, env=environment
        )
    service = Running(process, port, log)
    try:
        wait_until_ready(service)
        yield service
    finally:
        if process.poll() is None:
            process.terminate()
        process.wait(2 * PATIENT_S)  # what runs may take as long as its limit


def wait_until_ready(service: Running) -> None:
    deadline = time.monotonic() + PATIENT_S
    with service.client() as client:
        while True:
            try:
                if client.get("/health/ready").status_code == 200:
                    return
            except httpx.TransportError:
                pass
            if service.process.poll() is not None or time.monotonic() > deadline:
                raise RuntimeError(f"the service did not start: {service.log.read_text()}")
            time.sleep(0.05)


@pytest.fixture(scope="session", autouse=True)
def patient_solvers() -> Iterator[None]:
    """Give the solvers in this process their time: a run of theirs takes up to a second alone."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(clarabel, "MAX_RUN_S", PATIENT_S)
        for options in (ipopt_setup.OPTIONS, trust_region_step.OPTIONS):
            patch.setitem(options, "ipopt.max_wall_time", PATIENT_S)
        yield


@pytest.fixture(scope="session")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    log = tmp_path_factory.mktemp("service") / "log"
    with running_service(log, workers=2) as running:
        yield running


@pytest.fixture
def client(service: Running) -> Iterator[httpx.Client]:
    """Return a client that holds every problem's pointers against the body it sent."""
    with service.client() as client:
        client.event_hooks["response"] = [require_pointers]
        yield client
