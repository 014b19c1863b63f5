"""The sheet of a move, and the limits that bind it, as drawn."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.legend import Legend
from matplotlib.lines import Line2D

from design.analysis.sensitivity import SensitivityRange, sensitivity
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.initial_state import AngleSwing
from design.model.plants.pendulum import Pendulum
from design.moves.maneuvers import Maneuver, maneuver
from design.pictures.design_sheet import design_sheet
from design.pictures.files import figure_bytes
from design.pictures.move_sheet import move_sheet
from design.pipeline import design
from design.shapers.registry import SHAPERS
from tests.design.pictures.drawn import lines, panel, points
from tests.expm_route import outcome

VERSION = "1.2.3"
CRANE = Pendulum(cable_length_m=9.0, gravity_m_s2=9.81)
LIMITS = RateLimited(accel_limit_m_s2=0.3, decel_limit_m_s2=0.4, speed_m_s=1.0)
LAGGED = RateLimited(
    accel_limit_m_s2=0.3,
    decel_limit_m_s2=0.4,
    speed_m_s=1.0,
    then=FirstOrder(accel_time_constant_s=0.25, decel_time_constant_s=0.25),
)


def moved(drive: Actuator, distance_m: float, kind: str = "numzv") -> Maneuver:
    return maneuver(CRANE, drive, SHAPERS[kind], speed_m_s=1.0, distance_m=distance_m)


def marks(axes: Axes) -> list[Line2D]:
    return lines(axes, "limit-")


@pytest.mark.parametrize("distance_m", [12.0, -12.0, 0.3])
def test_each_mark_has_the_slope_of_its_limit(distance_m: float) -> None:
    axes = panel(move_sheet("numzv", CRANE, LIMITS, moved(LIMITS, distance_m), VERSION), "velocity")
    slopes = {"acceleration": 0.3, "deceleration": -0.4, "speed": 0.0, "rest": 0.0}
    sign = 1 if distance_m > 0 else -1
    for mark in marks(axes):
        limit = str(mark.get_gid()).removeprefix("limit-")
        times, levels = points(mark)
        np.testing.assert_allclose(
            np.diff(levels), sign * slopes[limit] * np.diff(times), atol=1e-9
        )
        if limit in {"speed", "rest"}:
            np.testing.assert_allclose(levels, sign * float(limit == "speed"), atol=1e-9)


@pytest.mark.parametrize("drive", [LIMITS, replace(LIMITS, jerk_limit_m_s3=0.5)])
def test_the_marks_follow_the_velocity_of_an_ideal_drive_from_end_to_end(
    drive: RateLimited,
) -> None:
    move = moved(drive, 12.0, "numzvd")
    axes = panel(move_sheet("numzvd", CRANE, drive, move, VERSION), "velocity")
    times, velocity = points(lines(axes, "velocity-line")[0])
    reached = 0.0
    for mark in marks(axes):
        at, levels = points(mark)
        assert at[0] == pytest.approx(reached, abs=1e-9)
        np.testing.assert_allclose(levels, np.interp(at, times, velocity), atol=0.01)
        reached = float(at[-1])
    assert move.ramps is not None
    assert reached == pytest.approx(move.ramps.end_s, rel=1e-12)


def test_the_legend_names_each_limit_that_binds_once() -> None:
    axes = panel(move_sheet("numzv", CRANE, LIMITS, moved(LIMITS, 0.3), VERSION), "velocity")
    texts = [
        text.get_text()
        for legend in axes.get_children()
        if isinstance(legend, Legend)
        for text in legend.get_texts()
    ]
    assert sorted(texts) == ["acceleration", "command", "deceleration", "rest", "velocity"]


def test_a_design_sheet_marks_its_limits_too_and_says_when_the_last_ramp_ends() -> None:
    made = design(CRANE, LAGGED, SHAPERS["numzvd"])
    curve = sensitivity(made.impulses, CRANE.mode, LAGGED, SensitivityRange())
    figure = design_sheet("numzvd", CRANE, LAGGED, made, [curve], VERSION)
    limits = [str(mark.get_gid()) for mark in marks(panel(figure, "command"))]
    assert limits == [f"limit-{name}celeration" for name in ("ac", "de", "ac", "de", "ac")]
    texts = [text.get_text() for text in figure.texts]
    assert "last ramp ends" in texts
    assert "6.678 s" in texts


@pytest.mark.parametrize("drive", [Ideal(), LIMITS, LAGGED])
@pytest.mark.parametrize("distance_m", [5.0, -5.0])
def test_the_payload_hangs_still_after_the_move(drive: Actuator, distance_m: float) -> None:
    kind = "umzv" if isinstance(drive, Ideal) else "numzv"
    move = moved(drive, distance_m, kind)
    axes = panel(move_sheet(kind, CRANE, drive, move, VERSION), "payload")
    times, deflection = points(lines(axes, "shaped")[0])
    late = times > times[-1] - 2.0
    largest = float(np.abs(deflection).max())
    assert np.abs(deflection[late]).max() < 1e-6 * largest
    # It hangs back as the crane sets off.
    first = np.flatnonzero(np.abs(deflection) > 0.05 * largest)[0]
    assert deflection[first] * distance_m < 0


def test_a_swing_at_the_start_is_drawn_and_cancelled() -> None:
    begun = AngleSwing(angle_rad=0.02, angle_rate_rad_s=0.01)
    move = maneuver(CRANE, LAGGED, SHAPERS["numzv"], speed_m_s=1.0, distance_m=-0.5, initial=begun)
    axes = panel(move_sheet("numzv", CRANE, LAGGED, move, VERSION), "payload")
    times, deflection = points(lines(axes, "shaped")[0])
    assert np.interp(0.0, times, deflection) == pytest.approx(0.02 * 9.0, abs=1e-9)
    rate = (np.interp(0.01, times, deflection) - np.interp(-0.01, times, deflection)) / 0.02
    assert rate == pytest.approx(0.01 * 9.0, abs=5e-3)
    assert np.abs(deflection[times > times[-1] - 2.0]).max() < 1e-6


def test_without_limits_there_is_no_mark_and_the_end_is_a_switch() -> None:
    figure = move_sheet("umzv", CRANE, Ideal(), moved(Ideal(), 5.0, "umzv"), VERSION)
    assert marks(panel(figure, "velocity")) == []
    assert "last switch" in [text.get_text() for text in figure.texts]


def test_the_bytes_repeat() -> None:
    move = moved(LIMITS, 0.3)
    first, second = (
        figure_bytes(move_sheet("numzv", CRANE, LIMITS, move, VERSION), "svg") for _ in range(2)
    )
    assert first == second
    assert first.startswith(b"<?xml")


def test_the_residual_in_words_is_that_of_another_route() -> None:
    move = moved(LIMITS, 12.0)
    figure = move_sheet("numzv", CRANE, LIMITS, move, VERSION)
    assert outcome(move.command, CRANE.mode, LIMITS).residual < 1e-9
    assert "residual below 1e-7 %" in [text.get_text() for text in figure.texts]
