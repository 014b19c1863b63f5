"""What takes long beside the rest of the suite, which holds a shorter form of most of it."""

import importlib
import os
import platform
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from service.settings import Settings
from tests.design.shapers.test_damping import require_what_is_claimed_or_a_reason
from tests.design.shapers.test_several_modes import require_words_where_modes_are_far_apart
from tests.patience import PATIENT_S
from tests.service.http.test_tables_over_http import require_largest_answered
from tests.shaper_table import SHAPER_TABLE

ROOT = Path(__file__).parents[2]

PRINT_CHECKSUM = """
import zlib
from dataclasses import replace
from design.tables.compute import compute_with_counts
from tests.table_cases import random_table

table = random_table(300, 3, order=2)
table = replace(table, listed=table.listed.round(6))  # made by the library's exponential
rows, counts = compute_with_counts(table, 0, 300)
print(counts.compiled, zlib.crc32(rows.results.tobytes()))
"""


def test_compiled_rows_are_the_same_to_the_bit_on_any_kind_of_machine(tmp_path: Path) -> None:
    """Here, and on an older machine: narrow vectors, no fused multiply-adds.

    Some of the rows come from the search of all branches.
    """
    umath: Any = importlib.import_module("numpy._core._multiarray_umath")
    newer = [name for name in umath.__cpu_dispatch__ if umath.__cpu_features__[name]]
    plain = {
        "NPY_DISABLE_CPU_FEATURES": ",".join(newer),
        "NUMBA_CPU_NAME": "generic",
        "NUMBA_CPU_FEATURES": "-avx" if platform.machine() == "x86_64" else "",
        "NUMBA_CACHE_DIR": str(tmp_path),
    }
    printed = [
        subprocess.run(
            [sys.executable, "-c", PRINT_CHECKSUM],
            env=os.environ | {"PYTHONPATH": str(ROOT)} | changes,
            capture_output=True,
            text=True,
            check=True,
            timeout=PATIENT_S,
        ).stdout
        for changes in ({}, plain)
    ]
    assert printed[0].startswith("300 ")
    assert printed[1] == printed[0]


@pytest.mark.parametrize("name", SHAPER_TABLE)
def test_a_heavily_damped_plant_gets_what_is_claimed_or_a_reason(name: str) -> None:
    require_what_is_claimed_or_a_reason(name, 0.9)


def test_modes_too_far_apart_for_doubles_are_refused_in_words() -> None:
    require_words_where_modes_are_far_apart(each=20)


def test_the_largest_body_is_answered(tmp_path: Path) -> None:
    require_largest_answered(tmp_path, Settings().max_table_bytes)
