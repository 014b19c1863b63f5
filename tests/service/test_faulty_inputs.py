"""Each slip of people is answered with field, rule, value and repair, over HTTP and for files."""

from collections import Counter
from pathlib import Path

import pytest

from service.cli.reading import ReadingError, read_request, read_source
from service.dispatch import respond
from service.operations.table import TABLE
from service.problems import Problem
from tests.service.cli.commands import shapersmith
from tests.service.faulty_inputs import FAULTY, LISTS, Faulty
from tests.service.http.in_process import InProcess
from tests.service.test_plain_words import JARGON

LEAST = 60
"""Inputs; of each kind of slip there are two or more."""


@pytest.fixture(scope="module")
def service() -> InProcess:
    return InProcess()


def name_of(faulty: Faulty) -> str:
    return f"{faulty.slip}-{faulty.told[-2 if faulty.told[-1] == 'near `' else -1]}"


every_input = pytest.mark.parametrize("faulty", FAULTY, ids=name_of)


def test_there_are_enough_of_each_kind() -> None:
    assert len(FAULTY) >= LEAST
    assert min(Counter(one.slip for one in FAULTY).values()) >= 2
    assert len({(one.operation, one.body) for one in FAULTY}) == len(FAULTY)


@every_input
def test_a_fault_is_answered_over_http(service: InProcess, faulty: Faulty) -> None:
    answer = service.ask("POST", TABLE[faulty.operation].path, faulty.body)
    document = answer.json()
    assert answer.status_code == (400 if faulty.code == "not_json" else 422)
    assert document["code"] == faulty.code
    if faulty.pointer:
        (fault,) = document["errors"]
        assert (fault["pointer"], fault["code"]) == (faulty.pointer, faulty.code)
    for part in faulty.told:
        assert part in document["detail"]
    assert not [word for word in JARGON if word in document["detail"]]


@every_input
def test_a_fault_of_a_file_is_one_line_with_its_place(tmp_path: Path, faulty: Faulty) -> None:
    path = tmp_path / "crane.json"
    path.write_bytes(faulty.body)
    if faulty.file_is_read:
        read = read_request(faulty.body, toml=False)
        assert not isinstance(respond(faulty.operation, read), Problem)
        return
    done = shapersmith(TABLE[faulty.operation].command, path)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    name = (
        "not-json: crane.json" if faulty.code == "not_json" else f"invalid-input: {faulty.pointer}"
    )
    assert name.replace("crane.json", str(path)) in done.stderr
    for part in faulty.told:
        assert part in done.stderr


@pytest.mark.parametrize(("name", "text", "code", "told"), LISTS)
def test_a_fault_of_a_list_names_the_file(
    tmp_path: Path, name: str, text: str, code: str, told: str
) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(ReadingError) as refused:
        read_source(b'{"designs_file": "%b"}' % name.encode(), toml=False, folder=tmp_path)
    (fault,) = refused.value.problem.errors
    assert (fault.pointer, fault.code) == ("/designs_file", code)
    assert fault.detail.startswith((f"{name} line ", f"{name}: "))
    assert told in fault.detail


@pytest.mark.parametrize(
    "text", [b"[plant]\nkind = pendulum\n", b"[plant]\ncable_length_m = 0,8\n"]
)
def test_a_text_in_toml_is_refused_with_its_place(text: bytes) -> None:
    with pytest.raises(ReadingError) as refused:
        read_request(text, toml=True)
    assert "line 2" in str(refused.value)
