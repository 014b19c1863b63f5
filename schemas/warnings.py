"""Wire form of warnings."""

from typing import Annotated, Self

from pydantic import Field

from design.analysis.warnings import DesignWarning
from schemas.base import Wire


class WarningOut(Wire):
    """Something to know about an answer that is nevertheless right."""

    code: Annotated[str, Field(description="A name that programs can rely on.")]
    detail: Annotated[str, Field(description="The warning in words, with its figure.")]

    @classmethod
    def from_design(cls, warning: DesignWarning) -> Self:
        """Wrap the design record."""
        return cls.model_construct(code=warning.code, detail=warning.detail)


Warnings = Annotated[list[WarningOut], Field(description="What else to know about the answer.")]
