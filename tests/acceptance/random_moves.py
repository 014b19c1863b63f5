"""Random moves through the wire, each played by another route."""

import math
from collections.abc import Callable, Iterator

import numpy as np

from design.claims import ZERO_LIMITS
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator, unit_ramps_s
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.settling import settling_time_s
from design.shapers.registry import SHAPERS
from tests import expm_route
from tests.acceptance.answer_cases import (
    AGREE,
    JSON,
    NOTHING,
    apart,
    full_speed,
    impulses_of,
    random_sample_time_s,
    random_shaper,
    random_subject,
)

MOVED = ("umzv", "umzvd", "umzvc", "numzv", "numzvd")
"""Kinds that moves take."""

BOUND_GIVES = 2e-8
"""IPOPT moves its bounds by 1e-8, over the phase of a gap and over 1 rad [-], [rad]."""

SLOPES_AGREE = 3e-7
"""The same of slopes, one of them differenced [-]."""


def random_move(rng: np.random.Generator) -> tuple[str, JSON, Callable[[JSON], Iterator[str]]]:
    """Draw a move, and return what finds the faults of its answer."""
    name = MOVED[int(rng.integers(len(MOVED)))]
    kind = SHAPERS[name]
    mode, actuator, told = random_subject(rng, kind.actuators)
    shaper = random_shaper(rng, name)
    # At the longest search and the cruise speed that are usual, so that most moves exist.
    for usual in ("max_velocity_ratio", "max_duration_periods"):
        shaper.pop(usual, None)
    speed = full_speed(rng, actuator)
    periods = float(np.exp(rng.uniform(math.log(0.3), math.log(20.0))))
    way = periods * mode.period_s
    request: JSON = {**told, "shaper": shaper, "speed_m_s": speed}
    sign = -1.0 if rng.random() < 0.5 else 1.0
    if rng.random() < 0.5:
        request["distance_m"] = sign * way * speed
    else:
        request["pulse_s"] = way
        request["speed_m_s"] = sign * speed
    request["joint"] = bool(rng.random() < 0.2)
    initial = (0.0, 0.0)
    if rng.random() < 0.15:
        deflection, rate = 0.2 * speed * rng.normal(size=2)
        deflection /= mode.natural_frequency_rad_s
        if told["plant"]["kind"] == "pendulum":
            length = told["plant"]["cable_length_m"]
            request["initial"] = {
                "angle_rad": deflection / length,
                "angle_rate_rad_s": rate / length,
            }
        else:
            request["initial"] = {"deflection_m": deflection, "deflection_rate_m_s": rate}
        initial = (float(sign * deflection / speed), float(sign * rate / speed))
    if rng.random() < 0.3:
        request["sample_time_s"] = float(mode.period_s / rng.uniform(20, 300))

    def faults(answer: JSON) -> Iterator[str]:
        yield from wrong_in_move(answer, mode, actuator, request, initial)

    return name, request, faults


def random_program(rng: np.random.Generator) -> tuple[str, JSON, Callable[[JSON], Iterator[str]]]:
    """Draw a move with its program on any samples."""
    name, request, faults = random_move(rng)
    plant = request["plant"]
    w = plant.get("natural_frequency_rad_s")
    if w is None:
        w = math.sqrt(plant["gravity_m_s2"] / plant["cable_length_m"])
    request["sample_time_s"] = random_sample_time_s(rng, 2 * math.pi / w)
    return name, request, faults


def wrong_in_move(
    answer: JSON, mode: Mode, actuator: Actuator, request: JSON, initial: tuple[float, float]
) -> Iterator[str]:
    """Yield what is wrong with a move."""
    command = impulses_of(answer["command"])
    speed = answer["speed_m_s"] if "speed_m_s" in answer else abs(request["speed_m_s"])
    levels = np.cumsum(command.amplitudes)
    if levels.min() < -1e-9 or levels.max() > 1 + 1e-9:
        yield f"levels from {levels.min():.6g} to {levels.max():.6g}"
    codes = [one["code"] for one in answer["warnings"]]
    if ("lower_speed" in codes) != (levels.max() < 1 - 1e-9):
        yield f"levels up to {levels.max():.6g} have warnings {codes}"
    if request["shaper"].get("settle"):
        yield from _unsettled(command, mode, actuator)
    played = expm_route.outcome(command, mode, actuator, initial)
    yield from apart("residual", answer["residual"], played.residual)
    way = answer["direction"] * speed * played.travel
    if abs(way - answer["distance_m"]) > 1e-9 * abs(way):
        yield f"goes {way!r} m, told {answer['distance_m']!r}"
    if "distance_m" in request and abs(way - request["distance_m"]) > 1e-9 * abs(way):
        yield f"goes {way!r} m, asked {request['distance_m']!r}"
    slope = _slope(command, mode, actuator, initial, request)
    found = {"residual": played.residual, "slope": slope}
    yield from _wrong_claims(answer, found, command, mode, initial, request)
    program = answer["program"]
    if program is not None:
        held = np.diff(np.array(program["velocity_m_s"]) / answer["direction"] / speed, prepend=0.0)
        used = np.abs(held) > 1e-13
        steps = Impulses(times_s=np.array(program["times_s"])[used], amplitudes=held[used])
        left = expm_route.outcome(steps, mode, actuator, initial).residual
        yield from apart("residual of the program", program["residual"], left)
        if ("program_residual" in codes) != (program["residual"] > NOTHING):
            yield f"a program that leaves {program['residual']:.3g} has warnings {codes}"
        yield from _without_its_figure(answer, "program_residual", program["residual"])
        yield from _wrong_program(answer, request, steps, mode, actuator, initial)


