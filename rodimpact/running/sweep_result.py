"""Results of a family of collisions: arrays of its shape, tables and files.

A column has one entry per collision; the system and the argument `also` of `sweep`
decide which columns there are.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..hints import NamedItems, UndefinedResult, explain_missing
from ..methods.family import Columns
from ..methods.groups import unilateral
from ..methods.registry import Options
from ..model import System
from ..model.arguments import demand
from ..model.frozen import InvalidModel, invalid_argument
from ..model.quantities import is_integer
from ..results.labels import dataset
from ..results.notebook import Shown
from ..results.outcome import OnlyContact
from ..results.solution import Solution
from ..storage.extras import optional
from ..storage.family_file import describe, restore
from ..storage.writing import PathLike, check_ending, write_lines, write_npz
from ..units import shown
from .columns import (
    ENDED,
    STATUS,
    ContactColumns,
    columns_of,
    layout_of,
)
from .readings import RequestedReadings

LINES_PER_BLOCK = 4096  # number of lines of a table that are made at a time


@explain_missing()
class Axis(NamedTuple):
    """One axis of a family, with the path and the values of the number that varies.

    Only this number varies along the axis. If there is no such number, the name is
    ``"axis 0"``, and the values are 0, 1, 2, ...

    Examples
    --------
    >>> import numpy as np, rodimpact as ri
    >>> lengths = np.array([0.2, 0.4])
    >>> left = ri.Rod(lengths, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> (axis,) = ri.sweep(ri.System([left, ri.Wall()])).axes
    >>> axis.name, axis.values.tolist()
    ('bodies.0.length', [0.2, 0.4])
    """

    name: str
    values: Any


class NotAskedFor(InvalidModel, UndefinedResult):
    """A result of a family that is computed only if `also` names it."""


def check_family_name(path: Any) -> None:
    """Raise InvalidModel unless the name of a file is that of a saved family."""
    check_ending(path, (".npz",), "result.to_csv(path) writes a table")


@explain_missing("contacts", "system")
@dataclass(frozen=True, eq=False)
class SweepResult(Shown, OnlyContact[Any]):
    """Outcomes of a family of collisions; every array has its `shape`.

    Attributes
    ----------
    system : System
        The family.
    options : Options
        Options and method with which each member was solved.
    columns : dict of str to array
        By name: ``restitution``; ``velocity_after.I`` of body I, m/s; ``impulse.K`` (N
        s), ``peak_force.K`` (N), ``duration.K`` (force duration, s) and ``episodes.K``
        of contact K; ``vibration``, the vibration energy, J; ``final``; ``status``.
        Totals are counted to the end of the run: `until`, the proof that the collision
        is over, or an earlier stop. A number that does not exist is nan. If `also` of
        `sweep` names them, there are ``dissipated``, energy lost in contacts, J;
        ``set.K``, the permanent set of contact K, m; ``displacement.I`` of the centre
        of mass of body I at the end of the run, m; and ``largest_stress.I``, the
        largest absolute stress anywhere in rod I at any time, Pa, as
        `Solution.extreme_stress` finds it. ``accuracy`` is the largest stated error of
        velocities, impulses and peak forces, relative to the largest of each.
    readings : RequestedReadings
        Arguments `gauges`, `times` and `also` of the sweep.
    strain : array or None
        Strain at the gauges, of the family's shape + (gauge, time); nan after the end
        of a member's run. None without gauges.

    Examples
    --------
    >>> import numpy as np, rodimpact as ri
    >>> steel = ri.materials.steel
    >>> lengths = np.array([0.2, 0.4, 0.8])
    >>> left = ri.Rod(lengths, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> ri.sweep(ri.System([left, right])).restitution.round(12)
    array([0.2, 0.4, 0.8])
    """

    system: System
    options: Options
    columns: Columns
    readings: RequestedReadings = field(default_factory=RequestedReadings)
    strain: Any = None
    _several = "these rows have {} contacts that can open, not 1; use result.contacts"

    @property
    def method(self) -> str:
        """Name of the method."""
        return self.options.method

    @property
    def gauges(self) -> tuple[tuple[int, float], ...]:
        """Strain gauges: body, and distance from its left end, m."""
        return self.readings.gauges

    @property
    def times(self) -> Any:
        """Times of `strain`, s."""
        return self.readings.times

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the family."""
        return self.system.shape

    @property
    def parameters(self) -> dict[str, Any]:
        """Numbers in which the members differ, by path; they broadcast to `shape`."""
        return self.system.parameters

    @property
    def axes(self) -> tuple[Axis, ...]:
        """The number that varies along each axis: its path and values as an `Axis`.

        It is the first number that varies along this axis only. If there is none, the
        name is "axis 0", "axis 1" and so on, and the values are 0, 1, 2, ...
        """
        axes = []
        for dimension, size in enumerate(self.shape):
            axes.append(Axis(f"axis {dimension}", np.arange(size)))
        # In reverse, so that the first number of an axis replaces the later ones.
        for path, values in reversed(self.parameters.items()):
            varies = np.greater(values.shape, 1)  # whether along each axis of `values`
            if np.count_nonzero(varies) == 1:
                # Arrays are broadcast with their last axes aligned, so the axis counts
                # from the last one, as a negative index.
                axis_from_last = int(np.argmax(varies)) - values.ndim
                axes[axis_from_last] = Axis(path, values.ravel())
        return tuple(axes)

    @property
    def restitution(self) -> Any:
        """Effective coefficient of restitution e; nan if undefined, see `explain`."""
        return self.columns["restitution"]

    @property
    def velocities_after(self) -> tuple[Any, ...]:
        """Velocities of the centres of mass at the end, one array per body, m/s."""
        velocities = []
        for i in range(len(self.system.bodies)):
            velocities.append(self.columns[f"velocity_after.{i}"])
        return tuple(velocities)

    @property
    def vibration(self) -> Any:
        """Vibration energy of all bodies, J."""
        return self.columns["vibration"]

    @property
    def final(self) -> Any:
        """Whether it is proved that no contact can press again."""
        return self.columns["final"]

    @property
    def status(self) -> Any:
        """Reason why each run stopped, one of the words of `STATUS`."""
        return np.array(STATUS)[self.columns["status"]]

    @property
    def incomplete(self) -> Any:
        """Whether each run was stopped before its end, or failed.

        A run is stopped by `max_events` or by the clock.
        """
        return ~np.isin(self.columns["status"], ENDED)

    @cached_property
    def contacts(self) -> tuple[ContactColumns, ...]:
        """Totals of each contact from left to right, including contacts with walls.

        Each is an array of the family's shape: impulse, peak force, force duration and
        episodes.
        """
        contacts = []
        for k in range(len(self.system.contacts)):
            contact = ContactColumns(
                impulse=self.columns[f"impulse.{k}"],
                peak_force=self.columns[f"peak_force.{k}"],
                duration=self.columns[f"duration.{k}"],
                episodes=self.columns[f"episodes.{k}"],
            )
            contacts.append(contact)
        return tuple(contacts)

    @cached_property
    def unilateral(self) -> list[int]:
        """Indices of the contacts that can open."""
        return unilateral(self.system)

    @property
    def episodes(self) -> Any:
        """Number of episodes of the only contact; ValueError if there are several."""
        return self._only_contact().episodes

    @property
    def dissipated(self) -> Any:
        """Energy lost in contacts, J; ValueError if `also` did not request it."""
        return self._requested("dissipated")[0]  # 0: the whole row

    @property
    def accuracy(self) -> Any:
        """Largest stated error of velocities, impulses and peak forces.

        It is relative to the largest velocity, impulse or peak force. ValueError if it
        was not requested by `also`.
        """
        return self._requested("accuracy")[0]  # 0: the whole row

    @property
    def sets(self) -> dict[int, Any]:
        """Permanent sets of yielding contacts, m, by contact.

        ValueError if `also` did not request them.
        """
        return self._requested("set")

    @property
    def displacements(self) -> dict[int, Any]:
        """Displacements of the centres of mass at the end, m, by body.

        ValueError if `also` did not request them.
        """
        return self._requested("displacement")

    @property
    def largest_stresses(self) -> dict[int, Any]:
        """Largest absolute stress in each rod, Pa, by body.

        ValueError if `also` did not request them.
        """
        return self._requested("largest_stress")

    def _requested(self, name: str) -> dict[int, Any]:
        """Columns of a result that `also` names, by the index of the body or contact.

        A result of the whole row has the index 0. NotAskedFor is raised if `also` of
        the sweep did not name this result.
        """
        if name not in self.readings.also:
            message = f'was not asked for; give sweep(..., also=["{name}"])'
            raise NotAskedFor([(name, message)])
        by_owner = {}
        for column, source in columns_of(self.system, [name]).items():
            by_owner[source.owner_index] = self.columns[column]
        return by_owner

    def explain(self, index: Any) -> str:
        """Reason why one member ended, or why it has no restitution, as a sentence.

        The member is solved again. If the run is complete but has no restitution, the
        sentence tells why; otherwise it tells how the run ended. If the method refuses
        the member, all its mistakes are returned, each with its path. InvalidModel is
        raised if the index picks several members.

        Parameters
        ----------
        index : int or tuple of int
        """
        member = self.system[index]
        demand(not member.shape, "index", f"must pick one member, got {shown(index)}")
        try:
            run = self.options.run(self.method, member)
        except InvalidModel as error:
            sentences = []
            for path, message in error.problems:
                sentences.append(f"{path}: {message}")
            return "; ".join(sentences)
        solution = Solution(run, self.options)
        outcome = solution.outcome
        reached_end = solution.stopped_by == "until"
        # A driven row is never final: its run is complete when it reaches `until`.
        is_complete = outcome.final or (outcome.driven and reached_end)
        if is_complete:
            reason = outcome.why_no_restitution()
            if reason:
                return reason
        return outcome.status

    def save(self, path: PathLike, *, force: bool = False) -> None:
        """Write an NPZ file that `rodimpact.load` reads: system, options, all arrays.

        Raises
        ------
        FileExistsError
            If the file is there and `force` is false.
        InvalidModel
            If the name of the file does not end in ``.npz``, or a law of the system is
            a function.
        OSError
            If the file cannot be written.
        """
        check_family_name(path)
        contents = [self.system, asdict(self.options), list(self.readings)]
        document, arrays = describe(contents)
        arrays = arrays | self.columns  # `arrays` are those of the system
        if self.strain is not None:
            arrays["strain"] = self.strain
        write_npz(path, "sweep", document, arrays, force=force)

    @classmethod
    def restored(cls, document: dict[str, Any], arrays: Columns) -> SweepResult:
        """The result that `save` wrote, from its document and its arrays by name.

        An error of any class is raised if the document is not one of `save`; it is a
        ValueError if a column has a wrong shape.
        """
        system, options, stored_readings = restore(document, arrays)
        gauges, times, also = stored_readings
        # JSON turned the tuples into lists.
        readings = RequestedReadings(
            gauges=tuple(map(tuple, gauges)), times=times, also=tuple(also)
        )
        columns = {}
        for name, layout in layout_of(system, readings).items():
            columns[name] = arrays[name]
            shape = (*system.shape, *layout.member_shape)
            if columns[name].shape != shape:
                raise ValueError("columns do not have the family's shape")
        strain = columns.pop("strain", None)
        return cls(system, Options(**options), NamedItems(columns), readings, strain)

    def table(self, start: int = 0, stop: int | None = None) -> Columns:
        """Varied numbers and results of the members `start` to `stop` - 1, by name.

        Each is an array with one entry per member, in C order; a status is a word.
        Strains are left out. The default is all members. Negative indices count from
        the end, as in a slice. InvalidModel is raised if `start` or `stop` is not a
        whole number.
        """
        is_stop_valid = stop is None or is_integer(stop)
        if not is_integer(start) or not is_stop_valid:
            message = f"must be whole numbers, got {shown(start)} and {shown(stop)}"
            raise invalid_argument("start, stop", message)
        shape = self.shape
        if not shape:  # a single collision is a table of one line
            shape = (1,)
        members = np.arange(math.prod(shape))[start:stop]
        index = np.unravel_index(members, shape)  # for each axis, [member]
        columns = self.parameters | self.columns
        columns["status"] = self.status
        table = {}
        for name, values in columns.items():
            # A number has the length 1 along the axes along which it does not vary.
            table[name] = np.broadcast_to(values, shape)[index]
        return table

    def csv_lines(self) -> Iterator[str]:
        """Lines of a CSV table of all members, without newlines; the first has names.

        The columns are those of `table`. Numbers have all their digits; nan is an empty
        cell.
        """
        yield ",".join([*self.parameters, *self.columns])
        for start in range(0, math.prod(self.shape), LINES_PER_BLOCK):
            table = self.table(start, start + LINES_PER_BLOCK)
            columns = []
            for values in table.values():
                columns.append(values.tolist())
            for row in zip(*columns, strict=True):
                yield ",".join(map(_cell, row))

    def to_csv(self, path: PathLike, *, force: bool = False) -> None:
        """Write a CSV table of all members, one per line: varied numbers, then results.

        Raises
        ------
        FileExistsError
            If the file is there and `force` is false.
        """
        write_lines(path, self.csv_lines(), force=force)

    def to_dataframe(self) -> Any:
        """All members as a pandas DataFrame (extra ``dataframe``), one per row.

        The columns are those of `table`; the status is categorical.

        Examples
        --------
        >>> import rodimpact as ri
        >>> steel = ri.materials.steel
        >>> lengths = [[0.2], [0.4]]
        >>> left = ri.Rod(lengths, area=[1e-4, 2e-4], material=steel, velocity=1.0)
        >>> right = ri.Rod(1.0, area=1e-4, material=steel)
        >>> frame = ri.sweep(ri.System([left, right])).to_dataframe()
        >>> best = frame.loc[frame.groupby("bodies.0.area")["restitution"].idxmax()]
        >>> best["bodies.0.length"].tolist()
        [0.4, 0.4]
        >>> frame.query("final and restitution < 0.3")["status"].tolist()
        ['final']
        """
        pandas = optional("pandas", "dataframe")
        frame = pandas.DataFrame(self.table())
        frame["status"] = pandas.Categorical(frame["status"], STATUS)
        return frame

    def to_xarray(self) -> Any:
        """All results as an xarray Dataset (extra ``xarray``), one dimension per axis.

        Numbers that vary are coordinates; a status is a word. Strains have the further
        dimensions ``gauge`` and ``time``, with the coordinates ``body`` and ``x`` of
        each gauge. Every variable has its ``long_name`` and its ``units``.

        Examples
        --------
        >>> import rodimpact as ri
        >>> steel = ri.materials.steel
        >>> left = ri.Rod([0.2, 0.4], area=1e-4, material=steel, velocity=1.0)
        >>> right = ri.Rod(1.0, area=1e-4, material=steel)
        >>> data = ri.sweep(ri.System([left, right])).to_xarray()
        >>> status = data["status"].sel({"bodies.0.length": 0.4})
        >>> data["impulse.0"].attrs["units"], status.item()
        ('N s', 'final')
        """
        names = [axis.name for axis in self.axes]
        coordinates: Columns = {}  # by name: (names of the dimensions, values)
        for path, values in self.parameters.items():
            coordinates[path] = (names, np.broadcast_to(values, self.shape))
        # The number that names an axis is replaced by its values along this axis alone.
        for axis in self.axes:
            coordinates[axis.name] = ([axis.name], axis.values)
        variables: Columns = {}  # by name: (names of the dimensions, values)
        for name, column in self.columns.items():
            variables[name] = (names, column)
        variables["status"] = (names, self.status)
        if self.strain is not None:
            # `gauges` are pairs (body, x).
            bodies, places = zip(*self.gauges, strict=True)
            coordinates["time"] = (["time"], self.times)
            coordinates["body"] = (["gauge"], list(bodies))
            coordinates["x"] = (["gauge"], list(places))
            variables["strain"] = ([*names, "gauge", "time"], self.strain)
        return dataset(self.system, variables, coordinates)

    def __repr__(self) -> str:
        """Shape of the family, and paths of the numbers that vary."""
        varied = "nothing"
        if self.parameters:
            varied = ", ".join(self.parameters)
        return f"<SweepResult of shape {self.shape} over {varied}>"


def _cell(value: Any) -> str:
    """A value of any type as text, with every digit; "" for nan."""
    is_nan = value != value  # only nan differs from itself
    if is_nan:
        return ""
    return str(value)
