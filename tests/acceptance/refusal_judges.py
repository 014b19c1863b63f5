"""What is not true of a refusal: its words by the numbers that they carry."""

import re
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from design.errors import DesignError, InfeasibleDesignError
from design.model.plants.scheduled import Scheduled
from design.pipeline import design
from design.solvers.budget import MAX_WORK_PER_DESIGN
from tests.acceptance.judges import ROUNDING, actuator_of_design, has_formula
from tests.random_cases import Case
from tests.second_route import curve_by_formula, gain_and_slope

MIN_STARTS = 1024
"""Starts of a search that says that it found nothing."""

NUMBER = r"(-?[\d.]+(?:e[+-]?\d+)?)"


def wrong_in_refusal(case: Case, refusal: str) -> Iterator[str]:
    """Yield what is not true of a refusal, as far as its words are known here."""
    if len(refusal) < 40 or not re.search(r"\d|'", refusal):
        yield f"says little: {refusal}"
    for pattern, judge in JUDGES:
        match = re.search(pattern, refusal)
        if match:
            numbers = [float(part.rstrip(".")) for part in match.groups()]
            if not judge(case, *numbers):
                yield f"not true: {refusal}"


def _leaves_that_in_range(case: Case, left: float, tolerance: float) -> bool:
    assert isinstance(case.plant, Scheduled)
    made = design(case.plant.middle, case.actuator, case.kind, case.options)
    if not has_formula(made.impulses, actuator_of_design(case)):
        return left > tolerance
    ratios = np.linspace(*case.plant.band, 2000)
    curve = curve_by_formula(made.impulses, case.plant.middle, actuator_of_design(case), ratios)
    return left > tolerance and abs(float(curve.max()) - left) <= 2e-3 * left


def _can_be_met(case: Case, **changed: float) -> bool:
    options = replace(case.options, **changed)
    try:
        made = design(case.plant, case.actuator, case.kind, options)
    except DesignError:
        return False
    longest = options.max_duration_periods * case.plant.modes[0].period_s
    return made.certificate.verified and made.impulses.duration_s <= longest * (1 + ROUNDING)


def _none_as_short(case: Case, horizon: float, starts: float) -> bool:
    """Whether a search over a longer horizon finds nothing within the one that was searched."""
    if starts < MIN_STARTS:
        return False
    if not hasattr(case.options, "max_duration_periods"):
        return True
    options = replace(case.options, max_duration_periods=min(max(3.0, 3 * horizon), 100.0))
    try:
        made = design(case.plant, case.actuator, case.kind, options)
    except InfeasibleDesignError:
        return True
    return made.impulses.duration_s > horizon * case.plant.modes[0].period_s * (1 - 1e-6)


def _alpha(case: Case) -> float:
    """|G_decel / G_accel| at the plant's pole."""
    mode = case.plant.modes[0]
    gains = [gain_and_slope(case.actuator, mode.pole_rad_s, accel=one)[0] for one in (True, False)]
    return abs(gains[1] / gains[0])


JUDGES: tuple[tuple[str, Callable[..., bool]], ...] = (
    (
        rf"is {NUMBER} within the range of frequencies.* above its tolerance {NUMBER}:",
        _leaves_that_in_range,
    ),
    (
        rf"a tolerance of {NUMBER} can be met$",
        lambda case, tolerance: _can_be_met(case, tolerance=tolerance),
    ),
    (
        rf"; max_duration_periods = {NUMBER}(?: or| can)",
        lambda case, periods: _can_be_met(case, max_duration_periods=periods),
    ),
    (
        rf"take {NUMBER} periods in all, more than max_duration_periods = {NUMBER}",
        lambda _, takes, horizon: takes > horizon,
    ),
    (
        rf"duration <= {NUMBER} periods in {NUMBER} starts; nearest miss(?!.* to the end: its)",
        _none_as_short,
    ),
    (
        rf"in {NUMBER} starts; nearest miss.* to the end: its budget of {NUMBER} million units",
        lambda _, starts, budget: starts > 0 and budget * 1e6 == MAX_WORK_PER_DESIGN,
    ),
    (
        rf"frequency is {NUMBER}, and the vector diagram",
        lambda case, alpha: alpha > 2 and abs(_alpha(case) - alpha) < 1e-9,
    ),
    (
        rf"of its sides {NUMBER}, {NUMBER} and {NUMBER} none may",
        lambda _, a, b, c: 2 * max(a, b, c) > a + b + c,
    ),
    (
        rf"acts as one of {NUMBER}, more than the other two together, {NUMBER}",
        lambda _, acts, others: acts >= others,
    ),
    (
        rf"command would go from {NUMBER} to {NUMBER} of full speed",
        lambda _, low, high: low < 0 or high > 1,
    ),
    (
        rf"found at a damping ratio of {NUMBER}:.*meet at a damping ratio of {NUMBER} with",
        lambda _, asked, met: met <= asked * 1.01,
    ),
    (
        rf"ordered solution takes {NUMBER} periods, more than max_duration_periods = {NUMBER}",
        lambda _, takes, horizon: takes > horizon,
    ),
)
"""Patterns of refusals and what must be true of their numbers."""
