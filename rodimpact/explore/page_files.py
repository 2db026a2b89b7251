"""The files of the page: served one by one, or put together in one that opens from disk."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
from collections.abc import Mapping
from importlib import resources
from typing import Any

SCRIPTS = (
    "numbers.js", "pens.js", "contacts.js", "layout.js", "picture.js", "plots.js", "reading.js",
    "lesson.js", "tour.js", "film.js", "compare.js", "controls.js", "build.js",
    "server.js", "main.js",
)
KINDS = {"html": "text/html", "css": "text/css", "js": "text/javascript"}
SERVED = ("page.html", "page.css", *SCRIPTS)


def read(name: str) -> str:
    """Text of a file of the page."""
    return resources.files(__package__).joinpath("page", name).read_text(encoding="utf-8")


def kind_of(name: str) -> str:
    """Content type of a file of the page."""
    return f"{KINDS[name.rpartition('.')[2]]}; charset=utf-8"


def standalone(scene: Mapping[str, Any], design: Mapping[str, Any], title: str) -> str:
    """The page with a scene inside, in one file that asks nobody for anything.

    Parameters
    ----------
    scene : dict
        As `scene.scene` makes it.
    design : dict
        As `Design.to_dict` makes it.
    title : str
        Of the window.

    Returns
    -------
    str
        HTML.
    """
    style = read("page.css")
    script = "\n".join(read(name) for name in SCRIPTS)
    policy = "; ".join([
        "default-src 'none'", f"style-src {_digest(style)}", f"script-src {_digest(script)}",
        "img-src data: blob:", "base-uri 'none'", "form-action 'none'",
    ])
    data = json.dumps({"scene": scene, "design": design}, allow_nan=False, ensure_ascii=False)
    data = data.replace("<", "\\u003c")  # so that no text in it ends the element
    head = (
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        f"<style>{style}</style>"
    )
    tail = (
        f'<script type="application/json" id="embedded">{data}</script>\n'
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
