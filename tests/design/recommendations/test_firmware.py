"""A shaper for a printer is one that its firmware has, judged as that plays it."""

import math
import re
from collections.abc import Callable

import numpy as np
import pytest

from design.analysis.residual import residual_vibration
from design.errors import InfeasibleDesignError
from design.export.klipper import klipper_line
from design.export.marlin import marlin_impulses, marlin_numbers
from design.export.printers import PRINTERS
from design.model.actuators.first_order import FirstOrder
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.pipeline import design
from design.recommendations.firmware import PLAYED_WITHIN
from design.shapers.registry import SHAPERS
from design.tables.rows import Subject
from tests.design.recommendations.recommended import TWO_MODES, asked, everything
from tests.firmware import klipper_reads, marlin_reads, reprap_36_reads
from tests.refusals import refused
from tests.shaper_table import IDEAL

PRINTER = Mode(natural_frequency_rad_s=45 * math.tau, damping_ratio=0.06)
LAG = FirstOrder(accel_time_constant_s=0.001, decel_time_constant_s=0.002)

WANTED: dict[str, dict[str, float]] = {
    "klipper": {"half_width": 0.3},
    "marlin": {"half_width": 0.03, "tolerance": 0.06},
    "rrf": {"half_width": 0.2},
}
"""A question that each firmware answers."""

ONE_TICK = 45 * math.tau / 750_000
"""Of the phase, in a tick of RepRapFirmware's clock, which the reader does not count [rad]."""

READERS: dict[str, Callable[[str], Impulses]] = {
    "klipper": klipper_reads,
    "marlin": marlin_reads,
    "rrf": reprap_36_reads,
}


def commands(lines: tuple[str, ...]) -> list[str]:
    """Return the G-code among the lines."""
    found = (re.search(r"(SET_INPUT_SHAPER|M593) .*", line) for line in lines)
    return [one[0] for one in found if one is not None and "3.4 to 3.5" not in one.string]


@pytest.mark.parametrize("name", PRINTERS)
def test_candidates_are_the_kinds_that_the_firmware_has(name: str) -> None:
    found = asked(PRINTER, IDEAL, **WANTED[name], firmware=PRINTERS[name])
    kinds = {one.designed.choice.kind.name for one in everything(found).values()}
    assert kinds
    assert kinds <= set(PRINTERS[name].kinds)
    assert set(PRINTERS[name].kinds) <= set(SHAPERS)


@pytest.mark.parametrize("name", PRINTERS)
def test_what_the_firmware_reads_in_its_lines_keeps_the_tolerance(name: str) -> None:
    found = asked(PRINTER, IDEAL, **WANTED[name], firmware=PRINTERS[name])
    tolerance, (low, high) = found.question.requirements.tolerance, found.question.band
    for candidate in found.candidates:
        (verdict,) = [one for one in candidate.verdicts if one.requirement == "firmware"]
        assert candidate.played is not None
        assert verdict.value is not None
        lines = commands(candidate.played.lines)
        assert lines
        for line in lines:
            left = [
                residual_vibration(READERS[name](line), _times(PRINTER, ratio), IDEAL)
                for ratio in np.linspace(low, high, 201)
            ]
            assert max(left) == pytest.approx(verdict.value, rel=2e-3, abs=ONE_TICK)
        assert verdict.value <= PLAYED_WITHIN * tolerance


def _times(mode: Mode, ratio: float) -> Mode:
    return Mode(
        natural_frequency_rad_s=ratio * mode.natural_frequency_rad_s,
        damping_ratio=mode.damping_ratio,
    )


def test_humps_of_klipper_are_asked_as_klipper_has_them() -> None:
    found = everything(asked(PRINTER, IDEAL, tolerance=0.1, firmware=PRINTERS["klipper"]))
    for kind in ("two_hump_ei", "three_hump_ei"):
        assert found[kind].designed.choice.options["tolerance"] == 0.05


def test_a_fit_that_leaves_more_than_is_asked_is_not_recommended() -> None:
    """Klipper's three humps leave 5.2 % of this mode from 0.54 on: more than 5 % and its digits."""
    found = everything(
        asked(PRINTER, IDEAL, half_width=0.2, firmware=PRINTERS["klipper"], highest_command=1.0)
    )
    assert "firmware" not in found["two_hump_ei"].missed
    with pytest.raises(InfeasibleDesignError, match="three_hump_ei") as caught:
        asked(PRINTER, IDEAL, lower_ratio=0.55, upper_ratio=1.5, firmware=PRINTERS["klipper"])
    assert caught.value.code == "none_meets_all"
    assert any("Klipper" in detail for _, detail in caught.value.faults)


