"""What is given in Python is what the wire has, and refused in the same words."""

import json
from typing import Any, get_args

import pytest

import shapersmith
from schemas.actuators import ActuatorIn
from schemas.base import Wire
from schemas.plants import PlantIn
from schemas.simulations import CommandIn
from service.dispatch import respond
from service.problems import Problem
from shapersmith import given
from tests.conftest import CRANE

MODELS = [
    model
    for model in vars(given).values()
    if isinstance(model, type) and issubclass(model, given.Given) and model is not given.Given
]


@pytest.mark.parametrize(
    "union", [PlantIn, ActuatorIn, CommandIn], ids=["plant", "actuator", "command"]
)
def test_every_kind_of_the_wire_has_its_model(union: Any) -> None:
    (kinds, _) = get_args(union)
    for kind in get_args(kinds):
        (model,) = (one for one in MODELS if issubclass(one, kind))
        assert (model.model_fields["kind"].default,) == get_args(
            kind.model_fields["kind"].annotation
        )
        assert getattr(shapersmith, model.__name__) is model


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.__name__)
def test_a_value_without_a_name_is_refused_with_the_first_name(model: Any) -> None:
    with pytest.raises(shapersmith.InvalidInputError) as refused:
        model(7.5)
    first = next((name for name in model.model_fields if name != "kind"), None)
    example = "" if first is None else f"{first}=7.5"
    assert refused.value.code == "value_without_name"
    assert refused.value.detail.endswith(f", as {model.__name__}({example})")


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.__name__)
def test_a_model_adds_no_field(model: type[Wire]) -> None:
    _, wire, *_ = model.__mro__[1:]
    assert issubclass(wire, Wire)
    assert set(model.model_fields) == set(wire.model_fields)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("cable_length_m", -1.0),
        ("cable_length_m", float("nan")),
        ("cable_length_m", "0.8"),
        ("cable_length_m", None),
        ("cable_length_mm", 800.0),
        ("damping_ratio", 2.0),
    ],
)
def test_a_value_is_refused_in_the_words_of_http(field: str, value: object) -> None:
    values: dict[str, Any] = {"cable_length_m": 0.8, field: value}
    body = {**CRANE, "plant": {"kind": "pendulum", **values}}
    problem = respond("design", json.dumps(body).encode())
    assert isinstance(problem, Problem)
    with pytest.raises(shapersmith.InvalidInputError) as caught:
        shapersmith.Pendulum(**values)
    (fault,), (told,) = caught.value.errors, problem.errors
    assert (f"/plant{fault.pointer}", fault.code, fault.detail) == (
        told.pointer,
        told.code,
        told.detail,
    )
    assert caught.value.code == problem.code


DRIVE = {**CRANE["actuator"], "kind": "second_order"}


@pytest.mark.parametrize(
    ("model", "changed"),
    [
        (shapersmith.SecondOrder, {"decel": 5}),
        (shapersmith.SecondOrder, {"decel": {"damping_ratio": "0.8"}}),
        (shapersmith.RateLimited, {"then": {"kind": "none"}}),
        (shapersmith.RateLimited, {"then": [1]}),
    ],
)
def test_a_value_of_another_type_is_refused_in_the_words_of_http(
    model: type[Wire], changed: dict[str, Any]
) -> None:
    limited = {"accel_limit_m_s2": 0.3, "decel_limit_m_s2": 0.4, "speed_m_s": 1.0}
    values = {**(limited if model is shapersmith.RateLimited else DRIVE), **changed}
    values["kind"] = model.model_fields["kind"].default
    problem = respond("design", json.dumps({**CRANE, "actuator": values}).encode())
    assert isinstance(problem, Problem)
    with pytest.raises(shapersmith.InvalidInputError) as caught:
        model(**values)
    told = [(f"/actuator{one.pointer}", one.code, one.detail) for one in caught.value.errors]
    assert told == [(one.pointer, one.code, one.detail) for one in problem.errors]


def test_what_json_cannot_hold_is_refused_by_its_name() -> None:
    with pytest.raises(shapersmith.InvalidInputError, match=r"/cable_length_m: .*<object object"):
        shapersmith.Pendulum(cable_length_m=object())  # type: ignore[arg-type]


def test_a_missing_field_is_named() -> None:
    with pytest.raises(
        shapersmith.InvalidInputError,
        match=r"^/cable_length_m: must be given, or cable_length_mm in its place$",
    ):
        shapersmith.Pendulum()  # type: ignore[call-arg]


def test_each_of_several_faults_is_named() -> None:
    with pytest.raises(shapersmith.InvalidInputError) as caught:
        shapersmith.FirstOrder(accel_time_constant_s=-1.0, decel_time_constant_s=-1.0)
    pointers = [fault.pointer for fault in caught.value.errors]
    assert pointers == ["/accel_time_constant_s", "/decel_time_constant_s"]
    assert caught.value.code == "out_of_range"


def test_a_kind_of_shaper_and_its_parameters_are_checked_where_they_are_said() -> None:
    with pytest.raises(shapersmith.InvalidInputError, match="numvz") as caught:
        shapersmith.shaper("numvz")
    assert caught.value.code == "unknown_kind"
    with pytest.raises(shapersmith.InvalidInputError, match=r"^/tolerance: must be") as caught:
        shapersmith.shaper("ei", tolerance=2.0)
    assert caught.value.errors[0].pointer == "/tolerance"


def test_a_word_of_python_has_a_dash_below_and_none_on_the_wire() -> None:
    axis = shapersmith.Axis(field="/plant/cable_length_m", from_=0.4, to=1.4)
    assert json.loads(given.as_json(axis))["from"] == 0.4


def test_several_modes_are_sent_without_their_kinds() -> None:
    modes = [shapersmith.Mode(natural_frequency_rad_s=speed) for speed in (3.0, 9.0)]
    sent = json.loads(given.as_json(shapersmith.Modes(modes=[*modes])))
    assert sent == {
        "kind": "modes",
        "modes": [{"natural_frequency_rad_s": speed, "damping_ratio": 0.0} for speed in (3.0, 9.0)],
    }


def test_a_tuple_is_a_list() -> None:
    steps = shapersmith.Impulses(times_s=(0, 0.9), amplitudes=(0.5, 0.5))  # type: ignore[arg-type]
    assert steps == shapersmith.Impulses(times_s=[0, 0.9], amplitudes=[0.5, 0.5])


def test_a_drive_behind_limits_keeps_what_follows_them() -> None:
    drive = shapersmith.RateLimited(
        accel_limit_m_s2=0.3,
        decel_limit_m_s2=0.4,
        speed_m_s=1.0,
        then=shapersmith.FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.1),
    )
    assert json.loads(given.as_json(drive))["then"]["kind"] == "first_order"
