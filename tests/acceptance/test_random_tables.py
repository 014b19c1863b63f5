"""A hundred thousand random machines as tables: none is verified that another route refutes."""

import numpy as np
import pytest

from design.analysis.certificate import certify
from design.claims import ZERO_LIMITS, zeros
from design.model.actuators.model import Model
from design.model.impulses import Impulses
from design.tables.compute import compute_with_counts
from design.tables.rows import VERIFIED
from tests.second_route import claims_by_formula
from tests.table_cases import random_table

ROWS = 25_000
SIMULATED = 500


@pytest.mark.parametrize("model", ["superposed", "switched"])
@pytest.mark.parametrize("order", [1, 2])
def test_rows_marked_verified_are_shapers(order: int, model: Model) -> None:
    """At least 99.5 % are verified; of those, evenly drawn ones are simulated apart."""
    table = random_table(ROWS, 100 + order, order=order, model=model)
    rows, counts = compute_with_counts(table, 0, ROWS)
    verified = np.flatnonzero(rows.status == VERIFIED)
    assert verified.size >= 0.995 * ROWS
    assert set(rows.reasons) == set(np.flatnonzero(rows.status != VERIFIED).tolist())
    assert counts.corrected == 0
    assert (np.diff(rows.results[verified, :5], axis=1) > 0).all()
    for index in verified[:: max(1, verified.size // SIMULATED)].tolist():
        plant, actuator, _ = table.at(rows.fields[index])
        impulses = Impulses(
            times_s=rows.results[index, :5], amplitudes=np.array([1.0, -1.0, 1.0, -1.0, 1.0])
        )
        assert certify(impulses, plant.mode, actuator, zeros(["residual", "slope"])).verified
        if model == "superposed":
            left = claims_by_formula(impulses, plant.mode, actuator)
            assert left["residual"] <= ZERO_LIMITS["residual"]
            assert left["slope"] <= ZERO_LIMITS["slope"]
