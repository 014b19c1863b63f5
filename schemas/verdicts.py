"""Wire form of a requirement, held against a shaper."""

import math
from typing import Annotated, Self

from pydantic import Field

from design.recommendations.judging import Verdict
from schemas.base import Wire


def finite_or_none(value: float | None) -> float | None:
    """Return a number that JSON knows: none for one without bound."""
    return value if value is None or math.isfinite(value) else None


class VerdictOut(Wire):
    """One requirement, and whether a shaper meets it."""

    requirement: Annotated[str, Field(description="Field of the request.")]
    met: Annotated[bool, Field(description="Whether the shaper meets it.")]
    value: Annotated[
        float | None,
        Field(
            description="Figure that is held against the limit, in the field's unit; null for "
            "a sign, and where there is no bound."
        ),
    ]
    limit: Annotated[
        float | None,
        Field(description="Limit of the request, in the field's unit; null for a sign."),
    ]
    reason: Annotated[str, Field(description="Verdict in words.")]

    @classmethod
    def from_design(cls, verdict: Verdict) -> Self:
        """Wrap the design record."""
        return cls.model_construct(
            requirement=verdict.requirement,
            met=verdict.met,
            value=finite_or_none(verdict.value),
            limit=verdict.limit,
            reason=verdict.reason,
        )
