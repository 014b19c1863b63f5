"""Table jobs kept in memory, for tests and tools: nothing computes them, and no store is behind."""

import time
from collections.abc import AsyncIterator, Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

from service.jobs.adding import KeyReusedError
from service.jobs.asking import UnansweredError
from service.jobs.records import UNFINISHED, Event, Job, NewJob, State
from service.jobs.watching import Watching
from service.problems import NOT_FOUND, Problem
from service.version import version


class MemoryJobs:
    """Does to jobs what `JobService` does, as far as routes see it.

    Parameters
    ----------
    folder
        Where files of tables are written.

    Attributes
    ----------
    files
        The file of each job and format, or why it cannot be written.
    silence
        Why no call is answered; empty where all are.
    """

    def __init__(self, folder: Path) -> None:
        self.files: dict[tuple[str, str], bytes | Problem] = {}
        self.silence = ""
        self.stopping: Callable[[], bool] = lambda: False
        self._folder = folder
        self._jobs: dict[str, Job] = {}
        self._keys: dict[str, str] = {}
        self._watching = Watching(self.find, lambda: self.stopping())

    def start(self) -> None:
        """Do nothing: no process computes these jobs."""

    def close(self) -> None:
        """Do nothing: there is nothing to end."""

    async def add(self, job: NewJob, key: str | None) -> str:
        """Add a job, unless its key has begun one already.

        Parameters
        ----------
        job, key
            As of `Jobs.add`.

        Returns
        -------
        str
            Id of the new job, or of the one that the key has begun.

        Raises
        ------
        KeyReusedError
            If the key began a job of another specification.
        UnansweredError
            If no call is answered.
        """
        self._require_answers()
        begun = self._keys.get(key) if key is not None else None
        if begun is not None:
            if self._jobs[begun].sha256 != job.sha256:
                raise KeyReusedError("this key began a table of another specification")
            return begun
        self._jobs[job.id] = _waiting(job)
        if key is not None:
            self._keys[key] = job.id
        return job.id

    async def find(self, job: str) -> Job | None:
        """Return a job, or None."""
        self._require_answers()
        return self._jobs.get(job)

    async def newest(self, most: int) -> list[Job]:
        """Return the newest jobs, newest first."""
        self._require_answers()
        return list(reversed(self._jobs.values()))[:most]

    async def cancel(self, job: str) -> bool:
        """Cancel a job, and return whether it is cancelled now."""
        found = await self.find(job)
        if found is None:
            return False
        if found.state in UNFINISHED:
            self.change(job, "cancelled")
        return found.state in {*UNFINISHED, "cancelled"}

    async def delete(self, job: str) -> bool:
        """Delete a job that has ended, and return whether it had."""
        found = await self.find(job)
        if found is None or not found.ended:
            return False
        del self._jobs[job]
        self._keys = {key: begun for key, begun in self._keys.items() if begun != job}
        return True

    async def resume(self, job: str) -> bool:
        """Let a failed job be tried again; return whether it is unfinished now."""
        found = await self.find(job)
        if found is None or not found.sound:
            return False
        if found.state == "failed":
            if found.version != version() and found.done > 0:
                return False
            self.change(job, "running")
        return found.state in {*UNFINISHED, "failed"}

    def events(self, job: Job) -> AsyncIterator[Event]:
        """Yield an event for each state of a job, until its last."""
        return self._watching.events(job)

    def path_of(self, job: str, name: str) -> Path:
        """Return where the file of a job in a format is, or is to be.

        Parameters
        ----------
        job, name
            As of `Jobs.path_of`.

        Returns
        -------
        Path
            A file in the folder of these jobs.
        """
        return self._folder / f"{job}.{name}"

    def writing_of(self, job: str, name: str) -> Callable[[], Problem | None]:
        """Return the task that writes the file of a job from `files`.

        Parameters
        ----------
        job, name
            As of `Jobs.writing_of`.

        Returns
        -------
        Callable
            The task, for a worker; it returns why it could not write, or None.
        """
        missing = Problem(NOT_FOUND, f"there is no file of {job}")
        return partial(_write, self.path_of(job, name), self.files.get((job, name), missing))

    def change(self, job: str, state: State, *, reason: str = "", rows_done: int = 0) -> None:
        """Make of a job what its computation would.

        Parameters
        ----------
        job
            Id of the job, which must be there.
        state
            Its new state.
        reason
            Why it failed.
        rows_done
            Rows that are computed; all of them count as verified.
        """
        self._jobs[job] = replace(
            self._jobs[job], state=state, reason=reason, done=rows_done, verified=rows_done
        )

    def _require_answers(self) -> None:
        if self.silence:
            raise UnansweredError(self.silence)


def _waiting(job: NewJob) -> Job:
    return Job(
        id=job.id,
        state="waiting",
        reason="",
        created=time.time(),
        sha256=job.sha256,
        version=job.version,
        rows=job.rows,
        chunks=job.chunks,
        estimated_bytes=job.estimated_bytes,
        done=0,
        verified=0,
        verified_ideal=0,
        infeasible=0,
        rate_rows_s=0.0,
    )


def _write(path: Path, content: bytes | Problem) -> Problem | None:
    if isinstance(content, Problem):
        return content
    path.write_bytes(content)
    return None
