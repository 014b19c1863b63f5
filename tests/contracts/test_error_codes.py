"""Every error has a code of its meaning; the list of codes is what the source says."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from tests.errors_raised import codes, errors_raised
from tests.syntax import parsed

ROOT = Path(__file__).parents[2]

CODE = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
"""Words in small letters: the style of the codes of warnings."""

MAX_CODE_CHARACTERS = 32
"""Characters of a code."""

BOUND = re.compile(r"between|at least|at most|greater than 0|> 0")
"""What a rule says that `out_of_range` may stand for: the bounds of one number, in any words."""


@cache
def words_of_tests() -> frozenset[str]:
    """Return every string that stands in a test."""
    return frozenset(
        node.value
        for path in (ROOT / "tests").rglob("test_*.py")
        for node in ast.walk(parsed(path))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    )


def test_an_error_says_its_code_where_it_is_made_or_keeps_that_of_another() -> None:
    kept = [one for one in errors_raised() if not isinstance(one.code, ast.Constant)]
    assert [
        one.place for one in kept if ast.unparse(one.code) not in ("error.code", "self.code")
    ] == []
    assert len(codes()) > 100


@pytest.mark.parametrize("code", sorted(codes()))
def test_a_code_is_a_few_words_in_snake_case(code: str) -> None:
    assert CODE.fullmatch(code)
    assert len(code) <= MAX_CODE_CHARACTERS


@pytest.mark.parametrize("code", sorted(codes()))
def test_one_code_is_of_one_class_and_has_one_meaning(code: str) -> None:
    assert len({one.error for one in codes()[code]}) == 1
    meanings = {one.words: one.place for one in codes()[code]}
    if code == "out_of_range":
        assert [place for words, place in meanings.items() if not BOUND.search(words)] == []
    else:
        assert len(meanings) == 1, meanings


@pytest.mark.parametrize("code", sorted(codes()))
def test_a_code_stands_in_a_test(code: str) -> None:
    assert code in words_of_tests()
