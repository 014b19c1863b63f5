"""A job store over each database."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from service.jobs.store import Store
from tests.job_stores import HOUR_S, erase
from tests.postgres import running_cluster


@pytest.fixture(scope="session")
def postgres_url() -> Iterator[str]:
    with running_cluster() as cluster:
        yield cluster.url


@pytest.fixture(params=["sqlite", "postgresql"])
def url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    if request.param == "sqlite":
        return f"sqlite:///{tmp_path / 'jobs.sqlite'}"
    return str(request.getfixturevalue("postgres_url"))


@pytest.fixture
def store(url: str) -> Iterator[Store]:
    opened = Store(url, stalled_s=HOUR_S, version="1")
    for job in opened.jobs(1000):
        opened.cancel(job.id)
        opened.delete(job.id)
    erase(opened)
    yield opened
    opened.close()
