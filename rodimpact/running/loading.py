"""load(): a saved solution is solved again from its case, a saved family is read."""

import warnings
from typing import Any

from ..hints import explain_arguments
from ..model.frozen import invalid_argument
from ..results.saved import OutcomeDiffers, difference
from ..results.solution import Solution
from ..storage.casefile import read_case
from ..storage.reading import open_regular, read_npz
from ..storage.writing import PathLike, file_name
from .solving import solve
from .sweep_result import SweepResult

NPZ_START = b"PK"
"""First bytes of an NPZ file, which is a ZIP archive."""


@explain_arguments
def load(path: PathLike) -> Any:
    """Load a file that `Solution.save` or `SweepResult.save` wrote.

    A family is read as it was saved. A solution is solved again from its case, and its
    outcome is compared with the stored one. Velocities, impulses, peak forces, force
    durations and times may differ by the sum of the stated errors of both runs;
    energies, relative to their sum, by twice that of velocities and impulses. The same
    version on the same machine finds the same numbers.

    Parameters
    ----------
    path : str or path

    Returns
    -------
    Solution or SweepResult
        Its `system` equals the saved one.

    Warns
    -----
    OutcomeDiffers
        If the outcome differs from the stored one by more than the stated errors.

    Raises
    ------
    InvalidModel
        If a case has mistakes, with all of them, or no stored outcome.
    FileFormatError
        If an NPZ file was not saved by rodimpact, is damaged, holds a single solution,
        as files of earlier versions do, or is of a newer version.
    FileNotFoundError, IsADirectoryError, OSError
        If the file cannot be read at all.
    MemoryError
        If a family takes more than half of the memory of this machine.

    Examples
    --------
    >>> import tempfile, rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> solution = ri.solve(ri.System([rod, ri.Wall()]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     solution.save(f"{folder}/run.toml")
    ...     ri.load(f"{folder}/run.toml").outcome == solution.outcome
    True
    """
    name = file_name(path)
    with open_regular(name) as file:
        start = file.read(len(NPZ_START))
    if start == NPZ_START or name.lower().endswith(".npz"):
        # A family is the only kind of file: "sweep", as `SweepResult.save` wrote it.
        return read_npz(name, {"sweep": SweepResult.restored})
    return _solve_again(name)


def _solve_again(path: str) -> Solution:
    """Solve the case of a file, and compare the outcome with the one stored there.

    If the two outcomes differ by more than the stated errors, the warning
    OutcomeDiffers names the differences; the new solution is returned all the same.
    InvalidModel if the file stores no outcome.
    """
    case = read_case(path)
    if case.result is None:
        message = (
            "has no table [result], so it is no saved solution; read_case(path) reads "
            "the case, and solve(case.system, **case.solve) solves it"
        )
        raise invalid_argument(path, message)  # names the file, not an argument
    solution = solve(case.system, **case.solve)
    differences = difference(case.result, solution)
    if differences:
        # stacklevel 4: this function, `load`, its decorator, the line that calls it
        warnings.warn(f"{path}: {differences}", OutcomeDiffers, stacklevel=4)
    return solution
