"""Between the rows of programs: 1,000 random values within the bound that the head states."""

import re
import subprocess
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from design.export.c_header import EXPORT as C
from design.export.lookup import MAX_AXES, Lookup, lookup_of, up
from design.export.structured_text import EXPORT as STRUCTURED_TEXT
from design.model.impulses import Impulses
from design.tables.columns import varied_paths
from design.tables.rows import INFEASIBLE, VERIFIED, Rows, TableHead, subject_of
from design.types import FloatArray
from tests.designed_tables import CRANE, designed_table
from tests.expm_route import outcome
from tests.second_route import claims_by_formula
from tests.structured_text import Block

RANDOM_VALUES = 1_000

FLAGS = ["-Wall", "-Wextra", "-Werror", "-std=c99", "-pedantic", "-Wdouble-promotion", "-O1"]

SWITCHED: dict[str, Any] = {
    "plant": {"kind": "pendulum", "cable_length_m": 9.0},
    "actuator": {
        "kind": "first_order",
        "accel_time_constant_s": 0.3,
        "decel_time_constant_s": 0.15,
        "model": "switched",
    },
    "shaper": {"kind": "numzv"},
}

IDEAL: dict[str, Any] = {
    "plant": {"kind": "spring_mass", "mass_kg": 3.0, "stiffness_n_m": 900.0, "damping_ratio": 0.02},
    "actuator": {"kind": "ideal"},
    "shaper": {"kind": "umzvd"},
}

LIMITED: dict[str, Any] = {
    "plant": {"kind": "mode", "natural_frequency_rad_s": 3.5, "damping_ratio": 0.02},
    "actuator": {
        "kind": "rate_limited",
        "accel_limit_m_s2": 2.0,
        "decel_limit_m_s2": 3.0,
        "speed_m_s": 0.2,
        "then": CRANE["actuator"],
    },
    "shaper": {"kind": "numzvd"},
}

MODE: dict[str, Any] = {**CRANE, "plant": LIMITED["plant"]}

LENGTHS_M = {"plant.cable_length_m": np.linspace(0.3, 1.4, 12).tolist()}

TABLES: dict[str, tuple[dict[str, Any], dict[str, list[float]]]] = {
    "length": (CRANE, LENGTHS_M),
    "switched": (SWITCHED, {"plant.cable_length_m": np.linspace(3.0, 12.0, 10).tolist()}),
    "mass": (
        {**IDEAL, "plant": {**IDEAL["plant"], "damping_ratio": 0.0}},
        {"plant.mass_kg": [1.0, 1.7, 4.0]},
    ),
    "stiffness": (
        {**IDEAL, "actuator": SWITCHED["actuator"], "shaper": {"kind": "numzv"}},
        {"plant.stiffness_n_m": np.geomspace(3.0, 90.0, 9).tolist()},
    ),
    "speed": (LIMITED, {"actuator.speed_m_s": np.linspace(0.1, 0.4, 9).tolist()}),
    "drive": (
        MODE,
        {"actuator.accel.natural_frequency_rad_s": np.linspace(18.0, 30.0, 6).tolist()},
    ),
    "two": (
        CRANE,
        {
            "plant.cable_length_m": np.geomspace(0.3, 1.4, 9).tolist(),
            "plant.damping_ratio": np.linspace(0.0, 0.1, 5).tolist(),
        },
    ),
    "frequencies": (
        MODE,
        {
            "plant.natural_frequency_rad_s": np.linspace(2.5, 4.5, 7).tolist(),
            "actuator.accel.natural_frequency_rad_s": np.linspace(18.0, 30.0, 3).tolist(),
        },
    ),
}
"""Tables by a word for what they vary."""

FORMULA = ("length", "two", "frequencies", "drive")
"""Those whose residual is a sum that needs no simulation."""


@cache
def table(which: str) -> tuple[TableHead, Rows]:
    return designed_table(*TABLES[which])


@cache
def lookup(which: str) -> Lookup:
    found = lookup_of(*table(which))
    assert isinstance(found, Lookup), found
    return found


