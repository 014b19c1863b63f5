"""Bodies that a reader of the documentation can send: each is answered, by a test."""

import json
from dataclasses import dataclass
from typing import Any

from schemas.actuators import FirstOrderIn, RateLimitedIn
from service.catalogue import THESIS_CRANE, TWO_MODES


@dataclass(frozen=True, slots=True, kw_only=True)
class Example:
    """A body, and what it is an example of.

    Attributes
    ----------
    summary
        What it shows.
    value
        The body as JSON has it; a string of lines for JSON Lines.
    """

    summary: str
    value: Any


CRANE = {**THESIS_CRANE, "shaper": {"kind": "numzvd"}}

MODE = {"kind": "mode", "natural_frequency_rad_s": 6.0, "damping_ratio": 0.02}

IDEAL = {"kind": "ideal"}

HOISTING = {
    "kind": "hoisting",
    "cable_length_m": {"times_s": [0.0, 5.0], "values": [0.8, 0.5]},
    "gravity_m_s2": 9.81,
}

CRANE_OF_9_M = {
    "plant": {"kind": "pendulum", "cable_length_m": 9.0},
    "actuator": {
        **RateLimitedIn.EXAMPLE,
        "accel_limit_m_s2": 0.3,
        "decel_limit_m_s2": 0.4,
        "speed_m_s": 1.0,
        "then": IDEAL,
    },
}

