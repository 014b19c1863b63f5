"""Every field with a unit is read in others, by its name, and answers keep SI."""

import json
import math
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import numpy as np
import pytest
from pydantic import BaseModel, TypeAdapter, ValidationError

from schemas.base import wire_names
from schemas.design_request import DesignRequest
from schemas.fits import FIELDS, FitIn
from schemas.maps import AxisIn
from schemas.plants import LengthCourseIn, ModeIn, PlantIn, ScheduledIn
from schemas.tables import TableAxis, TableRequest
from schemas.units import MAX_NAME_CHARACTERS, STAND_INS, UNITS, all_in_si, other_names, reading_of
from service.dispatch import answer
from service.operations.table import TABLE, load
from tests.conftest import CRANE
from tests.refusals import refused

ROOT = Path(__file__).parents[2]

IN_SI: dict[str, Callable[[float], float]] = {
    "_hz": lambda value: 2 * math.pi * value,
    "_deg": math.radians,
    "_rate_deg_s": math.radians,
    "_n_mm": lambda value: value / 1e-3,
    "_ms": lambda value: value * 1e-3,
    "_mm": lambda value: value * 1e-3,
    "_mm_s": lambda value: value * 1e-3,
    "_mm_s2": lambda value: value * 1e-3,
    "_mm_s3": lambda value: value * 1e-3,
    "period_s": lambda value: 2 * math.pi / value,
    "period_ms": lambda value: 2 * math.pi / (value * 1e-3),
    "log_decrement": lambda value: value / math.sqrt(4 * math.pi**2 + value**2),
}
"""What each unit is, said once more."""

SI_ONLY = {"mass_kg", "hook_mass_kg", "load_mass_kg"}
"""Fields whose unit has no other."""

VALUE = 4.0
"""A value that every field takes, in every unit."""


def models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    """Yield the models that an annotation holds, those within them too."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
        for field in annotation.model_fields.values():
            yield from models_in(field.annotation)
    for inner in get_args(annotation):
        yield from models_in(inner)


def example_of(annotation: Any) -> Any:
    """Return a value that the wire takes for a required field."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        required = (item for item in annotation.model_fields.items() if item[1].is_required())
        return {field.alias or name: example_of(field.annotation) for name, field in required}
    origin = get_origin(annotation)
    if origin is Literal:
        return get_args(annotation)[0]
    if origin is list:
        return [example_of(get_args(annotation)[0])] * 2
    if origin is Annotated or origin is Union or str(origin) == "<class 'types.UnionType'>":
        return example_of(get_args(annotation)[0])
    return "/plant/cable_length_m" if annotation is str else 0.5


def holds_list(annotation: Any) -> bool:
    """Return whether a field is a list, or one that may be left out."""
    return get_origin(annotation) is list or any(map(holds_list, get_args(annotation)))


REQUESTS = (*(load(name).request for name in TABLE), TableRequest)
MODELS = sorted(set(models_in(Union[REQUESTS])), key=str)  # noqa: UP007 - made of a tuple
FIELDS_WITH_UNITS = [
    (model, field, other)
    for model in MODELS
    for field in model.model_fields
    for other in other_names(field)
]


def test_every_field_with_a_unit_has_another_name() -> None:
    named = {field for _, field, _ in FIELDS_WITH_UNITS}
    ends = ("_s", "_m", "_rad", "_s2", "_s3", "_kg")
    assert {n for m in MODELS for n in m.model_fields if n.endswith(ends)} - named == SI_ONLY
    assert len(FIELDS_WITH_UNITS) > 70


@pytest.mark.parametrize(
    ("model", "field", "other"),
    FIELDS_WITH_UNITS,
    ids=[f"{model.__name__}-{other}" for model, _, other in FIELDS_WITH_UNITS],
)
def test_a_field_may_be_given_in_another_unit_once(
    model: type[BaseModel], field: str, other: str
) -> None:
    end = max((end for end in IN_SI if other.endswith(end)), key=len)
    annotation = model.model_fields[field].annotation
    in_list, over_time = holds_list(annotation), annotation is LengthCourseIn
    value: Any = [VALUE] * 2 if in_list or over_time else VALUE
    if over_time:
        value = {"times_s": [0.5], "values": value}
    given = {**example_of(model), other: value}
    given.pop(field, None)
    body = TypeAdapter(Any).dump_json(given)
    told = getattr(model.model_validate_json(body), field)
    in_si = IN_SI[end](VALUE)
    found = told.values if over_time else told
    assert found == pytest.approx([in_si] * 2 if in_list or over_time else in_si, rel=1e-15)
    assert getattr(model.model_validate(given), field) == told

    with pytest.raises(ValidationError, match=f"{field}") as caught:
        model.model_validate({**given, field: value})
    (fault,) = caught.value.errors()
    assert (fault["type"], fault["ctx"]) == (
        "unit_said_twice",
        {"first": other, "second": field},
    )


