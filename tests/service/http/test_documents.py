"""What the documents say is what there is."""

import re
from pathlib import Path

import pytest

from service.cli.main import COMMANDS
from service.http.app import create_app
from service.settings import PREFIX, Settings

ROOT = Path(__file__).parents[3]

DOCUMENTS = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "benchmarks/README.md")),
    *sorted((ROOT / "docs").glob("*.md")),
]

MADE = {"kinds.md", "commands.md", "errors.md"}
"""Pages that are made when the site is built, by `docs/reference.py`."""

MOST_WORDS = 700
"""Words of the README: it is a window, and the shop is in `docs`."""


def test_there_is_a_row_for_every_setting_with_its_default() -> None:
    settings = (ROOT / "docs/settings.md").read_text()
    rows = dict(re.findall(rf"^\| `{PREFIX}(\w+)` \| ([^|]*?) ?\|", settings, re.MULTILINE))
    assert {name.lower() for name in rows} == set(Settings.model_fields)
    for name, field in Settings.model_fields.items():
        told = rows[name.upper()]
        if isinstance(field.default, str):
            assert told == field.default, name
        elif name not in {"workers", "job_workers"}:  # depend on the machine
            assert float(told.replace(",", "")) == field.default, name


def test_every_route_and_command_is_named() -> None:
    routes = (ROOT / "docs/routes.md").read_text()
    app = create_app(Settings())
    for path in app.openapi()["paths"]:
        assert re.search(rf"`(GET|POST) {path}`", routes), path
    for command in (*COMMANDS, "table", "shapers", "schemas", "serve"):
        assert f"`shapersmith {command}" in routes, command


def test_the_readme_is_short() -> None:
    assert len((ROOT / "README.md").read_text().split()) <= MOST_WORDS


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_to_files_that_are_there(document: Path) -> None:
    links = re.findall(r"\]\(([^)#\s]+)", document.read_text())
    lost = [
        link
        for link in links
        if not link.startswith(("http://", "https://"))
        and not (document.parent / link).exists()
        and link not in MADE
    ]
    assert not lost


def test_every_page_is_reached_from_the_list_of_pages() -> None:
    assert "](docs/index.md)" in (ROOT / "README.md").read_text()
    pages = {page.name for page in (ROOT / "docs").glob("*.md")} | MADE
    listed = set(re.findall(r"\]\(([a-z-]+\.md)\)", (ROOT / "docs/index.md").read_text()))
    assert pages == listed | {"index.md"}
