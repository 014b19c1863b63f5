"""A figure as the bytes of a file."""

import html
import io
from typing import Literal

from matplotlib.figure import Figure

from design.pictures.style import house_style

PAGE = """<!doctype html>
<html lang="en">
<head><meta charset="utf-8"><title>{title}</title>
<style>svg {{ display: block; margin: auto; max-width: 100%; height: auto }}</style></head>
<body>
{picture}
</body>
</html>
"""
"""A page that needs no other file and no server."""


def figure_bytes(figure: Figure, image_format: Literal["png", "svg", "html"]) -> bytes:
    """Return a figure as a file's bytes, the same ones every time.

    Parameters
    ----------
    figure
        A figure of this package.
    image_format
        ``png``, 150 dots per inch, ``svg``, with text as outlines, or ``html``, a page that holds
        such an ``svg``.

    Returns
    -------
    bytes
        Without a date or version in them.
    """
    drawn = "png" if image_format == "png" else "svg"
    # Neither the time nor the version of the program belongs in the file.
    metadata = {"Date": None} if drawn == "svg" else {"Software": None}
    buffer = io.BytesIO()
    with house_style():
        figure.savefig(buffer, format=drawn, metadata=metadata)
    if image_format != "html":
        return buffer.getvalue()
    svg = buffer.getvalue().decode()
    words = [text.get_text() for text in figure.texts if text.get_text()]
    title = html.escape(figure.get_suptitle() or " ".join(words[:1]))
    return PAGE.format(title=title, picture=svg[svg.index("<svg") :]).encode()
