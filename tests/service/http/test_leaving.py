"""Work ends with whoever asked for it: requests and batches, by sockets that are closed."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from service.workers.costs import SLICE_S
from tests.conftest import CRANE, Running, running_service
from tests.processes import until, workers
from tests.service.http.test_server import ENDLESS, asking, at_work

BATCH = "\n".join(
    json.dumps({**ENDLESS, "sensitivity": {"from_ratio": 0.3, "to_ratio": 1.8 + 1e-6 * number}})
    for number in range(1000)
).encode()


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    log = tmp_path_factory.mktemp("leaving") / "log"
    with running_service(log, job_workers=0, workers=1) as service:
        yield service


@pytest.mark.parametrize(
    ("path", "body"),
    [("/v1/designs", json.dumps(ENDLESS).encode()), ("/v1/designs/batch", BATCH)],
    ids=["request", "batch"],
)
def test_the_work_of_a_client_that_leaves_ends(service: Running, path: str, body: bytes) -> None:
    already = len(service.log.read_text())

    def log() -> str:
        return service.log.read_text()[already:]

    before = workers(service)
    with asking(service, path, body):
        # By then no part of a batch is split any more, whose worker ends for that reason.
        victim = at_work(service, before, used_s=4 * SLICE_S)
    until(lambda: "its client has left" in log(), "its work goes on")
    until(lambda: victim not in workers(service), "its worker goes on")
    until(lambda: '"status": 499' in log(), "no line in the log")
    with service.client() as client:
        assert client.post("/v1/designs", json=CRANE).status_code == 200
    assert '"level": "error"' not in log()


def test_a_batch_ends_at_its_own_limit_and_says_so_on_each_line(tmp_path: Path) -> None:
    lines = b"\n".join([json.dumps(CRANE).encode(), *BATCH.splitlines()[:20]])
    with (
        running_service(tmp_path / "log", job_workers=0, workers=1, batch_limit_s=1) as service,
        service.client() as client,
    ):
        answer = client.post("/v1/designs/batch", content=lines)
    told = [json.loads(line) for line in answer.text.splitlines()]
    assert len(told) == 21
    assert told[-1]["status"] == 504
    assert "the batch was ended after 1 s" in told[-1]["detail"]
