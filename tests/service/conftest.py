"""A job store over each database."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from service.jobs.store import Store
from service.workers.own_path import ensure_fork_server
from service.workers.process import PRELOADED
from tests.job_stores import HOUR_S, erase
from tests.postgres import running_cluster


@pytest.fixture(autouse=True)
def fork_server() -> None:
    """Have it hold all that workers need, whichever test is the first to need some.

    Workers that are born of one that holds less build their own solvers, each anew.
    """
    ensure_fork_server([*PRELOADED, "tests.table_warmth"])


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
