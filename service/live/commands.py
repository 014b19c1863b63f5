"""What becomes of buttons: the switches that are still to come, by each mode of shaping."""

from dataclasses import dataclass, replace
from typing import NamedTuple

from design.analysis.certificate import Certificate
from design.live.emergency_request import EmergencyRequest
from design.live.hoist import HoistRequest
from design.live.machine import LiveKind, LiveMachine
from design.live.session import LiveState, Press, event
from design.model.impulses import Impulses
from design.rig.crane import AXES, AxisName

SAME_LEVEL = 1e-12
"""Within it two levels are one: rounding of their sum [-]."""


class Switch(NamedTuple):
    """A level of an axis from a time on."""

    at_s: float
    axis: AxisName
    level: float


class Planned(NamedTuple):
    """The switches that an event has led to, from its own time on, and what is claimed of them."""

    switches: tuple[Switch, ...]
    certificate: Certificate | None = None
    ideal: bool = False  # Whether the claims are of an ideal drive
    fallback: str | None = None


@dataclass(frozen=True, slots=True)
class Convolved:
    """Commands that pass a delay line; of one impulse at once they pass unchanged.

    Attributes
    ----------
    shaper
        What each change is convolved with.
    targets
        Levels that are asked for, of x and y [-].
    levels
        Levels that are commanded [-].
    coming
        Changes of levels that are still to come, in order of time.
    """

    shaper: Impulses
    targets: tuple[float, float] = (0.0, 0.0)
    levels: tuple[float, float] = (0.0, 0.0)
    coming: tuple[Switch, ...] = ()

    def pressed(self, at_s: float, press: Press) -> tuple["Convolved", Planned]:
        """Return the commands after buttons, and what is to come.

        Parameters
        ----------
        at_s
            When they are pressed, not before the event before [s].
        press
            The levels asked for.

        Returns
        -------
        tuple of Convolved and Planned
            As they are then.
        """
        levels, targets, coming = list(self.levels), list(self.targets), []
        for one in self.coming:
            if one.at_s < at_s:
                levels[AXES.index(one.axis)] += one.level
            else:
                coming.append(one)
        for which, (axis, level) in enumerate(zip(AXES, (press.x, press.y), strict=True)):
            if level is None or level == targets[which]:
                continue
            times, shares = self.shaper.times_s.tolist(), self.shaper.amplitudes.tolist()
            coming += [
                Switch(at_s + time_s, axis, share * (level - targets[which]))
                for time_s, share in zip(times, shares, strict=True)
            ]
            targets[which] = level
        coming.sort()
        after = replace(
            self,
            targets=(targets[0], targets[1]),
            levels=(levels[0], levels[1]),
            coming=tuple(coming),
        )
        return after, Planned(after._switches())

    def _switches(self) -> tuple[Switch, ...]:
        levels, made = list(self.levels), []
        for one in self.coming:
            which = AXES.index(one.axis)
            levels[which] += one.level
            if abs(levels[which]) <= SAME_LEVEL:
                levels[which] = 0.0
            made.append(one._replace(level=levels[which]))
        return tuple(made)


@dataclass(frozen=True, slots=True)
class Resolved:
    """Commands that are solved anew at each event."""

    machine: LiveMachine
    state: LiveState

    def pressed(
        self, at_s: float, press: Press | EmergencyRequest | HoistRequest | LiveKind
    ) -> tuple["Resolved", Planned]:
        """Return the commands after buttons, and what is to come.

        Parameters
        ----------
        at_s
            When they are pressed, not before the event before [s].
        press
            The levels asked for, an emergency stop, another length of the cable, or another kind.

        Returns
        -------
        tuple of Resolved and Planned
            As they are then.

        Raises
        ------
        InvalidInputError
            If the event comes faster than the sample time, or finds a swing beyond the model.
        """
        state = event(self.machine, self.state, at_s, press)
        switches = [
            Switch(time_s, axis, level)
            for axis, of in zip(AXES, (state.x, state.y), strict=True)
            for time_s, level in zip(of.plan.times_s, of.plan.levels, strict=True)
            if time_s >= at_s
        ]
        planned = Planned(
            tuple(sorted(switches)), state.certificate, state.kind.ideal, state.fallback
        )
        return replace(self, state=state), planned


Commands = Convolved | Resolved
