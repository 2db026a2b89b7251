"""gradient(): how what a collision adds up to changes with the numbers of its system.

A number of a row is a product of powers of numbers of its system, so its derivatives are known from
the exponents; those of the collision come from a run and one pass over its log. Where the order of
events may change with a number, the collision is followed on both sides as well.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ..methods import kernels
from ..methods.family import table
from ..methods.fronts.assembly import Blueprint
from ..methods.fronts.families import ROOM, Block, space
from ..methods.fronts.front_kernel import FINAL, FULL, Results
from ..methods.fronts.layout_kernel import LAID, lay_out_all
from ..methods.groups import grounds, groups, unilateral
from ..methods.memory import ask
from ..methods.registry import Options, count
from ..methods.row import Array, Row
from ..methods.run import MAX_EVENTS
from ..model import Absorbing, Free, Rod, Steps, System
from ..model.frozen import InvalidModel, Problems
from ..model.paths import numbers_of, places_of, suggestion
from ..results.labels import outcome, parameter
from ..results.outcome import UndefinedRestitution, effective_restitution
from ..running.jobs import pool_of
from ..running.solving import solve
from ..units import shown
from .result import Gradient, Kink
from .row_changes import RowChanges
from .tangent_kernel import SMOOTH, Begin, Derivatives, Tangents, derive

EVENTS = (
    "", "waves from both sides arrive together", "a gap closes just as a wave arrives",
    "the contact is closed without force", "a front vanishes", "the bodies stay together",
    "there is no gap at first",
)
"""What may come otherwise on one of the sides; in the order of the kernel's names."""
POWERS = {
    "length": (0, 0, 1), "area": (0, 1, 0), "diameter": (0, 2, 0), "youngs_modulus": (0.5, 0.5, 0),
    "density": (-0.5, 0.5, 0), "wave_speed": (1, 1, 0),
}
"""To which power wave speed, impedance and length of a segment go with a number of it."""
FIELDS = (*POWERS, "gap", "velocity", "strain")
APART = 2.0**-20  # relative distance of the neighbours on both sides of a number
CONTINUOUS = 1e-9  # relative difference of values that is none
AGREE = 1e-6  # relative difference of the derivatives on both sides that is none
MEMBERS = 1024  # that are run as one
PLAIN = 5e-4  # s that a short member takes in plain Python, about
BEGIN = len(Begin._fields)  # columns that stay
FIRST = BEGIN + len(Results._fields)  # column of derivatives
ROW_NUMBERS = 11  # that a row of the log takes besides its derivatives


def gradient(
    system: System, of: str = "restitution", wrt: Sequence[str] = (), *,
    max_events: int = MAX_EVENTS, workers: int | None = None,
) -> Gradient:
    """Exact derivatives of what a collision adds up to, for what the method "fronts" can solve.

    Nothing is differenced: the derivatives follow the events of the collision. Where two events
    meet that a number moves apart, both sides are followed a millionth away, and derivatives are
    carried over from there, to eight digits or so.

    Parameters
    ----------
    system : System
        Of any shape. Rods whose velocity and strain do not jump; no driven ends.
    of : str
        ``"restitution"``, ``"velocity_after.1"`` (m/s, of a body), ``"impulse.0"`` (N s) or
        ``"duration.0"`` (s, of a contact). What an absorbing end slows down for ever has no
        velocity after.
    wrt : sequence of str
        Paths of a case file: ``"bodies.0.length"``, ``"contacts.0.gap"``,
        ``"materials.steel.wave_speed"``.
    max_events : int
        Cap for each collision.
    workers : int, optional
        Number of threads; default: the processors at hand.

    Returns
    -------
    Gradient
        In SI units; a member that has no such quantity, or is not followed to its end, has nan.

    Raises
    ------
    InvalidModel
        If there is no such quantity, a path is none of the system, or method "fronts" lacks
        something.
    UndefinedRestitution
        If a single collision has no such number.

    Examples
    --------
    Rods of one section: e is the ratio of their lengths.

    >>> import rodimpact as ri
    >>> left = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
    >>> g = ri.gradient(ri.System([left, right]), wrt=["bodies.0.length", "bodies.1.length"])
    >>> print(g)
    restitution = 0.4; its derivative by
      bodies.0.length: 1 1/m
      bodies.1.length: -0.4 1/m
    """
    Options(method="fronts", max_events=max_events).method_for(system)
    plan = Blueprint(Row(system))
    known, problems = places_of(system), _lacks(system)
    quantity = Quantity(system, plan, of, problems)
    if workers is not None:
        count(problems, "workers", workers)
    if not isinstance(wrt, list | tuple) or not wrt or not all(isinstance(p, str) for p in wrt):
        message = f"must be a list of paths, such as ['bodies.0.length'], got {shown(wrt)}"
        raise InvalidModel([*problems, ("wrt", message)])
    for path in wrt:
        if path not in known:
            message = f"{shown(path)} is no number of the system; {suggestion(path, known)}"
            problems.append(("wrt", message))
        elif path.rpartition(".")[2] not in FIELDS:
            fields = ", ".join(FIELDS)
            message = f"{path} is for other methods; derivatives are known for {fields}"
            problems.append(("wrt", message))
    if problems:
        raise InvalidModel(problems)
    places = [known[path] for path in wrt]
    shape, given = system.shape, table(plan.numbers, system.shape)
    have = numbers_of(system)
    numbers = table([have[place[0]] for place in places], shape)
    powers = np.array([_powers(plan, place) for place in places])

    def run(start: int, stop: int, fast: bool) -> list[Array]:
        return _both_sides(
            quantity, given[start:stop], _slopes(given[start:stop], numbers[start:stop], powers),
            max_events, fast)

    size = len(given)
    fast = kernels.worth_compiling(PLAIN * size * (1 + len(wrt)), lay_out_all, derive)
    if size <= MEMBERS:
        parts = [run(0, size, fast)]
    else:
        with pool_of(None, workers) as pool:
            starts = range(0, size, MEMBERS)
            jobs = [pool.executor.submit(run, i, min(i + MEMBERS, size), fast) for i in starts]
            parts = [job.result() for job in jobs]
    value, below, above, jump, event, when, where = (
        np.concatenate(part) for part in zip(*parts, strict=True))
    if not shape and math.isnan(value[0]):
        quantity.refuse(max_events)
    found = _gradient(of, tuple(wrt), shape, value, below, above, jump, event, when, where)
    unit = outcome(system, of).unit
    units = {path: _per(unit, parameter(system, path).unit) for path in wrt}
    return replace(found, unit="" if unit == "1" else unit, units=units)


