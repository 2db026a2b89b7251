"""Pictures as the last line of a notebook's cell: each shows its figure."""

from __future__ import annotations

import io
from typing import Any, TypeVar

from matplotlib.figure import Figure

from ..model.frozen import refusal

DOTS_PER_INCH = 90
Kind = TypeVar("Kind", bound=type)


class Sheet(Figure):
    """A figure that a notebook shows, without any command before."""

    def _repr_png_(self) -> bytes:
        memory = io.BytesIO()
        self.savefig(memory, format="png", dpi=DOTS_PER_INCH, metadata={"Software": None})
        return memory.getvalue()


def picture(kind: Kind) -> Kind:
    """Class decorator: in a notebook such a picture shows its figure instead of its artists."""
    kind._repr_png_ = lambda drawn: Sheet._repr_png_(figure_of(drawn))  # type: ignore[attr-defined]
    return kind


def figure_of(drawn: Any) -> Any:
    """The figure of a picture, Axes or figure.

    Raises
    ------
    ValueError
        If it has none.
    """
    axes = getattr(drawn, "ax", getattr(drawn, "force_ax", drawn))
    figure = getattr(axes, "figure", axes)
    if not isinstance(figure, Figure):
        raise refusal("picture", f"must be a figure, axes or a picture of them, got {drawn!r}")
    return figure
