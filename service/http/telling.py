"""Problems on the way to an answer, raised where they are known and told in one place."""

import functools
from collections.abc import Awaitable, Callable, Mapping
from typing import Any

from starlette.requests import Request
from starlette.responses import Response

from service.http.bodies import BodyError, problem_response
from service.jobs.asking import UnansweredError
from service.problems import OVERLOADED, Problem
from service.workers.runs import TaskError


class ProblemError(Exception):
    """A problem, with headers that its answer should have."""

    def __init__(self, problem: Problem, headers: Mapping[str, str] | None = None) -> None:
        super().__init__(problem.detail)
        self.problem = problem
        self.headers = headers or {}


Route = Callable[..., Awaitable[Response]]


def telling(route: Route) -> Route:
    """Return a route that answers what is raised in it by a problem document."""

    @functools.wraps(route)
    async def answered(request: Request, **named: Any) -> Response:  # noqa: ANN401
        request_id: str = request.state.request_id
        try:
            return await route(request, **named)
        except UnansweredError as error:
            return problem_response(Problem(OVERLOADED, str(error)), request_id)
        except ProblemError as error:
            response = problem_response(error.problem, request_id)
            response.headers.update(error.headers)
            return response
        except (BodyError, TaskError) as error:
            return problem_response(error.problem, request_id)

    return answered
