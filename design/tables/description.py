"""What a table's specification says of its plant, actuator and shaper."""

import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from design.actuators import (
    Actuator,
    FirstOrder,
    Ideal,
    RateLimited,
    SecondOrder,
    SecondOrderSet,
    Unlimited,
)
from design.errors import InvalidInputError
from design.plants import Mode, Pendulum, Plant
from design.tables.rows import Rows, TableHead
from design.types import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Description:
    """What the rows of a table are designs of.

    Attributes
    ----------
    plant, actuator
        With the values of the specification where no row tells another.
    shaper
        Name of the kind of shaper.
    """

    plant: Plant
    actuator: Actuator
    shaper: str


def described(head: TableHead) -> Description:
    """Read plant, actuator and kind of shaper from the specification of a table."""
    design: dict[str, Any] = json.loads(head.specification_json)["design"]
    return Description(
        plant=_plant(**design["plant"]),
        actuator=_actuator(**design["actuator"]),
        shaper=design["shaper"]["kind"],
    )


def _plant(kind: str, **values: Any) -> Plant:  # noqa: ANN401
    if kind == "pendulum":
        return Pendulum(**values)
    return Mode(**(values["modes"][0] if kind == "modes" else values))


def _actuator(kind: str, **values: Any) -> Actuator:  # noqa: ANN401
    if kind == "rate_limited":
        return RateLimited(**{
            **values,
            "then": _unlimited(**values.get("then", {"kind": "ideal"})),
        })
    return _unlimited(kind, **values)


def _unlimited(kind: str, **values: Any) -> Unlimited:  # noqa: ANN401
    if kind == "first_order":
        return FirstOrder(**values)
    if kind == "second_order":
        accel, decel = (SecondOrderSet(**values.pop(name)) for name in ("accel", "decel"))
        return SecondOrder(accel=accel, decel=decel, **values)
    return Ideal()


def names_of(head: TableHead, kind: str) -> list[str]:
    """Return the names of the columns of one kind, in order."""
    return [column.name for column in head.columns if column.kind == kind]


def times_of(head: TableHead, rows: Rows) -> FloatArray:
    """Return the times of the impulses in every row, shape (m, impulses) [s].

    Raises
    ------
    InvalidInputError
        If the table has no columns of times.
    """
    wanted = [f"t{number}_s" for number in range(1, head.impulses + 1)]
    return rows.results[:, _positions(head, wanted, "times_s")]


def amplitudes_of(head: TableHead, rows: Rows) -> FloatArray:
    """Return the heights of the impulses in every row, shape (m, impulses) [-].

    Those of the head where the table has no columns of amplitudes.
    """
    if "a1" not in names_of(head, "result"):
        return np.broadcast_to(np.array(head.amplitudes), (rows.status.size, head.impulses))
    wanted = [f"a{number}" for number in range(1, head.impulses + 1)]
    return rows.results[:, _positions(head, wanted, "amplitudes")]


def _positions(head: TableHead, wanted: list[str], column: str) -> list[int]:
    names = names_of(head, "result")
    if not set(wanted) <= set(names):
        raise InvalidInputError("columns", names, f"with {column!r} among them")
    return [names.index(name) for name in wanted]


def require_times(head: TableHead) -> None:
    """Raise InvalidInputError unless the table has columns of times."""
    _positions(head, [f"t{number}_s" for number in range(1, head.impulses + 1)], "times_s")


def mode_of(plant: Plant, names: list[str], values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return natural frequency and damping ratio of the plant at many values of fields.

    Parameters
    ----------
    plant
        What the fields are varied in.
    names
        Names of the fields, as ``plant.cable_length_m``; those of other parts are passed over.
    values
        Their values, shape (m, len(names)).

    Returns
    -------
    tuple of FloatArray
        Natural frequencies, shape (m,) [rad/s], and damping ratios, shape (m,) [-].
    """

    def of(field: str) -> FloatArray:
        if f"plant.{field}" in names:
            return values[:, names.index(f"plant.{field}")]
        return np.full(len(values), float(getattr(plant, field)))

    if isinstance(plant, Pendulum):
        return np.sqrt(of("gravity_m_s2") / of("cable_length_m")), of("damping_ratio")
    return of("natural_frequency_rad_s"), of("damping_ratio")
