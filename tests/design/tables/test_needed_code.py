"""What a table needs of compiled code is told before it is called, and is all that it calls."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from design.model.actuators.model import Model
from design.shapers.registry import SHAPERS
from design.shapers.settle_options import SettleOptions
from design.tables import compiled, kernel, proofs, starts
from design.tables.compute import compute_rows, with_impulse_count
from design.tables.needed_code import code_is_kept, needed_calls
from design.tables.specification import TableSpecification
from tests.table_cases import random_table

BY_KERNEL = [name for name, kind in SHAPERS.items() if kind.compiled_rows is not None]

ENTRIES = {
    "_close_triangles": kernel,
    "_settle": kernel,
    "nearest_to_seeds": kernel,
    "prove_rows": proofs,
}
"""What is called from outside of compiled code; `fastest` only where the seeds of a row fail."""


def settles(kind: str) -> bool:
    return isinstance(SHAPERS[kind].options(), SettleOptions)


def table_of(
    kind: str, model: Model, damping: float, *, settle: bool = False
) -> TableSpecification:
    options = SHAPERS[kind].options()
    if settle:
        assert isinstance(options, SettleOptions)
        options = replace(options, settle=True)
    table = random_table(3, 3, order=1, kind=kind, model=model, damping=damping, options=options)
    return with_impulse_count(table)


class Recorded:
    """Notes with what types a compiled function is called, and calls it."""

    def __init__(self, function: Any, name: str, calls: set[tuple[str, Any]]) -> None:
        self._function, self._name, self._calls = function, name, calls

    def __call__(self, *arguments: Any) -> Any:
        self._calls.add((self._name, types_of(self._function, arguments)))
        return self._function(*arguments)


def types_of(function: Any, arguments: tuple[Any, ...]) -> Any:
    return tuple(map(function.typeof_pyval, arguments))


@pytest.mark.parametrize("damping", [0.0, 0.2])
@pytest.mark.parametrize("model", ["superposed", "switched"])
@pytest.mark.parametrize(
    ("kind", "settle"),
    [(kind, settle) for kind in BY_KERNEL for settle in (False, True) if settles(kind) >= settle],
)
def test_what_is_needed_is_what_is_called(
    kind: str, settle: bool, model: Model, damping: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = table_of(kind, model, damping, settle=settle)
    called: set[tuple[str, Any]] = set()
    needed = {
        (name, types_of(call.function, call.arguments))
        for call in needed_calls(table)
        for name, module in ENTRIES.items()
        if getattr(module, name) is call.function
    }
    assert {name for name, _ in needed} == {
        name
        for name, module in ENTRIES.items()
        for call in needed_calls(table)
        if call.function is getattr(module, name)
    }
    for name, module in ENTRIES.items():
        monkeypatch.setattr(module, name, Recorded(getattr(module, name), name, called))
    compute_rows(table, 0, 3)
    assert called == needed
    monkeypatch.undo()
    assert code_is_kept(table)


def test_rows_that_are_designed_one_by_one_need_nothing() -> None:
    table = random_table(3, 3, order=1, kind="num_ei")
    assert not list(needed_calls(table))
    assert code_is_kept(table)


def test_code_for_other_types_is_no_code_of_these() -> None:
    rows, gaps = np.empty((0, 8), dtype=np.float32), np.empty(0, dtype=np.float32)
    assert not compiled.is_kept(starts.within, (rows, gaps, 0.0))
    table = table_of("numzvd", "switched", 0.2)
    compute_rows(table, 0, 1)
    (solving, proving) = needed_calls(table)
    assert compiled.is_kept(*solving)
    *others, _ = proving.arguments
    assert compiled.is_kept(*proving)
    assert not compiled.is_kept(proving.function, (*others, np.empty((0, 2), dtype=np.float32)))
