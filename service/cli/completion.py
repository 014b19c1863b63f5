"""Completion of words in a shell."""

import argparse

import shtab

FILES = ("FILE", "REQUEST", "SPEC")
"""What the help calls arguments that are files."""

FOLDER = "FOLDER"
"""What it calls one that is a folder."""


def completion_of(parser: argparse.ArgumentParser, shell: str) -> str:
    """Return the script that completes the words of a command.

    Parameters
    ----------
    parser
        Of the command line; its arguments that are files are completed as such from then on.
    shell
        A shell that shtab knows.

    Returns
    -------
    str
        To be evaluated by that shell.
    """
    _name_files(parser)
    script: str = shtab.complete(parser, shell)
    return script


def _name_files(parser: argparse.ArgumentParser) -> None:
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                _name_files(command)
        elif action.metavar in FILES:
            action.complete = shtab.FILE  # type: ignore[attr-defined]
        elif action.metavar == FOLDER:
            action.complete = shtab.DIRECTORY  # type: ignore[attr-defined]
