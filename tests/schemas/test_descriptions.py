"""Each field of the wire says what it is, in the documentation and in the schema of its model."""

from collections.abc import Iterator

import pytest
from pydantic import BaseModel

from schemas.problems import ProblemDocument
from schemas.table_jobs import TableJobs
from schemas.tables import TableRequest
from service.operations.table import TABLE, load

MODELS: list[type[BaseModel]] = [
    ProblemDocument,
    TableJobs,
    TableRequest,
    *(load(name).request for name in TABLE),
    *(load(name).response for name in TABLE),
]


def undescribed(model: type[BaseModel]) -> Iterator[str]:
    """Yield what has no description: neither its own nor that of the model that it is."""
    whole = model.model_json_schema(mode="serialization")
    models = whole.get("$defs", {})
    for name, schema in {model.__name__: whole, **models}.items():
        for field, said in schema.get("properties", {}).items():
            referred = models.get(said.get("$ref", "").rpartition("/")[2], {})
            if "const" not in said and not {**referred, **said}.get("description"):
                yield f"{name}.{field}"


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.__name__)
def test_each_field_is_described_unless_it_names_its_kind(model: type[BaseModel]) -> None:
    assert list(undescribed(model)) == []