def test_the_document_lists_every_unit() -> None:
    text = (ROOT / "docs" / "requests.md").read_text()
    rows = re.findall(r"^\| `(_\w+)` \| `(_\w+)` \| `(\w+)`", text, flags=re.MULTILINE)
    assert {(end, si_end) for si_end, end, _ in rows} == {(unit.end, unit.si_end) for unit in UNITS}
    for si_end, end, example in rows:
        reading = reading_of(example)
        assert reading is not None
        assert example.endswith(end)
        assert reading.name.endswith(si_end)
    assert all(name in text for name in STAND_INS)
    request, *_ = re.findall("```json\n(.*?)```", text, flags=re.DOTALL)
    plant = DesignRequest.model_validate_json(request).plant.to_design()
    assert [0 < mode.damping_ratio < 0.01 for mode in plant.modes] == [True]


def test_answers_are_the_same_in_any_unit() -> None:
    fit = {"over": "/plant/cable_length_m", "from": 0.75, "to": 0.85, "degree": 2}
    in_si = {**CRANE, "shaper": {"kind": "umzv"}, "fit": fit}
    given = {
        **in_si,
        "plant": {"kind": "pendulum", "cable_length_mm": 800, "gravity_mm_s2": 9810},
        "fit": {**fit, "over": "/plant/cable_length_mm", "from": 750, "to": 850},
    }
    answers = [answer("design", json.dumps(body).encode()).outcome for body in (in_si, given)]
    assert isinstance(answers[0], bytes)
    assert answers[1] == answers[0]


@pytest.mark.parametrize("value", [None, True, "0.8", {}, [], 10**400, math.nan, math.inf])
@pytest.mark.parametrize("name", ["natural_frequency_hz", "period_s", "log_decrement"])
def test_what_is_no_number_is_refused_in_any_unit(name: str, value: Any) -> None:
    given = {"kind": "mode", "natural_frequency_rad_s": 1.0, name: value}
    if name != "log_decrement":
        del given["natural_frequency_rad_s"]
    with pytest.raises(ValidationError):
        TypeAdapter(PlantIn).validate_python(given)


@pytest.mark.parametrize("name", ["natural_frequency_hz", "period_s", "period_ms"])
@pytest.mark.parametrize("value", [0, -1])
def test_a_sign_is_refused_in_any_unit(name: str, value: float) -> None:
    with pytest.raises(ValidationError, match="greater than 0"):
        TypeAdapter(PlantIn).validate_python({"kind": "mode", name: value})


@pytest.mark.parametrize("millimetres", [1, 9, 800, 1001, 1400])
def test_a_thousandth_is_the_same_number_as_its_decimals(millimetres: int) -> None:
    reading = reading_of("cable_length_mm")
    assert reading is not None
    assert reading.convert(millimetres) == float(f"{millimetres}e-3")


@pytest.mark.parametrize(
    "name", ["speed_m_ms", "rows_per_ms", "times_mm_h", "_mm", "hz", "", f"{'x' * 100}_mm"]
)
def test_a_name_that_ends_in_no_unit_is_not_read(name: str) -> None:
    assert reading_of(name) is None


@pytest.mark.parametrize("field", sorted(FIELDS))
def test_a_fit_is_over_any_name_of_its_field(field: str) -> None:
    path, _, last = field.rpartition("/")
    for other in other_names(last):
        scale = IN_SI[max((end for end in IN_SI if other.endswith(end)), key=len)]
        fit = FitIn.model_validate({"over": f"{path}/{other}", "from": 1, "to": 2, "degree": 2})
        assert fit.over == field
        assert [fit.from_, fit.to] == pytest.approx(sorted([scale(1), scale(2)]))


