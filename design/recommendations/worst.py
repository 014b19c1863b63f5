"""The largest residual over all that plant and drive may be."""

from design.analysis.band import largest_in_band
from design.model.actuators.registry import Actuator
from design.model.impulses import Impulses
from design.pipeline import Design
from design.recommendations.requirements import Question
from design.shapers.several_modes import FREQUENCIES_PER_RADIAN


def work_of_worst(found: Design, question: Question) -> float:
    """Return the work of judging a design.

    It goes by impulses times frequencies, on each line, for each drive.

    Parameters
    ----------
    found, question
        The design, and what is asked.

    Returns
    -------
    float
        Of `worst_residual` and `drive_off_residual` together [units].
    """
    band, lines = question.own_band, 1 if question.requirements.damping is None else 4
    duration, impulses = found.impulses.duration_s, found.impulses.times_s.size
    radians = (band[1] - band[0]) * duration * sum(
        mode.natural_frequency_rad_s for mode in question.designed_for
    )  # fmt: skip
    drives = 1 if found.impulses.accelerates.all() else 1 + len(question.drives_off)
    each = question.actuator.PROOF_WORK * impulses * FREQUENCIES_PER_RADIAN * radians * lines
    return drives * each


def worst_residual(
    impulses: Impulses, question: Question, actuator: Actuator | None = None
) -> float:
    """Return the largest residual over all that the plant may be [-].

    Parameters
    ----------
    impulses, question
        The impulses, and what is asked.
    actuator
        The drive; None for the one given.

    Returns
    -------
    float
        Over band and damping, by simulation [-].
    """
    band, damping = question.own_band, question.requirements.damping
    drive = question.actuator if actuator is None else actuator
    return max(
        largest_in_band(impulses, mode, drive, band, damping) for mode in question.designed_for
    )


def drive_off_residual(impulses: Impulses, question: Question, worst: float) -> float | None:
    """Return the largest residual with the drive given and those that are off.

    One set alone is a factor of the command and of the unshaped step: whatever it is, the share of
    positive impulses is the same.

    Parameters
    ----------
    impulses, question
        The impulses, and what is asked.
    worst
        Their `worst_residual` with the drive given [-].

    Returns
    -------
    float or None
        Over band and damping, by simulation [-]; None where the drive is not asked to be off.
    """
    if not question.drives_off:
        return None
    if impulses.accelerates.all():
        return worst
    return max(worst, *(worst_residual(impulses, question, one) for one in question.drives_off))
