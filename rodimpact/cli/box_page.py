"""The page that shows what `rodimpact box` tells and draws: one file beside its figures."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING

from ..storage.tables import as_html

if TYPE_CHECKING:
    from ..plot.style import Colours

STYLE = """\
body { max-width: 64rem; margin: 2rem auto; padding: 0 1rem; font: 1rem/1.5 sans-serif;
       background: %s; color: %s; }
figure { margin: 1.5rem 0; }
img { max-width: 100%%; }
a { color: inherit; }
"""


def box_page(parts: Sequence[tuple[str, list[str]]], colours: Colours) -> str:
    """Write the page.

    Parameters
    ----------
    parts : sequence of (str, list of str)
        Text, whose first line is a heading, and names of figures, which lie beside the page.
    colours : Colours
        Of paper and letters.

    Returns
    -------
    str
        HTML.
    """
    titles = [escape(text.partition("\n")[0]) for text, _ in parts]
    lines = [
        '<!doctype html>', '<html lang="en">', '<meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{titles[0]}</title>", f"<style>\n{STYLE % colours[:2]}</style>",
    ]
    for level, title, (text, figures) in zip("1" + "2" * len(parts), titles, parts, strict=False):
        lines += [f"<h{level}>{title}</h{level}>", as_html(text.partition("\n")[2].strip("\n"))]
        lines += [_figure(name, f"{title}: {name.rpartition('.')[0]}") for name in figures]
    return "\n".join([*lines, "</html>", ""])


def _figure(name: str, words: str) -> str:
    """A figure, or a link to one that no page shows."""
    shown = name if name.endswith(".pdf") else f'<img src="{name}" alt="{words}">'
    return f'<figure><a href="{name}">{shown}</a></figure>'
