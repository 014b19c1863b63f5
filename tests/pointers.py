"""What a problem's pointers lead to in the request that was refused (RFC 6901)."""

import json
from typing import Any

import httpx


def inner(here: Any, part: str) -> Any:
    """Return what a part of a pointer names in a value; raise LookupError if there is none."""
    if isinstance(here, list):
        if not part.isdecimal() or (part != "0" and part.startswith("0")):
            raise LookupError(part)
        return here[int(part)]
    if isinstance(here, dict):
        return here[part]
    raise LookupError(part)


def leads_somewhere(pointer: str, body: Any) -> bool:
    """Whether a pointer names a value in the body, or a field missing from an object there."""
    if not pointer:
        return True
    first, *parts = pointer.split("/")
    parts = [part.replace("~1", "/").replace("~0", "~") for part in parts]
    if first:
        return False
    here = body
    try:
        for part in parts[:-1]:
            here = inner(here, part)
    except LookupError:
        return False
    if isinstance(here, dict):
        return True
    try:
        inner(here, parts[-1])
    except LookupError:
        return False
    return True


def require_pointers(response: httpx.Response) -> None:
    """Fail unless every pointer of a problem leads somewhere in the body that was sent."""
    request = response.request
    refused = response.headers.get("content-type") == "application/problem+json"
    if request.method != "POST" or not refused or request.url.path.endswith("/batch"):
        return  # a stream of events is left to the test
    response.read()
    faults = response.json()["errors"]
    if not faults:
        return
    body = json.loads(request.content, parse_int=float)
    astray = [
        fault["pointer"]
        for fault in faults
        if not leads_somewhere(fault["pointer"], body) and not fault["pointer"].endswith("...")
    ]
    assert not astray, (astray, request.content[:1000])
