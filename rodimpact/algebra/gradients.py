"""gradient(): how what a collision adds up to changes with the numbers of its system.

A collision is followed on numbers with derivatives. Where it meets a tie, and in large families, it
is differenced on either side, and extrapolated to steps of no length.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..methods.fronts.family_layout import lay_out_family
from ..methods.groups import unilateral
from ..methods.registry import Options
from ..methods.row import Array, Row, largest
from ..methods.run import MAX_EVENTS
from ..model import Steps, System
from ..model.frozen import Problems, nearest, raise_noted
from ..model.paths import numbers_of, places_of, suggestion, with_numbers
from ..results.labels import outcome, parameter
from ..results.outcome import UndefinedRestitution
from ..running.solving import solve
from ..running.sweeping import sweep
from ..units import format_si, shown
from .following import EVENTS, NO_TIE, SMOOTH, Followed, ending

STRAIGHT = ("gap", "velocity", "strain")
"""Numbers of a row themselves; the numbers of a row go with powers of the others."""
FIELDS = (
    "length",
    "area",
    "diameter",
    "youngs_modulus",
    "density",
    "wave_speed",
    *STRAIGHT,
)
FEW = 64  # members that are followed one by one
STEPS = 2.0 ** -np.arange(10.0, 19.0)  # of differences, relative
AGREE = 1e-6  # relative difference of the derivatives on both sides that is none
CONTINUOUS = 1e-9  # relative difference of values that is none


class Kink(NamedTuple):
    """A place where a derivative differs on both sides, or is known on one side only.

    Each attribute is a number, or an array of the shape of a family.

    Attributes
    ----------
    below, above : float
        Derivatives on the side of smaller and of larger numbers; nan on a side that does not exist,
        such as below a gap of 0.
    jump : float
        The quantity above minus the quantity below.
    time : float
        Time of the first event that differs between the sides, s; nan without a kink.
    node : int
        Place of this event: 0 is the left end of the row, then come the joints of its segments.
    event : str
        What happens there; empty without a kink.

    Examples
    --------
    At equal lengths e = l1/l2 below and e = l2/l1 above:

    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> rods = [ri.Rod(1.0, area=1e-4, material=steel, velocity=v) for v in (1.0, 0.0)]
    >>> kink = ri.gradient(ri.System(rods), wrt=["bodies.0.length"]).kinks["bodies.0.length"]
    >>> round(float(kink.below), 6), round(float(kink.above), 6)
    (1.0, -1.0)
    """

    below: Any
    above: Any
    jump: Any
    time: Any
    node: Any
    event: Any


@dataclass(frozen=True)
class Gradient:
    """Derivatives of a result of a collision; as an array, [..., path].

    Attributes
    ----------
    of : str
    wrt : tuple of str
    value : float or array
        Of the quantity.
    values : dict of str to float or array
        Derivative by path, where it is the same on both sides; else nan.
    one_sided : dict of str to (float or array, float or array)
        Derivatives below and above each number.
    kinks : dict of str to Kink
        By the paths that have any.
    unit : str
        Of the quantity; "" if it has none.
    units : dict of str to str
        Of each derivative, by path.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> slopes = ri.gradient(ri.System([left, right]), wrt=["bodies.0.length"])
    >>> round(float(slopes["bodies.0.length"]), 9), slopes.units["bodies.0.length"]     # e = l1/l2
    (1.0, '1/m')
    """

    of: str
    wrt: tuple[str, ...]
    value: Any
    values: Mapping[str, Any]
    one_sided: Mapping[str, tuple[Any, Any]]
    kinks: Mapping[str, Kink]
    unit: str
    units: Mapping[str, str]

    def __array__(self, dtype: Any = None, copy: Any = None) -> Array:
        return np.stack([self.values[path] for path in self.wrt], -1).astype(
            dtype or float
        )

    def __getitem__(self, path: str) -> Any:
        if not isinstance(path, str) or path not in self.values:
            raise KeyError(f"no derivative by {shown(path)}; {nearest(path, self.wrt)}")
        return self.values[path]

    def __str__(self) -> str:
        if np.ndim(self.value):
            found = f"of {np.size(self.value)} members, by {', '.join(self.wrt)}"
            return f"derivatives of {self.of} {found}"
        value = f"{self.value:.10g} {self.unit}".rstrip()
        lines = [f"{self.of} = {value}; its derivative by"]
        for path in self.wrt:
            below, above = self.one_sided[path]
            unit = f" {self.units[path]}" if self.units[path] else ""
            text = f"{self.values[path]:.8g}{unit}"
            if path in self.kinks:
                kink = self.kinks[path]
                text = f"{below:.8g} below, {above:.8g} above{unit}: {kink.event}"
                text += f" (node {kink.node}, {format_si(kink.time, 's')})"
            lines.append(f"  {path}: {text}".rstrip())
        return "\n".join(lines)


def gradient(
    system: System,
    of: str = "restitution",
    wrt: Sequence[str] = (),
    *,
    max_events: int = MAX_EVENTS,
    workers: int | None = None,
) -> Gradient:
    """Exact derivatives of results of a collision, for systems that the method "fronts" can solve.

    The derivatives follow the events of the collision and are exact to round-off. If two events
    happen at one time, finite differences are taken on both sides, right to eight digits or more.
    Families of more than 64 members use finite differences as well. Members where the differences
    on both sides disagree are followed one by one.

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
    _check(system, of, wrt)

    def totals(family: System) -> Array:
        found = sweep(family, "fronts", max_events=max_events, workers=workers).columns
        return np.where(found["final"], found[of], math.nan)

    value = totals(system)
    if not system.shape and math.isnan(value):
        known = solve(system, method="fronts", max_events=max_events).outcome
        why = known.why_no_restitution() if of == "restitution" else ""
        raise UndefinedRestitution(why or f"{of} is undefined: {known.status}")
    # below, above, jump, time, node, event
    none = np.reshape([math.nan, math.nan, 0.0, *NO_TIE], (6, 1, *[1] * value.ndim))
    table, followed = none + np.zeros((len(wrt), *value.shape)), np.isfinite(value)
    if value.size > FEW:
        numbers = _numbers(system, wrt)
        with np.errstate(all="ignore"):  # of members in which nothing moves
            sides = np.array([x.differences(totals, value) for x in numbers])
        table[:2] = sides[:, :2].mean(axis=1)
        followed &= ~np.all(sides[:, 3], axis=0)
    for at in map(tuple, np.argwhere(followed)):
        table[:, :, *at] = _follow(_numbers(system[at], wrt), of, max_events, totals)
    return _gradient(system, of, tuple(wrt), value, table)


