"""Records of strain gauges, and the tables that Hopkinson-bar tools read."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..hints import explain_arguments, explain_missing
from ..methods.signals import Floats, Ints, Pieces, Side, quadrature
from ..model.arguments import array, check_text, demand, scalar
from ..model.frozen import Problems, invalid_argument, raise_if_problems
from ..records.signal import Signal
from ..storage.tables import heading, misnamed, write_table
from ..units import shown
from .fields import to_side

DEFAULT_SAMPLES = 10_000  # number of sampling intervals of a record, by default
MAX_TABLE_ROWS = 100_000_000  # a table of some gigabytes
ROWS_PER_BLOCK = 4096  # rows of a table that are computed at a time
SAMPLE_COUNT_RTOL = 1e-12  # fraction of a record by which its last sample may be late
RECORD_END_RTOL = 1e-9  # fraction of a record by which a time may exceed its end


class Sampling(NamedTuple):
    """Samples at equal intervals from t = 0 on."""

    step: float  # interval from one sample to the next, s
    sample_count: int


class CellParts(NamedTuple):
    """Parts of consecutive cells, in each of which a signal is one polynomial."""

    cuts: Floats  # [part + 1], ticks
    cell: Ints  # index of the cell to which a part belongs, [part]


@explain_missing()
@dataclass(frozen=True)
class Gauge:
    """Record of a strain gauge.

    With the method "fronts" the record has an entry for each jump, and strain and
    velocity are constant between entries. If waves change smoothly, straight lines
    between entries have an error of at most 5e-5 of the range of each wave, and all
    jumps are entries. On a grid the record has an entry for each stored state.
    `strain_at` and `signal` give the strain at all times.

    Attributes
    ----------
    body : int
    x : float
        m from the left end of the body.
    times : array
        s. The record starts at t = 0. Entry i is valid from times[i] on, and the last
        entry up to `end`.
    strain, velocity : array
        Values from each time on; the velocity in m/s.
    rightward, leftward : array
        Strain of the wave that runs to the right, and of the wave that runs to the
        left, relative to the velocity at t = 0. Their sum is `strain`.
    end : float
        s.
    record : Pieces
        Strain at all times, in ticks of the clock.
    tick : float
        s.
    name : str
        Name of the body in tables and figures, such as "rod 2".

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> gauge = ri.solve(ri.System([left, right])).gauge(body=1, x=0.5)
    >>> (gauge.strain[:3] * 1e6).round(3).tolist()     # microstrain: a pulse
    [0.0, -99.058, 0.0]
    """

    body: int
    x: float
    times: Floats
    strain: Floats
    velocity: Floats
    rightward: Floats
    leftward: Floats
    end: float
    record: Pieces
    tick: float
    name: str

    @property
    def strain_after(self) -> Floats:
        """Strain just after each time."""
        return self.strain_at(self.times)

    @property
    def strain_rate(self) -> Floats:
        """Mean strain rate from each time to the next, 1/s, one for each time.

        The rate is (strain just before t[i + 1] - strain just after t[i])/(t[i + 1] -
        t[i]), without the jumps at the times. The last rate is the mean up to `end`. If
        the next time, or `end`, is equal to a time, the rate there is 0.
        """
        stops = np.append(self.times[1:], self.end)
        durations = stops - self.times
        # "left" takes the strain before a jump at a tick. In `_ticks` it matters only
        # for times so large that floats do not resolve ticks.
        ticks_before = self._ticks(stops, "left")
        strain_before = self.record.at(ticks_before, "left")
        changes = strain_before - self.strain_after
        rates = np.zeros(len(durations))
        np.divide(changes, durations, out=rates, where=durations > 0)
        return rates

    def _ticks(self, t: Floats, side: Side = "right") -> Ints:
        """Ticks nearest to times in s.

        Ticks that are too large to be resolved by floats are moved to just after
        ("right") or just before ("left") jumps at these times, see `to_side`.
        """
        nearest = np.rint(t / self.tick).astype(np.int64)
        return to_side(nearest, side)

    def signal(self, interval: float | None = None, name: str = "") -> Signal:
        """Return the strain as a signal at equal intervals, the first sample at t = 0.

        A sample is a weighted mean over 1.5 intervals on each side. The weight is a
        parabolic spline, so the sample varies smoothly with the time of a jump, as a
        fit needs. Beyond both ends of the record the strain is taken as constant.

        Parameters
        ----------
        interval : float, optional
            Time between samples, s; by default a 10 000th of the record.
        name : str
            Name of the signal in figures, tables and files; default such as "strain of
            rod 2 at 0.5 m".

        Raises
        ------
        InvalidModel
            If the interval is not a positive number of seconds, too short, or longer
            than the record, or if the name is no text.

        Examples
        --------
        >>> import rodimpact as ri
        >>> steel = ri.materials.steel
        >>> rods = [ri.Rod(0.2, area=1e-4, material=steel, velocity=v) for v in (2, 0)]
        >>> gauge = ri.solve(ri.System(rods), until=1e-4).gauge(1, 0.1)
        >>> round(gauge.signal(1e-7).pulse().width / (0.2 / steel.wave_speed), 4)
        1.0
        """
        check_text("name", name, "incident")
        sampling = _sampling(interval, self.end)
        step = sampling.step
        message = f"must not be longer than the record, {self.end!r} s, got {step!r}"
        demand(step <= self.end, "interval", message)
        samples = []
        for rows in _blocks(sampling.sample_count):
            samples.append(self._spline_means(step / self.tick, rows))
        times = step * np.arange(sampling.sample_count)
        if name == "":
            name = f"strain of {self.name} at {self.x:g} m"
        return Signal(np.concatenate(samples), times, name=name)

    def _spline_means(self, step: float, rows: Ints) -> Floats:
        """Means of the strain about the times of n consecutive rows, [n].

        The row r has the time r * step, ticks. The means are weighted by a parabolic
        spline over three cells, each a step long, with the row in the middle. With u
        from 0 to 1 in each cell, the weights are u^2/2, 1/2 + u - u^2 and (1 - u)^2/2.
        So a mean is made of the integrals over cells of the strain, of u times the
        strain, and of u^2 times the strain.
        """
        # Row r has three cells, from r - 1.5 to r + 1.5 steps. So n rows have n + 2
        # cells, and these n + 3 bounds: one for each row and for the three that follow.
        following = rows[-1] + np.arange(1, 4)
        bounds_in_steps = np.append(rows, following) - 1.5
        bounds = step * bounds_in_steps  # ticks
        parts = self._cell_parts(bounds)
        cell_of_part = parts.cell
        begin = (parts.cuts[:-1] - bounds[cell_of_part]) / step  # u where a part begins
        width = np.diff(parts.cuts)[:, None] / step  # of a part, in u
        # In a part the strain is one polynomial, of a degree one below its count of
        # coefficients, and the strain times u^2 of a degree one above that count.
        # Gauss's rule of n points is exact up to the degree 2 n - 1.
        point_count = (self.record.coefficient_count + 3) // 2
        shares, weights = quadrature(point_count)  # points as shares of a part's width
        u = begin[:, None] + width * shares  # [part, point of the rule]
        strain = self.record.inside(parts.cuts[:-1], parts.cuts[1:], shares)
        # The terms of the integrals over u, [part, point of the rule].
        terms = strain * weights * width
        terms_u = terms * u
        terms_u2 = terms * (u * u)
        # Sums over the points of the rule, and then over the parts of each cell.
        cell_count = len(bounds) - 1
        integral = np.bincount(cell_of_part, terms.sum(axis=1), cell_count)
        integral_u = np.bincount(cell_of_part, terms_u.sum(axis=1), cell_count)
        integral_u2 = np.bincount(cell_of_part, terms_u2.sum(axis=1), cell_count)
        # The integral over each cell with the weight that it has as the first, the
        # second and the third cell of a row.
        rising = integral_u2 / 2  # by u^2/2
        middle = integral / 2 + integral_u - integral_u2  # by 1/2 + u - u^2
        falling = integral / 2 - integral_u + integral_u2 / 2  # by (1 - u)^2/2
        # The i-th of these rows has the cells i, i + 1 and i + 2.
        means: Floats = rising[:-2] + middle[1:-1] + falling[2:]
        return means

    def _cell_parts(self, bounds: Floats) -> CellParts:
        """Cells cut at breaks, where the next polynomial of the strain begins.

        The cells lie between increasing bounds, ticks. A cell without a break is one
        part. A break at a bound makes a part without width.
        """
        all_breaks = self.record.breaks
        first, stop = all_breaks.searchsorted(bounds[[0, -1]])
        breaks = all_breaks[first:stop]
        # Cell i lies between the bounds i and i + 1. `next_bound` is the index of the
        # bound after each break, so that the break lies in the cell next_bound - 1.
        next_bound = bounds[:-1].searchsorted(breaks, side="right")
        cuts = np.insert(bounds, next_bound, breaks)  # in order
        cell_count = len(bounds) - 1
        # Each break makes one more part of its cell, inserted after its other parts.
        cell = np.insert(np.arange(cell_count), next_bound, next_bound - 1)
        return CellParts(cuts, cell)

    def to_csv(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write a table of strain and velocity, one row per entry.

        The columns are time, strain, rightward strain, leftward strain and velocity.

        Raises
        ------
        FileExistsError
            If the file is there and `force` is false.
        """
        columns = {
            heading("time", "s"): self.times,
            heading("strain", ""): self.strain,
            heading("rightward", ""): self.rightward,
            heading("leftward", ""): self.leftward,
            heading("velocity", "m/s"): self.velocity,
        }
        block = list(columns.values())  # one block of all rows, as a list of columns
        write_table(path, list(columns), [block], force=force)

    def strain_at(self, t: ArrayLike) -> Floats:
        """Strain at times t in s, from 0 to `end`, of their shape.

        At a jump this is the value after the jump. ValueError for times outside the
        record, except for round-off (`RECORD_END_RTOL`) at the end.
        """
        t = array("t", t, "s")
        # `demand` puts the first value outside in place of {0!r}.
        message = f"must be from 0 to {self.end!r} s, got {{0!r}}"
        inside = (t >= 0) & (t <= self.end * (1 + RECORD_END_RTOL))
        demand(inside, "t", message, t)
        return self.record.at(self._ticks(t))


