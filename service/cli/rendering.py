"""Answers as text for people and spreadsheets."""

import csv
import html
import io
import json
from collections.abc import Iterable, Sequence
from typing import Any

from schemas.catalogue import Catalogue
from schemas.certificates import CertificateOut, ClaimOut
from schemas.designed_shaper import ShaperOut
from schemas.designs import DesignResponse
from schemas.fits import FitOut
from schemas.insensitivity import InsensitivityOut
from schemas.maneuvers import ManeuverResponse, ProgramOut
from schemas.maps import MapResponse
from schemas.recommendations import CandidateOut, RecommendationResponse
from schemas.runs import RunResponse
from schemas.sensitivity import SensitivityResponse
from schemas.sensitivity_curves import SensitivityOut
from schemas.simulations import SimulationResponse
from schemas.solver import SolverOut
from schemas.trace import TraceStepOut
from schemas.warnings import WarningOut
from service.cli.drive_off import drive_off_lines, usual_drive_off
from service.cli.plant_lines import (
    DRIVES,
    PLANTS,
    drive_lines,
    large_swing_lines,
    only_hertz,
    plant_lines,
)
from service.cli.recommended import legend, next_command, shown_rows
from service.cli.run_log import run_lines, run_rows

Response = (
    DesignResponse
    | SensitivityResponse
    | FitOut
    | SimulationResponse
    | RunResponse
    | ManeuverResponse
    | MapResponse
    | RecommendationResponse
    | Catalogue
)


HISTORIES = (SensitivityResponse, SimulationResponse, RunResponse, ManeuverResponse)
"""Answers whose table is a curve or a motion, which nobody reads line by line."""

MAX_TEXT_ROWS = 40
"""Rows of such a table as text; of a longer one these are shown:"""

FIRST_ROWS, LAST_ROWS = 10, 5

MAX_HTML_ROWS = 20
"""Rows of a table in a notebook; a longer one is cut."""

HTML_DIGITS = 6


def as_csv(response: Response) -> str:
    """Return the table of an answer as CSV, floats in full."""
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows(_rows(response))
    return out.getvalue()


def as_table(response: Response, request: bytes = b"") -> str:
    """Return an answer as aligned text with its findings below.

    Parameters
    ----------
    response, request
        The answer, and what was asked as JSON: its plant is named, where it is given.

    Returns
    -------
    str
        Lines, each with its end.
    """
    rows = list(_shown_rows(response))
    left_out = 0
    if isinstance(response, HISTORIES) and len(rows) > MAX_TEXT_ROWS:
        left_out = len(rows) - 1 - FIRST_ROWS - LAST_ROWS
        gap = ["…"] * len(rows[0])
        rows = [*rows[: FIRST_ROWS + 1], gap, *rows[-LAST_ROWS:]]
    # Compared at a glance, a row of many numbers each.
    digits = 4 if isinstance(response, RecommendationResponse) else 9
    cells = [[_cell(value, digits) for value in row] for row in rows]
    widths = [max(len(row[column]) for row in cells) for column in range(len(cells[0]))]
    lines = [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in cells
    ]
    if left_out:
        lines.append(f"{left_out:,} rows are not shown; --format csv has all")
    return "\n".join([*lines, *_findings(response, request)]) + "\n"


def as_html(response: Response, request: bytes = b"") -> str:
    """Return an answer as a small table of HTML with its findings below.

    Parameters
    ----------
    response, request
        As of `as_table`.

    Returns
    -------
    str
        A table, and the findings as they are.
    """
    head, *rows = _shown_rows(response)
    shown = rows if len(rows) <= MAX_HTML_ROWS else [*rows[: MAX_HTML_ROWS - 1], ["…"]]
    lines = [_html_row("th", head), *(_html_row("td", row) for row in shown)]
    found = html.escape("\n".join(_findings(response, request)).strip())
    return f"<table>{''.join(lines)}</table><pre>{found}</pre>"


