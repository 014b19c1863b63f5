"""The command line: one command a route, the same JSON.

Exit status: 0 done, 2 invalid input or usage, 3 infeasible, 4 solver failed or time limit,
5 a checked table has drifted, 1 anything else.
"""

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from design.export.formats import FORMATS, LOG_FORMAT
from service.cli import streams
from service.cli.given_files import (
    PICTURES,
    UsageError,
    is_same_file,
    read_file,
    require_file,
    require_picture,
)
from service.operations.table import TABLE as OPERATIONS
from service.operations.table import load

if TYPE_CHECKING:
    from service.cli.rendering import Response
    from service.problems import Problem

OK = 0
FAILED = 1
USAGE = 2

COMMANDS = {row.command: name for name, row in OPERATIONS.items()}
"""Names of the operations, by command."""

TABLE_HELP = "a table of designs over axes or a list, into a file (POST /v1/tables)"
SCHEMAS_HELP = "JSON Schema of every request and response, a file each (GET /v1/schemas)"
PROGRAMS = {
    "design": tuple(name for name, row in FORMATS.items() if row.is_program),
    "maneuver": tuple(name for name, row in FORMATS.items() if row.plays_moves),
    "run": tuple(name for name, row in FORMATS.items() if row.plays_moves),
}
"""Formats of a table that one answer of an operation has too, by the operation."""

PROGRAM_HELP = {
    "design": "the shaper as a program or a line of firmware",
    "maneuver": "the move as blocks or functions that are called once a cycle",
    "run": "in live mode, the block that shapes live commands on a controller",
}
"""What is written in them."""

IN_REAL = tuple(name for name, row in FORMATS.items() if row.has_real)
"""Formats whose numbers are of a type that is asked for."""

MAX_WORKERS = 1024

PLOT_HELP = "draw the answer: FILE.png, FILE.svg or FILE.html"


class _Completion(argparse.Action):
    """Print what a shell needs to complete words; shtab is imported only then."""

    def __call__(
        self, parser: argparse.ArgumentParser, _: object, values: object, *__: object
    ) -> None:
        from service.cli.completion import completion_of  # noqa: PLC0415

        sys.stdout.write(completion_of(parser, str(values)))
        parser.exit()


