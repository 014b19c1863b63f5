"""What is wrong with a design on samples, by routes that share no code with it."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from design.claims import ZERO_LIMITS
from design.model.actuators.ideal import Ideal
from design.model.actuators.rate_limited import RateLimited
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.model.plants.registry import Plant
from design.model.plants.scheduled import Scheduled
from tests import expm_route
from tests.acceptance.answer_cases import (
    AGREE,
    JSON,
    apart,
    impulses_of,
)
from tests.acceptance.judges import ORDERS
from tests.acceptance.played import (
    INTEGRATED,
    MAX_INTEGRATED_STEPS,
    curve_of,
    limits_jerk,
    residual_of,
)
from tests.acceptance.sample_proofs import (
    MAX_LISTED,
    MAX_SAMPLES,
    Wanted,
    best_amplitudes,
    least_of_level_0_or_1,
    missed,
)
from tests.second_route import ideal_derivative_by_formula

SAMPLE_TOLERANCE = 0.01
"""What a shaper that claims zero may leave on samples, where nothing else is asked [-]."""

LOOKED_AT = 41
"""Frequencies of a band at which a command is played behind a drive without a formula."""

DENSE = 1001
"""The same of one with a formula."""

PEAK = 2e-3
"""What a told peak may be above all that is looked at, over it [-]."""

ROUNDING = 1e-6
"""Accuracy of bounds and of sums of amplitudes that programs find [-]."""

NONE_OVER_BAND = re.compile(
    r"over the band of ([\d.]+) to ([\d.]+) is less .* of up to (\d+) samples has less than "
    r"([\d.]+) %"
)
DIGITS = 5e-4
"""How exact a number of four digits is [-]."""

HUMP, FINE, EDGE = 1e-6, 1e-4, 1e-9
"""Residual at ends of a band that are zeros, steps to its edges, how exact these are [-]."""


@dataclass(frozen=True, slots=True)
class OnSamples:
    """An answer, that to the same between the samples, and what was asked."""

    answer: JSON
    between: JSON
    plant: Plant
    actuator: Actuator
    shaper: JSON

    @property
    def command(self) -> Impulses:
        return impulses_of(self.answer["shaper"]["impulses"])

    @property
    def designed_for(self) -> Actuator:
        return Ideal() if self.answer["certificate"]["actuator"] == "ideal" else self.actuator

    @property
    def is_free(self) -> bool:
        return bool(self.answer["sampled"]["method"] == "free_amplitudes")

    @property
    def codes(self) -> list[str]:
        return [one["code"] for one in self.answer["warnings"]]

    def wrong(self) -> Iterator[str]:
        """Yield what is wrong."""
        yield from self._wrong_amplitudes()
        yield from self._wrong_residuals()
        yield from self._wrong_claims()
        yield from self._wrong_warnings()
        yield from self._wrong_bounds()
        yield from self._wrong_search()

    def _played(self, mode: Mode, actuator: Actuator) -> float | None:
        """Return the residual by another route; None where there is none that is fast."""
        if limits_jerk(actuator) and self.command.times_s.size > MAX_INTEGRATED_STEPS:
            return None
        end_s = self.answer["shaper"].get("ramp_end_s", 0.0)
        return residual_of(self.command, mode, actuator, end_s)

    def _apart(self, what: str, told: float, mode: Mode, actuator: Actuator) -> Iterator[str]:
        other = self._played(mode, actuator)
        if other is not None and limits_jerk(actuator):
            if abs(told - other) > INTEGRATED * (1 + other):
                yield f"{what} {told:.9g}, integrated {other:.9g}"
        elif other is not None:
            yield from apart(what, told, other)

    def _wrong_amplitudes(self) -> Iterator[str]:
        command, sampled = self.command, self.answer["sampled"]
        samples = command.times_s / self.shaper["sample_time_s"]
        if np.abs(samples - sampled["samples"]).max() > 1e-6 or (np.diff(samples) < 0.5).any():
            yield f"samples {sampled['samples']}, times {command.times_s.tolist()}"
        if command.times_s[0] != 0:
            yield f"begins at {command.times_s[0]!r}"
        if abs(self.answer["shaper"]["duration_s"] - command.duration_s) > 1e-12:
            yield "tells another duration"
        if abs(command.amplitudes.sum() - 1) > 1e-12:
            yield f"amplitudes sum to {command.amplitudes.sum()!r}"
        before = impulses_of(self.between["shaper"]["impulses"])
        levels, known = np.cumsum(command.amplitudes), np.cumsum(before.amplitudes)
        low, high = min(0.0, known.min()), max(1.0, known.max())
        if levels.min() < low - 1e-9 or levels.max() > high + 1e-9:
            yield f"levels {levels.min():.9g} to {levels.max():.9g}, allowed {low:g} to {high:g}"
        if before.amplitudes.min() > 0 and command.amplitudes.min() <= 0:
            yield "is not positive"
        if self.shaper["kind"].startswith("sna") and self.is_free:
            down = [one.amplitudes[one.amplitudes < 0].sum() for one in (command, before)]
            if abs(down[0] - down[1]) > ROUNDING:
                yield f"negative steps sum to {down[0]:.9g}, between the samples {down[1]:.9g}"
        if not self.is_free:
            signs = (-1.0) ** np.arange(command.times_s.size)
            if np.abs(command.amplitudes - signs).max() > 0:
                yield f"is not of unity magnitude: {command.amplitudes.tolist()}"

    def _wrong_residuals(self) -> Iterator[str]:
        modes = self.answer.get("modes")
        told = [one["residual"] for one in modes] if modes else [self.answer["residual"]]
        if abs(max(told) - self.answer["residual"]) > 0:
            yield f"residuals {told}, as a whole {self.answer['residual']!r}"
        for mode, residual in zip(self.plant.modes, told, strict=True):
            yield from self._apart("residual", residual, mode, self.actuator)
        if isinstance(self.plant, Scheduled) and not limits_jerk(self.actuator):
            worst = self.answer["scheduled"]["worst_residual"]
            peak = self._peak(self.plant.middle, self.actuator, self.plant.band)
            yield from _unlike_peak("worst in range", worst, peak)

    def _peak(self, mode: Mode, actuator: Actuator, band: tuple[float, float]) -> float:
        count = DENSE if actuator.model == "superposed" else LOOKED_AT
        if isinstance(actuator, RateLimited):
            count = LOOKED_AT
        curve = curve_of(self.command, mode, actuator, np.linspace(*band, count))
        return float(curve.max())

    def _wrong_claims(self) -> Iterator[str]:
        certificate = self.answer["certificate"]
        if not certificate["verified"]:
            yield "not verified"
        promised = self.between["certificate"]["claims"]
        bands = [(one.get("mode"), one["band"]) for one in promised if "band" in one]
        claims = certificate["claims"]
        if bands != [(one.get("mode"), one["band"]) for one in claims if "band" in one]:
            yield f"claims {claims}, between the samples {promised}"
        for claim in claims:
            mode = self.plant.modes[claim.get("mode", 0)]
            if claim["value"] > claim["limit"] * (1 + 1e-9):
                yield f"claims {claim}"
            if claim["quantity"] == "residual":
                yield from self._apart("claims", claim["value"], mode, self.designed_for)
            elif not limits_jerk(self.designed_for):
                peak = self._peak(mode, self.designed_for, claim["band"])
                yield from _unlike_peak("claims over the band", claim["value"], peak)
        if self.is_free:
            for claim in promised:
                yield from self._not_kept(claim)

    def _not_kept(self, claim: JSON) -> Iterator[str]:
        """Yield where free amplitudes do not keep what the shaper does between the samples."""
        mode, drive = self.plant.modes[claim.get("mode", 0)], self.designed_for
        found: float | None = None
        if claim["quantity"] in ORDERS:
            found = ideal_derivative_by_formula(self.command, mode, ORDERS[claim["quantity"]])
        elif claim["quantity"] == "slope" and not limits_jerk(drive):
            found = expm_route.slope(self.command, mode, drive) / 3  # one is differenced
        elif claim["quantity"] == "residual":
            found = self._played(mode, drive)
        else:
            found = max(
                one["value"]
                for one in self.answer["certificate"]["claims"]
                if one.get("mode") == claim.get("mode") and one.get("band") == claim["band"]
            )
        if found is not None and found > claim["limit"] * (1 + PEAK):
            yield f"{claim['quantity']} is {found:.6g}, between the samples {claim['limit']}"

    def _wrong_warnings(self) -> Iterator[str]:
        ideal = self.answer["certificate"]["actuator"] == "ideal"
        if ("actuator_ignored" in self.codes) != ideal:
            yield f"a certificate for the ideal drive: {ideal}, warnings {self.codes}"
        if ideal:
            yield from self._without_figure("actuator_ignored", 100 * self.answer["residual"], " %")
        limits = {
            (one.get("mode"), one["band"][0]): one["limit"]
            for one in self.between["certificate"]["claims"]
            if "band" in one
        }
        zero = [
            one
            for one in self.between["certificate"]["claims"]
            if one["quantity"] == "residual" and one["limit"] <= ZERO_LIMITS["residual"]
        ]
        tolerance = self.shaper.get("sample_tolerance", SAMPLE_TOLERANCE)
        above = False
        for claim in self.answer["certificate"]["claims"]:
            if "band" in claim:
                limit = limits[claim.get("mode"), claim["band"][0]]
                if claim["value"] > limit * (1 + PEAK):
                    above = True
                    yield from self._without_figure("tolerance_not_kept", claim["value"], "")
                elif claim["value"] > limit:  # a peak between the frequencies looked at
                    above |= "tolerance_not_kept" in self.codes
            elif zero and not limits and claim["value"] > tolerance * (1 + 1e-8):
                above = True
        if zero and not limits and above and len(self.plant.modes) == 1:
            (nominal,) = self.answer["certificate"]["claims"]
            yield from self._without_figure("tolerance_not_kept", 100 * nominal["value"], " %")
        if above != ("tolerance_not_kept" in self.codes):
            yield f"above its tolerance: {above}, warnings {self.codes}"

    def _without_figure(self, code: str, figure: float, unit: str) -> Iterator[str]:
        details = [one["detail"] for one in self.answer["warnings"] if one["code"] == code]
        if not any(f"{figure:.4g}{unit}" in detail for detail in details):
            yield f"{code} without its figure {figure:.4g}: {details}"

    @property
    def levels(self) -> tuple[float, float] | None:
        """Between which the sums of amplitudes stay; None of positive ones."""
        before = impulses_of(self.between["shaper"]["impulses"]).amplitudes
        known = np.cumsum(before)
        return None if before.min() > 0 else (min(0.0, known.min()), max(1.0, known.max()))

    def wanted(self) -> list[Wanted] | None:
        """Return what is asked of amplitudes; None where V is not a plain sum of turns."""
        amplitudes = impulses_of(self.between["shaper"]["impulses"]).amplitudes
        drive = self.designed_for
        alike = drive.accel_lag == drive.decel_lag or amplitudes.min() > 0
        if isinstance(drive, RateLimited) or not alike or self.shaper["kind"].startswith("sna"):
            return None
        wanted, promised = [], self.between["certificate"]["claims"]
        bands = any("band" in one or one["limit"] > 1e-4 for one in promised)
        for claim in promised:
            mode = self.plant.modes[claim.get("mode", 0)]
            band = (1.0, 1.0)
            if "band" in claim:
                before = impulses_of(self.between["shaper"]["impulses"])
                band = _whole_band(before, mode, drive, claim)
            order = {"slope": 1, **ORDERS}.get(claim["quantity"], 0)
            if bands and claim["limit"] < 1e-4:
                return None  # zeros beside a tolerance
            if order and not isinstance(drive, Ideal):
                return None  # a Taylor coefficient has those of the lag in it
            limit = claim["limit"] if bands else 1.0
            wanted.append(Wanted(mode=mode, band=band, limit=limit, order=order))
        return wanted

    def _wrong_bounds(self) -> Iterator[str]:
        sampled, claims = self.answer["sampled"], self.answer["certificate"]["claims"]
        bound, shorter = sampled["bound"], sampled["shorter_bound"]
        if not self.is_free:
            return
        wanted = self.wanted()
        limits = [one["limit"] for one in self.between["certificate"]["claims"]]
        tolerance = max(limits)
        if bound is not None and tolerance > 1e-4:
            worst = max(one["value"] for one in claims)
            if bound > worst * (1 + ROUNDING):
                worst = max(worst, *self._left_over_whole_bands())
            if bound > worst * (1 + ROUNDING):
                yield f"a bound of {bound!r} for {worst!r}"
        if bound is not None and tolerance <= 1e-4 and bound != 0:
            yield f"a bound of {bound!r} for zeros"
        samples = sampled["samples"][-1] + 1
        if wanted is None or samples > MAX_SAMPLES:
            return
        scale = tolerance if tolerance > 1e-4 else 1.0
        for what, count, told in (("bound", samples, bound), ("shorter", samples - 1, shorter)):
            if count < 1 or (what == "bound" and scale == 1.0):
                continue
            best = best_amplitudes(wanted, count, self.shaper["sample_time_s"], self.levels)
            if best is None:
                yield f"no amplitudes on {count} samples by a dense program"
                continue
            left = scale * missed(wanted, best, self.shaper["sample_time_s"])
            if told is not None and told > left * (1 + ROUNDING) + 1e-9:
                yield f"{what} is {told:.9g} on {count} samples, a dense program finds {left:.9g}"
            if what == "shorter" and scale < 1 and left < tolerance * (1 - 2 * ROUNDING):
                yield f"takes {samples} samples, {left:.9g} is left on one less"
            worst = max(one["value"] for one in claims)
            if what == "bound" and len(self.plant.modes) == 1 and worst > left * (1 + PEAK):
                yield f"leaves {worst:.9g} on {count} samples, a dense program {left:.9g}"

    def _left_over_whole_bands(self) -> Iterator[float]:
        """Yield what is left over all of each band that a shaper of humps keeps."""
        before, drive = impulses_of(self.between["shaper"]["impulses"]), self.designed_for
        for claim in self.between["certificate"]["claims"]:
            if "band" in claim:
                mode = self.plant.modes[claim.get("mode", 0)]
                yield self._peak(mode, drive, _whole_band(before, mode, drive, claim))

    def _wrong_search(self) -> Iterator[str]:
        search = self.answer["sampled"]["search"]
        drive = self.actuator
        if search is None or isinstance(drive, RateLimited) or drive.model == "switched":
            return
        samples = search["searched_samples"]
        claims = self.between["certificate"]["claims"]
        promised = {one["quantity"] for one in claims}
        bands = {tuple(one["band"]) for one in claims if "band" in one}
        if len(bands) > 1:
            return
        band = next(iter(bands), None)
        listed = min(samples, MAX_LISTED)
        if listed < 2:
            return
        least = least_of_level_0_or_1(
            self.plant.modes[0],
            drive,
            self.shaper["sample_time_s"],
            listed,
            slope="slope" in promised,
            band=band,
        )
        if search["bound"] > least + AGREE:
            yield f"of {samples} samples none below {search['bound']:.9g}; {least:.9g} is"
        reached = min(one["compared"] for one in self.answer["sampled"]["tried"])
        # Over a band 17 frequencies are compared here, and more there.
        if band is None and samples >= listed and least < reached - 1e-8 and search["complete"]:
            tolerance = self.shaper.get("sample_tolerance", SAMPLE_TOLERANCE)
            if least <= tolerance or reached > tolerance:
                yield f"the best tried leaves {reached:.9g}, one of {listed} samples {least:.9g}"


def wrong_refusal(
    detail: str, plant: Plant, actuator: Actuator, sample_time_s: float
) -> Iterator[str]:
    """Yield what is not true of a proof that no command of level 0 or 1 serves over a band."""
    told = NONE_OVER_BAND.search(detail)
    if told is None or isinstance(actuator, RateLimited) or actuator.model == "switched":
        return
    low, high, samples, percent = map(float, told.groups())
    # The band is told to four digits: over a wider one the best of all commands leaves no less.
    least = least_of_level_0_or_1(
        plant.modes[0],
        actuator,
        sample_time_s,
        min(int(samples), MAX_LISTED),
        slope=False,
        band=(low * (1 - DIGITS), high * (1 + DIGITS)),
    )
    if percent / 100 > least * (1 + 2 * DIGITS):
        yield f"not true, as one leaves {100 * least:.4g} %: {detail}"


def _whole_band(before: Impulses, mode: Mode, drive: Actuator, claim: JSON) -> tuple[float, float]:
    """Return all of the band that a shaper of humps keeps; of others the one that is claimed."""
    low, high = claim["band"]
    if curve_of(before, mode, drive, np.array([low, high])).max() > HUMP:
        return low, high
    reach = np.arange(0.0, 1.0, FINE)
    for sign, end in ((-1, low), (1, high)):
        at = end * (1 + sign * reach)
        kept = curve_of(before, mode, drive, at) <= claim["limit"]
        first = int(np.argmin(kept))
        last, lost = at[first - 1], at[first]
        # A step nearer, what four impulses and fewer leave at the edge is a thousandth less.
        while abs(lost - last) > EDGE:
            middle = (last + lost) / 2
            within = curve_of(before, mode, drive, np.array([middle]))[0] <= claim["limit"]
            last, lost = (middle, lost) if within else (last, middle)
        low, high = (last, high) if sign < 0 else (low, last)
    return float(low), float(high)


def _unlike_peak(what: str, told: float, peak: float) -> Iterator[str]:
    if peak > told * (1 + ROUNDING) + AGREE:
        yield f"{what} {told:.9g}, another route {peak:.9g}"
    if told > peak * (1 + 0.05) + 1e-6:
        yield f"{what} {told:.9g}, another route only {peak:.9g}"
