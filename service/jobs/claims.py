"""Which chunks a worker gets: fair between jobs, whatever their size.

A job has chunks that nobody has begun, numbered from ``begun`` on, and free ones of those before:
given back, failed, or held by a worker that has been silent for too long.
"""

import heapq
import logging
from collections.abc import Iterable
from dataclasses import dataclass

import sqlalchemy as sa

from service.jobs.records import UNFINISHED, ChunkClaim
from service.jobs.schema import CHUNKS, JOBS
from service.jobs.soundness import damage_of

LOG = logging.getLogger("shapersmith.jobs")

CLAIM_LOCK = 20_110_002
"""Key of the advisory lock that lets one claim at a time at the jobs of a PostgreSQL store."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Turn:
    """An unfinished job that may get a chunk.

    Attributes
    ----------
    running
        Its chunks that are being computed.
    free
        Its chunks that may be claimed.
    served, created
        When it last got one, and when it was begun [s].
    """

    job: str
    running: int
    free: int
    served: float
    created: float


def shares(turns: Iterable[Turn], most: int) -> dict[str, int]:
    """Return how many of some chunks each job gets.

    The next chunk goes to the job with the fewest running, of these to the one that has waited
    longest, of these to the oldest.

    Parameters
    ----------
    turns
        The jobs that may get a chunk.
    most
        Chunks to be given in all.

    Returns
    -------
    dict of str to int
        Number of chunks by job; jobs that get none are left out.
    """
    given: dict[str, int] = {}
    waiting = [(turn.running, turn.served, turn.created, turn.job, turn.free) for turn in turns]
    waiting = [one for one in waiting if one[-1] > 0]
    heapq.heapify(waiting)
    while waiting and most > 0:
        running, served, created, job, free = heapq.heappop(waiting)
        given[job] = given.get(job, 0) + 1
        most -= 1
        if free > 1:
            heapq.heappush(waiting, (running + 1, served, created, job, free - 1))
    return given


@dataclass(frozen=True, slots=True, kw_only=True)
class Claimer:
    """Claims chunks for a worker.

    Attributes
    ----------
    now
        The database's clock [s].
    stalled_s
        Silence after which a worker loses its chunks [s].
    version
        Of shapersmith, that computes them.
    """

    worker: str
    now: sa.ColumnElement[float]
    stalled_s: float
    version: str

    def claim(self, connection: sa.Connection, most: int) -> list[ChunkClaim]:
        """Claim a number of chunks at most, in a transaction that is open.

        Parameters
        ----------
        connection
            The connection of the transaction, which may write.
        most
            Most chunks.

        Returns
        -------
        list of Claim
            The chunks that the worker holds from the end of the transaction on.
        """
        if connection.dialect.name == "postgresql":
            # Two that lock several jobs each, in orders of their own, would wait for each other.
            connection.execute(sa.select(sa.func.pg_advisory_xact_lock(CLAIM_LOCK)))
        return [
            ChunkClaim(job, number)
            for job, share in shares(self._turns(connection), most).items()
            for number in self._take_chunks(connection, job, share)
        ]

    @property
    def _silent(self) -> sa.ColumnElement[bool]:
        return sa.and_(CHUNKS.c.state == "running", CHUNKS.c.heartbeat < self.now - self.stalled_s)

    def _turns(self, connection: sa.Connection) -> list[Turn]:
        """Return the jobs that may get a chunk; of another version only what nobody has begun.

        Those whose records are damaged get none: whoever looks at them sees why.
        """
        silent = _count(self._silent)
        active = sa.select(
            JOBS,
            (_count(CHUNKS.c.state == "waiting") + silent).label("left"),
            (_count(CHUNKS.c.state == "running") - silent).label("running"),
        ).where(JOBS.c.state.in_(UNFINISHED))
        turns = []
        for found in map(dict, connection.execute(active).mappings()):
            if damage_of(found):
                continue
            turn = Turn(
                job=found["id"],
                free=found["chunks"] - found["begun"] + found["left"],
                running=found["running"],
                served=found["served"],
                created=found["created"],
            )
            version = found["version"]
            if version == self.version or self._take_over(connection, turn, version):
                turns.append(turn)
        return turns

    def _take_over(self, connection: sa.Connection, turn: Turn, version: str) -> bool:
        """Take over a job of another version without a row yet, or fail it.

        Its rows would be of both versions otherwise. While others compute it, it is left to them.
        """
        if turn.running:
            return False
        unfinished = JOBS.update().where(JOBS.c.id == turn.job, JOBS.c.state.in_(UNFINISHED))
        if connection.scalar(sa.select(has_rows(turn.job))):
            reason = (
                f"begun by version {version}, this is {self.version}: begin it anew, or resume it "
                "with the version that began it"
            )
            LOG.warning("job %s is %s", turn.job, reason)
            connection.execute(unfinished.values(state="failed", reason=reason))
            return False
        connection.execute(unfinished.values(version=self.version))
        return True

    def _take_chunks(self, connection: sa.Connection, job: str, most: int) -> list[int]:
        """Take the free chunks of a job, then those that nobody has begun."""
        held = connection.execute(
            sa
            .select(JOBS.c.begun, JOBS.c.chunks, JOBS.c.chunk_rows, JOBS.c.rows)
            .where(JOBS.c.id == job, JOBS.c.state.in_(UNFINISHED))
            .with_for_update()
        ).one_or_none()
        if held is None:  # it ended meanwhile
            return []
        numbers: list[int] = []
        for free in (CHUNKS.c.state == "waiting", self._silent):
            numbers += connection.scalars(
                sa
                .select(CHUNKS.c.number)
                .where(CHUNKS.c.job == job, free)
                .order_by(CHUNKS.c.number)
                .limit(most - len(numbers))
                .with_for_update(skip_locked=True)
            ).all()
        mine = {"state": "running", "worker": self.worker, "heartbeat": self.now}
        if numbers:
            taken = CHUNKS.update().where(CHUNKS.c.job == job, CHUNKS.c.number.in_(numbers))
            connection.execute(taken.values(mine))
        begun = range(held.begun, min(held.begun + most - len(numbers), held.chunks))
        for number in begun:
            rows = min(held.chunk_rows, held.rows - number * held.chunk_rows)
            connection.execute(CHUNKS.insert().values(job=job, number=number, rows=rows, **mine))
        numbers += begun
        if not numbers:  # others took what was free
            return []
        values = {"state": "running", "served": self.now, "begun": held.begun + len(begun)}
        connection.execute(JOBS.update().where(JOBS.c.id == job).values(values))
        return numbers


def has_rows(job: str) -> sa.ColumnElement[bool]:
    """Return whether any chunk of a job is done."""
    return sa.exists().where(CHUNKS.c.job == job, CHUNKS.c.state == "done")


def _count(which: sa.ColumnElement[bool]) -> sa.ScalarSelect[int]:
    """Return how many chunks of a job are such."""
    return (
        sa
        .select(sa.func.count())
        .select_from(CHUNKS)
        .where(CHUNKS.c.job == JOBS.c.id, which)
        .correlate(JOBS)
        .scalar_subquery()
    )
