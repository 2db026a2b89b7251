"""A sweep on disk: result columns as NPY files, and which chunks of them are done.

A chunk counts as done only when its numbers are on the disk, so a process may be killed at any
moment; the next one goes on with what is missing. Every column is an ordinary NPY file.
"""

from __future__ import annotations

import contextlib
import json
import os
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .reading import FileFormatError
from .writing import PathLike, write_text

HEAD = "sweep.json"
SYNC_EVERY = 1.0  # s; at most so much work is done again after a crash


class Checkpoint:
    """Columns of results in a directory.

    Parameters
    ----------
    path : str or path
        Directory; made if there is none, gone on with if it holds the same sweep.
    sweep : mapping
        What makes it the same sweep, JSON-ready.
    columns : mapping of str to (dtype, shape)
    chunks : int

    Attributes
    ----------
    done : array of bool, [chunks]

    Raises
    ------
    FileFormatError
        If the directory holds something else: another sweep, or foreign files.
    OSError
        If it cannot be read or written.
    """

    def __init__(
        self, path: PathLike, sweep: Mapping[str, Any],
        columns: Mapping[str, tuple[Any, tuple[int, ...]]], chunks: int,
    ) -> None:
        self.path, self._columns, self._waiting = Path(path), columns, list[int]()
        self._synced = time.monotonic()
        self.path.mkdir(parents=True, exist_ok=True)
        head = self.path / HEAD
        if head.exists():
            self._compare(head, sweep)
        else:
            mine = {self._file(name).name for name in (*columns, "done")}
            foreign = sorted({entry.name for entry in self.path.iterdir()} - mine)
            if foreign:
                raise FileFormatError(
                    f"{self.path}: is no checkpoint of a sweep, it holds {foreign[0]!r}; name a "
                    "new or an empty directory"
                )
            for name, (dtype, shape) in {**columns, "done": (np.bool_, (chunks,))}.items():
                array = np.lib.format.open_memmap(self._file(name), "w+", dtype, shape)
                array.flush()
            write_text(head, json.dumps(sweep, indent=1) + "\n")
        self.done = np.array(self._read("done", (np.bool_, (chunks,))))
        for name, of in columns.items():
            self._read(name, of)
        self._open = {name: self._file(name).open("r+b") for name in (*columns, "done")}
        self._start = {name: _header_size(file) for name, file in self._open.items()}

    def _file(self, name: str) -> Path:
        return self.path / f"{name}.npy"

    def _read(self, name: str, of: tuple[Any, tuple[int, ...]]) -> Any:
        """A column, on disk until it is looked at."""
        path = self._file(name)
        try:
            array = np.load(path, mmap_mode="r", allow_pickle=False)
        except (ValueError, FileNotFoundError) as error:
            raise FileFormatError(f"{path}: is damaged ({error}); start in a new directory"
                                  ) from None
        if array.dtype != of[0] or array.shape != of[1]:
            raise FileFormatError(f"{path}: is not this sweep's; start in a new directory")
        return array

    def _compare(self, head: Path, sweep: Mapping[str, Any]) -> None:
        try:
            there = dict(json.loads(head.read_text(encoding="utf-8")))
        except ValueError:
            raise FileFormatError(f"{head}: is damaged; start in a new directory") from None
        different = [key for key in {**there, **sweep} if there.get(key) != sweep.get(key)]
        if different:
            raise FileFormatError(
                f"{self.path}: holds another sweep, with another {' and '.join(different)}; name "
                "a new directory"
            )

    def write(self, chunk: int, start: int, columns: Mapping[str, Any]) -> None:
        """Write a chunk, whose first member has the flat index `start`."""
        for name, values in columns.items():
            file = self._open[name]
            file.seek(self._start[name] + start * values[:1].nbytes)
            file.write(values.tobytes())
        self._waiting.append(chunk)
        if time.monotonic() - self._synced > SYNC_EVERY:
            self.sync()

    def sync(self) -> None:
        """Bring what was written to the disk, and only then mark it as done."""
        if self._waiting:
            for name in self._columns:
                self._bring(name)
            for chunk in self._waiting:
                self._open["done"].seek(self._start["done"] + chunk)
                self._open["done"].write(b"\1")
            self._bring("done")
            self.done[self._waiting] = True
            self._waiting.clear()
        self._synced = time.monotonic()

    def _bring(self, name: str) -> None:
        self._open[name].flush()
        os.fsync(self._open[name].fileno())

    def close(self) -> None:
        """Mark what can be marked and close the files."""
        try:
            self.sync()
        finally:
            for file in self._open.values():
                with contextlib.suppress(OSError):  # what it could not write is not marked
                    file.close()

    def columns(self) -> dict[str, Any]:
        """Columns, read from the disk as they are needed."""
        return {name: self._read(name, of) for name, of in self._columns.items()}


def _header_size(file: Any) -> int:
    """Where the numbers of an NPY file begin."""
    version = np.lib.format.read_magic(file)
    read = {(1, 0): np.lib.format.read_array_header_1_0,
            (2, 0): np.lib.format.read_array_header_2_0}[version]
    read(file)
    return int(file.tell())
