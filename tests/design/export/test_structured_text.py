"""The Structured Text, parsed by blark and run by an interpreter of the tests' own."""

import re
from dataclasses import replace

import numpy as np
import pytest

from design.curve_fit.fit import fit
from design.curve_fit.fit_range import FitRange
from design.curve_fit.polynomials import Fit
from design.export.structured_text import EXPORT as STRUCTURED_TEXT
from design.shapers.registry import SHAPERS
from design.tables.columns import times_of
from design.tables.rows import Rows, TableHead, subject_of
from schemas.tables import TableRequest
from service.jobs.plan import plan_of
from service.jobs.results import head_for
from tests.designed_tables import CRANE, designed_table, made_up_table
from tests.refusals import refused
from tests.structured_text import Block

SAMPLE_TIME_S = 0.004

LENGTHS_M = [0.3, 0.8, 1.4]


@pytest.fixture(scope="module")
def polynomials() -> Fit:
    request = subject_of(made_up_table(0, 1)[0])
    wanted = FitRange(over="cable_length_m", start=0.3, stop=1.4, degree=3)
    return fit(request.plant, request.actuator, SHAPERS["numzvd"], wanted)


@pytest.fixture(scope="module")
def table(polynomials: Fit) -> tuple[TableHead, Rows]:
    head, rows = designed_table(CRANE, {"plant.cable_length_m": LENGTHS_M}, fit=polynomials)
    results = rows.results.copy()
    results[2] = np.nan  # as a row without a design is
    status = rows.status.copy()
    status[2] = 2
    return head, Rows(
        first=0, fields=rows.fields, results=results, status=status, reasons={2: "gave up"}
    )


@pytest.fixture(scope="module")
def program(table: tuple[TableHead, Rows]) -> str:
    head, rows = table
    return b"".join(STRUCTURED_TEXT.write(head, [rows])).decode()


def test_blark_parses_its_function_blocks(program: str) -> None:
    from blark.parse import parse_source_code

    parsed = parse_source_code(program)
    blocks = [item.name for item in parsed.transform().items]
    # Of three rows, one without a design: nothing to interpolate.
    names = ("table", "evaluator", "shaper")
    assert blocks == [f"crane_numzvd_{name}" for name in names]


def test_the_table_gives_its_rows_to_the_last_digit(
    table: tuple[TableHead, Rows], program: str
) -> None:
    head, rows = table
    block = Block(program, "crane_numzvd_table")
    for row in (1, 0):
        held = block(row=row)
        assert held["status"] == 0
        assert held["times_s"].values == times_of(head, rows)[row].tolist()
        assert held["amplitudes"].values == list(head.amplitudes)
        assert held["columns"].values == [*rows.fields[row], rows.results[row, -1]]


def test_a_row_without_a_design_lets_the_command_pass_and_tells(program: str) -> None:
    block = Block(program, "crane_numzvd_table")
    held = block(row=2)
    assert held["status"] == 2
    assert held["times_s"].values == [0.0] * 5
    assert held["amplitudes"].values == [1.0, 0.0, 0.0, 0.0, 0.0]
    assert block(row=3)["status"] == block(row=-1)["status"] == -1


def test_the_evaluator_gives_the_polynomials(program: str, polynomials: Fit) -> None:
    block = Block(program, "crane_numzvd_evaluator")
    for length in np.linspace(0.31, 1.39, 12).tolist():
        frequency = (9.81 / length) ** 0.5
        held = block(cable_length_m=length)
        x = frequency / 20.0
        phases = polynomials.coefficients @ x ** np.arange(polynomials.degree + 1)
        assert held["valid"] is True
        assert held["amplitudes"].values == polynomials.checks.amplitudes.tolist()
        np.testing.assert_allclose(
            held["times_s"].values, phases / frequency, rtol=1e-13, atol=1e-15
        )
    before = list(held["times_s"].values)
    held = block(cable_length_m=9.81 / 9.0**2)
    assert held["valid"] is False
    assert held["times_s"].values == before


