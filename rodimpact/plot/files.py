"""Pictures and films as files: the suffix gives the format; a file is complete or not written.

Matplotlib's own writers of films draw every frame anew through `savefig` and keep it whole: of 120
frames the GIF takes 8 times as long, the MP4 4 times.
"""

import base64
import contextlib
import html
import io
import os
import re
import shutil
import subprocess
from collections.abc import Collection
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from matplotlib import rc_context
from PIL import Image

from ..model.frozen import refusal
from ..progress import Report, no_report
from ..storage.writing import file_name, write_bytes
from .style import FONT, figure_of

DOTS_PER_INCH = 200
FORMATS: dict[str, dict[str, Any]] = {
    "png": {"Software": None},
    "svg": {"Date": None},
    "pdf": {"CreationDate": None},
}
LAST_FRAME = 1500  # ms that the last frame of a GIF stays, before it begins again
SHADES = 255  # colours of a GIF, those of its last frame
ALIKE = (
    9  # of 255: shades that are no nearer to the paper than this are not taken for it
)


def save(picture: Any, path: str | os.PathLike[str], force: bool = False) -> None:
    """Write a figure as PNG, SVG or PDF, an animation as GIF or MP4, as the suffix says.

    The same picture gives the same bytes: nothing in the file depends on date or chance.

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
    if hasattr(picture, "frames"):  # of an Animation
        picture.save(path, force=force)
        return
    kind = format_of(path, FORMATS)
    figure = figure_of(picture)
    memory = io.BytesIO()
    about = FORMATS[kind]
    if kind == "svg":  # what a screen reader says of the picture
        words = [
            word
            for ax in figure.axes[:1]
            for word in (ax.get_ylabel(), ax.get_xlabel())
        ]
        title = figure.get_suptitle() or " over ".join(filter(None, words))
        about = {**about, "Title": " ".join(title.split())}
    with rc_context(
        {"svg.hashsalt": "rodimpact", "svg.fonttype": "none", "pdf.fonttype": 42}
    ):
        figure.savefig(memory, format=kind, dpi=DOTS_PER_INCH, metadata=about)
    data = memory.getvalue()
    if kind == "svg":  # hundredths of a point are enough, and a font that is named once
        family = f"; font-family: '{FONT}'(?=[;\"])".encode()
        data = re.sub(
            rb"(?<=\.\d\d)\d+(?=[^<>]*>)|(?<=\n) +| (?=\n)|" + family, b"", data
        )
        data = data.replace(
            b"<svg ", f"<svg font-family=\"'{FONT}', sans-serif\" ".encode(), 1
        )
    write_bytes(path, data, force=force)


def format_of(path: str | os.PathLike[str], known: Collection[str]) -> str:
    """The one of the formats that the suffix of a path names; ValueError if it names none."""
    path = file_name(path)
    kind = Path(path).suffix.lower().removeprefix(".")
    if kind not in known:
        suffixes = ", ".join(f".{name}" for name in known)
        raise refusal("path", f"must end in one of {suffixes}, got {path!r}")
    return kind


def check_film(path: str | os.PathLike[str]) -> str:
    """Kind of film that a path names.

    Raises
    ------
    ValueError
        If it names none.
    OSError
        If it names an MP4, and there is no ffmpeg to make it.
    """
    kind = format_of(path, WRITERS)
    if kind == "mp4" and shutil.which("ffmpeg") is None:
        raise OSError(
            f"cannot write {os.fspath(path)!r}: the program ffmpeg, which makes MP4 files, is not "
            "on the path; install it, or write a .gif"
        )
    return kind


def as_image(data: bytes, kind: str, words: str) -> str:
    """A picture as HTML that needs no file."""
    code = base64.b64encode(data).decode()
    return (
        f'<img src="data:image/{kind};base64,{code}" alt="{html.escape(words)}" '
        'style="max-width: 100%">'
    )


def write_gif(file: BinaryIO, film: Any, report: Report = no_report) -> None:
    """Write the frames of an Animation, in the colours of the last one, which shows all of it."""
    last = Image.fromarray(film.frame(len(film) - 1))
    palette: Any = last.quantize(SHADES)
    shades, paper = np.reshape(palette.getpalette(), (-1, 3)), last.getpixel((0, 0))
    shades[np.abs(shades - paper).max(axis=1) < ALIKE] = paper
    palette.putpalette(shades.ravel().tolist())
    pictures = (
        Image.fromarray(frame).quantize(palette=palette, dither=Image.Dither.NONE)
        for frame in film.frames(report)
    )
    each = 10 * max(2, round(100 / film.fps))
    durations = [each] * len(film)
    durations[-1] += LAST_FRAME
    next(pictures).save(
        file,
        format="GIF",
        save_all=True,
        append_images=pictures,
        loop=0,
        duration=durations,
    )


def _write_mp4(file: BinaryIO, film: Any, report: Report) -> None:
    height, width, _ = film.frame(0).shape
    command = [
        "ffmpeg",
        "-loglevel",
        "error",
        "-f",
        "rawvideo",
        "-pix_fmt",
        "rgb24",
        "-s",
        f"{width}x{height}",
        "-r",
        f"{film.fps:g}",
        "-i",
        "-",
        "-vf",
        "pad=ceil(iw/2)*2:ceil(ih/2)*2",  # the format takes even numbers of pixels
        "-pix_fmt",
        "yuv420p",
        "-movflags",
        "+faststart",
        "-f",
        "mp4",
        "-y",
        file.name,
    ]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        assert process.stdin is not None
        with contextlib.suppress(BrokenPipeError):  # the errors tell why
            for picture in film.frames(report):
                process.stdin.write(picture.tobytes())
        reason = process.communicate()[1].decode(errors="replace").strip()
    if process.returncode:
        raise OSError(f"ffmpeg failed: {reason or f'status {process.returncode}'}")


WRITERS = {"gif": write_gif, "mp4": _write_mp4}
