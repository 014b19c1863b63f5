"""Tables computed into a store in this process: for tests of what becomes of them thereafter."""

import json
from pathlib import Path
from typing import Any

from service.jobs.plan import Plan, plan_table
from service.jobs.service import JobService
from service.jobs.store import Store
from service.jobs.work import compute_chunk, pack
from service.settings import Settings


def jobs_in(folder: Path, **settings: Any) -> JobService:
    """Return the table jobs of a folder, which no process computes."""
    return JobService(Settings(data_dir=str(folder), job_workers=0, **settings))


def add_done(store: Store, table: object) -> str:
    """Add a table to a store, compute all of it here, and return its id."""
    plan = plan_table(json.dumps(table).encode())
    assert isinstance(plan, Plan), plan
    job = store.add(plan.job)
    content = pack(plan.job.specification)
    for claim in store.claim("here", plan.job.chunks):
        assert store.finish("here", claim, compute_chunk(content, plan.job.impulses, claim.number))
    store.settle()
    found = store.job(job)
    assert found is not None
    assert found.state == "done"
    return job
