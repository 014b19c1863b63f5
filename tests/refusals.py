"""What an error of the mathematics says to programs, for tests that need not tie to its words."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from design.errors import DesignError, InvalidInputError


@contextmanager
def refused(
    code: str, field: str | None = None, *, says: str | None = None
) -> Iterator[pytest.ExceptionInfo[DesignError]]:
    """Hold that the body raises an error of this code; a code also decides the class of error.

    Parameters
    ----------
    code
        Code of the error.
    field
        Dotted path of the field at fault, where the input is invalid.
    says
        Pattern of what the words must say besides, such as a figure.

    Yields
    ------
    pytest.ExceptionInfo[DesignError]
        The error, once it is raised.
    """
    with pytest.raises(DesignError, match=says) as caught:
        yield caught
    assert caught.value.code == code
    if field is not None:
        assert isinstance(caught.value, InvalidInputError)
        assert caught.value.name == field
