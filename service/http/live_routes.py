"""The route of live sessions: a WebSocket on which a crane is driven."""

from urllib.parse import urlsplit

from fastapi import APIRouter, WebSocket

from service.http.handlers import problem_response
from service.http.live_session import LiveSession
from service.http.middleware import request_id_of
from service.problems import FORBIDDEN, OVERLOADED, Problem

PATH = "/v1/live"

router = APIRouter()


@router.websocket(PATH)
async def live(socket: WebSocket) -> None:
    """Drive a crane: the first message is a run without events, the others are events."""
    request_id = request_id_of(socket.scope)
    refused = _refusal(socket)
    if refused is not None:
        await socket.send_denial_response(problem_response(refused, request_id))
        return
    sessions: set[str] = socket.app.state.live_sessions
    sessions.add(request_id)
    try:
        await socket.accept(headers=[(b"x-request-id", request_id.encode())])
        await LiveSession(socket, request_id).drive()
    finally:
        sessions.discard(request_id)


def _refusal(socket: WebSocket) -> Problem | None:
    """Return why a session is not begun."""
    origin = socket.headers.get("origin")
    # A page of another site may open a socket to here: browsers ask nobody, but say whose it is.
    if origin is not None and urlsplit(origin).netloc != socket.headers.get("host"):
        return Problem(FORBIDDEN, f"a page of {origin} may not drive a crane here")
    sessions, most = socket.app.state.live_sessions, socket.app.state.settings.max_live
    if len(sessions) >= most:
        return Problem(OVERLOADED, f"all {most} live sessions are taken")
    return None
