"""One tree of errors, each with a message that says what, the rule and the value."""

import inspect
import pickle

import pytest

from design import errors
from design.checks import require_between, require_scale
from design.errors import (
    DesignError,
    InfeasibleDesignError,
    InvalidInputError,
    SolverFailedError,
    TimeLimitError,
)
from tests.refusals import refused

LEAVES = (InvalidInputError, InfeasibleDesignError, SolverFailedError, TimeLimitError)


def defined_errors() -> list[type]:
    found = inspect.getmembers(errors, inspect.isclass)
    return [one for _, one in found if one.__module__ == errors.__name__]


@pytest.mark.parametrize("error", LEAVES)
def test_every_error_is_a_design_error(error: type) -> None:
    assert issubclass(error, DesignError)


def test_no_error_is_a_kind_of_another_so_that_one_table_can_translate_them() -> None:
    for one in LEAVES:
        assert [other.__name__ for other in LEAVES if issubclass(one, other)] == [one.__name__]


def test_the_tree_drawn_at_the_top_of_the_file_names_every_class() -> None:
    drawn = (errors.__doc__ or "").split()
    assert {one.__name__ for one in defined_errors()} <= set(drawn)
    assert {one.__name__ for one in defined_errors()} == {"DesignError"} | {
        one.__name__ for one in LEAVES
    }


def test_an_input_error_says_the_field_the_rule_and_the_value() -> None:
    error = InvalidInputError("mode.damping_ratio", 0.7, "between 0 and 0.5", code="out_of_range")
    assert str(error) == "mode.damping_ratio must be between 0 and 0.5, got 0.7"
    assert (error.name, error.value, error.rule) == ("mode.damping_ratio", 0.7, "between 0 and 0.5")


def test_an_input_error_shows_text_in_quotes() -> None:
    assert str(InvalidInputError("model", "both", "one of two", code="unknown")).endswith(
        "got 'both'"
    )


def test_an_input_error_can_be_named_from_an_outer_record() -> None:
    error = InvalidInputError("damping_ratio", 9.0, "between 0.1 and 5", code="out_of_range")
    outer = error.within("accel").within("actuator")
    assert str(outer) == "actuator.accel.damping_ratio must be between 0.1 and 5, got 9.0"
    assert (outer.value, outer.code) == (9.0, "out_of_range")


def test_a_fault_of_one_field_can_be_that_of_another() -> None:
    error = InvalidInputError("damping_ratio", 9.0, "between 0.1 and 5", code="out_of_range")
    other = error.at("to", 7.0)
    assert str(other) == "to must be between 0.1 and 5, got 7.0"
    assert other.code == "out_of_range"


@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf"), -float("inf")])
def test_a_positive_number_is_asked_for_by_name(value: float) -> None:
    with refused("not_positive", "cable", says="finite and > 0, got "):
        require_scale("cable", value)


def test_the_smallest_positive_number_is_positive_and_too_small() -> None:
    with refused("out_of_range", "cable"):
        require_scale("cable", 5e-324)


@pytest.mark.parametrize("value", [-1e-12, 0.5 + 1e-12, float("nan"), float("inf")])
def test_a_number_outside_its_range_is_refused(value: float) -> None:
    with refused("out_of_range", "share", says=r"between 0 and 0\.5, got "):
        require_between("share", value, 0.0, 0.5)


@pytest.mark.parametrize("value", [0.0, 0.5])
def test_the_ends_of_a_range_belong_to_it(value: float) -> None:
    require_between("share", value, 0.0, 0.5)


@pytest.mark.parametrize("error", LEAVES[1:])
def test_an_error_of_one_message_crosses_to_another_process(error: type[DesignError]) -> None:
    again = pickle.loads(pickle.dumps(error("searched to 3 periods", code="none")))
    assert type(again) is error
    assert (str(again), again.code) == ("searched to 3 periods", "none")


def test_what_cannot_be_met_together_crosses_to_another_process() -> None:
    faults = (("max_duration_s", "1 is the shortest"),)
    again = pickle.loads(pickle.dumps(InfeasibleDesignError("no", code="none", faults=faults)))
    assert (str(again), again.code, again.faults) == ("no", "none", faults)


def test_an_input_error_crosses_to_another_process() -> None:
    error = InvalidInputError("damping_ratio", 0.7, "between 0 and 0.5", code="out_of_range")
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.name, again.value) == (str(error), error.name, error.value)
    assert again.code == "out_of_range"
