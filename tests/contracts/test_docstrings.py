"""Docstrings of public functions say what the signature does not, section by section.

Ruff holds the sections that are there against the signature; what must be there is held here.
The docstring of a route is its description on the wire, written for clients, without sections.
"""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.syntax import parsed

ROOT = Path(__file__).parents[2]

MAX_SUMMARY_CHARACTERS = 72
"""Characters of a summary that editors and lists of functions show whole."""

Function = ast.FunctionDef | ast.AsyncFunctionDef


def documented_files() -> Iterator[str]:
    """Yield the public modules as paths from the root."""
    for package in ("design", "schemas", "service", "shapersmith"):
        for path in sorted((ROOT / package).rglob("*.py")):
            if not path.stem.startswith("_") or path.stem == "__init__":
                yield path.relative_to(ROOT).as_posix()


def public_functions(body: list[ast.stmt], owner: str = "") -> Iterator[tuple[str, Function]]:
    """Yield public functions and methods with their names, without overloads and routes."""
    for node in body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield from public_functions(node.body, f"{owner}{node.name}.")
        elif (
            isinstance(node, Function)
            and not node.name.startswith("_")
            and not any(name == "overload" or is_route(name) for name in decorators(node))
        ):
            yield f"{owner}{node.name}", node


def decorators(function: Function) -> list[str]:
    """Return the decorators of a function as they are written."""
    return [ast.unparse(decorator) for decorator in function.decorator_list]


def is_route(decorator: str) -> bool:
    """Return whether a decorator, as it is written, makes a function a route."""
    return decorator.startswith("router.")


def arguments(function: Function) -> list[str]:
    """Return the names of the arguments except `self` and `cls`."""
    given = function.args
    stars = [one for one in (given.vararg, given.kwarg) if one is not None]
    names = [one.arg for one in (*given.posonlyargs, *given.args, *given.kwonlyargs, *stars)]
    return [name for name in names if name not in {"self", "cls"}]


def own_nodes(function: Function) -> Iterator[ast.AST]:
    """Yield the nodes of a function's body without those of functions inside it."""
    waiting: list[ast.AST] = list(function.body)
    while waiting:
        node = waiting.pop()
        yield node
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda | ast.ClassDef):
            waiting.extend(ast.iter_child_nodes(node))


def faults_of(function: Function) -> list[str]:
    """Return what the docstring of a function lacks."""
    docstring = ast.get_docstring(function) or ""
    summary = docstring.partition("\n")[0]
    nodes = list(own_nodes(function))
    returns = function.returns is not None and ast.unparse(function.returns) not in {
        "None",
        "Iterator[None]",
        "NoReturn",
        "Never",
    }
    attribute = any(name.endswith("property") for name in decorators(function))
    raises = any(isinstance(node, ast.Raise) and node.exc is not None for node in nodes)

    def has(section: str) -> bool:
        return f"\n{section}\n{'-' * len(section)}\n" in docstring

    with_sections = any(has(section) for section in ("Parameters", "Raises", "Examples"))
    faults = []
    if len(arguments(function)) > 1 and not has("Parameters"):
        faults.append("no Parameters")
    if with_sections and returns and not attribute and not (has("Returns") or has("Yields")):
        faults.append("no Returns or Yields beside its other sections")
    if raises and not has("Raises") and not summary.startswith("Raise "):
        faults.append("no Raises")
    if len(summary) > MAX_SUMMARY_CHARACTERS:
        faults.append(f"a summary of {len(summary)} characters")
    return faults


@pytest.mark.parametrize("name", list(documented_files()))
def test_public_functions_say_arguments_results_and_errors(name: str) -> None:
    functions = public_functions(parsed(ROOT / name).body)
    faults = {
        f"{name}:{function.lineno} {label}": faults_of(function) for label, function in functions
    }
    assert not {where: what for where, what in faults.items() if what}


def test_a_function_that_says_too_little_is_found() -> None:
    (poor,) = ast.parse(
        "def scale(values, factor) -> list:\n"
        "    'Scale.'\n"
        "    if not values:\n"
        "        raise ValueError\n"
        "    return [factor * value for value in values]\n"
    ).body
    assert isinstance(poor, ast.FunctionDef)
    assert faults_of(poor) == ["no Parameters", "no Raises"]
