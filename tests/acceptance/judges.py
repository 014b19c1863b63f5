"""What is wrong with a design: claims by formula, bounds by other kinds."""

import math
import re
from collections.abc import Iterator

import numpy as np

from design.analysis.certificate import Claim, certify
from design.analysis.claims_found import claim_over_band, zeros_of
from design.analysis.insensitivity import insensitivity
from design.analysis.residual import residual_vectors, residual_vibration
from design.analysis.residuals_of_many import residual_curve
from design.claims import Promise
from design.errors import InfeasibleDesignError, InvalidInputError
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.scheduled import Scheduled
from design.pipeline import Design, design
from design.sampling.sampled_design import sampled_design
from design.shapers.registry import SHAPERS
from design.shapers.several_modes import ConvolvedOptions
from design.shapers.specified_insensitivity import BandOptions
from design.types import FloatArray
from tests.expm_route import end_s
from tests.integration_route import residual_by_integration
from tests.random_cases import Case
from tests.second_route import (
    claims_by_formula,
    curve_by_formula,
    ideal_derivative_by_formula,
    increases,
)

ROUNDING = 1e-9
"""Two routes to one number agree to it, relative, and where it is nothing to `NOTHING`."""

NOTHING = 2e-9

DIFFERENCE = 1e-5
"""Relative step in frequency of a central difference: its error and rounding are 1e-9 [-]."""

ORDERS = {"second_derivative": 2, "third_derivative": 3}

INTEGRATED = 40
SAMPLED = 7
COMPARED = 3
"""Every how manieth case is integrated step by step, brought to samples, compared with bounds."""

MAX_INTEGRATED_IMPULSES = 9
"""Impulses of a command that is integrated, at most."""


def wrong_in_design(case: Case, made: Design) -> Iterator[str]:
    """Yield what is wrong with a design."""
    yield from _wrong_impulses(made.impulses)
    if not made.certificate.verified:
        yield "not verified"
    kept = {(claim.quantity, claim.mode) for claim in made.certificate.claims}
    for number in range(len(case.plant.modes)):
        for quantity in _promises(case):
            if (quantity, number) not in kept:
                yield f"claims no {quantity} of mode {number}"
    designed_for = actuator_of_design(case) if made.for_ideal else case.actuator
    for claim in made.certificate.claims:
        mode = case.plant.modes[claim.mode]
        yield from _wrong_claim(claim, made.impulses, mode, designed_for)
    for mode, residual in zip(case.plant.modes, made.residuals, strict=True):
        told = _residual(made.impulses, mode, case.actuator)
        if abs(told - residual) > NOTHING + ROUNDING * told:
            yield f"tells a residual of {residual:.6g}, another route {told:.6g}"
    yield from _wrong_range(case, made)
    yield from _wrong_bound(case, made)
    if len(case.plant.modes) == 1 and case.number % INTEGRATED == 0:
        yield from _wrong_by_integration(case, made)
    if case.number % SAMPLED == 0 and not isinstance(case.plant, Modes | Scheduled):
        yield from _wrong_on_samples(case, made)
    if case.number % COMPARED == 0:
        yield from _shorter_than_bound(case, made)


def _residual(impulses: Impulses, mode: Mode, actuator: Actuator) -> float:
    """Return the residual by formula; by the closed form of a switched actuator; else simulated.

    What is left then are ramps that are cut, for which there is no other route than integration.
    """
    if has_formula(impulses, actuator):
        return claims_by_formula(impulses, mode, actuator)["residual"]
    if not isinstance(actuator, RateLimited):
        return residual_vibration(impulses, mode, actuator)
    asked = Promise(quantity="residual", limit=math.inf)
    return certify(impulses, mode, actuator, (asked,)).claims[0].value


def _curve(impulses: Impulses, mode: Mode, actuator: Actuator, ratios: FloatArray) -> FloatArray:
    """Return the residual at ratios of frequency, likewise."""
    if has_formula(impulses, actuator):
        return curve_by_formula(impulses, mode, actuator, ratios)
    return residual_curve(impulses, mode, actuator, ratios)


def _slope(impulses: Impulses, mode: Mode, actuator: Actuator) -> float:
    """Return the slope where the residual is zero, by differencing the closed form."""
    poles = mode.pole_rad_s * np.array([1 - DIFFERENCE, 1 + DIFFERENCE])
    below, above = residual_vectors(impulses, poles, actuator)
    return float(abs(above - below)) / (2 * DIFFERENCE)


