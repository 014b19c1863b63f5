"""What is wrong with the environment of the service, by the names that stand in it."""

import re

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from service.plain_words import refusal
from service.settings import PREFIX, Settings
from service.suggestions import close_names, listed

SIZE = re.compile(r"\s*(\d+(?:[.,]\d+)?)\s*([kmgt]?)(i?)b?(?:ytes?)?\s*", re.IGNORECASE)
"""A number of bytes as people write it."""

POWERS = {"": 0, "k": 1, "m": 2, "g": 3, "t": 4}

DURATION = re.compile(
    r"\s*(\d+(?:[.,]\d+)?)\s*(ms|s|sec|seconds?|min|minutes?|h|hours?|d|days?)\s*"
)

SECONDS = {"ms": 1e-3, "s": 1.0, "m": 60.0, "h": 3600.0, "d": 86400.0}
"""Units of time by their first letter, milliseconds aside."""


def why_refused(error: ValidationError) -> str:
    """Return what is wrong with the settings, by their names as they stand.

    Parameters
    ----------
    error
        What `Settings.from_environment` raised.

    Returns
    -------
    str
        Every setting at fault, with rule, value, and what may be meant.
    """
    return "; ".join(map(_told, error.errors()))


def _told(fault: ErrorDetails) -> str:
    setting = "_".join(map(str, fault["loc"]))
    name = _variable(setting)
    if fault["type"] == "extra_forbidden":
        close = [_variable(one) for one in close_names(setting, Settings.model_fields)]
        meant = f"did you mean {listed(close, 'or')}?" if close else _all_settings()
        return f"{name}: is no setting; {meant}"
    told = refusal(fault, Settings, name)
    value = fault["input"]
    return f"{name}: {told}{_number_meant(setting, value) if isinstance(value, str) else ''}"


def _variable(setting: str) -> str:
    return f"{PREFIX}{setting.upper()}"


def _all_settings() -> str:
    return f"the settings are {', '.join(map(_variable, Settings.model_fields))}"


def _number_meant(setting: str, value: str) -> str:
    """Return the number that a text with a unit stands for."""
    if setting.endswith("_bytes") and (size := SIZE.fullmatch(value)):
        base = 1024 if size[3] else 1000
        return f"; give {_number(size[1]) * base ** POWERS[size[2].lower()]:.0f}"
    if setting.endswith(("_s", "_days")) and (time := DURATION.fullmatch(value.lower())):
        seconds = _number(time[1]) * SECONDS["ms" if time[2] == "ms" else time[2][0]]
        return f"; give {seconds / (SECONDS['d'] if setting.endswith('_days') else 1):.12g}"
    return ""


def _number(text: str) -> float:
    return float(text.replace(",", "."))
