"""The certificate holds for right shapers and for no others."""

import math

import numpy as np
import pytest

from design.analysis.certificate import METHOD, Certificate, Claim, certify
from design.analysis.claims_found import zeros_of
from design.analysis.residual import residual_vectors
from design.claims import ZERO_LIMITS, Quantity, zeros
from design.model.actuators.first_order import FirstOrder
from design.model.actuators.model import Model
from design.model.actuators.registry import Actuator
from design.model.actuators.second_order import SecondOrder, SecondOrderSet
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.pipeline import design
from design.shapers.registry import SHAPERS
from design.types import FloatArray
from tests.second_route import claims_by_formula, derivatives_by_series, ideal_derivative_by_formula
from tests.shaper_table import CRANE, DAMPED, FIRST_ORDER, IDEAL, THESIS

CLAIMS: tuple[Quantity, ...] = ("residual", "slope")
SWAPPED = SecondOrder(accel=THESIS.decel, decel=THESIS.accel)


def shaper(name: str, plant: Plant, actuator: Actuator) -> Impulses:
    return design(plant, actuator, SHAPERS[name]).impulses


def move(impulses: Impulses, index: int, by: float) -> Impulses:
    times = impulses.times_s.copy()
    times[index] += by
    return Impulses(times_s=times, amplitudes=impulses.amplitudes)


def values(impulses: Impulses, mode: Mode, actuator: Actuator) -> dict[str, float]:
    return {
        one.quantity: one.value for one in certify(impulses, mode, actuator, zeros(CLAIMS)).claims
    }


@pytest.mark.parametrize("plant", [CRANE, DAMPED])
@pytest.mark.parametrize("actuator", [IDEAL, FIRST_ORDER, THESIS])
def test_a_right_shaper_is_verified(plant: Plant, actuator: Actuator) -> None:
    certificate = certify(shaper("numzvd", plant, actuator), plant.mode, actuator, zeros(CLAIMS))
    assert certificate.verified
    assert [claim.limit for claim in certificate.claims] == [1e-9, 1e-7]


@pytest.mark.parametrize("index", [1, 2, 3, 4])
@pytest.mark.parametrize("by", [-1e-7, 1e-7])
def test_a_switch_a_tenth_of_a_microsecond_off_is_found(index: int, by: float) -> None:
    wrong = move(shaper("numzvd", CRANE, THESIS), index, by)
    # 3.5 rad/s for 1e-7 s: 3.5e-7 of a step, 350 times the limit.
    assert not certify(wrong, CRANE.mode, THESIS, zeros(("residual",))).verified


@pytest.mark.parametrize("actuator", [IDEAL, FIRST_ORDER, SWAPPED])
def test_a_shaper_for_another_actuator_is_not_verified(actuator: Actuator) -> None:
    made = shaper("numzvd", CRANE, THESIS)
    assert not certify(made, CRANE.mode, actuator, zeros(("residual",))).verified


@pytest.mark.parametrize("ratio", [0.999, 1.001])
def test_a_shaper_for_another_frequency_is_not_verified(ratio: float) -> None:
    other = Mode(natural_frequency_rad_s=ratio * CRANE.mode.natural_frequency_rad_s)
    made = shaper("numzvd", CRANE, THESIS)
    # A zero slope still leaves (width ~ .26 at 5 %) about 3e-6 at a thousandth.
    assert not certify(made, other, THESIS, zeros(("residual",))).verified


def test_a_wrong_amplitude_is_not_verified() -> None:
    made = shaper("umzv", CRANE, IDEAL)
    wrong = Impulses(times_s=made.times_s, amplitudes=np.array([1.0, -1.0, 1.0 + 1e-8]))
    assert not certify(wrong, CRANE.mode, IDEAL, zeros(("residual",))).verified