class _Number(NamedTuple):
    """A number of a system, or of each member of a family."""

    system: System
    places: list[str]
    field: str
    x: Any
    size: Any  # by which its changes are measured

    def changed(self, by: Any) -> System:
        """The system in which it is larger."""
        return with_numbers(self.system, dict.fromkeys(self.places, self.x + by))

    def changes(self) -> Array:
        """How the numbers of a row change with this one, per change by its size."""
        y, there = (
            np.array(lay_out_family(Row(system)).values)
            for system in (self.system, self.changed(self.size))
        )
        with np.errstate(all="ignore"):  # of what is 0, and does not change
            power = (
                np.round(2 * np.log2(there / y)) / 2
            )  # the size of these is the number itself
        return np.asarray(
            there - y if self.field in STRAIGHT else np.nan_to_num(power * y)
        )

    def differences(self, totals: Callable[[System], Array], value: Any) -> Array:
        """Derivatives below and above, by how much the value jumps, and whether it is smooth.

        It is smooth if the derivatives are the same and it does not jump: [4, *shape].
        """
        sign = np.reshape([-1.0, 1.0], (2, *[1] * len(self.system.shape)))
        steps = np.multiply.outer(STEPS, sign) * self.size
        able = (self.field != "gap") | (
            self.x + steps >= 0
        )  # there is one side of no gap
        y = np.where(able, totals(self.changed(np.where(able, steps, 0.0))), math.nan)
        below, above = _limit(np.diff(y, axis=0) / np.diff(steps, axis=0))
        (jump,) = np.diff(_limit(y), axis=0)
        most = np.abs(below) + np.abs(above) + np.abs(value) / self.size
        whole = np.abs(jump) <= CONTINUOUS * np.abs(value)
        return np.array(
            [below, above, jump, whole & (np.abs(above - below) <= AGREE * most)]
        )


def _numbers(system: System, paths: Sequence[str]) -> list[_Number]:
    """The numbers at some paths."""
    row, known, have, found = Row(system), places_of(system), numbers_of(system), []
    c, T = (
        largest([getattr(s, name) for s in row.segments])
        for name in ("wave_speed", "transit_time")
    )
    for path in paths:
        x, field = have[known[path][0]], path.rpartition(".")[2]
        sizes = {
            "velocity": row.scale,
            "strain": row.scale / c,
            "gap": np.where(x == 0, row.scale * T, x)[()],
        }
        found.append(
            _Number(system, known[path], field, x, sizes.get(field, np.abs(x)))
        )
    return found


