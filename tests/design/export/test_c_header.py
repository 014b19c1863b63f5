"""The C header, compiled and run: its table, its polynomials, its delay line."""

import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from design.curve_fit.fit import fit
from design.curve_fit.fit_range import FitRange
from design.curve_fit.polynomials import Fit
from design.export.c_header import EXPORT as C
from design.shapers.registry import SHAPERS
from design.tables.columns import times_of
from design.tables.rows import Rows, TableHead, subject_of
from design.types import FloatArray
from tests.designed_tables import CRANE, designed_table, head_of, made_up_table
from tests.refusals import refused

FLAGS = ["-Wall", "-Wextra", "-Werror", "-std=c99", "-O2"]
"""As firmware that takes no warnings compiles."""

SAMPLE_TIME_S = 0.004

PROGRAM = """
#include <stdio.h>
#include "table.h"
#define ROWS CRANE_NUMZVD_ROWS
#define N CRANE_NUMZVD_IMPULSES

int main(void)
{
    static shapersmith_real memory[1000];
    static crane_numzvd_shaper shaper;
    shapersmith_real times[N];
    double x;
    int k, row, column;
    for (row = 0; row < ROWS; ++row) {
        for (column = 0; column < CRANE_NUMZVD_COLUMNS; ++column) {
            printf("%.17g ", (double)crane_numzvd_table[row][column]);
        }
        for (k = 0; k < N; ++k) {
            printf("%.17g ", (double)crane_numzvd_times[row][k]);
        }
        printf("%d\\n", crane_numzvd_status[row]);
    }
    /* Too short a line, no sample time, not a number: refused. */
    crane_numzvd_start(&shaper, memory, 10, SHAPERSMITH_C(0.25));
    printf("%d ", crane_numzvd_set(&shaper, crane_numzvd_times[0], crane_numzvd_amplitudes,
                                   SHAPERSMITH_C(SAMPLE)));
    crane_numzvd_start(&shaper, memory, 1000, SHAPERSMITH_C(0.25));
    printf("%d ", crane_numzvd_set(&shaper, crane_numzvd_times[0], crane_numzvd_amplitudes,
                                   SHAPERSMITH_C(0.0)));
    times[0] = times[1] = times[2] = times[3] = times[4] = (shapersmith_real)NAN;
    printf("%d ", crane_numzvd_set(&shaper, times, crane_numzvd_amplitudes,
                                   SHAPERSMITH_C(SAMPLE)));
    /* Not set yet: the command passes. */
    printf("%.17g ", (double)crane_numzvd_step(&shaper, SHAPERSMITH_C(0.5)));
    crane_numzvd_start(&shaper, memory, 1000, SHAPERSMITH_C(0.25));
    printf("%d\\n", crane_numzvd_set(&shaper, crane_numzvd_times[1], crane_numzvd_amplitudes,
                                    SHAPERSMITH_C(SAMPLE)));
    while (scanf("%lf", &x) == 1) {
        printf("%.17g\\n", (double)crane_numzvd_step(&shaper, (shapersmith_real)x));
    }
    return 0;
}
"""

EVALUATES = """
#include <stdio.h>
#include "table.h"
int main(void)
{
    shapersmith_real times[CRANE_NUMZVD_IMPULSES] = {0};
    double frequency;
    while (scanf("%lf", &frequency) == 1) {
        int k, done = crane_numzvd_evaluate_at((shapersmith_real)frequency, times);
        printf("%d ", done);
        for (k = 0; k < CRANE_NUMZVD_IMPULSES; ++k) {
            printf("%.17g ", (double)times[k]);
        }
        printf("\\n");
    }
    return 0;
}
"""

MODE = {
    **CRANE,
    "plant": {"kind": "modes", "modes": [{"natural_frequency_rad_s": 3.5, "damping_ratio": 0.0}]},
}
THESIS = CRANE["actuator"]
FIRST_ORDER = {
    "kind": "first_order",
    "accel_time_constant_s": 0.03,
    "decel_time_constant_s": 0.012,
}
IDEAL = {"kind": "ideal"}

