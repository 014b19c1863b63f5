"""Wire form of a design, in and out."""

from typing import Annotated, Literal, Self

from pydantic import Field

from design.analysis.certificate import Certificate, Claim
from design.model.impulses import Impulses
from design.model.plants.registry import Plant
from design.model.plants.scheduled import Scheduled
from design.pipeline import Design
from design.sampling.sampled import Sampled
from schemas.actuators import ActuatorIn
from schemas.base import Wire, leave_out_none
from schemas.fits import FitIn, FitOut
from schemas.impulses import ImpulsesWire
from schemas.plants import PlantIn
from schemas.sensitivity import ModeOut, OfModes, SensitivityIn, SensitivityOut
from schemas.shapers import ShaperIn
from schemas.trace import TraceStepOut
from schemas.warnings import WarningOut, Warnings


def _is_false(value: object) -> bool:
    return value is False


class DesignRequest(Wire):
    """Body of `POST /v1/designs`."""

    plant: PlantIn
    actuator: ActuatorIn
    shaper: ShaperIn
    sensitivity: Annotated[
        SensitivityIn | None, Field(description="Range of the curve; null for no curve.")
    ] = SensitivityIn()
    fit: Annotated[FitIn | None, Field(description="Curve coefficients with the design.")] = None
    trace: Annotated[
        bool,
        Field(
            description="Report each step of the search, and what was rejected and why; of a "
            "refusal too.",
            exclude_if=_is_false,
        ),
    ] = False


class ShaperOut(Wire):
    """The shaper."""

    kind: str
    impulses: ImpulsesWire
    duration_s: Annotated[float, Field(description="Time that it adds to a move [s].")]


class TriedOut(Wire):
    """The best command of unity magnitude with one number of impulses."""

    impulses: int
    duration_s: float
    residual: float
    compared: Annotated[
        float,
        Field(description="Residual, and where zero slope is claimed 0.05 |dV/d ln w| more [-]."),
    ]


class SampledOut(Wire):
    """What it cost to bring the shaper to a sample grid."""

    sample_time_s: float
    method: Annotated[
        str,
        Field(description="split, exact_positive, unity_on_grid or more_impulses_on_grid."),
    ]
    samples: Annotated[list[int], Field(description="Sample number of each impulse.")]
    continuous_times_s: Annotated[list[float], Field(description="Before [s].")]
    continuous_residual: Annotated[float, Field(description="Left before, likewise [-].")]
    split_residual: Annotated[
        float, Field(description="Left by the linear split, which is not of unity magnitude [-].")
    ]
    nearest_residual: Annotated[
        float | None, Field(description="Left by nearest samples; null where two coincide [-].")
    ]
    carried_residual: Annotated[
        float | None,
        Field(description="Left with rounding errors carried on; null likewise [-]."),
    ]
    tried: Annotated[
        list[TriedOut],
        Field(description="For amplitudes of both signs, the best of each number of impulses."),
    ]

    @classmethod
    def from_design(cls, sampled: Sampled, continuous: Impulses) -> Self:
        """Wrap the design records.

        Parameters
        ----------
        sampled
            The shaper on samples.
        continuous
            The same between them.

        Returns
        -------
        Self
            Both, with what each leaves.
        """
        return cls.model_construct(
            sample_time_s=sampled.sample_time_s,
            method=sampled.method,
            samples=list(sampled.samples),
            continuous_times_s=continuous.times_s.tolist(),
            continuous_residual=sampled.continuous_residual,
            split_residual=sampled.split_residual,
            nearest_residual=sampled.nearest_residual,
            carried_residual=sampled.carried_residual,
            tried=[
                TriedOut.model_construct(
                    impulses=one.impulses,
                    duration_s=one.duration_s,
                    residual=one.residual,
                    compared=one.compared,
                )
                for one in sampled.tried
            ],
        )


class ClaimOut(Wire):
    """One promise of the shaper, recomputed."""

    quantity: str
    value: float
    limit: float
    mode: Annotated[
        int | None,
        leave_out_none("Number of the plant's mode, from 0; left out for the first."),
    ]
    band: Annotated[
        tuple[float, float] | None,
        leave_out_none("For band: its ends, ratios of the mode's frequency; left out else."),
    ]

    @classmethod
    def from_design(cls, claim: Claim) -> Self:
        """Wrap the design record."""
        return cls.model_construct(
            quantity=claim.quantity,
            value=claim.value,
            limit=claim.limit,
            mode=claim.mode or None,
            band=claim.band,
        )


