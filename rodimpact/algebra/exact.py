"""exact(): a collision in fractions; and how formulas run a row on exact numbers.

Both are runs of the kernel of the method "fronts".

What the mechanics is made of are transit times T and impedances Z. They follow from lengths, areas
and materials, or are given themselves, as if they stood in the case: `bodies.0.transit_time`,
`bodies.0.impedance`.
"""

import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any, NamedTuple

from ..methods.abilities import needs
from ..methods.fronts import energy
from ..methods.fronts.family_layout import lay_out_family
from ..methods.fronts.simulation import Simulation, start_simulation
from ..methods.groups import grounds, groups, unilateral
from ..methods.laws import Status, Stop
from ..methods.registry import count
from ..methods.row import Row
from ..methods.walk import walk
from ..model import Bonded, Free, Rod, Steps, System, Wall
from ..model.arguments import of_kind
from ..model.frozen import InvalidModel, Problems, raise_noted
from ..model.paths import places_of, suggestion
from ..progress import ProgressFunction, check_progress
from ..units import shown
from .numbers import ZERO, Number

MOST_EVENTS = 5_000
TICKS = (
    1 << 20
)  # in the shortest transit: the kernel waits a tick where it waits to prove


class Numbers(NamedTuple):
    """What the mechanics needs to know."""

    transit: list[Number]  # [segment]
    impedance: list[Number]  # [segment]
    velocity: list[Number]  # [body]
    gap: list[Number]  # [contact]


class Exact(NamedTuple):
    """A collision in fractions: nothing in it is rounded.

    Attributes
    ----------
    restitution : Fraction or None
        e; None where not exactly one contact can open, or nothing collides.
    velocities_after : tuple of Fraction
        Of the centres of mass, m/s.
    impulses : tuple of Fraction
        At each contact, N s; at a bond its average, as vibration goes on.
    contact_times : tuple of tuple of (Fraction, Fraction)
        At each contact, when its force began and ended, in units of `time_unit`.
    time_unit : float
        s. It is 1 if wave speeds are rational or transit times are given. Otherwise it is the time
        in which a wave runs 1 m in the first rod. Only this number may be rounded.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> found = ri.exact(ri.System([left, right]))
    >>> found.velocities_after
    (Fraction(0, 1), Fraction(2, 5))
    """

    restitution: Any
    velocities_after: tuple[Any, ...]
    impulses: tuple[Any, ...]
    contact_times: tuple[tuple[tuple[Any, Any], ...], ...]
    time_unit: float = 1.0


def exact(
    system: System,
    values: Mapping[str, Any] | None = None,
    *,
    max_events: int = MOST_EVENTS,
) -> Exact:
    """Solve a collision in fractions.

    Numbers are taken as they are written: 0.1 is one tenth. What enters the mechanics are transit
    times, impedances, velocities and gaps. Wave speeds sqrt(E/rho) need not be rational, only
    their ratios: time is then measured by the first of them. With gaps they must be rational.

    Parameters
    ----------
    system : System
        Uniform or stepped rods, free or against walls, in rigid or bonded contact; no family.
    values : mapping, optional
        Fractions, whole numbers or texts such as ``"1/3"`` in place of numbers of the system, by
        their paths, such as ``bodies.0.length``; also ``bodies.0.transit_time``, s, and
        ``bodies.0.impedance``, kg/s, in place of lengths, areas and materials.
    max_events : int
        Cap.

    Raises
    ------
    InvalidModel
        If a number is not rational, or something acts of which this method knows nothing; if the
        collision is not over after `max_events`.

    Examples
    --------
    >>> import rodimpact as ri
    >>> left = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
    >>> exact(ri.System([left, right])).restitution
    Fraction(2, 5)
    """
    check(system)
    check_arguments(max_events=max_events)
    row, places = walk(system), places_of(system)
    given = {
        place: value
        for path, value in fractions_of(values).items()
        for place in places.get(path, [path])
    }

    known: dict[str, None] = {}
    squares: dict[str, Fraction] = {}  # of wave speeds, by the paths of segments

    def take(path: str, value: Any) -> Any:
        known[path] = None
        if path in given:
            return Number(given[path])
        follows = path.endswith((".transit_time", ".impedance"))
        return None if follows else Number(written(value))

    def material(s: Any, path: str) -> tuple[Number, Number]:
        E, rho = (
            take(f"{path}.material.{name}", getattr(s.material, name))
            for name in ("youngs_modulus", "density")
        )
        if E <= 0 or rho <= 0:
            raise InvalidModel([(f"{path}.material", "needs numbers above 0")])
        squares[path] = E.value / rho.value
        return Number(
            root(squares[path] / unit()) or 1
        ), rho  # what has no root is told below

    def unit() -> Fraction:
        """Square of the speed by which times are measured: 1 m/s, or that in the first rod."""
        first = next(iter(squares.values()), Fraction(1))
        return Fraction(1) if root(first) else first

    numbers = read(row, take, material)
    _check_speeds(row, squares, unit())
    known |= dict.fromkeys(path for path, at in places.items() if at[0] in known)
    unknown: Problems = [
        (path, f"is not a parameter of the system; {suggestion(path, known)}")
        for path in given
        if path not in known
    ]
    for name in ("transit", "impedance"):
        for path, x in zip(row.paths[1:], getattr(numbers, name), strict=True):
            if x <= 0:
                unknown.append((path, f"needs numbers above 0, got {name} {x.value}"))
    raise_noted(unknown)
    done = run(row, numbers, max_events)
    check_final(done, max_events)
    return each(done.results, lambda x: x.value)._replace(
        time_unit=float(unit()) ** -0.5
    )