def test_a_shaper_of_three_impulses_has_a_slope() -> None:
    certificate = certify(shaper("numzv", CRANE, THESIS), CRANE.mode, THESIS, zeros(CLAIMS))
    holds = {claim.quantity: claim.holds for claim in certificate.claims}
    assert holds == {"residual": True, "slope": False}
    assert not certificate.verified


COMMANDS: dict[str, tuple[FloatArray, FloatArray]] = {
    "step": (np.array([0.0]), np.array([1.0])),
    "pulse": (np.array([0.0, 0.4]), np.array([1.0, -1.0])),
    "rough shaper": (np.array([0.0, 0.17, 0.64, 1.14, 1.27]), np.array([1.0, -1, 1, -1, 1])),
    "move": (np.array([0.0, 0.3, 2.0, 2.3]), np.array([0.5, 0.5, -0.5, -0.5])),
}


@pytest.mark.parametrize("name", COMMANDS)
@pytest.mark.parametrize("actuator", [IDEAL, FIRST_ORDER, THESIS])
@pytest.mark.parametrize("z", [0.0, 0.1])
def test_the_values_of_any_command_are_those_of_the_formula(
    name: str, actuator: Actuator, z: float
) -> None:
    times, amplitudes = COMMANDS[name]
    command = Impulses(times_s=times, amplitudes=amplitudes)
    mode = Mode(natural_frequency_rad_s=3.5, damping_ratio=z)
    found, expected = values(command, mode, actuator), claims_by_formula(command, mode, actuator)
    assert found["residual"] == pytest.approx(expected["residual"], abs=1e-12)  # rounding
    # Central difference: (1e-5)^2 / 6 times the third derivative, at most (3.5 * 2.3)^3 * 4.
    assert found["slope"] == pytest.approx(expected["slope"], abs=1e-7)


@pytest.mark.parametrize("rate", [1e3, 1e6, 1e9])
def test_a_stiff_actuator_does_not_drown_the_slope_in_rounding(rate: float) -> None:
    actuator = FirstOrder(accel_time_constant_s=1 / rate, decel_time_constant_s=0.05)
    made = shaper("numzvd", CRANE, actuator)
    # An order below the limit: a hundred times the rounding of an unstiff one.
    assert values(made, CRANE.mode, actuator)["slope"] <= 0.1 * ZERO_LIMITS["slope"]


def near_pole(seed: int, model: Model) -> tuple[Mode, SecondOrder, float]:
    """Return a drive with one pole near the plant's, and how near: .001 to .3 of w."""
    rng = np.random.default_rng(seed)
    w, z = float(rng.uniform(0.5, 5)), float(rng.uniform(0.15, 0.45))
    mode = Mode(natural_frequency_rad_s=w, damping_ratio=z)
    apart = float(np.exp(rng.uniform(np.log(1e-3), np.log(0.3))))
    pole = mode.pole_rad_s + w * apart * np.exp(1j * rng.uniform(0, 2 * np.pi))
    near = SecondOrderSet(
        natural_frequency_rad_s=abs(pole), damping_ratio=max(0.1, -pole.real / abs(pole))
    )
    far = SecondOrderSet(
        natural_frequency_rad_s=w * float(rng.uniform(3, 20)),
        damping_ratio=float(rng.uniform(0.3, 2)),
    )
    sets = (near, far) if seed % 2 else (far, near)
    return mode, SecondOrder(accel=sets[0], decel=sets[1], model=model), apart


@pytest.mark.parametrize("model", ["superposed", "switched"])
@pytest.mark.parametrize("seed", range(60))
def test_derivatives_near_a_pole_of_the_drive_are_those_of_the_series(
    seed: int, model: Model
) -> None:
    mode, drive, apart = near_pole(seed, model)
    rng = np.random.default_rng(1000 + seed)
    command = Impulses(
        times_s=np.sort(rng.uniform(0, 2 * mode.period_s, 4)), amplitudes=rng.uniform(-1, 1, 4)
    )
    expected = derivatives_by_series(command, mode, drive, 3)
    told = [one.value for one in certify(command, mode, drive, zeros(ALL_ORDERS)).claims]
    for order, (value, right) in enumerate(zip(told, expected, strict=True)):
        # A derivative grows by 1 / apart, and rounding and truncation with it.
        assert value == pytest.approx(right, rel=1e-7, abs=1e-9 * apart**-order), order


