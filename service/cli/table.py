"""The command `table`: a separate job, its store beside the file that is asked for."""

import argparse
import os
import signal
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy.exc import DBAPIError

from design.errors import DesignError, InvalidInputError
from design.export.reading import why_not_read
from design.export.registry import EXPORTS
from schemas.tables import TableRequest
from service.cli.checks import drifts_of_file, drifts_of_text, file_named_in, readable
from service.cli.compiling import Compiling
from service.cli.progress import Progress
from service.cli.reading import ReadingError, Source, read_source
from service.cli.streams import warn
from service.files import (
    LockedError,
    NotReplaceableError,
    hold_lock,
    remove_parts,
    require_not_input,
)
from service.jobs.database import StoreError, disk_full, url_of
from service.jobs.executors import SchedulerError, starter
from service.jobs.plan import Plan, plan_table
from service.jobs.records import Job
from service.jobs.results import pieces, require_taken, table_of, write_result
from service.jobs.runner import Runner
from service.jobs.store import Store
from service.problems import INVALID, SOLVER_FAILED, Problem, problem_of_design

DRIFTED = 5
"""Exit status of a check that found a difference."""

STALLED_S = 30.0
"""Of the command's own store, which no other process uses while its lock is held [s]."""

C_ENDINGS = (".c", ".cpp", ".hpp", ".cc")
"""What a file of C may be called elsewhere."""

PAUSE_S = 0.02
"""Between two looks at a job whose last chunks are being computed [s]."""


class CommandError(Exception):
    """The command cannot go on; the message says why."""


def run_table(options: argparse.Namespace, content: bytes) -> int | Problem:
    """Compute a table into a file, or check one.

    Parameters
    ----------
    options
        Options of the command.
    content
        The specification.

    Returns
    -------
    int or Problem
        Exit status, 0 or `DRIFTED`; a problem where there is no table.

    Raises
    ------
    CommandError
        If the command is stopped, or the store, the scheduler or a file cannot be used.
    """
    source, plan = _plan_of_file(options, content)
    if isinstance(plan, Problem):
        return source.locate(plan)
    check: Path | None = options.check
    path: Path = check or options.output
    try:
        name = options.format or _format_of(path)
        require_taken(plan.job, name)
    except DesignError as error:
        return problem_of_design(error)
    warn(plan.warnings)
    if check is None:
        try:
            require_not_input(path, source.read, f"{source.file}, which lists the designs")
        except NotReplaceableError as error:
            return Problem(INVALID, str(error))
    size = plan.size
    _say(
        f"{_counted(size.rows, 'row')} in {_counted(size.chunks, 'chunk')}, about "
        f"{size.estimated_bytes / 1e6:,.1f} MB of numbers"
    )
    try:
        if check is not None:
            return _check(options, plan, path, name)
        return _write(options, plan, path, name)
    except DesignError as error:
        # What a format finds in the rows, as a damping ratio that a firmware does not take.
        return problem_of_design(error)
    except KeyboardInterrupt:
        raise CommandError("stopped; the same command goes on where it was") from None
    except (StoreError, SchedulerError) as error:
        raise CommandError(str(error)) from None
    except DBAPIError as error:
        reason = "no space left" if disk_full(error) else str(error.orig)
        raise CommandError(f"the job store beside {path}: {reason}") from None
    except OSError as error:
        raise CommandError(
            f"cannot write {path}: {error.strerror}; nothing is lost, the same command goes on "
            "where it was"
        ) from None


def _plan_of_file(options: argparse.Namespace, content: bytes) -> tuple[Source, Plan | Problem]:
    given = Path(options.request)
    try:
        source = read_source(content, toml=given.suffix.lower() == ".toml", folder=given.parent)
    except ReadingError as error:
        return Source(b""), error.problem
    return source, plan_table(source.body)


def _format_of(path: Path) -> str:
    for export in EXPORTS.values():
        if path.suffix.lower() == export.suffix:
            return export.name
    endings = ", ".join(f"{export.suffix} ({name})" for name, export in EXPORTS.items())
    meant = "; C is written as a header, .h" if path.suffix.lower() in C_ENDINGS else ""
    raise InvalidInputError(
        "format",
        path.name,
        f"given, or the file's name end in {endings}{meant}",
        code="format_unknown",
    )


def _say(text: str) -> None:
    print(f"shapersmith: {text}", file=sys.stderr)  # noqa: T201 - this is the command line


