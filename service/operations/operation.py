"""What an operation is: a request, a response, and the function between them."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel

from schemas.base import Wire

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True, kw_only=True)
class Operation:
    """A use case that takes a body.

    Attributes
    ----------
    request
        Model of the body.
    response
        Model of the answer.
    run
        From the one to the other.
    draw
        From a request to a figure of the answer.
    """

    request: type[Wire]
    response: type[Wire]
    run: Callable[[Any], BaseModel]
    draw: "Callable[[Any], Figure]"
