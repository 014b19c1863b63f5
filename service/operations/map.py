"""What a shaper does, or is, over one or two fields."""

from typing import TYPE_CHECKING

from design.analysis.warnings import sum_warnings
from design.fields import Axis
from design.maps.field_map import field_map
from design.maps.map_case import Map, MapCase
from design.model.impulses import Impulses
from schemas.base import name_field
from schemas.maps import MapRequest, MapResponse
from service.operations.found_shaper import found_shaper
from service.operations.operation import Operation
from service.operations.subject import subject_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def map_over_fields(request: MapRequest) -> MapResponse:
    """Return a quantity of a shaper, or of the drive alone, over fields.

    Parameters
    ----------
    request
        The plant, the actuator, the shaper, the quantity and one or two fields.

    Returns
    -------
    MapResponse
        The quantity at every point.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule, or the quantity does not go with the rest.
    InfeasibleDesignError
        If a shaper that is held all over the map was not found.
    SolverFailedError
        If such a shaper was found and not verified.
    """
    case, x, y, found = _make_map(request)
    warnings = sum_warnings(case.shaper) if isinstance(case.shaper, Impulses) else ()
    return MapResponse.from_design(request, x, y, found, warnings)


def map_picture(request: MapRequest) -> "Figure":
    """Draw the map that `map_over_fields` returns.

    Parameters
    ----------
    request
        The plant, the actuator, the shaper, the quantity and one or two fields.

    Returns
    -------
    Figure
        The map, or the curve where there is one axis.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule, or the quantity does not go with the rest.
    InfeasibleDesignError
        If a shaper that is held all over the map was not found.
    SolverFailedError
        If such a shaper was found and not verified.
    """
    from design.pictures.map_sheet import map_sheet  # noqa: PLC0415 - matplotlib takes a second

    case, x, y, found = _make_map(request)
    return map_sheet(case, x, y, found)


def _make_map(request: MapRequest) -> tuple[MapCase, Axis, Axis | None, Map]:
    plant, actuator = subject_of(request)
    with name_field("x"):
        x = request.x.to_design()
    y = None
    if request.y is not None:
        with name_field("y"):
            y = request.y.to_design()
    held = None
    shaper = request.shaper
    if shaper is not None and shaper.sample_time_s is not None and request.holds_one_shaper:
        with name_field("shaper"):
            options = shaper.options()
        held = found_shaper(plant, actuator, shaper, options).impulses
    case = request.to_design(plant, actuator, held)
    return case, x, y, field_map(case, x, y)


OPERATION = Operation(
    request=MapRequest, response=MapResponse, run=map_over_fields, draw=map_picture
)
