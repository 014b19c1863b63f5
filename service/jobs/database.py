"""The database of the job store: opened, and brought to the newest schema."""

import sqlite3
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import sqlalchemy as sa
from alembic import command
from alembic.config import Config
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import event
from sqlalchemy.exc import (
    ArgumentError,
    DBAPIError,
    DisconnectionError,
    NoSuchModuleError,
    SQLAlchemyError,
)

LOCK_WAIT_S = 5
"""How long a call waits for a lock, or for a server to be reached [s]."""

MIGRATION_WAIT_S = 30
"""How long an SQLite file that is opened may be locked, as by another's migration [s]."""

MIGRATION_LOCK = 20_110_001
"""Key of the advisory lock that lets one process at a time migrate a PostgreSQL store."""

REASONS = {
    sqlite3.SQLITE_BUSY: "another process has locked it",
    sqlite3.SQLITE_FULL: "no space left",
    sqlite3.SQLITE_IOERR: "its disk fails",
    sqlite3.SQLITE_CANTOPEN: "its file is gone or may not be opened",
    sqlite3.SQLITE_CORRUPT: "its file is damaged",
    sqlite3.SQLITE_NOTADB: "its file is damaged",
    sqlite3.SQLITE_READONLY: "its file was moved or may not be written",
}
"""What SQLite's error codes mean for a store."""


class StoreError(Exception):
    """The job store cannot be used; the message says why and what to do."""


@dataclass(frozen=True, slots=True)
class Database:
    """A store's database: its readers take no lock, and wait for no writer.

    Attributes
    ----------
    writing
        Each transaction holds the write lock from its first statement on.
    reading
        Each statement sees what is committed; on SQLite nothing can be written.
    """

    writing: sa.Engine
    reading: sa.Engine

    def close(self) -> None:
        """Let go of all connections."""
        self.writing.dispose()
        self.reading.dispose()


def url_of(file: Path) -> str:
    """Return the URL of a store in an SQLite file.

    The path may have any characters.
    """
    return sa.URL.create("sqlite", database=str(file)).render_as_string()


def open_database(url: str) -> Database:
    """Return the database of a store, its schema made or migrated.

    Parameters
    ----------
    url
        Of an SQLite file or a PostgreSQL database.

    Returns
    -------
    Database
        Engines that write and read.

    Raises
    ------
    StoreError
        If the URL is none, or the schema is newer than this version knows.
    sqlalchemy.exc.DBAPIError
        If the database does not answer, or is none.
    """
    try:
        parsed = sa.make_url(url)
        if parsed.get_backend_name() == "postgresql":
            return _postgres(parsed.set(drivername="postgresql+psycopg"))
        if parsed.get_backend_name() == "sqlite" and parsed.database:
            return _sqlite(Path(parsed.database).absolute())
    except (ArgumentError, NoSuchModuleError):
        raise StoreError("the URL of the job store cannot be read") from None
    except ModuleNotFoundError as error:
        raise StoreError(f"install shapersmith[postgres]: {error}") from None
    except OSError as error:
        raise StoreError(f"no folder for the job store: {error}") from None
    raise StoreError("a job store is sqlite:///FILE or postgresql://..., no other database")


def _postgres(url: sa.URL) -> Database:
    given = {} if "connect_timeout" in url.query else {"connect_timeout": LOCK_WAIT_S}
    migrating = sa.create_engine(url, poolclass=sa.NullPool, connect_args=given)
    _migrate(migrating)

    def engine(**options: Any) -> sa.Engine:  # noqa: ANN401 - SQLAlchemy's own
        # A connection may have died since it was last used: ask it first.
        made = sa.create_engine(url, pool_pre_ping=True, connect_args=given, **options)
        event.listen(made, "connect", _wait_for_locks)
        return made

    return Database(engine(), engine(isolation_level="AUTOCOMMIT"))


def _wait_for_locks(connection: Any, record: object) -> None:  # noqa: ANN401
    del record
    connection.execute(f"SET lock_timeout = '{LOCK_WAIT_S}s'")
    connection.commit()


