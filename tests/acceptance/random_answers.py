"""Random moves, simulations and recommendations through the wire, each played by another route.

    python -m tests.acceptance.random_answers moves 5000
    python -m tests.acceptance.random_answers simulations 2000
    python -m tests.acceptance.random_answers recommendations 500

Requests go in and answers come out as JSON, as over HTTP. What an answer says of the drive given,
its residual, distance, claims and warnings, is held against `tests.expm_route`. The report counts
answers, refusals by reason and the slowest; the exit status is 1 if anything is wrong. The suite
runs the first of them.
"""

import argparse
import dataclasses
import json
import math
import sys
import time
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from design.claims import ZERO_LIMITS
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.pendulum import Pendulum
from design.model.plants.registry import Plant
from design.shapers.registry import SHAPERS
from service.dispatch import respond
from service.problems import INFEASIBLE, INVALID, Problem
from tests import expm_route
from tests.acceptance.random_kinds import Verdict, report
from tests.random_cases import random_actuator, random_options, random_plant

MOVED = ("umzv", "umzvd", "umzvc", "numzv", "numzvd")
"""Kinds that moves take."""

EVERY_DRIVE = ("ideal", "first_order", "second_order", "rate_limited")

NOTHING = 1e-9
"""Limit of a residual that is claimed to be zero [-]."""

AGREE = 2e-9
"""What two routes to one residual may differ by, over one and over itself [-]."""

SLOPES_AGREE = 3e-7
"""The same of slopes, one of them differenced [-]."""

SAMPLE_TOLERANCE = 0.01
"""What a shaper that claims zero may leave on samples, where nothing else is asked [-]."""

LOST = {"stop_not_designed", "steps_not_designed", "actuator_ignored", "tolerance_not_kept"}
"""Warnings that more remains than a shaper claims."""

PLAYED_AT = 7
"""Times at which a simulated motion is looked at."""

LOOKED_AT = 25
"""Frequencies of a band at which a recommended shaper is looked at."""

JSON = dict[str, Any]


def plant_as_json(plant: Mode | Pendulum) -> JSON:
    """Return the request's form of a plant of one mode."""
    if isinstance(plant, Pendulum):
        return {
            "kind": "pendulum",
            "cable_length_m": plant.cable_length_m,
            "damping_ratio": plant.damping_ratio,
            "gravity_m_s2": plant.gravity_m_s2,
        }
    return {
        "kind": "mode",
        "natural_frequency_rad_s": plant.natural_frequency_rad_s,
        "damping_ratio": plant.damping_ratio,
    }


def actuator_as_json(actuator: Actuator) -> JSON:
    """Return the request's form of an actuator."""
    told: JSON = {"kind": actuator.kind}
    if isinstance(actuator, RateLimited):
        names = ("accel_limit_m_s2", "decel_limit_m_s2", "speed_m_s")
        return {
            **told,
            **{name: getattr(actuator, name) for name in names},
            "then": actuator_as_json(actuator.then),
        }
    if isinstance(actuator, Ideal):
        return told
    told["model"] = actuator.model
    if actuator.kind == "first_order":
        for name in ("accel_time_constant_s", "decel_time_constant_s"):
            told[name] = getattr(actuator, name)
        return told
    for name in ("accel", "decel"):
        part = getattr(actuator, name)
        told[name] = {
            "natural_frequency_rad_s": part.natural_frequency_rad_s,
            "damping_ratio": part.damping_ratio,
        }
    return told


def random_subject(
    rng: np.random.Generator, served: tuple[str, ...]
) -> tuple[Mode, Actuator, JSON]:
    """Draw a plant of one mode and a drive; return both as records and in the request's form."""
    plant: Plant = random_plant(rng)
    one = plant if isinstance(plant, Pendulum) else plant.modes[0]
    actuator = random_actuator(rng, one.mode.natural_frequency_rad_s, served)
    told = {"plant": plant_as_json(one), "actuator": actuator_as_json(actuator)}
    return one.mode, actuator, told


def random_shaper(rng: np.random.Generator, name: str) -> JSON:
    """Draw a kind's parameters."""
    options, _ = random_options(rng, SHAPERS[name].options)
    fields = () if options is None else dataclasses.fields(options)
    return {"kind": name, **{field.name: getattr(options, field.name) for field in fields}}


def full_speed(rng: np.random.Generator, actuator: Actuator) -> float:
    """Return the speed of a request: that of the limits where there are any."""
    if isinstance(actuator, RateLimited):
        return actuator.speed_m_s
    return float(np.exp(rng.uniform(math.log(0.05), math.log(2.0))))


def impulses_of(told: JSON) -> Impulses:
    """Return the record of impulses in an answer."""
    return Impulses(times_s=np.array(told["times_s"]), amplitudes=np.array(told["amplitudes"]))