def _per(unit: str, other: str) -> str:
    """Unit of a derivative."""
    above, below = (f"({u})" if "/" in u or " " in u else u for u in (unit, other or "1"))
    if unit == other:
        return ""
    return unit if below == "1" else f"{above}/{below}"


class Traced(NamedTuple):
    """What a run and the pass over its log say; [member] and [member, direction]."""

    value: Array
    slope: Array
    size: Array
    event: Array
    when: Array
    where: Array


class Quantity:
    """What is differentiated: reads it, and its derivatives, off the runs of some members."""

    def __init__(self, system: System, plan: Blueprint, of: Any, problems: Problems) -> None:
        self.system, self.plan, self.of, able = system, plan, of, unilateral(system)
        self.kind, _, number = str(of).partition(".")
        bodies = range(len(system.bodies))
        ending = [i for group in groups(system) if not _radiates(system, group) for i in group]
        choices = [f"velocity_after.{i}" for i in ending]
        choices += [f"{name}.{k}" for name in ("impulse", "duration") for k in able]
        if len(able) == 1 and {able[0], able[0] + 1} <= {*ending}:
            choices.append("restitution")
        if not isinstance(of, str) or of not in choices:
            known = ", ".join(choices)
            problems.append(("of", f"must be one of {known}, got {shown(of)}"))
            return
        self.i = int(number) if number else able[0]
        self._sources = [self._source(body) for body in bodies]

    def read(
        self, given: Array, slope: Array, results: Results, found: Derivatives,
        motion: tuple[Array, Array],
    ) -> tuple[Array, Array]:
        """Value [member] and derivatives [member, direction]; nan where the run is not final."""
        if self.kind in ("impulse", "duration"):
            node = self.plan.make.node[self.i]
            value = getattr(results, self.kind)[:, node]
            derivative = getattr(found, self.kind)[:, node]
        else:
            bodies = range(self.i, self.i + 2) if self.kind == "restitution" else (self.i,)
            before, after, d_before, d_after = zip(
                *(self._velocities(i, given, slope, results, motion) for i in bodies), strict=True)
            value, derivative = after[0], d_after[0]
            if self.kind == "restitution":
                episodes = results.episodes[:, self.plan.make.node[self.i]]
                value = effective_restitution(results.final, episodes, before, after)
                closing = (before[0] - before[1])[:, None]
                with np.errstate(all="ignore"):
                    derivative = (
                        d_after[1] - d_after[0] - value[:, None] * (d_before[0] - d_before[1])
                    ) / closing
        known = (results.flag == FINAL) & np.isfinite(value)
        return np.where(known, value, math.nan), np.where(known[:, None], derivative, math.nan)

    def refuse(self, max_events: int) -> None:
        """Say why a single collision has no such number."""
        outcome = solve(self.system, method="fronts", max_events=max_events).outcome
        if self.kind == "restitution":
            _ = outcome.restitution
        raise UndefinedRestitution(f"{self.of} is undefined: {outcome.status}")

    def _source(self, body: int) -> tuple[bool, int]:
        """Whether a body has the velocity of what holds it, and its place among the numbers.

        Else the segment whose velocity it has.
        """
        group = next(g for g in groups(self.system) if body in g)
        if grounds(self.system, group):
            return True, self.plan.make.profile[0 if group[0] == 0 else -1]
        return False, self.plan.row.spans[body][0]

    def _velocities(
        self, body: int, given: Array, slope: Array, results: Results, motion: tuple[Array, Array]
    ) -> tuple[Array, Array, Array, Array]:
        held, place = self._sources[body]
        if held:
            return (given[:, place],) * 2 + (slope[:, :, place],) * 2
        before, after = motion
        s = place - 1
        return results.before[:, place], results.after[:, place], before[:, s], after[:, s]


