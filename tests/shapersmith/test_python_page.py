"""Every example of docs/python.md runs and prints what the page says."""

import contextlib
import inspect
import io
import re
from pathlib import Path

import pytest

import shapersmith
from service.operations.table import TABLE
from shapersmith.errors import ShapersmithError
from shapersmith.here import HERE
from tests.conftest import Running
from tests.shapersmith.requests import REQUESTS, call

PAGE = (Path(__file__).parents[2] / "docs" / "python.md").read_text()
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```$", PAGE, flags=re.DOTALL | re.MULTILINE)
PROSE = re.sub(r"^```.*?^```$", "", PAGE, flags=re.DOTALL | re.MULTILINE)

MAX_SENTENCE_WORDS = 35


def without_rounding(text: str) -> str:
    """Return a text without the numbers that another processor rounds otherwise."""
    return re.sub(r"[\d.]+e-\d+", "tiny", text)


@pytest.fixture(scope="module")
def after(service: Running, tmp_path_factory: pytest.TempPathFactory) -> dict[str, object]:
    """Return what the names of the page stand for, once all of its blocks have run in order."""
    names: dict[str, object] = {}
    printed = ""
    with (
        pytest.MonkeyPatch.context() as patch,
        contextlib.chdir(tmp_path_factory.mktemp("page")),
    ):
        patch.setenv("no_proxy", "127.0.0.1")
        for language, block in BLOCKS:
            if language == "python":
                program = block.replace("http://127.0.0.1:8000", service.address)
                with contextlib.redirect_stdout(io.StringIO()) as out:
                    exec(program, names)
                printed = out.getvalue()
            else:
                assert without_rounding(printed) == without_rounding(block)
        assert Path("move.png").read_bytes().startswith(b"\x89PNG")
    return names


def test_every_block_runs_and_prints_what_is_said(after: dict[str, object]) -> None:
    assert isinstance(after["found"], shapersmith.Design)
    assert isinstance(after["remote"], shapersmith.Client)
    swing_rad, residuals = after["swing_rad"], after["residuals"]
    assert isinstance(swing_rad, float)
    assert 0.01 < swing_rad < 0.2
    assert getattr(residuals, "shape", None) == (21,)


def test_a_row_of_the_page_is_a_function_with_its_route_and_fields() -> None:
    rows = dict(re.findall(r"^\| (`\w+`) \| `POST ([\w/]+)` \|.*\|$", PAGE, re.MULTILINE))
    calls = {f"`{call(HERE, name).__name__}`": row.path for name, row in TABLE.items()}
    assert rows == calls
    for operation in REQUESTS:
        called = call(HERE, operation)
        (row,) = re.findall(rf"^\| `{called.__name__}` \|.*\| (.*)\|$", PAGE, re.MULTILINE)
        answer = getattr(shapersmith, inspect.signature(called).return_annotation.__name__)
        for field in re.findall(r"`(\w+)(?:\(\))?`", row):
            assert hasattr(answer, field), field
        assert ("plot" in row) == hasattr(answer, "plot")


def test_each_class_of_errors_is_on_the_page() -> None:
    classes = set(re.findall(r"^\| `(\w+Error)` \|", PAGE, re.MULTILINE))
    public = {
        name
        for name in shapersmith.__all__
        if isinstance(getattr(shapersmith, name), type)
        and issubclass(getattr(shapersmith, name), ShapersmithError)
    }
    assert classes == public - {"ShapersmithError"}


def test_no_sentence_of_the_page_is_long() -> None:
    paragraphs = [part for part in PROSE.split("\n\n") if not part.startswith(("|", "#"))]
    sentences = re.split(r"(?<=[.:;])\s", " ".join(paragraphs))
    assert max(len(sentence.split()) for sentence in sentences) <= MAX_SENTENCE_WORDS
