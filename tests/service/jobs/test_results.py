"""Files of tables, by the names of their formats."""

from service.jobs.results import export_of
from tests.refusals import refused


def test_a_format_that_is_none_is_refused() -> None:
    with refused("format_not_served", "format"):
        export_of("xls")
