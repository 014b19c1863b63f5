"""The running server: socket, log and signals around the app."""

import ctypes
import logging
import math
import os
import signal
import socket
import sys
from types import FrameType

import uvicorn

from service.compiled_code import keep_in
from service.http.app import create_app
from service.http.refusing import RefusingProtocol
from service.jobs.service import JobService
from service.log import log_to_stderr
from service.settings import Settings

SHUTDOWN_MARGIN_S = 5
"""How much longer than the longest task a shutdown may take [s]."""

LIVE_PING_S = 2.0
"""How often a live client is asked for a sign of life, and how long it may take [s]."""

STOPS = [
    getattr(signal, name) for name in ("SIGTERM", "SIGINT", "SIGBREAK") if hasattr(signal, name)
]
"""Signals that end the service well; the last is Ctrl+Break, which Windows alone has."""


class PortTakenError(Exception):
    """The address cannot be bound."""


def serve(settings: Settings, *, host: str, port: int) -> None:
    """Serve until a signal ends it, one of `STOPS`.

    The work that runs then is finished, and new work is refused.

    Parameters
    ----------
    settings
        Settings of the service.
    host
        Address to bind; one with a colon is of IPv6.
    port
        Port to bind; 0 for any that is free.

    Raises
    ------
    PortTakenError
        If the address cannot be bound.
    StoreError
        If the job store cannot be used.
    """
    listener = _listen(host, port)
    log_to_stderr()
    keep_in(settings.data_dir)
    # uvicorn raises the signal again once it has stopped: this makes that the end, with status 0.
    for number in STOPS:
        signal.signal(number, _stop_quietly)
    app = create_app(settings, jobs=JobService(settings))
    config = uvicorn.Config(
        app,
        http=RefusingProtocol,
        log_config=None,
        access_log=False,
        server_header=False,
        ws="wsproto",
        # A socket that has vanished is known within some seconds: its crane is stopped then.
        ws_ping_interval=LIVE_PING_S,
        ws_ping_timeout=LIVE_PING_S,
        ws_max_size=settings.max_body_bytes,
        # What a worker has begun ends within its limit; whoever waits longer, as a batch or one who
        # has not even sent a body, is cut off.
        timeout_graceful_shutdown=math.ceil(settings.time_limit_s) + SHUTDOWN_MARGIN_S,
    )
    bound_host, bound_port = listener.getsockname()[:2]
    address = f"http://{f'[{bound_host}]' if ':' in bound_host else bound_host}:{bound_port}"
    logging.getLogger("shapersmith").info(
        "serving on %s, its documentation on %s/docs", address, address
    )
    server = uvicorn.Server(config)
    app.state.stopping = lambda: server.should_exit
    server.run(sockets=[listener])


def _stop_quietly(number: int, frame: FrameType | None) -> None:
    del number, frame


def _reason(error: OSError) -> str:
    if isinstance(error, socket.gaierror) or error.errno is None:
        return str(error.strerror)
    if sys.platform == "win32":
        return ctypes.FormatError(error.errno)
    return os.strerror(error.errno)


def _listen(host: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        return socket.create_server((host, port), family=family, backlog=2048)
    except OSError as error:
        raise PortTakenError(f"cannot serve on {host} port {port}: {_reason(error)}") from None
