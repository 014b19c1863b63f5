"""A request of each operation, as JSON has it, and its call."""

from collections.abc import Callable
from typing import Any

from shapersmith.calls import Calls
from tests.conftest import CRANE

DRIVEN = {"plant": CRANE["plant"], "actuator": CRANE["actuator"]}
LENGTHS = {"field": "/plant/cable_length_m", "from": 0.6, "to": 1.0, "points": 3}

REQUESTS: dict[str, dict[str, Any]] = {
    "design": {
        **CRANE,
        "fit": None,
        "sensitivity": {"points": 11},
        "drive": {"to": 0.1, "points": 2},
        "trace": True,
    },
    "sensitivity": {**DRIVEN, "impulses": {"times_s": [0, 0.9], "amplitudes": [0.5, 0.5]}},
    "fit": {
        **CRANE,
        "fit": {"over": "/plant/cable_length_m", "from": 0.7, "to": 0.9, "degree": 2},
    },
    "maneuver": {**CRANE, "speed_m_s": 0.2, "distance_m": 0.6, "sample_time_s": 0.02},
    "simulation": {**CRANE, "command": {"kind": "pulse", "pulse_s": 3.0}, "points": 11},
    "run": {
        **DRIVEN,
        "speed_m_s": 0.2,
        "model": "nonlinear",
        "shaping": {"mode": "delay_line", "shaper": {"kind": "zv"}},
        "events": [
            {"at_s": 0.0, "move": {"x_m": 0.3}},
            {"at_s": 0.5, "cable_length_m": 0.6, "over_s": 1.5},
            {"at_s": 1.0, "direction": {"y": -1}, "for_s": 0.5},
        ],
        "encoder": {},
        "points": 11,
    },
    "map": {**CRANE, "x": LENGTHS, "y": {"field": "/plant/damping_ratio", "values": [0, 0.1]}},
    "recommendation": {**DRIVEN, "half_width": 0.1, "sign": "unity"},
}
"""By the name of the operation."""


def call(calls: Calls, operation: str) -> Callable[..., Any]:
    """Return the call of an operation."""
    named = {"simulation": "simulate", "map": "field_map", "recommendation": "recommend"}
    found: Callable[..., Any] = getattr(calls, named.get(operation, operation))
    return found
