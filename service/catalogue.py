"""Every kind of shaper, with parameters, an example and its source."""

from typing import get_args

from design.shapers.registry import SHAPERS
from schemas.catalogue import Catalogue, CatalogueEntry
from schemas.plants import PlantIn
from schemas.shapers import MODELS
from service.version import version

THESIS_CRANE = {
    "plant": {"kind": "pendulum", "cable_length_m": 0.8, "gravity_m_s2": 9.81},
    "actuator": {
        "kind": "second_order",
        "accel": {"natural_frequency_rad_s": 20, "damping_ratio": 0.8},
        "decel": {"natural_frequency_rad_s": 50, "damping_ratio": 1.5},
    },
}
"""The crane of Kim 2011: the example of the catalogue and of the demo."""


TWO_MODES = {
    "kind": "modes",
    "modes": [
        {"natural_frequency_rad_s": 3.5, "damping_ratio": 0.0},
        {"natural_frequency_rad_s": 9.4, "damping_ratio": 0.02},
    ],
}
"""The example of shapers for several modes."""


EXAMPLE_ACTUATORS = {
    "ideal": {"kind": "ideal"},
    "first_order": {
        "kind": "first_order",
        "accel_time_constant_s": 0.1,
        "decel_time_constant_s": 0.05,
    },
    "second_order": THESIS_CRANE["actuator"],
    "rate_limited": {
        "kind": "rate_limited",
        "accel_limit_m_s2": 30.0,
        "decel_limit_m_s2": 5e4,
        "speed_m_s": 0.2,
        "then": THESIS_CRANE["actuator"],
    },
}


def _plants() -> list[str]:
    """Return every kind of plant that the wire takes, in its order."""
    models = get_args(get_args(PlantIn)[0])
    return [get_args(model.model_fields["kind"].annotation)[0] for model in models]


def _richest(kinds: tuple[str, ...]) -> str:
    """Return the last of the actuator kinds that there is an example of."""
    return [kind for kind in kinds if kind in EXAMPLE_ACTUATORS][-1]


def shaper_catalogue() -> Catalogue:
    """Return every kind of shaper, with parameters, example and source."""
    plants = _plants()
    return Catalogue(
        shapers=[
            CatalogueEntry(
                kind=kind.name,
                summary=kind.summary,
                source=kind.source,
                claims=list(kind.claims),
                plants=plants,
                most_modes=kind.most_modes,
                actuators=list(kind.actuators),
                parameters=MODELS[kind.name].model_json_schema(),
                example={
                    "plant": TWO_MODES if kind.serves_several else THESIS_CRANE["plant"],
                    "actuator": EXAMPLE_ACTUATORS[_richest(kind.actuators)],
                    "shaper": {"kind": kind.name},
                },
            )
            for kind in SHAPERS.values()
        ],
        version=version(),
    )
