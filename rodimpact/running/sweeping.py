"""sweep(): every collision of a family, on any executor.

The members are run in chunks, which are smaller families. The result of a chunk is a
table of columns with one row per collision.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import asdict, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..hints import NamedItems, explain_arguments
from ..methods.registry import Options, checked_count
from ..methods.run import MAX_EVENTS
from ..model import System
from ..model.frozen import InvalidModel, Problems, raise_if_problems
from ..progress import Progress, ProgressFunction, check_progress
from ..storage.checkpoint import Checkpoint
from ..storage.writing import PathLike
from ..version import __version__
from .chunks import run_jobs
from .columns import layout_of
from .jobs import check_executor, pool_of
from .readings import RequestedReadings, check_also, check_readings
from .sweep_result import SweepResult


@explain_arguments
def sweep(
    system: System,
    method: str = "auto",
    executor: Executor | None = None,
    *,
    until: float | None = None,
    max_events: int = MAX_EVENTS,
    dt: float | None = None,
    rtol: float | None = None,
    cells: int | None = None,
    gauges: Sequence[tuple[int, float]] = (),
    times: ArrayLike | None = None,
    also: Sequence[str] = (),
    workers: int | None = None,
    progress: bool | ProgressFunction = True,
    checkpoint: PathLike | None = None,
) -> SweepResult:
    """Solve every collision of a family.

    Parameters
    ----------
    system : System
        A system of any shape. Numbers of the model that are arrays define a family, and
        broadcast as in NumPy. The family of a case file is ``read_case("case.toml",
        vary={"bodies.0.length": "0.05:1:20"}).system``.
    method : str
        As for `solve`; all members have the same method.
    executor : concurrent.futures.Executor, optional
        Executor that runs the chunks; default: threads of this process. It may run
        processes or a cluster, by ``dask.distributed.Client.get_executor()`` or
        ``mpi4py.futures.MPIPoolExecutor``. The result is bit for bit the same as with
        threads.
    until : float, optional
        End of each run, s; default: the proof that the collision is over. With driven
        ends or gravity there is no proof. Chains with repeated contact may have no
        proof for a long time.
    max_events, dt, rtol, cells
        Options for each member, as for `solve`.
    gauges : sequence of (int, float), optional
        Strain gauges: body, and distance from its left end, m.
    times : array_like, optional
        Times at which the strain at the gauges is returned, s, for all members; [time].
    also : sequence of str, optional
        Further results, which take longer: ``"dissipated"``, the energy lost in
        contacts; ``"largest_stress"`` in each rod; ``"set"``, the permanent set of each
        yielding contact, such as the set of a pile; ``"displacement"`` of each body at
        `until`; ``"accuracy"``, the stated error of each member. See `SweepResult`.
    workers : int, optional
        Number of threads; default: one for each processor. With an executor: the number
        of its workers; default 64.
    progress : bool or function
        Whether a progress bar may be shown, after two seconds of work, on a terminal or
        in a notebook. A function is called with the number of completed collisions and
        the number of all collisions, at least twice a second. An exception that the
        function raises ends the sweep.
    checkpoint : path, optional
        Directory for finished chunks, including strains. An interrupted sweep continues
        from these chunks.

    Returns
    -------
    SweepResult

    Raises
    ------
    InvalidModel
        If an argument is wrong or missing, or the method lacks something that the
        system has.
    FileFormatError, OSError
        If the checkpoint directory holds something else, or cannot be written.

    Warns
    -----
    DamagedChunks
        If files of the checkpoint are damaged; their members are solved again.

    Notes
    -----
    If a member cannot be solved, or if the limit on events or the clock stops it, the
    result contains its `status` and the results so far. `SweepResult.incomplete` marks
    such members, and `SweepResult.explain` gives the reason.

    Each of several workers gets about eight jobs, or about a hundred with a checkpoint,
    at most two at a time. An interrupt cancels waiting jobs. Running jobs end within
    seconds, or with their present member.

    Processes, dask, and MPI, started by
    ``mpiexec -n 65 python -m mpi4py.futures program.py``::

        with ProcessPoolExecutor() as pool:  # under if __name__ == "__main__":
            result = ri.sweep(family, executor=pool)

        client.run(ri.warm)  # each machine compiles once, before the first job
        result = ri.sweep(family, executor=client.get_executor())

        with MPIPoolExecutor() as pool:
            result = ri.sweep(family, executor=pool)

    Under SLURM, ``sbatch --array=0-99`` starts a hundred programs, each with its own
    members. With its own checkpoint each program can continue after an interruption::

        task = int(os.environ["SLURM_ARRAY_TASK_ID"])
        ri.sweep(family[task::100], checkpoint=f"part-{task}").save(f"part-{task}.npz")

    Examples
    --------
    Strain at a gauge in the middle of a bar, for three strikers:

    >>> import numpy as np, rodimpact as ri
    >>> steel = ri.materials.steel
    >>> lengths = np.array([0.1, 0.2, 0.4])
    >>> striker = ri.Rod(lengths, area=1e-4, material=steel, velocity=10.0)
    >>> bar = ri.Rod(2.0, area=1e-4, material=steel)
    >>> pulses = ri.sweep(ri.System([striker, bar]), until=5e-4, gauges=[(1, 1.0)],
    ...                   times=np.linspace(0, 5e-4, 6))
    >>> pulses.strain.shape
    (3, 1, 6)
    """
    problems: Problems = []
    if workers is not None:
        workers = checked_count(problems, "workers", workers)
    check_progress(problems, progress)
    try:
        options = Options(
            until=until,
            method=method,
            max_events=max_events,
            dt=dt,
            rtol=rtol,
            cells=cells,
        )
        options = replace(options, method=options.method_for(system))
        check_executor(problems, executor, system)
        readings = check_readings(problems, system, gauges, times)
        names = check_also(problems, also, options.until)
        readings = readings._replace(also=names)
        size = math.prod(system.shape)
        if size == 0:
            message = f"has no members, its shape is {system.shape}; select one or more"
            problems.append(("system", message))
    except InvalidModel as error:
        problems += error.problems
    raise_if_problems(problems)
    description: dict[str, Any] = {}  # only a checkpoint on disk uses it
    if checkpoint is not None:
        description = describe_sweep(system, options, readings)
    store = Checkpoint(layout_of(system, readings), size, checkpoint, description)
    # The contexts end in reverse order: the jobs are stopped first, and the store saves
    # last.
    with (
        contextlib.closing(store),
        Progress(progress, "sweep", "collisions") as report,
        pool_of(executor, workers) as pool,
        contextlib.closing(run_jobs(system, options, readings, store, pool)) as turns,
    ):
        # In each turn: the jobs that have ended since the previous turn, if any.
        for ended_jobs in turns:
            for start, stop, part in ended_jobs:
                store.put(start, stop, part)
            done = int(np.count_nonzero(store.done))
            report(done, size)
    columns = {}
    for name, column in store.columns.items():
        member_shape = column.shape[1:]  # () except for "strain"
        columns[name] = column.reshape((*system.shape, *member_shape))
    strain = columns.pop("strain", None)
    return SweepResult(system, options, NamedItems(columns), readings, strain)


def describe_sweep(
    system: System, options: Options, readings: RequestedReadings
) -> dict[str, Any]:
    """All inputs on which the results of a sweep depend, by name, ready for JSON.

    They are the version of rodimpact, a digest and the shape of the system, the options
    and the readings. Only a sweep with the same description may continue a checkpoint.
    """
    return {
        "rodimpact": __version__,
        "system": system.digest,
        "shape": system.shape,
        **asdict(options),
        **readings._asdict(),
        "times": readings.times.tolist(),  # replaces the array, which JSON cannot hold
    }