class _Version(argparse.Action):
    """Print the version; it is looked up only then, for --help must not wait for it."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from service.version import version  # noqa: PLC0415

        sys.stdout.write(f"shapersmith {version()}\n")
        parser.exit()


def main(arguments: Sequence[str] | None, serve: Callable[[str, int], int]) -> int:
    """Run one command and return its exit status.

    Parameters
    ----------
    arguments
        Words of the command line after the name of the program; None for those of this process.
    serve
        Serves on a host and a port, and returns the exit status.

    Returns
    -------
    int
        Exit status, see the module.

    Raises
    ------
    SystemExit
        If help is asked for, or the arguments are no command.
    """
    # As in the workers of the service: on a busy machine threads of BLAS wait for each other.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    streams.prepare()
    options = command_parser().parse_args(arguments)
    try:
        _require_json_if_pretty(options)
        _require_real(options)
        if options.command == "serve":
            return serve(options.host, options.port)
        if options.command == "shapers":
            return _shapers(options)
        if options.command == "schemas":
            from service.cli.schema_files import write_into  # noqa: PLC0415

            return write_into(options.output)
        if options.command == "table":
            return _table(options)
        return _answer(options)
    except UsageError as error:
        print(f"shapersmith: {error}", file=sys.stderr)  # noqa: T201 - this is the command line
        return USAGE
    except BrokenPipeError:
        _silence_stdout()  # the reader has seen enough
        return FAILED
    except Exception as error:  # noqa: BLE001 - the last resort: a line, not a traceback
        _silence_stdout()
        print(f"shapersmith: {type(error).__name__}: {error}", file=sys.stderr)  # noqa: T201
        return FAILED


def _require_json_if_pretty(options: argparse.Namespace) -> None:
    if getattr(options, "pretty", False) and options.format not in {None, "json"}:
        raise UsageError(f"--pretty goes with json, not with {options.format}")


def _require_real(options: argparse.Namespace) -> None:
    if getattr(options, "real", None) is not None and options.format not in IN_REAL:
        given = options.format or "json"
        raise UsageError(f"--real goes with {', '.join(IN_REAL)}, not with {given}")


def _silence_stdout() -> None:
    """Keep Python from complaining once more when it flushes at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def command_parser() -> argparse.ArgumentParser:
    """Return what reads the arguments of the command line."""
    parser = argparse.ArgumentParser(
        prog="shapersmith",
        description="Input shapers for flexible machines whose actuators are not ideal.",
        epilog=__doc__.partition("\n\n")[2] if __doc__ else None,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version")
    parser.add_argument(
        "--print-completion",
        action=_Completion,
        choices=("bash", "zsh"),
        help="print what this shell needs to complete words of the command",
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for operation, row in OPERATIONS.items():
        summary = f"{row.help} (POST {row.path})"
        command = commands.add_parser(row.command, help=summary, description=summary)
        command.add_argument(
            "request",
            metavar="REQUEST",
            help="the request, .json or .toml; - reads JSON from stdin",
        )
        _add_format(command, operation)
        if operation == "run":
            command.add_argument(
                "--play",
                metavar="FILE",
                type=Path,
                help="play this CSV: times_s and x_velocity_m_s or x_position_m, the same for y",
            )
        if operation == "design":
            command.add_argument(
                "--trace",
                action="store_true",
                help="report each step of the search; with --plot, draw it in place",
            )
        command.add_argument("--plot", metavar="FILE", type=Path, help=PLOT_HELP)
    _add_format(commands.add_parser("shapers", help="every kind of shaper (GET /v1/shapers)"))
    _add_table(commands.add_parser("table", help=TABLE_HELP, description=TABLE_HELP))
    schemas = commands.add_parser("schemas", help=SCHEMAS_HELP, description=SCHEMAS_HELP)
    schemas.add_argument(
        "-o",
        "--output",
        metavar="FOLDER",
        type=Path,
        default=Path("shapersmith-schemas"),
        help="folder to write to, %(default)s if not given",
    )
    serve = commands.add_parser("serve", help="serve over HTTP")
    serve.add_argument("--host", default="127.0.0.1", help="address to bind (%(default)s)")
    serve.add_argument("--port", default=8000, type=int, help="port to bind (%(default)s)")
    return parser


def _add_format(command: argparse.ArgumentParser, operation: str = "") -> None:
    more = PROGRAMS.get(operation, ())
    command.add_argument(
        "-o", "--output", metavar="FILE", type=Path, help="write the answer to this file, whole"
    )
    command.add_argument("--pretty", action="store_true", help="indent the JSON of the answer")
    programs = f"; {', '.join(more)}: {PROGRAM_HELP[operation]}" if more else ""
    command.add_argument(
        "--format",
        choices=("json", "table", "csv", *more, *((LOG_FORMAT,) if operation == "run" else ())),
        help="format of the answer, json if not given; if given, json also holds for errors"
        + programs
        + (f"; {LOG_FORMAT}: the log for MATLAB" if operation == "run" else ""),
    )
    if more:
        command.add_argument(
            "--real",
            choices=("LREAL", "REAL"),
            help=f"type of the numbers in {', '.join(IN_REAL)}, LREAL if not given",
        )


def _add_table(table: argparse.ArgumentParser) -> None:
    table.add_argument(
        "request", metavar="SPEC", help="the specification, .json or .toml; - reads JSON from stdin"
    )
    table.add_argument("-o", "--output", metavar="FILE", type=Path, help="the file to write")
    table.add_argument(
        "--format",
        choices=tuple(FORMATS),
        help="format of the file; by the end of its name if not given",
    )
    table.add_argument(
        "--workers",
        metavar="N",
        type=int,
        help="worker processes; one for each processor if not given",
    )
    table.add_argument(
        "--scheduler", metavar="ADDRESS", help="address of a Dask cluster to compute on"
    )
    table.add_argument(
        "--check",
        metavar="FILE",
        nargs="?",
        type=Path,
        const=Path(),
        help="compute anew and compare with FILE, or with that of -o, in place of writing it",
    )


def _table(options: argparse.Namespace) -> int:
    if options.check == Path():
        options.check = options.output
        if options.check is None:
            raise UsageError("--check takes a file, or that of -o")
    if options.check is None and options.output is None:
        raise UsageError("table needs -o FILE to write, or --check FILE")
    if options.workers is not None and not 1 <= options.workers <= MAX_WORKERS:
        raise UsageError(f"--workers must be between 1 and {MAX_WORKERS}, got {options.workers}")
    content, read = read_file(options.request)
    if options.check is None:
        require_file(options.output, read, "the specification itself")

    from service.compiled_code import keep_in  # noqa: PLC0415
    from service.jobs import executors  # noqa: PLC0415

    if "SHAPERSMITH_DATA_DIR" in os.environ:
        keep_in(os.environ["SHAPERSMITH_DATA_DIR"])
    if not options.scheduler:
        executors.prepare()
    from service.cli.table import CommandError, run_table  # noqa: PLC0415
    from service.problems import Problem  # noqa: PLC0415

    try:
        done = run_table(options, content)
    except CommandError as error:
        print(f"shapersmith: {error}", file=sys.stderr)  # noqa: T201
        return FAILED
    return _tell(done, options, as_json=False) if isinstance(done, Problem) else done


def _answer(options: argparse.Namespace) -> int:
    plot: Path | None = options.plot
    content, read = read_file(options.request)
    if plot is not None:
        require_picture(plot, read)
    if options.output is not None:
        require_file(options.output, read, "the request itself")
        if plot is not None and is_same_file(options.output, plot):
            raise UsageError(f"--output and --plot are both {plot}")

    # --help must not wait for it
    from service.cli.reading import ReadingError, read_request  # noqa: PLC0415
    from service.dispatch import respond  # noqa: PLC0415
    from service.problems import Problem  # noqa: PLC0415

    try:
        body = read_request(content, toml=options.request.lower().endswith(".toml"))
        if getattr(options, "play", None) is not None:
            from service.cli.played_file import with_played  # noqa: PLC0415

            body = with_played(body, options.play.name, read_file(str(options.play))[0])
    except ReadingError as error:
        return _tell(error.problem, options, as_json=options.format == "json")
    operation = COMMANDS[options.command]
    if options.format in PROGRAMS.get(operation, ()):
        if plot is not None:
            raise UsageError(f"--plot goes with json, table or csv, not with {options.format}")
        from service.cli.single_file import FILES  # noqa: PLC0415

        written = FILES[operation](body, options.format, options.real or "LREAL")
        if isinstance(written, Problem):
            return _tell(written, options, as_json=False)
        streams.warn(written.warnings)
        _write(written.content, options)
        return OK
    asked = {"trace": True} if getattr(options, "trace", False) else {}
    response = respond(operation, body, asked)
    if isinstance(response, Problem):
        return _tell(response, options, as_json=options.format == "json")
    if plot is not None:
        from design.pictures.files import figure_bytes  # noqa: PLC0415
        from service.files import write_whole  # noqa: PLC0415

        case = load(operation)
        request = case.request.model_validate_json(body).model_copy(update=asked)
        write_whole(plot, figure_bytes(case.draw(request), PICTURES[plot.suffix]))
    if options.format == LOG_FORMAT:
        from service.cli.run_log import as_mat  # noqa: PLC0415

        _write(as_mat(response), options)  # type: ignore[arg-type]
        return OK
    _print(response, options, body)  # type: ignore[arg-type]
    return OK


def _shapers(options: argparse.Namespace) -> int:
    if options.output is not None:
        require_file(options.output, None, "")
    from service.catalogue import shaper_catalogue  # noqa: PLC0415

    _print(shaper_catalogue(), options)
    return OK


def _print(response: "Response", options: argparse.Namespace, request: bytes = b"") -> None:
    if options.format in {None, "json"}:
        indent = 2 if options.pretty else None
        _write(response.model_dump_json(by_alias=True, indent=indent) + "\n", options)
        return
    from service.cli import rendering  # noqa: PLC0415 - it knows the answers of all commands

    if options.format == "table":
        _write(rendering.as_table(response, request), options)
    else:
        streams.warn(getattr(getattr(response, "recommended", response), "warnings", ()))
        _write(rendering.as_csv(response), options)


def _write(answer: str | bytes, options: argparse.Namespace) -> None:
    """Write an answer to the file that is asked for, whole or not at all, or to standard output.

    An archive is no text: on standard output its bytes stay as they are.
    """
    if options.output is not None:
        from service.files import write_whole  # noqa: PLC0415

        write_whole(options.output, answer if isinstance(answer, bytes) else answer.encode())
        return
    if isinstance(answer, bytes):
        sys.stdout.buffer.write(answer)
    else:
        sys.stdout.write(answer)
    sys.stdout.flush()


def _tell(problem: "Problem", options: argparse.Namespace, *, as_json: bool) -> int:
    file = (
        f"{options.request} " if problem.kind.name == "not-json" and options.request != "-" else ""
    )
    line = f"shapersmith: {problem.kind.name}: {file}{problem.detail}"
    if as_json:
        line = problem.document().model_dump_json(exclude_none=True)
    print(line, file=sys.stderr)  # noqa: T201
    return problem.kind.exit_status
