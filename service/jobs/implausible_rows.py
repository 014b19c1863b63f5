"""Values of a table's specification that are hardly meant."""

from collections.abc import Iterator
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from schemas.pointers import json_pointer
from schemas.tables import TableRequest
from schemas.usual_ranges import Range
from service.implausible import implausible_values

IN_DESIGN = ("/plant", "/actuator")
"""Where pointers begin that lead into the design which is varied."""


def implausible_in_table(request: TableRequest) -> list[tuple[str, Range, float, float]]:
    """Return what is hardly meant in a specification.

    Parameters
    ----------
    request
        The specification; `plan_of` has found it right.

    Returns
    -------
    list of tuple
        As `implausible_values` returns it.
    """
    design = request.design
    looked_at = SimpleNamespace(
        plant=design.plant,
        actuator=design.actuator,
        axes=request.axes,
        designs=_Listed(request) if request.designs else None,
    )
    return [
        (f"/design{place}" if place.startswith(IN_DESIGN) else place, usual, quantity, compared)
        for place, usual, quantity, compared in implausible_values(looked_at)
    ]


@dataclass(frozen=True, slots=True)
class _Listed:
    """The designs that a specification lists."""

    request: TableRequest

    def numbers(self, pointer: str) -> Iterator[tuple[str, str, float]]:
        """Yield the least and the largest value of each field that varies."""
        table = self.request.to_design()
        if table.listed is None:
            return
        for path, values in zip(table.listed_paths, table.listed.T, strict=True):
            for row in sorted({int(np.argmin(values)), int(np.argmax(values))}):
                place = json_pointer((str(row), *path))
                yield f"{pointer}{place}", f"{path[0]}/{path[-1]}", float(values[row])
