"""A run as a log: its columns, and what is said below them."""

from collections.abc import Iterable, Sequence

from design.export.log_mat import log_mat
from schemas.runs import AxisHistory, RunResponse
from service.version import version


def run_rows(response: RunResponse) -> Iterable[Sequence[object]]:
    """Yield the columns of a log, then a row for each time.

    Names without an axis are those of x, as in the answer.
    """
    columns = log_columns(response)
    yield list(columns)
    yield from zip(*columns.values(), strict=True)


def log_columns(response: RunResponse) -> dict[str, Sequence[float]]:
    """Return the columns of a log by name, each of one length."""
    history, sensors = response.history, response.sensors
    columns: dict[str, Sequence[float]] = {"times_s": history.times_s}
    columns |= _axis_columns(history, "")
    if history.y is not None:
        columns |= _axis_columns(history.y, "y_")
    if history.cable_length_m is not None:
        columns["cable_length_m"] = history.cable_length_m
    if sensors is not None:
        told = {name: getattr(sensors, name) for name in type(sensors).model_fields}
        columns |= {name: values for name, values in told.items() if values is not None}
    return columns


def _axis_columns(history: AxisHistory, ahead: str) -> dict[str, Sequence[float]]:
    told = {name: getattr(history, name) for name in AxisHistory.model_fields}
    return {f"{ahead}{name}": values for name, values in told.items() if values is not None}


def as_mat(response: RunResponse) -> bytes:
    """Return the log of a run as a file for MATLAB, the same for the same run."""
    return log_mat(log_columns(response), f"shapersmith {version()}")


def run_lines(response: RunResponse) -> list[str]:
    """Return what is said of a run below its log."""
    history = response.history
    swing = max(map(abs, history.deflection_m))
    if history.y is not None:
        swing = max(swing, max(map(abs, history.y.deflection_m)))
    last = max((event.last_switch_s for event in response.events), default=0.0)
    return [
        f"events      {len(response.events)}, the last switch at {last:.9g} s",
        f"deflection  {swing:.4g} m at most",
        "residual    "
        + (
            "not defined, it has died away before the drive settles"
            if response.residual is None
            else f"{100 * response.residual:.4g} % of an unshaped step"
        ),
    ]
