"""sweep(): every collision of a family, on any executor.

Its members are run in chunks, which are smaller families; a chunk's result is a table
of columns, one row a collision.
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
        Of any shape: numbers of the model that are arrays make a family, as NumPy
        broadcasts them. That of a case is
        ``read_case("case.toml", vary={"bodies.0.length": "0.05:1:20"}).system``.
    method : str
        As for `solve`; one for all members.
    executor : concurrent.futures.Executor, optional
        Executor that runs the chunks; by default threads of this process. Processes, a
        cluster by ``dask.distributed.Client.get_executor()`` or
        ``mpi4py.futures.MPIPoolExecutor``. The result is the same bit for bit.
    until : float, optional
        Time to which each member runs, s; by default to the proof that its collision is
        over. Where drives or gravity act there is none, and chains that touch again and
        again may have none for a long time.
    max_events, dt, rtol, cells
        Of each member, as for `solve`.
    gauges : sequence of (int, float), optional
        Strain gauges: body, and place in m from its left end.
    times : array_like, optional
        Times at which the strain at the gauges is wanted, s, for all members; [time].
    also : sequence of str, optional
        What else is wanted, which takes longer: ``"dissipated"``, the energy lost in
        contacts; ``"largest_stress"`` in each rod; ``"set"``, how far each yielding
        contact has yielded for good, such as the set of a pile; ``"displacement"``, how
        far each body has moved at `until`; ``"accuracy"``, the stated error of each
        member. See `SweepResult`.
    workers : int, optional
        Number of threads, by default the processors at hand; beside an executor the
        number of its workers, by default 64.
    progress : bool or function
        Whether a bar may show how far the sweep is: after two seconds of work, on a
        terminal or in a notebook. A function is called with the number of collisions
        done and of all, twice a second or more often; what it raises ends the sweep.
    checkpoint : path, optional
        Directory for finished chunks, strains included. A sweep that was interrupted
        continues from there.

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
        If the checkpoint has files that are not what was written; their members are run
        again.

    Notes
    -----
    A member that cannot be solved, or that the cap on events or the clock stops, keeps
    its `status` and the results that are known; `SweepResult.incomplete` and
    `SweepResult.explain` tell more.

    Each of several workers gets about eight jobs, with a checkpoint a hundred, at most
    two at a time. An interrupt cancels jobs that wait. Jobs that run end within
    seconds, or with their present member.

    Processes, dask, and MPI, started by
    ``mpiexec -n 65 python -m mpi4py.futures program.py``::

        with ProcessPoolExecutor() as pool:  # under if __name__ == "__main__":
            result = ri.sweep(family, executor=pool)

        client.run(ri.warm)  # each machine compiles once, before the first job
        result = ri.sweep(family, executor=client.get_executor())

        with MPIPoolExecutor() as pool:
            result = ri.sweep(family, executor=pool)

    Under SLURM, ``sbatch --array=0-99`` starts a hundred programs, each with members of
    its own; a checkpoint each lets them go on where they were::

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
    description: dict[str, Any] = {}
    if checkpoint is not None:
        description = describe_sweep(system, options, readings)
    store = Checkpoint(layout_of(system, readings), size, checkpoint, description)
    # They close in reverse order: jobs first, and last the store, which saves.
    with (
        contextlib.closing(store),
        Progress(progress, "sweep", "collisions") as report,
        pool_of(executor, workers) as pool,
        contextlib.closing(run_jobs(system, options, readings, store, pool)) as turns,
    ):
        # Each turn brings the jobs that have ended since the last one, or none.
        for ended_jobs in turns:
            for start, stop, part in ended_jobs:
                store.put(start, stop, part)
            done = int(np.count_nonzero(store.done))
            report(done, size)
    columns = {}
    for name, column in store.columns.items():
        member_shape = column.shape[1:]
        columns[name] = column.reshape((*system.shape, *member_shape))
    strain = columns.pop("strain", None)
    return SweepResult(system, options, NamedItems(columns), readings, strain)


def describe_sweep(
    system: System, options: Options, readings: RequestedReadings
) -> dict[str, Any]:
    """Everything on which the results of a sweep depend, by name, ready for JSON.

    It has the version of rodimpact, a digest and the shape of the system, the options
    and the readings. A checkpoint may be continued only by a sweep with the same
    description.
    """
    return {
        "rodimpact": __version__,
        "system": system.digest,
        "shape": system.shape,
        **asdict(options),
        **readings._asdict(),
        "times": readings.times.tolist(),  # in place of the array of the readings
    }
