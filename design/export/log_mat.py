"""A log as MATLAB's .mat, version 5: ``load`` gives one struct, ``log``, a column a field."""

import io
from collections.abc import Mapping, Sequence

import numpy as np

from design.export.mat_header import HEADER_TEXT_BYTES, header_text

NAME = "log"


def log_mat(columns: Mapping[str, Sequence[float]], tool: str) -> bytes:
    """Return a log as .mat, with no date in it.

    Parameters
    ----------
    columns
        Its columns by name, each of n numbers.
    tool
        Name and version of the program, for the head of the file.

    Returns
    -------
    bytes
        The file; each field of the struct is n by 1.
    """
    from scipy.io import savemat  # noqa: PLC0415 - most answers are text

    file = io.BytesIO()
    struct = {
        name: np.asarray(values, dtype=np.float64)[:, None] for name, values in columns.items()
    }
    savemat(file, {NAME: struct}, format="5", do_compression=False, long_field_names=True)
    return header_text(tool) + file.getvalue()[HEADER_TEXT_BYTES:]
