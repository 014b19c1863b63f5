"""Every number of docs/limits.md is computed here."""

import math
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from design.analysis.ramp_figures import RampFigures, end_of_reference
from design.analysis.residual import residual_vibration
from design.analysis.unshaped import unshaped_ramp_residual
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.commands import step
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.moves.maneuvers import maneuver
from design.pipeline import design
from design.shapers.numsi import UnityBandOptions
from design.shapers.registry import SHAPERS
from design.solving.textbooks import figures_beside_textbooks, textbook_shapers, unshaped_move
from tests.pages.reading import prose
from tests.refusals import refused

PAGE = (Path(__file__).parents[2] / "docs" / "limits.md").read_text()
PROSE = prose("docs/limits.md")

CRANE = Pendulum(cable_length_m=9, gravity_m_s2=9.81)
DRIVE = RateLimited(accel_limit_m_s2=0.3, decel_limit_m_s2=0.4, speed_m_s=1.0)
PERIOD_S = 2 * math.pi * math.sqrt(9 / 9.81)
WHOLE = RateLimited(accel_limit_m_s2=1 / PERIOD_S, decel_limit_m_s2=0.4, speed_m_s=1.0)

GIVEN = {"9", "1", "0.3", "0.4", "12", "0.9", "1.1", "5", "10", "0.1", "0.0"}
"""What the page asks: the crane, its moves, by how much its frequency is off, and zeros."""

JERKS = (None, 0.3, 0.1)
"""Limits to the jerk of the second table [m/s³]."""

OF_JERK = {
    "`numzv`": ("numzv", None),
    "`num_si`, 5 % over ±10 %": ("num_si", UnityBandOptions(tolerance=0.05, half_width=0.1)),
    "`num_ei`": ("num_ei", None),
    "`num_2ei`": ("num_2ei", None),
}
"""Its rows: kinds and their parameters."""


@cache
def figures(kind: str) -> RampFigures:
    found = design(CRANE, DRIVE, SHAPERS[kind])
    return figures_beside_textbooks(found.impulses, CRANE.modes, DRIVE, found.certificate.claims)


@cache
def ends_by_jerk() -> dict[str, list[float]]:
    """Return when the last ramps end without limit to the jerk and with each [s]."""
    drives = [replace(DRIVE, jerk_limit_m_s3=jerk) for jerk in JERKS]
    return {
        label: [
            end_of_reference(design(CRANE, drive, SHAPERS[kind], options).impulses, drive)
            for drive in drives
        ]
        for label, (kind, options) in OF_JERK.items()
    }


def move_end_s(distance_m: float, *, joint: bool) -> float:
    move = maneuver(
        CRANE, DRIVE, SHAPERS["numzv"], speed_m_s=1.0, distance_m=distance_m, joint=joint
    )
    assert move.ramps is not None
    return move.ramps.end_s


def shaped_move_end_s(distance_m: float) -> float:
    move = maneuver(CRANE, DRIVE, SHAPERS["numzv"], speed_m_s=1.0, distance_m=distance_m)
    assert move.ramps is not None
    return move.ramps.textbooks[0].ramp_end_s


def off_by(ratio: float) -> float:
    """Return the residual of a ramp of one period where the frequency is another [%]."""
    mode = replace(CRANE.mode, natural_frequency_rad_s=ratio * CRANE.mode.natural_frequency_rad_s)
    return 100 * residual_vibration(step(), mode, WHOLE)


def damped_steps() -> float:
    """Return the residual of the steps of zv with a damping ratio of 0.1 [%]."""
    mode = replace(CRANE.mode, damping_ratio=0.1)
    found = textbook_shapers((mode,), DRIVE, derivatives=0, end_s=1.0)
    return next(100 * one.residual for one in found if (one.shaper, one.command) == ("zv", "steps"))


