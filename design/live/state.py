"""What live shaping knows at a moment: drive, modes and the rest of the plan of each axis."""

from dataclasses import dataclass, replace

import numpy as np

from design.live.kernel import OF_MODE
from design.live.machine import LiveKind
from design.types import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """Switches of a command that are still to come.

    Attributes
    ----------
    times_s
        When each is commanded, ascending; a dead time later the drive answers [s].
    levels
        Level of the command from each on, signed [-].
    fallback
        Why this is an older plan than the event asked for, or what of it is not kept; None where it
        is its own.
    swing_left
        What may swing after it, over an unshaped step's swing: an emergency stop's [-].
    rests_s
        When no more than that swings; None if that is after the last switch [s].
    """

    times_s: tuple[float, ...] = ()
    levels: tuple[float, ...] = ()
    fallback: str | None = None
    swing_left: float = 0.0
    rests_s: float | None = None

    def __add__(self, later: "Plan") -> "Plan":
        """Return both in one."""
        return Plan(times_s=self.times_s + later.times_s, levels=self.levels + later.levels)

    def then(self, later: "Plan", now_s: float) -> "Plan":
        """Return what was sent and a plan made for its end, both in one.

        Parameters
        ----------
        later
            The plan; its first switch may be now.
        now_s
            The moment [s].

        Returns
        -------
        Plan
            Its own switches not before now, which the sum of dead times may be by rounding.
        """
        times = tuple(max(time_s, now_s) for time_s in later.times_s)
        return replace(later, times_s=self.times_s + times, levels=self.levels + later.levels)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AxisState:
    """State of one axis, as the drive has answered until a moment.

    Attributes
    ----------
    time_s
        The moment [s].
    level
        Of the command that the drive follows, signed [-].
    target
        What was asked for last: where the plan ends [-].
    force
        The set in force: 0 accelerates, 1 decelerates.
    lag
        Error of the velocity against the command and rate of the velocity, shape (2, 2): row 0 of
        a switched drive, else a row for each set [-], [1/s].
    rings
        Modal coordinates, shape (n, 4): real and imaginary part, with what the lags will still
        leave added, and those of the derivative over the logarithm of the frequency [-].
    ideal_rings
        The same as if the drive were ideal.
    plan
        Switches still to come.
    kind
        What the plan was solved for.
    """

    time_s: float
    level: float
    target: float
    force: int
    lag: FloatArray
    rings: FloatArray
    ideal_rings: FloatArray
    plan: Plan
    kind: LiveKind

    @property
    def vibration(self) -> tuple[complex, ...]:
        """Modal coordinate of each mode; an ideal unit step adds 1 to it [-]."""
        return tuple(complex(*one) for one in self.rings[:, :2].tolist())

    @property
    def slope(self) -> tuple[complex, ...]:
        """Derivative of each over the logarithm of its frequency [-]."""
        return tuple(complex(*one) for one in self.rings[:, 2:].tolist())


def at_rest(modes: int, kind: LiveKind) -> AxisState:
    """Return an axis at rest at time 0.

    Parameters
    ----------
    modes
        How many modes swing under it.
    kind
        What its plans are solved for.

    Returns
    -------
    AxisState
        Without a plan.
    """
    return AxisState(
        time_s=0.0,
        level=0.0,
        target=0.0,
        force=0,
        lag=np.zeros((2, 2)),
        rings=np.zeros((modes, OF_MODE)),
        ideal_rings=np.zeros((modes, OF_MODE)),
        plan=Plan(),
        kind=kind,
    )
