"""Enough of IEC 61131-3 Structured Text to run a function block: a second route for the tests.

It knows the language from the standard, and nothing of the generator: declarations with initial
values, instances of other blocks, assignments, IF, FOR, arrays with any lower bound, and the
operators in their precedence. A REAL is a number of single precision.
"""

import operator
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

Value = Any

TOKEN = re.compile(
    r"\s+|\(\*.*?\*\)|(?P<token>\d+\.\d+(?:[eE][+-]?\d+)?|\d+|[A-Za-z_]\w*|:=|<=|>=|<>|\.\."
    r"|[-+*/=<>()\[\],;:.])",
    re.DOTALL,
)

FUNCTIONS: dict[str, Callable[[Any], Value]] = {
    "TRUNC": int,  # towards zero
    "DINT_TO_LREAL": float,
    "DINT_TO_REAL": np.float32,
    "ABS": abs,
    "SQRT": lambda value: type(value)(np.sqrt(value)),
    "EXP": lambda value: type(value)(np.exp(value)),
    "SIN": lambda value: type(value)(np.sin(value)),
    "COS": lambda value: type(value)(np.cos(value)),
    "ATAN": lambda value: type(value)(np.arctan(value)),
}

TYPES: dict[str, Value] = {
    "BOOL": False,
    "LREAL": 0.0,
    "REAL": np.float32(0),
    "DINT": 0,
    "SINT": 0,
}
"""Initial values of the elementary types."""

COMPARED: dict[str, Callable[[Value, Value], bool]] = {
    "<": operator.lt,
    ">": operator.gt,
    "<=": operator.le,
    ">=": operator.ge,
    "=": operator.eq,
    "<>": operator.ne,
}


def tokens_of(text: str) -> list[str]:
    """Return the words of a program; comments and blanks fall away."""
    found, position = [], 0
    while position < len(text):
        match = TOKEN.match(text, position)
        if match is None:
            raise SyntaxError(f"not Structured Text: {text[position : position + 40]!r}")
        if match["token"]:
            found.append(match["token"])
        position = match.end()
    return found


@dataclass
class Array:
    """An array with its lower bound."""

    lower: int
    values: list[Value]

    def place(self, index: Value) -> int:
        if not (isinstance(index, int) and 0 <= index - self.lower < len(self.values)):
            raise IndexError(f"{index} in ARRAY[{self.lower}..{self.lower + len(self.values) - 1}]")
        return index - self.lower


