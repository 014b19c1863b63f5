"""`python -m service`, the command `shapersmith`: the command line, and the service it starts."""

import os
import sys
from collections.abc import Sequence

from service.cli.given_files import UsageError
from service.cli.main import FAILED, OK
from service.cli.main import main as run_command


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status."""
    return run_command(arguments, serve_with_settings)


def serve_with_settings(host: str, port: int) -> int:
    """Serve as the environment says, until ended; return the exit status."""
    # --help must not wait for them.
    from pydantic import ValidationError  # noqa: PLC0415

    from service.environment import why_refused  # noqa: PLC0415
    from service.http.server import PortTakenError, serve  # noqa: PLC0415
    from service.jobs.database import StoreError  # noqa: PLC0415
    from service.settings import Settings  # noqa: PLC0415

    if not 0 <= port <= 65535:  # noqa: PLR2004 - the range of a port
        raise UsageError(f"--port must be between 0 and 65535, got {port}")
    _require_address(host)
    try:
        settings = Settings.from_environment(os.environ)
    except ValidationError as error:
        raise UsageError(why_refused(error)) from None
    try:
        serve(settings, host=host, port=port)
    except (PortTakenError, StoreError) as error:
        print(f"shapersmith: {error}", file=sys.stderr)  # noqa: T201
        return FAILED
    return OK


def _require_address(host: str) -> None:
    """Refuse an address with what belongs to another option, or to none."""
    address = host.partition("://")[2].partition("/")[0] if "://" in host else host
    name, colon, port = address.rpartition(":")
    if name.startswith("[") and name.endswith("]"):
        name = name[1:-1]
    elif ":" in name:
        name, colon, port = address, "", ""  # all of it is of IPv6
    if colon and port.isdecimal():
        raise UsageError(f"--host takes no port, got {host!r}; give --host {name} --port {port}")
    if "://" in host:
        raise UsageError(f"--host takes an address alone, got {host!r}; give --host {address}")


if __name__ == "__main__":
    sys.exit(main())
