"""Answers and problems as responses, and as lines of a batch."""

from starlette.responses import Response

from service.dispatch import Answer
from service.http.handlers import problem_response
from service.problems import Problem


def answer_response(answer: Answer, request_id: str | None) -> Response:
    """Return an answer as the response.

    Parameters
    ----------
    answer, request_id
        The response of an operation, or a problem; id of the request, which a problem repeats.

    Returns
    -------
    Response
        JSON, with the time of the work in the ``Server-Timing`` header [ms].
    """
    if isinstance(answer.outcome, Problem):
        response = problem_response(answer.outcome, request_id)
    else:
        response = Response(answer.outcome, media_type="application/json")
    response.headers["server-timing"] = f"work;dur={1e3 * answer.seconds:.3f}"
    return response
