"""What the README says is what there is."""

import re
from pathlib import Path

from service.cli.main import COMMANDS
from service.http.app import create_app
from service.settings import PREFIX, Settings

README = (Path(__file__).parents[3] / "README.md").read_text()


def test_the_readme_has_a_row_for_every_setting_with_its_default() -> None:
    rows = dict(re.findall(rf"^\| `{PREFIX}(\w+)` \| ([^|]*?) ?\|", README, re.MULTILINE))
    assert {name.lower() for name in rows} == set(Settings.model_fields)
    for name, field in Settings.model_fields.items():
        told = rows[name.upper()]
        if isinstance(field.default, str):
            assert told == field.default, name
        elif name not in {"workers", "job_workers"}:  # depend on the machine
            assert float(told.replace(",", "")) == field.default, name


def test_the_readme_names_every_route_and_command() -> None:
    app = create_app(Settings())
    for path in app.openapi()["paths"]:
        assert re.search(rf"`(GET|POST) {path}`", README), path
    for command in (*COMMANDS, "table", "shapers", "serve"):
        assert f"`shapersmith {command}" in README, command