@explain_arguments
def gauges_to_csv(
    path: str | os.PathLike[str],
    gauges: Mapping[str, Gauge],
    *,
    interval: float | None = None,
    force: bool = False,
) -> None:
    """Write strains of several gauges at equal intervals as one table.

    The table has a column of times from 0 to the end of the shortest record, and a
    column of strain for each gauge. With the two gauges ``incident`` and
    ``transmitted`` this is the table of three columns that programs for split Hopkinson
    bars read.

    Parameters
    ----------
    path : str or path
    gauges : mapping of str to Gauge
        Names of the columns, and records of one solution.
    interval : float, optional
        Time between samples, s; by default a 10 000th of the shortest record.
    force : bool
        Whether to replace an existing file.

    Raises
    ------
    InvalidModel
        If there is no gauge, a name would break the table, or the interval is not a
        positive number of seconds or gives too many rows.
    FileExistsError
        If the file is there and `force` is false.

    Examples
    --------
    >>> import pathlib, tempfile, rodimpact as ri
    >>> steel = ri.materials.steel
    >>> striker = ri.Rod(0.2, area=1e-4, material=steel, velocity=10.0)
    >>> bars = [ri.Rod(1.0, area=1e-4, material=steel) for _ in range(2)]
    >>> solution = ri.solve(ri.System([striker, *bars]))
    >>> incident = solution.gauge(1, 0.5)
    >>> gauges = {"incident": incident, "transmitted": solution.gauge(2, 0.5)}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     ri.gauges_to_csv(f"{folder}/bars.csv", gauges, interval=1e-6)
    ...     pathlib.Path(f"{folder}/bars.csv").read_text().splitlines()[0]
    'time [s],incident [1],transmitted [1]'
    """
    check_gauges(gauges)
    message = "needs at least one record, such as solution.gauge(1, 0.5)"
    demand(len(gauges) > 0, "gauges", message)
    problems: Problems = []
    for name in gauges:
        sentence = misnamed(name)
        if sentence:
            problems.append(("gauges", sentence))
    raise_if_problems(problems)
    records = list(gauges.values())
    earliest_end = min(record.end for record in records)
    sampling = _sampling(interval, earliest_end)
    heads = [heading("time", "s")]
    for name in gauges:
        heads.append(heading(name, ""))
    write_table(path, heads, _table_blocks(records, sampling), force=force)


