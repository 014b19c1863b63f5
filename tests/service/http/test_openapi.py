"""The OpenAPI document: a client generator and a person find all that they need in it."""

import json
import re
from collections.abc import Iterator
from typing import Any

import pytest

from schemas.designs import DesignResponse
from schemas.table_jobs import TableJob
from service.http.document import TAGS, operations_of
from service.http.examples import EXAMPLES
from service.jobs.memory import MemoryJobs
from service.operations.table import TABLE, load
from tests.service.http.in_process import InProcess

Json = dict[str, Any]

DOCUMENT: Json = InProcess().app.openapi()

OPERATIONS = operations_of(DOCUMENT)

SCHEMAS: Json = DOCUMENT["components"]["schemas"]


def fields() -> Iterator[tuple[str, Json]]:
    """Yield every field of every model, with its name."""
    for model, schema in SCHEMAS.items():
        for name, field in schema.get("properties", {}).items():
            yield f"{model}.{name}", field


def inner(value: Any) -> Iterator[Json]:
    """Yield every object of a JSON value."""
    if isinstance(value, dict):
        yield value
    for one in value.values() if isinstance(value, dict) else value:
        if isinstance(one, dict | list):
            yield from inner(one)


def is_described(schema: Json) -> bool:
    model = SCHEMAS.get(schema.get("$ref", "").rpartition("/")[2], {})
    return bool(schema.get("description") or model.get("description"))


def test_operation_ids_are_short_and_each_of_one_route() -> None:
    ids = [operation["operationId"] for operation in OPERATIONS.values()]
    assert len(set(ids)) == len(ids)
    assert all(re.fullmatch(r"[a-z]+(_[a-z]+){0,2}", one) for one in ids)
    assert {row.command for row in TABLE.values()} < set(ids)


def test_each_route_has_a_tag_a_summary_and_a_description() -> None:
    tags = [tag["name"] for tag in TAGS]
    assert all(tag["description"] for tag in TAGS)
    for route, operation in OPERATIONS.items():
        assert operation["summary"], route
        assert operation["description"], route
        (tag,) = operation["tags"]
        assert tag in tags, route
    assert {operation["tags"][0] for operation in OPERATIONS.values()} == set(tags)


def test_each_model_field_and_parameter_is_described() -> None:
    assert not [name for name, schema in SCHEMAS.items() if not schema.get("description")]
    assert not [name for name, field in fields() if not is_described(field)]
    for operation in OPERATIONS.values():
        assert all(one["description"] for one in operation.get("parameters", ()))


def test_no_default_is_an_object_or_a_list() -> None:
    assert not [
        one["default"] for one in inner(SCHEMAS) if isinstance(one.get("default"), dict | list)
    ]


def test_a_default_that_generators_cannot_hold_is_said_in_words() -> None:
    described = SCHEMAS["DesignRequest"]["properties"]["sensitivity"]["description"]
    text = re.search(r"(\{.*\}) if not given\.", described)
    assert text is not None
    usual = {"sensitivity": json.loads(text[1])}
    bare = EXAMPLES["design"]["positive"].value
    service = InProcess()
    left_out, given = (service.ask("POST", "/v1/designs", bare | more) for more in ({}, usual))
    assert left_out.status_code == 200
    assert left_out.content == given.content


def test_every_reference_leads_to_a_model_and_every_model_is_referred_to() -> None:
    used = {one["$ref"].rpartition("/")[2] for one in inner(DOCUMENT) if "$ref" in one}
    assert used == set(SCHEMAS)


def test_each_route_that_takes_a_body_has_examples() -> None:
    with_body = {one["operationId"] for one in OPERATIONS.values() if "requestBody" in one}
    assert with_body == set(EXAMPLES)


@pytest.mark.parametrize(
    ("operation", "name"), [(one, name) for one in EXAMPLES for name in EXAMPLES[one]]
)
def test_an_example_is_answered_as_documented(
    operation: str, name: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    ((method, path),) = (
        route for route, one in OPERATIONS.items() if one["operationId"] == operation
    )
    content = OPERATIONS[method, path]["requestBody"]["content"]
    media_type = next(iter(content))
    body = content[media_type]["examples"][name]["value"]
    sent = body.encode() if isinstance(body, str) else body
    service = InProcess(MemoryJobs(tmp_path_factory.mktemp("tables")))
    answer = service.ask(method, path, sent, headers={"content-type": media_type})
    (success,) = (one for one in OPERATIONS[method, path]["responses"] if one.startswith("2"))
    assert answer.status_code == int(success), answer.text
    models = {row.command: load(name).response for name, row in TABLE.items()}
    model = models | {"create_table": TableJob, "design_batch": DesignResponse}
    texts = answer.text.splitlines() if operation == "design_batch" else [answer.text]
    assert all(model[operation].model_validate_json(text) for text in texts)
