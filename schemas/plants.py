"""Wire form of the plants."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from design.errors import InvalidInputError
from design.model.plants.double_pendulum import DoublePendulum
from design.model.plants.free_body import FreeBody
from design.model.plants.hoisting import MAX_POINTS, Hoisting, LengthCourse
from design.model.plants.mode import Mode
from design.model.plants.modes import MAX_MODES, Modes
from design.model.plants.pendulum import STANDARD_GRAVITY_M_S2, Pendulum
from design.model.plants.scheduled import Scheduled
from design.model.plants.spring_mass import SpringMass
from schemas.base import Positive, Wire, WireOf, name_field
from schemas.damping import PlantDamping
from schemas.varied import Varied


class BareMode(WireOf[Mode]):
    """One vibration mode in a list of them."""

    RECORD = Mode

    natural_frequency_rad_s: Annotated[
        Positive, Field(description="Undamped natural frequency [rad/s].")
    ]
    damping_ratio: PlantDamping = 0.0


class ModeIn(BareMode):
    """One vibration mode."""

    ALSO: ClassVar[tuple[str, ...]] = (
        "frequency",
        "single_mode",
        "oscillator",
        "resonance",
        "robot",
        "printer",
    )

    kind: Literal["mode"]


class ModesIn(Wire):
    """Several vibration modes of one plant, or one."""

    ALSO: ClassVar[tuple[str, ...]] = (
        "multi_mode",
        "several_modes",
        "two_modes",
    )

    kind: Literal["modes"]
    modes: Annotated[
        list[BareMode],
        Field(min_length=1, max_length=MAX_MODES, description="Modes, no two alike."),
    ]

    def to_design(self) -> Mode | Modes:
        """Build the design record."""
        return modes_of(self.modes)


def modes_of(modes: list[BareMode]) -> Mode | Modes:
    """Build the record of one mode or of several."""
    built = []
    for number, one in enumerate(modes):
        with name_field(f"modes.{number}"):
            built.append(one.to_design())
    return built[0] if len(built) == 1 else Modes(modes=tuple(built))


class FreeBodyIn(Wire):
    """A body that nothing holds, moved by an on-off force: in maneuvers, with force_n."""

    ALSO: ClassVar[tuple[str, ...]] = (
        "spacecraft",
        "satellite",
        "floating_oscillator",
    )

    kind: Literal["free_body"]
    mass_kg: Annotated[
        Positive, Field(description="Mass of the whole [kg]; for a turn its inertia [kg m^2].")
    ]
    modes: Annotated[
        list[BareMode],
        Field(min_length=1, max_length=MAX_MODES, description="Modes that the force excites."),
    ]

    def to_design(self) -> FreeBody:
        """Build the design record."""
        return FreeBody(mass_kg=self.mass_kg, vibration=modes_of(self.modes))


class PendulumIn(WireOf[Pendulum]):
    """A load on a cable, at small angles."""

    ALSO: ClassVar[tuple[str, ...]] = (
        "crane",
        "overhead_crane",
        "gantry",
        "trolley",
        "hoist",
        "cable",
    )

    RECORD = Pendulum

    kind: Literal["pendulum"]
    cable_length_m: Annotated[
        Positive, Field(description="Length from the suspension to the centre of the load [m].")
    ]
    damping_ratio: PlantDamping = 0.0
    gravity_m_s2: Annotated[Positive, Field(description="Acceleration of free fall [m/s^2].")] = (
        STANDARD_GRAVITY_M_S2
    )


class DoublePendulumIn(WireOf[DoublePendulum]):
    """A load slung below a hook of some mass, at small angles: two modes."""

    ALSO: ClassVar[tuple[str, ...]] = (
        "two_pendulums",
        "hook_and_load",
        "slung_load",
    )

    RECORD = DoublePendulum

    kind: Literal["double_pendulum"]
    hook_mass_kg: Annotated[Positive, Field(description="Mass of the hook [kg].")]
    load_mass_kg: Annotated[Positive, Field(description="Mass of the load [kg].")]
    cable_length_m: Annotated[
        Positive, Field(description="Length from the suspension to the hook [m].")
    ]
    load_length_m: Annotated[
        Positive, Field(description="Length from the hook to the centre of the load [m].")
    ]
    damping_ratio: PlantDamping = 0.0
    gravity_m_s2: Annotated[Positive, Field(description="Acceleration of free fall [m/s^2].")] = (
        STANDARD_GRAVITY_M_S2
    )


class SpringMassIn(WireOf[SpringMass]):
    """A load held by a spring."""

    ALSO: ClassVar[tuple[str, ...]] = (
        "mass_spring",
        "mass_spring_damper",
        "spring",
    )

    RECORD = SpringMass

    kind: Literal["spring_mass"]
    mass_kg: Annotated[Positive, Field(description="Mass of the load [kg].")]
    stiffness_n_m: Annotated[Positive, Field(description="Stiffness of the spring [N/m].")]
    damping_ratio: PlantDamping = 0.0

    def numbers(self, pointer: str) -> Iterator[tuple[str, str, float]]:
        """Yield the frequency that both fields make, at the second.

        Parameters
        ----------
        pointer
            Of this plant.

        Yields
        ------
        tuple of str, str and float
            Pointer, field of a mode, and value.
        """
        frequency_rad_s = self.to_design().mode.natural_frequency_rad_s
        yield f"{pointer}/stiffness_n_m", "natural_frequency_rad_s", frequency_rad_s


class ScheduledIn(Varied):
    """A plant with one field anywhere in a range; its value in `plant` is not used."""

    kind: Literal["scheduled"]
    plant: Annotated[
        ModeIn | PendulumIn | SpringMassIn,
        Field(discriminator="kind", description="Plant in which one field is a range."),
    ]
    over: Annotated[
        str,
        Field(
            max_length=40, description="Field that is anywhere in a range, such as cable_length_m."
        ),
    ]
    from_: Annotated[Positive, Field(alias="from", description="Start, in the field's unit.")]
    to: Annotated[Positive, Field(description="End, in the field's unit.")]

    def to_design(self) -> Scheduled:
        """Build the design record.

        Raises
        ------
        InvalidInputError
            If the plant has no field of that name, or an end of the range breaks its rule.

        Returns
        -------
        Scheduled
            The plant at both ends of the range.
        """
        if self.over not in type(self.plant).model_fields or self.over == "kind":
            names = type(self.plant).model_fields
            fields = [name for name in names if name not in {"kind", "damping_ratio"}]
            raise InvalidInputError(
                "over",
                self.over,
                f"one of {', '.join(fields)}",
                code="field_not_scheduled",
            )
        with name_field("plant"):
            plant = self.plant.to_design()
        ends = []
        for name, value in (("from", self.from_), ("to", self.to)):
            changed: dict[str, Any] = {self.over: value}
            try:
                ends.append(replace(plant, **changed))
            except InvalidInputError as error:
                raise error.at(name, value) from None
        return Scheduled(first=ends[0], last=ends[1])

    def numbers(self, pointer: str) -> Iterator[tuple[str, str, float]]:
        """Yield the numbers in use: the ends of the range, and what is fixed.

        Parameters
        ----------
        pointer
            Of this plant.

        Yields
        ------
        tuple of str, str and float
            Pointer, field that it is a value of, and value.
        """
        if isinstance(self.plant, SpringMassIn):
            ends = self.to_design()
            for name, end in (("from", ends.first), ("to", ends.last)):
                yield (
                    f"{pointer}/{name}",
                    "natural_frequency_rad_s",
                    end.mode.natural_frequency_rad_s,
                )
            return
        yield f"{pointer}/from", self.over, self.from_
        yield f"{pointer}/to", self.over, self.to
        for name, value in self.plant:
            if name not in {self.over, "kind"}:
                yield f"{pointer}/plant/{name}", name, value


class LengthCourseIn(WireOf[LengthCourse]):
    """A length over time: linear between points, held before and after them."""

    RECORD = LengthCourse

    times_s: Annotated[
        list[float],
        Field(
            max_length=MAX_POINTS,
            description="Times from the first step of the command on, rising, two or more [s].",
            examples=[[0.0, 5.0]],
        ),
    ]
    values: Annotated[
        list[float],
        Field(max_length=MAX_POINTS, description="Length at each [m].", examples=[[0.8, 0.5]]),
    ]


class HoistingIn(WireOf[Hoisting]):
    """A load on a cable that is hoisted or lowered: in maneuvers, simulations and runs."""

    ALSO: ClassVar[tuple[str, ...]] = (
        "hoisted",
        "lowering",
        "winch",
    )

    RECORD = Hoisting

    kind: Literal["hoisting"]
    cable_length_m: Annotated[
        LengthCourseIn,
        Field(description="Length from the suspension to the centre of the load over time [m]."),
    ]
    damping_ratio: PlantDamping = 0.0
    gravity_m_s2: Annotated[Positive, Field(description="Acceleration of free fall [m/s^2].")] = (
        STANDARD_GRAVITY_M_S2
    )

    def numbers(self, pointer: str) -> Iterator[tuple[str, str, float]]:
        """Yield the lengths, each at its place.

        Parameters
        ----------
        pointer
            Of this plant.

        Yields
        ------
        tuple of str, str and float
            Pointer, field that it is a value of, and value.
        """
        for number, length_m in enumerate(self.cable_length_m.values):
            yield f"{pointer}/cable_length_m/values/{number}", "cable_length_m", length_m


PlantIn = Annotated[
    ModeIn
    | ModesIn
    | PendulumIn
    | DoublePendulumIn
    | SpringMassIn
    | ScheduledIn
    | HoistingIn
    | FreeBodyIn,
    Field(discriminator="kind", description="What swings."),
]