def _lacks(system: System) -> Problems:
    """What of a system has no derivatives here."""
    problems: Problems = []
    for i, body in enumerate(system.bodies):
        if isinstance(body, Rod):
            problems += [
                (f"bodies.{i}.{name}", "jumps; its derivatives are not known, give one number")
                for name in ("velocity", "strain") if isinstance(getattr(body, name), Steps)
            ]
    return problems


def _radiates(system: System, group: Sequence[int]) -> bool:
    """Whether a group of bodies is bonded to an absorbing end."""
    first, last = (isinstance(end, Absorbing) for end in system.ends)
    return (first and group[0] == 0) or (last and group[-1] == len(system.bodies) - 1)


def _powers(plan: Blueprint, places: Sequence[str]) -> Array:
    """To which power each number of a row goes with the number at these places."""
    make, powers = plan.make, np.zeros(len(plan.numbers))
    n, paths = make.size[0], plan.row.paths
    for place in places:
        owner, _, field = place.rpartition(".")
        owner = owner.removesuffix(".material")
        if field in POWERS:
            s = paths.index(owner) - 1
            powers[[s, n + s, 2 * n + s]] = POWERS[field]
        elif field == "gap":
            powers[3 * n + int(owner.split(".")[1])] = 1
        else:
            fixed = not isinstance(plan.row.system.ends[0], Free)
            powers[make.profile[int(owner.split(".")[1]) + fixed] + (field == "strain")] = 1
    return powers


def _slopes(given: Array, numbers: Array, powers: Array) -> Array:
    """Derivatives of the numbers of rows, [member, direction, number]."""
    x, y = numbers[:, :, None], given[:, None, :]
    ones = np.ones(np.broadcast_shapes(x.shape, y.shape))
    return powers * np.divide(y, x, out=ones, where=x != 0)


def _both_sides(
    quantity: Quantity, given: Array, slope: Array, max_events: int, fast: bool
) -> list[Array]:
    """Value [member], derivatives below and above [member, direction], and where they differ.

    That is: by how much the value jumps, which event comes otherwise, when and where.
    """
    make = quantity.plan.make
    here = _follow(quantity, given, slope, max_events, fast)
    sides, event = np.stack([here.slope, here.slope]), here.event.copy()
    jump = np.zeros_like(here.slope)
    member, p = np.nonzero(event != SMOOTH)
    if len(member):
        around, moved, value = given[member], slope[member, p], here.value[member]
        with np.errstate(divide="ignore"):  # of what does not move
            step = APART / here.size[member, p]
        h = np.stack([-step, step])
        there = around + h[..., None] * moved
        gaps = slice(3 * make.size[0], 3 * make.size[0] + len(make.node))
        outside = np.any(there[..., gaps] < 0, axis=-1)
        there = np.where(outside[..., None], around, there).reshape(-1, around.shape[1])
        beside = _follow(quantity, there, np.tile(moved, (2, 1))[:, None], max_events, fast)
        unclear = outside | (beside.event.reshape(h.shape) != SMOOTH)
        slopes = np.where(unclear, math.nan, beside.slope.reshape(h.shape))
        values = beside.value.reshape(h.shape)
        moves = h * slopes
        limits = values - moves
        whole = np.abs(limits - value) <= CONTINUOUS * (
            np.abs(limits) + np.abs(value) + np.abs(moves) / APART)
        limits = np.where(whole, value, limits)
        # of a parabola through the value here, and value and slope there
        sides[:, member, p] = np.where(whole, 2 * (values - value) / h - slopes, slopes)
        jump[member, p] = limits[1] - limits[0]
        (b, a), size = sides[:, member, p], np.abs(value) * APART / step
        alike = np.abs(a - b) <= AGREE * (np.abs(a) + np.abs(b) + size)
        event[member, p] = np.where(alike & (jump[member, p] == 0), SMOOTH, event[member, p])
    return [here.value, *sides, jump, event, here.when, here.where]


