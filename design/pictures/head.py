"""The head of a sheet: what is drawn, of what, and whether it is proven, in columns."""

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.text import Text

from design.analysis.warnings import DesignWarning
from design.pictures.style import AMBER, AMBER_WASH, GREY, INK, PROVEN, SMALL_PT

MARGIN_IN = 0.2
"""Margin of the head on either side [in]."""

LABEL_IN, VALUE_IN, DETAIL_IN, LINE_IN = 0.22, 0.43, 0.63, 0.157
"""From the top of the page to the label, the value and the first detail; a line further [in]."""

RULE_IN, NOTE_IN = 1.07, 1.23
"""From the top of the page to the rule and to the note below it [in]."""

HEAD_IN = 1.5
"""What the head takes of the page, its note included [in]."""

TITLE_IN = 0.3
"""Between the head and the panels, for their titles [in]."""

GAP_IN = (0.2, 0.5)
"""Least and most between two columns [in]."""

FITTING = 3
"""How often type is shrunk: its width does not follow its size exactly [-]."""

NAME_PT, VALUE_PT = (11.0, 21.0), 10.0
"""Type sizes: of the name the least and the largest, and of a value [pt]."""

NAME_WIDTH_PT = 150.0
"""A name that is longer than this at its largest size gets a smaller one [pt]."""

NOTE_CHARACTERS_PER_IN, NOTE_LINES = 16.0, 2
"""Characters of a note to the inch, and its lines, at most: what is longer is cut [1/in], [-]."""


@dataclass(frozen=True, slots=True)
class Fact:
    """A column of the head.

    Attributes
    ----------
    label
        What is said.
    value
        In heavy type.
    detail
        Below it, up to three lines.
    colour
        Of the value.
    ground
        Colour behind the column; empty for none.
    """

    label: str
    value: str
    detail: str = ""
    colour: str = INK
    ground: str = ""


def certificate_fact(claims: Sequence[str], *, verified: bool, for_ideal: bool) -> Fact:
    """Return what is proven, and of what.

    Green is proven for the drive given, amber for an ideal one alone.

    Parameters
    ----------
    claims
        Quantities that are claimed.
    verified
        Whether they are proven.
    for_ideal
        Whether that is for an ideal actuator, and not for the one given.

    Returns
    -------
    Fact
        In words too: a print may be grey.
    """
    told = " and ".join(dict.fromkeys(claims))
    if not verified:
        return Fact("certificate", "✗ not verified", told, AMBER, AMBER_WASH)
    if for_ideal:
        detail = "not proven for the\nactuator given"
        return Fact("certificate", "ideal actuator only", detail, AMBER, AMBER_WASH)
    return Fact("certificate", "✓ verified", told, PROVEN)


def note_of(warnings: Sequence[DesignWarning]) -> str:
    """Return the first warning, and how many more there are."""
    if not warnings:
        return ""
    others = len(warnings) - 1
    return f"note: {warnings[0].detail}" + (f"; {others} more" if others else "")


def write_head(
    figure: Figure, name: str, version: str, facts: Sequence[Fact], note: str = ""
) -> None:
    """Write the head of a sheet: name, facts in columns, a rule and a note.

    Columns are as wide as their text and the gaps are equal. Where they do not fit, all type
    shrinks.

    Parameters
    ----------
    figure
        A figure without a head.
    name
        What is drawn.
    version
        Of the program, below the name.
    facts
        From left to right.
    note
        Below the rule, on two lines at most; the rest is cut.
    """
    width, height = (float(size) for size in figure.get_size_inches())
    largest = min(NAME_PT[1], max(NAME_PT[0], NAME_WIDTH_PT / max(len(name), 1)))
    columns = [
        [
            figure.text(0, 1 - (VALUE_IN + 0.01) / height, name, fontsize=largest, weight="bold"),
            figure.text(
                0, 1 - DETAIL_IN / height, f"shapersmith {version}", fontsize=SMALL_PT, color=GREY
            ),
        ]
    ]
    columns += [_column(figure, fact, height) for fact in facts]
    _place(figure, columns, width)
    for column, fact in zip(columns[1:], facts, strict=True):
        if fact.ground:
            _lay_ground(figure, column, fact.ground, width, height)
    left, right = MARGIN_IN / width, 1 - MARGIN_IN / width
    rule = 1 - RULE_IN / height
    figure.add_artist(Line2D([left, right], [rule, rule], color=INK, linewidth=1.0))
    most = int(NOTE_CHARACTERS_PER_IN * (width - 2 * MARGIN_IN))
    lines = textwrap.wrap(note, most, max_lines=NOTE_LINES, placeholder=" …")
    for row, line in enumerate(lines):
        lower = 1 - (NOTE_IN + row * LINE_IN) / height
        figure.text(left, lower, line, fontsize=SMALL_PT, color=GREY)


def _column(figure: Figure, fact: Fact, height: float) -> list[Text]:
    """Write one fact at the left edge; line by line, so that neighbours align."""
    return [
        figure.text(0, 1 - LABEL_IN / height, fact.label, color=GREY, fontsize=SMALL_PT),
        figure.text(
            0, 1 - VALUE_IN / height, fact.value, fontsize=VALUE_PT, weight="bold",
            color=fact.colour,
        ),
        *(
            figure.text(0, 1 - (DETAIL_IN + row * LINE_IN) / height, line, fontsize=SMALL_PT + 0.5)
            for row, line in enumerate(fact.detail.splitlines())
        ),
    ]  # fmt: skip


def _place(figure: Figure, columns: list[list[Text]], width: float) -> None:
    """Put the columns side by side, with equal gaps, and shrink them where they do not fit."""
    room = width - 2 * MARGIN_IN - (len(columns) - 1) * GAP_IN[0]
    widths = [_width_in(figure, column) for column in columns]
    for _ in range(FITTING):
        if sum(widths) <= room:
            break
        for text in (text for column in columns for text in column):
            text.set_fontsize(float(text.get_fontsize()) * room / sum(widths))
        widths = [_width_in(figure, column) for column in columns]
    gap = (width - 2 * MARGIN_IN - sum(widths)) / max(len(columns) - 1, 1)
    left = MARGIN_IN
    for column, own in zip(columns, widths, strict=True):
        for text in column:
            text.set_x(left / width)
        left += own + min(gap, GAP_IN[1])


def _width_in(figure: Figure, column: list[Text]) -> float:
    return max(text.get_window_extent().width for text in column) / float(figure.dpi)


def _lay_ground(
    figure: Figure, column: list[Text], colour: str, width: float, height: float
) -> None:
    """Lay a colour behind a column, from above its label to below its last line."""
    boxes = [text.get_window_extent() for text in column]
    dots = float(figure.dpi)
    left = min(box.x0 for box in boxes) / dots - 0.07
    right = max(box.x1 for box in boxes) / dots + 0.07
    low, high = height - RULE_IN + 0.04, height - 0.06
    figure.add_artist(
        Rectangle(
            (left / width, low / height), (right - left) / width, (high - low) / height,
            facecolor=colour, edgecolor="none", zorder=-1, gid="not-proven",
        )
    )  # fmt: skip
