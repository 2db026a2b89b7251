"""Films as files: GIF, and MP4 by the program ffmpeg.

Matplotlib's own writers of films draw every frame anew through `savefig` and keep it
whole: of 120 frames the GIF takes 8 times as long, the MP4 4 times.
"""

import contextlib
import os
import shutil
import subprocess
from typing import Any, BinaryIO

import numpy as np
from PIL import Image

from ..progress import ProgressReport, no_report
from .files import format_of

LAST_FRAME_MS = 1500  # time for which a GIF stops before it begins again
GIF_COLOURS = 255  # those of its last frame
PAPER_TOLERANCE = 9  # shades, of 255: nearer ones are taken for the paper


def check_film(path: str | os.PathLike[str]) -> str:
    """Kind of film that a path names, a key of `WRITERS`.

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
            f"cannot write {os.fspath(path)!r}: the program ffmpeg, which makes MP4 "
            "files, is not on the path; install it, or write a .gif"
        )
    return kind


def write_gif(file: BinaryIO, film: Any, report: ProgressReport = no_report) -> None:
    """Write the frames of an Animation, in the colours of the last one."""
    last = film.frame(len(film) - 1)
    palette = _palette(Image.fromarray(last))
    pictures = (
        Image.fromarray(frame).quantize(palette=palette, dither=Image.Dither.NONE)
        for frame in film.frames(report)
    )
    hundredths = max(2, round(100 / film.fps))  # the unit of time of a GIF
    durations = [10 * hundredths] * len(film)  # ms
    durations[-1] += LAST_FRAME_MS
    next(pictures).save(
        file,
        format="GIF",
        save_all=True,
        append_images=pictures,
        loop=0,
        duration=durations,
    )


def _palette(last: Image.Image) -> Any:
    """Picture with the colours of the last frame, all near to the paper the paper's."""
    palette: Any = last.quantize(GIF_COLOURS)
    paper = last.getpixel((0, 0))  # no panel reaches into the corner
    shades = np.reshape(palette.getpalette(), (-1, 3))
    difference = np.abs(shades - paper).max(axis=1)
    shades[difference < PAPER_TOLERANCE] = paper
    palette.putpalette(shades.ravel().tolist())
    return palette


def _write_mp4(file: BinaryIO, film: Any, report: ProgressReport) -> None:
    """Let ffmpeg write the frames of an Animation, raw pixels, to this file's name.

    OSError is raised with the words of ffmpeg if it fails.
    """
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
        _, errors = process.communicate()
    if process.returncode:
        reason = errors.decode(errors="replace").strip()
        if not reason:
            reason = f"status {process.returncode}"
        raise OSError(f"ffmpeg failed: {reason}")


WRITERS = {"gif": write_gif, "mp4": _write_mp4}
