"""Entity tags, by which a client says what it has already (RFC 9110, section 13)."""

from starlette.requests import Request

HEADER = "if-none-match"


def held_tags(request: Request) -> set[str]:
    """Return the tags that a request lists, weak ones too (RFC 9110, 13.1.2)."""
    return {tag.strip().removeprefix("W/") for tag in request.headers.get(HEADER, "").split(",")}
