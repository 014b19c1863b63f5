"""A recommendation for people: columns in per cent and hertz, what they are, what to run next."""

import json
from collections.abc import Callable, Iterator, Sequence
from math import tau
from typing import Any, NamedTuple

from schemas.recommendations import CandidateOut, RecommendationResponse
from service.cli.plant_lines import PLANTS


class Column(NamedTuple):
    """A column of the table: its heading, what it is, and its cell for a shaper."""

    name: str
    legend: str
    cell: Callable[[CandidateOut], object]


def _off_residual(one: CandidateOut) -> float | None:
    """Return the residual with the drive off, where that is asked; None where there is none."""
    told = (each.value for each in one.requirements if each.requirement == "drive_off_by")
    return next(told, None)


def _off_cell(one: CandidateOut) -> object:
    residual = _off_residual(one)
    return "" if residual is None else 100 * residual


DRIVE_OFF = Column("drive_off_%", "the same, with the drive off as well", _off_cell)
"""The column of a recommendation for a drive that may be off."""


def _columns(response: RecommendationResponse) -> list[Column]:
    limited = response.recommended.ramp_end_s is not None
    ends = Column(
        "ramp_end_s",
        "when the last ramp ends, after the first step [s]",
        lambda one: one.ramp_end_s,
    )
    return [
        Column("duration_s", "time that it adds to a move [s]", lambda one: one.duration_s),
        *([ends] if limited else []),
        Column(
            "residual_%",
            "largest residual in the ranges asked, % of an unshaped step",
            lambda one: "" if one.worst_residual is None else 100 * one.worst_residual,
        ),
        *([] if _off_residual(response.recommended) is None else [DRIVE_OFF]),
        *_edges(response),
        Column(
            "high_mode_gain",
            "largest residual at 1.5 to 10 times the frequency, in unshaped steps",
            lambda one: one.high_mode_gain,
        ),
        Column(
            "peak_command", "largest size of the command, in steps", lambda one: one.peak_command
        ),
        Column("delay_s", "mean time of its impulses [s]", lambda one: one.delay_s),
        Column(
            "smoothing_s2",
            "times an acceleration, how far a shaped path is off [s^2]",
            lambda one: one.smoothing_s2,
        ),
        Column(
            "misses",
            f"limits that it does not meet{_as_played(response)}",
            lambda one: " ".join(_missed(one)),
        ),
    ]


def _missed(one: CandidateOut) -> Iterator[str]:
    """Yield the limits that a shaper misses: of a firmware only what is not missed without it."""
    missed = [told for told in one.requirements if not told.met]
    beyond = any(told.requirement == "tolerance" for told in missed)
    for told in missed:
        if told.requirement == "drive_off_by" and beyond:
            continue  # what is above the tolerance already
        if told.requirement != "firmware":
            yield told.requirement
        elif told.value is None:
            yield "not_in_firmware"
        elif not beyond:
            yield "tolerance_as_played"


def _as_played(response: RecommendationResponse) -> str:
    asked = [told.requirement for told in response.recommended.requirements]
    if "firmware" not in asked:
        return ""
    return "; tolerance_as_played: only as the firmware plays it; not_in_firmware: it has none such"


def _edges(response: RecommendationResponse) -> list[Column]:
    """Return the columns of both ends of the insensitive band: in hertz for a plant of one mode."""
    tolerance = next(
        one.limit for one in response.recommended.requirements if one.requirement == "tolerance"
    )
    within = "" if tolerance is None else f" within {100 * tolerance:g} %"
    first, *others = response.designed_for
    unit, scale, of = "ratio", 1.0, "over the plant's [-]"
    if not others:
        middle = (response.band.lower_ratio + response.band.upper_ratio) / 2
        unit, scale, of = "hz", first.natural_frequency_rad_s / tau / middle, "[Hz]"

    def at(end: str) -> Callable[[CandidateOut], object]:
        def cell(one: CandidateOut) -> object:
            ratio = None if one.insensitivity is None else getattr(one.insensitivity, end)
            return "" if ratio is None else scale * ratio

        return cell

    return [
        Column(f"from_{unit}", f"least true frequency{within} {of}", at("lower_ratio")),
        Column(f"to_{unit}", f"largest true frequency{within} {of}", at("upper_ratio")),
    ]


def shown_rows(response: RecommendationResponse) -> Iterator[Sequence[object]]:
    """Yield headings, then a row for each shaper, ranked if it meets all."""
    columns = _columns(response)
    yield "rank", "shaper", *(column.name for column in columns)
    for rank, one in enumerate([response.recommended, *response.runners_up], start=1):
        yield rank, one.name, *(column.cell(one) for column in columns)
    for one in response.others:
        yield "-", one.name, *(column.cell(one) for column in columns)


def legend(response: RecommendationResponse) -> list[str]:
    """Return what each column is, with its unit."""
    columns = _columns(response)
    width = max(len(column.name) for column in columns)
    return [f"legend      {column.name:<{width}}  {column.legend}" for column in columns]


def next_command(response: RecommendationResponse, request: dict[str, Any]) -> str:
    """Return the command that designs the recommended shaper.

    Parameters
    ----------
    response, request
        The recommendation, and what was asked.

    Returns
    -------
    str
        For a shell; the body between the quotes is one of ``POST /v1/designs``.
    """
    modes = [one.model_dump() for one in response.designed_for]
    plant = PLANTS.validate_json(json.dumps(request["plant"]))
    given = [
        {
            "natural_frequency_rad_s": one.natural_frequency_rad_s,
            "damping_ratio": one.damping_ratio,
        }
        for one in plant.to_design().modes
    ]
    as_given = plant.kind == "scheduled" or given == modes
    kinds = {"kind": "mode", **modes[0]} if len(modes) == 1 else {"kind": "modes", "modes": modes}
    body = {
        "plant": request["plant"] if as_given else kinds,
        "actuator": request["actuator"],
        "shaper": response.recommended.shaper,
    }
    return f"echo '{json.dumps(body)}' | shapersmith design - --format table"
