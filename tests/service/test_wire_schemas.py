"""JSON Schemas: valid, whole, and of one mind with the models on what users send and get."""

import json
import re
import tomllib
from collections.abc import Iterator
from copy import deepcopy
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from pydantic import ValidationError

from schemas.catalogue import CatalogueEntry
from schemas.requests import requests
from service.catalogue import shaper_catalogue
from service.cli.main import main
from service.http.document import operations_of
from service.http.examples import EXAMPLES
from service.jobs.memory import MemoryJobs
from service.wire_schemas import schema_bytes, schema_names, write_schemas
from tests.conftest import CRANE
from tests.pages.reading import PAGES, blocks
from tests.service.http.in_process import InProcess, require_problem

Json = dict[str, Any]

OF_A_PAGE = re.compile(rf"shapersmith ({'|'.join(requests())}) ([\w./-]+\.(?:json|toml))\b")

FAULTY = ("shapersmith: invalid-input:", "shapersmith: not-json:")
"""Begin what a command prints of a request that is not right."""

IN_OTHER_UNITS = {
    "plant": {"kind": "mode", "period_s": 1.9, "log_decrement": 0.05},
    "actuator": {
        "kind": "first_order",
        "accel_time_constant_ms": 100,
        "decel_time_constant_s": 0.1,
    },
    "shaper": {"kind": "zvd", "sample_time_ms": 4},
}


@cache
def validator(name: str) -> Any:
    """Return what holds a JSON value against a schema."""
    return jsonschema.Draft202012Validator(json.loads(schema_bytes(name)))


def inner(value: Any) -> Iterator[Json]:
    """Yield every object of a JSON value."""
    if isinstance(value, dict):
        yield value
    for one in value.values() if isinstance(value, dict) else value:
        if isinstance(one, dict | list):
            yield from inner(one)


def examples() -> Iterator[tuple[str, str, Any]]:
    """Yield each example of the OpenAPI document: operation, name, body."""
    for operation, named in EXAMPLES.items():
        for name, example in named.items():
            yield operation, name, example.value


def requests_of_pages() -> Iterator[tuple[str, str, str, Any]]:
    """Yield each request that a page writes and one of its commands reads, as no faulty one.

    Yields the page, the command, the file and what it holds.
    """
    for page in PAGES:
        written: dict[str, str] = {}
        for block in blocks(page):
            if block.file is not None and block.language in {"json", "toml"}:
                written[block.file] = block.text
            for command in block.commands:
                if any(line.startswith(FAULTY) for line in command.prints):
                    continue
                for name, file in OF_A_PAGE.findall(command.line):
                    if file in written:
                        read = tomllib.loads if file.endswith(".toml") else json.loads
                        yield page, name, file, read(written[file])


OF_PAGES = list(requests_of_pages())


@pytest.mark.parametrize("name", schema_names())
def test_each_schema_is_valid_and_whole(name: str) -> None:
    schema = json.loads(schema_bytes(name))
    jsonschema.Draft202012Validator.check_schema(schema)
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert schema["$id"] == f"urn:shapersmith:schema:{name}"
    assert schema["title"]
    assert schema["description"]
    held = schema.get("$defs", {})
    used = {one["$ref"] for one in inner(schema) if isinstance(one.get("$ref"), str)}
    assert used == {f"#/$defs/{model}" for model in held}
    assert all(model["description"] for model in held.values())


def test_each_field_is_described() -> None:
    for name in schema_names():
        schema = json.loads(schema_bytes(name))
        for model in (schema, *schema.get("$defs", {}).values()):
            for field, told in model.get("properties", {}).items():
                # What a reference leads to has a description, as a test has it.
                assert told.keys() & {"$ref", "const", "description"}, (name, field)


@pytest.mark.parametrize("case", list(examples()), ids=lambda case: f"{case[0]}-{case[1]}")
def test_the_examples_of_the_document_and_their_answers_pass(
    case: tuple[str, str, Any], tmp_path: Path
) -> None:
    operation, _, body = case
    command = {"create_table": "table", "design_batch": "design"}.get(operation, operation)
    lines = body.splitlines() if isinstance(body, str) else [json.dumps(body)]
    for line in lines:
        validator(f"{command}-request").validate(json.loads(line))
    service = InProcess(MemoryJobs(tmp_path))
    (path,) = (
        path
        for (_, path), one in operations_of(service.app.openapi()).items()
        if one["operationId"] == operation
    )
    sent, kind = (body.encode(), "application/jsonl") if len(lines) > 1 else (body, "")
    headers = {"content-type": kind} if kind else {}
    answer = service.ask("POST", path, sent, headers=headers)
    for line in answer.text.splitlines():
        validator(f"{command}-response").validate(json.loads(line))


def test_there_are_requests_of_most_commands_on_the_pages() -> None:
    assert len({command for _, command, _, _ in OF_PAGES}) >= len(requests()) - 1


