"""Files of the page, put together in one file that opens from disk."""

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
    "elements.js",
    "fields.js",
    "solver.js",
    "curves.js",
    "toml.js",
    "pens.js",
    "colours.js",
    "axes.js",
    "layout.js",
    "cuts.js",
    "centres.js",
    "grids.js",
    "diagram.js",
    "rods.js",
    "plots.js",
    "reading.js",
    "events.js",
    "guess.js",
    "tour.js",
    "film.js",
    "compare.js",
    "row.js",
    "undo.js",
    "form.js",
    "map.js",
    "dragging.js",
    "handles.js",
    "results.js",
    "files.js",
    "address.js",
    "main.js",
)
"""Scripts of the page, in the order of their use."""
LOADER = "loader.js"
"""Script that unpacks the others."""
LETTER_IN_PLACE = str.maketrans("<", ",")
"""Replacement of a letter of base 85: < may look like the end of the text's element."""


def read(name: str) -> str:
    """Text of a file of the page; "kernels.js" is translated from Python.

    "kernels.js" is the script of the solver, without line ends where none are needed.
    """
    if name == "kernels.js":
        return compact(script())
    file = resources.files(__package__).joinpath("page", name)
    return file.read_text(encoding="utf-8")


def lean(text: str) -> str:
    """The text of a file of the page without indentation and comments.

    A comment behind code stays if it has a quotation mark: // may then be part of a
    text in the code.
    """
    line_comment = r"\s*//.*\n"
    block_comment = r"\s*/\*\*(.|\n)*?\*/\n"
    # The last alternative, because comments may be indented
    indentation = r"\s+"
    left_out = f"^({line_comment}|{block_comment}|{indentation})"
    text = re.sub(left_out, "", text, flags=re.MULTILINE)
    comment_behind_code = r"[ \t]+// [^\"'`\n]*$"
    return re.sub(comment_behind_code, "", text, flags=re.MULTILINE)


def compact(text: str) -> str:
    """A style or translated script without line ends after ; { } and commas.

    Semicolons before } are left out, too. Scripts that people write are not shortened
    like this: a comment that `lean` left would hide the next line.
    """
    return re.sub(r"(?<=[;{},])\n", "", lean(text)).replace(";}", "}")


def standalone(embedded: Mapping[str, Any], title: str) -> str:
    """The page in one file, which asks no network for anything.

    The text of ``page.html`` gets the style, the data, the compressed scripts and the
    loader that unpacks them. A content security policy forbids all other scripts.

    Parameters
    ----------
    embedded : dict
        Data with which the page begins.
    title : str
        Title of the window.

    Returns
    -------
    str
        HTML.
    """
    style = compact(read("page.css"))
    style = style.replace(": ", ":").replace(" {", "{")
    loader = lean(read(LOADER))
    script = lean("\n".join(map(read, SCRIPTS)))
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
    data = data.replace("<", "\\u003c")  # </script> in a text would end the element
    head = (
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        f"<style>{style}</style>"
    )
    tail = (
        f'<script type="application/json" id="embedded">{data}</script>\n'
        f'<script type="text/plain" id="packed">{packed(script)}</script>\n'
        f"<script>{loader}</script>"
    )
    page = lean(read("page.html")).replace(
        "<title>rodimpact<", f"<title>{html.escape(title)}<"
    )
    page = page.replace('<link rel="stylesheet" href="page.css">', head)
    return page.replace("</body>", f"{tail}\n</body>")


def packed(text: str) -> str:
    """A text compressed and written in base 85, which is shorter than base 64.

    A comma stands for the letter "<".
    """
    letters = base64.b85encode(zlib.compress(text.encode(), 9)).decode()
    return letters.translate(LETTER_IN_PLACE)


def _digest(text: str) -> str:
    """Source of a script or style with this text in a content security policy.

    It is its SHA-256 in base 64: 'sha256-...', in quotation marks.
    """
    digest = hashlib.sha256(text.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"
