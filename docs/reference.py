"""Pages of the documentation that are made from the code when it is built."""

import argparse
import re
from collections.abc import Iterator

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

from schemas.catalogue import CatalogueEntry
from service.catalogue import shaper_catalogue
from service.cli.main import command_parser


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages; MkDocs calls it."""
    for name, text in (("kinds.md", _kinds()), ("commands.md", _commands())):
        files.append(File.generated(config, name, content=text))
    return files


def _kinds() -> str:
    pages = (_kind(entry) for entry in shaper_catalogue().shapers)
    return "\n\n".join(["# Kinds of shapers", *pages])


def _kind(entry: CatalogueEntry) -> str:
    rows = [
        f"| `{name}` | {_default(field)} | {_cell(field.get('description', ''))} |"
        for name, field in entry.parameters["properties"].items()
        if name != "kind"
    ]
    return "\n".join([
        f"## {entry.kind}",
        "",
        entry.summary,
        "",
        f"Claims: {', '.join(entry.claims) or 'a tolerance'}. "
        f"Actuators: {', '.join(entry.actuators)}. Modes: up to {entry.most_modes}.",
        "",
        "| parameter | if not given | is |",
        "|---|---|---|",
        *rows,
        "",
        f"Source: {entry.source}",
    ])


def _default(field: dict[str, object]) -> str:
    default = field.get("default")
    return "" if default is None else f"`{default}`"


def _cell(text: str) -> str:
    return re.sub(r"\s+", " ", text).replace("|", "\\|")


def _commands() -> str:
    return "\n\n".join(["# Command line", *_helps(command_parser())])


def _helps(parser: argparse.ArgumentParser) -> Iterator[str]:
    """Yield the help of a command and of those below it."""
    yield f"## {parser.prog}\n\n```\n{parser.format_help().rstrip()}\n```"
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                yield from _helps(command)
