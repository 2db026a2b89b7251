"""Records of strain gauges, and the tables that Hopkinson-bar tools read."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..methods.signals import Floats
from ..model.arguments import array
from ..model.frozen import InvalidModel
from ..storage.writing import write_text, written

SAMPLES = 10_000  # of a record where no interval is given


@dataclass(frozen=True)
class Gauge:
    """Record of a strain gauge: strain and velocity are constant between jumps.

    On a grid it has an entry for each state that was kept, which holds until the next.

    Attributes
    ----------
    body : int
    x : float
        m from the left end of the body.
    times : array
        s; the record starts at t = 0 and entry i holds from times[i] on, the last to `end`.
    strain, velocity : array
        Just after each time; m/s.
    rightward, leftward : array
        Strain carried by the wave running right and by the one running left, relative to the
        velocity at t = 0; their sum is `strain`.
    end : float
        s.
    """

    body: int
    x: float
    times: Floats
    strain: Floats
    velocity: Floats
    rightward: Floats
    leftward: Floats
    end: float

    def to_csv(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write time, strain, rightward and leftward strain and velocity, one row a jump.

        Raises
        ------
        FileExistsError
            If the file is there and `force` is false.
        """
        names = ("time", "strain", "rightward", "leftward", "velocity")
        columns = (self.times, self.strain, self.rightward, self.leftward, self.velocity)
        rows = [names, *zip(*([repr(v) for v in c.tolist()] for c in columns), strict=True)]
        write_text(path, "".join(",".join(row) + "\n" for row in rows), force=force)

    def strain_at(self, t: ArrayLike) -> Floats:
        """Strain at times t in s, from 0 to `end`."""
        place = np.searchsorted(self.times, array("t", t, "s"), "right") - 1
        found: Floats = self.strain[np.maximum(place, 0)]
        return found


def gauges_to_csv(
    path: str | os.PathLike[str], gauges: Mapping[str, Gauge], *, interval: float | None = None,
    force: bool = False,
) -> None:
    """Write strains of several gauges at equal intervals: a column of times, then one a gauge.

    With the two gauges ``incident`` and ``transmitted`` this is the table of three columns that
    programs for split Hopkinson bars take.

    Parameters
    ----------
    path : str or path
    gauges : mapping of str to Gauge
        Names of the columns, and records of one solution.
    interval : float, optional
        Between samples, s; by default a 10 000th of the record.
    force : bool
        Whether to replace an existing file.

    Raises
    ------
    InvalidModel
        If there is no gauge, or the interval is not positive.
    FileExistsError
        If the file is there and `force` is false.

    Examples
    --------
    >>> import pathlib, tempfile, rodimpact as ri
    >>> steel = ri.materials.steel
    >>> striker = ri.Rod(0.2, area=1e-4, material=steel, velocity=10.0)
    >>> bars = [ri.Rod(1.0, area=1e-4, material=steel) for _ in range(2)]
    >>> solution = ri.solve(ri.System([striker, *bars]))
    >>> gauges = {"incident": solution.gauge(1, 0.5), "transmitted": solution.gauge(2, 0.5)}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     ri.gauges_to_csv(f"{folder}/bars.csv", gauges, interval=1e-6)
    ...     pathlib.Path(f"{folder}/bars.csv").read_text().splitlines()[0]
    'time,incident,transmitted'
    """
    if not gauges:
        message = "needs at least one record, such as solution.gauge(1, 0.5)"
        raise InvalidModel([("gauges", message)])
    end = min(record.end for record in gauges.values())
    interval = end / SAMPLES if interval is None else interval
    if not interval > 0:
        message = f"must be a positive number of seconds, got {interval!r}"
        raise InvalidModel([("interval", message)])
    times = interval * np.arange(int(end / interval * (1 + 1e-12)) + 1)
    columns = [times, *(record.strain_at(times) for record in gauges.values())]
    with written(path, force=force) as file:
        file.write((",".join(["time", *gauges]) + "\n").encode())
        for row in zip(*(column.tolist() for column in columns), strict=True):
            file.write((",".join(map(repr, row)) + "\n").encode())