def each(results: Exact, what: Callable[[Any], Any]) -> Exact:
    """Results with what `what` makes of each number."""

    def mapped(x: Any) -> Any:
        return (
            tuple(map(mapped, x))
            if isinstance(x, tuple)
            else None
            if x is None
            else what(x)
        )

    return Exact(*map(mapped, results[:-1]))


class ExactRun(NamedTuple):
    """A finished run of the kernel; its times are those of the model times `rate`."""

    row: Row
    nodes: list[int]
    numbers: Numbers
    rate: Fraction
    state: Simulation
    final: bool
    results: Exact  # of `Number`


def written(x: float) -> Fraction:
    """Return a number as it is written: 0.1 is one tenth."""
    return Fraction(repr(x))


def fractions_of(values: Any) -> dict[str, Fraction]:
    """Numbers that the user gave, by path."""
    given, problems = {}, Problems()
    if values is not None and not isinstance(values, Mapping):
        message = "must be numbers by path, such as {'bodies.0.length': '1/3'}"
        raise InvalidModel([("values", f"{message}, got {shown(values)}")])
    for path, value in (values or {}).items():
        if not isinstance(path, str):
            message = f"must be by paths such as 'bodies.0.length', got {shown(path)}"
            problems.append(("values", message))
            continue
        try:
            given[path] = (
                written(value) if isinstance(value, float) else Fraction(value)
            )
        except (ValueError, TypeError, ZeroDivisionError, OverflowError):
            problems.append(
                (path, f'must be a number or a text such as "1/3", got {shown(value)}')
            )
    raise_noted(problems)
    return given


def root(x: Fraction) -> Fraction | None:
    """Square root of a fraction, if it is one."""
    p, q = math.isqrt(x.numerator), math.isqrt(x.denominator)
    return Fraction(p, q) if Fraction(p * p, q * q) == x else None


def check_arguments(progress: bool | ProgressFunction = True, **caps: Any) -> None:
    """Raise InvalidModel unless caps are whole numbers above 0 and `progress` will do."""
    problems: Problems = []
    for name, value in caps.items():
        count(problems, name, value)
    check_progress(problems, progress)
    raise_noted(problems)


def check_final(done: ExactRun, max_events: int) -> None:
    """Raise InvalidModel for a run that came to its cap."""
    if not done.final:
        message = f"the collision is not over after {max_events} events; raise it"
        raise InvalidModel([("max_events", message)])


def check(system: System) -> None:
    """Raise InvalidModel where something has no exact numbers: that is told."""
    of_kind("system", system, System, "System([rod, Wall()])")
    problems: Problems = []
    if system.shape:
        problems.append(
            ("system", f"has members of shape {system.shape}; take one: system[0]")
        )
    found = [(path, f"know no {what}; leave it out") for path, what in needs(system)]
    found += [
        (
            f"bodies.{i}",
            "need a uniform velocity and no strain; put pieces of rod there",
        )
        for i, body in enumerate(system.bodies)
        if isinstance(body, Rod)
        and (isinstance(body.velocity, Steps) or body.strain != 0)
    ]
    found += [
        (f"ends.{side}", f"need Free(), got {type(end).__name__}(); leave it out")
        for side, end in zip(("left", "right"), system.ends, strict=True)
        if not isinstance(end, Free)
    ]
    found += [
        (f"contacts.{k}", "know no rod bonded to a wall; let it touch")
        for k, law in enumerate(system.contacts)
        if isinstance(law, Bonded) and Wall in map(type, system.bodies[k : k + 2])
    ]
    problems += [
        (path, f"formulas and fractions {wrong}, or solve()") for path, wrong in found
    ]
    raise_noted(problems)


