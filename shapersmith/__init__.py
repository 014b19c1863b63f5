"""Input shapers for flexible machines whose actuators are not ideal.

The packages `design`, `schemas` and `service` belong to it. `import shapersmith` raises an
`ImportError` that names the clash where one of these names stands for another module.

Examples
--------
>>> import shapersmith
>>> crane = shapersmith.Pendulum(cable_length_m=0.8, gravity_m_s2=9.81)
>>> drive = shapersmith.FirstOrder(accel_time_constant_s=0.1, decel_time_constant_s=0.05)
>>> round(shapersmith.design(crane, drive, "numzv").shaper.duration_s, 4)
0.5836
"""

from importlib import import_module
from typing import TYPE_CHECKING

from shapersmith.name_clash import import_own_packages

import_own_packages()

if TYPE_CHECKING:
    from shapersmith.client import Client
    from shapersmith.errors import (
        InfeasibleDesignError,
        InvalidInputError,
        ServiceError,
        ShapersmithError,
        SolverFailedError,
        TimeLimitError,
        UnreachableError,
    )
    from shapersmith.given import (
        AngleSwing,
        Axis,
        DampingBand,
        DampingRange,
        DeflectionSwing,
        DoublePendulum,
        DriveRange,
        FirstOrder,
        FitRange,
        FreeBody,
        Hoisting,
        Ideal,
        Impulses,
        ImpulsesCommand,
        LengthCourse,
        ListCommand,
        Mode,
        Modes,
        Move,
        Pendulum,
        PulseCommand,
        RateLimited,
        SampledCommand,
        Scheduled,
        SecondOrder,
        SecondOrderSet,
        SensitivityRange,
        SpringMass,
        StepCommand,
        TableAxis,
        shaper,
    )
    from shapersmith.here import (
        design,
        field_map,
        fit,
        maneuver,
        recommend,
        run,
        sensitivity,
        simulate,
    )
    from shapersmith.results import (
        Design,
        FieldMap,
        Fit,
        Maneuver,
        Recommendation,
        Run,
        Sensitivity,
        Simulation,
    )
    from shapersmith.tables import table

    __version__: str
else:

    def __getattr__(name: str) -> object:
        """Return a public name, imported at its first use: help of the command line needs none."""
        if name == "__version__":
            from importlib.metadata import version  # noqa: PLC0415

            return version("shapersmith")
        if name in __all__:
            for home in HOMES:
                found = getattr(import_module(f"shapersmith.{home}"), name, None)
                if found is not None:
                    return found
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


HOMES = ("errors", "given", "results", "here", "client", "tables")
"""Modules of the public names, in the order in which one is looked for."""

__all__ = [
    "AngleSwing",
    "Axis",
    "Client",
    "DampingBand",
    "DampingRange",
    "DeflectionSwing",
    "Design",
    "DoublePendulum",
    "DriveRange",
    "FieldMap",
    "FirstOrder",
    "Fit",
    "FitRange",
    "FreeBody",
    "Hoisting",
    "Ideal",
    "Impulses",
    "ImpulsesCommand",
    "InfeasibleDesignError",
    "InvalidInputError",
    "LengthCourse",
    "ListCommand",
    "Maneuver",
    "Mode",
    "Modes",
    "Move",
    "Pendulum",
    "PulseCommand",
    "RateLimited",
    "Recommendation",
    "Run",
    "SampledCommand",
    "Scheduled",
    "SecondOrder",
    "SecondOrderSet",
    "Sensitivity",
    "SensitivityRange",
    "ServiceError",
    "ShapersmithError",
    "Simulation",
    "SolverFailedError",
    "SpringMass",
    "StepCommand",
    "TableAxis",
    "TimeLimitError",
    "UnreachableError",
    "design",
    "field_map",
    "fit",
    "maneuver",
    "recommend",
    "run",
    "sensitivity",
    "shaper",
    "simulate",
    "table",
]


def __dir__() -> list[str]:
    """Return the public names, whether they are imported yet or not."""
    return sorted({*globals(), *__all__, "__version__"})
