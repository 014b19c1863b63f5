"""Wire form of warnings."""

from typing import Annotated

from pydantic import Field

from design.analysis.warnings import DesignWarning
from schemas.base import OutOf


class WarningOut(OutOf[DesignWarning]):
    """Something to know of an answer that is right all the same."""

    code: Annotated[str, Field(description="A name that programs can rely on.")]
    detail: Annotated[str, Field(description="The warning in words, with its figure.")]


Warnings = Annotated[list[WarningOut], Field(description="What else to know about the answer.")]
