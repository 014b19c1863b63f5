"""Jobs that are watched: one look at each every half second, however many streams show it."""

import asyncio
import logging
from collections.abc import AsyncIterator, Awaitable, Callable

from service.jobs.asking import UnansweredError
from service.jobs.plan import wire_job
from service.jobs.records import Event, Job

LOOK_EVERY_S = 0.5
"""Between two looks at a job [s]."""

GONE = "gone"
"""The last event of a job that was deleted."""

LOG = logging.getLogger("shapersmith.jobs")


class _Watched:
    """A job, the latest event of it, and those who wait for the next."""

    def __init__(self, job: Job) -> None:
        self.job = job
        self.event: Event | None = None
        self.number = 0
        self.over = False
        self.streams = 0
        self.changed = asyncio.Condition()
        self.looking: asyncio.Task[None] | None = None


class Watching:
    """Shows jobs to streams of events until they end.

    Parameters
    ----------
    look
        Returns a job as it is now, or None if it is no more.
    stopping
        Whether the service stops, and all streams with it.
    """

    def __init__(
        self,
        look: Callable[[str], Awaitable[Job | None]],
        stopping: Callable[[], bool],
    ) -> None:
        self._look = look
        self._stopping = stopping
        self._watched: dict[str, _Watched] = {}

    async def events(self, job: Job) -> AsyncIterator[Event]:
        """Yield an event for each state of a job, until its last.

        The events end early where the service stops.

        Parameters
        ----------
        job
            The job as it is now.

        Yields
        ------
        Event
            The first is of the present state; the last is `GONE` where the job was deleted.
        """
        watched = self._watched.get(job.id)
        if watched is None:
            watched = self._watched[job.id] = _Watched(job)
            watched.looking = asyncio.create_task(self._keep_looking(watched))
        watched.streams += 1
        seen = 0
        try:
            while True:
                async with watched.changed:
                    while watched.number == seen and not watched.over:
                        await watched.changed.wait()
                if watched.number > seen and watched.event is not None:
                    seen = watched.number
                    yield watched.event
                if watched.over and watched.number == seen:
                    return
        finally:
            watched.streams -= 1
            if watched.streams == 0:
                self._drop(watched)

    async def _keep_looking(self, watched: _Watched) -> None:
        """Look until the job has ended; whatever happens then, no stream is left waiting."""
        try:
            while not self._stopping():
                job = watched.job
                await self._show(watched, job, job.state if job.ended else "progress")
                if job.ended:
                    return
                await asyncio.sleep(LOOK_EVERY_S)
                try:
                    found = await self._look(job.id)
                except UnansweredError as error:
                    LOG.warning("a job that is watched is looked at again later: %s", error)
                    continue
                if found is None:
                    await self._show(watched, job, GONE)
                    return
                watched.job = found
        finally:
            self._drop(watched)
            async with watched.changed:
                watched.over = True
                watched.changed.notify_all()

    async def _show(self, watched: _Watched, job: Job, name: str) -> None:
        event = Event(name, wire_job(job).model_dump_json())
        if event != watched.event:
            async with watched.changed:
                watched.event = event
                watched.number += 1
                watched.changed.notify_all()

    def _drop(self, watched: _Watched) -> None:
        """Look no more; who comes next begins anew."""
        if self._watched.get(watched.job.id) is watched:
            del self._watched[watched.job.id]
            if watched.looking is not None and watched.looking is not asyncio.current_task():
                watched.looking.cancel()
