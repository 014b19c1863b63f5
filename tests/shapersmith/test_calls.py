"""The functions answer what the wire answers, and take what it takes."""

import inspect
import json

import numpy as np
import pytest

import shapersmith
from schemas.sensitivity_curves import SensitivityIn
from service.dispatch import answer
from service.operations.table import TABLE, load
from shapersmith.calls import Calls
from shapersmith.here import HERE
from tests.conftest import CRANE
from tests.shapersmith.requests import REQUESTS, call

PENDULUM = shapersmith.Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
DRIVE = shapersmith.SecondOrder(
    accel=shapersmith.SecondOrderSet(natural_frequency_rad_s=20, damping_ratio=0.8),
    decel=shapersmith.SecondOrderSet(natural_frequency_rad_s=50, damping_ratio=1.5),
)


@pytest.mark.parametrize("operation", TABLE)
def test_a_function_answers_what_the_wire_answers(operation: str) -> None:
    request = REQUESTS[operation]
    outcome = answer(operation, json.dumps(request).encode()).outcome
    assert isinstance(outcome, bytes), outcome
    assert call(HERE, operation)(**request).to_dict() == json.loads(outcome)


@pytest.mark.parametrize("operation", TABLE)
def test_arguments_are_the_fields_of_the_request_with_their_defaults(operation: str) -> None:
    fields = load(operation).request.model_fields
    parameters = inspect.signature(call(HERE, operation)).parameters
    assert set(parameters) == set(fields)
    for name, parameter in parameters.items():
        given = parameter.default
        assert (given is inspect.Parameter.empty) == fields[name].is_required(), name
        if not fields[name].is_required():
            usual = fields[name].default
            plain = SensitivityIn(**dict(given)) if isinstance(usual, SensitivityIn) else given
            assert plain == usual, name


def test_models_and_objects_of_json_ask_the_same() -> None:
    of_models = shapersmith.design(PENDULUM, DRIVE, "numzvd")
    assert of_models.to_dict() == shapersmith.design(**CRANE).to_dict()


def test_a_recommended_shaper_is_designed_as_it_stands_in_the_answer() -> None:
    mode = shapersmith.Mode(natural_frequency_rad_s=3.5)
    best = shapersmith.recommend(mode, shapersmith.Ideal(), half_width=0.1, sign="unity")
    found = shapersmith.design(mode, shapersmith.Ideal(), best.recommended.shaper)
    assert found.amplitudes.tolist() == best.amplitudes.tolist()


def test_impulses_of_an_answer_are_taken_as_they_are() -> None:
    found = shapersmith.design(PENDULUM, DRIVE, "numzvd")
    curve = shapersmith.sensitivity(found.steps, PENDULUM, DRIVE)
    assert found.sensitivity is not None
    assert curve.sensitivity == found.sensitivity


def test_arrays_and_numbers_of_numpy_are_taken() -> None:
    mode = shapersmith.Mode(natural_frequency_rad_s=np.float32(3.5))  # type: ignore[arg-type]
    steps = {"times_s": np.array([0.0, 0.9]), "amplitudes": np.array([0.5, 0.5])}
    curve = shapersmith.sensitivity(steps, mode, shapersmith.Ideal(), points=np.int64(11))  # type: ignore[arg-type]
    impulses = shapersmith.Impulses(**steps)  # type: ignore[arg-type]
    assert curve == shapersmith.sensitivity(impulses, mode, shapersmith.Ideal(), points=11)


def test_what_json_cannot_hold_is_named() -> None:
    with pytest.raises(TypeError, match="takes numbers, texts and its own models, got <object"):
        shapersmith.design(PENDULUM, DRIVE, object())  # type: ignore[arg-type]


def test_the_package_has_each_call_as_a_function() -> None:
    calls = {name for name in Calls.__dict__ if not name.startswith("_")} - {"ask"}
    assert calls == {call(HERE, operation).__name__ for operation in TABLE}
    for name in calls:
        assert getattr(shapersmith, name) == getattr(HERE, name)
