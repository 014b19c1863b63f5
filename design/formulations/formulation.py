"""A shaper design as data: what formulations say and solvers read."""

from dataclasses import dataclass, replace
from typing import Literal

from design.claims import Promise, Quantity
from design.formulations.bands import BandProblem, BandSearch
from design.formulations.equations import GapProblem
from design.formulations.large_swing import LargeSwingProblem
from design.formulations.ramped import RampedProblem
from design.formulations.ramped_band import RampedBandProblem
from design.formulations.ramped_humps import RampedHumpsProblem
from design.formulations.steps_for_modes import StepsProblem
from design.formulations.unequal_band import UnequalBandProblem
from design.formulations.unequal_humps import UnequalHumpsProblem
from design.formulations.unequal_ramps import UnequalRampsProblem
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.types import ComplexArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ClosedForm:
    """A shaper that needs no search.

    Attributes
    ----------
    impulses
        The shaper.
    designed_for
        The actuator of the claims.
    claims
        What the impulses keep; none stands for the claims of the kind, each at its zero.
    method
        ``closed_form``, or ``newton`` for equations followed from one.
    """

    impulses: Impulses
    designed_for: Actuator
    claims: tuple[Promise, ...] = ()
    method: Literal["closed_form", "newton"] = "closed_form"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class JointProblem:
    """The fastest shaper without residual in any of several modes.

    Attributes
    ----------
    unit_poles
        Poles of the modes over the lowest natural frequency, shape (m,).
    natural_frequency_rad_s
        That frequency: it turns phases into times [rad/s].
    positive
        Whether amplitudes are positive; else the command is anywhere from 0 to 1.
    designed_for
        The actuator of the claims.
    claims
        None: no residual in any mode.
    """

    unit_poles: ComplexArray
    natural_frequency_rad_s: float
    positive: bool
    designed_for: Actuator
    claims: tuple[Promise, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Convolution:
    """A shaper for each mode, each shaping the steps of the one before.

    Attributes
    ----------
    parts
        Formulations of them, in the order of the modes.
    zeros_of_parts
        What a part that claims nothing itself keeps at zero.
    designed_for
        The actuator of the claims.
    """

    parts: tuple["Formulation", ...]
    zeros_of_parts: tuple[Quantity, ...]
    designed_for: Actuator

    @property
    def claims(self) -> tuple[Promise, ...]:
        """What the parts keep, each in its own mode; none for zeros."""
        return tuple(
            replace(promise, mode=number)
            for number, part in enumerate(self.parts)
            for promise in part.claims
        )


Formulation = (
    ClosedForm
    | GapProblem
    | BandProblem
    | BandSearch
    | JointProblem
    | StepsProblem
    | LargeSwingProblem
    | RampedProblem
    | RampedBandProblem
    | RampedHumpsProblem
    | UnequalRampsProblem
    | UnequalBandProblem
    | UnequalHumpsProblem
    | Convolution
)