# --------------------------------------------------------------------------------
# Moves


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


def wrong_in_move(
    answer: JSON, mode: Mode, actuator: Actuator, request: JSON, initial: tuple[float, float]
) -> Iterator[str]:
    """Yield what is wrong with a move."""
    command = impulses_of(answer["command"])
    speed = answer["speed_m_s"] if "speed_m_s" in answer else abs(request["speed_m_s"])
    levels = np.cumsum(command.amplitudes)
    if levels.min() < -1e-9 or levels.max() > 1 + 1e-9:
        yield f"levels from {levels.min():.6g} to {levels.max():.6g}"
    played = expm_route.outcome(command, mode, actuator, initial)
    yield from _apart("residual", answer["residual"], played.residual)
    way = answer["direction"] * speed * played.travel
    if abs(way - answer["distance_m"]) > 1e-9 * abs(way):
        yield f"goes {way!r} m, told {answer['distance_m']!r}"
    if "distance_m" in request and abs(way - request["distance_m"]) > 1e-9 * abs(way):
        yield f"goes {way!r} m, asked {request['distance_m']!r}"
    slope = _slope(command, mode, actuator, initial, request)
    found = {"residual": played.residual, "slope": slope}
    yield from _wrong_claims(answer, found, command, mode, initial, request)
    codes = [one["code"] for one in answer["warnings"]]
    program = answer["program"]
    if program is not None:
        held = np.diff(np.array(program["velocity_m_s"]) / answer["direction"] / speed, prepend=0.0)
        used = np.abs(held) > 1e-13
        steps = Impulses(times_s=np.array(program["times_s"])[used], amplitudes=held[used])
        left = expm_route.outcome(steps, mode, actuator, initial).residual
        yield from _apart("residual of the program", program["residual"], left)
        if ("program_residual" in codes) != (program["residual"] > NOTHING):
            yield f"a program that leaves {program['residual']:.3g} has warnings {codes}"
        yield from _without_its_figure(answer, "program_residual", program["residual"])


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


def _apart(what: str, told: float, other: float) -> Iterator[str]:
    if not abs(told - other) <= AGREE * (1 + other):
        yield f"{what} {told:.9g}, another route {other:.9g}"


# --------------------------------------------------------------------------------
# Simulations


def random_simulation(
    rng: np.random.Generator,
) -> tuple[str, JSON, Callable[[JSON], Iterator[str]]]:
    """Draw a simulation of any command, shaped or not."""
    singles = [name for name, kind in SHAPERS.items() if not kind.serves_several]
    name = singles[int(rng.integers(len(singles)))]
    shaped = bool(rng.random() < 0.75)
    served = SHAPERS[name].actuators if shaped else EVERY_DRIVE
    mode, actuator, told = random_subject(rng, served)
    speed = full_speed(rng, actuator)
    command = random_command(rng, mode, speed)
    request: JSON = {**told, "command": command, "speed_m_s": speed, "points": 101}
    if shaped:
        request["shaper"] = random_shaper(rng, name)
        if rng.random() < 0.15:
            request["shaper"]["sample_time_s"] = float(mode.period_s / rng.uniform(40, 200))

    def faults(answer: JSON) -> Iterator[str]:
        yield from wrong_in_simulation(answer, mode, actuator, request)

    return name if shaped else "(unshaped)", request, faults


def random_command(rng: np.random.Generator, mode: Mode, speed: float) -> JSON:
    """Draw a step, a pulse, impulses, a list or samples, over some periods."""
    kinds = ("step", "pulse", "impulses", "list", "sampled")
    kind = kinds[int(rng.integers(len(kinds)))]
    if kind == "step":
        return {"kind": "step"}
    if kind == "pulse":
        return {"kind": "pulse", "pulse_s": float(mode.period_s * rng.uniform(0.1, 6))}
    count = int(rng.integers(2, 6))
    times = np.concatenate(([0.0], np.cumsum(mode.period_s * rng.uniform(0.05, 1.5, count - 1))))
    levels = rng.uniform(0, 1, count)
    if rng.random() < 0.3:
        levels[-1] = 0.0
    if rng.random() < 0.2:
        levels[int(rng.integers(count))] *= -1
    if kind == "impulses":
        steps = np.diff(levels, prepend=0.0)
        return {
            "kind": kind,
            "impulses": {"times_s": times.tolist(), "amplitudes": steps.tolist()},
        }
    velocities = (speed * levels).tolist()
    if kind == "list":
        return {"kind": kind, "times_s": times.tolist(), "velocity_m_s": velocities}
    return {"kind": kind, "sample_time_s": float(mode.period_s / 7), "velocity_m_s": velocities}


