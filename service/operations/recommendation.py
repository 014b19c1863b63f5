"""From what is known to the fastest shaper that meets it."""

from design.recommendations.recommendation import recommend
from schemas.recommendations import RecommendationRequest, RecommendationResponse
from service.operations.operation import Operation
from service.operations.subject import subject_of
from service.version import version


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


OPERATION = Operation(
    request=RecommendationRequest, response=RecommendationResponse, run=recommend_shaper
)