def test_the_delay_line_is_a_convolution(table: tuple[TableHead, Rows], program: str) -> None:
    head, rows = table
    # A line of 400 cells, so that it wraps.
    block = Block(program.replace("4095", "399"), "crane_numzvd_shaper")
    times = times_of(head, rows)[1]
    command = np.random.default_rng(6).uniform(-1, 1, 900)
    shaped = []
    for value in command.tolist():
        held = block(
            command=value,
            times_s=times.tolist(),
            amplitudes=head.amplitudes,
            sample_time_s=SAMPLE_TIME_S,
        )
        assert held["ready"] is True
        shaped.append(held["shaped"])
    samples = times / SAMPLE_TIME_S
    whole = np.floor(samples).astype(int)
    taps = np.zeros(whole[-1] + 2)
    np.add.at(taps, whole, np.array(head.amplitudes) * (1 - (samples - whole)))
    np.add.at(taps, whole + 1, np.array(head.amplitudes) * (samples - whole))
    # The first call fills the line with its command.
    expected = command[0] + np.convolve(command - command[0], taps)[: command.size]
    np.testing.assert_allclose(shaped, expected, atol=1e-13)


def test_a_shaper_that_cannot_passes_the_command(program: str) -> None:
    times, amplitudes = [0.0, 0.1, 0.2, 0.3, 0.4], [1.0, -1.0, 1.0, -1.0, 1.0]
    block = Block(program.replace("4095", "9"), "crane_numzvd_shaper")
    for bad in (
        {"sample_time_s": 0.0, "times_s": times},
        {"sample_time_s": 0.04, "times_s": times},  # ten samples in a line of ten
        {"sample_time_s": 0.1, "times_s": [-0.1, *times[1:]]},
    ):
        held = block(command=0.7, amplitudes=amplitudes, **bad)
        assert held["ready"] is False
        assert held["shaped"] == 0.7
    held = block(command=0.7, amplitudes=amplitudes, sample_time_s=0.1, times_s=times)
    assert held["ready"] is True


def test_the_comment_tells_tool_specification_units_and_worst_residual(
    table: tuple[TableHead, Rows], program: str
) -> None:
    head, rows = table
    comment = program.partition("*)")[0]
    assert "shapersmith 0.1.0" in comment
    assert head.specification_sha256 in comment
    assert "plant.cable_length_m [m], t1_s [s]" in comment
    assert f"worst residual of the rows: {np.nanmax(rows.results[:, -1]):.3g}" in comment
    assert "1 failed" in comment


def test_a_table_too_long_for_a_controller_is_refused() -> None:
    with refused("program_too_large", "rows", says="of at most 200000 numbers"):
        STRUCTURED_TEXT.checks(made_up_table(50_000, 1)[0])


def test_real_is_single_precision_everywhere(table: tuple[TableHead, Rows]) -> None:
    head, rows = table
    program = b"".join(STRUCTURED_TEXT.write(replace(head, real="REAL"), [rows])).decode()
    assert "LREAL" not in program.replace("numbers: REAL", "")
    held = Block(program, "crane_numzvd_table")(row=1)
    assert held["times_s"].values == times_of(head, rows)[1].astype(np.float32).tolist()
    evaluated = Block(program, "crane_numzvd_evaluator")(cable_length_m=0.8)
    np.testing.assert_allclose(
        np.array(evaluated["times_s"].values), times_of(head, rows)[1], atol=1e-4
    )


def test_the_call_of_the_evaluator_runs(program: str) -> None:
    call = re.findall(r"(?s)PROGRAM .*?END_PROGRAM", program)[0]
    main = Block(f"{program}\n{call}".replace("DINT := 4095", "DINT := 400"), "crane_numzvd_main")
    assert main(command=1.0)["velocity"] == 1.0
    assert main.values["times"].values["valid"] is True


def test_the_specification_says_in_which_type_numbers_are() -> None:
    axes = [{"field": "/plant/cable_length_m", "values": LENGTHS_M}]
    usual = plan_of(TableRequest.model_validate({"design": CRANE, "axes": axes})).job
    single = TableRequest.model_validate({"design": CRANE, "axes": axes, "real": "REAL"})
    assert '"real"' not in usual.specification  # whose hash stays as it was
    assert head_for(usual, "st").real == "LREAL"
    assert head_for(plan_of(single).job, "st").real == "REAL"
