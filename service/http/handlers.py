"""What is raised on the way to an answer, answered by a problem document."""

from http import HTTPStatus

from fastapi import FastAPI, Request
from starlette.exceptions import HTTPException
from starlette.responses import Response
from starlette.types import Send

from service.problems import METHOD_NOT_ALLOWED, NOT_FOUND, Problem, ProblemError, ProblemKind


def add_handlers(app: FastAPI) -> None:
    """Have an app answer errors with problem documents.

    The errors are the problems that its routes raise, and what the framework refuses.
    """
    # Starlette calls a handler with errors of its type alone.
    app.add_exception_handler(ProblemError, _answer_problem)  # type: ignore[arg-type]
    app.add_exception_handler(HTTPException, _answer_refusal)  # type: ignore[arg-type]


async def _answer_problem(request: Request, error: ProblemError) -> Response:
    response = problem_response(error.problem, request.state.request_id)
    response.headers.update(error.headers)
    return response


async def _answer_refusal(request: Request, error: HTTPException) -> Response:
    """Answer what the framework itself refuses, as 404 and 405."""
    known: dict[int, tuple[ProblemKind, str]] = {
        404: (NOT_FOUND, f"there is no {request.url.path}"),
        405: (METHOD_NOT_ALLOWED, f"{request.url.path} does not take {request.method}"),
    }
    headers = dict(error.headers or {})
    if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED and (methods := _methods_of(request)):
        headers["Allow"] = methods
    refused = ProblemKind("refused", HTTPStatus(error.status_code), 1, "The request was refused")
    kind, detail = known.get(error.status_code, (refused, str(error)))
    return await _answer_problem(request, ProblemError(Problem(kind, detail), headers))


def _methods_of(request: Request) -> str:
    """Return the documented methods of the path; the framework names those of one route alone."""
    path = getattr(request.scope.get("route"), "path", "")
    item = request.app.openapi()["paths"].get(path, {})
    return ", ".join(method.upper() for method in sorted(item))


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


async def send_problem(problem: Problem, request_id: str, send: Send) -> None:
    """Send a problem as the response, without the framework.

    Parameters
    ----------
    problem, request_id, send
        The problem, the id of the request, and where ASGI takes the messages.
    """
    body = problem.document(request_id).model_dump_json().encode()
    headers = [
        (b"content-type", b"application/problem+json"),
        (b"content-length", str(len(body)).encode()),
    ]
    headers += [(name.encode(), value.encode()) for name, value in problem.headers.items()]
    await send({
        "type": "http.response.start",
        "status": problem.kind.http.value,
        "headers": headers,
    })
    await send({"type": "http.response.body", "body": body})
