"""Klipper, Marlin and RepRapFirmware: what they can take, and what is refused by name."""

import math
import re
from itertools import accumulate
from typing import Any

import numpy as np
import pytest

from design.analysis.residual import residual_vibration
from design.export.klipper import EXPORT as KLIPPER
from design.export.marlin import EXPORT as MARLIN
from design.export.reprap import EXPORT as REPRAP
from design.model.actuators.ideal import Ideal
from design.model.plants.mode import Mode
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.tables.rows import Rows, TableHead
from tests.designed_tables import CRANE, designed_table, head_of
from tests.firmware import lines_of, marlin_reads, reprap_35_reads, reprap_36_reads
from tests.refusals import refused

PLANT = {"kind": "mode", "natural_frequency_rad_s": 250.0, "damping_ratio": 0.0}


def zvd_table(
    kind: str = "zvd", actuator: dict[str, Any] | None = None, scale: float = 1.0
) -> tuple[TableHead, Rows]:
    """Return a table of undamped ZVD shapers, half a period apart, and one failure."""
    request = {
        "plant": PLANT,
        "actuator": actuator or {"kind": "ideal"},
        "shaper": {"kind": kind},
    }
    field = "plant.natural_frequency_rad_s"
    frequencies = scale * np.array([200.0, 250.0, 300.0])
    half = math.pi / frequencies
    results = np.stack((0 * half, half, 2 * half, 0 * half), axis=1)
    results[2] = math.nan
    rows = Rows(
        first=0,
        fields=frequencies[:, None],
        results=results,
        status=np.array([0, 0, 2], dtype=np.int8),
        reasons={2: "the solver\ngave up"},
    )
    return head_of(request, (field,), 3, (0.25, 0.5, 0.25), title="printer"), rows


def test_klipper_gets_its_own_name_frequency_and_damping() -> None:
    head, rows = zvd_table()
    KLIPPER.checks(head)
    lines = b"".join(KLIPPER.write(head, [rows])).decode().splitlines()
    commands = [line for line in lines if not line.startswith(";")]
    assert len(commands) == 4
    told = [(frequency, axis) for frequency in (200.0, 250.0) for axis in "XY"]
    for command, (frequency, axis) in zip(commands, told, strict=True):
        name, *pairs = command.split()
        given = dict(pair.split("=") for pair in pairs)
        assert name == "SET_INPUT_SHAPER"
        assert given.pop(f"SHAPER_TYPE_{axis}") == "zvd"
        assert float(given.pop(f"SHAPER_FREQ_{axis}")) == frequency / (2 * math.pi)
        assert float(given.pop(f"DAMPING_RATIO_{axis}")) == 0.0
        assert not given  # the other axis keeps what it has
    assert "; failed: the solver gave up" in lines
    assert any(head.specification_sha256 in line for line in lines)


def test_klipper_refuses_shapers_and_drives_that_it_does_not_know() -> None:
    unity, _ = designed_table(CRANE, {"plant.cable_length_m": [0.8]})
    with refused("not_klipper_shaper", "shaper.kind"):
        KLIPPER.checks(unity)
    lagging = {"kind": "first_order", "accel_time_constant_s": 0.1, "decel_time_constant_s": 0.1}
    with refused("klipper_knows_no_actuator", "actuator.kind"):
        KLIPPER.checks(zvd_table(actuator=lagging)[0])


def test_both_ages_of_reprapfirmware_read_the_same_impulses() -> None:
    head, rows = zvd_table()
    REPRAP.checks(head)
    text = b"".join(REPRAP.write(head, [rows])).decode()
    newer = lines_of(text)
    older = re.findall(r"^; 3.4 to 3.5: (M593.*)$", text, re.MULTILINE)
    assert len(newer) == len(older) == 2
    for reader, found in ((reprap_36_reads, newer), (reprap_35_reads, older)):
        for row, line in enumerate(found):
            read = reader(line)
            np.testing.assert_allclose(read.times_s, rows.results[row, :3], atol=2e-9)
            np.testing.assert_allclose(read.amplitudes, head.amplitudes, atol=2e-9)


def test_what_rounding_leaves_stands_with_the_row() -> None:
    """Of 250 rad/s counts of 1.33 us are a thousandth of a radian at most."""
    head, rows = zvd_table()
    text = b"".join(REPRAP.write(head, [rows])).decode()
    left = re.findall(
        r"^; rounded as the firmware does, it leaves ([\d.e-]+) %$", text, re.MULTILINE
    )
    assert len(left) == 2
    assert all(0 < float(one) < 0.01 for one in left)


def test_a_mode_too_quick_for_the_step_clock_is_refused() -> None:
    head, rows = zvd_table(scale=60.0)
    with refused("reprap_rounds_too_much", "times_s of row 0"):
        list(REPRAP.write(head, [rows]))


def test_reprapfirmware_refuses_negative_impulses_and_long_shapers() -> None:
    unity, _ = designed_table(CRANE, {"plant.cable_length_m": [0.8]})
    with refused("shaper_not_positive", "shaper.kind"):
        REPRAP.checks(unity)
    request = {"plant": PLANT, "actuator": {"kind": "ideal"}, "shaper": {"kind": "zvd"}}
    long = head_of(request, (), 1, (0.2, 0.2, 0.2, 0.2, 0.1, 0.1))
    with refused("wrong_count_for_reprap", "impulses", says="2 to 5 for RepRapFirmware"):
        REPRAP.checks(long)


