"""Requests that cost much, all legal."""

import json
from typing import Any

CRANE: dict[str, Any] = {
    "kind": "second_order",
    "accel": {"natural_frequency_rad_s": 20, "damping_ratio": 0.8},
    "decel": {"natural_frequency_rad_s": 50, "damping_ratio": 1.5},
}
"""An actuator."""

WITH_LIMITS = {
    "kind": "rate_limited",
    "accel_limit_m_s2": 30,
    "decel_limit_m_s2": 40,
    "speed_m_s": 0.2,
    "then": CRANE,
}


def endless_fit(number: int) -> dict[str, Any]:
    """Return a fit that tries every degree, and none is good enough."""
    end = 0.3 - 1e-6 * number
    return {"over": "/plant/damping_ratio", "from": 0, "to": end, "max_residual": 1e-15}


def slow_body(number: int) -> bytes:
    """Return a design of a second; it is refused in the end."""
    return json.dumps({
        "plant": {"kind": "mode", "natural_frequency_rad_s": 3.5},
        "actuator": WITH_LIMITS,
        "shaper": {"kind": "numzvd"},
        "fit": endless_fit(number),
    }).encode()


def heavy_body(number: int) -> bytes:
    """Return a design of 4,096 impulses, and where they leave how much.

    It takes 13 s of a processor: 20 s where three workers share two.
    """
    frequencies = (1.0, 1.7, 2.9, 4.1, 6.3, 8.8 + 1e-6 * number)
    modes = [{"natural_frequency_rad_s": one, "damping_ratio": 0.01} for one in frequencies]
    return json.dumps({
        "plant": {"kind": "modes", "modes": modes},
        "actuator": {"kind": "ideal"},
        "shaper": {"kind": "convolved", "base": "zvdd"},
        "sensitivity": {"from_ratio": 0.3, "to_ratio": 1.8},
    }).encode()


def table_body(
    *points: int, kind: str = "numzvd", chunk_rows: int = 100_000, fit: dict[str, Any] | None = None
) -> bytes:
    """Return a table over frequency and, where two numbers of points are given, damping."""
    axes = [
        {"field": "/plant/natural_frequency_rad_s", "from": 2, "to": 5},
        {"field": "/plant/damping_ratio", "from": 0, "to": 0.1},
    ]
    return json.dumps({
        "design": {
            "plant": {"kind": "mode", "natural_frequency_rad_s": 3.5},
            "actuator": CRANE,
            "shaper": {"kind": kind},
        },
        "axes": [{**axis, "points": size} for axis, size in zip(axes, points, strict=False)],
        "columns": ["times_s", "residual"],
        "chunk_rows": chunk_rows,
        "fit": fit,
    }).encode()
