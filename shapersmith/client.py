"""The same calls over HTTP, with nothing but the standard library and the wire models."""

import http.client
import time
import urllib.error
import urllib.request
from pathlib import Path
from urllib.parse import quote

from pydantic import ValidationError

from schemas.problems import ProblemDocument
from schemas.table_jobs import TableJob
from service.operations.table import TABLE
from service.problems import INVALID, Problem
from shapersmith.calls import Answered, Calls
from shapersmith.errors import STRANGE_ANSWER, UNREACHABLE, raise_problem
from shapersmith.given import Json, as_json
from shapersmith.results import require_done

PAUSE_S = 0.2
"""Between two looks at a table that is being computed [s]."""


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
        content = self._ask_for(TABLE[answer.OPERATION].path, request)
        try:
            return answer.of(content, request)
        except ValidationError:
            raise_problem(_strange_answer(self.url))

    def table(self, specification: Json, path: str | Path, format: str) -> TableJob:
        """Write a table that the service computes into a file, once it is done.

        Parameters
        ----------
        specification
            Body of ``POST /v1/tables``.
        path
            The file.
        format
            Its format, as ``csv``, ``json``, ``parquet``, ``mat``, ``c`` or ``st``.

        Returns
        -------
        TableJob
            How many rows are verified, infeasible or failed, and the id of the job, which the
            service keeps.

        Raises
        ------
        ShapersmithError
            What the service answers as a problem document, or that the table has failed.
        OSError
            If the file cannot be written.
        """
        job = self._job(self._ask_for("/v1/tables", as_json(specification)))
        while job.state in {"waiting", "running"}:
            time.sleep(PAUSE_S)
            job = self._job(self._ask_for(f"/v1/tables/{job.id}"))
        done = require_done(job)
        _write(Path(path), self._ask_for(f"/v1/tables/{job.id}/result?format={quote(format)}"))
        return done

    def _job(self, content: bytes) -> TableJob:
        try:
            return TableJob.model_validate_json(content)
        except ValidationError:
            raise_problem(_strange_answer(self.url))

    def _ask_for(self, path: str, body: bytes | None = None) -> bytes:
        """Return what the service answers to a POST, or to a GET where there is no body."""
        request = urllib.request.Request(
            self.url + path, body, {"content-type": "application/json"}
        )
        try:
            with _open(request, self.timeout_s) as answer:
                content: bytes = answer.read()
        except (OSError, http.client.HTTPException) as error:
            raise_problem(_no_answer(self.url, error))
        if isinstance(answer, urllib.error.HTTPError):
            raise_problem(_problem(self.url, content))
        return content


def _open(
    request: urllib.request.Request, timeout_s: float
) -> http.client.HTTPResponse | urllib.error.HTTPError:
    """Return what a service answers, be it a problem."""
    try:
        answer: http.client.HTTPResponse = urllib.request.urlopen(request, timeout=timeout_s)
    except urllib.error.HTTPError as error:
        return error
    return answer


def _write(path: Path, content: bytes) -> None:
    from service.files import NotReplaceableError, write_whole  # noqa: PLC0415 - not on every system

    try:
        write_whole(path, content)
    except NotReplaceableError as error:
        raise_problem(Problem(INVALID, str(error)).document())


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
