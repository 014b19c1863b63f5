"""How tests read code."""

import ast
import gc
from pathlib import Path


def parsed(module: Path) -> ast.Module:
    """Return the syntax of a module.

    Where Python 3.11 collects garbage in the middle of it, whose finalizers may let other threads
    run or parse themselves, it fails: "AST constructor recursion depth mismatch".
    """
    gc.disable()
    try:
        return ast.parse(module.read_text())
    finally:
        gc.enable()