def _html_row(tag: str, row: Iterable[object]) -> str:
    cells = (f"<{tag}>{html.escape(_cell(value, HTML_DIGITS))}</{tag}>" for value in row)
    return f"<tr>{''.join(cells)}</tr>"


def _cell(value: object, digits: int) -> str:
    return f"{value:.{digits}g}" if isinstance(value, float) else str(value)


def _shown_rows(response: Response) -> Iterable[Sequence[object]]:
    """Yield what people read: as the rows of the answer, or in other units."""
    return shown_rows(response) if isinstance(response, RecommendationResponse) else _rows(response)


def _rows(response: Response) -> Iterable[Sequence[object]]:
    """Yield a header and the rows of the table that an answer is about."""
    if isinstance(response, DesignResponse):
        yield "impulse", "time_s", "amplitude"
        impulses = response.shaper.impulses
        for number, (time, amplitude) in enumerate(
            zip(impulses.times_s, impulses.amplitudes, strict=True), start=1
        ):
            yield number, time, amplitude
    elif isinstance(response, SensitivityResponse):
        yield "frequency_ratio", "residual"
        curve = response.sensitivity
        yield from zip(curve.frequency_ratio, curve.residual, strict=True)
    elif isinstance(response, SimulationResponse):
        columns = ["times_s", "command_m_s", "velocity_m_s", "deflection_m", "angle_rad"]
        told = [name for name in columns if getattr(response, name) is not None]
        yield told
        yield from zip(*(getattr(response, name) for name in told), strict=True)
    elif isinstance(response, RunResponse):
        yield from run_rows(response)
    elif isinstance(response, ManeuverResponse):
        yield from _move_rows(response)
    elif isinstance(response, MapResponse):
        yield from _map_rows(response)
    elif isinstance(response, RecommendationResponse):
        yield from _candidate_rows(response)
    elif isinstance(response, FitOut):
        yield "impulse", *(f"c{power}" for power in range(response.degree + 1))
        for number, row in enumerate(response.coefficients, start=1):
            yield number, *row
    else:
        yield "kind", "claims", "actuators", "summary", "source"
        for entry in response.shapers:
            yield (
                entry.kind,
                " ".join(entry.claims),
                " ".join(entry.actuators),
                entry.summary,
                entry.source,
            )


def _move_rows(response: ManeuverResponse) -> Iterable[Sequence[object]]:
    """Yield the program where there is one, else the steps of the command."""
    program, command = response.program, response.command
    if program is not None:
        yield "time_s", "velocity_m_s", "position_m"
        yield from zip(program.times_s, program.velocity_m_s, program.position_m, strict=True)
    else:
        yield "step", "time_s", "amplitude"
        steps = zip(command.times_s, command.amplitudes, strict=True)
        yield from ((number, *step) for number, step in enumerate(steps, start=1))


def _map_rows(response: MapResponse) -> Iterable[Sequence[object]]:
    """Yield a table of two axes, or, of a curve or of several numbers a cell, a row for each cell.

    A cell without a value is empty.
    """
    x, y, told = response.x, response.y, getattr(response, response.quantity)
    several = response.quantity in {"times_s", "branch"}
    if y is not None and not several:
        yield f"{y.field} by {x.field}", *x.values
        for value, row in zip(y.values, told, strict=True):
            yield value, *("" if cell is None else cell for cell in row)
        return
    yield *([] if y is None else [y.field]), x.field, response.quantity
    rows = (
        [((), told)]
        if y is None
        else [((value,), row) for value, row in zip(y.values, told, strict=True)]
    )
    for ahead, row in rows:
        for value, cell in zip(x.values, row, strict=True):
            numbers = cell if isinstance(cell, list) else [cell]
            yield *ahead, value, *("" if number is None else number for number in numbers)


def _candidate_rows(response: RecommendationResponse) -> Iterable[Sequence[object]]:
    """Yield a row for each shaper, numbered if it meets all that is asked, else with what fails."""
    limited = response.recommended.ramp_end_s is not None
    yield (
        "rank",
        "shaper",
        "duration_s",
        *(["ramp_end_s"] if limited else []),
        "worst_residual",
        "lower_ratio",
        "upper_ratio",
        "high_mode_gain",
        "peak_command",
        "delay_s",
        "smoothing_s2",
        "misses",
    )
    for rank, one in enumerate([response.recommended, *response.runners_up], start=1):
        yield rank, *_candidate_row(one)
    for one in response.others:
        yield "-", *_candidate_row(one)


