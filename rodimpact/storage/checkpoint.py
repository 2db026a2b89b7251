"""A sweep on disk: files of members that are done.

Each file knows whose members it has. A file is there as a whole or not at all, so a
process may be killed at any moment; the next one goes on with what is missing, or is no
longer what it was.
"""

from __future__ import annotations

import json
import time
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..units import shown_path
from .reading import FileFormatError, read_npz
from .writing import PASSING, Arrays, PathLike, check_target, file_name, write_npz

KIND = "part of a sweep"
"""Kind of the files."""
FILE_NAME = "members-{}.npz"
"""Name of a file, with the index of its first member."""
SAVE_INTERVAL = 1.0
"""Time between two files, s, at least; a crash undoes the work since the last one."""
SAVE_TIME_RATIO = 0.02
"""Time between two files over the time so far, at least."""


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
    """Columns of results, which are also kept in a directory where one is given.

    Parameters
    ----------
    columns : mapping of str to (dtype, shape of a member)
    size : int
        Number of members.
    path : str or path, optional
        Directory; made if there is none, gone on with if it holds the same sweep.
    sweep : mapping
        What makes it the same sweep, JSON-ready.

    Attributes
    ----------
    columns : dict of str to array, [member, ...]
    done : array of bool, [member]

    Warns
    -----
    DamagedChunks
        If a file is not what was written; it is put aside, and its members are not
        done.

    Raises
    ------
    FileFormatError
        If the directory holds something else: another sweep, or foreign files.
    OSError
        If it cannot be read or written.
    """

    def __init__(
        self,
        columns: Mapping[str, tuple[Any, tuple[int, ...]]],
        size: int,
        path: PathLike | None,
        sweep: Mapping[str, Any],
    ) -> None:
        """Make columns for `size` members, and take over those in the directory.

        The directory `path` is made if there is none; with None nothing is read or
        kept. `columns` has the dtype and the shape of a member of each column, and
        `sweep` what makes it the same sweep. A damaged file is a warning, a file of
        another sweep FileFormatError.
        """
        self.size = size
        self.columns: Arrays = {}
        for name, (dtype, shape) in columns.items():
            self.columns[name] = np.empty((size, *shape), dtype)
        self.path: Path | None = None
        if path is not None:
            self.path = Path(file_name(path))
        # In the form in which it comes back from a file: JSON turns tuples into lists.
        self._sweep = json.loads(json.dumps(sweep))
        self._began = time.monotonic()  # s
        self._saved_at = self._began  # time of the last file, s
        self.done = np.zeros(size, dtype=bool)
        self._unsaved = np.zeros(size, dtype=bool)  # members that are not on the disk
        for file in self._files():
            chunk = self._read(file)
            if chunk is not None:
                count = len(chunk.columns["status"])  # every column has this length
                stop = chunk.start + count
                self._take(chunk.start, stop, chunk.columns)

    def missing(self) -> list[Span]:
        """Spans of the members that are not done."""
        return spans(~self.done)

    def _take(self, start: int, stop: int, part: Mapping[str, Any]) -> None:
        """Copy the columns of some members to their places; these members are done."""
        for name, column in self.columns.items():
            column[start:stop] = part[name]
        self.done[start:stop] = True

    def _files(self) -> list[Path]:
        """Files of members in the directory, sorted; it is made if there is none.

        Files that were not finished or are put aside are left out. [] if no directory
        is given. OSError if no file can be written there, FileFormatError for foreign
        files.
        """
        if self.path is None:
            return []
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            message = (
                f"cannot make the directory {shown_path(self.path)}: {error.strerror}"
            )
            raise type(error)(message) from None
        # Raises if no file can be written there: now, before anything is computed.
        check_target(self.path / FILE_NAME.format(0), force=True)
        files = []
        for file in sorted(self.path.iterdir()):
            is_left_over = file.name.startswith(PASSING)  # not whole, or put aside
            if is_left_over:
                continue
            if not file.match(FILE_NAME.format("*")):
                raise FileFormatError(
                    f"{self.path}: is no checkpoint of a sweep, it holds "
                    f"{file.name!r}; name a "
                    "new or an empty directory"
                )
            files.append(file)
        return files

    def _read(self, file: Path) -> _Chunk | None:
        """Index of the first member in a file, and the columns of its members.

        None, with a warning, if the file is damaged; then it is put aside under another
        name. FileFormatError if the members are of another sweep.
        """

        def as_it_is(document: dict[str, Any], columns: Arrays) -> Any:
            """Document and arrays of a file, unchanged."""
            return document, columns

        try:
            document, columns = read_npz(file, {KIND: as_it_is})
        except FileFormatError as error:
            message = f"{error}; it is put aside, and its members are run again"
            # The line that calls `sweep`: above are the constructor, `sweep` and its
            # decorator.
            warnings.warn(message, DamagedChunks, stacklevel=5)
            file.replace(file.with_name(PASSING + file.name))
            return None
        saved_sweep = document["sweep"]
        different = []
        for key, entry in self._sweep.items():
            if saved_sweep.get(key) != entry:
                different.append(key)
        if different:
            raise FileFormatError(
                f"{self.path}: holds another sweep, with another "
                f"{' and '.join(different)}; name "
                "a new directory"
            )
        return _Chunk(document["start"], columns)

    def put(self, start: int, stop: int, part: Mapping[str, Any]) -> None:
        """Put the results of the members `start` to `stop - 1` into the columns.

        `part` has their columns by name. All members that are not on the disk are saved
        if the last time is long ago: `SAVE_INTERVAL`, or longer for a long sweep.
        """
        self._take(start, stop, part)
        self._unsaved[start:stop] = True
        now = time.monotonic()
        # Saving takes time: a long sweep saves less often.
        interval = max(SAVE_INTERVAL, SAVE_TIME_RATIO * (now - self._began))
        if now - self._saved_at >= interval:
            self._save()

    def close(self) -> None:
        """Save what `put` has not saved yet."""
        self._save()

    def _save(self) -> None:
        """Save the members that are not on the disk, a file for each run of them.

        From then on they count as saved, and the time until the next save begins anew.
        Without a directory nothing is written, but they count as saved, too.
        """
        if self.path is not None:
            # Each run of members without a gap, from `start` to `stop - 1`.
            for start, stop in spans(self._unsaved):
                self._write(self.path / FILE_NAME.format(f"{start:08}"), start, stop)
        self._unsaved[:] = False
        self._saved_at = time.monotonic()

    def _write(self, file: Path, start: int, stop: int) -> None:
        """Write the members `start` to `stop - 1` to a file; an old one is replaced.

        OSError, with a sentence on going on later, if it cannot be written.
        """
        part = {}
        for name, column in self.columns.items():
            part[name] = column[start:stop]
        document = {"sweep": self._sweep, "start": start}
        try:
            write_npz(file, KIND, document, part, force=True)
        except OSError as error:
            remedy = "what is done is kept, and the same sweep goes on from there"
            raise type(error)(f"{error}; {remedy}") from error


class Span(NamedTuple):
    """Consecutive members."""

    start: int
    stop: int  # the one after the last member


class _Chunk(NamedTuple):
    """Results of consecutive members."""

    start: int  # the first member
    columns: Arrays


def spans(members: Any) -> list[Span]:
    """Runs of members that are true, from an array of truth values [member]."""
    changes = np.diff(np.concatenate(([0], members, [0])))
    # By turns the first member of a run and the one after its last
    edges = np.flatnonzero(changes)
    return [Span(int(start), int(stop)) for start, stop in edges.reshape(-1, 2)]
