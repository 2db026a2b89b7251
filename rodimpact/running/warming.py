"""warm(): all solvers are compiled in advance, before a result is waited for."""

import time
import warnings

import numpy as np

from ..hints import explain_arguments
from ..materials import steel
from ..methods import kernels
from ..methods.abilities import needs
from ..methods.registry import METHODS
from ..model import RigidMass, Rod, System
from ..model.laws import Spring
from .solving import solve
from .sweeping import sweep

WARMING_CELLS = 8  # number of cells of the grid in the runs that compile its kernels


@explain_arguments
def warm() -> float:
    """Compile all solvers, and keep the compiled code on disk.

    Compiled code that already exists is loaded, and all later runs of this process use
    it. Without `warm` a process begins in plain Python. It changes to compiled code
    when plain Python has taken half a second, or three seconds if no compiled code is
    on disk. ``dask.distributed.Client.run(ri.warm)`` calls `warm` on each worker of a
    cluster.

    Returns
    -------
    float
        Time for compiling and loading, s; 0 if nothing can be compiled.

    Warns
    -----
    NoCompiler
        If nothing can be compiled.

    Examples
    --------
    Up to a minute the first time, seconds afterwards:

    >>> import rodimpact as ri
    >>> seconds = ri.warm()                                # doctest: +SKIP
    """
    start = time.perf_counter()
    reason = kernels.why_not()
    if reason:
        message = f"nothing can be compiled: {reason}"
        # stacklevel 3: this function, its decorator, the line that calls `warm`
        warnings.warn(message, kernels.NoCompiler, stacklevel=3)
        return 0.0
    with kernels.kept():
        for name in METHODS:
            warm_method(name)
    return time.perf_counter() - start


def warm_method(name: str) -> None:
    """Compile all kernels of a method, by running each of them at least once.

    Two small families are enough for this: two rods, and a mass with a spring in front
    of a rod. A family that the method cannot solve is left out.
    """
    method = METHODS[name]
    cells = None  # other methods have no mesh
    if "cells" in method.takes:  # a small mesh is enough
        cells = WARMING_CELLS
    bar = Rod(1.0, area=1e-4, material=steel)
    speeds = np.array([1.0, 2.0])
    families = [
        System([Rod(0.5, area=1e-4, material=steel, velocity=speeds), bar]),
        System([RigidMass(0.1, velocity=speeds), bar], contacts=[Spring(1e6)]),
    ]
    with kernels.forced(True):  # True: compiled, however short the runs are
        for family in families:
            # Needs of the system that the method lacks, such as compliant contacts
            lacking = method.lacking(needs(family))
            if len(lacking) == 0:
                _run_kernels(family, name, cells)


def _run_kernels(family: System, method: str, cells: int | None) -> None:
    """Run all kernels of a method, by the family as a sweep and by its first member.

    `cells` is the number of cells for a method with a mesh, else None.
    """
    sweep(family, method, cells=cells, workers=1)
    also = ["largest_stress"]  # for this, members are also solved one by one
    sweep(family, method, until=1e-3, cells=cells, workers=1, also=also)
    solution = solve(family[0], method=method, cells=cells)
    if cells is not None:
        # Without `cells` the method searches for a mesh, by further kernels. The large
        # rtol ends the search at once.
        solve(family[0], method=method, rtol=1.0)
    # Fields have kernels, too. Any positions x, [position, 1], and times t, [time], are
    # good enough. Body 1 is the bar.
    x = np.array([[0.0], [0.5]])
    t = np.array([0.0, 1e-4])
    solution.velocity(1, x, t)
