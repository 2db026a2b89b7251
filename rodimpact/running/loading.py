"""Results survive in files: what `load` returns equals what was saved, bit for bit."""

from typing import Any

from ..results.run_file import put_together
from ..results.solution import Solution
from ..storage.reading import read_npz
from ..storage.writing import PathLike
from .sweep_result import SweepResult


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
        If the file is not an NPZ of rodimpact, is damaged, or is of a newer version.
    FileNotFoundError, IsADirectoryError, OSError
        If it cannot be read at all.
    MemoryError
        If it holds more than half of what this machine has of memory.

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
    return read_npz(
        path,
        {
            "solution": lambda document, arrays: Solution(
                put_together(document, arrays)
            ),
            "sweep": SweepResult.restored,
        },
    )