def _sqlite(file: Path) -> Database:
    file.parent.mkdir(parents=True, exist_ok=True)
    migrating = _sqlite_engine(file, "rwc", wait_s=MIGRATION_WAIT_S, poolclass=sa.NullPool)
    event.listen(migrating, "connect", _log_ahead)
    _migrate(migrating)
    # From here on a file that is gone is not made anew, empty.
    writing = _sqlite_engine(file, "rw", wait_s=LOCK_WAIT_S)
    event.listen(writing, "begin", _lock)
    reading = _sqlite_engine(file, "rw", wait_s=LOCK_WAIT_S)
    event.listen(reading, "connect", _set_read_only)
    for engine in (writing, reading):
        _keep_to(file, engine)
    return Database(writing, reading)


def _sqlite_engine(file: Path, mode: str, *, wait_s: float, **options: Any) -> sa.Engine:  # noqa: ANN401
    def connect() -> sqlite3.Connection:
        connection = sqlite3.connect(
            f"{file.as_uri()}?mode={mode}",
            uri=True,
            timeout=wait_s,
            isolation_level=None,  # transactions are begun here, not by the driver
            check_same_thread=False,
        )
        # What is no UTF-8 is damaged: it is seen, and keeps nobody from reading other rows.
        connection.text_factory = lambda text: text.decode(errors="replace")
        # A killed process loses nothing; a lost machine may lose the last commits, never the store.
        connection.execute("PRAGMA synchronous=NORMAL")
        return connection

    return sa.create_engine("sqlite://", creator=connect, **{"poolclass": sa.QueuePool, **options})


def _log_ahead(connection: sqlite3.Connection, record: object) -> None:
    """Have the file, for good, written by way of a log, beside which readers go on."""
    del record
    connection.execute("PRAGMA journal_mode=WAL")


def _set_read_only(connection: sqlite3.Connection, record: object) -> None:
    del record
    connection.execute("PRAGMA query_only=ON")


def _lock(connection: sa.Connection) -> None:
    # A transaction that read first and then wrote could find itself overtaken, and fail.
    connection.exec_driver_sql("BEGIN IMMEDIATE")


def _keep_to(file: Path, engine: sa.Engine) -> None:
    """Drop connections to a file that is the store's no more: what they wrote would be lost."""

    def note_file(connection: object, record: Any) -> None:  # noqa: ANN401
        del connection
        record.info["file"] = _identity(file)

    def check_file(connection: object, record: Any, proxy: object) -> None:  # noqa: ANN401
        del connection, proxy
        if record.info["file"] != _identity(file):
            raise DisconnectionError("the file of the job store was replaced")

    event.listen(engine, "connect", note_file)
    event.listen(engine, "checkout", check_file)


def _identity(file: Path) -> tuple[int, int] | None:
    try:
        found = file.stat()
    except OSError:
        return None
    return found.st_dev, found.st_ino


def _migrate(engine: sa.Engine) -> None:
    """Bring a database to the newest schema; one that has it is read only, locked or not."""
    config = Config()
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations"))
    scripts = ScriptDirectory.from_config(config)
    with engine.connect() as connection:
        if MigrationContext.configure(connection).get_current_revision() == (
            scripts.get_current_head()
        ):
            return
        if engine.dialect.name == "postgresql":
            connection.execute(sa.select(sa.func.pg_advisory_xact_lock(MIGRATION_LOCK)))
        else:
            _lock(connection)
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
        connection.commit()


def disk_full(error: DBAPIError) -> bool:
    """Whether a database refused for want of space."""
    return "disk is full" in str(error.orig) or "No space left" in str(error.orig)


def reason_of(error: SQLAlchemyError) -> str:
    """Return in words why a database refused.

    The words are fit for those who ask over HTTP: they name no path and no host.
    """
    cause = error.orig if isinstance(error, DBAPIError) else None
    code = getattr(cause, "sqlite_errorcode", 0) & 0xFF
    if code in REASONS:
        return REASONS[code]
    if isinstance(error, DBAPIError) and disk_full(error):
        return "no space left"
    if "no such table" in str(cause) or "does not exist" in str(cause):
        return "its tables are gone"
    return "the database does not answer"