LENGTHS_M = [0.3, 0.8, 1.1, 1.4]


@pytest.fixture(scope="module")
def table() -> tuple[TableHead, Rows]:
    head, rows = designed_table(CRANE, {"plant.cable_length_m": LENGTHS_M})
    results = rows.results.copy()
    results[3] = np.nan  # as a row without a design is
    status = rows.status.copy()
    status[3] = 1
    return head, Rows(
        first=0, fields=rows.fields, results=results, status=status, reasons={3: "none found"}
    )


@pytest.fixture(scope="module")
def polynomials() -> Fit:
    request = subject_of(made_up_table(0, 1)[0])
    wanted = FitRange(over="cable_length_m", start=0.3, stop=1.4, degree=5)
    return fit(request.plant, request.actuator, SHAPERS["numzvd"], wanted)


def compile_program(folder: Path, header: bytes, program: str, *more: str) -> Path:
    (folder / "table.h").write_bytes(header)
    (folder / "main.c").write_text(program.replace("SAMPLE)", f"{SAMPLE_TIME_S})"))
    binary = folder / "main"
    made = subprocess.run(
        ["gcc", *FLAGS, *more, "-o", str(binary), str(folder / "main.c"), "-lm"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert made.returncode == 0, made.stderr
    return binary


def answers(binary: Path, numbers: FloatArray) -> list[str]:
    given = "\n".join(map(repr, numbers.tolist()))
    out = subprocess.run([str(binary)], input=given, capture_output=True, text=True, check=True)
    return out.stdout.splitlines()


@pytest.mark.parametrize(("more", "tolerance"), [((), 1e-12), (("-DSHAPERSMITH_FLOAT",), 1e-6)])
def test_the_header_compiles_and_holds_the_table(
    table: tuple[TableHead, Rows], tmp_path: Path, more: tuple[str, ...], tolerance: float
) -> None:
    head, rows = table
    binary = compile_program(tmp_path, b"".join(C.write(head, [rows])), PROGRAM, *more)
    printed = [[float(cell) for cell in line.split()] for line in answers(binary, np.empty(0))[:4]]
    residuals = rows.results[:, -1:]
    expected = np.hstack((rows.fields, residuals, times_of(head, rows), rows.status[:, None]))
    np.testing.assert_allclose(printed, expected, rtol=tolerance)


def test_the_header_promotes_no_float(table: tuple[TableHead, Rows], tmp_path: Path) -> None:
    head, rows = table
    quiet = '#define SHAPERSMITH_FLOAT\n#include "table.h"\nint main(void) { return 0; }\n'
    strict = ["-Wdouble-promotion", "-Wconversion", "-Wfloat-conversion", "-pedantic"]
    compile_program(tmp_path, b"".join(C.write(head, [rows])), quiet, *strict)


@pytest.mark.parametrize(("more", "tolerance"), [((), 1e-13), (("-DSHAPERSMITH_FLOAT",), 1e-4)])
def test_the_delay_line_is_a_convolution(
    table: tuple[TableHead, Rows], tmp_path: Path, more: tuple[str, ...], tolerance: float
) -> None:
    head, rows = table
    command = np.random.default_rng(5).uniform(-1, 1, 2_500)  # longer than the line: it wraps
    binary = compile_program(tmp_path, b"".join(C.write(head, [rows])), PROGRAM, *more)
    refused, *shaped = answers(binary, command)[4:]
    assert refused.split() == ["-1", "-1", "-1", "0.5", "0"]
    # Each impulse, shared between the two samples that it lies between, is a filter for NumPy.
    times = times_of(head, rows)[1] / SAMPLE_TIME_S
    whole = np.floor(times).astype(int)
    taps = np.zeros(whole[-1] + 2)
    np.add.at(taps, whole, np.array(head.amplitudes) * (1 - (times - whole)))
    np.add.at(taps, whole + 1, np.array(head.amplitudes) * (times - whole))
    # At rest at 0.25 before: the amplitudes add up to 1.
    expected = 0.25 + np.convolve(command - 0.25, taps)[: command.size]
    # In float the part of a sample, of a few hundred, keeps four digits.
    np.testing.assert_allclose([float(line) for line in shaped], expected, atol=tolerance)


@pytest.mark.parametrize(("more", "tolerance"), [((), 1e-12), (("-DSHAPERSMITH_FLOAT",), 3e-6)])
def test_the_evaluator_gives_the_polynomials(
    table: tuple[TableHead, Rows],
    polynomials: Fit,
    tmp_path: Path,
    more: tuple[str, ...],
    tolerance: float,
) -> None:
    _, rows = table
    head = designed_table(CRANE, {"plant.cable_length_m": LENGTHS_M}, fit=polynomials)[0]
    binary = compile_program(tmp_path, b"".join(C.write(head, [rows])), EVALUATES, *more)
    frequencies = np.sqrt(9.81 / np.linspace(0.31, 1.39, 50))
    lines = answers(binary, np.append(frequencies, [2.0, 7.0, np.inf]))
    assert [line.split()[0] for line in lines] == ["0"] * 50 + ["-1"] * 3
    x = frequencies / 20.0
    phases = sum(
        np.multiply.outer(x**power, polynomials.coefficients[:, power])
        for power in range(polynomials.degree + 1)
    )
    printed = [[float(cell) for cell in line.split()[1:]] for line in lines[:50]]
    # The power basis adds up terms a few times larger than their sum: that times float's 6e-8.
    np.testing.assert_allclose(
        printed, phases / frequencies[:, None], rtol=tolerance, atol=tolerance
    )


@pytest.mark.parametrize(
    ("actuator", "over", "start", "stop", "form"),
    [
        (THESIS, "damping_ratio", 0.0, 0.1, "dimensionless"),
        (THESIS, "natural_frequency_rad_s", 3.0, 4.0, "time_in_frequency"),
        (FIRST_ORDER, "natural_frequency_rad_s", 3.0, 4.0, "dimensionless"),
        (IDEAL, "natural_frequency_rad_s", 3.0, 4.0, "dimensionless"),
    ],
)
def test_every_kind_of_fit_evaluates_up_to_its_ends(
    tmp_path: Path, actuator: dict[str, Any], over: Any, start: float, stop: float, form: Any
) -> None:
    request = {**MODE, "actuator": actuator}
    described_by = subject_of(head_of(request, (), 1, (1.0,) * 5))
    wanted = FitRange(over=over, start=start, stop=stop, degree=2, form=form)
    made = fit(described_by.plant, described_by.actuator, SHAPERS["numzvd"], wanted)
    head, rows = designed_table(request, {"plant.damping_ratio": [0.0]}, fit=made)
    if over == "damping_ratio":
        call = "crane_numzvd_evaluate((shapersmith_real)frequency, SHAPERSMITH_C(3.5), times)"
    else:
        call = "crane_numzvd_evaluate_at((shapersmith_real)frequency, times)"
    program = EVALUATES.replace(
        "crane_numzvd_evaluate_at((shapersmith_real)frequency, times)", call
    )
    header = b"".join(C.write(head, [rows]))
    for more, tolerance in (((), 1e-13), (("-DSHAPERSMITH_FLOAT",), 1e-5)):
        binary = compile_program(tmp_path, header, program, *more)
        for value, x in ((start, made.variable.start), (stop, made.variable.stop)):
            frequency = 3.5 if over == "damping_ratio" else value
            scale = 1.0 if form == "time_in_frequency" else frequency
            expected = made.coefficients @ x ** np.arange(3) / scale
            done, *times = answers(binary, np.array([value]))[0].split()
            assert done == "0"
            np.testing.assert_allclose(
                [float(time) for time in times], expected, rtol=tolerance, atol=tolerance
            )


def test_the_comment_tells_tool_specification_units_and_worst_residuals(
    table: tuple[TableHead, Rows], polynomials: Fit
) -> None:
    _, rows = table
    head = designed_table(CRANE, {"plant.cable_length_m": LENGTHS_M}, fit=polynomials)[0]
    comment = b"".join(C.write(head, [rows])).decode().partition("*/")[0]
    assert "shapersmith 0.1.0" in comment
    assert head.specification_sha256 in comment
    assert "plant.cable_length_m [m], t1_s [s]" in comment
    worst = np.nanmax(rows.results[:, -1])
    assert f"worst residual of the rows: {worst:.3g}" in comment
    assert f"worst residual of the polynomials: {polynomials.worst_residual:.3g}" in comment


def test_a_table_too_long_for_a_program_is_refused() -> None:
    with refused("program_too_large", "rows", says="of at most 200000 numbers"):
        C.checks(made_up_table(50_000, 1)[0])
    C.checks(made_up_table(5_000, 1)[0])


def test_a_table_that_a_program_cannot_hold_is_refused() -> None:
    with refused("program_empty", "rows", says="at least 1"):
        C.checks(made_up_table(0, 1)[0])
    head = made_up_table(1, 1)[0]
    without = replace(head, columns=(head.columns[0], *head.columns[-3:]))
    with refused("column_missing", "columns"):
        C.checks(without)


CALLED = """
#include "table.h"
int main(void)
{
    const shapersmith_real cable_length_m = SHAPERSMITH_C(0.8);
    const shapersmith_real in = SHAPERSMITH_C(1.0), sample_time_s = SHAPERSMITH_C(0.004);
    const int row = 1;
    shapersmith_real out;
    @USAGE@
    for (int k = 0; k < 900; ++k) {
        out = crane_numzvd_step(&shaper, in);
    }
    (void)cable_length_m, (void)row;
    return out == SHAPERSMITH_C(1.0) && shaper.whole[4] > 0 ? 0 : 1;
}
"""
"""Whether the lines of a head compile, and shape: five impulses that add up to 1."""


@pytest.mark.parametrize("by", ["rows", "polynomials", "polynomials of other amplitudes"])
def test_the_example_of_the_head_runs(
    table: tuple[TableHead, Rows], polynomials: Fit, tmp_path: Path, by: str
) -> None:
    head, rows = table
    if by != "rows":
        head = designed_table(CRANE, {"plant.cable_length_m": LENGTHS_M}, fit=polynomials)[0]
    if by == "polynomials of other amplitudes":
        head = replace(head, amplitudes=(0.5, -0.5, 0.5, -0.5, 1.0))
    header = b"".join(C.write(head, [rows]))
    usage = header.decode().partition("     static shapersmith_real memory")[2]
    usage = "static shapersmith_real memory" + usage.partition("     every sample")[0]
    wanted = {
        "rows": "crane_numzvd_amplitudes,",
        "polynomials": "times_s, crane_numzvd_amplitudes,",
        "polynomials of other amplitudes": "times_s, crane_numzvd_fit_amplitudes,",
    }
    assert wanted[by] in usage
    binary = compile_program(tmp_path, header, CALLED.replace("@USAGE@", usage))
    assert subprocess.run([binary], check=False).returncode == 0


def test_two_tables_of_one_name_do_not_compile_together(
    table: tuple[TableHead, Rows], tmp_path: Path
) -> None:
    head, rows = table
    for number, digest in enumerate((head.specification_sha256, "0" * 64)):
        other = replace(head, specification_sha256=digest)
        (tmp_path / f"{number}.h").write_bytes(b"".join(C.write(other, [rows])))
    for files, fails in ((("0.h", "0.h"), False), (("0.h", "1.h"), True)):
        text = "".join(f'#include "{file}"\n' for file in files)
        (tmp_path / "both.c").write_text(f"{text}int main(void) {{ return 0; }}\n")
        ran = subprocess.run(
            ["gcc", "-fsyntax-only", "both.c"],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
        )
        assert (ran.returncode != 0) is fails
        assert ("two tables have the names of crane_numzvd" in ran.stderr) is fails
