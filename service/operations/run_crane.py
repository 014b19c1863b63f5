"""The crane of a run: what swings, its hoists, and what a delay line does for it."""

from dataclasses import replace
from typing import NamedTuple

from design.analysis.warnings import DesignWarning
from design.checks import MAX_VALUE
from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.double_pendulum import DoublePendulum
from design.model.plants.hoisting import Hoisting
from design.model.plants.mode import Mode
from design.model.plants.modes import Modes
from design.model.plants.pendulum import STANDARD_GRAVITY_M_S2, Pendulum
from design.model.plants.registry import Plant
from design.model.plants.spring_mass import SpringMass
from design.pipeline import design
from design.rig.crane import HOOK_MASS_KG, MAX_CABLE_M, AxisName, Crane, Load, Stroke
from design.rig.hoists import hoists_of
from design.rig.scenario import HoistTo
from design.shapers.kind import ShaperKind
from design.shapers.options import ShaperOptions
from design.shapers.refusals import require_small_swings
from schemas.base import name_field
from schemas.runs import DelayLine, RunRequest, StrokeIn
from service.operations.found_shaper import on_samples

CRANES = Pendulum | Hoisting | DoublePendulum
"""Plants that have a cable, of one length at first."""


class Swinging(NamedTuple):
    """What swings in a run, at its start."""

    cable: Pendulum | None  # The cable at its first length; None for a mode
    load: Load | None
    hook_mass_kg: float
    hoists: list[HoistTo]  # Those of the plant
    held: Mode | SpringMass | None = None  # A plant without a cable


def crane_of(request: RunRequest, plant: Plant) -> tuple[Crane, Swinging]:
    """Return the crane of a request; a mode is a linear one of its frequency.

    Parameters
    ----------
    request
        The request.
    plant
        Its plant.

    Returns
    -------
    tuple of Crane and Swinging
        The machine, and what of it the plant says.

    Raises
    ------
    InvalidInputError
        If the plant is none of a run, or something is said twice.
    """
    swinging = _swinging(request, plant)
    if swinging.cable is None:
        mode = plant.mode
        gravity, damping = STANDARD_GRAVITY_M_S2, mode.damping_ratio
        length = gravity / mode.natural_frequency_rad_s**2
    else:
        cable = swinging.cable
        length, gravity, damping = cable.cable_length_m, cable.gravity_m_s2, cable.damping_ratio
    strokes = request.strokes
    with name_field("plant"):
        crane = Crane(
            cable_length_m=length,
            damping_ratio=damping,
            gravity_m_s2=gravity,
            hook_mass_kg=swinging.hook_mass_kg,
            load=swinging.load,
            model=request.model,
            strokes=(
                _stroke_of("x", None if strokes is None else strokes.x),
                _stroke_of("y", None if strokes is None else strokes.y),
            ),
            max_speed_m_s=MAX_VALUE if request.max_speed_m_s is None else request.max_speed_m_s,
            max_cable_length_m=max(MAX_CABLE_M, length),
        )
    return crane, swinging


def _swinging(request: RunRequest, plant: Plant) -> Swinging:
    hook_mass = HOOK_MASS_KG if request.hook_mass_kg is None else request.hook_mass_kg
    if isinstance(plant, DoublePendulum):
        for name, value in (("load", request.load), ("hook_mass_kg", request.hook_mass_kg)):
            if value is not None:
                raise InvalidInputError(
                    name,
                    "a load" if name == "load" else value,
                    "left out where the plant is of kind double_pendulum, which has a hook and a "
                    "load",
                    code="load_said_twice",
                )
        with name_field("plant"):
            cable = Pendulum(
                cable_length_m=plant.cable_length_m,
                damping_ratio=plant.damping_ratio,
                gravity_m_s2=plant.gravity_m_s2,
            )
            below = Load(mass_kg=plant.load_mass_kg, length_m=plant.load_length_m)
        return Swinging(cable, below, plant.hook_mass_kg, [])
    load = None
    if request.load is not None:
        with name_field("load"):
            load = request.load.to_design()
    if isinstance(plant, Pendulum):
        return Swinging(plant, load, hook_mass, [])
    if isinstance(plant, Hoisting):
        with name_field("plant"):
            return Swinging(plant.at(0.0), load, hook_mass, hoists_of(plant.cable_length_m))
    if not isinstance(plant, Mode | SpringMass):
        raise InvalidInputError(
            "plant.kind",
            request.plant.kind,
            "pendulum, double_pendulum, hoisting, mode or spring_mass: a run is of one crane, or "
            "of one mode",
            code="plant_not_run",
        )
    if request.model != "linear" or load is not None:
        raise InvalidInputError(
            "plant.kind",
            request.plant.kind,
            "pendulum, double_pendulum or hoisting for a nonlinear model, and pendulum or hoisting "
            "for a load",
            code="run_needs_pendulum",
        )
    return Swinging(None, None, hook_mass, [], plant)


