"""What is wrong with the environment, or an address, is said by the names that people typed."""

import re

import pytest
from pydantic import ValidationError

from service.__main__ import main
from service.environment import why_refused
from service.settings import PREFIX, Settings


def refusal(**environment: str) -> str:
    with pytest.raises(ValidationError) as refused:
        Settings.from_environment({f"{PREFIX}{name}": value for name, value in environment.items()})
    return why_refused(refused.value)


@pytest.mark.parametrize("setting", Settings.model_fields)
def test_a_slip_of_a_name_is_answered_with_the_name_as_it_must_stand(setting: str) -> None:
    name = setting.upper()
    told = refusal(**{name[:-1]: "2"})
    assert told.startswith(f"{PREFIX}{name[:-1]}: is no setting; did you mean ")
    assert f"{PREFIX}{name}" in re.split(r"[ ,?]+", told)
    names = re.split(r", | or ", told.partition("did you mean ")[2].removesuffix("?"))
    assert all(one.removeprefix(PREFIX).lower() in Settings.model_fields for one in names)


def test_what_is_like_no_setting_is_answered_with_all() -> None:
    told = refusal(XYZZY="2")
    assert all(f"{PREFIX}{name.upper()}" in told for name in Settings.model_fields)


@pytest.mark.parametrize(
    ("name", "text", "number"),
    [
        ("WORKER_MEMORY_BYTES", "2GB", "2000000000"),
        ("WORKER_MEMORY_BYTES", "2 GiB", "2147483648"),
        ("WORKER_MEMORY_BYTES", "1,5 G", "1500000000"),
        ("MAX_BODY_BYTES", "512k", "512000"),
        ("MAX_BATCH_BYTES", "8 MiB", "8388608"),
        ("TIME_LIMIT_S", "30s", "30"),
        ("BATCH_LIMIT_S", "5 min", "300"),
        ("EXPORT_LIMIT_S", "1h", "3600"),
        ("STALLED_S", "500 ms", "0.5"),
        ("KEEP_TABLES_DAYS", "36 hours", "1.5"),
    ],
)
def test_a_number_with_a_unit_is_answered_with_the_number_that_is_taken(
    name: str, text: str, number: str
) -> None:
    told = refusal(**{name: text})
    assert told.startswith(f"{PREFIX}{name}: must be a")
    assert told.endswith(f"got {text!r}; give {number}")
    Settings.from_environment({f"{PREFIX}{name}": number})


def test_every_setting_at_fault_is_named() -> None:
    told = refusal(WORKERS="two", MAX_PENDING="0", KEY="x")
    assert told.count(PREFIX) >= 3
    assert f"{PREFIX}WORKERS: must be a whole number, got 'two'; {PREFIX}MAX_PENDING: " in told


@pytest.mark.parametrize(
    ("host", "told"),
    [
        ("0.0.0.0:18001", "give --host 0.0.0.0 --port 18001"),
        ("localhost:80", "give --host localhost --port 80"),
        ("[::1]:8000", "give --host ::1 --port 8000"),
        ("http://10.0.0.1:8000/", "give --host 10.0.0.1 --port 8000"),
        ("http://10.0.0.1", "give --host 10.0.0.1"),
    ],
)
def test_an_address_with_a_port_is_answered_with_both_options(
    host: str, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["serve", "--host", host]) == 2
    assert capsys.readouterr().err.endswith(f", got {host!r}; {told}\n")


def test_an_address_of_ipv6_is_no_port() -> None:
    from service.__main__ import _require_address

    for host in ("::1", "::", "fe80::1:8000", "127.0.0.1", "localhost"):
        _require_address(host)
