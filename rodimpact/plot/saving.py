"""Pictures to files: format by suffix, whole or not at all, the same bytes every time."""

from __future__ import annotations

import io
import os
import re
from typing import Any

from matplotlib import rc_context

from ..storage.writing import write_bytes
from .film import format_of
from .moving import Animation
from .style import FONT, figure_of

DOTS_PER_INCH = 200
FORMATS: dict[str, dict[str, Any]] = {
    "png": {"Software": None},
    "svg": {"Date": None},
    "pdf": {"CreationDate": None},
}


def save(picture: Any, path: str | os.PathLike[str], force: bool = False) -> None:
    """Write a figure as PNG, SVG or PDF, an animation as GIF, HTML or MP4, as the suffix says.

    The same picture gives the same bytes: nothing in the file depends on date or chance.

    Parameters
    ----------
    picture : Figure, Axes, Animation, or what a function of this package returned
    path : path
    force : bool
        Replace a file that is there.

    Raises
    ------
    ValueError
        For any other suffix, or if `picture` is none of these.
    FileExistsError
        If the file is there and `force` is false.

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
    if isinstance(picture, Animation):
        picture.save(path, force=force)
        return
    kind = format_of(path, FORMATS)
    figure = figure_of(picture)
    memory = io.BytesIO()
    about = FORMATS[kind]
    if kind == "svg":  # what a screen reader says of the picture
        labels = [(ax.get_ylabel(), ax.get_xlabel()) for ax in figure.axes[:1]]
        words = " over ".join(label for pair in labels for label in pair if label)
        about = {**about, "Title": " ".join((figure.get_suptitle() or words).split())}
    with rc_context({"svg.hashsalt": "rodimpact", "svg.fonttype": "none", "pdf.fonttype": 42}):
        figure.savefig(memory, format=kind, dpi=DOTS_PER_INCH, metadata=about)
    data = memory.getvalue()
    if kind == "svg":  # hundredths of a point are enough, and a font that is named once
        family = f"; font-family: '{FONT}'(?=[;\"])".encode()
        data = re.sub(rb"(?<=\.\d\d)\d+(?=[^<>]*>)|(?<=\n) +| (?=\n)|" + family, b"", data)
        data = data.replace(b"<svg ", f"<svg font-family=\"'{FONT}', sans-serif\" ".encode(), 1)
    write_bytes(path, data, force=force)
