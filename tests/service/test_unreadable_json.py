"""A text that is no JSON is answered with the place and the cause."""

import json

import pytest

from service.dispatch import respond
from service.problems import NOT_JSON, Problem
from service.unreadable_json import why_unreadable
from tests.conftest import CRANE

TEXT = json.dumps(CRANE, indent=1)
"""The crane with a field a line; ``cable_length_m`` is on the fourth."""

CAUSES = [
    ('"cable_length_m": 0.8', '"cable_length_m": 0,8', "line 4, column 23: a decimal comma"),
    ('"cable_length_m": 0.8,', '"cable_length_m": 0.8, // m', "line 4, column 26: a comment"),
    ('"cable_length_m": 0.8,', '"cable_length_m": 0.8, /* m */', "line 4, column 26: a comment"),
    ('"cable_length_m": 0.8,', '"cable_length_m": 0.8, # m', "line 4, column 26: a comment"),
    ('"gravity_m_s2": 9.81', '"gravity_m_s2": 9.81,', "a comma before a closing bracket"),
    ('"pendulum"', "'pendulum'", "line 3, column 11: single quotes"),
    ('"cable_length_m"', "'cable_length_m'", "line 4, column 3: single quotes"),
    ('"pendulum"', "\u201cpendulum\u201d", "line 3, column 11: typographic quotes"),
    ('"cable_length_m"', "cable_length_m", "line 4, column 3: a name without double quotes"),
    ("0.8,", "True,", "a word of Python"),
    (": 0.8,", ": .8,", "a number without a digit ahead of its point: write 0.8"),
    (": 0.8,", ": .05,", "a number without a digit ahead of its point: write 0.05"),
    (": 0.8,", ": -.5e-3,", "a number without a digit ahead of its point: write -0.5e-3"),
    (": 0.8,", ": 12,75,", "a decimal comma: numbers have a point, as 12.75"),
    (": 0.8,", ": -1,5e3,", "a decimal comma: numbers have a point, as -1.5e3"),
    (": 0.8,", ": 12.,", "a number without a digit after its point: write 12.0"),
    (": 0.8,", ": 007,", "a number with a zero ahead: JSON has none there, write 7"),
    (": 0.8,", ": +3,", "a plus sign: JSON numbers have none ahead, write 3"),
    (": 0.8,", ": 1,5.2,", "a decimal comma: numbers have a point, as 0.8"),
    (": 0.8,", ": +0.8,", "a plus sign"),
    (": 0.8,", ": 00.8,", "a number with a zero ahead"),
    (": 0.8,", ": 1.,", "a number without a digit after its point"),
    (": 0.8,", ": 0.8", "line 5, column 3: a comma is missing"),
    ('"cable_length_m":', '"cable_length_m"', "a colon is missing"),
    ('"pendulum"', '"pendulum', "a line break or tab within a text"),
    ('"pendulum"', '"pen\\dulum"', "a backslash within a text"),
    (": 0.8,", ": ,", "a value is expected"),
]


@pytest.mark.parametrize(("right", "wrong", "told"), CAUSES)
def test_a_cause_is_named_with_line_column_and_excerpt(right: str, wrong: str, told: str) -> None:
    text = TEXT.replace(right, wrong, 1)
    assert text != TEXT
    problem = respond("design", text.encode())
    assert isinstance(problem, Problem)
    assert problem.kind == NOT_JSON
    assert told in problem.detail
    assert ", near `" in problem.detail
    assert "\n" not in problem.detail


@pytest.mark.parametrize(
    ("body", "told"),
    [
        (b"", "the text is empty"),
        (b" \n", "the text is empty"),
        (TEXT[:-2].encode(), "the text ends here"),
        (TEXT.encode() + b"{}", "more text after the end"),
        (TEXT.encode("utf-8-sig"), "UTF-8 with a byte order mark"),
        (TEXT.encode("utf-16"), "UTF-16"),
        (TEXT.encode("utf-16-be"), "UTF-16-BE"),
        (b'{\n"plant": "\xe9"}', "line 2, column 11: byte 0xe9 is no UTF-8"),
        (b'{"plant": 1' + b"0" * 5000 + b"}", "a whole number has more digits than are read"),
        (b"[" * 100_000, "nested too deep"),
        (b'{"plant": "\\ud800"}', "hex escape"),
    ],
)
def test_what_is_no_text_of_json_is_named(body: bytes, told: str) -> None:
    problem = respond("design", body)
    assert isinstance(problem, Problem)
    assert problem.kind == NOT_JSON
    assert told in problem.detail


def test_a_long_line_is_shown_in_part() -> None:
    text = f'{{"a": "{"x" * 500}", b: "{"y" * 500}"}}'
    told = why_unreadable(text, "")
    assert "a name without double quotes, near `...xxx" in told
    assert len(told) < 150
