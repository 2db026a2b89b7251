"""The files of the page, put together in one that opens from disk."""

import base64
import hashlib
import html
import json
import re
import zlib
from collections.abc import Mapping
from importlib import resources
from typing import Any

from .solver import script

SCRIPTS = (
    "numbers.js",
    "python.js",
    "kernels.js",
    "solver.js",
    "pens.js",
    "layout.js",
    "picture.js",
    "strip.js",
    "plots.js",
    "reading.js",
    "lesson.js",
    "tour.js",
    "film.js",
    "compare.js",
    "controls.js",
    "map.js",
    "build.js",
    "handles.js",
    "address.js",
    "main.js",
)
LOADER = "loader.js"  # unpacks the others


def read(name: str) -> str:
    """Text of a file of the page; the kernels are translated as they are now."""
    if name == "kernels.js":
        return script()
    return (
        resources.files(__package__).joinpath("page", name).read_text(encoding="utf-8")
    )


def lean(text: str) -> str:
    """A script or a style without indentation, and without comments on lines of their own."""
    return re.sub(
        r"^(\s+|\s*//.*\n|\s*/\*\*(.|\n)*?\*/\n)", "", text, flags=re.MULTILINE
    )


def standalone(embedded: Mapping[str, Any], title: str) -> str:
    """The page with all that it needs inside, in one file that asks nobody for anything.

    Parameters
    ----------
    embedded : dict
        What the page begins with.
    title : str
        Of the window.

    Returns
    -------
    str
        HTML.
    """
    style = lean(read("page.css"))
    loader, script = lean(read(LOADER)), lean("\n".join(map(read, SCRIPTS)))
    policy = "; ".join(
        [
            "default-src 'none'",
            f"style-src {_digest(style)}",
            f"script-src {_digest(loader)} {_digest(script)}",
            "img-src data: blob:",
            "base-uri 'none'",
            "form-action 'none'",
        ]
    )
    data = json.dumps(
        embedded, allow_nan=False, ensure_ascii=False, separators=(",", ":")
    )
    data = data.replace("<", "\\u003c")  # so that no text in it ends the element
    head = (
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        f"<style>{style}</style>"
    )
    tail = (
        f'<script type="application/json" id="embedded">{data}</script>\n'
        f'<script type="text/plain" id="packed">{packed(script)}</script>\n'
        f"<script>{loader}</script>"
    )
    page = read("page.html").replace(
        "<title>rodimpact<", f"<title>{html.escape(title)}<"
    )
    page = page.replace('<link rel="stylesheet" href="page.css">', head)
    return page.replace("</body>", f"{tail}\n</body>")


def packed(text: str) -> str:
    """A text compressed, as letters."""
    return base64.b64encode(zlib.compress(text.encode(), 9)).decode()


def _digest(text: str) -> str:
    """What a policy calls a script or style of this text."""
    return (
        f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
    )
