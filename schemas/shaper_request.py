"""What requests say of a shaper: its kind, its parameters, its samples."""

import dataclasses
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from design.errors import InvalidInputError
from design.sampling.sampled_design import SAMPLE_TOLERANCE
from design.shapers.kind import ShaperKind
from design.shapers.registry import SHAPERS
from schemas.base import Positive, Wire


class ShaperRequest(Wire):
    """A kind of shaper with its parameters."""

    if TYPE_CHECKING:
        kind: str

    sample_time_s: Annotated[
        Positive | None,
        Field(
            description="Sample time of a controller, to whose samples the impulses are "
            "brought [s]."
        ),
    ] = None
    sample_tolerance: Annotated[
        float | None,
        Field(
            ge=0,
            le=1,
            description="With sample_time_s: for a shaper of unity magnitude with a larger "
            "residual (slope counted where zero slope is claimed) the shortest command "
            f"within it is searched; {SAMPLE_TOLERANCE} if not given. None is searched "
            "with settle, whose gaps it would break [-].",
        ),
    ] = None

    def shaper_kind(self) -> ShaperKind:
        """Return the registry's entry."""
        return SHAPERS[self.kind]

    def options(self) -> Any:  # noqa: ANN401 - each kind has a separate record
        """Build the record of the kind's parameters.

        Returns
        -------
        Any
            The kind's own options.

        Raises
        ------
        InvalidInputError
            If a parameter breaks its rule, or a sample tolerance is given without a sample time.
        """
        if self.sample_tolerance is not None and self.sample_time_s is None:
            raise InvalidInputError(
                "sample_tolerance",
                self.sample_tolerance,
                "left out without sample_time_s",
                code="tolerance_without_samples",
            )
        names = [field.name for field in dataclasses.fields(self.shaper_kind().options)]
        return self.shaper_kind().options(**{name: getattr(self, name) for name in names})
