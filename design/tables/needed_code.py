"""Which compiled functions the rows of a table call, and with what, before any of them is called.

Numba compiles a function anew for each combination of types of its arguments. So a table of another
kind, or behind another model of the actuator, may need code that no table before it did.
"""

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from design.tables.compiled import is_kept
from design.tables.compute import compiled_rows_of
from design.tables.kernel import calls_of_rows
from design.tables.parameters import row_parameters
from design.tables.proofs import prove_rows
from design.tables.specification import TableSpecification


class Call(NamedTuple):
    """A compiled function, and arguments of the types with which it is called."""

    function: Callable[..., Any]
    arguments: tuple[Any, ...]


def needed_calls(specification: TableSpecification) -> Iterator[Call]:
    """Yield the calls that the first rows of a table make.

    Parameters
    ----------
    specification
        The table, which says how many impulses a row has.

    Yields
    ------
    Call
        None of a table whose rows are designed one by one.
    """
    how = compiled_rows_of(specification)
    if specification.grid is not None or how is None:
        return
    given = specification.actuator.model == "switched"
    designed_for = given and not how.for_ideal
    rows = row_parameters(specification, specification.field_values(*specification.chunk(0)))
    undamped = rows.lags[:, 0] == 0
    closed = undamped & (how.closed_form_undamped and not designed_for)
    for function, arguments in calls_of_rows(
        specification.impulses or 0,
        switched=designed_for,
        settle=bool(getattr(specification.options, "settle", False)),
        closed=bool(np.any(closed)),
        solved=not bool(np.all(closed)),
    ):
        yield Call(function, arguments)
    claimed = "slope" in specification.kind.claims
    wanted = "slope" in specification.columns
    if how.for_ideal:
        yield _proof(switched=False, slopes=claimed)
    yield _proof(switched=given, slopes=claimed or wanted)


def _proof(*, switched: bool, slopes: bool) -> Call:
    """Return the call of `design.tables.proofs.proven` for no rows."""
    table = np.empty((0, 5))
    models = (True if switched else None, True if slopes else None)
    return Call(prove_rows, (*models, table, np.empty(0), table, table))


def code_is_kept(specification: TableSpecification) -> bool:
    """Return whether all code that the first rows of a table need is on disk.

    Parameters
    ----------
    specification
        The table, which says how many impulses a row has.

    Returns
    -------
    bool
        True of a table that needs none.
    """
    return all(is_kept(*call) for call in needed_calls(specification))