def test_only_what_is_claimed_is_recomputed() -> None:
    certificate = certify(shaper("umzv", CRANE, IDEAL), CRANE.mode, IDEAL, zeros(("residual",)))
    assert [claim.quantity for claim in certificate.claims] == ["residual"]
    assert certificate.method == METHOD


def test_not_a_number_is_no_proof() -> None:
    claim = Claim(quantity="residual", value=math.nan, limit=1e-9)
    assert not claim.holds
    assert not Certificate(claims=(claim,)).verified


def test_a_value_on_the_limit_holds() -> None:
    assert Claim(quantity="residual", value=1e-9, limit=1e-9).holds
    assert not Claim(quantity="residual", value=math.nextafter(1e-9, 1), limit=1e-9).holds


def test_a_right_shaper_of_five_periods_is_verified() -> None:
    # Steps must settle, so that the solution takes 4.9 periods; its slope by formula is 0. A
    # frequency step that did not shrink with the phase would miss the limit by its truncation.
    lag = FirstOrder(accel_time_constant_s=0.8, decel_time_constant_s=0.8)
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=0.05)
    made = Impulses(times_s=long_solution(mode, lag), amplitudes=np.array([1.0, -1, 1, -1, 1]))
    assert claims_by_formula(made, mode, lag)["slope"] <= 1e-11
    assert certify(made, mode, lag, zeros(CLAIMS)).verified


def long_solution(mode: Mode, actuator: FirstOrder) -> FloatArray:
    from design.formulations.unity_magnitude import ZERO_VIBRATION_DERIVATIVE
    from design.formulations.unity_magnitude_problem import unity_magnitude_problem
    from design.solvers.search import candidates

    problem = unity_magnitude_problem(
        ZERO_VIBRATION_DERIVATIVE, mode, actuator, settle=True, max_duration_periods=6.0
    )
    return next(candidates(problem)).impulses.times_s


@pytest.mark.parametrize("z", [0.0, 0.1, 0.4])
def test_higher_derivatives_of_any_command_are_those_of_the_formula(z: float) -> None:
    mode = Mode(natural_frequency_rad_s=3.5, damping_ratio=z)
    for times, amplitudes in COMMANDS.values():
        command = Impulses(times_s=times, amplitudes=amplitudes)
        promises = zeros(["second_derivative", "third_derivative"])
        for order, claim in enumerate(certify(command, mode, IDEAL, promises).claims, start=2):
            expected = ideal_derivative_by_formula(command, mode, order)
            # Rounding: 1e-11 p^3 for phases p of up to 8.
            assert claim.value == pytest.approx(expected, abs=5e-9)
            assert claim.holds == (expected <= ZERO_LIMITS[claim.quantity])


ALL_ORDERS: tuple[Quantity, ...] = ("residual", "slope", "second_derivative", "third_derivative")


def derivatives_by_cauchy(
    impulses: Impulses, mode: Mode, actuator: Actuator, radius: float
) -> list[float]:
    """Sizes of V and its derivatives by ln w, of the closed form on a circle without a pole.

    By Cauchy's integral: aliasing is the 64th power of the radius over the nearest pole's distance.
    """
    turns = np.exp(2j * np.pi * np.arange(64) / 64)
    poles = mode.pole_rad_s * np.exp(radius * turns)
    turned = np.exp((mode.pole_rad_s - poles) * impulses.duration_s)
    gains = actuator.accel_lag.denominator(poles) / actuator.accel_lag.denominator(mode.pole_rad_s)
    vectors = residual_vectors(impulses, poles, actuator) / gains * turned
    return [
        abs(math.factorial(order) * np.mean(vectors * turns**-order) / radius**order)
        for order in range(len(ALL_ORDERS))
    ]