def wrong_in_simulation(
    answer: JSON, mode: Mode, actuator: Actuator, request: JSON
) -> Iterator[str]:
    """Yield what is wrong with a simulation."""
    command, speed = impulses_of(answer["impulses"]), request["speed_m_s"]
    residual = expm_route.outcome(command, mode, actuator).residual
    yield from _apart("residual", answer["residual"], residual)
    z = mode.damping_ratio
    unit = abs(
        expm_route.outcome(
            Impulses(times_s=np.zeros(1), amplitudes=np.ones(1)), mode, actuator
        ).unit
    )
    damped = mode.natural_frequency_rad_s * math.sqrt(1 - z * z)
    swing = speed * residual * unit / damped
    if abs(answer["remaining"]["deflection_m"] - swing) > 1e-8 * (swing + speed * unit / damped):
        yield f"remaining {answer['remaining']['deflection_m']:.9g} m, another route {swing:.9g}"
    looked = np.linspace(0, len(answer["times_s"]) - 1, PLAYED_AT).astype(int)
    times = np.array(answer["times_s"])[looked]
    # At a step itself either side is right.
    times = times[[np.abs(command.times_s - one).min() > 1e-9 * mode.period_s for one in times]]
    picked = [answer["times_s"].index(one) for one in times.tolist()]
    if picked:
        deflection, velocity = expm_route.history(command, mode, actuator, times)
        scale = speed * float(np.abs(command.amplitudes).sum())
        for name, other, unit_of in (
            ("deflection_m", deflection, 1 / mode.natural_frequency_rad_s),
            ("velocity_m_s", velocity, 1.0),
        ):
            off = np.abs(np.array(answer[name])[picked] - speed * other).max()
            if off > 1e-8 * scale * unit_of:
                yield f"{name} is off by {off:.3g}"
    yield from _wrong_warning(answer, residual, request)


def _wrong_warning(answer: JSON, residual: float, request: JSON) -> Iterator[str]:
    """Yield a warning that is missing, or has no reason: by what the shaper alone claims."""
    lost = [one for one in answer["warnings"] if one["code"] in LOST]
    if "shaper" not in request:
        if lost:
            yield f"warnings without a shaper: {lost}"
        return
    made = respond(
        "design",
        json.dumps({
            "plant": request["plant"],
            "actuator": request["actuator"],
            "shaper": {**request["shaper"], "sample_time_s": None},
            "sensitivity": None,
        }).encode(),
    )
    if isinstance(made, Problem):
        yield f"simulated, not designed: {made.detail}"
        return
    shaper = made.model_dump()
    on_samples = request["shaper"].get("sample_time_s") is not None
    limits = [
        SAMPLE_TOLERANCE if on_samples and claim["limit"] <= NOTHING else claim["limit"]
        for claim in shaper["certificate"]["claims"]
        if claim["quantity"] in {"residual", "band"}
    ]
    heights = _heights(request)
    allowed = min(limits) * heights
    if residual > allowed * (1 + 1e-6) + AGREE and not lost:
        yield f"leaves {residual:.4g}, claimed {allowed:.4g}, and has no warning"
    if residual < allowed * (1 - 1e-6) - AGREE and lost:
        yield f"leaves {residual:.4g}, claimed {allowed:.4g}, and warns: {lost}"
    for one in lost:
        if f"{100 * answer['residual']:.4g} %" not in one["detail"]:
            yield f"a warning without its figure {answer['residual']:.4g}: {one['detail']}"


def _heights(request: JSON) -> float:
    command = request["command"]
    if command["kind"] == "step":
        return 1.0
    if command["kind"] == "pulse":
        return 2.0
    if command["kind"] == "impulses":
        return float(np.abs(command["impulses"]["amplitudes"]).sum())
    levels = np.array(command["velocity_m_s"]) / request["speed_m_s"]
    return float(np.abs(np.diff(levels, prepend=0.0)).sum())


# --------------------------------------------------------------------------------
# Recommendations


def random_recommendation(
    rng: np.random.Generator,
) -> tuple[str, JSON, Callable[[JSON], Iterator[str]]]:
    """Draw what is known and what is asked."""
    mode, actuator, request = random_subject(rng, EVERY_DRIVE)
    request["half_width"] = float(rng.choice([0.0, rng.uniform(0, 0.1), rng.uniform(0, 0.3)]))
    request["tolerance"] = float(np.exp(rng.uniform(math.log(0.01), math.log(0.2))))
    if rng.random() < 0.3:
        z = mode.damping_ratio
        request["damping"] = {"from": z * 0.5, "to": z + float(rng.uniform(0.01, 0.05))}
    if rng.random() < 0.3:
        request["sign"] = str(rng.choice(["positive", "unity"]))
    if rng.random() < 0.3:
        request["max_duration_s"] = float(mode.period_s * rng.uniform(0.5, 2.5))
    if rng.random() < 0.2:
        request["max_high_mode_gain"] = float(rng.uniform(1.0, 6.0))
    if rng.random() < 0.15:
        request["sample_time_s"] = float(mode.period_s / rng.uniform(20, 200))

    def faults(answer: JSON) -> Iterator[str]:
        yield from wrong_in_recommendation(answer, actuator, request)

    return "recommend", request, faults


