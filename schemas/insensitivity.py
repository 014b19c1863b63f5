"""Wire form of the interval around 1 on which a residual is within a tolerance."""

from typing import Annotated

from pydantic import Field

from design.analysis.insensitivity import Insensitivity
from schemas.base import OutOf


class InsensitivityOut(OutOf[Insensitivity]):
    """The interval around 1 on which the residual is within the tolerance."""

    tolerance: Annotated[float, Field(description="Residual at the edges of the interval [-].")]
    lower_ratio: Annotated[
        float | None, Field(description="Lower edge; null where the search found none [-].")
    ]
    upper_ratio: Annotated[
        float | None, Field(description="Upper edge; null where the search found none [-].")
    ]
    width: Annotated[
        float | None, Field(description="Upper edge less lower edge; null where either is [-].")
    ]
    searched_from_ratio: Annotated[
        float,
        Field(
            description="Lower end of what is known to be within the tolerance: the edge, or "
            "where the search for it ended [-]."
        ),
    ]
    searched_to_ratio: Annotated[float, Field(description="Upper end of the same [-].")]
