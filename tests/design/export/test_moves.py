"""Moves in C and Structured Text, played and held against the plant by a route of its own."""

import math
from pathlib import Path

import numpy as np
import pytest

from design.claims import ZERO_LIMITS
from design.export.move import MoveBlocks, Sequence
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.rate_limited import RateLimited
from design.model.impulses import Impulses
from design.model.initial_state import AngleSwing
from design.model.plants.pendulum import Pendulum
from design.moves.cycles import JITTER, played_in_cycles
from design.moves.later_stops import RIGHT, later_stops
from design.shapers.registry import SHAPERS
from design.tables.rows import Real
from design.types import FloatArray
from tests import expm_route
from tests.played_moves import (
    Calls,
    Case,
    InC,
    case,
    mean_levels,
    on_steps,
    play_in_text,
    random_cases,
    steady,
    steps_of,
)

COUNT = 30
"""Random moves, both models in turn."""

CYCLE_S = 0.001

SWITCHED = FirstOrder(accel_time_constant_s=0.3, decel_time_constant_s=0.15, model="switched")
CRANE = Pendulum(cable_length_m=9.0)


@pytest.fixture(scope="module")
def cases() -> list[Case]:
    return random_cases(COUNT, 7)


@pytest.fixture(scope="module")
def in_double(cases: list[Case], tmp_path_factory: pytest.TempPathFactory) -> InC:
    return InC(tmp_path_factory.mktemp("double"), cases, single=False)


@pytest.fixture(scope="module")
def in_float(cases: list[Case], tmp_path_factory: pytest.TempPathFactory) -> InC:
    return InC(tmp_path_factory.mktemp("float"), cases, single=True)


@pytest.fixture(scope="module")
def travel() -> Case:
    return case(CRANE, SWITCHED, "numzv", speed_m_s=1.0, distance_m=-12.0)


def whole(blocks: MoveBlocks) -> tuple[str, Sequence]:
    return f"{blocks.name}_move", blocks.sequences[-1]


def starts(calls: Calls) -> FloatArray:
    """Return when each call is, the first at 0."""
    cycles = np.array([cycle for _, _, cycle in calls])
    times_s: FloatArray = np.cumsum(cycles) - cycles[0]
    return times_s


def left(one: Case, share: FloatArray, times_s: FloatArray) -> expm_route.Outcome:
    """Play shares, each held to the next call, through drive and payload."""
    played = steps_of(one.move.direction * share, times_s)
    return expm_route.outcome(played, one.mode, one.actuator, one.swing)


def test_the_cases_are_of_every_sort(cases: list[Case]) -> None:
    assert {one.move.direction for one in cases} == {1, -1}
    assert {one.move.joint for one in cases} == {True, False}
    assert {getattr(one.actuator, "model", "") for one in cases} == {"superposed", "switched"} | ({
        "superposed"
    })
    assert sum(isinstance(one.actuator, RateLimited) for one in cases) == COUNT // 10
    assert {one.kind for one in cases} == {"numzv", "numzvd", "umzvc"}


@pytest.mark.parametrize("place", range(COUNT))
def test_levels_as_they_are_leave_what_the_certificate_says(
    cases: list[Case], in_double: InC, place: int
) -> None:
    one = cases[place]
    name, sequence = whole(one.blocks())
    calls = on_steps(sequence.times_s)
    played = in_double.play(name, calls)
    found = left(one, played.share, starts(calls))
    assert one.move.certificate.verified
    limit = 2 * ZERO_LIMITS["residual"]  # that of the certificate, and as much for its other route
    assert found.residual <= (limit if not one.move.for_ideal else one.move.residual + limit)
    way = one.move.direction * one.move.speed_m_s * found.travel
    assert way == pytest.approx(one.move.distance_m, rel=1e-9)
    np.testing.assert_allclose(played.velocity_m_s, one.move.speed_m_s * played.share, rtol=1e-15)
    assert played.share[-1] == 0.0
    assert not played.error.any()


@pytest.mark.parametrize("place", range(COUNT))
def test_steady_cycles_leave_what_the_head_says(
    cases: list[Case], in_double: InC, place: int
) -> None:
    one = cases[place]
    name, sequence = whole(one.blocks())
    calls = steady(CYCLE_S, sequence.end_s)
    played = in_double.play(name, calls)
    wanted = one.move.direction * mean_levels(one.move.command, CYCLE_S, len(calls))
    np.testing.assert_allclose(played.share, wanted, atol=1e-9)
    told = played_in_cycles(one.move.command, one.mode, one.actuator, CYCLE_S)
    assert told is not None
    times_s = CYCLE_S * np.arange(len(calls))
    found = left(one, np.where(np.abs(played.share) < 1e-9, 0.0, played.share), times_s)
    assert found.residual == pytest.approx(told.residual, abs=1e-7)
    way = one.move.direction * one.move.speed_m_s * found.travel
    assert way == pytest.approx(one.move.distance_m * (1 + told.missed), rel=1e-7)
    # The end is told in the call that gives the last level, or when the last ramp is over.
    assert played.done.argmax() == math.ceil(sequence.end_s / CYCLE_S - 1e-9)
    np.testing.assert_array_equal(played.busy, 1 - played.done)


