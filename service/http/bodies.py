"""Bodies in, answers out: what all routes share."""

import asyncio

from starlette.requests import Request

from service.problems import (
    REQUEST_TIMEOUT,
    TOO_LARGE,
    UNSUPPORTED_MEDIA_TYPE,
    Problem,
    ProblemError,
)

BODY_WAIT_S = 20.0
"""Longest wait for a body [s]."""


async def read_body(request: Request, *, limit_bytes: int, media_types: tuple[str, ...]) -> bytes:
    """Return the body, read no further than its limit.

    Parameters
    ----------
    request, limit_bytes
        The request, and its longest body [bytes].
    media_types
        Values of ``content-type`` that are accepted, the usual one first.

    Returns
    -------
    bytes
        The whole body.

    Raises
    ------
    ProblemError
        If it is longer or late, or its ``content-type`` is not accepted.
    ClientDisconnect
        If the client is gone before the body is whole.
    """
    media_type = request.headers.get("content-type", media_types[0]).split(";")[0].strip().lower()
    if media_type not in media_types:
        accepted = " or ".join(media_types)
        raise ProblemError(
            Problem(UNSUPPORTED_MEDIA_TYPE, f"content-type must be {accepted}, got {media_type!r}")
        )
    body = bytearray()
    try:
        async with asyncio.timeout(BODY_WAIT_S):
            async for part in request.stream():
                body += part
                if len(body) > limit_bytes:
                    detail = f"the body must be at most {limit_bytes} bytes"
                    raise ProblemError(Problem(TOO_LARGE, detail))
    except TimeoutError:
        detail = f"the body did not arrive within {BODY_WAIT_S:g} s"
        raise ProblemError(Problem(REQUEST_TIMEOUT, detail)) from None
    return bytes(body)
