"""From what is known to the fastest shaper that meets it."""

from typing import TYPE_CHECKING

from design.recommendations.recommendation import recommend
from schemas.recommendations import RecommendationRequest, RecommendationResponse
from service.operations.operation import Operation
from service.operations.subject import subject_of
from service.version import version

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def recommend_shaper(request: RecommendationRequest) -> RecommendationResponse:
    """Return the fastest shaper that meets what is asked, and why.

    Parameters
    ----------
    request
        The plant, the actuator and the requirements.

    Returns
    -------
    RecommendationResponse
        The shaper, and its runners-up.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule.
    InfeasibleDesignError
        If no shaper meets what is asked.
    """
    plant, actuator = subject_of(request)
    found = recommend(plant, actuator, request.to_design())
    return RecommendationResponse.from_design(found, version())


def recommendation_picture(request: RecommendationRequest) -> "Figure":
    """Draw what `recommend_shaper` returns.

    Parameters
    ----------
    request
        The plant, the actuator and the requirements.

    Returns
    -------
    Figure
        The curves of the best four, and the durations of all.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule.
    InfeasibleDesignError
        If no shaper meets what is asked.
    """
    from design.pictures.recommendation_sheet import (  # noqa: PLC0415 - matplotlib takes a second
        recommendation_sheet,
    )

    plant, actuator = subject_of(request)
    found = recommend(plant, actuator, request.to_design())
    return recommendation_sheet(plant, actuator, found, version())


OPERATION = Operation(
    request=RecommendationRequest,
    response=RecommendationResponse,
    run=recommend_shaper,
    draw=recommendation_picture,
)