def _stroke_of(axis: AxisName, stroke: StrokeIn | None) -> Stroke | None:
    if stroke is None:
        return None
    with name_field(f"strokes.{axis}"):
        return stroke.to_design()


def shaper_of(
    line: DelayLine,
    crane: Crane,
    swinging: Swinging,
    plant: Plant,
    actuator: Actuator,
    speed_m_s: float,
) -> Impulses:
    """Design the shaper of a delay line, for both modes of a hook with a load.

    Parameters
    ----------
    line
        The delay line.
    crane, swinging
        What swings, from which a given length of the cable is taken.
    plant, actuator, speed_m_s
        Of the request; full speed [m/s].

    Returns
    -------
    Impulses
        The shaper, on samples where it is asked for there.

    Raises
    ------
    InvalidInputError
        If a value breaks its rule.
    InfeasibleDesignError
        If the shaper was not found.
    SolverFailedError
        If none of the solutions found was verified.
    """
    subject = plant
    if swinging.cable is None:
        if line.cable_length_m is not None:
            raise InvalidInputError(
                "cable_length_m",
                line.cable_length_m,
                "left out where the plant has no cable",
                code="hoist_needs_cable",
            )
    else:
        length = swinging.cable.cable_length_m
        length = length if line.cable_length_m is None else line.cable_length_m
        subject = subject_at_length(crane, swinging.cable, length)
    with name_field("shaper"):
        options = line.shaper.options()
        _require_same_swing(line.shaper.shaper_kind(), options, crane, speed_m_s)
    found = design(subject, actuator, line.shaper.shaper_kind(), options)
    if line.shaper.sample_time_s is not None:
        found, _ = on_samples(found, subject, actuator, line.shaper, line.shaper.sample_time_s)
    return found.impulses


def _require_same_swing(
    kind: ShaperKind, options: ShaperOptions, crane: Crane, speed_m_s: float
) -> None:
    """Check that a shaper for large swings is exact for the run."""
    if not kind.large_swings:
        return
    if crane.model != "nonlinear":
        require_small_swings(kind, "runs of the linear model", "kind")
    exact_at = getattr(options, "speed_m_s", None)
    if exact_at is not None and exact_at != speed_m_s:
        raise InvalidInputError(
            "speed_m_s",
            exact_at,
            f"that of the run, {speed_m_s:g}: at another the shaper is not exact",
            code="large_swing_of_other_speed",
        )


def subject_at_length(crane: Crane, cable: Pendulum, length_m: float) -> Pendulum | Modes:
    """Return what swings on a length of the cable, for shapers.

    Parameters
    ----------
    crane
        The machine.
    cable
        Its cable at first.
    length_m
        The length [m].

    Returns
    -------
    Pendulum or Modes
        Both modes where a load hangs under the hook.
    """
    frequencies = crane.frequencies_rad_s(length_m)
    if len(frequencies) == 1:
        return replace(cable, cable_length_m=length_m)
    slowest = frequencies[0]
    # The drag is that of the slowest mode: of a quicker one it is a smaller share.
    ratios = [crane.damping_ratio * slowest / one for one in frequencies]
    return Modes(
        modes=tuple(
            Mode(natural_frequency_rad_s=one, damping_ratio=ratio)
            for one, ratio in zip(frequencies, ratios, strict=True)
        )
    )


def one_length_warnings(
    line: DelayLine, cable: Pendulum, hoists: list[HoistTo]
) -> tuple[DesignWarning, ...]:
    """Return what to know of a delay line while a cable is hoisted.

    Parameters
    ----------
    line
        The delay line.
    cable
        The cable at first.
    hoists
        All that is hoisted.

    Returns
    -------
    tuple of DesignWarning
        None where nothing is.
    """
    if not hoists:
        return ()
    length = cable.cable_length_m if line.cable_length_m is None else line.cable_length_m
    lengths = [cable.cable_length_m, *(hoist.cable_length_m for hoist in hoists)]
    return (
        DesignWarning(
            code="shaper_of_one_length",
            detail=f"the shaper of the delay line is that of {length:.6g} m, and the cable is "
            f"hoisted within {min(lengths):.6g} and {max(lengths):.6g} m: other lengths keep some "
            "vibration",
        ),
    )
