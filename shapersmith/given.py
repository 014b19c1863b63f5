"""What is given: the wire models, with their `kind` filled in and their faults as our errors."""

import json
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Literal, NoReturn, Self

from pydantic import (
    ConfigDict,
    ModelWrapValidatorHandler,
    TypeAdapter,
    ValidationError,
    model_validator,
)

from schemas import (
    actuators,
    damping,
    drive_sensitivity,
    fits,
    impulses,
    maneuvers,
    maps,
    plants,
    sensitivity_curves,
    simulations,
    tables,
)
from schemas.base import Wire
from schemas.problems import FieldFault
from schemas.shaper_request import ShaperRequest
from schemas.shapers import ShaperIn
from service.plain_words import echo
from service.problems import invalid_fields, problem_of_validation
from shapersmith.errors import raise_problem

Json = Mapping[str, Any]
"""An object as JSON has it, which stands for any of these models."""


class Given(Wire):
    """A wire model that is made in Python: from NumPy too, and refused as HTTP refuses it."""

    model_config = ConfigDict(validate_by_name=True)

    if not TYPE_CHECKING:  # a type checker reads the fields, and finds this by itself

        def __new__(cls, *unnamed: object, **_: object) -> Self:
            """Make one; refuse values without a name."""
            if unnamed:
                _refuse_unnamed(cls, unnamed)
            return object.__new__(cls)

    @model_validator(mode="wrap")
    @classmethod
    def _validate(cls, values: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:  # noqa: ANN401
        if isinstance(values, dict):
            fields = cls.model_fields
            kind = {"kind": fields["kind"].default} if "kind" in fields else {}
            values = kind | {name: _plain(value) for name, value in values.items()}
        try:
            return handler(values)
        except ValidationError as error:
            _refuse(error, values, cls._validate_json, cls.__bases__[1])

    @classmethod
    def _validate_json(cls, body: str) -> object:
        """Validate JSON by the model of the wire that this one is made from."""
        wire: type[Wire] = cls.__bases__[1]
        return wire.model_validate_json(body, by_alias=True, by_name=True)


def _refuse_unnamed(model: type[Wire], values: tuple[object, ...]) -> NoReturn:
    """Refuse values that are given in order, and say how the first is given."""
    first = next((name for name in model.model_fields if name != "kind"), None)
    example = "" if first is None else f"{first}={echo(_plain(values[0]))}"
    takes = "no values" if first is None else "its values by name"
    told = f"{model.__name__} takes {takes}, as {model.__name__}({example})"
    fault = FieldFault(pointer="", code="value_without_name", detail=told)
    raise_problem(invalid_fields(told, (fault,)).document())


def _plain(value: Any) -> Any:  # noqa: ANN401
    """Return arrays and tuples as lists, numbers of NumPy as Python's own; all else as it is."""
    if isinstance(value, tuple):
        return list(value)
    return value.tolist() if hasattr(value, "tolist") else value


def _refuse(
    error: ValidationError,
    values: object,
    validate_json: Callable[[str], object],
    model: Any,  # noqa: ANN401 - a model, or a union of them
) -> NoReturn:
    """Raise the error in the words of HTTP, which are those for JSON."""
    body = json.dumps(values, default=_unpacked_or_named)
    try:
        validate_json(body)
    except ValidationError as error_of_json:
        error = error_of_json
    raise_problem(problem_of_validation(error, body, model).document())


def _unpacked_or_named(value: object) -> object:
    return _unpacked(value) if isinstance(value, Wire) else repr(value)


def as_json(value: object) -> bytes:
    """Return JSON of what is given, with every field by its name on the wire."""
    return json.dumps(value, default=_unpacked).encode()


def _unpacked(value: object) -> object:
    if isinstance(value, Wire):
        return value.model_dump(mode="json", by_alias=True)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"shapersmith takes numbers, texts and its own models, got {value!r}")


class Mode(Given, plants.ModeIn):
    """One vibration mode.

    Examples
    --------
    >>> Mode(natural_frequency_rad_s=3.5)
    Mode(natural_frequency_rad_s=3.5, damping_ratio=0.0, kind='mode')
    >>> Mode(natural_frequency_rad_s=-3.5)
    Traceback (most recent call last):
    shapersmith.errors.InvalidInputError: /natural_frequency_rad_s: must be greater than 0, got -3.5
    """

    kind: Literal["mode"] = "mode"


class Modes(Given, plants.ModesIn):
    """Several vibration modes of one plant, each a `Mode`."""

    kind: Literal["modes"] = "modes"


class FreeBody(Given, plants.FreeBodyIn):
    """A body that nothing holds, moved by an on-off force: in maneuvers, with force_n."""

    kind: Literal["free_body"] = "free_body"


class Pendulum(Given, plants.PendulumIn):
    """A load on a cable, at small angles."""

    kind: Literal["pendulum"] = "pendulum"


class LengthCourse(Given, plants.LengthCourseIn):
    """A length over time: linear between points, held before and after them."""


