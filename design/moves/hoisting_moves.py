"""Whole moves from rest to rest while the cable is hoisted or lowered."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from design.analysis.certificate import Certificate
from design.analysis.claims_found import claims_in_words, shortfall_of
from design.analysis.drive_warnings import drive_warnings
from design.analysis.hoisting_certificate import certify_hoisting
from design.analysis.warnings import DesignWarning, actuator_ignored
from design.errors import InfeasibleDesignError, SolverFailedError
from design.formulations.gaps import settling_gaps_rad
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.hoisting import Hoisting
from design.moves.designed_parts import designed_parts
from design.moves.hoisting_times import HoistingTask, follow_times, solve_times
from design.moves.maneuvers import Maneuver, direction_of, maneuver
from design.moves.parts import Parts
from design.moves.while_hoisting import require_no_limits, require_while_hoisting
from design.response.closed_form import travel
from design.response.hoisting_vibration import hoisting_residual
from design.shapers.kind import ShaperKind
from design.shapers.options import ShaperOptions
from design.solvers.budget import Budget
from design.types import FloatArray

Retime = Literal["both", "stop"]
"""Which times are solved for the cable as it is hoisted: start and stop, or the stop alone."""

NO_RESIDUAL = 1e-9
"""Up to it a start of the first length has no residual [-]."""


def hoisting_maneuver(
    plant: Hoisting,
    actuator: Actuator,
    kind: ShaperKind,
    *,
    speed_m_s: float,
    pulse_s: float | None = None,
    distance_m: float | None = None,
    retime: Retime = "both",
    options: ShaperOptions | None = None,
    budget: Budget | None = None,
) -> Maneuver:
    """Design a move with a cable that is hoisted, and prove it as a whole.

    The hoisting is counted from the first step of the start, and is not changed by the move.

    Parameters
    ----------
    plant
        The load and the length of its cable over time.
    actuator
        What drives it, without limits to acceleration.
    kind
        Entry of the registry: a shaper of unity magnitude without residual, or without residual
        and slope.
    speed_m_s, pulse_s, distance_m
        As of `design.moves.maneuvers.maneuver`.
    retime
        With ``stop`` the start is that of the first length, and the stop cancels the rest.
    options
        Parameters of the shaper; its defaults if not given.
    budget
        What the search for the times may do; that of one design if not given.

    Returns
    -------
    Maneuver
        Its residual is the amplitude of the swing that remains on the last length, over ``v / (w
        sqrt(1 - z^2))`` with w of that length, at the last step or the end of the hoisting,
        whichever is later. Its slope is per relative change of all frequencies.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule, or the kind or the drive is not served here.
    InfeasibleDesignError
        If no such move was found; says how far the hoisting was followed.
    SolverFailedError
        If the certificate did not verify the whole.

    Examples
    --------
    >>> from design.model.actuators.ideal import Ideal
    >>> from design.model.plants.hoisting import LengthCourse
    >>> from design.shapers.registry import SHAPERS
    >>> course = LengthCourse(times_s=(0.0, 5.0), values=(0.8, 0.5))
    >>> crane = Hoisting(cable_length_m=course)
    >>> move = hoisting_maneuver(crane, Ideal(), SHAPERS["umzv"], speed_m_s=0.2, distance_m=0.8)
    >>> round(move.distance_m, 12), move.command.times_s.round(4).tolist()
    (0.8, [0.0, 0.2947, 0.5915, 4.0495, 4.2947, 4.542])
    """
    options = kind.options() if options is None else options
    require_no_limits(actuator)
    fastest = plant.shortest.mode
    direction = direction_of(fastest, speed_m_s, pulse_s, distance_m)
    first = designed_parts(plant.at(0.0), actuator, kind, options)
    require_while_hoisting("shaper.max_velocity_ratio", first.peak, "1", holds=first.peak == 1)
    budget = Budget() if budget is None else budget
    found = _Search(
        plant, actuator, kind, options, first, retime, pulse_s, distance_m, speed_m_s, budget
    )
    command, joint = found.command()
    certificate, for_ideal, warnings = _judge(command, plant, actuator, first, kind.name)
    split = (command.times_s.size // 2) | 1 if joint else first.start.times_s.size
    start, stop = (
        Impulses(times_s=command.times_s[part], amplitudes=command.amplitudes[part])
        for part in (slice(None, split), slice(split, None))
    )
    left = 0.0 if joint else hoisting_residual(start, plant, first.designed_for)
    if left > NO_RESIDUAL:
        warnings = (*warnings, _start_warning(left))
    return Maneuver(
        start=start,
        stop=stop,
        command=command,
        direction=direction,
        speed_m_s=abs(speed_m_s),
        pulse_s=float(stop.times_s[0] - start.times_s[0]),
        distance_m=direction * abs(speed_m_s) * travel(command, actuator),
        residual=hoisting_residual(command, plant, actuator),
        certificate=certificate,
        for_ideal=for_ideal,
        swing=None,
        joint=joint,
        ramps=None,
        lower_bound_s=None,
        warnings=(*warnings, *drive_warnings(command, (fastest,), actuator)),
    )


def _start_warning(residual: float) -> DesignWarning:
    return DesignWarning(
        code="start_of_first_length",
        detail="the start is that of the first length, and its residual is "
        f"{100 * residual:.3g} % of a "
        "step while the cable is hoisted: the payload swings until the stop cancels it",
    )


def _judge(
    command: Impulses, plant: Hoisting, actuator: Actuator, parts: Parts, name: str
) -> tuple[Certificate, bool, tuple[DesignWarning, ...]]:
    """Hold a move against its claims: with the drive given, or with that designed for."""
    certificate = certify_hoisting(command, plant, actuator, parts.claims)
    if certificate.verified:
        return certificate, False, ()
    failing = [claim for claim in certificate.claims if not claim.holds]
    warnings: tuple[DesignWarning, ...] = ()
    for_ideal = parts.designed_for != actuator
    if for_ideal:
        certificate = certify_hoisting(command, plant, parts.designed_for, parts.claims)
        warnings = (actuator_ignored(f"the move by {name}", claims_in_words(failing, 1)),)
    if not certificate.verified:
        raise SolverFailedError(
            f"the whole move of {name} was not verified: {shortfall_of(certificate)}",
            code="move_not_verified",
        )
    return certificate, for_ideal, warnings


@dataclass(frozen=True, slots=True, eq=False)
class _Search:
    """What is asked, and where the times are sought."""

    plant: Hoisting
    actuator: Actuator
    kind: ShaperKind
    options: ShaperOptions
    first: Parts  # Start and stop for the first length
    retime: Retime
    pulse_s: float | None
    distance_m: float | None
    speed_m_s: float
    budget: Budget

    def command(self) -> tuple[Impulses, bool]:
        """Return the steps of the move, and whether start and stop were solved as one.

        Raises
        ------
        InfeasibleDesignError
            If no times were found.
        """
        no_parts = ""
        if self.first.starts_at_once or self.first.no_stop:
            no_parts = f"; {self.first.no_stop or 'the first length has no start'}"
        elif self._pulse_s > self.first.shortest_pulse_s:
            apart = self._apart()
            if apart is not None:
                return apart, False
        command, share = self._as_one()
        if command is not None:
            return command, True
        raise InfeasibleDesignError(
            f"no times of steps on levels 0 and 1 were found by {self.kind.name} for the cable as "
            f"it is hoisted: those for one length were followed to {100 * share:.3g} % of the "
            f"hoisting{no_parts}{'; ' + self.budget.in_words if self.budget.spent else ''}",
            code="no_hoisting_move_found",
        )

    @property
    def _travel_s(self) -> float:
        if self.distance_m is not None:
            return abs(self.distance_m) / self.speed_m_s
        return (self.pulse_s or 0.0) + self.first.lead_s()

    @property
    def _pulse_s(self) -> float:
        """The pulse, or one near that of the distance [s]."""
        return self._travel_s - self.first.lead_s()

    def _task(
        self, amplitudes: FloatArray, start_steps: int, travel_s: float | None
    ) -> HoistingTask:
        return HoistingTask(
            plant=self.plant,
            drive=self.first.designed_for,
            actuator=self.actuator,
            derivatives=self.first.derivatives,
            amplitudes=amplitudes,
            start_steps=start_steps,
            travel_s=travel_s,
            budget=self.budget,
        )

    def _shortest_s(self, steps: int) -> FloatArray:
        mode, drive = self.first.mode, self.first.designed_for
        gaps = settling_gaps_rad(mode, drive, steps, settle=self.first.settle)
        return gaps / mode.natural_frequency_rad_s

    def _apart(self) -> Impulses | None:
        """Return start and stop, each solved for the cable as it is hoisted."""
        pulse_s, first = self._pulse_s, self.first
        sooner = self._parts_at(first.start.duration_s / 2) if self.retime == "both" else first
        later = self._parts_at(pulse_s + first.stop.duration_s / 2)
        sizes = first.start.times_s.size, first.stop.times_s.size
        for start, stop in ((sooner, later), (first, first)):
            if (start.start.times_s.size, stop.stop.times_s.size) != sizes:
                continue
            times = np.concatenate((start.start.times_s, pulse_s + stop.stop.times_s))
            found = self._solve_apart(times, followed=stop is first)
            if found is not None:
                return found
        return None

    def _parts_at(self, time_s: float) -> Parts:
        """Return start and stop for the length of a moment, or those for the first."""
        try:
            return designed_parts(self.plant.at(time_s), self.actuator, self.kind, self.options)
        except InfeasibleDesignError:  # the first length has both
            return self.first

    def _solve_apart(self, times_s: FloatArray, *, followed: bool) -> Impulses | None:
        starts, by_distance = self.first.start.times_s.size, self.distance_m is not None
        head = 0 if self.retime == "stop" else starts - 1
        # Unknown are the gaps of the start, the pulse if the distance sets it, those of the stop.
        gaps = np.diff(times_s)
        guess = np.concatenate((gaps[:head], times_s[starts:][:by_distance], gaps[starts:]))

        def place(unknown_s: FloatArray) -> FloatArray:
            placed = times_s.copy()
            placed[1 : head + 1] = np.cumsum(unknown_s[:head])
            if by_distance:
                placed[starts] = unknown_s[head]
            placed[starts + 1 :] = placed[starts] + np.cumsum(unknown_s[head + by_distance :])
            return placed

        amplitudes = np.concatenate((self.first.start.amplitudes, self.first.stop.amplitudes))
        task = self._task(
            amplitudes,
            starts if head else 0,
            self._travel_s if by_distance else None,
        )
        shortest = self._shortest_s(times_s.size)
        if followed:
            length_m = self.plant.cable_length_m.values[0]
            found, _ = follow_times(task, guess, place, shortest, length_m)
        else:
            found = solve_times(task, guess, place, shortest)
        return None if found is None else Impulses(times_s=place(found), amplitudes=amplitudes)

    def _as_one(self) -> tuple[Impulses | None, float]:
        """Return a move solved as one, from that of the middle length, and how far it was followed.

        Of the times that do, those nearest to the ones before: they are not the fastest.
        """
        middle = self.plant.at(self._travel_s / 2)
        frozen = maneuver(
            middle,
            self.actuator,
            self.kind,
            speed_m_s=abs(self.speed_m_s),
            distance_m=self._travel_s * abs(self.speed_m_s),
            options=self.options,
        ).command
        if not np.allclose(np.abs(frozen.amplitudes), 1.0):
            return None, 0.0
        task = self._task(frozen.amplitudes, 0, self._travel_s)

        def place(gaps_s: FloatArray) -> FloatArray:
            placed: FloatArray = np.concatenate(([0.0], np.cumsum(gaps_s)))
            return placed

        gaps, share = follow_times(
            task,
            np.diff(frozen.times_s),
            place,
            self._shortest_s(frozen.times_s.size),
            middle.cable_length_m,
        )
        if gaps is None:
            return None, share
        return Impulses(times_s=place(gaps), amplitudes=frozen.amplitudes), share
