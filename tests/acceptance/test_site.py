"""The documentation as a site: built without a warning, complete, and of no other server."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from design.shapers.registry import SHAPERS
from service.cli.main import COMMANDS
from service.http.app import create_app
from service.problems import KIND_OF
from service.settings import PREFIX, Settings
from tests.errors_raised import codes

ROOT = Path(__file__).parents[2]

ELSEWHERE = re.compile(r"""<(?:script|link|img|iframe)\b[^>]*(?:src|href)=["']?(?:https?:)?//""")
"""What a browser would fetch from another server; a link that a person follows is none."""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the site; a warning is an error where it is built."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--quiet", "--site-dir", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True)
    return folder


def test_every_page_is_there_and_can_be_searched(site: Path) -> None:
    index = (site / "search/search_index.json").read_text()
    pages = [page.stem for page in (ROOT / "docs").glob("*.md")]
    for page in (*pages, "kinds", "commands", "errors"):
        assert (site / f"{page}.html").is_file(), page
        assert f'"location":"{page}.html' in index, page


def test_the_reference_has_every_kind_command_and_error(site: Path) -> None:
    kinds, commands, errors = (
        (site / f"{page}.html").read_text() for page in ("kinds", "commands", "errors")
    )
    for kind in SHAPERS:
        assert f'<h2 id="{kind}">' in kinds, kind
    for command in (*COMMANDS, "table", "shapers", "serve"):
        assert f"shapersmith {command}</h2>" in re.sub(r"<a .*?</a>", "", commands), command
    for code in (*codes(), *(kind.name for kind in KIND_OF.values())):
        assert f"<code>{code}</code>" in errors, code


def test_the_reference_has_every_route_with_its_command(site: Path) -> None:
    routes = re.sub(r"</?code>", "", (site / "routes.html").read_text())
    for path, methods in create_app(Settings()).openapi()["paths"].items():
        for method in methods:
            assert f"<td>{method.upper()} {path}</td>" in routes, (method, path)
    commands = set(re.findall(r"<td>shapersmith (\w+)</td>", routes))
    assert commands == {*COMMANDS, "table", "shapers", "schemas"}


def test_the_reference_has_every_setting_with_its_default(site: Path) -> None:
    settings = re.sub(r"</?code>", "", (site / "settings.html").read_text())
    rows = dict(re.findall(rf"<td>{PREFIX}(\w+)</td>\s*<td>(.*?)</td>", settings))
    assert {name.lower() for name in rows} == set(Settings.model_fields)
    assert (rows["WORKERS"], rows["JOB_WORKERS"]) == ("processors + 1", "processors")
    assert (rows["MAX_BODY_BYTES"], rows["DATA_DIR"]) == ("1,048,576", "shapersmith-data")
    assert rows["DATABASE_URL"] == ""


def test_nothing_is_fetched_from_another_server(site: Path) -> None:
    for page in site.rglob("*.html"):
        assert not ELSEWHERE.search(page.read_text()), page
