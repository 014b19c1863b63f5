"""Wire form of what it cost to bring a shaper to a sample grid."""

from typing import Annotated, Self

from pydantic import Field

from design.model.impulses import Impulses
from design.sampling.on_off_search import Searched
from design.sampling.sampled import Sampled, Tried
from schemas.base import OutOf, Wire


class TriedOut(OutOf[Tried]):
    """A command of unity magnitude that was found."""

    impulses: Annotated[int, Field(description="Number of its impulses.")]
    duration_s: Annotated[float, Field(description="Its duration [s].")]
    residual: Annotated[float, Field(description="Its residual [-].")]
    compared: Annotated[
        float,
        Field(
            description="Figure by which commands are compared: the residual, plus 0.05 |dV/d "
            "ln w| where zero slope is claimed [-]."
        ),
    ]


class SearchedOut(Wire):
    """What a search of all commands of unity magnitude on the samples proves."""

    searched_samples: Annotated[
        int, Field(description="Every command of up to so many samples was searched.")
    ]
    complete: Annotated[
        bool,
        Field(
            description="Whether those are all: of as many samples as the answer has, where that "
            "is within sample_tolerance, else of up to max_duration_periods."
        ),
    ]
    bound: Annotated[
        float,
        Field(
            description="Least figure of all commands of up to so many samples, by which those in "
            "tried are compared [-]."
        ),
    ]

    @classmethod
    def from_design(cls, searched: Searched) -> Self:
        """Wrap the design record."""
        return cls.model_construct(
            searched_samples=searched.searched, complete=searched.complete, bound=searched.bound
        )


class SampledOut(Wire):
    """What it cost to bring the shaper to a sample grid."""

    sample_time_s: Annotated[float, Field(description="Sample time of the controller [s].")]
    method: Annotated[
        str,
        Field(
            description="free_amplitudes, unity_on_grid, search_on_off or more_impulses_on_grid."
        ),
    ]
    samples: Annotated[list[int], Field(description="Sample number of each impulse.")]
    continuous_times_s: Annotated[
        list[float], Field(description="Times of the impulses before sampling [s].")
    ]
    continuous_residual: Annotated[float, Field(description="Residual before sampling [-].")]
    split_residual: Annotated[
        float | None,
        Field(
            description="Residual of the linear split, which is not of unity magnitude; null where "
            "the sample time is longer than the shaper [-]."
        ),
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
        Field(
            description="For unity magnitude: the shaper's impulses at the best samples, where "
            "each has one, then what searches with more impulses found."
        ),
    ]
    bound: Annotated[
        float | None,
        Field(
            description="What no amplitudes on as many samples can go below: the largest residual "
            "over the band that the shaper keeps between samples; 0 where only zeros are claimed; "
            "null where nothing is proven [-]."
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
    search: Annotated[
        SearchedOut | None,
        Field(description="What the search of all commands proves; null where none was needed."),
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
            search=None if sampled.searched is None else SearchedOut.from_design(sampled.searched),
            bound=sampled.bound,
            shorter_bound=sampled.shorter_bound,
        )
