"""Every error that the source makes: its class, its code, its words; for tests and documents."""

import ast
from collections import defaultdict
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from design import errors
from tests.syntax import parsed

ROOT = Path(__file__).parents[1]

MESSAGE = {
    errors.InvalidInputError.__name__: 2,
    errors.InfeasibleDesignError.__name__: 0,
    errors.SolverFailedError.__name__: 0,
    errors.TimeLimitError.__name__: 0,
    "_refuse": 0,  # of the command line
    "_refuse_key": 0,  # over HTTP
}
"""What makes an error, and which argument says the fault in words."""


@dataclass(frozen=True)
class Raised:
    """An error as the source makes it: its class, its code, what it says, and where."""

    error: str
    code: ast.expr
    words: str
    place: str


def template(words: ast.expr) -> str:
    """Return the words of an f-string with a gap for each value, other expressions as written."""
    if isinstance(words, ast.JoinedStr):
        return "".join(map(template, words.values))
    if isinstance(words, ast.Constant):
        return str(words.value)
    return "{}" if isinstance(words, ast.FormattedValue) else ast.unparse(words)


@cache
def errors_raised() -> list[Raised]:
    """Return every error that the three packages make."""
    found = []
    for package in ("design", "schemas", "service"):
        for path in sorted((ROOT / package).rglob("*.py")):
            for node in ast.walk(parsed(path)):
                if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name)):
                    continue
                if node.func.id in MESSAGE:
                    (code,) = (one.value for one in node.keywords if one.arg == "code")
                    words = template(node.args[MESSAGE[node.func.id]])
                    place = f"{path.relative_to(ROOT)}:{node.lineno}"
                    found.append(Raised(error=node.func.id, code=code, words=words, place=place))
    return found


def codes() -> dict[str, list[Raised]]:
    """Return the errors of each code that stands in the source."""
    found = defaultdict(list)
    for one in errors_raised():
        if isinstance(one.code, ast.Constant):
            found[str(one.code.value)].append(one)
    return found
