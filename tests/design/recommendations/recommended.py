"""What the tests of recommendations ask."""

from typing import Any

from design.model.actuators.registry import Actuator
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.registry import Plant
from design.recommendations.judging import Candidate
from design.recommendations.recommendation import Recommendation, recommend
from design.recommendations.requirements import Requirements
from tests.shaper_table import CRANE, IDEAL


def asked(plant: Plant = CRANE, actuator: Actuator = IDEAL, **wanted: Any) -> Recommendation:
    return recommend(plant, actuator, Requirements(**wanted))


def everything(found: Recommendation) -> dict[str, Candidate]:
    return {one.name: one for one in (*found.candidates, *found.others)}


TWO_MODES = Modes(
    modes=(
        Mode(natural_frequency_rad_s=3.5),
        Mode(natural_frequency_rad_s=9.4, damping_ratio=0.02),
    )
)
