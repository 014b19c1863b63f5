"""Wire form of an answer with a design."""

from typing import Annotated, Self

from pydantic import Field

from design.analysis.ramp_figures import RampFigures
from design.pipeline import Design
from schemas.base import Version, Wire, leave_out_none
from schemas.certificates import CertificateOut
from schemas.designed_shaper import ShaperOut
from schemas.drive_sensitivity import DriveOut
from schemas.fits import FitOut
from schemas.impulses import ImpulsesWire
from schemas.large_swings import OfLargeSwing, large_swing_of
from schemas.ramps import LimitsOut, OfLimits, UnshapedRampResidual
from schemas.ranges import RangeOut
from schemas.sampled import SampledOut
from schemas.sensitivity import ModeOut, OfModes
from schemas.sensitivity_curves import SensitivityOut
from schemas.solver import SolverOut
from schemas.trace import TraceStepOut
from schemas.warnings import WarningOut, Warnings


class DesignResponse(Wire):
    """Answer of `POST /v1/designs`."""

    shaper: Annotated[ShaperOut, Field(description="The shaper and its duration.")]
    sampled: Annotated[
        SampledOut | None,
        Field(
            description="With sample_time_s, the result of sampling: the certificate then "
            "proves its residual."
        ),
    ]
    residual: Annotated[
        float,
        Field(
            description="Residual vibration with the plant and actuator given, a share of an "
            "unshaped step; of several modes the largest [-]."
        ),
    ]
    unshaped_ramp_residual: UnshapedRampResidual
    limits: OfLimits
    certificate: Annotated[CertificateOut, Field(description="Promises of the shaper, recomputed.")]
    sensitivity: Annotated[SensitivityOut | None, Field(description="Its curve, or null.")]
    drive: Annotated[DriveOut | None, leave_out_none("Residual where the drive is off, if asked.")]
    modes: OfModes
    scheduled: Annotated[
        RangeOut | None,
        leave_out_none("Figures over the range of a scheduled plant; otherwise left out."),
    ]
    large_swing: OfLargeSwing
    fit: Annotated[FitOut | None, Field(description="Its curve coefficients, or null.")]
    solver: SolverOut
    trace: Annotated[
        list[TraceStepOut] | None,
        leave_out_none("Steps of the search, where asked for; otherwise left out."),
    ]
    warnings: Warnings
    version: Version

    @classmethod
    def from_design(
        cls,
        kind: str,
        design: Design,
        ramps: RampFigures | None,
        sampled: SampledOut | None,
        sensitivity: SensitivityOut | None,
        drive: DriveOut | None,
        modes: list[ModeOut] | None,
        scheduled: RangeOut | None,
        fit: FitOut | None,
        trace: list[TraceStepOut] | None,
        version: str,
    ) -> Self:
        """Wrap the design records.

        Parameters
        ----------
        kind, design
            Name of the kind; the shaper that is sent, on samples where they were asked for.
        ramps, sampled, sensitivity, drive, modes, scheduled, fit, trace
            Each part that was asked for; None where it was not.
        version
            Of the tool.

        Returns
        -------
        Self
            Without what is None.
        """
        return cls.model_construct(
            shaper=ShaperOut.model_construct(
                kind=kind,
                impulses=ImpulsesWire.from_design(design.impulses),
                duration_s=design.impulses.duration_s,
                ramp_end_s=None if ramps is None else ramps.end_s,
            ),
            sampled=sampled,
            residual=design.residual,
            unshaped_ramp_residual=None if ramps is None else ramps.unshaped_residual,
            limits=None if ramps is None else LimitsOut.from_design(ramps),
            certificate=CertificateOut.from_design(design.certificate, given=not design.for_ideal),
            sensitivity=sensitivity,
            drive=drive,
            modes=modes,
            scheduled=scheduled,
            large_swing=design.large_swing and large_swing_of(design.large_swing),
            fit=fit,
            solver=SolverOut.from_design(design.solver),
            trace=trace,
            warnings=[WarningOut.from_design(warning) for warning in design.warnings],
            version=version,
        )
