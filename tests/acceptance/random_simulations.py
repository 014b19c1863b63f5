"""Random simulations through the wire, each played by another route."""

import json
import math
from collections.abc import Callable, Iterator

import numpy as np

from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.shapers.registry import SHAPERS
from service.dispatch import respond
from service.problems import Problem
from tests import expm_route
from tests.acceptance.answer_cases import (
    AGREE,
    EVERY_DRIVE,
    JSON,
    NOTHING,
    apart,
    full_speed,
    impulses_of,
    random_shaper,
    random_subject,
)

SAMPLE_TOLERANCE = 0.01
"""What a shaper that claims zero may leave on samples, where nothing else is asked [-]."""

LOST = {"stop_not_designed", "steps_not_designed", "actuator_ignored", "tolerance_not_kept"}
"""Warnings that more remains than a shaper claims."""

PLAYED_AT = 7
"""Times at which a simulated motion is looked at."""


def random_simulation(
    rng: np.random.Generator,
) -> tuple[str, JSON, Callable[[JSON], Iterator[str]]]:
    """Draw a simulation of any command, shaped or not."""
    singles = [
        name for name, kind in SHAPERS.items() if not (kind.serves_several or kind.large_swings)
    ]
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
    yield from apart("residual", answer["residual"], residual)
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