@pytest.mark.parametrize("place", range(COUNT))
def test_calls_that_are_early_or_late_leave_no_more_than_the_head_says(
    cases: list[Case], in_double: InC, place: int
) -> None:
    one = cases[place]
    name, sequence = whole(one.blocks())
    calls = steady(CYCLE_S, sequence.end_s)
    share = in_double.play(name, calls).share
    told = played_in_cycles(one.move.command, one.mode, one.actuator, CYCLE_S)
    assert told is not None
    rng = np.random.default_rng(place)
    for _ in range(3):
        jitter = rng.choice([-1.0, 1.0], len(calls)) * JITTER * CYCLE_S
        found = left(one, share, CYCLE_S * np.arange(len(calls)) + jitter)
        assert found.residual <= 1.001 * told.with_jitter + 1e-7


@pytest.mark.parametrize("place", range(COUNT))
def test_single_precision_leaves_what_the_head_says(
    cases: list[Case], in_float: InC, place: int
) -> None:
    one = cases[place]
    name, sequence = whole(one.blocks())
    calls = steady(CYCLE_S, sequence.end_s)
    played = in_float.play(name, calls)
    wanted = one.move.direction * mean_levels(one.move.command, CYCLE_S, len(calls))
    # A time is off by 6e-8 of itself, which is so much of the one cycle that has the step.
    np.testing.assert_allclose(played.share, wanted, atol=3e-7 * sequence.end_s / CYCLE_S)
    assert played.share[-1] == 0.0
    told = played_in_cycles(one.move.command, one.mode, one.actuator, CYCLE_S)
    assert told is not None
    found = left(one, played.share, CYCLE_S * np.arange(len(calls)))
    turn = one.mode.natural_frequency_rad_s * 3e-7 * sequence.end_s
    assert found.residual <= told.residual + turn * 2 * sequence.times_s.size


@pytest.mark.parametrize("real", ["LREAL", "REAL"])
@pytest.mark.parametrize("place", range(0, COUNT, 3))
def test_structured_text_does_what_c_does(
    cases: list[Case], in_double: InC, in_float: InC, place: int, real: Real
) -> None:
    one = cases[place]
    of = real
    text = one.written("st", of).decode()
    blocks, in_c = one.blocks(of), in_double if of == "LREAL" else in_float
    for sequence, other in zip(blocks.sequences, one.blocks().sequences, strict=True):
        calls = steady(one.mode.period_s / 61, sequence.end_s)
        calls += [(False, False, calls[0][2])] * 2
        found = play_in_text(text, f"{blocks.name}_{sequence.name}", calls)
        wanted = in_c.play(f"{one.blocks().name}_{other.name}", calls)
        np.testing.assert_allclose(found.share, wanted.share, atol=1e-13 if of == "LREAL" else 1e-6)
        for field in ("busy", "done", "error"):
            np.testing.assert_array_equal(getattr(found, field), getattr(wanted, field))


def test_a_stop_is_right_once_the_start_is_done(cases: list[Case], in_double: InC) -> None:
    rng = np.random.default_rng(5)
    apart = [one for one in cases if len(one.blocks().sequences) == 3]
    assert len(apart) > COUNT / 2
    waited = 0
    for one in apart:
        name = one.blocks().name
        start, stop, _ = one.blocks().sequences
        told = later_stops(one.move, one.mode, one.actuator)
        waited += told.wait_s > 0
        first, second = (
            in_double.play(f"{name}_{part.name}", steady(CYCLE_S, part.end_s))
            for part in (start, stop)
        )
        begins = int(first.done.argmax()) + 1 + int(rng.integers(0, 4000))
        share = np.full(begins + second.share.size, first.share[-1])
        share[: first.share.size] = first.share[: share.size]
        share[begins:] = second.share
        found = left(one, share, CYCLE_S * np.arange(share.size))
        # As in numbers without cycles, and what cycles of 1 ms add to these.
        both = Impulses(
            times_s=np.concatenate((start.times_s, CYCLE_S * begins + stop.times_s)),
            amplitudes=np.concatenate((one.move.start.amplitudes, one.move.stop.amplitudes)),
        )
        between = expm_route.outcome(both, one.mode, one.actuator, one.swing).residual
        assert between <= 1.1 * told.residual + 2 * ZERO_LIMITS["residual"]
        in_cycles = played_in_cycles(both, one.mode, one.actuator, CYCLE_S)
        assert in_cycles is not None
        assert found.residual == pytest.approx(in_cycles.residual, abs=1e-7)
        assert told.residual <= RIGHT
    assert waited > 5


