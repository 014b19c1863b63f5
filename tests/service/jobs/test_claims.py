"""Which chunks are served next: shares between jobs are fair."""

import pytest

from service.jobs.claims import Turn, shares
from service.jobs.store import Store
from tests.job_stores import HOUR_S, job, silent_for


def test_chunks_given_back_and_those_of_the_silent_come_before_new_ones(
    store: Store, url: str
) -> None:
    new = job(rows=9, chunk_rows=1)
    store.add(new)
    held = store.claim("a", 4)
    store.give_back("a", [held[2]])
    silent_for(url, 2 * HOUR_S)
    store.beat("a", [held[0]])
    numbers = [claim.number for claim in store.claim("b", 9)]
    assert numbers == [2, 1, 3, 4, 5, 6, 7, 8]


def test_a_small_job_is_served_beside_a_huge_one_and_all_in_turn(store: Store) -> None:
    huge, small, other = job(10**6, 1), job(1, 1), job(10**6, 1)
    store.add(huge)
    assert {claim.job for claim in store.claim("w", 4)} == {huge.id}
    store.add(small)
    store.add(other)
    got = [claim.job for claim in store.claim("w", 5)]
    assert (got.count(small.id), got.count(other.id)) == (1, 4)
    got = [claim.job for claim in store.claim("w", 6)]
    assert (got.count(huge.id), got.count(other.id)) == (3, 3)


def turn(name: str, **values: float) -> Turn:
    given = {"running": 0, "free": 9, "served": 0.0, "created": 0.0, **values}
    return Turn(job=name, **given)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("turns", "most", "given"),
    [
        ([], 3, {}),
        ([turn("a")], 0, {}),
        ([turn("a", free=2)], 5, {"a": 2}),
        ([turn("a", free=0), turn("b")], 2, {"b": 2}),
        ([turn("a", running=2), turn("b")], 2, {"b": 2}),
        ([turn("a", running=2), turn("b")], 4, {"b": 3, "a": 1}),
        ([turn("a", served=2.0), turn("b", served=1.0)], 1, {"b": 1}),
        ([turn("a", created=2.0), turn("b", created=1.0)], 1, {"b": 1}),
        ([turn("a", created=2.0), turn("b", created=1.0)], 4, {"a": 2, "b": 2}),
    ],
)
def test_shares_are_fair(turns: list[Turn], most: int, given: dict[str, int]) -> None:
    assert shares(turns, most) == given