def _table_blocks(records: list[Gauge], sampling: Sampling) -> Iterator[list[Floats]]:
    """Blocks of up to `ROWS_PER_BLOCK` rows of a table, each as a list of columns.

    The columns are the times, s, and the strain of each record at these times.
    """
    for rows in _blocks(sampling.sample_count):
        times = sampling.step * rows
        columns = [times]
        for record in records:
            columns.append(record.strain_at(times))
        yield columns


def check_gauges(gauges: Any) -> Mapping[str, Gauge]:
    """Check a mapping of names to gauges, which may be empty, and return it.

    InvalidModel for any other object, and if a value in it is no `Gauge`.
    """
    if isinstance(gauges, Mapping):
        are_gauges = [isinstance(record, Gauge) for record in gauges.values()]
        if all(are_gauges):
            return gauges
    message = "must be records by name, such as {'incident': solution.gauge(1, 0.5)}"
    raise invalid_argument("gauges", f"{message}, got {shown(gauges)}")


def _sampling(interval: Any, end: float) -> Sampling:
    """Samples at this interval, s, of a record that ends at `end`, s.

    If `interval` is None, there are `DEFAULT_SAMPLES` intervals. If the record has no
    duration, there is one sample. InvalidModel for an interval that is not positive, or
    gives more than `MAX_TABLE_ROWS` rows.
    """
    if interval is not None:
        step = scalar("interval", interval, "s", "positive")
    else:
        step = end / DEFAULT_SAMPLES
    if step == 0:  # the record has no duration: any step gives one sample
        step = 1.0
    if end / step > MAX_TABLE_ROWS:
        least = end / MAX_TABLE_ROWS
        message = (
            f"gives {end / step:.3g} rows, more than {MAX_TABLE_ROWS}; take at least"
        )
        raise invalid_argument("interval", f"{message} {least:.3g} s, got {step!r}")
    # Rounded down; a last sample that is late by round-off alone is included.
    interval_count = int(end / step * (1 + SAMPLE_COUNT_RTOL))
    return Sampling(step, interval_count + 1)


def _blocks(count: int) -> Iterator[Ints]:
    """Indices from 0 to `count - 1` in arrays of up to `ROWS_PER_BLOCK`."""
    for start in range(0, count, ROWS_PER_BLOCK):
        yield np.arange(start, min(start + ROWS_PER_BLOCK, count))
