"""exact(): a collision in fractions, from the numbers as they are written."""

import math
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from ..methods.row import Row
from ..model import System
from ..model.frozen import InvalidModel, Problems, raise_noted
from ..model.paths import places_of, suggestion
from ..units import shown
from .numbers import Number
from .rows import MOST_EVENTS, Exact, check, check_arguments, check_final, each, read, run, written


def exact(
    system: System, values: Mapping[str, Any] | None = None, *, max_events: int = MOST_EVENTS
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
    row, places = Row(system), places_of(system)
    given = {place: value for path, value in fractions_of(values).items()
             for place in places.get(path, [path])}

    def take(path: str, value: float) -> Number | None:
        known[path] = None
        if path in given:
            return Number(given[path])
        follows = path.endswith((".transit_time", ".impedance"))
        return None if follows else Number(written(value))

    speeds, unit = _wave_speeds(row, given)
    known = dict.fromkeys(f"{path}.material.youngs_modulus" for path in speeds)
    numbers = read(row, take, lambda path: Number(speeds[path]))
    known |= dict.fromkeys(path for path, at in places.items() if at[0] in known)
    unknown: Problems = [
        (path, f"is not a parameter of the system; {suggestion(path, known)}")
        for path in given if path not in known
    ]
    for name in ("transit", "impedance"):
        for path, x in zip(row.paths[1:], getattr(numbers, name), strict=True):
            if x <= 0:
                unknown.append((path, f"needs numbers above 0, got {name} {x.value}"))
    if unknown:
        raise InvalidModel(unknown)
    done = run(row, numbers, max_events)
    check_final(done, max_events)
    return each(done.results, lambda x: x.value)._replace(time_unit=unit)


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
            given[path] = written(value) if isinstance(value, float) else Fraction(value)
        except (ValueError, TypeError, ZeroDivisionError, OverflowError):
            problems.append((path, f'must be a number or a text such as "1/3", got {shown(value)}'))
    raise_noted(problems)
    return given


def root(x: Fraction) -> Fraction | None:
    """Square root of a fraction, if it is one."""
    p, q = math.isqrt(x.numerator), math.isqrt(x.denominator)
    return Fraction(p, q) if Fraction(p * p, q * q) == x else None


def _wave_speeds(row: Row, given: Mapping[str, Fraction]) -> tuple[dict[str, Fraction], float]:
    """Wave speeds by path, and the unit of time in which they are rational, s."""
    squares: dict[str, Fraction] = {}
    for s, path in zip(row.segments, row.paths[1:], strict=True):
        if not {f"{path}.transit_time", f"{path}.impedance"} <= set(given):
            E, rho = (
                given.get(f"{path}.material.{name}", written(getattr(s.material, name)))
                for name in ("youngs_modulus", "density")
            )
            squares[path] = E / rho
    first = next(iter(squares.values()), Fraction(1))
    absolute = root(first) is not None
    reference = Fraction(1) if absolute else first
    speeds: dict[str, Any] = {path: root(square / reference) for path, square in squares.items()}
    odd = [path for path, c in speeds.items() if c is None]
    timed = any(row.system.gaps) or len(squares) < len(row.segments)
    if odd or (timed and not absolute):
        path, message = [*odd, *squares][0], "has an irrational wave speed"
        if odd:
            message += ", also relative to the first rod"
        remedy = f"give {path}.transit_time and {path}.impedance, or take closed_form()"
        raise InvalidModel([(path, f"{message}; {remedy}")])
    return speeds, 1.0 if absolute else float(first) ** -0.5
