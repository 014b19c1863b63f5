"""Rows of a table against a bare compiled Newton and against SciPy's SLSQP."""

import math
import time
from collections.abc import Callable, Iterator
from statistics import median

import numba
import numpy as np
from scipy.optimize import minimize

from benchmarks.measure import Figure
from design.formulations.published_times import ZVD_POLYNOMIALS
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.plants.mode import Mode
from design.shapers.registry import SHAPERS
from design.tables.compute import compute_rows
from design.tables.kernel import rows_of_problems, solve_rows
from design.tables.parameters import row_parameters
from design.tables.proofs import proven
from design.tables.specification import TableSpecification
from design.tables.starts import FOUND
from design.types import FloatArray

ROWS = 1_000_000
SLSQP_ROWS = 200
ROUNDS = 3
POLYNOMIALS = 2 * math.pi * np.array(ZVD_POLYNOMIALS)


@numba.njit(error_model="numpy")
def equations(lags, t, values, jacobian):  # type: ignore[no-untyped-def] # noqa: ANN001, ANN201
    """Write V, dV/dw and their Jacobian by the times, as on paper: five terms each."""
    z = lags[0]
    s = complex(-z, math.sqrt(1 - z * z))
    vector, change = 0j, 0j
    for i in range(5):
        set_at = 1 if i % 2 == 0 else 3
        below = 1 + s * (lags[set_at] + s * lags[set_at + 1])
        gain = (1.0 if i % 2 == 0 else -1.0) / below
        slope = -gain * s * (lags[set_at] + 2 * lags[set_at + 1] * s) / below
        time = t[i - 1] if i > 0 else 0.0
        size = math.exp(z * time)
        turn = complex(size * math.cos(s.imag * time), -size * math.sin(s.imag * time))
        vector += gain * turn
        change += (slope - gain * s * time) * turn
        if i > 0:
            by_time = -s * gain * turn
            change_by_time = (-s * (slope - gain * s * time) - gain * s) * turn
            jacobian[0, i - 1], jacobian[1, i - 1] = by_time.real, by_time.imag
            jacobian[2, i - 1], jacobian[3, i - 1] = change_by_time.real, change_by_time.imag
    values[0], values[1] = vector.real, vector.imag
    values[2], values[3] = change.real, change.imag


@numba.njit(error_model="numpy")
def bare_newton(lags, polynomials, times):  # type: ignore[no-untyped-def] # noqa: ANN001, ANN201
    """Solve every row from the published seed, and look at nothing else."""
    values, jacobian = np.empty(4), np.empty((4, 4))
    for m in range(lags.shape[0]):
        z, t = lags[m, 0], times[m]
        for k in range(4):
            p = polynomials[k]
            t[k] = p[0] + z * (p[1] + z * (p[2] + z * p[3]))
        for _ in range(12):
            equations(lags[m], t, values, jacobian)
            miss = 0.0
            for k in range(4):
                miss = max(miss, abs(values[k]))
            if miss < 1e-12:
                break
            for c in range(4):
                pivot = c
                for r in range(c + 1, 4):
                    if abs(jacobian[r, c]) > abs(jacobian[pivot, c]):
                        pivot = r
                for k in range(4):
                    jacobian[c, k], jacobian[pivot, k] = jacobian[pivot, k], jacobian[c, k]
                values[c], values[pivot] = values[pivot], values[c]
                for r in range(c + 1, 4):
                    factor = jacobian[r, c] / jacobian[c, c]
                    for k in range(c + 1, 4):
                        jacobian[r, k] -= factor * jacobian[c, k]
                    values[r] -= factor * values[c]
            for r in range(3, -1, -1):
                for k in range(r + 1, 4):
                    values[r] -= jacobian[r, k] * values[k]
                values[r] /= jacobian[r, r]
                t[r] -= values[r]


def slsqp(lags: FloatArray) -> None:
    """Minimise the last time under the same equations, with their analytic Jacobian."""
    z = lags[0]
    values, jacobian = np.empty(4), np.empty((4, 4))

    def constraint(t: FloatArray) -> FloatArray:
        equations(lags, t, values, jacobian)
        return values.copy()

    def slope(t: FloatArray) -> FloatArray:
        equations(lags, t, values, jacobian)
        return jacobian.copy()

    minimize(
        lambda t: t[3],
        POLYNOMIALS @ [1, z, z * z, z**3],
        jac=lambda _: np.array([0.0, 0.0, 0.0, 1.0]),
        constraints={"type": "eq", "fun": constraint, "jac": slope},
        method="SLSQP",
        options={"ftol": 1e-12},
    )


