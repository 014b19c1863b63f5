"""Impulses whose times lie on the sample grid of a controller.

A shaper that falls between two samples cannot be given as designed. Rounding it costs most of what
it was designed for; where amplitudes are free they can keep it (`design.sampling.free_amplitudes`),
those of unity magnitude are only as good as whole samples allow (`design.sampling.unity_grid`).
"""

import math
from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from design.analysis.residual import residual_vibration
from design.analysis.workable import require_workable
from design.checks import require_between, require_scale
from design.claims import Quantity
from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.sampling.left import Band, residuals_of_many
from design.sampling.more_impulses import is_unity, more_impulses_on_grid
from design.sampling.on_off_search import Searched, search_on_off
from design.sampling.sample_grid import (
    ON_SAMPLE,
    nearest,
    nearest_integers,
    require_gaps,
    require_grid,
    round_with_carry,
    split,
)
from design.sampling.unity_band import unity_over_band
from design.sampling.unity_grid import unity_on_grid

Method = Literal["free_amplitudes", "unity_on_grid", "search_on_off", "more_impulses_on_grid"]
"""How a shaper was brought to the grid: the module or function here that did it."""

MAX_DURATION_PERIODS = 3.0
"""Longest command that is searched for a kind that says nothing of it, as kinds that do where
nothing is given [undamped periods]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Tried:
    """A command of unity magnitude that was found.

    Attributes
    ----------
    impulses
        Their number [-].
    duration_s
        From the first to the last [s].
    residual
        Its residual with the actuator given [-].
    compared
        By what it was chosen: the residual, and where zero slope is claimed ``0.05 |dV/d ln w|``
        more, to first order the residual of 5 % of error in frequency; where a tolerance is
        claimed over a band, the largest residual over that [-].
    """

    impulses: int
    duration_s: float
    residual: float
    compared: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sampled:
    """A shaper on a sample grid, and what that cost.

    Attributes
    ----------
    impulses
        The shaper, its times whole multiples of the sample time.
    sample_time_s
        The sample time [s].
    method
        How it was brought to the grid.
    residual
        Its residual with the actuator given [-].
    continuous_residual
        Residual of the shaper between the samples with the same actuator [-].
    split_residual
        Residual of its linear split, which is not of unity magnitude [-]; None where the sample
        time is longer than the shaper.
    nearest_residual
        What its impulses leave, each at the sample nearest to it [-]; None where two of them are
        less than a sample apart.
    carried_residual
        What they leave with each rounding error carried on [-]; None where that brings two of them
        to one sample too.
    tried
        For amplitudes of unity magnitude its own impulses at the best samples, if these have one
        for each, then what searches with more impulses found.
    bound, shorter_bound
        What no command on as many samples, or on one less, can go below, as of `FreeAmplitudes`
        [-]; None where nothing is proven.
    searched
        What a search of all commands of level 0 or 1 proves; None where none was needed.
    """

    impulses: Impulses
    sample_time_s: float
    method: Method
    residual: float
    continuous_residual: float
    split_residual: float | None
    nearest_residual: float | None
    carried_residual: float | None
    tried: tuple[Tried, ...]
    bound: float | None = None
    shorter_bound: float | None = None
    searched: Searched | None = None

    @property
    def samples(self) -> tuple[int, ...]:
        """Number of the sample of each impulse, counted from time 0."""
        return tuple(np.rint(self.impulses.times_s / self.sample_time_s).astype(int).tolist())


def sample(
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    sample_time_s: float,
    claims: Collection[Quantity],
    *,
    tolerance: float | None = None,
    band: Band | None = None,
    band_tolerance: float = 0.0,
    max_duration_periods: float = MAX_DURATION_PERIODS,
) -> Sampled:
    """Bring a shaper of unity magnitude to a sample grid.

    The amplitudes are kept (`unity_on_grid`); where they then have a residual above the tolerance,
    or an impulse has no sample, the shortest command of level 0 or 1 within it is searched, or the
    one of least residual (`search_on_off`, and on grids too fine for that
    `more_impulses_on_grid`). For a band the samples are chosen by what is left over it, and no
    impulses are added, but where two of them have one sample (`unity_over_band`). Free amplitudes
    are solved for by `sample_free`.

    Parameters
    ----------
    impulses
        The shaper.
    mode, actuator
        The plant's mode and its drive.
    sample_time_s
        Sample time, > 0, at most the shortest gap between two impulses, or where a search is
        served half a period [s].
    claims
        What the shaper makes zero; ``slope`` stands for the residual besides.
    tolerance
        What unity magnitude may leave at most before impulses are added, 0 to 1: the residual, and
        with ``slope`` in the claims ``0.05 |dV/d ln w|`` more [-]. None adds none.
    band
        The band of frequencies over which the shaper keeps a tolerance; None where it keeps none.
    band_tolerance
        That tolerance, for which the shortest command is searched where impulses have no separate
        samples [-].
    max_duration_periods
        Longest command that is searched [undamped periods].

    Returns
    -------
    Sampled
        The shaper on the grid, and what it and other ways to get there leave.

    Raises
    ------
    InvalidInputError
        If the sample time or tolerance breaks its rule, a set of the actuator is out of
        proportion to the plant, or there are too many impulses to search.
    InfeasibleDesignError
        If over a band no command on the samples was found that has less than an unshaped step.

    Examples
    --------
    >>> from design.model.actuators.ideal import Ideal
    >>> umzv = Impulses(times_s=np.array([0.0, 0.0833, 0.1667]), amplitudes=np.array([1.0, -1, 1]))
    >>> two_hertz = Mode(natural_frequency_rad_s=4 * np.pi)
    >>> sampled = sample(umzv, two_hertz, Ideal(), 0.02, ("residual",))
    >>> sampled.method, sampled.samples
    ('unity_on_grid', (0, 4, 8))
    """
    require_workable(mode, actuator)
    method, found, tried, searched = _of_unity(
        impulses,
        mode,
        actuator,
        sample_time_s,
        slope="slope" in claims,
        tolerance=tolerance,
        band=band,
        band_tolerance=band_tolerance,
        max_duration_periods=max_duration_periods,
    )
    return replace(
        compared(impulses, found, (mode,), actuator, sample_time_s, method=method, tried=tried),
        searched=searched,
    )


def compared(
    impulses: Impulses,
    found: Impulses,
    modes: tuple[Mode, ...],
    actuator: Actuator,
    sample_time_s: float,
    *,
    method: Method,
    tried: tuple[Tried, ...] = (),
) -> Sampled:
    """Return a shaper on samples beside what other ways to get there leave.

    Parameters
    ----------
    impulses, found
        The shaper between the samples, and on them.
    modes, actuator
        The plant's modes, of which the largest residual counts, and the drive.
    sample_time_s
        Sample time, > 0 [s].
    method, tried
        How it was found.

    Returns
    -------
    Sampled
        Without bounds.

    Raises
    ------
    InvalidInputError
        If the sample time breaks its rule.
    """

    def residual(command: Impulses) -> float:
        return max(residual_vibration(command, mode, actuator) for mode in modes)

    def residual_by(way: Callable[[Impulses, float], Impulses]) -> float | None:
        try:
            return residual(way(impulses, sample_time_s))
        except InvalidInputError:
            return None  # the sample time serves the shaper, but not this way

    return Sampled(
        impulses=found,
        sample_time_s=sample_time_s,
        method=method,
        residual=residual(found),
        continuous_residual=residual(impulses),
        split_residual=residual_by(split),
        nearest_residual=residual_by(nearest),
        carried_residual=residual_by(round_with_carry),
        tried=tried,
    )


def _of_unity(
    impulses: Impulses,
    mode: Mode,
    actuator: Actuator,
    sample_time_s: float,
    *,
    slope: bool,
    tolerance: float | None,
    band: Band | None,
    band_tolerance: float,
    max_duration_periods: float,
) -> tuple[Method, Impulses, tuple[Tried, ...], Searched | None]:
    """Return the shortest command within the tolerance, or that of least residual; all tried."""
    commands: list[tuple[Method, Impulses, float]] = []

    def add(method: Method, command: Impulses) -> float:
        """Note a command; return its figure."""
        left = _compare(command, mode, actuator, slope=slope, band=band)
        commands.append((method, command, left))
        return left

    longest = 0
    if tolerance is not None:
        require_between("sample_tolerance", tolerance, 0.0, 1.0)
        require_scale("sample_time_s", sample_time_s)
        if is_unity(impulses):
            longest = math.floor(max_duration_periods * mode.period_s / sample_time_s + ON_SAMPLE)
    own, searched = 1.0, None
    if longest < MIN_SEARCHED_SAMPLES or _has_samples(impulses, sample_time_s):
        moved = unity_on_grid(impulses, mode, actuator, sample_time_s, slope=slope, band=band)
        own = add("unity_on_grid", moved)
    else:
        require_grid(impulses, sample_time_s, mode.period_s / 2, "half a period")
        if band is not None:
            moved, searched = unity_over_band(
                impulses,
                mode,
                actuator,
                sample_time_s,
                band,
                tolerance=band_tolerance,
                longest=longest,
            )
            add("search_on_off", moved)
    if (
        tolerance is not None
        and band is None
        and longest >= MIN_SEARCHED_SAMPLES
        and (not commands or own > tolerance)
    ):
        searched = search_on_off(
            mode,
            actuator,
            sample_time_s,
            longest,
            slope=slope,
            tolerance=tolerance,
            known=own,
        )
        left = own
        if searched.samples is not None:
            first = nearest_integers(impulses.times_s[:1] / sample_time_s)
            signs = (-1.0) ** np.arange(searched.samples.size) * impulses.amplitudes[0]
            times_s = (first + searched.samples) * sample_time_s
            left = add("search_on_off", Impulses(times_s=times_s, amplitudes=signs))
        if left > tolerance and not searched.complete:
            for command in more_impulses_on_grid(
                impulses, mode, actuator, sample_time_s, slope=slope, tolerance=tolerance
            ):
                if add("more_impulses_on_grid", command) <= tolerance:
                    break
    if not commands:
        require_gaps(impulses, sample_time_s)
    tried = tuple(
        Tried(
            impulses=command.times_s.size,
            duration_s=command.duration_s,
            residual=residual_vibration(command, mode, actuator),
            compared=left,
        )
        for _, command, left in commands
    )
    # Only the last can be within the tolerance, and is then the least of all.
    method, found, _ = min(commands, key=lambda one: one[2])
    return method, found, tried, searched


MIN_SEARCHED_SAMPLES = 2
"""A command has a step up, one down, one up [-]."""


def _has_samples(impulses: Impulses, sample_time_s: float) -> bool:
    """Return whether each impulse has a separate sample."""
    try:
        require_gaps(impulses, sample_time_s)
    except InvalidInputError as error:
        if error.code == "sample_time_too_long":
            return False
        raise
    return True


def _compare(
    impulses: Impulses, mode: Mode, actuator: Actuator, *, slope: bool, band: Band | None
) -> float:
    times, amplitudes = impulses.times_s[None], impulses.amplitudes
    return float(residuals_of_many(times, amplitudes, mode, actuator, slope=slope, band=band)[0])
