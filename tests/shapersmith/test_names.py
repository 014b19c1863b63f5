"""Public names are there for people and type checkers, and cost nothing until they are used."""

import subprocess
import sys

import pytest

import shapersmith

BEFORE_USE = """
import sys, shapersmith
print(*sys.modules, sep="\\n")
"""


def test_the_import_alone_loads_nothing() -> None:
    command = [sys.executable, "-c", BEFORE_USE]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    heavy = {"numpy", "pydantic", "scipy", "casadi", "dataclasses", "shapersmith.given"}
    assert not set(done.stdout.split()) & heavy


@pytest.mark.parametrize("name", shapersmith.__all__)
def test_each_public_name_is_found_and_has_its_words(name: str) -> None:
    found = getattr(shapersmith, name)
    assert found.__name__ == name
    assert found.__doc__
    assert name in dir(shapersmith)


def test_a_name_that_is_not_there_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'maps'"):
        shapersmith.maps  # type: ignore[attr-defined]  # noqa: B018


def test_all_names_come_with_a_star() -> None:
    names: dict[str, object] = {}
    exec("from shapersmith import *", names)
    assert set(shapersmith.__all__) <= set(names)