def beside_the_pole(
    seed: int, distances: tuple[float, float]
) -> tuple[Mode, list[Actuator], float]:
    """Return a mode, drives of both models with poles near its own, and how near the nearer is."""
    random = np.random.default_rng(seed)
    while True:
        w, z = float(random.uniform(0.5, 20.0)), float(random.uniform(0.0, 0.5))
        mode = Mode(natural_frequency_rad_s=w, damping_ratio=z)
        sets, apart = [], []
        for _ in range(2):
            distance = math.exp(random.uniform(*np.log(distances)))
            pole = mode.pole_rad_s * (1 + distance * np.exp(2j * np.pi * random.uniform()))
            sets.append((abs(pole), -pole.real / abs(pole)))
            apart.append(abs(np.log(pole / mode.pole_rad_s)))
        if all(damping >= 0.1 for _, damping in sets):
            accel, decel = (
                SecondOrderSet(natural_frequency_rad_s=float(wa), damping_ratio=float(za))
                for wa, za in sets
            )
            both: list[Actuator] = [
                SecondOrder(accel=accel, decel=decel, model="superposed"),
                SecondOrder(accel=accel, decel=decel, model="switched"),
            ]
            return mode, both, min(apart)


@pytest.mark.parametrize("seed", range(40))
def test_derivatives_are_right_beside_a_pole_of_the_drive(seed: int) -> None:
    mode, actuators, nearest = beside_the_pole(seed, (1e-3, 0.3))
    for actuator in actuators:
        for times, amplitudes in COMMANDS.values():
            command = Impulses(
                times_s=times / mode.natural_frequency_rad_s * 3.5, amplitudes=amplitudes
            )
            expected = derivatives_by_cauchy(command, mode, actuator, nearest / 2)
            claims = certify(command, mode, actuator, zeros(ALL_ORDERS)).claims
            for order, (claim, value) in enumerate(zip(claims, expected, strict=True)):
                # A part in 1e8 of what the nearer pole makes of rounding in lower derivatives.
                scale = max(
                    expected[lower] / nearest ** (order - lower) for lower in range(order + 1)
                )
                assert claim.value == pytest.approx(value, abs=1e-8 * scale), claim.quantity
            alone = certify(command, mode, actuator, zeros(["slope"])).claims[0].value
            assert alone == pytest.approx(expected[1], abs=1e-7 * max(expected[:2]) / nearest)


@pytest.mark.parametrize("name", ["zv", "zvd", "zvdd", "zvddd"])
@pytest.mark.parametrize("seed", range(15))
def test_zeros_of_any_order_are_verified_beside_a_pole_of_the_drive(seed: int, name: str) -> None:
    mode, actuators, _ = beside_the_pole(seed, (2e-3, 0.3))
    for actuator in actuators:
        made = design(mode, actuator, SHAPERS[name])
        assert made.certificate.verified
        assert not made.for_ideal
        wrong = move(made.impulses, 1, 1e-4 / mode.natural_frequency_rad_s)
        promises = zeros(zeros_of(made.certificate))
        assert not certify(wrong, mode, actuator, promises).verified


def test_a_plant_between_the_poles_of_its_drive_has_all_zeros_proven() -> None:
    mode = Mode(natural_frequency_rad_s=1.0, damping_ratio=0.08)
    drive = SecondOrder(
        accel=SecondOrderSet(natural_frequency_rad_s=1.0, damping_ratio=0.1),
        decel=SecondOrderSet(natural_frequency_rad_s=1.1, damping_ratio=3.0),
    )
    for name, order in (("zvdd", 3), ("zvddd", 4)):
        made = design(mode, drive, SHAPERS[name])
        assert (made.certificate.verified, made.for_ideal) == (True, False)
        assert [claim.quantity for claim in made.certificate.claims] == list(ALL_ORDERS[:order])
