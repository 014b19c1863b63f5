"""Firmware of printers, as a recommendation asks it: lines ready to use, and what they make."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from design.errors import InvalidInputError
from design.export.firmware import require_shares
from design.export.klipper import BRACKETS, NAMES, klipper_line
from design.export.klipper_shapers import USUAL_TOLERANCE
from design.export.marlin import marlin_impulses, marlin_lines, marlin_numbers
from design.export.reprap import reprap_lines
from design.model.actuators.ideal import Ideal
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.registry import Plant
from design.recommendations.firmware import Firmware, ForOlder, Played
from design.shapers.kind import ShaperKind
from design.shapers.options import ShaperOptions
from design.tables.rows import Subject

SHAPER = "the shaper"
"""What messages call it, where a table has rows."""

Play = Callable[[Subject, Impulses], Played]


@dataclass(frozen=True, slots=True, kw_only=True)
class Printer:
    """Firmware of printers; `design.recommendations.firmware.Firmware` says what each part is."""

    title: str
    comment: str = ";"  # Of G-code
    kinds: tuple[str, ...]
    made_of: Play
    fixed: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    takes_impulses: bool = False  # Whether it is given impulses, not the name of a shaper

    def require(self, modes: int, actuator: Actuator, sample_time_s: float | None) -> None:
        """Check that it serves a question.

        Parameters
        ----------
        modes, actuator, sample_time_s
            Modes of the plant, its drive, and the samples that are asked for [s].

        Raises
        ------
        InvalidInputError
            If it computes its impulses itself, and these are to be of another sort.
        """
        if self.takes_impulses:
            return
        if not isinstance(actuator, Ideal):
            raise InvalidInputError(
                "actuator.kind",
                actuator.kind,
                f"ideal for {self.title}: its shapers know no drive",
                code="firmware_knows_no_actuator",
            )
        if modes > 1:
            raise InvalidInputError(
                "plant.modes",
                f"{modes} modes",
                f"a list of one for {self.title}: its shapers are for a single mode",
                code="firmware_of_one_mode",
            )
        if sample_time_s is not None:
            raise InvalidInputError(
                "sample_time_s",
                sample_time_s,
                f"left out for {self.title}: it computes its own impulses, between samples",
                code="firmware_not_on_samples",
            )

    def play(
        self,
        plant: Plant,
        actuator: Actuator,
        kind: ShaperKind,
        options: ShaperOptions,
        shaper: Impulses,
    ) -> Played:
        """Return what it makes of a shaper.

        Parameters
        ----------
        plant, actuator, kind, options
            What the shaper was designed for.
        shaper
            Its impulses.

        Returns
        -------
        Played
            Its lines, and the impulses that it plays.

        Raises
        ------
        InvalidInputError
            If it cannot play the shaper, or does not keep what it claims.
        """
        subject = Subject(plant=plant, actuator=actuator, kind=kind, options=options)
        return self.made_of(subject, shaper)


def _klipper(subject: Subject, shaper: Impulses) -> Played:
    line = klipper_line(subject, shaper, SHAPER, keeps_claims=False)
    names = ("shaper_type", "shaper_freq", "damping_ratio")
    values = (line.shaper, line.frequency_hz, line.damping_ratio)
    of_x, of_y = (
        [f"{name}_{axis}: {value}" for name, value in zip(names, values, strict=True)]
        for axis in "xy"
    )
    remarks = [f"# {BRACKETS}"] if "(" in line.shaper else []
    # Y is no part of it until somebody says so: it has another mode, most often.
    section = (
        "# printer.cfg, if this is the mode of X:",
        "[input_shaper]",
        *of_x,
        "# if it is that of Y, in that section:",
        *(f"# {one}" for one in of_y),
    )
    at_once = (f"# at once: {command}" for command in line.commands)
    older = None
    if line.without_brackets:
        plain = line.shaper.partition("(")[0]
        older = ForOlder(
            line=f"shaper_type_x: {plain}, or shaper_type_y: {plain}", played=line.without_brackets
        )
    return Played(lines=(*remarks, *section, *at_once), impulses=line.played, for_older=older)


def _marlin(subject: Subject, shaper: Impulses) -> Played:
    del shaper  # the mode says all
    mode = subject.plant.modes[0]
    return Played(lines=marlin_lines(mode), impulses=marlin_impulses(*marlin_numbers(mode)))


def _reprap(subject: Subject, shaper: Impulses) -> Played:
    require_shares(shaper.amplitudes, SHAPER, "RepRapFirmware")
    lines, played = reprap_lines(shaper, subject.plant, subject.actuator, SHAPER)
    return Played(lines=tuple(lines), impulses=played)


PRINTERS: dict[str, Firmware] = {
    "klipper": Printer(
        title="Klipper",
        comment="#",
        kinds=tuple(NAMES),
        made_of=_klipper,
        fixed={name: {"tolerance": USUAL_TOLERANCE} for name in ("two_hump_ei", "three_hump_ei")},
    ),
    "marlin": Printer(title="Marlin", kinds=("zv",), made_of=_marlin),
    "rrf": Printer(
        title="RepRapFirmware",
        kinds=(
            *("zv", "zvd", "zvdd", "zvddd", "mzv", "ei", "two_hump_ei", "three_hump_ei", "si"),
            *("multi_zv", "convolved"),
        ),
        made_of=_reprap,
        takes_impulses=True,
    ),
}
"""By the name on the wire."""
