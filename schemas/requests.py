"""The request of each command, by name: who explains a fault may need those of the others too."""

from functools import cache
from importlib import import_module

from schemas.base import Wire

MODELS = {
    "design": ("design_request", "DesignRequest"),
    "sensitivity": ("sensitivity", "SensitivityRequest"),
    "fit": ("fits", "FitRequest"),
    "maneuver": ("maneuvers", "ManeuverRequest"),
    "simulate": ("simulations", "SimulationRequest"),
    "run": ("runs", "RunRequest"),
    "map": ("maps", "MapRequest"),
    "recommend": ("recommendations", "RecommendationRequest"),
    "table": ("tables", "TableRequest"),
}
"""Module and class by command; a test compares them with the operations."""


@cache
def requests() -> dict[str, type[Wire]]:
    """Return the model of each command's request.

    Their modules are imported at first use.
    """
    return {
        command: getattr(import_module(f"schemas.{module}"), name)
        for command, (module, name) in MODELS.items()
    }
