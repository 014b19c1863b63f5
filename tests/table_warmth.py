"""Imported by the fork server of the tests: its workers need not load what is compiled."""

from design.tables.compute import compute_rows
from tests.table_cases import random_table

compute_rows(random_table(1, 1, order=2), 0, 1)