def read(
    row: Row,
    take: Callable[[str, Any], Any],
    material: Callable[[Any, str], tuple[Number, Number]],
) -> Numbers:
    """Gather the numbers of a row.

    Parameters
    ----------
    row : Row
    take : callable
        Of a path and the number written there; None for a transit time or an impedance that
        follows from others.
    material : callable
        Wave speed and density of a segment at that path.
    """
    transit, impedance = [], []
    for s, path in zip(row.segments, row.paths[1:], strict=True):
        T = take(f"{path}.transit_time", s.transit_time)
        Z = take(f"{path}.impedance", s.impedance)
        if T is None:
            T = take(f"{path}.length", s.length) / material(s, path)[0]
        if Z is None:
            c, density = material(s, path)
            Z = density * take(f"{path}.area", s.area) * c
        transit.append(T)
        impedance.append(Z)
    system = row.system
    velocity = [
        take(f"bodies.{i}.velocity", body.velocity)
        for i, body in enumerate(system.bodies)
    ]
    gap = [take(f"contacts.{k}.gap", float(g)) for k, g in enumerate(system.gaps)]
    return Numbers(transit, impedance, velocity, gap)


def run(row: Row, numbers: Numbers, max_events: int = MOST_EVENTS) -> ExactRun:
    """Follow every front until the collision is proved to be over, or to the cap on events."""
    layout, n = lay_out_family(row), len(numbers.transit)
    nodes = layout.contacts
    shortest = min(float(T) for T in numbers.transit)
    rate = Fraction(2) ** (TICKS.bit_length() - math.frexp(shortest)[1])
    # transit times are lengths here: waves run 1 m in 1 s
    given = [*[1] * n, *numbers.impedance, *numbers.transit, ZERO, ZERO, *numbers.gap]
    given += [x for v in numbers.velocity for x in (v, ZERO)]  # and no strain
    ticks = [T * rate for T in numbers.transit]
    state = start_simulation(layout, given, ticks, 1 / rate, ZERO)
    final = state.run_to_proof(max_events, ZERO) == Stop.FINAL
    energy.update_motion(state)
    before, after = zip(
        *(motion(row, state, i) for i in range(len(row.spans))), strict=True
    )
    e, free = None, unilateral(row.system)
    if final and len(free) == 1 and state.nodes[nodes[free[0]]].episodes:
        k = free[0]
        if before[k] > before[k + 1]:
            e = (after[k + 1] - after[k]) / (before[k] - before[k + 1])
    impulses: list[Number] = []
    for i, (k, law) in enumerate(zip(nodes, row.system.contacts, strict=True)):
        impulses.append(state.nodes[k].impulse / rate)
        if isinstance(
            law, Bonded
        ):  # its force goes on for ever: what it comes to on average
            first, last = row.spans[i]
            mass = sum(
                (
                    numbers.transit[s - 1] * numbers.impedance[s - 1]
                    for s in range(first, last + 1)
                ),
                ZERO,
            )
            lost = mass * (numbers.velocity[i] - after[i])
            impulses[i] = lost + (impulses[i - 1] if i else ZERO)
    times: dict[int, list[Number]] = {
        k: [] for k in nodes
    }  # when force began and ended in turn
    for change in state.changes:
        at = times[change.next_row]
        if (change.value == Status.PRESS) != len(at) % 2:
            at.append((change.tick + ZERO) / rate)
    episodes = tuple(
        tuple(zip(at[::2], at[1::2], strict=False)) for at in times.values()
    )
    results = Exact(e, after, tuple(impulses), episodes)
    return ExactRun(row, nodes, numbers, rate, state, final, results)


def motion(row: Row, state: Simulation, body: int) -> tuple[Any, Any]:
    """Velocity of a body before and after: that of what holds it, or of its segments."""
    group = next(g for g in groups(row.system) if body in g)
    if grounds(row.system, group):
        return (state.lines[0 if group[0] == 0 else -1].incoming_wave,) * 2
    segment = state.segments[row.spans[body][0]]
    return segment.initial_group_velocity, segment.group_velocity


def _check_speeds(row: Row, squares: Mapping[str, Fraction], unit: Fraction) -> None:
    """Raise InvalidModel where a wave speed that matters is irrational, also by this unit."""
    odd = [path for path, square in squares.items() if root(square / unit) is None]
    timed = any(row.system.gaps) or len(squares) < len(row.segments)
    if odd or (timed and unit != 1):
        path, also = (
            [*odd, *squares][0],
            ", also relative to the first rod" if odd else "",
        )
        remedy = f"give {path}.transit_time and {path}.impedance, or take closed_form()"
        raise InvalidModel([(path, f"has an irrational wave speed{also}; {remedy}")])
