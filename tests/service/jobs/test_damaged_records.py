"""Records of jobs, and of their chunks, that a disk or a person has changed."""

import random
import sqlite3
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from design.tables.rows import Rows
from service.jobs.blobs import to_blob
from service.jobs.contents import DamagedError
from service.jobs.plan import wire_job
from service.jobs.results import rows_of_job
from service.jobs.schema import JOBS, METADATA
from service.jobs.soundness import RULES, damage_of
from service.jobs.store import Store
from tests.job_stores import HOUR_S, done, job
from tests.patience import PATIENT_S
from tests.service.jobs.test_runner import inline, run, table

WRONG: list[Any] = ["many", "", -1, -0.5, 1e999, 10**15, b"\xff\xfe", "x\ud7ff", None]
"""What may come to stand in a column of SQLite, which takes anything anywhere."""

BYTES = "CAST(x'66ff66' AS TEXT)"
"""A text that is none."""


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("damaged") / "jobs.sqlite"


@pytest.fixture(scope="module")
def opened(file: Path) -> Iterator[Store]:
    opened = Store(f"sqlite:///{file}", stalled_s=HOUR_S, version="1")
    yield opened
    opened.close()


@pytest.fixture
def store(opened: Store, file: Path) -> Store:
    """Return the store of all tests, emptied: to make one takes longer than most of them."""
    with sqlite3.connect(file, timeout=PATIENT_S) as connection:
        for table in reversed(METADATA.sorted_tables):
            connection.execute(f"DELETE FROM {table.name}")
    connection.close()
    opened.version = "1"
    return opened


def edit(file: Path, one: str, column: str, value: Any) -> bool:
    """Put a value into a job's record, and return whether it could be."""
    with sqlite3.connect(file, timeout=PATIENT_S) as connection:
        given, values = ("?", [value]) if value != BYTES else (BYTES, [])
        try:
            connection.execute(f"UPDATE jobs SET {column} = {given} WHERE id = ?", [*values, one])
        except sqlite3.IntegrityError:
            return False
    connection.close()
    return True


def test_every_column_has_a_rule() -> None:
    assert set(RULES) == {column.name for column in JOBS.columns}


@pytest.mark.parametrize("column", [column.name for column in JOBS.columns])
@pytest.mark.parametrize("value", [*WRONG, BYTES], ids=repr)
def test_a_job_whose_record_cannot_be_harms_no_other_and_can_be_deleted(
    store: Store, file: Path, column: str, value: Any
) -> None:
    strange, good = job(rows=2, chunk_rows=1), job(rows=2, chunk_rows=1)
    store.add(strange)
    store.add(good)
    if not edit(file, strange.id, column, value):
        return
    while claims := store.claim("w", 1):
        for claim in claims:
            try:
                store.contents_of(claim.job)
            except DamagedError as error:
                store.fail_job(claim.job, str(error))
            else:
                assert store.finish("w", claim, done())
        store.settle()
    seen = {one.id: wire_job(one) for one in store.jobs(9)}
    assert seen[good.id].state == "done"
    assert seen[good.id].rows_done == 2
    found = store.job(strange.id)
    if found is None:  # it is another one now
        assert column == "id"
        return
    assert column == "state" or found.sound or found.state == "failed"
    if not found.sound:
        assert "damaged" in found.reason or "none that this version" in found.reason
        assert not store.resume(strange.id)
        assert store.delete(strange.id)
        assert store.job(strange.id) is None
        store.erase(strange.id)


SOUND: dict[str, Any] = {
    "id": "a",
    "state": "running",
    "reason": "",
    "created": 1.5,
    "sha256": "",
    "version": "1",
    "rows": 10,
    "chunks": 3,
    "impulses": None,
    "chunk_rows": 4,
    "estimated_bytes": 0,
    "begun": 3,
    "served": 0.0,
    "key": None,
    "rows_done": 8,
    "verified": 5,
    "verified_ideal": 2,
    "infeasible": 1,
    "last_finished": 2.0,
    "earlier_from": None,
    "earlier_rows": 0,
    "lately_from": None,
    "lately_rows": 0,
}


