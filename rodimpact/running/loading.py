"""Results survive in files: what `load` returns equals what was saved, bit for bit."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from .. import __version__
from ..results.run_file import put_together
from ..results.solution import Solution
from ..storage.writing import FORMAT, SCHEMA, Arrays, FileFormatError, PathLike, restored
from .sweeping import SweepResult


def load(path: PathLike) -> Any:
    """Read what `Solution.save` or `SweepResult.save` wrote, without solving again.

    Parameters
    ----------
    path : str or path

    Returns
    -------
    Solution or SweepResult
        Equal to the saved one, bit for bit.

    Raises
    ------
    FileFormatError
        If the file is not an NPZ of rodimpact, is damaged, is of a newer version, or was made on a
        clock that this version would lay out differently.
    FileNotFoundError, IsADirectoryError, OSError
        If it cannot be read at all.

    Examples
    --------
    >>> import tempfile, rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> solution = ri.solve(ri.System([rod, ri.Wall()]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     solution.save(f"{folder}/run.npz")
    ...     ri.load(f"{folder}/run.npz").outcome == solution.outcome
    True
    """
    raw, name = Path(path).read_bytes(), os.fspath(path)
    if not raw.startswith(b"PK"):
        raise FileFormatError(f"{name}: is not an NPZ file, so rodimpact did not save it")
    try:
        with np.load(io.BytesIO(raw), allow_pickle=False) as archive:
            arrays = {key: archive[key] for key in archive.files}
    except Exception as error:  # zipfile, zlib and numpy raise a dozen kinds for a damaged file
        raise FileFormatError(
            f"{name}: is not a whole NPZ file of plain arrays ({error})"
        ) from error
    try:
        document = json.loads(str(arrays.pop("document")))
        foreign = document["format"] != FORMAT
        schema, kind, version = document["schema"], document["kind"], document["rodimpact"]
        known = schema == SCHEMA and kind in _READERS
    except (KeyError, TypeError, ValueError, RecursionError):
        foreign = True
    if foreign:
        raise FileFormatError(f"{name}: is an NPZ file, but not one that rodimpact saved")
    if not known:
        raise FileFormatError(
            f"{name}: is a {kind!r} of schema {schema!r}, saved by rodimpact {version}; this is "
            f"rodimpact {__version__}, which reads schema {SCHEMA}. Use the version that saved it, "
            "or a newer one"
        )
    try:
        return _READERS[kind](document, arrays)
    except FileFormatError as error:
        raise FileFormatError(f"{name}: {error}") from None
    except Exception as error:  # whatever a wrong entry of the document leads to
        raise FileFormatError(
            f"{name}: its contents do not fit together ({type(error).__name__}: {error})"
        ) from error


def _read_sweep(document: dict[str, Any], arrays: Arrays) -> SweepResult:
    return SweepResult.restored(document, arrays)


def _read_solution(document: dict[str, Any], arrays: Arrays) -> Solution:
    return Solution(put_together(restored(document), arrays))


_READERS: dict[str, Callable[[dict[str, Any], Arrays], Any]] = {
    "solution": _read_solution, "sweep": _read_sweep,
}