def wrong_in_recommendation(answer: JSON, actuator: Actuator, request: JSON) -> Iterator[str]:
    """Yield what is wrong with a recommendation: what any of its shapers leaves over the ranges."""
    z = answer["designed_for"][0]["damping_ratio"]
    nominal = request["plant"].get("natural_frequency_rad_s") or math.sqrt(
        request["plant"]["gravity_m_s2"] / request["plant"]["cable_length_m"]
    )
    band = answer["band"]
    frequencies = nominal * np.linspace(band["lower_ratio"], band["upper_ratio"], LOOKED_AT)
    if band["lower_ratio"] == band["upper_ratio"]:
        frequencies = frequencies[:1]
    damping = request.get("damping")
    ratios = [z] if damping is None else [damping["from"], z, damping["to"]]
    best = [answer["recommended"], *answer["runners_up"]]
    for one in [*best, *answer["others"][:2]]:
        shaper = impulses_of(one["impulses"])
        worst = max(
            expm_route.outcome(
                shaper, Mode(natural_frequency_rad_s=float(at), damping_ratio=ratio), actuator
            ).residual
            for at in frequencies
            for ratio in ratios
        )
        told = one["worst_residual"]
        if told is not None and worst > told * (1 + 1e-6) + AGREE:
            yield f"{one['name']} leaves {worst:.6g} somewhere, told at most {told:.6g}"
        if told is not None and told > 1.5 * worst + 0.05:
            yield f"{one['name']} leaves {worst:.6g} at most, told {told:.6g}"
        kept = worst <= request["tolerance"] * (1 + 1e-6) + AGREE
        missed = {verdict["requirement"] for verdict in one["requirements"] if not verdict["met"]}
        if one in best and (missed or not kept):
            yield f"{one['name']} is among the best, leaves {worst:.6g} and misses {missed}"
        if not kept and "tolerance" not in missed:
            yield f"{one['name']} leaves {worst:.6g} and is said to keep the tolerance"
    durations = [one["duration_s"] for one in best]
    if any(later < earlier * (1 - 1e-5) for earlier, later in pairwise(durations)):
        yield f"durations {durations}"


# --------------------------------------------------------------------------------
# All of them

OPERATIONS = {
    "moves": ("maneuver", random_move),
    "simulations": ("simulation", random_simulation),
    "recommendations": ("recommendation", random_recommendation),
}


def generator(what: str, number: int) -> np.random.Generator:
    """Return what draws a case, the same in every run."""
    return np.random.default_rng([sorted(OPERATIONS).index(what), number])


def verdict(what: str, number: int) -> Verdict:
    """Ask for one answer and judge it."""
    operation, drawn = OPERATIONS[what]
    name, request, faults = drawn(generator(what, number))
    refusal = ""
    wrong: list[str] = []
    started = time.process_time()
    try:
        answer = respond(operation, json.dumps(request).encode())
        seconds = time.process_time() - started
        if not isinstance(answer, Problem):
            wrong += faults(json.loads(answer.model_dump_json(by_alias=True)))
        elif answer.kind in {INVALID, INFEASIBLE}:
            refusal = answer.detail
        else:
            wrong.append(f"{answer.kind.name}: {answer.detail}")
    except Exception as error:  # noqa: BLE001 - whatever it is, it is reported
        seconds = time.process_time() - started
        wrong.append(f"{type(error).__name__}: {error}")
    label = f"{name} {request['actuator']['kind']}"
    return Verdict(number=number, kind=label, refusal=refusal, wrong=tuple(wrong), seconds=seconds)


def main() -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=list(OPERATIONS))
    parser.add_argument("count", type=int)
    parser.add_argument("--first", type=int, default=0)
    given = parser.parse_args()
    found = []
    for number in range(given.first, given.first + given.count):
        found.append(verdict(given.what, number))
        for text in found[-1].wrong:
            print(f"case {number}, {found[-1].kind}: {text}", file=sys.stderr, flush=True)
    print("\n".join(report(found)))
    refused = sum(bool(one.refusal) for one in found)
    print(f"{len(found)} {given.what}, {refused} refused")
    return int(any(one.wrong for one in found))


if __name__ == "__main__":
    sys.exit(main())
