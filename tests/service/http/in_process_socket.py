"""A WebSocket to the app in this process, asked step by step."""

import asyncio
import json
from collections.abc import Mapping
from types import TracebackType
from typing import Any, Self

from tests.patience import PATIENT_S
from tests.service.http.in_process import InProcess


class Refused(Exception):
    """The app answered with a response in place of a socket."""

    def __init__(self, status: int, headers: Mapping[str, str], body: bytes) -> None:
        super().__init__(f"{status}: {body!r}")
        self.status, self.headers, self.document = status, headers, json.loads(body)


class Closed(Exception):
    """The app closed the socket."""

    def __init__(self, code: int, reason: str) -> None:
        super().__init__(f"{code}: {reason}")
        self.code, self.reason = code, reason


class Socket:
    """An open socket; the app moves on while a message is awaited."""

    def __init__(self, service: InProcess, path: str, headers: Mapping[str, str]) -> None:
        self._loop = asyncio.new_event_loop()
        self._to_app: asyncio.Queue[dict[str, Any]] = asyncio.Queue()
        self._from_app: asyncio.Queue[dict[str, Any]] = asyncio.Queue()
        sent = {"host": "service", **headers}
        scope = {
            "type": "websocket",
            "path": path,
            "raw_path": path.encode(),
            "query_string": b"",
            "root_path": "",
            "scheme": "ws",
            "subprotocols": [],
            "client": ("127.0.0.1", 1),
            "server": ("service", 80),
            "headers": [(name.encode(), value.encode()) for name, value in sent.items()],
            "extensions": {"websocket.http.response": {}},
        }
        self._to_app.put_nowait({"type": "websocket.connect"})
        self._app = self._loop.create_task(
            service.app(scope, self._to_app.get, self._from_app.put)  # type: ignore[arg-type]
        )

    def __enter__(self) -> Self:
        try:
            self._accept()
        except Refused:
            self.leave()
            raise
        return self

    def _accept(self) -> None:
        answer = self._next()
        if answer["type"] == "websocket.accept":
            return
        body = self._next()["body"]
        headers = {name.decode(): value.decode() for name, value in answer["headers"]}
        raise Refused(answer["status"], headers, body)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.leave()

    def leave(self) -> None:
        """Vanish, and wait until the app is done with it."""
        self._to_app.put_nowait({"type": "websocket.disconnect", "code": 1006})
        self._loop.run_until_complete(asyncio.wait_for(self._app, PATIENT_S))
        self._loop.close()

    def send(self, message: str | bytes) -> None:
        """Send a text or bytes."""
        name = "text" if isinstance(message, str) else "bytes"
        self._to_app.put_nowait({"type": "websocket.receive", name: message})

    def receive(self) -> str:
        """Return the next text."""
        message = self._next()
        if message["type"] == "websocket.close":
            raise Closed(message["code"], message["reason"])
        text: str = message["text"]
        return text

    def _next(self) -> dict[str, Any]:
        return self._loop.run_until_complete(asyncio.wait_for(self._from_app.get(), PATIENT_S))
