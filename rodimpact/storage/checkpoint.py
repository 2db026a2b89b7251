"""A sweep on disk: result columns as NPY files, and a checksum of each chunk that is done.

Every file is made whole by whoever comes first. A chunk gets its checksum when its numbers are on
the disk, so a process may be killed at any moment; the next one goes on with what is missing, or is
no longer what it was.
"""

from __future__ import annotations

import bisect
import contextlib
import json
import math
import os
import time
import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .reading import FileFormatError, npy_header, open_regular
from .writing import PASSING, PathLike, checksum, file_name, write_text, written

HEAD = "sweep.json"
CHECKSUMS = "checksums"  # a column of its own: one a chunk, 0 while it is not done
SYNC_EVERY = 1.0  # s; at most so much work is done again after a crash


class DamagedChunks(UserWarning):
    """Parts of a checkpoint are not what was written, and are run again.

    Examples
    --------
    A program that shall stop instead:

    >>> import warnings, rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", ri.DamagedChunks)
    ...     outcome = ri.collide(rod, ri.Wall())
    """


class Checkpoint:
    """Columns of results in a directory.

    Parameters
    ----------
    path : str or path
        Directory; made if there is none, gone on with if it holds the same sweep.
    sweep : mapping
        What makes it the same sweep, JSON-ready.
    columns : mapping of str to (dtype, shape)
    spans : sequence of (int, int)
        First and last flat index of the members of each chunk.

    Attributes
    ----------
    done : array of bool, [chunks]

    Warns
    -----
    DamagedChunks
        If chunks that were done do not have their checksum; they are done no longer.

    Raises
    ------
    FileFormatError
        If the directory holds something else: another sweep, or foreign files.
    OSError
        If it cannot be read or written.
    """

    def __init__(
        self, path: PathLike, sweep: Mapping[str, Any],
        columns: Mapping[str, tuple[Any, tuple[int, ...]]], spans: Sequence[tuple[int, int]],
    ) -> None:
        self.path, self._columns, self._spans = Path(file_name(path)), columns, spans
        self._waiting: dict[int, int] = {}  # checksums of chunks that are not on the disk for sure
        self._synced = time.monotonic()
        self._claim(sweep)
        files = {**columns, CHECKSUMS: (np.dtype(np.uint64), (len(spans),))}
        for name, of in files.items():
            self._make(name, *of)
        self._numbers = {name: self._read(name, *of) for name, of in files.items()}
        self.done = self._undamaged()
        self._open = {name: self._file(name).open("r+b") for name in files}

    def _file(self, name: str) -> Path:
        return self.path / f"{name}.npy"

    def _claim(self, sweep: Mapping[str, Any]) -> None:
        """Make this the directory of the sweep, or see that it is."""
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except FileExistsError:
            raise NotADirectoryError(f"{self.path}: is a file; name a directory") from None
        except OSError as error:
            message = f"cannot make the directory {str(self.path)!r}: {error.strerror}"
            raise type(error)(message) from None
        except ValueError:
            raise OSError(f"{str(self.path)!r}: a name cannot hold the character NUL") from None
        foreign = sorted(x.name for x in self.path.iterdir() if not x.name.startswith(PASSING))
        head = self.path / HEAD
        if not head.exists():
            if foreign:
                raise FileFormatError(
                    f"{self.path}: is no checkpoint of a sweep, it holds {foreign[0]!r}; name a "
                    "new or an empty directory"
                )
            with contextlib.suppress(FileExistsError):  # another process was first
                write_text(head, json.dumps(sweep, indent=1) + "\n")
        try:
            with open_regular(head) as file:
                there = json.load(file)
            same_kind = there.keys() == sweep.keys()
        except (AttributeError, ValueError, RecursionError):
            same_kind = False
        if not same_kind:
            raise FileFormatError(f"{head}: is damaged; start in a new directory")
        different = [key for key in sweep if there[key] != sweep[key]]
        if different:
            raise FileFormatError(
                f"{self.path}: holds another sweep, with another {' and '.join(different)}; name "
                "a new directory"
            )

    def _make(self, name: str, dtype: Any, shape: tuple[int, ...]) -> None:
        """A column of zeros, unless it is there."""
        with contextlib.suppress(FileExistsError), written(self._file(name)) as file:
            np.lib.format.write_array_header_1_0(file, {
                "descr": np.lib.format.dtype_to_descr(dtype), "fortran_order": False,
                "shape": shape,
            })
            file.truncate(file.tell() + dtype.itemsize * math.prod(shape))

    def _read(self, name: str, dtype: Any, shape: tuple[int, ...]) -> Any:
        """A column, on disk until it is looked at."""
        path = self._file(name)
        with open_regular(path) as file:
            try:
                if npy_header(file) != (dtype, shape, False):
                    raise ValueError(f"it has not the shape {shape} of this sweep")
                return np.memmap(file, dtype, "r", file.tell(), shape)
            except Exception as error:  # numpy raises half a dozen kinds for a damaged file
                raise FileFormatError(
                    f"{path}: is damaged, or not this sweep's ({error}); move it away to have it "
                    "made again, or start in a new directory"
                ) from None

    def _undamaged(self) -> Any:
        """Which chunks have their checksum; a warning of those that have another."""
        kept = self._numbers[CHECKSUMS]
        done = kept != 0
        members = self._spans[-1][1]
        columns = [self._numbers[name].reshape(members, -1) for name in self._columns]
        damaged = [
            chunk for chunk in np.flatnonzero(done).tolist()
            if checksum(x[slice(*self._spans[chunk])] for x in columns) != kept[chunk]
        ]
        if damaged:
            done[damaged] = False
            warnings.warn(
                f"{self.path}: damaged parts of the sweep are run again, {len(damaged)} of "
                f"{len(done)}, from number {damaged[0]} on", DamagedChunks, stacklevel=4,
            )
        return np.array(done)

    def put(self, start: int, stop: int, columns: Mapping[str, Any]) -> None:
        """Write chunks: those of the members from `start` to `stop`."""
        chunk = bisect.bisect_left(self._spans, (start, start))
        while chunk < len(self._spans) and self._spans[chunk][0] < stop:
            first, end = (at - start for at in self._spans[chunk])
            part = {name: values[first:end] for name, values in columns.items()}
            with self._told():
                for name in self._columns:
                    self._put(name, start + first, part[name])
            self._waiting[chunk] = checksum(part[name] for name in self._columns)
            chunk += 1
            if time.monotonic() - self._synced > SYNC_EVERY:
                self.sync()

    def sync(self) -> None:
        """Bring what was written to the disk, and only then its checksums."""
        if self._waiting:
            with self._told():
                for name in self._columns:
                    self._bring(name)
                for chunk, number in self._waiting.items():
                    self._put(CHECKSUMS, chunk, np.array([number], np.uint64))
                self._bring(CHECKSUMS)
            self.done[[*self._waiting]] = True
            self._waiting.clear()
        self._synced = time.monotonic()

    def _put(self, name: str, start: int, values: Any) -> None:
        """Write numbers of the members from `start` on."""
        self._open[name].seek(self._numbers[name].offset + start * values[:1].nbytes)
        self._open[name].write(values.tobytes())

    def _bring(self, name: str) -> None:
        self._open[name].flush()
        os.fsync(self._open[name].fileno())

    @contextlib.contextmanager
    def _told(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise type(error)(
                f"cannot write in {str(self.path)!r}: {error.strerror or error}; what is done is "
                "kept, and the same sweep goes on from there"
            ) from error

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
        return {name: self._read(name, *of) for name, of in self._columns.items()}
