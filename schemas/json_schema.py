"""JSON Schema of wire models (draft 2020-12), for editors and for programs in other languages.

A schema says what one object may hold: names, types, bounds, kinds. What two fields say together,
as a band whose ends are in order, the service alone knows.
"""

from copy import deepcopy
from typing import Any, Literal

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import CoreSchema

from schemas.units import other_names

Json = dict[str, Any]

Mode = Literal["validation", "serialization"]

DIALECT = GenerateJsonSchema.schema_dialect
"""Address of draft 2020-12."""

BOUNDS = ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum")


class _WithoutTitles(GenerateJsonSchema):
    """Models have titles, fields none: theirs would be their names once more."""

    def field_title_should_be_set(self, schema: CoreSchema) -> bool:  # noqa: ARG002
        """Return False."""
        return False


def json_schema_of(model: type[BaseModel], mode: Mode, *, urn: str, title: str) -> Json:
    """Return the schema of a model, with all that it refers to.

    Parameters
    ----------
    model
        The model of a request or an answer.
    mode
        ``validation`` for what is read, with the names of other units; ``serialization`` for what
        is written, in SI units alone.
    urn
        Name of the schema, its ``$id``.
    title
        Its title.

    Returns
    -------
    dict
        The schema, as JSON has it; models that it refers to are in ``$defs``.
    """
    made = model.model_json_schema(schema_generator=_WithoutTitles, mode=mode)
    for schema in (made, *made.get("$defs", {}).values()):
        if mode == "validation":
            _add_other_units(schema)
    _drop_discriminators(made)
    # Its own title and description are those of the class.
    return {"$schema": DIALECT, "$id": urn} | made | {"title": title}


def _add_other_units(schema: Json) -> None:
    """Add the names by which fields may be given in other units, one of each field."""
    fields: Json = schema.get("properties", {})
    required: list[str] = schema.get("required", [])
    rules = []
    for name in list(fields):
        others = [other for other in other_names(name) if other not in fields]
        if not others:
            continue
        for other in others:
            fields[other] = _in_other_unit(fields[name], name)
        choices: list[Json] = [{"required": [one]} for one in (name, *others)]
        if name in required:
            required.remove(name)
        else:
            choices.append({"not": {"anyOf": choices.copy()}})
        rules.append({"oneOf": choices})
    if rules:
        schema["allOf"] = rules


def _in_other_unit(field: Json, name: str) -> Json:
    """Return what a field may be in another unit; of its bounds only zero is the same there."""
    copied = deepcopy(field)
    copied.pop("default", None)
    for part in _parts(copied):
        for bound in BOUNDS:
            if part.get(bound):
                del part[bound]
    return copied | {"description": f"In place of {name}, in the unit of this name."}


def _parts(schema: Json) -> list[Json]:
    """Return a schema, its alternatives and what its lists hold."""
    inner = [*schema.get("anyOf", ()), *schema.get("prefixItems", ())]
    if isinstance(schema.get("items"), dict):
        inner.append(schema["items"])
    return [schema, *(part for one in inner for part in _parts(one))]


def _drop_discriminators(value: Any) -> None:  # noqa: ANN401 - any JSON
    """Drop OpenAPI's word for what ``oneOf`` and ``const`` say; JSON Schema does not know it."""
    if isinstance(value, dict):
        if isinstance(value.get("discriminator"), dict) and "oneOf" in value:
            del value["discriminator"]
        for one in value.values():
            _drop_discriminators(one)
    elif isinstance(value, list):
        for one in value:
            _drop_discriminators(one)
