"""Table jobs, as a client sees them."""

import asyncio
import json
import time

from benchmarks.chaos.trial import HUNG_S, HungError
from benchmarks.loops import Ask
from benchmarks.wire import Answer, Client, message

LOOK_S = 0.05
ENDED = {"done", "failed", "cancelled"}


class RefusedError(Exception):
    """A table was not begun."""


class TableClient:
    """Begins tables at a service and follows them."""

    def __init__(self, client: Client) -> None:
        self._client = client

    async def begin(self, body: bytes) -> str:
        """Begin a table and return its id.

        Raises
        ------
        RefusedError
            If the service does not.
        """
        answer = await self._client.ask(message("POST", "/v1/tables", body))
        if answer.status != 202:
            raise RefusedError(f"{answer.status}: {answer.body.decode()[:200]}")
        job: str = json.loads(answer.body)["id"]
        return job

    async def list_newest(self) -> Answer:
        """Ask for the newest tables."""
        return await self._client.ask(message("GET", "/v1/tables"))

    async def state(self, job: str) -> Answer:
        """Ask for the state of one."""
        return await self._client.ask(message("GET", f"/v1/tables/{job}"))

    async def cancel(self, job: str) -> Answer:
        """Cancel one."""
        return await self._client.ask(message("DELETE", f"/v1/tables/{job}"))

    def result(self, job: str, export: str) -> Ask:
        """Return what asks for the file of one in a format."""
        return lambda: self._client.ask(message("GET", f"/v1/tables/{job}/result?format={export}"))

    async def wait_for_end(self, job: str, *, hung_s: float = HUNG_S) -> str:
        """Wait until a table has ended, and return how.

        Raises
        ------
        HungError
            If it does not.
        """
        start = time.perf_counter()
        state = ""
        while state not in ENDED:
            if time.perf_counter() - start > hung_s:
                raise HungError(f"a table is {state} after {hung_s:g} s")
            await asyncio.sleep(LOOK_S)
            told = await self.state(job)
            state = json.loads(told.body)["state"] if told.status == 200 else ""
        return state
