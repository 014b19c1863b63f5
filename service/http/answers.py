"""Answers and problems as responses, and as lines of a batch."""

from starlette.responses import Response

from service.dispatch import Answer
from service.problems import Problem


def problem_response(problem: Problem, request_id: str | None) -> Response:
    """Return a problem as the response.

    Parameters
    ----------
    problem
        The problem.
    request_id
        Id of the request, which the document repeats; None for none.

    Returns
    -------
    Response
        A problem document with the status and headers of the problem.
    """
    return Response(
        problem.document(request_id).model_dump_json(),
        status_code=problem.kind.http.value,
        media_type="application/problem+json",
        headers=problem.headers,
    )


def answer_response(answer: Answer, request_id: str | None) -> Response:
    """Return an answer as the response.

    Parameters
    ----------
    answer
        The response of an operation, or a problem.
    request_id
        Id of the request, which a problem document repeats; None for none.

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


def answer_line(answer: Answer, request_id: str | None) -> bytes:
    """Return an answer as one line of a batch.

    Parameters
    ----------
    answer
        The response of an operation, or a problem.
    request_id
        Id of the request, which a problem document repeats; None for none.

    Returns
    -------
    bytes
        JSON without the end of the line.
    """
    if isinstance(answer.outcome, Problem):
        return answer.outcome.document(request_id).model_dump_json().encode()
    return answer.outcome
