"""Tables of random machines for the tests."""

from typing import Any

import numpy as np

from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.model import Model
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.mode import Mode
from design.shapers.registry import SHAPERS
from design.tables.specification import TableSpecification
from design.types import FloatArray

COLUMNS = ("times_s", "residual", "slope")


def random_table(
    rows: int,
    seed: int,
    *,
    order: int,
    model: Model = "superposed",
    kind: str = "numzvd",
    damping: float = 0.2,
    poles: tuple[float, float] = (4.0, 20.0),
    options: Any = None,
) -> TableSpecification:
    """List machines: w .5-60 rad/s, z 0-.2, poles 4-20 w, damped .4-1.6; order 0 is ideal."""
    rng = np.random.default_rng(seed)
    w = np.exp(rng.uniform(np.log(0.5), np.log(60.0), rows))
    columns: dict[tuple[str, ...], FloatArray] = {
        ("plant", "natural_frequency_rad_s"): w,
        ("plant", "damping_ratio"): rng.uniform(0, damping, rows),
    }
    corners = dict(zip(("accel", "decel"), w * rng.uniform(*poles, (2, rows)), strict=True))
    actuator: Actuator = Ideal()
    if order == 1:
        actuator = FirstOrder(accel_time_constant_s=1.0, decel_time_constant_s=1.0, model=model)
        for name, corner in corners.items():
            columns["actuator", f"{name}_time_constant_s"] = 1 / corner
    if order == 2:
        one = SecondOrderSet(natural_frequency_rad_s=1.0, damping_ratio=1.0)
        actuator = SecondOrder(accel=one, decel=one, model=model)
        for name, corner in corners.items():
            columns["actuator", name, "natural_frequency_rad_s"] = corner
            columns["actuator", name, "damping_ratio"] = rng.uniform(0.4, 1.6, rows)
    return TableSpecification(
        plant=Mode(natural_frequency_rad_s=1.0),
        actuator=actuator,
        kind=SHAPERS[kind],
        options=SHAPERS[kind].options() if options is None else options,
        listed=np.stack(list(columns.values()), axis=1),
        listed_paths=tuple(columns),
        columns=COLUMNS,
    )
