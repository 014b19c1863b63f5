"""How a file of MATLAB's .mat, version 5, begins."""

HEADER_START = b"MATLAB 5.0 MAT-file"
HEADER_TEXT_BYTES = 116
"""Of the text that starts a file; SciPy writes the date into it."""


def header_text(tool: str) -> bytes:
    """Return the text that starts a file: the program in place of a date."""
    text = f"{HEADER_START.decode()}, {tool}".ljust(HEADER_TEXT_BYTES)[:HEADER_TEXT_BYTES]
    return text.encode("ascii", errors="replace")
