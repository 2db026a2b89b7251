"""HTML that a notebook shows for a result.

`rodimpact` sets the function that makes it: results themselves must not import plots.
"""

from collections.abc import Callable
from typing import Any


def as_table(result: Any) -> str:
    """HTML of the table that a result prints."""
    from ..storage.tables import as_html

    return as_html(str(result))


html: Callable[[Any], str] = as_table
"""Draws the HTML of a result: a table, unless the package sets pictures for it."""


class Shown:
    """A result that a notebook shows."""

    def _repr_html_(self) -> str:
        return html(self)
