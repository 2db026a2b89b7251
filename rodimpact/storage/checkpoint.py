"""A sweep on disk: files with the results of members that are done.

Each file contains a description of its sweep. A file exists as a whole or not at all,
so a process may be killed at any moment; the next process runs the members whose files
are missing or damaged.
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
"""Kind of the files, see `read_npz`."""
FILE_NAME = "members-{}.npz"
"""Name of a file, with the index of its first member."""
SAVE_INTERVAL = 1.0
"""Shortest time between two files, s; a crash undoes the work since the last file."""
SAVE_TIME_RATIO = 0.02
"""Shortest time between two files over the time since the sweep began."""


class DamagedChunks(UserWarning):
    """Parts of a checkpoint are damaged, and their members are run again.

    Examples
    --------
    To stop the program with an error instead:

    >>> import warnings, rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", ri.DamagedChunks)
    ...     outcome = ri.collide(rod, ri.Wall())
    """


class Checkpoint:
    """Columns of results in memory; if a directory is given, they are also saved there.

    Parameters
    ----------
    columns : mapping of str to (dtype, shape of the entry of a member)
    size : int
        Number of members.
    path : str or path, optional
        Directory. It is made if it does not exist, and continued if it holds the same
        sweep.
    sweep : mapping
        Description of the sweep, ready for JSON: two sweeps with equal descriptions
        have the same results.

    Attributes
    ----------
    columns : dict of str to array, [member, ...]
        Results; the entries of members that are not done are undefined.
    done : array of bool, [member]
        Whether the columns have the results of each member.

    Warns
    -----
    DamagedChunks
        If a file is damaged; it is renamed, and its members are not done.

    Raises
    ------
    FileFormatError
        If the directory holds another sweep or foreign files.
    OSError
        If the directory cannot be read or written.
    """

    def __init__(
        self,
        columns: Mapping[str, tuple[Any, tuple[int, ...]]],
        size: int,
        path: PathLike | None,
        sweep: Mapping[str, Any],
    ) -> None:
        """Make columns for `size` members, and read the results in the directory.

        The directory `path` is made if it does not exist; if it is None, nothing is
        read or saved. For the other parameters, warnings and errors see the class.
        """
        self.size = size
        self.columns: Arrays = {}
        for name, (dtype, shape) in columns.items():
            self.columns[name] = np.empty((size, *shape), dtype)
        self.path: Path | None = None
        if path is not None:
            self.path = Path(file_name(path))
        # In the form in which a file returns it, to be compared: JSON turns tuples into
        # lists.
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
        """Spans of consecutive members that are not done, in ascending order."""
        return spans(~self.done)

    def _take(self, start: int, stop: int, part: Mapping[str, Any]) -> None:
        """Copy the results of the members `start` to `stop - 1`; they are done now.

        `part` has their columns by name.
        """
        for name, column in self.columns.items():
            column[start:stop] = part[name]
        self.done[start:stop] = True

    def _files(self) -> list[Path]:
        """Files of members in the directory, sorted; [] if no directory is given.

        The directory is made if it does not exist. Unfinished files and damaged ones,
        which were renamed, are left out. OSError is raised if no file can be written
        there, FileFormatError for foreign files.
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
        # Raises if no file can be written there, before anything is computed.
        check_target(self.path / FILE_NAME.format(0), force=True)
        files = []
        for file in sorted(self.path.iterdir()):
            is_left_over = file.name.startswith(PASSING)  # unfinished or damaged
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

        If the file is damaged, it is renamed, the warning DamagedChunks is given, and
        the result is None. FileFormatError is raised if the file is of another sweep.
        """

        def as_it_is(document: dict[str, Any], columns: Arrays) -> Any:
            """Return document and arrays of a file: the reader for `read_npz`."""
            return document, columns

        try:
            document, columns = read_npz(file, {KIND: as_it_is})
        except FileFormatError as error:
            message = f"{error}; it is put aside, and its members are run again"
            # stacklevel 5: this method, the constructor, `sweep`, its decorator, and
            # the line that calls `sweep`
            warnings.warn(message, DamagedChunks, stacklevel=5)
            file.replace(file.with_name(PASSING + file.name))
            return None
        saved_sweep = document["sweep"]
        different = []  # keys of the description with other entries in the file
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
        """Copy the results of the members `start` to `stop - 1` into the columns.

        `part` has their columns by name. Then all unsaved members are saved if the last
        save was `SAVE_INTERVAL` ago, or longer in a long sweep.
        """
        self._take(start, stop, part)
        self._unsaved[start:stop] = True
        now = time.monotonic()
        # Saving takes time, so a long sweep saves less often.
        interval = max(SAVE_INTERVAL, SAVE_TIME_RATIO * (now - self._began))
        if now - self._saved_at >= interval:
            self._save()

    def close(self) -> None:
        """Save the members that `put` has not saved yet."""
        self._save()

    def _save(self) -> None:
        """Save the members that are not on the disk, one file per span of members.

        Afterwards these members count as saved, and the interval until the next save
        begins. Without a directory no file is written; the rest is the same.
        """
        if self.path is not None:
            # Eight digits in the names, so that files sort by their first members
            for start, stop in spans(self._unsaved):
                self._write(self.path / FILE_NAME.format(f"{start:08}"), start, stop)
        self._unsaved[:] = False
        self._saved_at = time.monotonic()

    def _write(self, file: Path, start: int, stop: int) -> None:
        """Write the members `start` to `stop - 1` to a file, which may be replaced.

        If the file cannot be written, OSError says that the sweep can be continued.
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
    """Consecutive members, `start` to `stop - 1`."""

    start: int
    stop: int  # index after the last member


class _Chunk(NamedTuple):
    """Results of consecutive members."""

    start: int  # index of the first member
    columns: Arrays  # by name, [member, ...]


def spans(members: Any) -> list[Span]:
    """Spans of consecutive true entries of an array of truth values, [member]."""
    # The zeros at both ends make a change of a span that touches the first or last one.
    changes = np.diff(np.concatenate(([0], members, [0])))
    # Alternately the first index of a span and the index after its last
    edges = np.flatnonzero(changes)
    return [Span(int(start), int(stop)) for start, stop in edges.reshape(-1, 2)]