def _wrong_impulses(impulses: Impulses) -> Iterator[str]:
    if impulses.times_s[0] != 0 or (np.diff(impulses.times_s) <= 0).any():
        yield f"times {impulses.times_s.tolist()}"
    if abs(impulses.amplitudes.sum() - 1) > 1e-12:
        yield f"amplitudes sum to {impulses.amplitudes.sum()!r}"
    if np.abs(impulses.amplitudes).min() <= 1e-15 * np.abs(impulses.amplitudes).sum():
        yield f"amplitudes {impulses.amplitudes.tolist()}, one of them rounding"


def _promises(case: Case) -> tuple[str, ...]:
    """Return what the kind says of itself; of convolved shapers, what their base does."""
    if isinstance(case.options, ConvolvedOptions):
        return SHAPERS[case.options.base].claims
    return case.kind.claims


def actuator_of_design(case: Case) -> Actuator:
    """Return the drive that a kind designs for: the one of the case, or an ideal one."""
    modes, options = case.plant.modes, case.options
    if isinstance(case.plant, Scheduled) and hasattr(options, "half_width"):
        options = type(options)()
    asked = case.kind.case(modes, case.actuator, options)
    found: Actuator = case.kind.formulate(asked).designed_for
    assert found in {case.actuator, Ideal()}
    return found


def has_formula(impulses: Impulses, actuator: Actuator) -> bool:
    """Whether each step excites a response of its own, by a known set."""
    rising = increases(impulses)
    if actuator.model == "switched" and not all(rising):
        return False
    if not isinstance(actuator, RateLimited):
        return True
    speeds = [actuator.decel_limit_m_s2, actuator.accel_limit_m_s2]
    ramps = [
        abs(amplitude) * actuator.speed_m_s / speeds[up]
        for amplitude, up in zip(impulses.amplitudes.tolist(), rising, strict=True)
    ]
    levels = np.cumsum(impulses.amplitudes)
    return bool((np.diff(impulses.times_s) >= ramps[:-1]).all() and levels.min() >= -1e-12)


def _wrong_claim(
    claim: Claim, impulses: Impulses, mode: Mode, designed_for: Actuator
) -> Iterator[str]:
    if not math.isfinite(claim.value):
        yield f"{claim.quantity} is {claim.value}"
    if claim.quantity == "residual":
        value = _residual(impulses, mode, designed_for)
    elif claim.band is not None:
        if isinstance(designed_for, RateLimited) and not has_formula(impulses, designed_for):
            return
        turns = mode.natural_frequency_rad_s * impulses.duration_s * (claim.band[1] - claim.band[0])
        points = min(64 + int(8 * turns), 3000)
        curve = _curve(impulses, mode, designed_for, np.linspace(*claim.band, points))
        value = float(curve.max())
        if value > claim.value * (1 + 1e-6):
            yield f"claims {claim.value!r} over {claim.band}, another route finds {value!r}"
    elif not has_formula(impulses, designed_for):
        if claim.quantity != "slope" or isinstance(designed_for, RateLimited):
            return
        value = _slope(impulses, mode, designed_for)
    elif claim.quantity in ORDERS:
        # G is a common factor of positive steps, and V is zero.
        value = ideal_derivative_by_formula(impulses, mode, ORDERS[claim.quantity])
    else:
        value = claims_by_formula(impulses, mode, designed_for)[claim.quantity]
    if value > claim.limit * (1 + 2 * ROUNDING):
        yield f"{claim.quantity} of {claim.limit:g} claimed is {value!r} by another route"


def _wrong_range(case: Case, made: Design) -> Iterator[str]:
    if not isinstance(case.plant, Scheduled):
        return
    if made.worst_in_range is None:
        yield "tells nothing of the range"
        return
    bands = [claim for claim in made.certificate.claims if claim.band == case.plant.band]
    if "band" in _promises(case) and not bands:
        yield "does not claim its tolerance over the range"
    if not isinstance(case.actuator, RateLimited) or has_formula(made.impulses, case.actuator):
        ratios = np.linspace(*case.plant.band, 400)
        told = float(_curve(made.impulses, case.plant.middle, case.actuator, ratios).max())
        if told > made.worst_in_range * (1 + 1e-6) + NOTHING:
            yield f"tells {made.worst_in_range!r} as the worst in range, another route {told!r}"


