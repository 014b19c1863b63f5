"""A file as a response, whole or the range that is asked for (RFC 9110, section 14)."""

import asyncio
import os
import re
from collections.abc import AsyncIterator
from pathlib import Path
from typing import BinaryIO

from starlette.datastructures import Headers
from starlette.responses import Response, StreamingResponse

from service.problems import RANGE_NOT_SATISFIABLE, Problem, ProblemError

RANGE = re.compile(r"bytes=(\d{1,18})-(\d{0,18})\Z|bytes=-(\d{1,18})\Z", re.ASCII | re.IGNORECASE)
"""One range; what has more of them, or more digits than a file has bytes, is ignored."""

PIECE_BYTES = 256 * 1024


def file_response(path: Path, asked: Headers, headers: dict[str, str]) -> Response:
    """Return a file, or the range of it that a request asks for.

    Parameters
    ----------
    path
        The file.
    asked
        Headers of the request.
    headers
        Of the response, its entity tag among them.

    Returns
    -------
    Response
        Status 200 with the whole file, or 206 with the range.

    Raises
    ------
    FileNotFoundError
        If there is none.
    ProblemError
        If the file has no such range.
    """
    file = path.open("rb")
    size = os.fstat(file.fileno()).st_size
    headers = {**headers, "accept-ranges": "bytes"}
    first, stop, status = 0, size, 200
    wanted = RANGE.match(asked.get("range", ""))
    if wanted is not None and asked.get("if-range", headers["etag"]) == headers["etag"]:
        first, stop = _range(wanted, size)
        if first > stop:
            first, stop = 0, size  # no range: it ends before it begins
        elif first == stop:
            file.close()
            raise ProblemError(
                Problem(RANGE_NOT_SATISFIABLE, f"the file has {size} bytes"),
                {"content-range": f"bytes */{size}"},
            )
        else:
            status = 206
            headers["content-range"] = f"bytes {first}-{stop - 1}/{size}"
    headers["content-length"] = str(stop - first)
    return StreamingResponse(_pieces(file, first, stop), status_code=status, headers=headers)


def _range(wanted: re.Match[str], size: int) -> tuple[int, int]:
    """Return the first byte and the one after the last; the same where the file has none of it."""
    first, last, suffix = wanted.groups()
    if suffix is not None:
        return max(size - int(suffix), 0), size
    if last and int(last) < int(first):
        return 1, 0
    return min(int(first), size), min(int(last) + 1, size) if last else size


async def _pieces(file: BinaryIO, first: int, stop: int) -> AsyncIterator[bytes]:
    with file:
        await asyncio.to_thread(file.seek, first)
        while first < stop:
            piece = await asyncio.to_thread(file.read, min(PIECE_BYTES, stop - first))
            if not piece:
                raise EOFError("the file is shorter than it was")
            first += len(piece)
            yield piece
