"""What a run on a grid costs: memory, and time; which states are kept."""

from __future__ import annotations

import numpy as np

from .. import kernels
from ..memory import ask
from ..row import Array
from .mesh import Mesh

STATES_BYTES = 64 << 20  # of kept states, where their number is not given
CELL_TIMES = {"explicit": (7e-10, 8e-7), "implicit": (6e-9, 2.5e-6), "radial": (7e-10, 8e-7)}
"""Time of a cell and a step, s, compiled and in plain Python; of radial motion beside the other."""
STEP_TIMES = 3e-7, 1e-5
"""Time of a step beside that of its cells, with what results take."""


def check_memory(mesh: Mesh, step: float, steps: float, states: float) -> None:
    """Raise TooLong where a run, what is kept of it, and its results take too much memory."""
    row = mesh.row
    contacts, masses = len(row.contact_link), sum(m >= 0 for m in row.mass_of)
    ends = sum(kind != "none" for kind, _ in row.outside)
    kept = 3 * len(mesh.touching) + len(mesh.interfaces) + 6 + len(row.masses)
    # what the kernel keeps; force, gap, path, rate and power with integrals; edges and times
    record = steps * (2 * kept + 10 * contacts + 5 * masses + 8 * ends + 10)
    # two of each, while they are made larger or fields are made of them
    fields = 2 * states * (2 * len(mesh.mass) * (1 + mesh.swells) + len(mesh.starts) + 3)
    if not kernels.enabled():  # lists take four times what arrays take, and stand beside them
        record, fields = record + 4 * steps * kept, 3 * fields
    if record > fields:
        field, remedy = "until", "stop earlier, or take fewer cells"
    else:
        field, remedy = "snapshots", "keep fewer, or take fewer cells"
    what = f"a run of {steps:.4g} steps of {step:.3g} s with {states:.4g} states"
    ask(record + fields, field, what, remedy)


class Keeper:
    """Which states are kept: at chosen times, or so many at equal distances, all if they fit."""

    def __init__(self, snapshots: int | Array | None) -> None:
        self.snapshots, self.stride = snapshots, 1
        self.most = snapshots if isinstance(snapshots, int) else 0

    def count(self, mesh: Mesh, steps: float) -> float:
        """How many states of a run are kept at most."""
        if isinstance(self.snapshots, np.ndarray):
            return 2.0 * len(self.snapshots) + 2
        self.most = self.most or max(
            64, STATES_BYTES // (16 * len(mesh.mass) * (1 + mesh.swells)))
        return min(steps, max(self.most, 3)) + 2

    def when(self, step: float, end: int) -> list[int]:
        """Steps at whose ends states are kept, of a run to step `end`."""
        if isinstance(self.snapshots, np.ndarray):
            steps = self.snapshots / step
            both = np.concatenate((np.floor(steps), np.ceil(steps), [0.0]))
            chosen: list[int] = np.unique(both[both <= end].astype(int)).tolist()
            return chosen
        while end // self.stride + 2 > max(self.most, 3):
            self.stride *= 2
        return list(range(0, end + 1, self.stride))


def cost(mesh: Mesh, plain: bool) -> float:
    """About how long a step takes, s, in plain Python or compiled."""
    return STEP_TIMES[plain] + sum(
        (b - a + 1) * CELL_TIMES["implicit" if hidden else "explicit"][plain]
        for a, b, hidden in zip(mesh.starts, mesh.stops, mesh.implicit, strict=True)
    ) + np.count_nonzero(mesh.cells.swelling) * CELL_TIMES["radial"][plain]
