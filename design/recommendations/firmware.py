"""What a recommendation needs of the firmware that is to play the shaper."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.model.plants.registry import Plant
from design.shapers.kind import ShaperKind
from design.shapers.options import ShaperOptions

PLAYED_WITHIN = 1.01
"""Margin of a tolerance as a firmware plays a shaper: its clock and its fits of five digits move
the residual by less than this, and no machine shows it [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ForOlder:
    """The same shaper for versions that do not read the lines of another one."""

    line: str
    played: tuple[Impulses, ...]  # What the versions that read it play


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Played:
    """A shaper as a firmware has it."""

    lines: tuple[str, ...]  # Its configuration, ready to use
    impulses: Impulses  # What it plays then
    for_older: ForOlder | None = None  # None where every version reads the lines


class Firmware(Protocol):
    """A firmware: which shapers it has, and what it makes of one."""

    @property
    def title(self) -> str:
        """What it is called."""

    @property
    def comment(self) -> str:
        """What begins a comment in its configuration."""

    @property
    def kinds(self) -> tuple[str, ...]:
        """Names of the kinds of shapers that it has, or takes."""

    @property
    def fixed(self) -> Mapping[str, Mapping[str, Any]]:
        """Parameters of kinds that it has no choice of, by kind."""

    def require(self, modes: int, actuator: Actuator, sample_time_s: float | None) -> None:
        """Check that it serves a question.

        Parameters
        ----------
        modes, actuator, sample_time_s
            Modes of the plant, its drive, and the samples that are asked for [s].

        Raises
        ------
        InvalidInputError
            If it does not.
        """

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
