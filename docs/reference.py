"""What the documentation has from the code: pages that are made when it is built, and tables."""

import argparse
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from pydantic.fields import FieldInfo

from schemas.catalogue import CatalogueEntry
from service import problems
from service.catalogue import shaper_catalogue
from service.cli.main import command_parser
from service.http.app import create_app
from service.settings import IN_WORDS, PREFIX, Settings
from tests.errors_raised import codes


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages; MkDocs calls it."""
    pages = {"kinds.md": _kinds(), "commands.md": _commands(), "errors.md": _errors()}
    for name, text in pages.items():
        files.append(File.generated(config, name, content=text))
    return files


def with_tables(text: str) -> str:
    """Return a page with the tables in it that are made here, as the code has them now."""
    return PLACE.sub(lambda found: f"{found[1]}\n\n{TABLES[found[2]]()}\n\n{found[3]}", text)


def _routes() -> str:
    command_of = {
        found[1]: f"`shapersmith {name}`"
        for name, told in _commands_in_words(command_parser())
        if (found := re.search(r"\(((?:GET|POST) /\S+)\)", told))
    }
    rows = [
        (
            f"`{method.upper()} {path}`",
            command_of.get(f"{method.upper()} {path}", ""),
            told["summary"],
        )
        for path, methods in create_app(Settings()).openapi()["paths"].items()
        for method, told in methods.items()
    ]
    return _table(("route", "command", "does"), rows)


def _commands_in_words(parser: argparse.ArgumentParser) -> Iterator[tuple[str, str]]:
    """Yield each command with its help of one line."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for one in action._choices_actions:
                yield one.dest, one.help or ""


def _settings() -> str:
    rows = [
        (f"`{PREFIX}{name.upper()}`", _default_of(field), field.description)
        for name, field in Settings.model_fields.items()
    ]
    return _table(("variable", "default", "what"), rows)


def _default_of(field: FieldInfo) -> str:
    """Return the default of a setting in words; some depend on the machine."""
    if isinstance(field.json_schema_extra, dict) and IN_WORDS in field.json_schema_extra:
        return str(field.json_schema_extra[IN_WORDS])
    default = field.default
    return f"{default:,.0f}" if isinstance(default, int | float) else str(default)


def _kinds() -> str:
    pages = (_kind(entry) for entry in shaper_catalogue().shapers)
    return "\n\n".join(["# Kinds of shapers", *pages])


def _kind(entry: CatalogueEntry) -> str:
    rows = [
        (f"`{name}`", _default(field), field.get("description", ""))
        for name, field in entry.parameters["properties"].items()
        if name != "kind"
    ]
    return "\n\n".join([
        f"## {entry.kind}",
        entry.summary,
        f"Claims: {', '.join(entry.claims) or 'a tolerance'}. "
        f"Actuators: {', '.join(entry.actuators)}. Modes: up to {entry.most_modes}.",
        _table(("parameter", "if not given", "is"), rows),
        f"Source: {entry.source}",
    ])


def _default(field: dict[str, object]) -> str:
    default = field.get("default")
    return "" if default is None else f"`{default}`"


def _commands() -> str:
    return "\n\n".join(["# Command line", *_helps(command_parser())])


def _helps(parser: argparse.ArgumentParser) -> Iterator[str]:
    """Yield the help of a command and of those below it."""
    yield f"## {parser.prog}\n\n```\n{parser.format_help().rstrip()}\n```"
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                yield from _helps(command)


def _errors() -> str:
    kinds = [one for one in vars(problems).values() if isinstance(one, problems.ProblemKind)]
    types = [(f"`{one.name}`", one.http.value, one.exit_status, one.title) for one in kinds]
    name_of = {error.__name__: f"`{kind.name}`" for error, kind in problems.KIND_OF.items()}
    rows = [
        (f"`{code}`", name_of.get(found[0].error, ""), _words(found[0].words))
        for code, found in sorted(codes().items())
    ]
    return "\n\n".join([
        "# Errors",
        "An error has a type, by which a program decides what to do, and a code, which is one "
        "meaning. `urn:shapersmith:` and the name below are the type.",
        "## Types",
        _table(("type", "HTTP status", "exit status", "means"), types),
        "## Codes",
        "A message of `invalid-input` names the field, says that it must be what stands here, and "
        "repeats the value. Where a value stands in the words, the table has `…`. Codes of fields "
        "that any request may have at fault, as `missing` and `wrong_type`, are not listed.",
        _table(("code", "type", "says"), rows),
    ])


def _words(template: str) -> str:
    """Return the words of a message; those that are made elsewhere are a gap."""
    return template.replace("{}", "…") if " " in template else "…"


def _table(head: tuple[str, ...], rows: Sequence[tuple[object, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join(f"| {' | '.join(map(_cell, line))} |" for line in lines)


def _cell(value: object) -> str:
    return re.sub(r"\s+", " ", str(value)).replace("|", "\\|")


TABLES = {"routes": _routes, "settings": _settings}
"""Tables within pages that are otherwise written by hand."""

PLACE = re.compile(
    rf"(<!-- made from the code: ({'|'.join(TABLES)}) -->).*?(<!-- end -->)", re.DOTALL
)
"""Where one stands; `python -m docs.reference` writes it anew."""

PAGES = [Path(__file__).with_name(f"{name}.md") for name in TABLES]

if __name__ == "__main__":
    for made in PAGES:
        made.write_text(with_tables(made.read_text()))
