"""What a shaper is asked to do, before any is chosen."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from design.analysis.drive_sensitivity import MAX_OFF, drives_off, require_parameters
from design.analysis.workable import require_workable
from design.band import ends_of, require_said_once
from design.checks import MAX_VALUE, require_between, require_scale
from design.errors import InvalidInputError
from design.model.actuators.registry import Actuator
from design.model.plants.mode import MAX_DAMPING_RATIO, Mode
from design.model.plants.registry import Plant, SeveralModes
from design.model.plants.scheduled import Scheduled
from design.recommendations.firmware import Firmware

Sign = Literal["any", "positive", "unity"]
"""Amplitudes allowed: all; above zero; +1, -1, +1, ... as an on-off drive takes them."""

MAX_HALF_WIDTH = 0.95
MIN_RATIO, MAX_RATIO = 0.05, 10.0
"""Bounds of the band: what is known no better than by a factor of ten is to be measured [-]."""

MIN_TOLERANCE = 1e-6
"""Far below anything that a machine shows [-]."""

MAX_COMMAND = 10.0
"""Farthest limit of the command from 0 and 1, in cruise speeds [-]."""

MIDDLE_ROUNDING = 1e-12
"""A middle of the band this near to the plant's frequency is that frequency [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirements:
    """What is known of the plant and what the shaper has to keep.

    Attributes
    ----------
    half_width
        The true frequency is within ``1 - half_width`` and ``1 + half_width`` of the plant's [-];
        None if the ends are given, and 0.15 if they are not either.
    lower_ratio, upper_ratio
        The same by its ends, at most and at least 1 [-]; None with ``half_width``.
    tolerance
        Largest residual over all that the plant may be, 0 to 1, both excluded [-].
    damping
        Least and largest damping ratio that the plant may have, its own between them [-]; None if
        its own is right.
    max_duration_s
        Longest shaper [s]; None for no limit.
    sign
        Amplitudes allowed.
    lowest_command, highest_command
        Where the shaped command of a unit step must stay, over its cruise speed [-].
    max_high_mode_gain
        Largest share of an unshaped step left in any higher mode [-]; None for no limit.
    sample_time_s
        The impulses are to lie on samples of this length [s]; None for none.
    drive_off_by
        The tolerance holds as well where every parameter of the drive is off by this share, up or
        down [-]; None if those given are right.
    firmware
        What is to play the shaper: its kinds alone are candidates; None for any.
    """

    half_width: float | None = None
    lower_ratio: float | None = None
    upper_ratio: float | None = None
    tolerance: float = 0.05
    damping: tuple[float, float] | None = None
    max_duration_s: float | None = None
    sign: Sign = "any"
    lowest_command: float = 0.0
    highest_command: float = 1.0
    max_high_mode_gain: float | None = None
    sample_time_s: float | None = None
    drive_off_by: float | None = None
    firmware: Firmware | None = None

    def __post_init__(self) -> None:
        self._require_band()
        if not MIN_TOLERANCE <= self.tolerance < 1:
            raise InvalidInputError(
                "tolerance",
                self.tolerance,
                f"at least {MIN_TOLERANCE:g} and below 1, the residual without a shaper",
                code="out_of_range",
            )
        if self.damping is not None:
            least, most = self.damping
            require_between("damping.from", least, 0.0, MAX_DAMPING_RATIO)
            require_between("damping.to", most, 0.0, MAX_DAMPING_RATIO)
            if most < least:
                raise InvalidInputError(
                    "damping.to", most, f"at least from, {least!r}", code="range_below_start"
                )
        for name in ("max_duration_s", "sample_time_s"):
            value = getattr(self, name)
            if value is not None:
                require_scale(name, value)
        require_between("lowest_command", self.lowest_command, -MAX_COMMAND, 0.0)
        require_between("highest_command", self.highest_command, 1.0, 1.0 + MAX_COMMAND)
        if self.max_high_mode_gain is not None and not 0 < self.max_high_mode_gain <= MAX_VALUE:
            raise InvalidInputError(
                "max_high_mode_gain", self.max_high_mode_gain, "> 0", code="out_of_range"
            )

        if self.drive_off_by is not None and not 0 < self.drive_off_by <= MAX_OFF:
            raise InvalidInputError(
                "drive_off_by",
                self.drive_off_by,
                f"above 0 and at most {MAX_OFF:g}: beyond it, it is another drive",
                code="out_of_range",
            )

    def _require_band(self) -> None:
        require_said_once(self)
        if self.half_width is not None:
            if not 0 <= self.half_width <= MAX_HALF_WIDTH:
                raise InvalidInputError(
                    "half_width",
                    self.half_width,
                    f"between 0 and {MAX_HALF_WIDTH:g}: from 1 on the band would reach zero "
                    "frequency",
                    code="out_of_range",
                )
            return
        if self.lower_ratio is None or self.upper_ratio is None:
            return
        if not MIN_RATIO <= self.lower_ratio <= 1:
            raise InvalidInputError(
                "lower_ratio",
                self.lower_ratio,
                f"between {MIN_RATIO:g} and 1: a band around the plant's frequency that does "
                "not reach zero",
                code="out_of_range",
            )
        if not 1 <= self.upper_ratio <= MAX_RATIO:
            raise InvalidInputError(
                "upper_ratio",
                self.upper_ratio,
                f"between 1 and {MAX_RATIO:g}: a band around the plant's frequency",
                code="out_of_range",
            )

    @property
    def band_is_given(self) -> bool:
        """Whether the band was asked for and is not the usual one."""
        return self.half_width is not None or self.lower_ratio is not None

    @property
    def band(self) -> tuple[float, float]:
        """Ends of the band, ratios of the plant's frequency [-]."""
        return ends_of(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """Requirements of one plant and its drive.

    Attributes
    ----------
    actuator
        The drive.
    requirements
        What is asked.
    nominal
        The plant's modes, of the damping ratio that shapers are designed for.
    designed_for
        The modes in the middle of all that they may be.
    band
        Ends of the band, ratios of the nominal frequencies [-].
    scheduled
        Whether that is the range of the plant itself.
    drives_off
        The drives of which the tolerance is asked besides; none where the one given is right.
    """

    actuator: Actuator
    requirements: Requirements
    nominal: tuple[Mode, ...]
    designed_for: tuple[Mode, ...]
    band: tuple[float, float]
    scheduled: bool
    drives_off: tuple[Actuator, ...] = ()

    @property
    def own_band(self) -> tuple[float, float]:
        """Ends of the band over the frequencies shapers are designed for [-]."""
        middle = self.designed_for[0].natural_frequency_rad_s
        over = self.nominal[0].natural_frequency_rad_s / middle
        return self.band[0] * over, self.band[1] * over

    @property
    def half_width(self) -> float:
        """Half the band's width over its middle, as a shaper's option [-]."""
        return round((self.band[1] - self.band[0]) / (self.band[1] + self.band[0]), 12)


def question_of(plant: Plant, actuator: Actuator, requirements: Requirements) -> Question:
    """Return what is asked of one plant and drive.

    Shapers are designed for the middle of the band, and of the damping range: there the same
    shaper bears more on either side.

    Parameters
    ----------
    plant, actuator
        What moves, and what drives it.
    requirements
        What is asked.

    Returns
    -------
    Question
        For the modes in the middle of all that the plant may be.

    Raises
    ------
    InvalidInputError
        If the requirements do not go with the plant or the firmware, or a set of the actuator is
        out of proportion.
    """
    band = requirements.band
    if isinstance(plant, Scheduled):
        if requirements.band_is_given:
            name = "lower_ratio" if requirements.half_width is None else "half_width"
            raise InvalidInputError(
                name,
                getattr(requirements, name),
                "left out: the plant's range is the band",
                code="requirement_said_by_plant",
            )
        band = plant.band
    if isinstance(plant, SeveralModes) and requirements.damping is not None:
        raise InvalidInputError(
            "damping",
            requirements.damping,
            "left out for a plant of several modes",
            code="requirement_of_one_mode",
        )
    modes = plant.modes
    if requirements.firmware is not None:
        requirements.firmware.require(len(modes), actuator, requirements.sample_time_s)
    if requirements.damping is not None:
        modes = (_in_the_middle(modes[0], requirements.damping),)
    middle = (band[0] + band[1]) / 2
    middle = 1.0 if abs(middle - 1) < MIDDLE_ROUNDING else middle
    designed_for = tuple(_scale(mode, middle) for mode in modes)
    at_ends = [
        _scale(mode, ratio)
        for mode in designed_for
        for ratio in (1.0, band[0] / middle, band[1] / middle)
    ]
    for mode in at_ends:
        require_workable(mode, actuator)
    return Question(
        actuator=actuator,
        requirements=requirements,
        nominal=modes,
        designed_for=designed_for,
        band=band,
        scheduled=isinstance(plant, Scheduled),
        drives_off=_drives_off(actuator, requirements.drive_off_by, at_ends),
    )


def _drives_off(
    actuator: Actuator, share: float | None, modes: Sequence[Mode]
) -> tuple[Actuator, ...]:
    """Return the drives that are off, each of them workable with all modes."""
    if share is None:
        return ()
    require_parameters(actuator, "drive_off_by")
    try:
        drives = drives_off(actuator, share)
        for mode in modes:
            for drive in drives:
                require_workable(mode, drive)
    except InvalidInputError as error:
        raise InvalidInputError(
            "drive_off_by",
            share,
            f"such that the drive that is off is one that is served: its "
            f"{error.name.removeprefix('actuator.')} must be {error.rule}",
            code="drive_off_bounds",
        ) from None
    return drives


def _in_the_middle(mode: Mode, damping: tuple[float, float]) -> Mode:
    least, most = damping
    if not least <= mode.damping_ratio <= most:
        raise InvalidInputError(
            "plant.damping_ratio",
            mode.damping_ratio,
            f"within the range of damping given, {least:g} to {most:g}",
            code="damping_outside_its_range",
        )
    return Mode(
        natural_frequency_rad_s=mode.natural_frequency_rad_s, damping_ratio=(least + most) / 2
    )


def _scale(mode: Mode, ratio: float) -> Mode:
    return Mode(
        natural_frequency_rad_s=ratio * mode.natural_frequency_rad_s,
        damping_ratio=mode.damping_ratio,
    )
