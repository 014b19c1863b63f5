"""The same calls over HTTP, with nothing but the standard library and the wire models."""

import http.client
import urllib.error
import urllib.request
from typing import TypeVar

from pydantic import ValidationError

from schemas.problems import ProblemDocument
from service.operations.table import TABLE
from service.problems import Problem
from shapersmith.calls import Calls
from shapersmith.errors import STRANGE_ANSWER, UNREACHABLE, raise_problem
from shapersmith.results import Result

Answered = TypeVar("Answered", bound=Result)


class Client(Calls):
    """The same calls over HTTP: a service computes them, no solver is imported here.

    Parameters
    ----------
    url
        Address of the service, as ``http://127.0.0.1:8000``.
    timeout_s
        Longest silence of the service [s].
    """

    def __init__(self, url: str, *, timeout_s: float = 60.0) -> None:
        self.url = url.rstrip("/")
        self.timeout_s = timeout_s

    def ask(self, answer: type[Answered], request: bytes) -> Answered:
        """Return the answer of the service.

        Parameters
        ----------
        answer, request
            Class of the answer, and the request as JSON.

        Returns
        -------
        Answered
            The answer.

        Raises
        ------
        ShapersmithError
            What the service answers as a problem document.
        ServiceError
            If it answers otherwise than this version of shapersmith does.
        UnreachableError
            If it does not answer.
        """
        content = self._post(TABLE[answer.OPERATION].path, request)
        try:
            return answer.of(content, request)
        except ValidationError:
            raise_problem(_strange_answer(self.url))

    def _post(self, path: str, body: bytes) -> bytes:
        request = urllib.request.Request(
            self.url + path, body, {"content-type": "application/json"}
        )
        try:
            with urllib.request.urlopen(request, timeout=self.timeout_s) as answer:
                content: bytes = answer.read()
        except urllib.error.HTTPError as error:
            with error:
                raise_problem(_problem(self.url, error.read()))
        except (OSError, http.client.HTTPException) as error:
            raise_problem(_no_answer(self.url, error))
        return content


def _problem(url: str, content: bytes) -> ProblemDocument:
    try:
        return ProblemDocument.model_validate_json(content)
    except ValidationError:
        return _strange_answer(url)


def _strange_answer(url: str) -> ProblemDocument:
    told = f"what answers at {url} is no shapersmith of this version"
    return Problem(STRANGE_ANSWER, told).document()


def _no_answer(url: str, error: Exception) -> ProblemDocument:
    told = f"no answer from {url}: {getattr(error, 'reason', error)}"
    return Problem(UNREACHABLE, told).document()