def _wrong_bound(case: Case, made: Design) -> Iterator[str]:
    bound, gap, duration = made.solver.lower_bound_s, made.solver.gap, made.impulses.duration_s
    if (made.impulses.amplitudes < 0).any():  # what ends behind limits is the last ramp
        duration = end_s(made.impulses, case.actuator)
    if (bound is None) != (gap is None):
        yield f"bound {bound} and gap {gap}"
    if bound is None or gap is None:
        return
    if not 0 <= bound <= duration * (1 + 1e-12):
        yield f"a bound of {bound!r} for a duration of {duration!r}"
    if abs(duration * (1 - gap) - bound) > 1e-9 * duration:
        yield f"a gap of {gap!r} between {bound!r} and {duration!r}"


def _wrong_by_integration(case: Case, made: Design) -> Iterator[str]:
    if made.impulses.times_s.size > MAX_INTEGRATED_IMPULSES:
        return
    told = residual_by_integration(made.impulses, case.plant.modes[0], case.actuator)
    # The integrator keeps 1e-11 a step, over an unshaped step's swing that damping makes smaller.
    if abs(told - made.residual) > 1e-6:
        yield f"tells a residual of {made.residual!r}, integration {told!r}"


def _wrong_on_samples(case: Case, made: Design) -> Iterator[str]:
    rng = np.random.default_rng([case.number, 1])
    shortest = float(np.diff(made.impulses.times_s).min())
    sample_time_s = shortest * float(rng.uniform(0.02, 0.9))
    mode = case.plant.mode
    try:
        found, _ = sampled_design(made, mode, case.actuator, sample_time_s, tolerance=None)
    except InvalidInputError as error:
        if not re.search(r"sample_time_s|samples|impulses", str(error)):
            yield f"on samples: {error}"
        return
    claim, *over_band = found.certificate.claims
    if claim.quantity != "residual" or not found.certificate.verified:
        yield f"on samples claims {found.certificate.claims}"
    promised = claim_over_band(made.certificate)
    if [one.band for one in over_band] != ([] if promised is None else [promised.band]):
        yield f"on samples claims {over_band}, promised was {promised}"
    samples = found.impulses.times_s / sample_time_s
    if np.abs(samples - np.rint(samples)).max() > 1e-6:
        yield "on samples it is not"
    if has_formula(found.impulses, case.actuator):
        told = claims_by_formula(found.impulses, mode, case.actuator)["residual"]
        if abs(told - found.residual) > NOTHING + ROUNDING * told:
            yield f"on samples tells {found.residual!r}, the formula {told!r}"


def _shorter_than_bound(case: Case, made: Design) -> Iterator[str]:
    """Yield where a shaper of another kind is shorter than a bound of its class."""
    modes, duration = case.plant.modes, made.impulses.duration_s
    positive = bool((made.impulses.amplitudes > 0).all())
    if len(modes) > 1:
        # Behind limits the last switch comes before the reference ends.
        limited = isinstance(case.actuator, RateLimited)
        if made.solver.lower_bound_s is None and not limited:
            for other in ("multi_zv", "multi_umzv") if positive else ("multi_umzv",):
                try:
                    bound = _bound(design(case.plant, Ideal(), SHAPERS[other]))
                except (InfeasibleDesignError, InvalidInputError):
                    continue  # no joint shaper is found where modes decay at once
                if "residual" in zeros_of(made.certificate) and bound > duration * (1 + ROUNDING):
                    yield f"is {duration!r} long, the bound of {other} is {bound!r}"
        return
    if not positive or case.kind.name == "si":
        return
    rng = np.random.default_rng([case.number, 2])
    tolerance = float(np.exp(rng.uniform(np.log(0.01), np.log(0.3))))
    kept = insensitivity(made.impulses, modes[0], Ideal(), tolerance)
    if kept is None or kept.lower_ratio is None or kept.upper_ratio is None:
        return
    try:
        options = BandOptions(
            lower_ratio=kept.lower_ratio,
            upper_ratio=kept.upper_ratio,
            tolerance=tolerance,
            max_duration_periods=100.0,
        )
    except InvalidInputError:
        return
    fastest = design(modes[0], Ideal(), SHAPERS["si"], options)
    # The band's ends are known to 1e-9; the bound is for what is within the tolerance there.
    if _bound(fastest) > duration * (1 + 1e-6):
        yield f"keeps {tolerance!r} as long as si, in {duration!r}, its bound {_bound(fastest)!r}"


def _bound(made: Design) -> float:
    assert made.solver.lower_bound_s is not None
    return made.solver.lower_bound_s