def written(export: Any, table: tuple[TableHead, Rows], **changed: Any) -> str:
    return b"".join(export.write(replace(table[0], **changed), [table[1]])).decode()


def bound_of(text: str) -> float:
    """Return the bound in the head; that of float in a head that has both."""
    found = re.findall(r"(?:residual|in float) at most (\S+)", text.partition("*")[2])
    return float(found[-1])


def random_values(which: str, count: int = RANDOM_VALUES) -> FloatArray:
    random = np.random.default_rng(16)
    axes = TABLES[which][1].values()
    return np.column_stack([random.uniform(axis[0], axis[-1], count) for axis in axes])


def largest_residual(which: str, values: FloatArray, times_s: FloatArray) -> float:
    """Return the largest residual of times, by routes that share no code with the package."""
    head, _ = table(which)
    subject, paths = subject_of(head), varied_paths(head)
    found = []
    for value, times in zip(values.tolist(), times_s, strict=True):
        plant, actuator, _ = subject.at(paths, value)
        command = Impulses(times_s=times, amplitudes=np.array(head.amplitudes))
        if which in FORMULA:
            found.append(claims_by_formula(command, plant.modes[0], actuator)["residual"])
        else:
            found.append(outcome(command, plant.modes[0], actuator).residual)
    return max(found)


PRINTS = """
#include <stdio.h>
#include "table.h"
int main(void)
{{
    shapersmith_real times_s[CRANE_NUMZVD_IMPULSES];
    double value[2];
    while (scanf("%lf %lf", &value[0], &value[1]) == 2) {{
        int k;
        if (crane_numzvd_lookup({inputs}, times_s) != 0) {{
            printf("none\\n");
            continue;
        }}
        for (k = 0; k < CRANE_NUMZVD_IMPULSES; ++k) {{
            printf("%.17g ", (double)times_s[k]);
        }}
        printf("\\n");
    }}
    return 0;
}}
"""


