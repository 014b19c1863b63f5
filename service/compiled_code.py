"""Where machine code is kept that tables compile at their first use on a machine."""

import os
import tempfile
from pathlib import Path

VARIABLE = "NUMBA_CACHE_DIR"
"""Names a folder to numba."""

CODE = Path(__file__).parents[1] / "design" / "tables"
"""The folder of what is compiled, which has the machine code beside it if that can be written."""


def keep_in(data_dir: str) -> None:
    """Keep machine code with the data if it cannot be beside the source.

    Processes that are started from now on keep it there too. A user without a home, who may not
    write where the code is, would otherwise compile it anew in each process. A folder that
    `VARIABLE` names already stays.

    Parameters
    ----------
    data_dir
        Folder of the job store and of tables' files.
    """
    if VARIABLE not in os.environ and not _can_be_written(CODE / "__pycache__"):
        os.environ[VARIABLE] = str(Path(data_dir).absolute() / "compiled")


def holds_nothing() -> bool:
    """Return whether no machine code is kept yet.

    False where nobody knows the folder: numba has one of the user's then.
    """
    named = os.environ.get(VARIABLE)
    if named is None and not _can_be_written(CODE / "__pycache__"):
        return False
    folder = CODE / "__pycache__" if named is None else Path(named)
    return not any(folder.rglob("*.nbi"))


def _can_be_written(folder: Path) -> bool:
    """Return whether files can be made in a folder; whoever may do all finds it out by trying."""
    try:
        folder.mkdir(exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False
