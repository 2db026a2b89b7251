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
GIF_COLOURS = 255  # number of colours of a GIF, which are taken from the last frame
PAPER_TOLERANCE = 9  # of 255, in red, green or blue: nearer colours become the paper's
MIN_HUNDREDTHS = 2  # hundredths of a second; browsers show faster pictures slowly


def check_film(path: str | os.PathLike[str]) -> str:
    """Kind of film that the suffix of a path names: "gif" or "mp4", without a dot.

    Raises
    ------
    ValueError
        If the suffix names neither.
    OSError
        If it names an MP4, and the program ffmpeg is not installed.
    """
    kind = format_of(path, WRITERS)
    if kind == "mp4" and shutil.which("ffmpeg") is None:
        raise OSError(
            f"cannot write {os.fspath(path)!r}: the program ffmpeg, which makes MP4 "
            "files, is not on the path; install it, or write a .gif"
        )
    return kind


def write_gif(file: BinaryIO, film: Any, report: ProgressReport = no_report) -> None:
    """Write the frames of an Animation as a GIF that repeats for ever.

    All frames have the colours of the last one. Each stays for a whole number of
    hundredths of a second, at least `MIN_HUNDREDTHS`, the last one `LAST_FRAME_MS`
    longer. `report` is called after each frame.
    """
    last = film.frame(len(film) - 1)
    palette = _palette(Image.fromarray(last))
    pictures = (
        Image.fromarray(frame).quantize(palette=palette, dither=Image.Dither.NONE)
        for frame in film.frames(report)
    )
    # The unit of time of a GIF is a hundredth of a second.
    hundredths = max(MIN_HUNDREDTHS, round(100 / film.fps))
    durations = [10 * hundredths] * len(film)  # ms
    durations[-1] += LAST_FRAME_MS
    first = next(pictures)
    first.save(
        file,
        format="GIF",
        save_all=True,
        append_images=pictures,  # the frames after the first, drawn one at a time
        loop=0,  # for ever
        duration=durations,
    )


def _palette(last: Image.Image) -> Any:
    """Picture whose palette has `GIF_COLOURS` colours of the last frame.

    Colours that hardly differ from the paper become that of the paper, so that it has
    no specks.
    """
    palette: Any = last.quantize(GIF_COLOURS)
    paper = last.getpixel((0, 0))  # no panel reaches into the corner
    rgb = np.reshape(palette.getpalette(), (-1, 3))  # [colour, red, green or blue]
    difference = np.abs(rgb - paper).max(axis=1)
    rgb[difference < PAPER_TOLERANCE] = paper
    palette.putpalette(rgb.ravel().tolist())
    return palette


def _write_mp4(file: BinaryIO, film: Any, report: ProgressReport) -> None:
    """Write the frames of an Animation as an MP4, by the program ffmpeg.

    The program takes raw pixels from a pipe, and replaces the file of this name.
    `report` is called after each frame. OSError is raised with the words of ffmpeg if
    it fails.
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
        # If ffmpeg ends early, its errors below tell why.
        with contextlib.suppress(BrokenPipeError):
            for picture in film.frames(report):
                process.stdin.write(picture.tobytes())
        _, errors = process.communicate()
    if process.returncode:
        reason = errors.decode(errors="replace").strip()
        if not reason:
            reason = f"status {process.returncode}"
        raise OSError(f"ffmpeg failed: {reason}")


WRITERS = {"gif": write_gif, "mp4": _write_mp4}