def _write(options: argparse.Namespace, plan: Plan, path: Path, name: str) -> int | Problem:
    try:
        with hold_lock(path.with_name(f".{path.name}.lock")):
            remove_parts(path)
            file = path.with_name(f".{path.name}.job")
            store, job = _resume(file, plan)
            try:
                ended = _compute(options, store, job, plan)
                if ended.state == "failed":
                    return Problem(SOLVER_FAILED, ended.reason)
                write_result(store, ended, name, path)
            finally:
                store.close()
            _remove(file)
    except LockedError:
        raise CommandError(f"another shapersmith is writing {path}") from None
    _say(f"wrote {path}: {_counts(ended)}")
    return 0


def _counts(job: Job) -> str:
    ideal = f"{job.verified_ideal:,} verified for an ideal actuator only, "
    return (
        f"{job.verified:,} verified, {ideal if job.verified_ideal else ''}"
        f"{job.infeasible:,} infeasible, {job.failed:,} failed"
    )


def _resume(file: Path, plan: Plan) -> tuple[Store, str]:
    """Open the store beside the file; go on with its job if that is the same, else begin anew."""
    store = _open_store(file)
    held = store.jobs(1)
    if held:
        job = held[0]
        if (job.sha256, job.version) == (plan.job.sha256, plan.job.version):
            store.release(job.id)
            store.resume(job.id)
            if job.done:
                _say(f"going on at {job.done:,} rows")
            return store, job.id
        store.close()
        _say("an unfinished table of another specification, or by another version, is dropped")
        _remove(file)
        store = _open_store(file)
    store.add(plan.job)
    return store, plan.job.id


def _open_store(file: Path) -> Store:
    return Store(url_of(file), stalled_s=STALLED_S)


def _remove(file: Path) -> None:
    for end in ("", "-wal", "-shm"):
        file.with_name(file.name + end).unlink(missing_ok=True)


def _compute(options: argparse.Namespace, store: Store, job: str, plan: Plan) -> Job:
    """Run a job to its end."""
    workers = options.workers or os.cpu_count() or 1
    progress = Progress(Compiling(plan.job))
    runner = Runner(
        store, starter(workers, options.scheduler), database_wait_s=STALLED_S, tell=_say
    )
    found = store.job(job)
    if found is None:
        raise StoreError("the job has gone from its store")
    ended: list[Job] = [found] if found.ended else []

    def until() -> bool:
        now = runner.patiently(lambda: store.job(job))
        if now is None:
            raise StoreError("the job has gone from its store")
        progress.show(now)
        if now.ended:
            ended.append(now)
        return now.ended

    if not ended:
        with _stop_on_interrupt(runner):
            try:
                runner.run(until=until, pause_s=PAUSE_S)
            finally:
                progress.end()
    if not ended:
        raise KeyboardInterrupt
    return ended[0]


@contextmanager
def _stop_on_interrupt(runner: Runner) -> Iterator[None]:
    """Let an interrupt stop the runner between two rounds, never in the middle of a lock."""
    before = signal.signal(signal.SIGINT, lambda *_: runner.stopping.set())
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _check(options: argparse.Namespace, plan: Plan, path: Path, name: str) -> int | Problem:
    if not path.is_file():
        raise CommandError(f"there is no file {path} to check")
    tolerances = TableRequest.model_validate_json(plan.job.specification).tolerances
    with _temporary_store() as store:
        store.add(plan.job)
        job = _compute(options, store, plan.job.id, plan)
        if job.state == "failed":
            return Problem(SOLVER_FAILED, job.reason)
        try:
            if readable(name):
                head, rows = table_of(store, store.contents_of(job.id), name)
                drifts = drifts_of_file(path, name, head, rows, tolerances)
            else:
                drifts = drifts_of_text(path, pieces(store, job.id, name, file_named_in(path)))
        except InvalidInputError as error:
            raise CommandError(why_not_read(name, path, error)) from None
    if not drifts.count:
        _say(f"{path} is as it was: {_counts(job)}")
        return 0
    for text in drifts.told:
        _say(text)
    more = drifts.count - len(drifts.told)
    found = _counted(drifts.count, "difference")
    _say(f"{path} has drifted: {found}" + (f", {more} not listed" if more else ""))
    return DRIFTED


def _counted(number: int, noun: str) -> str:
    return f"{number:,} {noun}" + ("" if number == 1 else "s")


@contextmanager
def _temporary_store() -> Iterator[Store]:
    with tempfile.TemporaryDirectory(prefix="shapersmith-") as folder:
        store = _open_store(Path(folder) / "check.job")
        try:
            yield store
        finally:
            store.close()
