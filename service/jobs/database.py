"""The database of the job store: opened, and brought to the newest schema."""

from pathlib import Path
from typing import Any

import sqlalchemy as sa
from alembic import command
from alembic.config import Config
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import event
from sqlalchemy.exc import ArgumentError, DBAPIError, NoSuchModuleError

BUSY_WAIT_S = 30.0
"""How long SQLite waits for another process's write [s]."""

MIGRATION_LOCK = 20_110_001
"""Key of the advisory lock that lets one process at a time migrate a PostgreSQL store."""


class StoreError(Exception):
    """The job store cannot be used; the message says why and what to do."""


def opened(url: str) -> sa.Engine:
    """Return the engine of a store, its schema made or migrated.

    Raises
    ------
    StoreError
        If the URL is none, or the schema is newer than this version knows.
    sqlalchemy.exc.OperationalError
        If the database does not answer.
    """
    engine = _engine(url)
    try:
        _migrate(engine)
    except BaseException:
        engine.dispose()
        raise
    return engine


def _engine(url: str) -> sa.Engine:
    try:
        parsed = sa.make_url(url)
        if parsed.get_backend_name() == "postgresql":
            parsed = parsed.set(drivername="postgresql+psycopg")
        elif parsed.get_backend_name() != "sqlite":
            raise StoreError("a job store is sqlite:///FILE or postgresql://..., no other database")
        elif parsed.database:
            Path(parsed.database).parent.mkdir(parents=True, exist_ok=True)
        # A connection may have died since it was last used: ask it first.
        engine = sa.create_engine(parsed, pool_pre_ping=True)
    except (ArgumentError, NoSuchModuleError):
        raise StoreError("the URL of the job store cannot be read") from None
    except ModuleNotFoundError as error:
        raise StoreError(f"install shapersmith[postgres]: {error}") from None
    except OSError as error:
        raise StoreError(f"no folder for the job store: {error}") from None
    if engine.dialect.name == "sqlite":
        event.listen(engine, "connect", _connected)
        event.listen(engine, "begin", _begun)
    return engine


def _connected(connection: Any, record: object) -> None:  # noqa: ANN401
    del record
    connection.isolation_level = None  # transactions are begun here, not by the driver
    connection.execute(f"PRAGMA busy_timeout={1000 * BUSY_WAIT_S:.0f}")
    connection.execute("PRAGMA journal_mode=WAL")
    # A killed process loses nothing; a lost machine may lose the last commits, never the store.
    connection.execute("PRAGMA synchronous=NORMAL")


def _begun(connection: sa.Connection) -> None:
    # A transaction that read first and then wrote could find itself overtaken, and fail.
    connection.exec_driver_sql("BEGIN IMMEDIATE")


def _migrate(engine: sa.Engine) -> None:
    config = Config()
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations"))
    scripts = ScriptDirectory.from_config(config)
    with engine.begin() as connection:
        if engine.dialect.name == "postgresql":
            connection.execute(sa.select(sa.func.pg_advisory_xact_lock(MIGRATION_LOCK)))
        found = MigrationContext.configure(connection).get_current_revision()
        if found == scripts.get_current_head():
            return
        if found is not None and found not in {step.revision for step in scripts.walk_revisions()}:
            raise StoreError(
                f"the job store has schema {found}, made by a newer version of shapersmith; this "
                f"one knows {scripts.get_current_head()} at most: update it, or name another store"
            )

        config.attributes["connection"] = connection
        command.upgrade(config, "head")


def disk_full(error: DBAPIError) -> bool:
    """Whether a database refused for want of space."""
    return "disk is full" in str(error.orig) or "No space left" in str(error.orig)