def _limit(y: Array) -> Array:
    """What tends to a limit as steps are halved, extrapolated: of the windows that agree best."""
    for n in (1, 2, 3):
        y = (2**n * y[1:] - y[:-1]) / (2**n - 1)
    apart = np.nan_to_num(np.abs(np.diff(y, axis=0)), nan=math.inf)
    best = np.argmin(apart, axis=0, keepdims=True)
    return np.asarray(np.take_along_axis(y, best, axis=0)[0])


def _follow(
    numbers: Sequence[_Number],
    of: str,
    max_events: int,
    totals: Callable[[System], Array],
) -> Array:
    """Columns of one member: [6, path]."""
    changes = np.transpose([x.changes() for x in numbers])
    one, columns = Followed(numbers[0].system, changes, max_events), []
    found = one.quantity(of)
    for p, x in enumerate(numbers):
        below = above = (found.d + np.zeros(len(numbers)))[p] / x.size
        jump, tie = 0.0, one.ties[:, p]
        if tie[2] != SMOOTH:
            below, above, jump, smooth = x.differences(totals, found.value)
            jump *= abs(jump) > CONTINUOUS * abs(found.value)
            if smooth:
                jump, tie = 0.0, NO_TIE
        columns.append([below, above, jump, *tie])
    return np.transpose(columns)


def _check(system: System, of: Any, wrt: Any) -> None:
    """Raise InvalidModel for what has no derivatives."""
    problems: Problems = [
        (
            f"bodies.{i}.{name}",
            "jumps, and its derivatives are not known; give one number",
        )
        for i, body in enumerate(system.bodies)
        for name in ("velocity", "strain")
        if isinstance(getattr(body, name, 0.0), Steps)
    ]
    lasting, able = ending(system), unilateral(system)
    choices = [f"velocity_after.{i}" for i in sorted(lasting)]
    choices += [f"{name}.{k}" for name in ("impulse", "duration") for k in able]
    if len(able) == 1 and {able[0], able[0] + 1} <= lasting:
        choices.append("restitution")
    if not isinstance(of, str) or of not in choices:
        problems.append(("of", f"must be one of {', '.join(choices)}, got {shown(of)}"))
    known = places_of(system)
    if (
        not isinstance(wrt, list | tuple)
        or not wrt
        or not all(isinstance(p, str) for p in wrt)
    ):
        message = (
            f"must be a list of paths, such as ['bodies.0.length'], got {shown(wrt)}"
        )
        problems.append(("wrt", message))
        wrt = ()
    for path in wrt:
        if path not in known:
            message = (
                f"the system has no parameter {shown(path)}; {suggestion(path, known)}"
            )
            problems.append(("wrt", message))
        elif path.rpartition(".")[2] not in FIELDS:
            message = f"{path} is for other methods; derivatives are known for {', '.join(FIELDS)}"
            problems.append(("wrt", message))
    raise_noted(problems)


def _gradient(
    system: System, of: str, wrt: tuple[str, ...], value: Array, table: Array
) -> Gradient:
    """Lay out the result: one number where both sides agree."""
    values, one_sided, kinks, units = {}, {}, {}, {}
    unit = outcome(system, of).unit
    for path, column in zip(wrt, np.moveaxis(table, 1, 0), strict=True):
        kink = Kink(*(x[()] for x in column))
        smooth = np.equal(kink.event, SMOOTH)
        values[path] = np.where(smooth, (kink.below + kink.above) / 2 + 0.0, math.nan)[
            ()
        ]
        one_sided[path], units[path] = (
            kink[:2],
            _per(unit, parameter(system, path).unit),
        )
        if not smooth.all():
            event = np.take(EVENTS, np.int64(kink.event))
            kinks[path] = kink._replace(node=np.int64(kink.node), event=event)
    unit = "" if unit == "1" else unit
    return Gradient(of, wrt, value[()], values, one_sided, kinks, unit, units)


def _per(unit: str, other: str) -> str:
    """Unit of a derivative."""
    above, below = (
        f"({u})" if "/" in u or " " in u else u for u in (unit, other or "1")
    )
    if unit == other:
        return ""
    return unit if below == "1" else f"{above}/{below}"