def _follow(
    quantity: Quantity, given: Array, slope: Array, max_events: int, fast: bool
) -> Traced:
    """Run members and go through their logs."""
    plan, (count, P, _) = quantity.plan, slope.shape
    n = plan.make.size[0]
    results, changes = space(count, n), RowChanges(plan.make, plan.status, given, slope)
    widths = [(n + 1, P), (n + 1, P), (P,), (P,), (P,)]
    kinds = [np.float64] * 2 + [np.int64, np.float64, np.int64]
    columns: list[Any] = [
        np.zeros((count, *width), kind) for width, kind in zip(widths, kinds, strict=True)]
    found, waiting, room = Derivatives(*columns), np.arange(count), ROOM
    while len(waiting):
        seconds = PLAIN * len(waiting) * room / ROOM
        fast = fast or (room > ROOM and kernels.worth_compiling(seconds, lay_out_all, derive))
        what = f"following {room} fronts of a member"
        ask((ROW_NUMBERS + 2 * P) * room, "max_events", what, "lower the cap")
        which: Any = slice(None)
        some = changes
        if len(waiting) < count:
            which = waiting
            some = RowChanges(plan.make, plan.status, given[waiting], slope[waiting])
        parts = [column[which] for column in (*results, *found)]
        full = _trace(plan, given[which], some, room, max_events, fast, parts)
        if len(waiting) < count:
            for column, part in zip((*results, *found), parts, strict=True):
                column[waiting] = part
        waiting, room = waiting[full], 8 * room
    motion = changes.motion(results, found)
    value, derivative = quantity.read(given, slope, results, found, motion)
    return Traced(value, derivative, changes.size, found.event, found.when, found.where)


def _trace(
    plan: Blueprint, given: Array, changes: RowChanges, room: int, max_events: int, fast: bool,
    columns: Sequence[Array],
) -> Array:
    """Fill in the columns of results and derivatives of members; return which filled the log."""
    block = Block(plan, room, None, fast)
    members = block.lay_out(given)
    n, P, rows = plan.make.size[0], columns[-1].shape[1], len(block.state[2].tick)
    x = Tangents(*([0.0] * (size * P) for size in (n + 2,) * 2 + (n + 1,) * 6
                   + (2 * n + 4,) * 2 + (rows,) * 2 + (1,) * 2))
    kernel: Any = derive
    status = block.status(members)
    flat: list[Any] = [column.reshape(-1) for column in (*changes.begin(), *columns)]
    if fast:
        kernel, x = kernels.compiled(derive), Tangents(*map(np.array, x))
    else:
        flat = [column.tolist() for column in flat]
    results, found = Results(*flat[BEGIN:FIRST]), Derivatives(*flat[FIRST:])
    kernel(Begin(*flat[:BEGIN]), *block.state, block.stocks, members, status, max_events, results,
           x, found)
    if not fast:
        for column, values in zip(columns, flat[BEGIN:], strict=True):
            column[...] = np.reshape(values, column.shape)
    return np.asarray((np.asarray(block.fates) == LAID) & (columns[0] == FULL))


def _gradient(
    of: str, wrt: tuple[str, ...], shape: tuple[int, ...], value: Array, below: Array,
    above: Array, jump: Array, event: Array, when: Array, where: Array,
) -> Gradient:
    """Lay out the result: one number where both sides agree."""
    kinked = event != SMOOTH

    def shaped(column: Array) -> Any:
        return column.reshape(shape)[()]

    values, one_sided, kinks = {}, {}, {}
    for p, path in enumerate(wrt):
        k, sides = kinked[:, p], (shaped(below[:, p]), shaped(above[:, p]))
        values[path] = shaped(np.where(k, math.nan, (below[:, p] + above[:, p]) / 2 + 0.0))
        one_sided[path] = sides
        if k.any():
            kinks[path] = Kink(
                sides[0], sides[1], shaped(np.where(k, jump[:, p], 0.0)),
                shaped(np.where(k, when[:, p], math.nan)), shaped(np.where(k, where[:, p], -1)),
                shaped(np.where(k, np.array(EVENTS)[event[:, p]], "")),
            )
    return Gradient(of, wrt, shaped(value), values, one_sided, kinks)
