"""A client that a usual generator makes of the OpenAPI document reaches the service, typed."""

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from importlib import import_module
from typing import Any

import httpx
import pytest

from service.http.document import operations_of
from service.http.examples import EXAMPLES
from tests.conftest import Running
from tests.patience import PATIENT_S
from tests.service.http.in_process import InProcess

NAME = "generated_client"

OF_LINES = "design_batch"
"""The operation whose body is JSON Lines, which the generator does not know."""

OPERATIONS = operations_of(InProcess().app.openapi())


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Generate a package that can be imported; return what the generator warned of."""
    folder = tmp_path_factory.mktemp("client")
    (folder / "openapi.json").write_text(json.dumps(InProcess().app.openapi()))
    (folder / "config.yaml").write_text("post_hooks: []\n")
    options = {
        "path": folder / "openapi.json",
        "config": folder / "config.yaml",
        "meta": "none",
        "output-path": folder / NAME,
    }
    done = subprocess.run(
        [
            *(sys.executable, "-m", "openapi_python_client", "generate"),
            *(f"--{name}={value}" for name, value in options.items()),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(folder)
        yield done.stdout + done.stderr


def part(name: str) -> Any:
    """Return a module of the client."""
    return import_module(f"{NAME}.{name}")


def call_of(operation: str) -> Any:
    """Return the module of an operation; a name of Python's has a stroke behind it."""
    (tag,) = (one["tags"][0] for one in OPERATIONS.values() if one["operationId"] == operation)
    return part(f"api.{tag}.{'map_' if operation == 'map' else operation}")


def client_of(address: str) -> Any:
    settings = {"timeout": httpx.Timeout(PATIENT_S), "httpx_args": {"trust_env": False}}
    return part("client").Client(base_url=address, **settings)


def test_the_generator_warns_of_json_lines_alone(generated: str) -> None:
    assert re.findall(r"WARNING parsing (\w+ \S+)", generated) == ["POST /v1/designs/batch"]


@pytest.mark.usefixtures("generated")
def test_every_route_but_that_of_lines_has_a_function() -> None:
    for operation in OPERATIONS.values():
        if operation["operationId"] != OF_LINES:
            assert callable(call_of(operation["operationId"]).sync_detailed)


@pytest.mark.usefixtures("generated")
@pytest.mark.parametrize("operation", [one for one in EXAMPLES if one != OF_LINES])
def test_the_client_writes_each_example_as_it_reads_it(operation: str) -> None:
    body = next(
        one["requestBody"]["content"]["application/json"]
        for one in OPERATIONS.values()
        if one["operationId"] == operation
    )
    model = getattr(part("models"), body["schema"]["$ref"].rpartition("/")[2])
    for example in EXAMPLES[operation].values():
        written = model.from_dict(example.value).to_dict()
        assert example.value.items() <= written.items()


@pytest.mark.usefixtures("generated")
def test_a_design_and_a_refusal_come_back_typed(service: Running) -> None:
    models, design = part("models"), call_of("design")
    request = models.DesignRequest.from_dict(EXAMPLES["design"]["crane"].value)
    with client_of(service.address) as client:
        done = design.sync(client=client, body=request)
        request.plant.cable_length_m = -1.0
        refused = design.sync_detailed(client=client, body=request)
    assert isinstance(done, models.DesignResponse)
    assert done.certificate.verified
    assert done.shaper.kind == "numzvd"
    assert done.shaper.impulses.amplitudes == [1, -1, 1, -1, 1]
    assert refused.status_code == 422
    assert isinstance(refused.parsed, models.ProblemDocument)
    (fault,) = refused.parsed.errors
    assert (fault.pointer, fault.code) == ("/plant/cable_length_m", "out_of_range")


@pytest.mark.usefixtures("generated")
@pytest.mark.parametrize("status", [200, 206])
def test_a_file_or_a_part_of_it_is_read(status: int) -> None:
    def answering(_: httpx.Request) -> httpx.Response:
        return httpx.Response(status, text="times_s", headers={"content-type": "text/csv"})

    with httpx.Client(base_url="http://service", transport=httpx.MockTransport(answering)) as http:
        client = part("client").Client(base_url="http://service").set_httpx_client(http)
        answer = call_of("get_table_result").sync_detailed(32 * "0", client=client)
    assert answer.parsed == "times_s"
