"""What is said of a value that is hardly meant, and where in an answer."""

from collections.abc import Iterable

from pydantic import BaseModel

from schemas.recommendations import RecommendationResponse
from schemas.usual_ranges import USUAL_RANGES, Range
from schemas.warnings import WarningOut

THOUSAND = 1000.0
"""Between two usual units of a quantity: most slips are one of them."""


def with_warnings(answer: BaseModel, values: Iterable[tuple[str, str, float, float]]) -> BaseModel:
    """Return an answer with a warning for each value, ahead of others.

    Parameters
    ----------
    answer
        An answer with warnings, or a recommendation: those of the recommended shaper.
    values
        As of `implausible_values`.

    Returns
    -------
    BaseModel
        The answer; as it is where it has no warnings.
    """
    told = [
        WarningOut(
            code="implausible_value",
            detail=meaning(pointer, USUAL_RANGES[pointer.split("/")[1], name], quantity, compared),
        )
        for pointer, name, quantity, compared in values
    ]
    if isinstance(answer, RecommendationResponse):
        best = answer.recommended
        warned = best.model_copy(update={"warnings": [*told, *best.warnings]})
        return answer.model_copy(update={"recommended": warned})
    own: list[WarningOut] | None = getattr(answer, "warnings", None)
    if own is None:
        return answer
    return answer.model_copy(update={"warnings": [*told, *own]})


def meaning(pointer: str, usual: Range, quantity: float, compared: float) -> str:
    """Return what is implausible of a value, and what may be meant.

    Parameters
    ----------
    pointer, usual
        Field of the request, and its usual range.
    quantity, compared
        The quantity in its unit, and as the range has it.

    Returns
    -------
    str
        Field, value, range and the likely meaning.

    Examples
    --------
    >>> meaning("/plant/cable_length_m", Range(0.01, 300, "m", "cable_length_mm"), 800, 800)
    '/plant/cable_length_m: 800 m, usual are 0.01 to 300 m; was 0.8 m meant, cable_length_mm 800?'
    """
    what = "a period of " if usual.of_frequency else ""
    figure = f"{what}{quantity:.6g} {usual.unit}"
    if usual.in_periods:
        told = f"{figure}, {compared:.4g} periods of the plant, usual are at most {usual.high:g}"
    elif usual.low == 0:
        told = f"{figure}, usual is less than {usual.high:g} {usual.unit}"
    else:
        told = f"{figure}, usual are {usual.low:g} to {usual.high:g} {usual.unit}"
    over = compared >= usual.high
    factor = 1 / THOUSAND if over else THOUSAND
    if not usual.low <= compared * factor < usual.high:
        return f"{pointer}: {told}; is it in {usual.unit}?"
    meant = f"{quantity * factor:.6g} {usual.unit}"
    other = f", {usual.milli} {quantity:.6g}" if over else ""
    return f"{pointer}: {told}; was {what}{meant} meant{other}?"