EXAMPLES: dict[str, dict[str, Example]] = {
    "design": {
        "crane": Example(
            summary="Unity magnitude behind a drive that accelerates and brakes differently",
            value=CRANE,
        ),
        "positive": Example(
            summary="Positive impulses for a lightly damped mode, an ideal drive",
            value={"plant": MODE, "actuator": IDEAL, "shaper": {"kind": "zvd"}},
        ),
        "two_modes": Example(
            summary="Two modes at once, behind a first-order drive",
            value={
                "plant": TWO_MODES,
                "actuator": FirstOrderIn.EXAMPLE,
                "shaper": {"kind": "multi_zv"},
            },
        ),
        "limits": Example(
            summary="Fastest behind limits to the acceleration, without a sensitivity curve",
            value={**CRANE_OF_9_M, "shaper": {"kind": "numzv"}, "sensitivity": None},
        ),
        "samples": Example(
            summary="Impulses on the samples of a controller",
            value={
                "plant": MODE,
                "actuator": IDEAL,
                "shaper": {"kind": "zvd", "sample_time_s": 0.01},
            },
        ),
    },
    "design_batch": {
        "two": Example(
            summary="Two designs, a line each",
            value="".join(
                json.dumps({"plant": MODE, "actuator": IDEAL, "shaper": {"kind": kind}}) + "\n"
                for kind in ("zv", "zvd")
            ),
        )
    },
    "sensitivity": {
        "zv": Example(
            summary="Two impulses of half the height, half a period apart",
            value={
                "plant": {**MODE, "damping_ratio": 0.0},
                "actuator": IDEAL,
                "impulses": {"times_s": [0.0, 0.5236], "amplitudes": [0.5, 0.5]},
            },
        ),
    },
    "fit": {
        "cable_length": Example(
            summary="Times of a shaper over the length of the cable",
            value={
                **CRANE,
                "fit": {"over": "/plant/cable_length_m", "from": 0.5, "to": 1.0, "degree": 3},
            },
        ),
    },
    "maneuver": {
        "distance": Example(
            summary="One metre at 0.2 m/s",
            value={**CRANE, "speed_m_s": 0.2, "distance_m": 1.0},
        ),
        "program": Example(
            summary="The same as a program on samples of 10 ms",
            value={**CRANE, "speed_m_s": 0.2, "distance_m": 1.0, "sample_time_s": 0.01},
        ),
        "hoisting": Example(
            summary="The same while the cable is hoisted",
            value={**CRANE, "plant": HOISTING, "speed_m_s": 0.2, "distance_m": 1.0},
        ),
        "free_body": Example(
            summary="Two masses and a spring, moved by an on-off force in minimum time",
            value={
                "plant": {
                    "kind": "free_body",
                    "mass_kg": 2.0,
                    "modes": [{"natural_frequency_rad_s": 1.4142135623730951}],
                },
                "actuator": IDEAL,
                "shaper": {"kind": "umzv"},
                "force_n": 1.0,
                "distance_m": 1.0,
            },
        ),
    },
    "simulate": {
        "shaped_pulse": Example(
            summary="A pulse of two seconds, shaped",
            value={
                **CRANE,
                "command": {"kind": "pulse", "pulse_s": 2.0},
                "speed_m_s": 0.2,
                "points": 201,
            },
        ),
        "step": Example(
            summary="A step that nothing shapes",
            value={**THESIS_CRANE, "command": {"kind": "step"}, "points": 201},
        ),
    },
    "run": {
        "live": Example(
            summary="Presses that are shaped live: solved anew at each event",
            value={
                "plant": THESIS_CRANE["plant"],
                "actuator": {**THESIS_CRANE["actuator"], "model": "switched"},
                "speed_m_s": 0.2,
                "shaping": {"mode": "live", "shaper": {"kind": "numzv"}},
                "events": [
                    {"at_s": 0.0, "direction": {"x": 1}},
                    {"at_s": 0.83, "direction": {"x": 0}},
                ],
                "points": 201,
            },
        ),
        "emergency": Example(
            summary="A start with limited deflection, and an emergency stop",
            value={
                "plant": THESIS_CRANE["plant"],
                "actuator": {**THESIS_CRANE["actuator"], "model": "switched"},
                "speed_m_s": 0.2,
                "shaping": {"mode": "live", "shaper": {"kind": "numzv"}},
                "deflection_limit": 0.5,
                "events": [
                    {"at_s": 0.0, "direction": {"x": 1}},
                    {"at_s": 2.0, "stop": "emergency", "swing_left": 0.05, "within_periods": 1},
                ],
                "points": 201,
            },
        ),
        "square": Example(
            summary="A square of 42 cm through a delay line, swings as large as they are",
            value={
                "plant": CRANE["plant"],
                "actuator": CRANE["actuator"],
                "speed_m_s": 0.2,
                "shaping": {"mode": "delay_line", "shaper": {"kind": "zv"}},
                "model": "nonlinear",
                "events": [
                    {"at_s": 0.0, "move": {"x_m": 0.42}},
                    {"at_s": 4.0, "move": {"y_m": 0.42}},
                    {"at_s": 8.0, "move": {"x_m": -0.42}},
                    {"at_s": 12.0, "move": {"y_m": -0.42}},
                ],
                "points": 201,
            },
        ),
        "moves": Example(
            summary="There and back by whole moves, while the cable is hoisted",
            value={
                "plant": {
                    "kind": "hoisting",
                    "cable_length_m": {"times_s": [0.0, 5.0], "values": [0.8, 0.5]},
                },
                "actuator": CRANE["actuator"],
                "speed_m_s": 0.2,
                "events": [
                    {"at_s": 0.0, "move": {"x_m": 0.8}, "shaper": {"kind": "numzv"}},
                    {"at_s": 6.0, "move": {"x_m": -0.8}, "shaper": {"kind": "numzv"}},
                ],
                "points": 201,
            },
        ),
        "hoist": Example(
            summary="A press while the hook is hoisted",
            value={
                "plant": CRANE["plant"],
                "actuator": CRANE["actuator"],
                "speed_m_s": 0.2,
                "model": "nonlinear",
                "events": [
                    {"at_s": 0.0, "direction": {"x": 1}, "for_s": 3.0},
                    {"at_s": 0.5, "cable_length_m": 0.5, "over_s": 2.0},
                ],
                "points": 201,
            },
        ),
    },
    "map": {
        "residual": Example(
            summary="Residual of one shaper over length and damping",
            value={
                **CRANE,
                "x": {"field": "/plant/cable_length_m", "from": 0.6, "to": 1.0, "points": 21},
                "y": {"field": "/plant/damping_ratio", "values": [0.0, 0.05]},
            },
        ),
        "drive": Example(
            summary="Residual of one shaper where the drive is not as given",
            value={
                **CRANE,
                "x": {
                    "field": "/actuator/accel/natural_frequency_rad_s",
                    "from": 15,
                    "to": 25,
                    "points": 11,
                },
                "y": {
                    "field": "/actuator/decel/natural_frequency_rad_s",
                    "from": 40,
                    "to": 60,
                    "points": 11,
                },
            },
        ),
        "duration": Example(
            summary="Duration of the shaper that is designed for each length",
            value={
                **CRANE,
                "quantity": "duration_s",
                "design": "each",
                "x": {"field": "/plant/cable_length_m", "from": 0.6, "to": 1.0, "points": 5},
            },
        ),
    },
    "recommend": {
        "band": Example(
            summary="At most 5 % within 15 % of the frequency, a command between 0 and 1",
            value={"plant": MODE, "actuator": IDEAL, "half_width": 0.15, "tolerance": 0.05},
        ),
        "drive_off": Example(
            summary="At most 5 % with every parameter of the drive off by 10 % as well",
            value={**THESIS_CRANE, "half_width": 0.05, "drive_off_by": 0.1},
        ),
    },
    "create_table": {
        "grid": Example(
            summary="Times over length and damping",
            value={
                "title": "crane",
                "design": CRANE,
                "axes": [
                    {"field": "/plant/cable_length_m", "from": 0.3, "to": 1.4, "points": 100},
                    {"field": "/plant/damping_ratio", "values": [0, 0.01, 0.05]},
                ],
                "columns": ["times_s", "residual"],
            },
        ),
        "list": Example(
            summary="Listed machines",
            value={
                "design": CRANE,
                "designs": [
                    {"plant": {"cable_length_m": 0.8}},
                    {"plant": {"cable_length_m": 1.2, "damping_ratio": 0.01}},
                ],
            },
        ),
    },
}
"""Examples of each route that takes a body, by its operation id."""