def by_c(text: str, values: FloatArray, folder: Path, *more: str) -> FloatArray:
    """Return times by a compiled header; not a number where it gives none."""
    inputs = ", ".join(f"(shapersmith_real)value[{axis}]" for axis in range(values.shape[1]))
    (folder / "table.h").write_text(text)
    (folder / "main.c").write_text(PRINTS.format(inputs=inputs))
    made = subprocess.run(
        ["gcc", *FLAGS, *more, "-o", str(folder / "main"), str(folder / "main.c"), "-lm"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert made.returncode == 0, made.stderr
    both = np.column_stack((values, np.zeros(len(values))))[:, :2]
    given = "\n".join(f"{one!r} {other!r}" for one, other in both.tolist())
    out = subprocess.run(
        [str(folder / "main")], input=given, capture_output=True, text=True, check=True
    )
    none = np.full(lookup_size(text), np.nan).tolist()
    return np.array([
        none if line == "none" else [float(word) for word in line.split()]
        for line in out.stdout.splitlines()
    ])


def lookup_size(text: str) -> int:
    return int(re.findall(r"_IMPULSES (\d+)", text)[0])


def by_text(text: str, values: FloatArray, which: str) -> FloatArray:
    """Return times by the interpreted block; not a number where it is not valid."""
    block = Block(text, "crane_numzvd_lookup")
    names = [axis.name for axis in lookup(which).axes]
    found = []
    for value in values.tolist():
        held = block(**dict(zip(names, value, strict=True)))
        times = [float(time) for time in held["times_s"].values]
        found.append(times if held["valid"] else [np.nan] * len(times))
    return np.array(found)


@pytest.mark.parametrize("flags", [(), ("-DSHAPERSMITH_FLOAT",)], ids=["double", "float"])
@pytest.mark.parametrize("which", TABLES)
def test_c_keeps_the_bound_of_its_head(which: str, flags: tuple[str, ...], tmp_path: Path) -> None:
    text = written(C, table(which))
    count = RANDOM_VALUES if which in {*FORMULA, "switched"} else 100
    values = random_values(which, count)
    bound = bound_of(text) if flags else float(up(lookup(which).residual))
    assert f"residual at most {up(lookup(which).residual)} of" in text
    assert largest_residual(which, values, by_c(text, values, tmp_path, *flags)) <= bound


@pytest.mark.parametrize("real", ["LREAL", "REAL"])
@pytest.mark.parametrize("which", TABLES)
def test_structured_text_keeps_the_bound_of_its_head(which: str, real: str) -> None:
    text = written(STRUCTURED_TEXT, table(which), real=real)
    count = RANDOM_VALUES if which == "length" else 50
    values = random_values(which, count)
    assert largest_residual(which, values, by_text(text, values, which)) <= bound_of(text)


@pytest.mark.parametrize("which", ["length", "two", "speed"])
def test_both_languages_find_the_same_times(which: str, tmp_path: Path) -> None:
    values = random_values(which, 20)
    for flags, real, digits in (((), "LREAL", 1e-14), (("-DSHAPERSMITH_FLOAT",), "REAL", 0.0)):
        text = written(STRUCTURED_TEXT, table(which), real=real)
        one = by_text(text, values, which)
        other = by_c(written(C, table(which)), values, tmp_path, *flags)
        np.testing.assert_allclose(one, other, rtol=digits, atol=digits)


def test_on_its_rows_a_lookup_gives_the_rows(tmp_path: Path) -> None:
    head, rows = table("length")
    times = by_c(written(C, (head, rows)), rows.fields, tmp_path)
    np.testing.assert_allclose(times, rows.results[:, :5], rtol=1e-15)


def test_beyond_the_rows_there_is_nothing(tmp_path: Path) -> None:
    values = np.array([[0.3], [0.2999], [1.4], [1.4001], [np.inf], [np.nan], [-1.0], [0.0]])
    known = [True, False, True, False, False, False, False, False]
    assert (~np.isnan(by_c(written(C, table("length")), values, tmp_path)[:, 0])).tolist() == known
    text = written(STRUCTURED_TEXT, table("length"))
    assert (~np.isnan(by_text(text, values, "length")[:, 0])).tolist() == known


def test_beside_a_row_without_a_design_there_is_nothing(tmp_path: Path) -> None:
    head, rows = table("length")
    results, status = rows.results.copy(), rows.status.copy()
    results[4], status[4] = np.nan, INFEASIBLE
    torn = head, replace(rows, results=results, status=status, reasons={4: "none"})
    values = random_values("length", 200)
    # A cell is joined from two rows on either side of it.
    rows_away = np.abs((values[:, 0] - 0.7) / 0.1)
    near, far = rows_away < 1, rows_away > 3
    by_both = (
        by_c(written(C, torn), values, tmp_path),
        by_text(written(STRUCTURED_TEXT, torn), values, "length"),
    )
    for times in by_both:
        assert np.isnan(times[near]).all()
        assert not np.isnan(times[far]).any()
        known = ~np.isnan(times[:, 0])
        found = largest_residual("length", values[known], times[known])
        assert found <= bound_of(written(STRUCTURED_TEXT, torn))


def test_the_bound_is_no_larger_than_it_has_to_be() -> None:
    for which in FORMULA:
        values = random_values(which)
        made = lookup(which)
        text = written(STRUCTURED_TEXT, table(which))
        some = values[:100]
        found = largest_residual(which, some, by_text(text, some, which))
        assert made.residual < 4 * found, which


def test_what_has_nothing_between_its_rows_says_why() -> None:
    head, rows = table("length")
    backwards = replace(rows, fields=rows.fields[::-1].copy(), results=rows.results[::-1].copy())
    damped = {**CRANE, "shaper": {"kind": "zv"}, "actuator": {"kind": "ideal"}}
    none = np.full(12, INFEASIBLE, dtype=np.int8)
    reasons = {
        "do not increase": (head, backwards),
        "no grid": (head, replace(rows, fields=np.full_like(rows.fields, 0.8))),
        f"not 1 or {MAX_AXES}": designed_table(CRANE, {}),
        "one or more verified": (head, replace(rows, status=none)),
        "the same in all rows": _with_own_amplitudes(damped),
    }
    for reason, (one, run) in reasons.items():
        found = lookup_of(one, run)
        assert isinstance(found, str)
        assert reason in found, (reason, found)
    text = written(STRUCTURED_TEXT, (head, backwards))
    assert "no crane_numzvd_lookup between rows: the values of the rows do not increase" in text
    assert "FUNCTION_BLOCK crane_numzvd_lookup" not in text


def _with_own_amplitudes(request: dict[str, Any]) -> tuple[TableHead, Rows]:
    from tests.designed_tables import head_of

    head = head_of(request, ("plant.damping_ratio",), 2, ())
    columns = tuple(
        replace(head.columns[0], name=name, kind="result") for name in ("t1_s", "t2_s", "a1", "a2")
    )
    return replace(head, columns=(head.columns[0], *columns, *head.columns[-2:]), impulses=2), Rows(
        first=0,
        fields=np.array([[0.0], [0.1]]),
        results=np.array([[0.0, 0.9, 0.5, 0.5], [0.0, 0.9, 0.6, 0.4]]),
        status=np.full(2, VERIFIED, dtype=np.int8),
        reasons={},
    )


@pytest.mark.parametrize("which", ["length", "two", "switched"])
def test_the_call_in_the_comment_runs(which: str) -> None:
    text = written(STRUCTURED_TEXT, table(which))
    call = re.findall(r"(?s)PROGRAM .*?END_PROGRAM", text)[0]
    text = text.replace("DINT := 4095", "DINT := 400")
    program = Block(f"{text}\n{call}", "crane_numzvd_main")
    shaped = [program(command=1.0)["velocity"] for _ in range(2)]
    assert shaped == [1.0, 1.0]
    assert program.values["times"].values["valid"] is True
    assert program.values["shaper"].values["ready"] is True
    assert program(command=0.0)["velocity"] == 0.0


@dataclass(frozen=True)
class Pair:
    """Two tables of one program."""

    one: tuple[TableHead, Rows]
    two: tuple[TableHead, Rows]


@pytest.fixture(scope="module")
def pair() -> Pair:
    one, two = table("length"), table("switched")
    return Pair((replace(one[0], title="hoist"), one[1]), (replace(two[0], title="gantry"), two[1]))


BOTH = """
#include <stdio.h>
#include "one.h"
#include "two.h"
int main(void)
{
    shapersmith_real one[HOIST_IMPULSES], two[GANTRY_IMPULSES];
    printf("%d %d", hoist_lookup(SHAPERSMITH_C(0.5), one), gantry_lookup(SHAPERSMITH_C(5.0), two));
    printf(" %.17g %.17g\\n", (double)one[1], (double)two[1]);
    return 0;
}
"""


def test_two_lookups_go_into_one_program(pair: Pair, tmp_path: Path) -> None:
    (tmp_path / "one.h").write_text(written(C, pair.one))
    (tmp_path / "two.h").write_text(written(C, pair.two))
    (tmp_path / "main.c").write_text(BOTH)
    command = ["gcc", *FLAGS, "-o", str(tmp_path / "main"), str(tmp_path / "main.c"), "-lm"]
    subprocess.run(command, check=True)
    out = subprocess.run([str(tmp_path / "main")], capture_output=True, text=True, check=True)
    first, second, *times = map(float, out.stdout.split())
    assert (first, second) == (0, 0)
    text = written(STRUCTURED_TEXT, pair.one) + written(STRUCTURED_TEXT, pair.two)
    both = [
        Block(text, f"{name}_lookup")(cable_length_m=length)["times_s"].values[1]
        for name, length in (("hoist", 0.5), ("gantry", 5.0))
    ]
    np.testing.assert_allclose(both, times, rtol=1e-14)


def test_a_bound_is_rounded_up() -> None:
    for value in np.geomspace(1e-12, 0.9, 200).tolist():
        assert value <= float(up(value)) <= 1.11 * value
    assert (up(0.0), up(1e-3), up(0.0124)) == ("0.0", "0.001", "0.013")