@pytest.mark.parametrize("entry", shaper_catalogue().shapers, ids=lambda entry: entry.kind)
def test_the_example_of_each_kind_of_shaper_passes(entry: CatalogueEntry) -> None:
    validator("design-request").validate(entry.example)


@pytest.mark.parametrize("case", OF_PAGES, ids=lambda case: "-".join(case[:3]))
def test_a_request_of_a_page_passes(case: tuple[str, str, str, Any]) -> None:
    _, command, _, body = case
    validator(f"{command}-request").validate(body)


def test_other_answers_pass() -> None:
    service = InProcess()
    for path, name in (
        ("/v1/shapers", "shapers-response"),
        ("/v1/schemas", "schemas-response"),
        ("/health/live", "live-response"),
        ("/health/ready", "ready-response"),
        ("/v1/nothing", "problem"),
    ):
        validator(name).validate(service.ask("GET", path).json())
    refused = service.ask(
        "POST", "/v1/designs", {**CRANE, "plant": {"kind": "mode"}, "trace": True}
    )
    validator("problem").validate(refused.json())


def changed(body: Json, pointer: str, value: object) -> Json:
    """Return a body in which one field is another, or is not there."""
    copied = deepcopy(body)
    *parents, last = pointer.split("/")[1:]
    at = copied
    for name in parents:
        at = at[name]
    if value is None:
        del at[last]
    else:
        at[last] = value
    return copied


@pytest.mark.parametrize(
    ("pointer", "value", "is_right"),
    [
        ("/plant/log_decrement", 0.1, True),
        ("/plant/log_decrement", None, True),
        ("/shaper/sample_time_ms", None, True),
        ("/shaper/sample_time_s", 0.004, False),  # both
        ("/plant/damping_ratio", 0.01, False),
        ("/plant/period_s", None, False),
        ("/plant/period_s", 0.0, False),
        ("/plant/period_s", "1.9", False),
        ("/plant/period_ms", 1900.0, False),
        ("/plant/cable_length_mm", 800.0, False),  # of another kind
        ("/plant/kind", "modes", False),
        ("/shaper/kind", "zzv", False),
        ("/actuator/accel_time_constant_ms", 1e13, True),
        ("/actuator/accel_time_constant_ms", -1.0, False),
        ("/actuator", None, False),
    ],
)
def test_schema_and_model_agree_in_other_units(pointer: str, value: object, is_right: bool) -> None:
    body = changed(IN_OTHER_UNITS, pointer, value)
    assert validator("design-request").is_valid(body) == is_right
    if is_right:
        requests()["design"].model_validate_json(json.dumps(body))
    else:
        with pytest.raises(ValidationError):
            requests()["design"].model_validate_json(json.dumps(body))


def test_the_command_the_service_and_the_files_have_the_same_bytes(tmp_path: Path) -> None:
    assert main(["schemas", "-o", str(tmp_path)], lambda *_: 1) == 0
    listed = InProcess().ask("GET", "/v1/schemas").json()["schemas"]
    assert {path.stem for path in tmp_path.iterdir()} == {one["name"] for one in listed}
    for one in listed:
        answer = InProcess().ask("GET", one["path"])
        assert answer.headers["content-type"] == "application/schema+json"
        assert answer.content == (tmp_path / f"{one['name']}.json").read_bytes()


def test_a_client_that_has_a_schema_is_told_so() -> None:
    service = InProcess()
    path = "/v1/schemas/design-request"
    tag = service.ask("GET", path).headers["etag"]
    assert tag != service.ask("GET", "/v1/schemas/fit-request").headers["etag"]
    for held in (tag, f'"other", W/{tag}', "*"):
        answer = service.ask("GET", path, headers={"if-none-match": held})
        assert (answer.status_code, answer.content, answer.headers["etag"]) == (304, b"", tag)
    assert service.ask("GET", path, headers={"if-none-match": '"other"'}).status_code == 200


def test_a_name_that_is_none_is_refused_with_where_the_names_are() -> None:
    refused = InProcess().ask("GET", "/v1/schemas/design")
    require_problem(refused, 404, "not-found", "GET /v1/schemas lists")


def test_a_folder_that_cannot_be_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    assert main(["schemas", "-o", str(tmp_path / "file")], lambda *_: 1) == 2
    assert f"cannot write into {tmp_path / 'file'}" in capsys.readouterr().err
    (tmp_path / "problem.json").mkdir()
    assert main(["schemas", "-o", str(tmp_path)], lambda *_: 1) == 2
    assert "problem.json: it is a folder" in capsys.readouterr().err


def test_files_that_are_there_are_replaced(tmp_path: Path) -> None:
    (tmp_path / "problem.json").write_text("old")
    write_schemas(tmp_path)
    assert (tmp_path / "problem.json").read_bytes() == schema_bytes("problem")