class Hoisting(Given, plants.HoistingIn):
    """A load on a cable that is hoisted or lowered meanwhile: in maneuvers and simulations.

    Examples
    --------
    >>> course = LengthCourse(times_s=[0, 5], values=[0.8, 0.5])
    >>> Hoisting(cable_length_m=course).damping_ratio
    0.0
    """

    kind: Literal["hoisting"] = "hoisting"


class DoublePendulum(Given, plants.DoublePendulumIn):
    """A load slung below a hook of some mass, at small angles: two modes.

    Examples
    --------
    >>> crane = DoublePendulum(
    ...     hook_mass_kg=0.385, load_mass_kg=0.6, cable_length_m=0.8, load_length_m=0.25
    ... )
    >>> [round(mode.natural_frequency_rad_s, 4) for mode in crane.to_design().modes]
    [3.1807, 11.0274]
    """

    kind: Literal["double_pendulum"] = "double_pendulum"


class SpringMass(Given, plants.SpringMassIn):
    """A load held by a spring."""

    kind: Literal["spring_mass"] = "spring_mass"


class Scheduled(Given, plants.ScheduledIn):
    """A plant with one field anywhere in a range.

    Examples
    --------
    >>> crane = Pendulum(cable_length_m=0.8)
    >>> Scheduled(plant=crane, over="cable_length_m", from_=0.6, to=1.0).to
    1.0
    """

    kind: Literal["scheduled"] = "scheduled"


class Ideal(Given, actuators.IdealIn):
    """An actuator that follows its command at once."""

    kind: Literal["ideal"] = "ideal"


class FirstOrder(Given, actuators.FirstOrderIn):
    """First-order lag, its time constant by direction."""

    kind: Literal["first_order"] = "first_order"


class SecondOrderSet(Given, actuators.SecondOrderSetIn):
    """One direction of a second-order actuator."""


class SecondOrder(Given, actuators.SecondOrderIn):
    """Second-order actuator, a `SecondOrderSet` for each direction."""

    kind: Literal["second_order"] = "second_order"


class RateLimited(Given, actuators.RateLimitedIn):
    """Limits to acceleration, deceleration and jerk, and what follows the limited command."""

    kind: Literal["rate_limited"] = "rate_limited"


class Impulses(Given, impulses.ImpulsesWire):
    """Steps of a velocity command."""


class SensitivityRange(Given, sensitivity_curves.SensitivityIn):
    """Range of the sensitivity curve that is wanted."""


class DampingRange(Given, damping.DampingIn):
    """Range of a curve over the damping ratio."""


class DriveRange(Given, drive_sensitivity.DriveIn):
    """By how much the parameters of a drive may be off."""


class DampingBand(Given, damping.DampingRangeIn):
    """Which damping ratios the plant of a recommendation may have."""


class FitRange(Given, fits.FitIn):
    """Over which field to fit, and how well."""


class AngleSwing(Given, maneuvers.AngleSwingIn):
    """Swing of a pendulum at the first step, positive where the load is ahead in +x."""


class DeflectionSwing(Given, maneuvers.DeflectionSwingIn):
    """Swing of a mode at the first step, positive in +x."""


class StepCommand(Given, simulations.StepCommand):
    """Full speed from time 0 on."""

    kind: Literal["step"] = "step"


class PulseCommand(Given, simulations.PulseCommand):
    """Full speed for some time."""

    kind: Literal["pulse"] = "pulse"


class ImpulsesCommand(Given, simulations.ImpulsesCommand):
    """Steps as shares of full speed."""

    kind: Literal["impulses"] = "impulses"


class SampledCommand(Given, simulations.SampledCommand):
    """Velocities at a sample time."""

    kind: Literal["sampled"] = "sampled"


class ListCommand(Given, simulations.ListCommand):
    """Velocities at times."""

    kind: Literal["list"] = "list"


class Axis(Given, maps.AxisIn):
    """One field of a map and its values: a range, or `values`."""


class TableAxis(Given, tables.TableAxis):
    """One field of a table and its values: a range with its `points`, or `values`."""


class Move(Given, maps.MoveIn):
    """The move that the shaper of a map starts and stops."""


_SHAPER: TypeAdapter[ShaperRequest] = TypeAdapter(ShaperIn)


def shaper(kind: str, **parameters: object) -> ShaperRequest:
    """Return a kind of shaper with its parameters.

    Parameters
    ----------
    kind
        Name of the kind, as ``ei``.
    **parameters
        Parameters of that kind, and ``sample_time_s`` [s].

    Returns
    -------
    ShaperRequest
        What every function here takes in place of the name of a kind.

    Raises
    ------
    InvalidInputError
        If there is no such kind, or a parameter breaks its rule.

    Examples
    --------
    >>> shaper("ei", tolerance=0.02)
    EiIn(sample_time_s=None, sample_tolerance=None, kind='ei', tolerance=0.02)
    """
    values = {"kind": kind, **{name: _plain(value) for name, value in parameters.items()}}
    try:
        return _SHAPER.validate_python(values)
    except ValidationError as error:
        _refuse(error, values, _SHAPER.validate_json, ShaperIn)