def test_reprapfirmware_refuses_delays_that_do_not_increase() -> None:
    head, rows = zvd_table()
    rows.results[1, 2] = rows.results[1, 1]
    with refused("gap_too_short_for_reprap", "times_s of row 1", says="2e-06 s or more apart"):
        list(REPRAP.write(head, [rows]))


def test_a_title_on_two_lines_stays_a_comment() -> None:
    head, rows = zvd_table()
    object.__setattr__(head, "title", "printer\nG28 ; go home")
    for export in (REPRAP, KLIPPER):
        lines = b"".join(export.write(head, [rows])).decode().splitlines()
        assert not any(line.startswith("G28") for line in lines)


def test_amplitudes_that_do_not_add_up_to_one_are_refused() -> None:
    head, rows = zvd_table()
    object.__setattr__(head, "amplitudes", (0.25, 0.5, 0.2))
    with refused("amplitudes_not_shares", "amplitudes of row 0", says="above 0 and add up"):
        list(REPRAP.write(head, [rows]))


def firmwares_own(kind: str, z: float, period_s: float) -> tuple[list[float], list[float]]:
    """Return heights, the last left out, and their distance, as RepRapFirmware computes them.

    src/Movement/AxisShaper.cpp, AxisShaper::Configure, cases zvd, zvdd, zvddd and mzv of branch
    3.6-dev: ``1/j, 2k/j``; ``1/j, 3k/j, 3k^2/j``; ``1/j, 4k/j, 6k^2/j, 4k^3/j`` half a damped
    period apart; ``a3/sum, a2/sum`` at 3/8 of it, which reads backward where damped.
    """
    d = math.sqrt(1 - z * z)
    k, half = math.exp(-z * math.pi / d), 0.5 * period_s / d
    if kind == "mzv":
        a1 = 1 - 0.5 * math.sqrt(2)
        a2 = math.sqrt(2) - 1
        return [a1 / (2 * a1 + a2), a2 / (2 * a1 + a2)], [0.75 * half] * 2
    powers = {"zvd": 2, "zvdd": 3, "zvddd": 4}[kind]
    j = (1 + k) ** powers
    return [math.comb(powers, number) * k**number / j for number in range(powers)], [half] * powers


@pytest.mark.parametrize(
    ("kind", "z"),
    [("mzv", 0.0), *((kind, z) for kind in ("zvd", "zvdd", "zvddd") for z in (0.0, 0.1, 0.3))],
)
def test_the_readers_of_either_age_hold_the_shapers_that_the_firmware_computes_itself(
    kind: str, z: float
) -> None:
    """116 numbers: heights and delays as 3.6 keeps them, sums and durations as 3.5 does."""
    mode = Mode(natural_frequency_rad_s=250.0, damping_ratio=z)
    wanted = design(mode, Ideal(), SHAPERS[kind]).impulses
    heights, gaps = firmwares_own(kind, z, mode.period_s)
    newer = reprap_36_reads(line_of(heights, list(accumulate(gaps))))
    older = reprap_35_reads(line_of(list(accumulate(heights)), gaps))
    for read in (newer, older):
        np.testing.assert_allclose(read.times_s, wanted.times_s, rtol=1e-12, atol=1e-15)
        np.testing.assert_allclose(read.amplitudes, wanted.amplitudes, atol=1e-12)


def line_of(heights: list[float], times_s: list[float]) -> str:
    numbers = (":".join(f"{one:.17f}" for one in listed) for listed in (heights, times_s))
    return 'M593 P"custom" H{} T{}'.format(*numbers)


ZV: dict[str, Any] = {
    "plant": {"kind": "mode", "natural_frequency_rad_s": 280.0, "damping_ratio": 0.0},
    "actuator": {"kind": "ideal"},
    "shaper": {"kind": "zv"},
}


def test_marlin_gets_a_line_for_each_axis_and_the_residual_that_it_keeps() -> None:
    head, rows = designed_table(ZV, {"plant.damping_ratio": [0.0, 0.06, 0.4]})
    MARLIN.checks(head)
    text = b"".join(MARLIN.write(head, [rows])).decode()
    read = [marlin_reads(line) for line in lines_of(text)]
    assert [line[:6] for line in lines_of(text)] == ["M593 X", "M593 Y"] * 3
    stated = re.findall(r"^; residual (\S+) % as Marlin rounds it$", text, re.MULTILINE)
    for row, damping in enumerate((0.0, 0.06, 0.4)):
        mode = Mode(natural_frequency_rad_s=280.0, damping_ratio=damping)
        for played in read[2 * row : 2 * row + 2]:
            left = 100 * residual_vibration(played, mode, Ideal())
            assert left == pytest.approx(float(stated[row]), rel=5e-3, abs=1e-4)
            assert left < 1.0
    assert float(stated[0]) < 1e-4  # the heights of an undamped mode are whole 128ths


def test_marlin_refuses_shapers_and_drives_that_it_does_not_know() -> None:
    lagging = {"kind": "first_order", "accel_time_constant_s": 0.1, "decel_time_constant_s": 0.1}
    on_samples = {"kind": "zv", "sample_time_s": 0.001}
    with refused("not_marlin_shaper", "shaper.kind"):
        MARLIN.checks(zvd_table()[0])
    with refused("marlin_knows_no_actuator", "actuator.kind"):
        MARLIN.checks(head_of({**ZV, "actuator": lagging}, (), 1, (0.5, 0.5)))
    with refused("marlin_not_on_samples", "shaper.sample_time_s"):
        MARLIN.checks(head_of({**ZV, "shaper": on_samples}, (), 1, (0.5, 0.5)))