@pytest.mark.parametrize("damping", [0.0, 0.01, 0.06, 0.2, 0.5])
def test_marlin_is_given_the_damped_frequency_and_is_off_by_a_128th(damping: float) -> None:
    mode = Mode(natural_frequency_rad_s=45 * math.tau, damping_ratio=damping)
    played = marlin_impulses(*marlin_numbers(mode))
    exact = design(mode, IDEAL, SHAPERS["zv"]).impulses
    np.testing.assert_allclose(played.times_s, exact.times_s, rtol=1e-6)
    # The cubic is off by less than a 128th itself, and is rounded down to one.
    np.testing.assert_allclose(played.amplitudes, exact.amplitudes, atol=2 / 128)
    assert residual_vibration(played, mode, IDEAL) < (0.03 if damping else 1e-6)


@pytest.mark.parametrize("name", ["klipper", "marlin"])
def test_a_firmware_that_computes_its_impulses_refuses_what_they_are_not_for(name: str) -> None:
    firmware = PRINTERS[name]
    with refused("firmware_knows_no_actuator", "actuator.kind"):
        asked(PRINTER, LAG, firmware=firmware)
    with refused("firmware_of_one_mode", "plant.modes"):
        asked(TWO_MODES, IDEAL, firmware=firmware)
    with refused("firmware_not_on_samples", "sample_time_s"):
        asked(PRINTER, IDEAL, firmware=firmware, sample_time_s=0.001)


def test_reprapfirmware_takes_shapers_of_two_modes_behind_a_drive() -> None:
    found = asked(TWO_MODES, IDEAL, half_width=0.01, firmware=PRINTERS["rrf"])
    assert found.recommended.impulses.times_s.size <= 5
    assert found.recommended.played is not None
    behind = asked(PRINTER, LAG, half_width=0.05, firmware=PRINTERS["rrf"])
    assert behind.recommended.played is not None


def test_the_reasons_say_what_the_firmware_leaves() -> None:
    found = asked(PRINTER, IDEAL, **WANTED["klipper"], firmware=PRINTERS["klipper"])
    assert any("as Klipper plays it" in reason for reason in found.why)
    assert not any("plays it" in reason for reason in asked(PRINTER, IDEAL).why)


@pytest.mark.parametrize("kind", ["two_hump_ei", "ei", "zvd"])
def test_what_is_recommended_is_written_for_the_same_firmware(kind: str) -> None:
    """One rule for both: a tolerance is kept to one in a hundred, as fits of five digits are."""
    wanted = {"two_hump_ei": 0.3, "ei": 0.19, "zvd": 0.14}
    found = asked(PRINTER, IDEAL, half_width=wanted[kind], firmware=PRINTERS["klipper"])
    candidate = everything(found)[kind]
    assert not candidate.missed
    assert candidate.played is not None
    subject = Subject(
        plant=PRINTER, actuator=IDEAL, kind=SHAPERS[kind], options=SHAPERS[kind].options()
    )
    line = klipper_line(subject, candidate.impulses, "row 0")
    assert set(line.commands) <= {one.removeprefix("# at once: ") for one in candidate.played.lines}


ASKED = re.compile(r"[#;] asked: 5 % from (\S+) to (\S+) of .*; as \w+ plays it (\S+) %")
OLDER = re.compile(r"# in a Klipper that refuses the line: (\S+) % there by")


@pytest.mark.parametrize("name", ["klipper", "rrf"])
def test_the_lines_say_what_is_left_in_the_band_that_was_asked(name: str) -> None:
    found = asked(PRINTER, IDEAL, half_width=0.2, firmware=PRINTERS[name])
    played = found.recommended.played
    assert played is not None
    said = ASKED.fullmatch(played.lines[0])
    assert said is not None
    assert (float(said[1]), float(said[2])) == (0.8, 1.2)
    left = largest(READERS[name](commands(played.lines)[0]), 0.8, 1.2)
    assert 100 * left == pytest.approx(float(said[3]), rel=2e-3)


def test_an_older_klipper_has_a_line_of_its_own_with_what_it_leaves() -> None:
    found = asked(PRINTER, IDEAL, half_width=0.2, firmware=PRINTERS["klipper"])
    assert found.recommended.name == "ei"
    assert found.recommended.played is not None
    *_, says, line = found.recommended.played.lines
    assert line == "# shaper_type_x: ei, or shaper_type_y: ei"
    said = OLDER.fullmatch(says)
    assert said is not None
    command = f"SET_INPUT_SHAPER SHAPER_TYPE_X=ei SHAPER_FREQ_X={45.0!r} DAMPING_RATIO_X=0.06"
    left = max(largest(klipper_reads(command, older=older), 0.8, 1.2) for older in (False, True))
    assert 100 * left == pytest.approx(float(said[1]), rel=2e-3)


def largest(impulses: Impulses, low: float, high: float) -> float:
    """Return the largest residual over a band, by the closed form at many frequencies."""
    return max(
        residual_vibration(impulses, _times(PRINTER, ratio), IDEAL)
        for ratio in np.linspace(low, high, 401)
    )
