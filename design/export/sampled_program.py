"""Rows on the samples of a controller, as a program lists them: whole numbers of samples."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from design.export.program import Listing
from design.tables.columns import varied_paths
from design.tables.rows import WITH_DESIGN, TableHead, subject_of
from design.types import FloatArray

SAME_SAMPLE_TIME = 1e-6
"""Sample times that differ by less are the same, as a share: what single precision rounds [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SampledListing:
    """Rows of a table on samples.

    Attributes
    ----------
    samples
        Number of the sample of each impulse, from the first on, shape (rows, impulses). Where a row
        has fewer impulses than others, that of its last, and 0 in a row without a design.
    amplitudes
        Heights of the impulses, shape (rows, impulses) [-]; 0 beyond those of a row. A row without
        a design lets the command pass: 1, 0, 0, ...
    sample_times_s
        Sample time of each row, shape (rows,) [s]; 0 in a row without a design.
    """

    samples: NDArray[np.int_]
    amplitudes: FloatArray
    sample_times_s: FloatArray

    @property
    def cells(self) -> int:
        """Cells of a delay line that holds any row."""
        return int(self.samples.max(initial=0)) + 1


def sampled_listing(head: TableHead, rows: Listing) -> SampledListing:
    """Return the rows of a table on samples by their whole numbers.

    Parameters
    ----------
    head
        The table's head.
    rows
        Its rows.

    Returns
    -------
    SampledListing
        As a delay line takes them.
    """
    subject, paths = subject_of(head), varied_paths(head)
    count = len(rows.status)
    samples = np.zeros((count, head.impulses), dtype=int)
    amplitudes = np.tile(np.eye(1, head.impulses), (count, 1))
    sample_times_s = np.zeros(count)
    for row in np.flatnonzero(np.isin(rows.status, WITH_DESIGN)).tolist():
        grid = subject.grid_at(paths, rows.numbers[row, : len(paths)].tolist())
        sample_time_s = np.nan if grid is None else grid.sample_time_s
        held = ~np.isnan(rows.times_s[row])
        times_s = rows.times_s[row, held]
        numbers = np.rint((times_s - times_s[0]) / sample_time_s).astype(int)
        samples[row] = numbers[-1]
        samples[row, : numbers.size] = numbers
        amplitudes[row] = 0.0
        amplitudes[row, : numbers.size] = rows.amplitudes[row, held]
        sample_times_s[row] = sample_time_s
    return SampledListing(samples=samples, amplitudes=amplitudes, sample_times_s=sample_times_s)