def slsqp_all(lags: FloatArray) -> None:
    """Solve row by row."""
    for one in lags:
        slsqp(one)


def machines() -> TableSpecification:
    """List cranes and drives: w 1-10 rad/s, z 0-.1, poles 6-20 w, their damping .5-1.5."""
    rng = np.random.default_rng(1)
    w = rng.uniform(1, 10, ROWS)
    one = SecondOrderSet(natural_frequency_rad_s=1.0, damping_ratio=1.0)
    columns = {
        ("plant", "natural_frequency_rad_s"): w,
        ("plant", "damping_ratio"): rng.uniform(0, 0.1, ROWS),
        ("actuator", "accel", "natural_frequency_rad_s"): w * rng.uniform(6, 20, ROWS),
        ("actuator", "accel", "damping_ratio"): rng.uniform(0.5, 1.5, ROWS),
        ("actuator", "decel", "natural_frequency_rad_s"): w * rng.uniform(6, 20, ROWS),
        ("actuator", "decel", "damping_ratio"): rng.uniform(0.5, 1.5, ROWS),
    }
    return TableSpecification(
        plant=Mode(natural_frequency_rad_s=1.0),
        actuator=SecondOrder(accel=one, decel=one),
        kind=SHAPERS["numzvd"],
        options=SHAPERS["numzvd"].options(),
        listed=np.stack(list(columns.values()), axis=1),
        listed_paths=tuple(columns),
        columns=("times_s", "residual"),
    )


def seconds_of(run: Callable[[], object]) -> float:
    """Return the processor time of one call: other processes of the machine do not count."""
    started = time.process_time()
    run()
    return time.process_time() - started


def kernel(table: TableSpecification) -> int:
    """Solve and prove every row in chunks of a job's size; return how many have a root."""
    found = 0
    for start in range(0, ROWS, table.chunk_rows):
        parameters = row_parameters(table, table.field_values(start, start + table.chunk_rows))
        rows = rows_of_problems(parameters.lags, parameters.max_duration_periods, settle=False)
        gaps, ends = solve_rows(rows, 5, switched=False)
        times = np.zeros((len(gaps), 5))
        np.cumsum(gaps, axis=1, out=times[:, 1:])
        w = parameters.natural_frequencies_rad_s
        proven(parameters.lags, w, times / w[:, None], switched=False, slopes=True)
        found += int((ends == FOUND).sum())
    return found


def every_row(table: TableSpecification) -> None:
    """Compute the table in chunks."""
    for start in range(0, ROWS, table.chunk_rows):
        compute_rows(table, start, start + table.chunk_rows)


def figures() -> Iterator[Figure]:
    """Measure."""
    table = machines()
    lags = row_parameters(table, table.field_values(0, ROWS)).lags
    times = np.empty((ROWS, 4))
    compute_rows(table, 0, 10)
    bare_newton(lags[:1], POLYNOMIALS, times[:1])
    slsqp(lags[0])
    bare, whole, peer = [], [], []
    for _ in range(ROUNDS):
        bare.append(seconds_of(lambda: bare_newton(lags, POLYNOMIALS, times)) / ROWS)
        whole.append(seconds_of(lambda: kernel(table)) / ROWS)
        peer.append(seconds_of(lambda: slsqp_all(lags[:SLSQP_ROWS])) / SLSQP_ROWS)
    all_of_it = seconds_of(lambda: every_row(table)) / ROWS
    share = median(a / b for a, b in zip(whole, bare, strict=True))
    yield Figure(
        what="kernel with certificate, superposed NUMZVD, 1e6 rows / bare compiled Newton",
        value=f"{share:.2f} ({1e6 * median(whole):.2f} / {1e6 * median(bare):.2f} us)",
        limit="<= 5",
        met=share <= 5,
        over_peer=share,
    )
    gain = median(b / a for a, b in zip(whole, peer, strict=True))
    yield Figure(
        what="kernel with certificate / SciPy SLSQP, analytic Jacobian",
        value=f"{1 / gain:.4f} ({1e6 * median(peer):.0f} us)",
        limit="<= 0.005",
        met=gain >= 200,
        over_peer=1 / gain,
    )
    yield Figure(
        what="a row of such a table with all that the pipeline does for it, one core",
        value=f"{1e6 * all_of_it:.2f} us",
        limit="",
        met=None,
    )
