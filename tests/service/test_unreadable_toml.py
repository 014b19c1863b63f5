"""A text that is no TOML is answered with the place and the cause."""

import tomllib

import pytest

from service.cli.reading import ReadingError, read_request
from service.unreadable_toml import MEANING

NUMBERS = [
    ("x = 0,8", "column 6: a decimal comma: numbers have a point, as 0.8"),
    ("x = -1,5e3", "a decimal comma: numbers have a point, as -1.5e3"),
    ("x = 1.", "column 6: a number without a digit after its point: write 1.0"),
    ("x = .5", "column 5: a number without a digit ahead of its point: write 0.5"),
    ("x = -.05e2", "write -0.05e2"),
    ("x = 007", "a number with a zero ahead: write 7"),
    ("x = 1.2.3", "a number with two points"),
    ("x = 9.81 m/s2", "a unit behind a number"),
    ("x = 5%", "a unit behind a number"),
    ("x = [1 Hz, 2 Hz]", "a unit behind a number"),
]

WORDS = [
    ('{"plant": 1}', "column 1: this is JSON: a file of JSON is named .json"),
    ("x = 1 // metres", "a comment begins with # in TOML"),
    ("x = 1 /* m */", "a comment begins with # in TOML"),
    ("x = 5;", "a comment begins with # in TOML"),
    ("x = True", "a word of Python"),
    ("x = null", "TOML has no empty value"),
    ("x = None", "TOML has no empty value"),
    ("x = pendulum", "column 5: a text without quotes"),
    ("plant = {kind = pendulum}", "column 17: a text without quotes"),
    ("x = \u201cpendulum\u201d", "typographic quotes"),
    ("kind: pendulum", "column 5: a colon: TOML has = between a name and its value"),
    ("cable length = 1", "a name in two words"),
    ("l\u00e4nge = 1", "is expected after a name"),
    ("\u00e4 = 1", "a name of other letters"),
    ("x = {a = 1,}", "a line break or a comma at the end within {}"),
    ("x = {a = 1,\nb = 2}", "a line break or a comma at the end within {}"),
]

MEANINGS = [
    ("x = 1\nx = 2", "line 2, column 6: a name that stands twice, near `x = 2`"),
    ("[a]\n[a]", "a heading that stands twice"),
    ("x = {a = 1, a = 2}", "a name that stands twice"),
    ("a = {b = 1}\na.c = 1", "a name below a value that is whole already"),
    ("x = {1", "= is expected after a name"),
    ("x.", "a name is expected"),
    ('x = "a', "column 7: a line break or tab within a text, or its closing quote is missing"),
    ('x = """a', "a text whose closing quote is missing"),
    ("x = 'a", "a text whose closing quote is missing"),
    (r'x = "\d"', "a backslash within a text"),
    (r'x = "C:\Users"', "a backslash within a text"),
    ("x = [1", "a list without its closing bracket"),
    ("x = {a = 1", "a brace without its closing one"),
    ("[a", "a heading without its closing bracket"),
    ("[[a]", "a heading without its closing brackets"),
    ("x", "= is expected after a name"),
    ("x = 1 y = 2", "more text after a value"),
    ('x = "a\nb"', "a line break or tab within a text"),
    ("x =", "a value is expected, near `x =`"),
    ("= 1", "a line is a heading in brackets, or a name, = and a value"),
]

CASES = [*NUMBERS, *WORDS, *MEANINGS]


@pytest.mark.parametrize("end", ["\n", "\r\n"])
@pytest.mark.parametrize(("text", "told"), CASES)
def test_a_cause_is_named_with_line_column_and_excerpt(text: str, told: str, end: str) -> None:
    whole = text if text.startswith("{") else f"[plant]\n{text}\n"
    with pytest.raises(ReadingError) as refused:
        read_request(whole.replace("\n", end).encode(), toml=True)
    detail = str(refused.value)
    assert detail.startswith("no TOML: line ")
    assert told.replace("line 2", "line 3") in detail
    assert ", near `" in detail
    assert "\n" not in detail


def test_every_word_of_pythons_reader_has_a_case() -> None:
    said = set()
    for text, _ in CASES:
        with pytest.raises(tomllib.TOMLDecodeError) as refused:
            tomllib.loads(f"{text}\n")
        said |= {one for one in MEANING if str(refused.value).startswith(one)}
    assert said == set(MEANING)


def test_a_text_that_is_none_is_named_as_such() -> None:
    for content, told in ((b"\xff\xfe\x00", "UTF-8"), (b"PK\x03\x04", "the file is no text")):
        with pytest.raises(ReadingError, match=told):
            read_request(content, toml=True)
    with pytest.raises(ReadingError, match="nested too deep"):
        read_request(b"x = " + b"[" * 100_000, toml=True)
