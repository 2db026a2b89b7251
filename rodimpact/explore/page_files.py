"""The files of the page: served one by one, or put together in one that opens from disk."""

from __future__ import annotations

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
    "numbers.js", "python.js", "kernels.js", "solver.js", "pens.js", "contacts.js", "layout.js",
    "picture.js", "strip.js", "plots.js", "reading.js", "lesson.js", "tour.js", "film.js",
    "compare.js", "controls.js", "map.js", "build.js", "server.js", "main.js",
)
PACKED = ("python.js", "kernels.js")  # in one file they are compressed, or left out
KINDS = {"html": "text/html", "css": "text/css", "js": "text/javascript"}
SERVED = ("page.html", "page.css", *SCRIPTS)


def read(name: str) -> str:
    """Text of a file of the page; the kernels are translated as they are now."""
    if name == "kernels.js":
        return script()
    text = resources.files(__package__).joinpath("page", name).read_text(encoding="utf-8")
    tags = "\n".join(f'<script src="{file}" defer></script>' for file in SCRIPTS)
    return text.replace("<!-- scripts -->", tags) if name == "page.html" else text


def lean(text: str) -> str:
    """A script or a style without indentation, and without comments on lines of their own."""
    return re.sub(r"^(\s+|\s*//.*\n|\s*/\*\*(.|\n)*?\*/\n)", "", text, flags=re.MULTILINE)


def kind_of(name: str) -> str:
    """Content type of a file of the page."""
    return f"{KINDS[name.rpartition('.')[2]]}; charset=utf-8"


def standalone(embedded: Mapping[str, Any], title: str) -> str:
    """The page with all that it needs inside, in one file that asks nobody for anything.

    Parameters
    ----------
    embedded : dict
        With ``scene`` and ``design``, to be looked at; or with ``start``, to be played with.
    title : str
        Of the window.

    Returns
    -------
    str
        HTML.
    """
    style = lean(read("page.css"))
    script = lean("\n".join(read(name) for name in SCRIPTS if name not in PACKED))
    kernels = lean("\n".join(map(read, PACKED))) if "start" in embedded else ""
    packed = base64.b64encode(zlib.compress(kernels.encode(), 9)).decode()
    policy = "; ".join([
        "default-src 'none'", f"style-src {_digest(style)}",
        f"script-src {_digest(script)} {_digest(kernels)}",
        "img-src data: blob:", "base-uri 'none'", "form-action 'none'",
    ])
    data = json.dumps(embedded, allow_nan=False, ensure_ascii=False, separators=(",", ":"))
    data = data.replace("<", "\\u003c")  # so that no text in it ends the element
    head = (
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        f"<style>{style}</style>"
    )
    tail = (
        f'<script type="application/json" id="embedded">{data}</script>\n'
        f'<script type="text/plain" id="packed">{packed}</script>\n'
        f"<script>{script}</script>"
    )
    page = read("page.html")
    for pattern, text in (
        (r"<title>.*</title>", f"<title>{html.escape(title)}</title>"),
        (r'<link rel="stylesheet" href="page.css">', head),
        (r'<script src="[a-z]+\.js" defer></script>\n', ""),
        (r"</body>", f"{tail}\n</body>"),
    ):
        page = re.sub(pattern, lambda _, text=text: text, page)  # type: ignore[misc]
    return page


def _digest(text: str) -> str:
    """What a policy calls a script or style of this text."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