def test_a_scheduled_plant_is_over_any_name_of_its_field() -> None:
    plant = {"kind": "mode", "period_s": 1.0}
    given = {"kind": "scheduled", "plant": plant, "over": "period_ms", "from": 500, "to": 2000}
    told = ScheduledIn.model_validate(given)
    assert isinstance(told.plant, ModeIn)
    assert (told.over, told.plant.natural_frequency_rad_s) == (
        "natural_frequency_rad_s",
        2 * math.pi,
    )
    assert [told.from_, told.to] == pytest.approx([math.pi, 4 * math.pi])


@pytest.mark.parametrize("axis", [AxisIn, TableAxis])
@pytest.mark.parametrize("spacing", ["linear", "geometric"])
@pytest.mark.parametrize(
    "field",
    [
        "/plant/cable_length_mm",
        "/plant/natural_frequency_hz",
        "/plant/period_s",
        "/plant/log_decrement",
        "/actuator/accel/period_ms",
    ],
)
def test_an_axis_is_spaced_in_the_unit_that_it_is_given_in(
    axis: type[AxisIn | TableAxis], spacing: Literal["linear", "geometric"], field: str
) -> None:
    scale = IN_SI[max((end for end in IN_SI if field.endswith(end)), key=len)]
    given = {"field": field, "from": 1.0, "to": 3.0, "points": 5, "spacing": spacing}
    told = axis.model_validate(given).to_design()
    space = np.linspace if spacing == "linear" else np.geomspace
    expected = sorted(scale(value) for value in space(1.0, 3.0, 5))
    assert told.values[np.arange(5)] == pytest.approx(expected)
    assert told.path[-1] in {"cable_length_m", "natural_frequency_rad_s", "damping_ratio"}
    listed = axis.model_validate({"field": field, "values": [1.0, 3.0]}).to_design()
    assert listed.values == pytest.approx([scale(1.0), scale(3.0)])


@pytest.mark.parametrize("axis", [AxisIn, TableAxis])
@pytest.mark.parametrize(
    ("ends", "spacing", "code"),
    [
        ((3.0, 1.0), "linear", "range_reversed"),
        ((1.0, 1.0), "linear", "range_reversed"),
        ((0.0, 1.0), "geometric", "geometric_from_zero"),
    ],
)
def test_a_range_that_is_none_is_refused_in_any_unit(
    axis: type[AxisIn | TableAxis], ends: tuple[float, float], spacing: str, code: str
) -> None:
    start, stop = ends
    for field in ("/plant/period_s", "/plant/log_decrement", "/plant/cable_length_mm"):
        given = {"field": field, "from": start, "to": stop, "points": 5, "spacing": spacing}
        told = axis.model_validate(given)
        with refused(code):
            told.to_design()


def test_a_long_axis_over_a_period_is_refused() -> None:
    given = {"field": "/plant/period_s", "from": 1.0, "to": 3.0, "points": 100_001}
    with pytest.raises(ValidationError, match="100000 points at most"):
        TableAxis.model_validate(given)


def test_listed_designs_are_read_in_any_unit_and_kept_in_si() -> None:
    listed: list[dict[str, Any]] = [
        {"plant": {"cable_length_mm": 800}},
        {"plant": {"cable_length_m": 0.9}},
    ]
    design = {name: CRANE[name] for name in ("plant", "actuator", "shaper")}
    told = TableRequest.model_validate({"design": design, "designs": listed})
    assert told.designs == [{"plant": {"cable_length_m": 0.8}}, {"plant": {"cable_length_m": 0.9}}]
    assert "mm" not in told.canonical()
    listed[0]["plant"]["cable_length_m"] = 0.8
    with pytest.raises(ValidationError, match="cable_length_mm and cable_length_m"):
        TableRequest.model_validate({"design": design, "designs": listed})


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.__name__)
def test_no_name_of_a_field_is_a_unit_of_another(model: type[BaseModel]) -> None:
    names = wire_names(model)
    assert max(map(len, names), default=0) < MAX_NAME_CHARACTERS - len("_mm_s3")
    for name in names:
        reading = reading_of(name)
        assert reading is None or reading.name not in names


def test_what_is_in_si_units_is_held_once() -> None:
    designs: list[dict[str, Any]] = [{}, {"plant": {"damping_ratio": 0.01}}]
    assert all_in_si(designs) is designs
    read = all_in_si([*designs, {"plant": {"log_decrement": 0.0}}])
    assert read[1] is designs[1]
    assert read[2] == {"plant": {"damping_ratio": 0.0}}