@pytest.mark.parametrize(
    ("change", "wrong"),
    [
        ({}, ""),
        ({"chunks": 11}, "chunks cannot be 11"),
        ({"chunk_rows": 10**15}, "chunks cannot be 3"),
        ({"begun": 4}, "begun cannot be 4"),
        ({"rows_done": 11}, "rows_done cannot be 11"),
        ({"rows_done": 7}, "rows_done cannot be 7"),
        ({"rows": "many", "begun": -1}, "rows cannot be 'many', begun cannot be -1"),
        ({"created": float("inf")}, "created cannot be inf"),
        ({"version": b"1"}, "version cannot be b'1'"),
    ],
)
def test_what_cannot_be_is_named(change: dict[str, Any], wrong: str) -> None:
    assert damage_of({**SOUND, **change}).endswith(wrong)
    assert bool(damage_of({**SOUND, **change})) == bool(wrong)


@pytest.mark.parametrize("value", ["[]", b"\xff", BYTES])
@pytest.mark.parametrize("gone", [False, True])
def test_a_specification_that_is_not_what_was_stored_fails_its_job_alone(
    store: Store, file: Path, value: Any, gone: bool
) -> None:
    strange, good = table(2, "strange"), table(2, "good")
    store.version = strange.version
    store.add(strange)
    store.add(good)
    with sqlite3.connect(file, timeout=PATIENT_S) as connection:
        if gone:
            connection.execute("DELETE FROM specifications WHERE job = ?", [strange.id])
        connection.execute(
            "UPDATE specifications SET specification = ? WHERE job = ?", [value, strange.id]
        )
    connection.close()
    run(store, inline)
    found = store.job(strange.id)
    assert found is not None
    assert (found.state, found.reason) == (
        "failed",
        "its specification in the job store is damaged",
    )
    with pytest.raises(DamagedError, match="specification"):
        store.contents_of(strange.id)


def rows(first: int) -> Rows:
    random_rows = np.random.default_rng(first)
    return Rows(
        first=first,
        fields=random_rows.random((40, 2)),
        results=random_rows.random((40, 6)),
        status=np.zeros(40, dtype=np.int8),
        reasons={3: "none in 50 starts"},
    )


def computed(store: Store) -> tuple[str, list[bytes]]:
    new = job(rows=80, chunk_rows=40)
    store.add(new)
    blobs = [to_blob(rows(0)), to_blob(rows(40))]
    for claim in store.claim("w", 2):
        assert store.finish("w", claim, done(blobs[claim.number]))
    return new.id, blobs


def put(file: Path, number: int, blob: Any, *, hashed: bool = True) -> None:
    with sqlite3.connect(file, timeout=PATIENT_S) as connection:
        connection.execute("UPDATE chunks SET blob = ? WHERE number = ?", (blob, number))
        if not hashed:
            connection.execute("UPDATE chunks SET sha256 = NULL")
    connection.close()


def test_no_random_damage_of_rows_is_read_as_numbers(store: Store, file: Path) -> None:
    new, (_, whole) = computed(store)
    dice = random.Random(20_115)
    for _ in range(200):
        damaged = bytearray(whole)
        for _ in range(dice.choice((1, 1, 4))):
            damaged[dice.randrange(len(whole))] ^= 1 << dice.randrange(8)
        if damaged == whole:
            continue
        put(file, 1, bytes(damaged))
        with pytest.raises(DamagedError, match=f"chunk 1 of job {new} are damaged"):
            list(rows_of_job(store, new))


@pytest.mark.parametrize("blob", [None, b"", b"no rows", "text", "other", "cut"])
@pytest.mark.parametrize("hashed", [True, False])
def test_rows_that_are_none_or_of_another_chunk_are_told(
    store: Store, file: Path, blob: Any, hashed: bool
) -> None:
    new, blobs = computed(store)
    put(file, 1, {"other": blobs[0], "cut": blobs[1][:200]}.get(blob, blob), hashed=hashed)
    if blob == "other" and not hashed:
        return  # nothing tells
    with pytest.raises(DamagedError, match=f"chunk 1 of job {new} are damaged"):
        list(rows_of_job(store, new))


def test_rows_of_an_older_version_have_no_hash_and_are_read(store: Store, file: Path) -> None:
    new, blobs = computed(store)
    put(file, 1, blobs[1], hashed=False)
    assert [run.first for run in rows_of_job(store, new)] == [0, 40]
