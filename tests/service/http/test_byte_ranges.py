"""Every form of a Range header: served, ignored or refused (RFC 9110, section 14)."""

import asyncio
from pathlib import Path
from typing import Any

import pytest
from starlette.datastructures import Headers
from starlette.responses import Response, StreamingResponse

from service.http.byte_ranges import PIECE_BYTES, file_response
from service.problems import ProblemError

CONTENT = bytes(range(251)) * (3 * PIECE_BYTES // 251)
SIZE = len(CONTENT)
DIGITS = "9" * 5000
"""More than `int` reads."""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    file = tmp_path / "table"
    file.write_bytes(CONTENT)
    return file


def ask(path: Path, **headers: str) -> Response:
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    return file_response(path, Headers(named), {"etag": '"tag"', "content-type": "text/csv"})


def body_of(response: Response) -> bytes:
    async def body() -> bytes:
        assert isinstance(response, StreamingResponse)
        pieces: list[Any] = [piece async for piece in response.body_iterator]
        return b"".join(pieces)

    return asyncio.run(body())


@pytest.mark.parametrize(
    ("header", "first", "last"),
    [
        ("bytes=0-0", 0, 0),
        ("bytes=10-19", 10, 19),
        (f"bytes=5-{2 * PIECE_BYTES}", 5, 2 * PIECE_BYTES),
        ("bytes=7-", 7, SIZE - 1),
        ("bytes=-7", SIZE - 7, SIZE - 1),
        (f"bytes={SIZE - 1}-", SIZE - 1, SIZE - 1),
        (f"bytes=0-{10 * SIZE}", 0, SIZE - 1),
        (f"bytes=-{10 * SIZE}", 0, SIZE - 1),
        ("Bytes=1-2", 1, 2),
        ("bytes=000001-2", 1, 2),
    ],
)
def test_a_range_is_served(path: Path, header: str, first: int, last: int) -> None:
    part = ask(path, range=header)
    assert part.status_code == 206
    assert part.headers["content-range"] == f"bytes {first}-{last}/{SIZE}"
    assert part.headers["content-length"] == str(last - first + 1)
    assert body_of(part) == CONTENT[first : last + 1]


@pytest.mark.parametrize(
    "header",
    [
        "",
        "bytes",
        "bytes=",
        "bytes=-",
        "bytes=9-1",
        "bytes=1-2,4-5",
        "bytes=a-b",
        "bytes=+1-2",
        "bytes=1_0-2_0",
        "bytes=\xb2-",
        "bytes= 1-2",
        "lines=1-2",
        f"bytes={DIGITS}-",
        f"bytes=0-{DIGITS}",
        f"bytes=-{DIGITS}",
        "bytes=0-1," * 1000,
    ],
)
def test_a_range_that_cannot_be_read_is_ignored(path: Path, header: str) -> None:
    whole = ask(path, range=header)
    assert (whole.status_code, whole.headers["content-length"]) == (200, str(SIZE))
    assert body_of(whole) == CONTENT


@pytest.mark.parametrize("header", [f"bytes={SIZE}-", "bytes=999999999-", "bytes=-0"])
def test_a_range_beyond_the_file_is_refused_with_its_size(path: Path, header: str) -> None:
    with pytest.raises(ProblemError, match=f"has {SIZE} bytes") as refused:
        ask(path, range=header)
    assert refused.value.problem.kind.http == 416
    assert refused.value.headers == {"content-range": f"bytes */{SIZE}"}
    assert body_of(ask(path, range=header, if_range='"old"')) == CONTENT


def test_a_range_of_another_file_is_not_mixed_into_this_one(path: Path) -> None:
    assert body_of(ask(path, range="bytes=1-2", if_range='"tag"')) == CONTENT[1:3]
    for other in ('"old"', 'W/"tag"', "Sat, 01 Jan 2000 00:00:00 GMT"):
        assert body_of(ask(path, range="bytes=1-2", if_range=other)) == CONTENT
