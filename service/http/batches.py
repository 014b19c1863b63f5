"""A batch: its lines in parts small enough to share the workers, what is large apart."""

import asyncio
from collections import deque

from service.dispatch import Answer, answer
from service.problems import TIME_LIMIT, Problem, ProblemError
from service.workers.protocol import Pool
from service.workers.runs import SplitError
from service.workers.shapes import shape_of

PART_S = 0.05
"""What a part of a batch is expected to take, so that batches share workers [s]."""

PART_LINES = 20
"""Most lines of a part."""


class Batch:
    """Designs, one a line, answered in order as `POST /v1/designs` would answer each.

    Parameters
    ----------
    pool
        Answers the lines.
    lines
        The bodies.
    client
        Whose they are.
    limit_s
        How long all of it may take [s]; lines without an answer by then have a problem each.
    """

    def __init__(self, pool: Pool, lines: list[bytes], *, client: str, limit_s: float) -> None:
        self._pool = pool
        self._lines = lines
        self._client = client
        self._limit_s = limit_s
        self._waiting = deque(range(len(lines)))
        late = Problem(TIME_LIMIT, f"the batch was ended after {limit_s:g} s, before this line")
        self._answers = [Answer(late, 0.0)] * len(lines)

    async def answers(self) -> list[Answer]:
        """Return an answer or a problem for each line."""
        try:
            async with asyncio.timeout(self._limit_s), asyncio.TaskGroup() as group:
                # A worker fewer than there are: a batch must not hold up the small work of others.
                for _ in range(max(1, self._pool.workers - 1)):
                    group.create_task(self._work())
        except TimeoutError:
            pass  # the lines that are left have their problem already
        return self._answers

    async def _work(self) -> None:
        while self._waiting:
            part = self._next()
            try:
                await self._answer(part)
            except (SplitError, ProblemError):
                for number in part:
                    await self._answer_alone(number)

    def _next(self) -> list[int]:
        """Take lines that are expected to be a part together, one at least."""
        part: list[int] = []
        cost_s = 0.0
        while self._waiting and len(part) < PART_LINES:
            cost_s += self._pool.costs.of(self._client, self._shape(self._waiting[0]))
            if part and cost_s > PART_S:
                break
            part.append(self._waiting.popleft())
        return part

    async def _answer(self, part: list[int]) -> None:
        if len(part) == 1:
            await self._answer_alone(part[0])
            return
        lines = [self._lines[number] for number in part]
        done: list[Answer] = await self._pool.run(
            answer_lines, "design", lines, client=self._client, kind="batch", splits=True
        )
        for number, one in zip(part, done, strict=True):
            self._answers[number] = one
            self._pool.costs.record(self._client, self._shape(number), one.seconds)

    async def _answer_alone(self, number: int) -> None:
        try:
            (self._answers[number],) = await self._pool.run(
                answer_lines,
                "design",
                [self._lines[number]],
                client=self._client,
                kind="batch",
                shape=self._shape(number),
            )
        except ProblemError as error:
            self._answers[number] = Answer(error.problem, 0.0)

    def _shape(self, number: int) -> object:
        return shape_of("design", self._lines[number])


def answer_lines(operation: str, lines: list[bytes]) -> list[Answer]:
    """Answer each line of a part of a batch.

    Parameters
    ----------
    operation, lines
        Name of the operation, and the requests as JSON.

    Returns
    -------
    list of Answer
        An answer to each, in order.
    """
    return [answer(operation, line) for line in lines]