class CertificateOut(Wire):
    """What the shaper claims, recomputed by a route without its solver."""

    verified: bool
    method: str
    actuator: Annotated[
        Literal["given", "ideal"],
        Field(
            description="What the claims are for: the actuator given, or one that follows its "
            "command at once."
        ),
    ]
    claims: list[ClaimOut]

    @classmethod
    def from_design(cls, certificate: Certificate, *, given: bool) -> Self:
        """Wrap the design record.

        Parameters
        ----------
        certificate
            The claims, recomputed.
        given
            Whether they are so for the actuator given; else for an ideal one.

        Returns
        -------
        Self
            All claims in their order.
        """
        return cls.model_construct(
            verified=certificate.verified,
            method=certificate.method,
            actuator="given" if given else "ideal",
            claims=[ClaimOut.from_design(claim) for claim in certificate.claims],
        )


class SolverOut(Wire):
    """How the impulses were found."""

    name: str
    status: str
    iterations: int
    seed: str
    starts: int
    lower_bound_s: Annotated[
        float | None,
        Field(description="No shaper of its class is as short; null where nothing is proven [s]."),
    ]
    gap: Annotated[
        float | None,
        Field(description="(duration - lower bound) / duration; null likewise [-]."),
    ]


class RangeOut(Wire):
    """What a shaper does over the range of a scheduled plant."""

    natural_frequency_rad_s: Annotated[
        float, Field(description="Middle of the range, for which the shaper is designed [rad/s].")
    ]
    lower_ratio: Annotated[float, Field(description="Lowest frequency over the middle one [-].")]
    upper_ratio: Annotated[float, Field(description="Highest frequency over the middle one [-].")]
    worst_residual: Annotated[
        float, Field(description="Largest residual in the range, with the actuator given [-].")
    ]

    @classmethod
    def from_design(cls, plant: Plant, design: Design) -> Self | None:
        """Wrap the design records.

        Parameters
        ----------
        plant
            The plant of the request.
        design
            Its design.

        Returns
        -------
        Self or None
            None for a plant that is not scheduled.
        """
        if not isinstance(plant, Scheduled) or design.worst_in_range is None:
            return None
        low, high = plant.band
        return cls.model_construct(
            natural_frequency_rad_s=plant.middle.natural_frequency_rad_s,
            lower_ratio=low,
            upper_ratio=high,
            worst_residual=design.worst_in_range,
        )


class DesignResponse(Wire):
    """Answer of `POST /v1/designs`."""

    shaper: ShaperOut
    sampled: Annotated[
        SampledOut | None,
        Field(description="With sample_time_s: the certificate then proves the residual told."),
    ]
    residual: Annotated[
        float,
        Field(
            description="Left with the plant and actuator given, share of an unshaped step; of "
            "several modes the most [-]."
        ),
    ]
    certificate: CertificateOut
    sensitivity: SensitivityOut | None
    modes: OfModes
    scheduled: Annotated[RangeOut | None, leave_out_none("Of a scheduled plant; left out else.")]
    fit: FitOut | None
    solver: SolverOut
    trace: Annotated[
        list[TraceStepOut] | None,
        leave_out_none("Steps of the search, where asked for; left out else."),
    ]
    warnings: Warnings
    version: str

    @classmethod
    def from_design(
        cls,
        kind: str,
        design: Design,
        sampled: SampledOut | None,
        sensitivity: SensitivityOut | None,
        modes: list[ModeOut] | None,
        scheduled: RangeOut | None,
        fit: FitOut | None,
        trace: list[TraceStepOut] | None,
        version: str,
    ) -> Self:
        """Wrap the design records.

        Parameters
        ----------
        kind
            Name of the kind of shaper.
        design
            The shaper that is sent: on samples where they were asked for.
        sampled
            How it came to the samples.
        sensitivity
            Its curve.
        modes
            What it does to each of several modes.
        scheduled
            What it does over the range of a scheduled plant.
        fit
            Polynomials for its times.
        trace
            The steps of the search.
        version
            Of the tool.

        Returns
        -------
        Self
            Without what is None.
        """
        solver = design.solver
        return cls.model_construct(
            shaper=ShaperOut.model_construct(
                kind=kind,
                impulses=ImpulsesWire.from_design(design.impulses),
                duration_s=design.impulses.duration_s,
            ),
            sampled=sampled,
            residual=design.residual,
            certificate=CertificateOut.from_design(design.certificate, given=not design.for_ideal),
            sensitivity=sensitivity,
            modes=modes,
            scheduled=scheduled,
            fit=fit,
            solver=SolverOut.model_construct(
                name=solver.name,
                status=solver.status,
                iterations=solver.iterations,
                seed=solver.seed,
                starts=solver.starts,
                lower_bound_s=solver.lower_bound_s,
                gap=solver.gap,
            ),
            trace=trace,
            warnings=[WarningOut.from_design(warning) for warning in design.warnings],
            version=version,
        )
