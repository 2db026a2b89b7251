"""Frames to files: GIF or MP4.

Matplotlib's own writers draw every frame anew through `savefig` and keep it whole: of 120 frames
the GIF takes 8 times as long, the MP4 4 times.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from PIL import Image

from ..model.frozen import refusal
from ..storage.writing import file_name

SHADES = 255  # colours of a GIF, those of its last frame
ALIKE = 9  # of 255: shades that are no nearer to the paper than this are not taken for it
Progress = Callable[[int, int], Any] | None


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


def write_gif(file: BinaryIO, film: Any, progress: Progress) -> None:
    """Write the frames of an Animation, in the colours of the last one."""
    pictures = _few_colours(film, progress)
    next(pictures).save(file, format="GIF", save_all=True, append_images=pictures, loop=0,
                        duration=10 * max(2, round(100 / film.fps)))


def _write_mp4(file: BinaryIO, film: Any, progress: Progress) -> None:
    height, width, _ = film.frame(0).shape
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryFile() as errors:
        target = Path(folder) / "film.mp4"
        command = [
            "ffmpeg", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24",
            "-s", f"{width}x{height}", "-r", f"{film.fps:g}", "-i", "-",
            "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2",  # the format takes even numbers of pixels
            "-pix_fmt", "yuv420p", "-movflags", "+faststart", str(target),
        ]
        with (
            contextlib.suppress(BrokenPipeError),  # the errors tell why
            subprocess.Popen(command, stdin=subprocess.PIPE, stderr=errors) as process,
        ):
            assert process.stdin is not None
            try:
                for picture in film.frames(progress):
                    process.stdin.write(picture.tobytes())
            except KeyboardInterrupt:
                process.kill()
                raise
        errors.seek(0)
        reason = errors.read().decode(errors="replace").strip()
        if process.returncode or not target.exists():
            raise OSError(f"ffmpeg failed: {reason or f'status {process.returncode}'}")
        file.write(target.read_bytes())


def _few_colours(film: Any, progress: Progress) -> Any:
    """Frames with the colours of the last one, in which everything is seen."""
    last = Image.fromarray(film.frame(len(film) - 1))
    palette: Any = last.quantize(SHADES)
    shades, paper = np.reshape(palette.getpalette(), (-1, 3)), last.getpixel((0, 0))
    shades[np.abs(shades - paper).max(axis=1) < ALIKE] = paper
    palette.putpalette(shades.ravel().tolist())
    for picture in film.frames(progress):
        yield Image.fromarray(picture).quantize(palette=palette, dither=Image.Dither.NONE)


WRITERS = {"gif": write_gif, "mp4": _write_mp4}
