"""Every kind of shaper, with parameters, an example and its source."""

import dataclasses
from typing import Any, get_args

from design.shapers.kind import ShaperKind
from design.shapers.registry import SHAPERS
from schemas.actuators import ActuatorIn, SecondOrderIn
from schemas.catalogue import Catalogue, CatalogueEntry
from schemas.plants import PlantIn
from schemas.shapers import MODELS
from service.version import version

THESIS_CRANE = {
    "plant": {"kind": "pendulum", "cable_length_m": 0.8, "gravity_m_s2": 9.81},
    "actuator": SecondOrderIn.EXAMPLE,
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


def kinds_of(union: object) -> dict[str, type[Any]]:
    """Return the models of a union of the wire by their kinds, in its order."""
    models = get_args(get_args(union)[0])
    return {get_args(model.model_fields["kind"].annotation)[0]: model for model in models}


EXAMPLE_ACTUATORS = {kind: model.EXAMPLE for kind, model in kinds_of(ActuatorIn).items()}
"""Each kind of actuator has an example."""


def _examples_of(kind: ShaperKind) -> dict[str, Any]:
    """Return examples of the parameters that have no usual value."""
    return {
        one.name: one.metadata["examples"][0]
        for one in dataclasses.fields(kind.options)
        if "examples" in one.metadata
    }


def shaper_catalogue() -> Catalogue:
    """Return every kind of shaper, with parameters, example and source."""
    plants = list(kinds_of(PlantIn))
    return Catalogue(
        shapers=[
            CatalogueEntry(
                kind=kind.name,
                summary=kind.summary,
                source=kind.source,
                claims=list(kind.claims),
                plants=["pendulum"] if kind.large_swings else plants,
                most_modes=kind.most_modes,
                actuators=list(kind.actuators),
                parameters=MODELS[kind.name].model_json_schema(),
                example={
                    "plant": TWO_MODES if kind.serves_several else THESIS_CRANE["plant"],
                    "actuator": EXAMPLE_ACTUATORS[kind.actuators[-1]],
                    "shaper": {"kind": kind.name, **_examples_of(kind)},
                },
            )
            for kind in SHAPERS.values()
        ],
        version=version(),
    )