def _candidate_row(candidate: CandidateOut) -> Sequence[object]:
    band = candidate.insensitivity
    return (
        candidate.name,
        candidate.duration_s,
        *([] if candidate.ramp_end_s is None else [candidate.ramp_end_s]),
        "" if candidate.worst_residual is None else candidate.worst_residual,
        *_edges(band),
        candidate.high_mode_gain,
        candidate.peak_command,
        candidate.delay_s,
        candidate.smoothing_s2,
        " ".join(one.requirement for one in candidate.requirements if not one.met),
    )


def _edges(band: InsensitivityOut | None) -> Sequence[object]:
    """Return the edges, each empty where there is none."""
    edges = (None, None) if band is None else (band.lower_ratio, band.upper_ratio)
    return ["" if edge is None else edge for edge in edges]


def _findings(response: Response, request: bytes) -> list[str]:
    asked: dict[str, Any] = json.loads(request) if request else {}
    plant = PLANTS.validate_json(json.dumps(asked["plant"])) if "plant" in asked else None
    hertz = None if plant is None else only_hertz(plant)
    about = [] if plant is None else plant_lines(plant)
    drive = DRIVES.validate_json(json.dumps(asked["actuator"])) if "actuator" in asked else None
    about += [] if drive is None else drive_lines(drive)
    if isinstance(response, DesignResponse):
        return [
            "",
            *about,
            _shaper(response.shaper),
            _certificate(response.certificate),
            *_shortest(response.solver),
            f"residual    {100 * response.residual:.4g} % with the actuator given",
            *large_swing_lines(response.large_swing),
            *([] if response.sensitivity is None else _band(response.sensitivity, hertz)),
            *(
                []
                if response.large_swing
                else drive_off_lines(
                    response.drive or usual_drive_off(response.shaper.impulses, plant, drive)
                )
            ),
            *([] if response.fit is None else _fit(response.fit)),
            *_trace(response.trace or []),
            *_warnings(response.warnings),
        ]
    if isinstance(response, SensitivityResponse):
        return [
            "",
            *about,
            f"residual    {100 * response.residual:.4g} % at the nominal",
            *_band(response.sensitivity, hertz),
            *drive_off_lines(response.drive),
            *_warnings(response.warnings),
        ]
    if isinstance(response, FitOut):
        return ["", *_fit(response), *_warnings(response.warnings)]
    if isinstance(response, ManeuverResponse):
        return [
            "",
            *about,
            f"move        {response.distance_m:.9g} m in {response.duration_s:.9g} s, "
            f"pulse {response.pulse_s:.9g} s{', solved as one' if response.joint else ''}",
            _certificate(response.certificate),
            f"residual    {100 * response.residual:.4g} % with the actuator given",
            *_program_lines(response.program),
            *_warnings(response.warnings),
        ]
    if isinstance(response, SimulationResponse):
        return ["", *about, *_swings(response), *_warnings(response.warnings)]
    if isinstance(response, RunResponse):
        return ["", *about, *run_lines(response), *_warnings(response.warnings)]
    if isinstance(response, RecommendationResponse):
        told = [f"why         {reason}" for reason in response.why]
        return [
            "",
            *legend(response),
            "",
            *about,
            *told,
            *_warnings(response.recommended.warnings),
            *(f"refused     {one.name}: {one.reason}" for one in response.refused),
            *([f"next        {next_command(response, asked)}"] if asked else []),
            *(["", *response.firmware_lines] if response.firmware_lines else []),
        ]
    if isinstance(response, MapResponse):
        return ["", *_warnings(response.warnings)] if response.warnings else []
    return []