class Block:
    """An instance of a function block, by name out of a program."""

    def __init__(self, program: "str | list[str]", name: str) -> None:
        self.words = tokens_of(program) if isinstance(program, str) else program
        self.at = next(
            at
            for at, word in enumerate(self.words)
            if word in {"FUNCTION_BLOCK", "PROGRAM"} and self.words[at + 1] == name
        )
        self.end = f"END_{self.words[self.at]}"
        self.at += 2
        # Literals are of the type that the program counts in.
        self.real: Callable[[str], Value] = np.float32 if "REAL" in self.words else float
        self.values: dict[str, Value] = {}
        self.constants: set[str] = set()
        while self.words[self.at].startswith("VAR"):
            self._declarations()
        self.body = self.at

    def __call__(self, **inputs: Value) -> dict[str, Value]:
        """Set inputs, run the body once, return all variables."""
        for name, value in inputs.items():
            held = self.values[name]
            if isinstance(held, Array):
                given = value.values if isinstance(value, Array) else list(value)
                if len(given) != len(held.values):
                    raise TypeError(f"{name} takes {len(held.values)} values")
                held.values[:] = given
            else:
                self.values[name] = value if isinstance(held, int) else type(held)(value)
        self.at = self.body
        self._statements(self.end)
        return self.values

    def _next(self, *expected: str) -> str:
        word = self.words[self.at]
        if expected and word not in expected:
            raise SyntaxError(f"{word!r} where {expected} is due")
        self.at += 1
        return word

    def _declarations(self) -> None:
        self._next()
        constant = self.words[self.at] == "CONSTANT"
        self.at += constant
        while self.words[self.at] != "END_VAR":
            name = self._next()
            self._next(":")
            bounds = None
            if self.words[self.at] == "ARRAY":
                self._next("ARRAY"), self._next("[")
                lower = self._expression()
                self._next("..")
                bounds = lower, self._expression()
                self._next("]"), self._next("OF")
            of = self._next()
            if of not in TYPES:
                self._next(";")
                self.values[name] = Block(self.words, of)
                continue
            zero = TYPES[of]
            value: Value = zero if bounds is None else [zero] * (bounds[1] - bounds[0] + 1)
            if self.words[self.at] == ":=":
                self._next()
                value = self._initial(value)
            self._next(";")
            self.values[name] = value if bounds is None else Array(bounds[0], value)
            if constant:
                self.constants.add(name)
        self._next("END_VAR")

    def _initial(self, blank: Value) -> Value:
        if not isinstance(blank, list):
            return self._expression()
        self._next("[")
        values = [self._expression()]
        while self._next(",", "]") == ",":
            values.append(self._expression())
        if len(values) != len(blank):
            raise SyntaxError(f"{len(values)} values for an array of {len(blank)}")
        return values

    def _statements(self, *ends: str) -> None:
        while self.words[self.at] not in ends:
            if self.words[self.at] == "IF":
                self._if()
            elif self.words[self.at] == "FOR":
                self._for()
            else:
                self._assignment()

    def _skip(self, *ends: str) -> None:
        """Go past statements that do not run, inner ones included."""
        depth = 0
        while depth > 0 or self.words[self.at] not in ends:
            depth += self.words[self.at] in {"IF", "FOR"}
            depth -= self.words[self.at] in {"END_IF", "END_FOR"}
            self.at += 1

    def _if(self) -> None:
        self._next("IF")
        taken = self._expression() is True
        self._next("THEN")
        (self._statements if taken else self._skip)("ELSE", "END_IF")
        if self._next() == "ELSE":
            (self._skip if taken else self._statements)("END_IF")
            self._next("END_IF")
        self._next(";")

    def _for(self) -> None:
        self._next("FOR")
        name = self._next()
        self._next(":=")
        first = self._expression()
        self._next("TO")
        last = self._expression()
        self._next("DO")
        body = self.at
        self._skip("END_FOR")
        for value in range(first, last + 1):
            self.values[name] = value
            self.at = body
            self._statements("END_FOR")
        self._next("END_FOR"), self._next(";")

    def _call(self, name: str) -> None:
        """Call an instance with inputs by name."""
        self._next("(")
        inputs = {}
        while self.words[self.at] != ")":
            given = self._next()
            self._next(":=")
            inputs[given] = self._expression()
            if self.words[self.at] != ")":
                self._next(",")
        self._next(")"), self._next(";")
        self.values[name](**inputs)

    def _assignment(self) -> None:
        name = self._next()
        if self.words[self.at] == "(":
            self._call(name)
            return
        index = None
        if self.words[self.at] == "[":
            self._next("[")
            index = self._expression()
            self._next("]")
        self._next(":=")
        value = self._expression()
        self._next(";")
        if name in self.constants:
            raise SyntaxError(f"{name} is CONSTANT")
        if index is not None:
            array = self.values[name]
            array.values[array.place(index)] = value
            return
        if type(value) is not type(self.values[name]):
            raise TypeError(f"{name} takes no {type(value).__name__}")
        self.values[name] = value

    def _expression(self) -> Value:
        value = self._conjunction()
        while self.words[self.at] == "OR":
            self._next()
            value = self._conjunction() or value
        return value

    def _conjunction(self) -> Value:
        value = self._comparison()
        while self.words[self.at] == "AND":
            self._next()
            value = self._comparison() and value
        return value

    def _comparison(self) -> Value:
        value = self._sum()
        if self.words[self.at] in COMPARED:
            sign, other = self._next(), self._sum()
            value = bool(COMPARED[sign](value, other))
        return value

    def _sum(self) -> Value:
        value = self._product()
        while self.words[self.at] in {"+", "-"}:
            sign, other = self._next(), self._product()
            self._alike(value, other)
            value = value + other if sign == "+" else value - other
        return value

    def _product(self) -> Value:
        value = self._atom()
        while self.words[self.at] in {"*", "/"}:
            sign, other = self._next(), self._atom()
            self._alike(value, other)
            whole = isinstance(value, int)  # of whole numbers the division is whole
            value = value * other if sign == "*" else value // other if whole else value / other
        return value

    @staticmethod
    def _alike(left: Value, right: Value) -> None:
        """Refuse what strict compilers refuse: DINT and LREAL in one operation."""
        if type(left) is not type(right):
            raise TypeError(f"{left!r} and {right!r} in one operation")

    def _atom(self) -> Value:
        word = self._next()
        if word == "(":
            value = self._expression()
            self._next(")")
            return value
        if word == "-":
            return -self._atom()
        if word == "NOT":
            return not self._atom()
        if word in {"TRUE", "FALSE"}:
            return word == "TRUE"
        if word[0].isdigit():
            return self.real(word) if "." in word else int(word)
        if word in FUNCTIONS:
            self._next("(")
            value = FUNCTIONS[word](self._expression())
            self._next(")")
            return value
        value = self.values[word]
        while self.words[self.at] == ".":
            self._next(".")
            value = value.values[self._next()]
        if self.words[self.at] == "[":
            self._next("[")
            index = self._expression()
            self._next("]")
            return value.values[value.place(index)]
        return value