def _wrong_program(
    answer: JSON,
    request: JSON,
    steps: Impulses,
    mode: Mode,
    actuator: Actuator,
    initial: tuple[float, float],
) -> Iterator[str]:
    """Yield what is wrong with a program beside its residual."""
    program, speed = answer["program"], answer.get("speed_m_s", abs(request["speed_m_s"]))
    sample_time_s = request["sample_time_s"]
    times, velocity, position = (
        np.array(program[name]) for name in ("times_s", "velocity_m_s", "position_m")
    )
    if np.abs(times / sample_time_s - np.arange(times.size)).max() > 1e-6:
        yield "is not on its samples"
    # Positions linear between samples and held velocities are one command.
    off = np.abs(np.diff(position) - velocity[:-1] * sample_time_s)
    if off.max(initial=0.0) > 1e-12 * speed * max(float(times[-1]), sample_time_s):
        yield f"positions are {off.max():.3g} m off the velocities held"
    if position[0] != 0 or velocity[-1] != 0:
        yield f"begins at {position[0]!r} m, ends at {velocity[-1]!r} m/s"
    levels = velocity / answer["direction"] / speed
    top = max(1.0, float(np.cumsum(answer["command"]["amplitudes"]).max()))
    if levels.min() < 0 or levels.max() > top + 1e-9:
        yield f"program has levels {levels.min():.9g} to {levels.max():.9g}"
    way = answer["direction"] * speed * expm_route.outcome(steps, mode, actuator, initial).travel
    codes = [one["code"] for one in answer["warnings"]]
    for told, name in ((program["distance_m"], "program"), (answer["distance_m"], "move")):
        missed = abs(way - told) > 1e-9 * abs(told)
        if missed and (name == "program" or "program_distance" not in codes):
            yield f"the program goes {way!r} m, told of the {name} {told!r}"
    if any(claim["quantity"] == "slope" for claim in answer["certificate"]["claims"]):
        slope = _slope(steps, mode, actuator, initial, request)
        warned = {"program_residual", "program_slope"} & set(codes)
        if slope > SLOPES_AGREE * 2 and not warned:
            yield f"program has a slope of {slope:.3g} and warnings {codes}"
        if slope < ZERO_LIMITS["slope"] / 2 and "program_slope" in codes:
            yield f"program has a slope of {slope:.3g} and a warning"


def _unsettled(command: Impulses, mode: Mode, actuator: Actuator) -> Iterator[str]:
    """Yield steps before which the last has not settled, its ramp included."""
    lags = (actuator.decel_lag, actuator.accel_lag)
    ramps = unit_ramps_s(actuator)[::-1]
    gaps = np.diff(command.times_s)
    for gap_s, height in zip(gaps, command.amplitudes[:-1], strict=True):
        which = int(height > 0)
        least_s = abs(height) * ramps[which] + settling_time_s(lags[which])
        if gap_s < least_s * (1 - BOUND_GIVES) - BOUND_GIVES / mode.natural_frequency_rad_s:
            yield f"{gap_s:.9g} s after a step that settles in {least_s:.9g} s comes the next"


def _slope(
    command: Impulses,
    mode: Mode,
    actuator: Actuator,
    initial: tuple[float, float],
    request: JSON,
) -> float:
    power = -2 if request["plant"]["kind"] == "pendulum" else 0
    return expm_route.slope(command, mode, actuator, initial, initial_power=power)


def _wrong_claims(
    answer: JSON,
    found: dict[str, float],
    command: Impulses,
    mode: Mode,
    initial: tuple[float, float],
    request: JSON,
) -> Iterator[str]:
    certificate = answer["certificate"]
    ideal = certificate["actuator"] == "ideal"
    if not certificate["verified"]:
        yield "not verified"
    codes = [one["code"] for one in answer["warnings"]]
    if ideal != ("actuator_ignored" in codes):
        yield f"a certificate for {certificate['actuator']} has warnings {codes}"
    of_whom = found
    if ideal:
        of_whom = {
            "residual": expm_route.outcome(command, mode, Ideal(), initial).residual,
            "slope": _slope(command, mode, Ideal(), initial, request),
        }
    below = True
    for claim in certificate["claims"]:
        name, value = claim["quantity"], claim["value"]
        margin = AGREE if name == "residual" else SLOPES_AGREE
        if abs(of_whom[name] - value) > margin * (1 + value):
            yield f"claims {name} {value:.3g}, another route {of_whom[name]:.3g}"
        if value > claim["limit"] * (1 + 1e-9):
            yield f"claims {name} {value:.3g} above {claim['limit']:.3g}"
        below &= found[name] < ZERO_LIMITS[name] / 2
    if ideal and below:
        yield f"warns of {found}, which is below every limit"
    if ideal and found["residual"] > NOTHING:
        yield from _without_its_figure(answer, "actuator_ignored", answer["residual"])


def _without_its_figure(answer: JSON, code: str, share: float) -> Iterator[str]:
    for one in answer["warnings"]:
        if one["code"] == code and f"{100 * share:.4g} %" not in one["detail"]:
            yield f"{code} without its figure {share:.4g}: {one['detail']}"
