"""Tables of designs into files, computed in this process."""

import tempfile
from contextlib import closing
from pathlib import Path

from design.errors import DesignError
from schemas.table_jobs import TableJob
from service.files import NotReplaceableError
from service.jobs.database import StoreError, url_of
from service.jobs.executors import thread
from service.jobs.plan import Plan, plan_table, wire_job
from service.jobs.records import Job
from service.jobs.results import require_taken, write_result
from service.jobs.runner import Runner
from service.jobs.store import Store
from service.problems import INVALID, Problem, problem_of_design
from shapersmith.errors import raise_problem
from shapersmith.given import Json, as_json
from shapersmith.results import require_done

STALLED_S = 30.0
"""Of a store that no other process uses [s]."""


def table(specification: Json, path: str | Path, format: str) -> TableJob:
    """Write a table of designs over axes or a list into a file.

    It is computed on one processor, without other processes; the command ``table`` takes all of
    them, and goes on where it was.

    Parameters
    ----------
    specification
        Body of ``POST /v1/tables``.
    path
        The file.
    format
        Its format, as ``csv``, ``json``, ``parquet``, ``mat``, ``c`` or ``st``.

    Returns
    -------
    TableJob
        How many rows are verified, infeasible or failed.

    Raises
    ------
    ShapersmithError
        If the specification breaks a rule, or the format does not take the table.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import shapersmith, tempfile
    >>> crane = shapersmith.Pendulum(cable_length_m=0.8)
    >>> design = {"plant": crane, "actuator": shapersmith.Ideal(), "shaper": {"kind": "umzv"}}
    >>> axis = shapersmith.TableAxis(field="/plant/cable_length_m", from_=0.4, to=1.4, points=5)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     job = table({"design": design, "axes": [axis]}, f"{folder}/table.csv", "csv")
    >>> job.verified
    5
    """
    plan = plan_table(as_json(specification))
    if isinstance(plan, Problem):
        raise_problem(plan.document())
    try:
        require_taken(plan.job, format)
        return _written(plan, Path(path), format)
    except DesignError as error:
        raise_problem(problem_of_design(error).document())
    except NotReplaceableError as error:
        raise_problem(Problem(INVALID, str(error)).document())


def _written(plan: Plan, path: Path, name: str) -> TableJob:
    with (
        tempfile.TemporaryDirectory(prefix="shapersmith-") as folder,
        closing(Store(url_of(Path(folder) / "table.job"), stalled_s=STALLED_S)) as store,
    ):
        store.add(plan.job)
        runner = Runner(store, thread, database_wait_s=STALLED_S)
        runner.run(until=lambda: _job(store, plan).ended)
        ended = _job(store, plan)
        done = require_done(wire_job(ended))
        write_result(store, ended, name, path)
        return done


def _job(store: Store, plan: Plan) -> Job:
    found = store.job(plan.job.id)
    if found is None:
        raise StoreError("the job has gone from its store")
    return found
