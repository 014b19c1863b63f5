"""The command `schemas`: a file for each."""

import sys
from pathlib import Path

from service.cli.given_files import UsageError
from service.files import NotReplaceableError
from service.wire_schemas import write_schemas


def write_into(folder: Path) -> int:
    """Write every schema into a folder, and print the names of the files.

    Parameters
    ----------
    folder
        The folder, which is made if there is none.

    Returns
    -------
    int
        Exit status, 0.

    Raises
    ------
    UsageError
        If a file cannot be written.
    """
    try:
        written = write_schemas(folder)
    except NotReplaceableError as error:
        raise UsageError(str(error)) from None
    except OSError as error:
        raise UsageError(f"cannot write into {folder}: {error.strerror}") from None
    sys.stdout.write("".join(f"{path}\n" for path in written))
    return 0