def _certificate(certificate: CertificateOut) -> str:
    """Say what is proven, and for which drive."""
    claims = ", ".join(
        f"{_claimed(claim)} {claim.value:.2g} <= {claim.limit:.2g}" for claim in certificate.claims
    )
    if not certificate.verified:
        return f"certificate NOT VERIFIED: {claims}"
    if certificate.actuator == "ideal":
        return f"certificate verified for an ideal actuator only, not for the one given: {claims}"
    return f"certificate verified: {claims}"


def _claimed(claim: ClaimOut) -> str:
    """Return what is claimed: of a band its ends, of a mode after the first its number."""
    mode = "" if claim.mode is None else f" of mode {claim.mode + 1}"
    band = "" if claim.band is None else f" {claim.band[0]:.4g} to {claim.band[1]:.4g}:"
    return f"{claim.quantity}{mode}{band}"


def _warnings(warnings: Iterable[WarningOut]) -> list[str]:
    return [f"warning     {warning.code}: {warning.detail}" for warning in warnings]


def _trace(steps: Iterable[TraceStepOut]) -> list[str]:
    """Say what each step of the search did."""
    return [
        f"trace       {number}. {step.stage}: {step.method} from {step.start}, {step.outcome}"
        + (f" after {step.iterations} iterations" if step.iterations else "")
        + ("" if step.duration_s is None else f", {step.duration_s:.6g} s")
        + (f": {step.detail}" if step.detail else "")
        for number, step in enumerate(steps, start=1)
    ]


def _program_lines(program: ProgramOut | None) -> list[str]:
    if program is None:
        return []
    return [f"program     {100 * program.residual:.4g} % as it is played on its samples"]


def _shaper(shaper: ShaperOut) -> str:
    end_s = shaper.ramp_end_s
    ends = "" if end_s is None else f", its last ramp ends at {end_s:.9g} s"
    return f"shaper      {shaper.kind}, {shaper.duration_s:.9g} s{ends}"


def _shortest(solver: SolverOut) -> list[str]:
    if solver.lower_bound_s is None or solver.gap is None:
        return []
    return [f"shortest    none below {solver.lower_bound_s:.9g} s, gap {solver.gap:.2g}"]


def _band(curve: SensitivityOut, hertz: float | None) -> list[str]:
    band = curve.insensitivity
    if band is None:
        return ["insensitive nowhere: the nominal itself is above the tolerance"]
    reach = f"{band.searched_from_ratio:.5g} to {band.searched_to_ratio:.5g}"
    of = "" if hertz is None else _in_hertz(band, hertz)
    told = [f"insensitive {reach} of the frequency{of} at {100 * band.tolerance:g} %"]
    if band.lower_ratio is None:
        told.append(f"no lower edge down to {band.searched_from_ratio:.5g} times")
    if band.upper_ratio is None:
        told.append(f"no upper edge up to {band.searched_to_ratio:.5g} times")
    if band.width is not None:
        told.append(f"width {band.width:.5f}")
    return [", ".join(told)]


def _in_hertz(band: InsensitivityOut, hertz: float) -> str:
    ends = band.searched_from_ratio * hertz, band.searched_to_ratio * hertz
    return f" ({ends[0]:.5g} to {ends[1]:.5g} Hz)"


def _swings(response: SimulationResponse) -> list[str]:
    lines = []
    for name, swing in (("peak", response.peaks), ("remaining", response.remaining)):
        if swing is not None:
            angle = "" if swing.angle_rad is None else f", {swing.angle_rad:.6g} rad"
            lines.append(f"{name:<11} {swing.deflection_m:.6g} m{angle}")
    if response.residual is not None:
        lines.append(f"residual    {100 * response.residual:.4g} % of an unshaped step")
    return lines


def _fit(fit: FitOut) -> list[str]:
    variable = fit.variable
    return [
        f"fit         {fit.formula}",
        f"            x = {variable.is_}, {variable.from_:.6g} to {variable.to:.6g}",
        f"            residual at most {100 * fit.worst_residual:.3g} %, "
        f"{fit.worst_timing_error_s:.3g} s off at most, on {fit.checked_points} points",
    ]