def facts() -> set[str]:
    """Return every number of the prose and the tables that is not given, as printed."""
    numzv, numzvd = figures("numzv"), figures("numzvd")
    turned = [one.to_s for one in numzv.binding]
    whole = design(CRANE, WHOLE, SHAPERS["numzvd"])
    lone = design(CRANE, WHOLE, SHAPERS["numzv"]).impulses
    assert lone.times_s.size == 1
    three = [
        PERIOD_S, 1 / 0.3, *turned,
        0.3 * turned[0], 0.3 * turned[0] - 0.4 * (turned[1] - turned[0]),
        numzvd.end_s, end_of_reference(whole.impulses, WHOLE), end_of_reference(lone, WHOLE),
        move_end_s(12.0, joint=False), move_end_s(12.0, joint=True), move_end_s(0.3, joint=True),
        shaped_move_end_s(12.0), shaped_move_end_s(0.3),
        end_of_reference(unshaped_move(DRIVE, 12.0), DRIVE),
        design(CRANE, Ideal(), SHAPERS["umzv"]).impulses.duration_s,
        design(CRANE, Ideal(), SHAPERS["zv"]).impulses.duration_s,
        unshaped_ramp_residual(CRANE.mode, DRIVE),
        *(one.ramp_end_s for found in (numzv, numzvd) for one in found.textbooks),
        replace(DRIVE, jerk_limit_m_s3=0.3).unit_ramps_s[0],
        *(end_s for row in ends_by_jerk().values() for end_s in row),
    ]  # fmt: skip
    one_digit = [
        1 / 0.4, damped_steps(), off_by(0.9), off_by(1.1),
        5 / unshaped_ramp_residual(CRANE.mode, DRIVE),
        *(100 * one.residual for found in (numzv, numzvd) for one in found.textbooks),
        *(100 * one.earlier for found in (numzv, numzvd) for one in found.textbooks),
    ]  # fmt: skip
    return {
        *(f"{value:.3f}" for value in three),
        *(f"{value:.1f}" for value in one_digit),
        f"{1 / PERIOD_S:.4g}",
        f"{1 / (3 * PERIOD_S):.4g}",
    }


def test_every_number_of_the_page_is_given_or_computed() -> None:
    printed = set(re.findall(r"(?<![\w.])\d+(?:\.\d+)?(?![\w.]*\w)", PROSE))
    assert printed - facts() - GIVEN == set()
    assert facts() - printed - GIVEN == set()


def test_the_table_is_what_the_answer_compares() -> None:
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in PAGE.splitlines()
        if line.startswith("| `")
    ]
    expected = []
    for kind in ("numzv", "numzvd"):
        found = figures(kind)
        expected.append([f"`{kind}`", f"{found.end_s:.3f}", "0.0", ""])
        expected += [
            [
                f"`{one.shaper}`, `{one.command}`",
                f"{one.ramp_end_s:.3f}",
                f"{100 * one.residual:.1f}",
                f"{100 * one.earlier:.1f}",
            ]
            for one in found.textbooks
        ]
    expected += [
        [label, *(f"{end_s:.3f}" for end_s in row)] for label, row in ends_by_jerk().items()
    ]
    assert rows == expected


def test_limits_below_the_least_that_is_named_are_refused() -> None:
    least = 1 / (3 * PERIOD_S)
    slow = replace(DRIVE, accel_limit_m_s2=0.999 * least)
    with refused("ramp_too_long", "actuator.accel_limit_m_s2", says="0.05539"):
        design(CRANE, slow, SHAPERS["numzv"])
    assert design(CRANE, replace(slow, accel_limit_m_s2=1.001 * least), SHAPERS["numzv"])


def test_a_fastest_course_never_idles() -> None:
    for kind in ("numzv", "numzvd"):
        binding = figures(kind).binding
        assert sum(one.to_s - one.from_s for one in binding) == pytest.approx(
            figures(kind).end_s, rel=1e-12
        )


def test_a_ramp_of_whole_periods_swings_nothing_and_its_stop_does() -> None:
    assert residual_vibration(step(), CRANE.mode, WHOLE) < 1e-12
    # By hand: |sin(w T / 2) / (w T / 2)| of a ramp of another length.
    half = math.pi * (1 / 0.4) / PERIOD_S
    other = replace(WHOLE, accel_limit_m_s2=0.4)
    assert unshaped_ramp_residual(CRANE.mode, other) == pytest.approx(
        abs(math.sin(half) / half), rel=1e-12
    )
    assert isinstance(CRANE.mode, Mode)
