"""A specification of a table in a file."""

import json
from pathlib import Path

import pytest

from tests.service.cli.table_runs import SMALL


@pytest.fixture
def spec(tmp_path: Path) -> Path:
    path = tmp_path / "spec.json"
    path.write_text(json.dumps(SMALL))
    return path
