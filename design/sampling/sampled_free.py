"""A shaper whose amplitudes are free, on a sample grid, for one mode or several."""

from collections.abc import Sequence
from dataclasses import replace

from design.analysis.residual import residual_vibration
from design.analysis.workable import require_workable
from design.claims import Promise
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.mode import Mode
from design.sampling.free_amplitudes import free_on_samples
from design.sampling.more_impulses import is_unity
from design.sampling.sample_grid import require_grid
from design.sampling.sampled import Sampled, compared
from design.shapers.kind import ShaperKind
from design.solvers.budget import Budget

BETWEEN_LEVELS = "multi_umzv"
"""Kind that claims the fastest command between 0 and 1: on samples it is between them at some."""


def has_free_amplitudes(impulses: Impulses, *, between_levels: bool) -> bool:
    """Return whether amplitudes other than those given serve a shaper.

    Parameters
    ----------
    impulses
        The shaper.
    between_levels
        Whether a command of level 0 or 1 may as well be between them: not that of an on-off drive.

    Returns
    -------
    bool
        False of a single step, and of unity magnitude that is to stay so.
    """
    return impulses.amplitudes.size > 1 and (between_levels or not is_unity(impulses))


def may_be_between_levels(kind: ShaperKind, modes: tuple[Mode, ...]) -> bool:
    """Return whether a kind only limits its command.

    Parameters
    ----------
    kind
        Kind of the shaper.
    modes
        Of the plant: for several, unity magnitude has no samples to choose from that leave nothing.

    Returns
    -------
    bool
        True of kinds that are given limits, and of the joint command between 0 and 1.
    """
    return hasattr(kind.options, "amplitudes") or (kind.name == BETWEEN_LEVELS and len(modes) > 1)


def require_two_a_period(impulses: Impulses, modes: tuple[Mode, ...], sample_time_s: float) -> None:
    """Check that a controller gives two samples in each period.

    Parameters
    ----------
    impulses, modes
        The shaper and the plant's modes.
    sample_time_s
        Sample time [s].

    Raises
    ------
    InvalidInputError
        If the sample time is not > 0, or longer than half the shortest period: samples then do not
        tell a mode from a slower one.
    """
    longest_s = min(mode.period_s for mode in modes) / 2
    require_grid(impulses, sample_time_s, longest_s, "half the period of the plant")


def sample_free(
    impulses: Impulses,
    promises: Sequence[Promise],
    modes: tuple[Mode, ...],
    actuator: Actuator,
    sample_time_s: float,
    *,
    designed_for: Actuator | None = None,
    budget: Budget | None = None,
) -> Sampled:
    """Bring a shaper to a sample grid by amplitudes that keep all it promises.

    Parameters
    ----------
    impulses, promises
        The shaper between the samples, and what it keeps there.
    modes, actuator
        The plant's modes and the drive that is given.
    sample_time_s
        Sample time, > 0, at most half the period and the whole duration [s].
    designed_for
        The drive for which promises are kept; the one given if None.
    budget
        The work is counted in it.

    Returns
    -------
    Sampled
        The shaper on the grid, what other ways to get there leave, and its bounds.

    Raises
    ------
    InvalidInputError
        If the sample time breaks its rule, or a set of the actuator is out of proportion to the
        plant.
    InfeasibleDesignError
        If no number of samples up to the horizon keeps the promises.

    Examples
    --------
    >>> import numpy as np
    >>> from design.claims import zeros
    >>> from design.model.actuators.ideal import Ideal
    >>> zv = Impulses(times_s=np.array([0.0, 0.25]), amplitudes=np.array([0.5, 0.5]))
    >>> two_hertz = Mode(natural_frequency_rad_s=4 * np.pi)
    >>> sampled = sample_free(zv, zeros(["residual"]), (two_hertz,), Ideal(), 0.1)
    >>> sampled.samples, sampled.residual < 1e-12
    ((0, 2, 3), True)
    """
    for mode in modes:
        require_workable(mode, actuator)
    require_two_a_period(impulses, modes, sample_time_s)
    # Others first: they refuse a sample time that is out of proportion to the shaper.
    others = compared(impulses, impulses, modes, actuator, sample_time_s, method="free_amplitudes")
    certified_for = actuator if designed_for is None else designed_for
    found = free_on_samples(impulses, promises, modes, certified_for, sample_time_s, budget)
    return replace(
        others,
        impulses=found.impulses,
        residual=max(residual_vibration(found.impulses, mode, actuator) for mode in modes),
        bound=found.bound,
        shorter_bound=found.shorter_bound,
    )
