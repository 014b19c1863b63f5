"""Values of a request that are hardly meant, each with its usual range and as that has it."""

from collections.abc import Iterator
from math import inf, tau
from typing import Any

from pydantic import BaseModel

from schemas.usual_ranges import PARTS, USUAL_RANGES, Range


def implausible_values(request: Any) -> list[tuple[str, Range, float, float]]:  # noqa: ANN401
    """Return pointer, usual range and quantity of what is beyond it."""
    plant = request.plant.to_design() if hasattr(request, "plant") else None
    modes = getattr(plant, "modes_of_moments", ()) or getattr(plant, "modes", ())
    period_s, beyond = max((mode.period_s for mode in modes), default=inf), []
    for part in PARTS:
        for pointer, name, value in _numbers(getattr(request, part, None), part, f"/{part}"):
            if usual := USUAL_RANGES.get((part, name)):
                quantity = tau / value if usual.of_frequency and value else value
                compared = abs(quantity) / (period_s if usual.in_periods else 1.0)
                if not usual.low <= compared < usual.high:
                    beyond.append((pointer, usual, quantity, compared))
                    period_s = inf if part == "plant" else period_s  # no drive is slow beside it
    return beyond


def _numbers(here: Any, name: str, pointer: str) -> Iterator[tuple[str, str, float]]:  # noqa: ANN401
    """Yield the numbers of a part, each with its pointer and the field that it is a value of."""
    if hasattr(here, "numbers"):
        yield from here.numbers(pointer)
    elif isinstance(here, BaseModel | list):
        for inner, value in enumerate(here) if isinstance(here, list) else here:
            yield from _numbers(value, str(inner), f"{pointer}/{inner}")
    elif isinstance(here, float | int):
        yield pointer, name, here
