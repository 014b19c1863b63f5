"""Wire form of what it cost to bring a shaper to a sample grid."""

from typing import Annotated, Self

from pydantic import Field

from design.model.impulses import Impulses
from design.sampling.sampled import Sampled, Tried
from schemas.base import OutOf, Wire


class TriedOut(OutOf[Tried]):
    """The best command of unity magnitude with one number of impulses."""

    impulses: int
    duration_s: float
    residual: float
    compared: Annotated[
        float,
        Field(
            description="Figure by which commands are compared: the residual, plus 0.05 |dV/d "
            "ln w| where zero slope is claimed [-]."
        ),
    ]


class SampledOut(Wire):
    """What it cost to bring the shaper to a sample grid."""

    sample_time_s: float
    method: Annotated[
        str,
        Field(description="free_amplitudes, unity_on_grid or more_impulses_on_grid."),
    ]
    samples: Annotated[list[int], Field(description="Sample number of each impulse.")]
    continuous_times_s: Annotated[
        list[float], Field(description="Times of the impulses before sampling [s].")
    ]
    continuous_residual: Annotated[float, Field(description="Residual before sampling [-].")]
    split_residual: Annotated[
        float,
        Field(description="Residual of the linear split, which is not of unity magnitude [-]."),
    ]
    nearest_residual: Annotated[
        float | None,
        Field(description="Residual of nearest samples; null where two impulses coincide [-]."),
    ]
    carried_residual: Annotated[
        float | None,
        Field(
            description="Residual with rounding errors carried on; null where two impulses "
            "coincide [-]."
        ),
    ]
    tried: Annotated[
        list[TriedOut],
        Field(description="For unity magnitude: the best command of each number of impulses."),
    ]
    bound: Annotated[
        float | None,
        Field(
            description="What no amplitudes on as many samples can go below: the largest residual "
            "over the band; 0 where only zeros are claimed; null where nothing is proven [-]."
        ),
    ]
    shorter_bound: Annotated[
        float | None,
        Field(
            description="The same of one sample less; where only zeros are claimed, of the largest "
            "of the residual and what makes it grow, to each order claimed, at 5 % of error in "
            "frequency [-]."
        ),
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
            Both, with their residuals.
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
            tried=[TriedOut.from_design(one) for one in sampled.tried],
            bound=sampled.bound,
            shorter_bound=sampled.shorter_bound,
        )
