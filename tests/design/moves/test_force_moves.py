"""A free body moved by an on-off force: published switches, random bodies, bounds, refusals."""

import math
from dataclasses import replace

import numpy as np
import pytest

from design.analysis.force_bound import least_burn_s, least_duration_s
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.ideal import Ideal
from design.model.plants.free_body import FreeBody
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.moves.force_moves import ForceMove, force_move
from design.shapers.registry import SHAPERS
from design.solvers.force_pulses import ForceTask, least_force, least_time
from tests.force_route import integrated_way, state_after
from tests.refusals import refused

# Two masses of 1 kg, a spring of 1 N/m between them, 1 N on the first, 1 m (Liu and Wie 1992).
FLOATING = FreeBody(mass_kg=2.0, vibration=Mode(natural_frequency_rad_s=math.sqrt(2)))

KINDS = ("umzv", "umzvd")


def moved(
    plant: FreeBody = FLOATING,
    kind: str = "umzv",
    *,
    force_n: float = 1.0,
    distance_m: float = 1.0,
    duration_s: float | None = None,
) -> ForceMove:
    return force_move(
        plant,
        Ideal(),
        SHAPERS[kind],
        force_n=force_n,
        distance_m=distance_m,
        duration_s=duration_s,
    )


def drawn_body(rng: np.random.Generator, most_modes: int) -> tuple[Mode, ...]:
    frequencies = np.cumsum(rng.uniform(1.0, 4.0, int(rng.integers(1, most_modes + 1))))
    damping = float(rng.choice([0.0, 0.0, 0.02, 0.1]))
    return tuple(Mode(natural_frequency_rad_s=float(w), damping_ratio=damping) for w in frequencies)


def body_of(modes: tuple[Mode, ...], mass_kg: float = 2.0) -> FreeBody:
    return FreeBody(mass_kg=mass_kg, vibration=modes[0] if len(modes) == 1 else Modes(modes=modes))


@pytest.mark.parametrize(
    ("kind", "printed_s"),
    [
        ("umzv", [0, 1.003, 2.109, 3.215, 4.218]),
        ("umzvd", [0, 0.7124, 1.6563, 2.9330, 4.2096, 5.1536, 5.8660]),
    ],
)
def test_the_floating_oscillator_is_moved_as_published(kind: str, printed_s: list[float]) -> None:
    move = moved(kind=kind)
    digits = 5e-4 if kind == "umzv" else 6e-5
    assert move.command.times_s == pytest.approx(printed_s, abs=digits)
    signs = [(-1.0) ** number for number in range(len(printed_s) - 2)]
    assert move.command.amplitudes.tolist() == [1.0, *(-2 * sign for sign in signs), 1.0]


def test_a_stiff_body_moves_as_a_rigid_one() -> None:
    """Half of the time forward, half back: 2 sqrt(way), plus what the fast mode asks."""
    stiff = FreeBody(mass_kg=2.0, vibration=Mode(natural_frequency_rad_s=100.0))
    rigid_s = 2 * math.sqrt(2.0)
    assert rigid_s <= moved(stiff).duration_s <= rigid_s + math.tau / 100.0


@pytest.mark.parametrize("seed", range(20))
def test_a_random_body_comes_to_rest_over_its_way_and_vibrates_no_more(seed: int) -> None:
    rng = np.random.default_rng(seed)
    modes, kind = drawn_body(rng, 3), KINDS[seed % 2]
    distance_m = float(rng.choice([-1, 1]) * 10 ** rng.uniform(-1.5, 2))
    move = moved(body_of(modes), kind, force_n=2.0, distance_m=distance_m)
    way_s2, speed_s, vibration = state_after(move.command, modes)
    assert move.direction * way_s2 == pytest.approx(distance_m, rel=1e-10)
    assert abs(speed_s) <= 1e-11 * move.duration_s
    assert vibration <= 1e-9
    assert move.lower_bound_s <= move.duration_s
    assert move.lower_bound_s == pytest.approx(move.duration_s, rel=1e-6)
    assert set(np.round(np.cumsum(move.command.amplitudes), 12)) <= {-1.0, 0.0, 1.0}
    if kind == "umzvd":  # flat: an error of 1 % is one of its square
        off = state_after(move.command, modes, frequency_factor=1.001)[2]
        plain = moved(body_of(modes), "umzv", force_n=2.0, distance_m=distance_m)
        assert off <= 0.3 * state_after(plain.command, modes, frequency_factor=1.001)[2] + 1e-9