def test_a_stop_that_does_not_wait_for_a_switched_drive_swings(travel: Case) -> None:
    told = later_stops(travel.move, travel.mode, travel.actuator)
    assert told.sooner > 100 * RIGHT
    start, _, _ = travel.blocks().sequences
    assert start.end_s == pytest.approx(travel.move.start.duration_s + told.wait_s)


def test_a_move_in_minus_x_is_signed(travel: Case, tmp_path: Path) -> None:
    name, sequence = whole(travel.blocks())
    assert sequence.toggles == -1.0
    played = InC(tmp_path, [travel], single=False).play(name, steady(0.01, sequence.end_s))
    assert played.share.max() == 0.0
    assert played.share.min() == -1.0
    way = -float(np.cumsum(travel.move.command.amplitudes)[:-1] @ np.diff(sequence.times_s))
    assert 0.01 * played.velocity_m_s.sum() == pytest.approx(way, rel=1e-12)  # of the command


OTHERS = {
    "peak": lambda: case(
        CRANE,
        FirstOrder(accel_time_constant_s=0.3, decel_time_constant_s=0.15),
        "umzvc",
        options=SHAPERS["umzvc"].options(max_velocity_ratio=1.25),
        speed_m_s=0.8,
        distance_m=-9.0,
    ),
    "slower": lambda: case(CRANE, SWITCHED, "numzvd", speed_m_s=1.0, distance_m=0.2),
    "swinging": lambda: case(
        CRANE,
        SWITCHED,
        "numzv",
        speed_m_s=1.0,
        distance_m=7.0,
        initial=AngleSwing(angle_rad=0.02, angle_rate_rad_s=-0.01),
    ),
}


@pytest.mark.parametrize("real", ["LREAL", "REAL"])
@pytest.mark.parametrize("which", OTHERS)
def test_other_levels_are_played_too(which: str, real: Real, tmp_path: Path) -> None:
    one = OTHERS[which]()
    single = real == "REAL"
    name, sequence = whole(one.blocks())
    calls = on_steps(sequence.times_s)
    played = InC(tmp_path, [one], single=single).play(name, calls)
    in_text = play_in_text(one.written("st").decode(), name, calls)
    # A time is off by 6e-8 of itself, which is so much of the one cycle that has the step.
    rounding = 3e-7 * sequence.end_s / min(cycle for _, _, cycle in calls)
    np.testing.assert_allclose(played.share, in_text.share, atol=rounding if single else 1e-13)
    for level in sequence.levels:
        assert np.abs(played.share - level).min() <= 1e-7
    if not single:
        found = left(one, played.share, starts(calls))
        assert found.residual <= one.move.residual + 2 * ZERO_LIMITS["residual"]
        way = one.move.direction * one.move.speed_m_s * found.travel
        assert way == pytest.approx(one.move.distance_m, rel=1e-9)
    assert played.share[-1] == 0.0
    assert (sequence.toggles is None) == (which == "peak")
    if which == "slower":
        assert 0 < float(np.abs(sequence.levels).max()) <= 1


@pytest.mark.parametrize("distance_m", [12.0, -12.0])
@pytest.mark.parametrize("limited", [False, True])
def test_a_program_on_samples_is_played_sample_by_sample(
    distance_m: float, limited: bool, tmp_path: Path
) -> None:
    drive = (
        RateLimited(accel_limit_m_s2=2.0, decel_limit_m_s2=3.0, speed_m_s=1.0)
        if limited
        else SWITCHED
    )
    one = case(CRANE, drive, "numzv", speed_m_s=1.0, distance_m=distance_m, sample_time_s=0.04)
    assert one.program is not None
    name, sequence = whole(one.blocks())
    assert [part.name for part in one.blocks().sequences] == ["move"]
    calls = [(True, False, 0.04)] * (sequence.last_sample + 2)
    wanted = one.program.velocity_m_s
    for played in (
        InC(tmp_path, [one], single=False).play(name, calls),
        play_in_text(one.written("st").decode(), name, calls),
    ):
        np.testing.assert_allclose(played.velocity_m_s[: wanted.size], wanted, atol=1e-15)
        assert not played.velocity_m_s[wanted.size :].any()
        assert played.done.argmax() == sequence.last_sample
        found = left(one, played.share, 0.04 * np.arange(len(calls)))
        assert found.residual == pytest.approx(one.program.residual, abs=1e-9)
        way = one.move.direction * one.move.speed_m_s * found.travel
        assert way == pytest.approx(one.program.distance_m, rel=1e-9)
    single = InC(tmp_path, [one], single=True).play(name, [(True, False, 0.04)] * len(calls))
    np.testing.assert_allclose(single.velocity_m_s[: wanted.size], wanted, atol=1e-7)
    # Of another cycle nothing is verified.
    other = play_in_text(one.written("st").decode(), name, [(True, False, 0.041)] * 3)
    assert other.error.all()
    assert not other.velocity_m_s.any()
