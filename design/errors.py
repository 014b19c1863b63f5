"""Errors raised by ``design``.

DesignError
├── InvalidInputError      the caller gave a value outside its rule
├── InfeasibleDesignError  no shaper that meets the request was found
├── SolverFailedError      a solver stopped without an answer, or its answer did not verify
└── TimeLimitError         a solver ran past the time it was given

Each error has a code, ``snake_case``, which says what is wrong in a word that does not change:
programs and tests go by the code, and the message is for people. One code has one meaning.
"""

from design.trace import TraceStep

Path = tuple[str, ...]
"""Names of fields from a record inward, numbers of list items among them."""


def path_of(name: str | Path) -> Path:
    """Return the path that a dotted name says; a path stays as it is.

    Returns
    -------
    Path
        Names of fields, from the record inward.

    Examples
    --------
    >>> path_of("accel.damping_ratio")
    ('accel', 'damping_ratio')
    """
    return tuple(name.split(".")) if isinstance(name, str) else tuple(name)


class DesignError(Exception):
    """Base of every error raised on purpose by ``design``.

    Parameters
    ----------
    message
        What is wrong, in words.
    code
        The same as a name, for programs.

    Attributes
    ----------
    trace
        Steps of the search that ended with it, where it was watched.
    """

    trace: tuple[TraceStep, ...] = ()

    def __init__(self, message: str, code: str) -> None:
        super().__init__(message, code)  # what pickle calls it with in another process
        self.message = message
        self.code = code

    def __str__(self) -> str:
        return self.message


class InvalidInputError(DesignError):
    """A value breaks its rule.

    Parameters
    ----------
    name
        Path of the field from the record that found the fault: dotted, as ``accel.damping_ratio``,
        or part by part where a part is a name that somebody chose, and may hold a dot.
    value
        The value got.
    rule
        What the value must be, to be read after "must be".
    code
        Which rule it breaks, whatever the field: ``out_of_range``, ``band_said_twice``.
    """

    def __init__(self, name: str | Path, value: object, rule: str, code: str) -> None:
        path = path_of(name)
        super().__init__(f"{'.'.join(path)} must be {rule}, got {value!r}", code)
        self.args = (path, value, rule, code)  # what pickle calls it with in another process
        self.path = path
        self.value = value
        self.rule = rule

    @property
    def name(self) -> str:
        """The path, dotted."""
        return ".".join(self.path)

    def at(self, name: str | Path, value: object) -> "InvalidInputError":
        """Return the same fault as that of another field.

        Parameters
        ----------
        name
            Path of the field.
        value
            The value got there.

        Returns
        -------
        InvalidInputError
            With the same rule and code.
        """
        return InvalidInputError(name, value, self.rule, code=self.code)

    def within(self, outer: str) -> "InvalidInputError":
        """Return the same error with its path led on from ``outer``.

        Parameters
        ----------
        outer
            Dotted path of the record that holds the one at fault.

        Returns
        -------
        InvalidInputError
            With the same value, rule and code.

        Examples
        --------
        >>> fault = InvalidInputError("damping_ratio", -1.0, "> 0", code="not_positive")
        >>> str(fault.within("plant"))
        'plant.damping_ratio must be > 0, got -1.0'
        """
        return self.at((*path_of(outer), *self.path), self.value)


class InfeasibleDesignError(DesignError):
    """No shaper that meets the request was found; the message says how far was searched.

    Parameters
    ----------
    message
        All of it in words.
    code
        The same as a name, for programs.
    faults
        Dotted paths of the fields that cannot be met together, each with the nearest that can.
    """

    def __init__(self, message: str, code: str, faults: tuple[tuple[str, str], ...] = ()) -> None:
        super().__init__(message, code)
        self.args = (message, code, faults)  # what pickle calls it with in another process
        self.faults = faults


class SolverFailedError(DesignError):
    """A solver stopped without an answer, or its answer did not pass the certificate."""


class TimeLimitError(DesignError):
    """A solver ran past the time it was given."""