@pytest.mark.parametrize("seed", range(12))
def test_a_longer_move_has_the_force_on_as_shortly_as_may_be(seed: int) -> None:
    rng = np.random.default_rng(seed)
    modes, kind = drawn_body(rng, 2), KINDS[seed % 2]
    body = body_of(modes)
    fastest = moved(body, kind, distance_m=3.0)
    duration_s = float(rng.uniform(1.05, 2.0)) * fastest.duration_s
    move = moved(body, kind, distance_m=3.0, duration_s=duration_s)
    way_s2, speed_s, vibration = state_after(move.command, modes)
    assert way_s2 == pytest.approx(6.0, rel=1e-10)
    assert abs(speed_s) <= 1e-10
    assert vibration <= 1e-9
    assert move.duration_s <= duration_s * (1 + 1e-12)
    assert move.least_burn_s is not None
    assert move.least_burn_s <= move.burn_s * (1 + 1e-12) < fastest.burn_s
    assert move.burn_s == pytest.approx(move.least_burn_s, rel=1e-4)
    levels = np.abs(np.round(np.cumsum(move.command.amplitudes)[:-1], 12))
    assert set(levels) == {0.0, 1.0}
    assert float(levels @ np.diff(move.command.times_s)) == pytest.approx(move.burn_s, rel=1e-12)


def test_the_way_is_that_of_an_integrator() -> None:
    assert integrated_way(moved().command) == pytest.approx(2.0, abs=1e-9)


def test_any_weights_prove_a_bound_and_those_found_the_best() -> None:
    modes = FLOATING.excited
    task = ForceTask(modes=modes, way_s2=2.0, derivatives=0)
    steps = least_time(task)
    assert steps is not None
    least_s, rng = float(steps.times_s[-1]), np.random.default_rng(3)
    best = least_duration_s(modes, steps.weights, 2.0)
    assert best == pytest.approx(least_s, rel=1e-11)
    for _ in range(20):
        other = steps.weights * np.array([1.0, *rng.uniform(0.5, 1.5, 3)])
        assert least_duration_s(modes, other, 2.0) <= best
    slow = least_force(task, 6.0)
    assert slow is not None
    burn = least_burn_s(modes, slow.weights, 2.0, 6.0)
    for _ in range(20):
        other = slow.weights * rng.uniform(0.5, 1.5, 4)
        assert least_burn_s(modes, other, 2.0, 6.0) <= burn


def test_twice_as_fast_a_mode_over_a_quarter_of_the_way_takes_half_the_time() -> None:
    fast = FreeBody(mass_kg=2.0, vibration=Mode(natural_frequency_rad_s=2 * math.sqrt(2)))
    half = moved(fast, distance_m=0.25).command.times_s
    assert 2 * half == pytest.approx(moved().command.times_s, rel=1e-11)


def test_a_move_back_is_the_same_the_other_way() -> None:
    forth, back = moved(), moved(distance_m=-1.0)
    assert forth.command.times_s.tolist() == back.command.times_s.tolist()
    assert (back.direction, back.distance_m) == (-1, -forth.distance_m)


def test_steps_that_break_a_claim_are_not_returned(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever a search returns is judged: here it returns what it should not."""
    good = least_time(ForceTask(modes=FLOATING.excited, way_s2=2.0, derivatives=0))
    assert good is not None
    rigid = np.array([0.0, math.sqrt(2.0), 2 * math.sqrt(2.0)])
    returned = {
        "force_switches_not_found": None,
        # On the way of a rigid body, at rest, but vibrating.
        "force_move_not_verified": replace(
            good, times_s=rigid, amplitudes=np.array([1.0, -2.0, 1.0])
        ),
        "force_leaves_speed": replace(
            good, times_s=rigid * np.array([1.0, 0.9, 1.0]), amplitudes=np.array([1.0, -2.0, 1.0])
        ),
    }
    for code, steps in returned.items():
        monkeypatch.setattr("design.moves.force_moves.least_time", lambda _, steps=steps: steps)
        with refused(code):
            moved()


def test_what_a_free_body_does_not_take_is_refused() -> None:
    drive = FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.1)
    with refused("force_through_drive", "actuator.kind"):
        force_move(FLOATING, drive, SHAPERS["umzv"], force_n=1.0, distance_m=1.0)
    with refused("kind_not_by_force", "shaper.kind"):
        moved(kind="ei")
    with refused("not_positive", "force_n"):
        moved(force_n=0.0)
    with refused("out_of_range", "distance_m"):
        moved(distance_m=0.0)
    with refused("force_move_too_long", "distance_m"):
        moved(distance_m=1e6)
    with refused("duration_below_force_time", says="the least time is 4.21786651 s"):
        moved(duration_s=4.2)
    with refused("out_of_range", "duration_s"):
        moved(duration_s=100.0)
    with refused("plant_moved_by_force", "plant.kind"):
        _ = FLOATING.mode
    with refused("not_positive", "mass_kg"):
        FreeBody(mass_kg=0.0, vibration=Mode(natural_frequency_rad_s=1.0))
