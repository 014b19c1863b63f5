"""The app in this process, without workers and without a store: what routes do by themselves."""

import asyncio
from collections.abc import AsyncIterator, Mapping
from typing import Any

import httpx
from fastapi import FastAPI

from service.http.app import create_app
from service.jobs.protocol import Jobs
from service.settings import Settings
from service.workers.inline import InlinePool


class InProcess:
    """An app and its pool, asked one request after another.

    Parameters
    ----------
    jobs
        Its table jobs, if it has any.
    settings
        Those that are not the default.
    """

    def __init__(self, jobs: Jobs | None = None, **settings: Any) -> None:
        self.pool = InlinePool()
        self.app: FastAPI = create_app(Settings(**settings), jobs=jobs, pool=self.pool)

    def ask(
        self,
        method: str,
        path: str,
        body: object = None,
        *,
        headers: Mapping[str, str] | None = None,
    ) -> httpx.Response:
        """Return the answer; a body that is neither bytes nor comes in parts is sent as JSON."""
        sent = {"content" if isinstance(body, bytes | AsyncIterator) else "json": body}
        return asyncio.run(self._ask(method, path, dict(headers or {}), sent))

    async def _ask(
        self, method: str, path: str, headers: dict[str, str], sent: dict[str, Any]
    ) -> httpx.Response:
        transport = httpx.ASGITransport(self.app)
        async with httpx.AsyncClient(transport=transport, base_url="http://service") as client:
            return await client.request(method, path, headers=headers, **sent)


def require_problem(answer: httpx.Response, status: int, name: str, told: str = "") -> None:
    """Hold an answer against the problem that it should be."""
    document = answer.json()
    assert (answer.status_code, document["type"]) == (status, f"urn:shapersmith:{name}")
    assert document["status"] == status
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.headers["x-request-id"] == document["request_id"]
    assert ("retry-after" in answer.headers) == (status == 503)
    assert told in document["detail"]
