"""Figures as files: the suffix gives the format; a file is complete or not written."""

import base64
import html
import io
import os
import re
from collections.abc import Collection
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.figure import Figure

from ..hints import explain_arguments
from ..model.frozen import invalid_argument
from ..storage.writing import file_name, write_bytes
from ..units import shown_path
from .panels import figure_of
from .style import FONT

DOTS_PER_INCH = 200
FORMATS: dict[str, dict[str, Any]] = {
    "png": {"Software": None},
    "svg": {"Date": None},
    "pdf": {"CreationDate": None},
}
"""Formats, with metadata that must not be written: they change from file to file."""
REPRODUCIBLE: Any = {
    "svg.hashsalt": "rodimpact",
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
}
"""Settings with which the same picture gives the same bytes."""
LONG_DECIMALS = rb"(?<=\.\d\d)\d+(?=[^<>]*>)"  # decimals beyond two, in an SVG
OUTER_SPACES = rb"(?<=\n) +| (?=\n)"  # at the beginnings and ends of lines


@explain_arguments
def save(picture: Any, path: str | os.PathLike[str], force: bool = False) -> None:
    """Write a figure as PNG, SVG or PDF, an animation as GIF or MP4, by the suffix.

    The same picture gives the same bytes: nothing in the file depends on date or
    chance.

    Parameters
    ----------
    picture : Figure, Axes, Animation, or what a function of this package returned
    path : path
    force : bool
        Replace an existing file.

    Raises
    ------
    ValueError
        For any other suffix, or if `picture` is none of these.
    FileExistsError
        If the file exists and `force` is false.

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> import os, tempfile
    >>> picture = ri.plot.energy(ri.solve(ri.System([rod, ri.Wall()])))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     ri.plot.save(picture, os.path.join(folder, "energy.svg"))
    ...     os.listdir(folder)
    ['energy.svg']
    """
    if hasattr(picture, "frames"):  # an Animation
        picture.save(path, force=force)
        return
    kind = format_of(path, FORMATS)
    figure = figure_of(picture)
    about = dict(FORMATS[kind])
    if kind == "svg":
        about["Title"] = _title(figure)
    memory = io.BytesIO()
    with rc_context(REPRODUCIBLE):
        figure.savefig(memory, format=kind, dpi=DOTS_PER_INCH, metadata=about)
    data = memory.getvalue()
    if kind == "svg":
        data = _smaller_svg(data)
    write_bytes(path, data, force=force)


def _title(figure: Figure) -> str:
    """Title of a figure in one line; without a title, "y over x" from axis labels.

    The labels are those of the first Axes; "" if there are none.
    """
    title = figure.get_suptitle()
    if not title and figure.axes:
        ax = figure.axes[0]
        labels = [label for label in (ax.get_ylabel(), ax.get_xlabel()) if label]
        title = " over ".join(labels)
    return " ".join(title.split())


def _smaller_svg(data: bytes) -> bytes:
    """A shorter SVG that shows the same.

    Numbers have two decimals, lines no spaces at their ends, and the font is named once
    for the whole picture.
    """
    family = f"; font-family: '{FONT}'(?=[;\"])".encode()  # in the style of each text
    data = re.sub(LONG_DECIMALS + b"|" + OUTER_SPACES + b"|" + family, b"", data)
    head = f"<svg font-family=\"'{FONT}', sans-serif\" ".encode()
    return data.replace(b"<svg ", head, 1)


def format_of(path: str | os.PathLike[str], formats: Collection[str]) -> str:
    """The suffix of a path without its dot, in small letters.

    ValueError is raised if it is none of `formats`.
    """
    path = file_name(path)
    kind = Path(path).suffix.lower().removeprefix(".")
    if kind not in formats:
        suffixes = ", ".join(f".{name}" for name in formats)
        raise invalid_argument(
            "path", f"must end in one of {suffixes}, got {shown_path(path)}"
        )
    return kind


def as_image(data: bytes, kind: str, description: str) -> str:
    """HTML of a picture with its data in the text, so that it needs no file.

    `kind` is its format, such as "png", `description` a text for screen readers.
    """
    code = base64.b64encode(data).decode()
    return (
        f'<img src="data:image/{kind};base64,{code}" alt="{html.escape(description)}" '
        'style="max-width: 100%">'
    )
