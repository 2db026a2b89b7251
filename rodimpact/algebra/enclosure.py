"""enclosure(): what a collision can come to while its numbers are known with tolerances."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from ..model import System
from ..model.frozen import InvalidModel, Problems, number
from ..units import dimension_of, format_si, parse, shown
from .covering import Covering
from .formula import Field
from .intervals import Bounds, around
from .naming import Naming, nearly_root
from .rational import root
from .rows import check_cap, written

UNITS = {
    "transit_time": "s", "impedance": "N s/m", "length": "m", "area": "m^2",
    "youngs_modulus": "Pa", "density": "kg/m^3", "velocity": "m/s", "gap": "m",
}
MOST_CELLS = 32


@dataclass(frozen=True)
class Enclosure:
    """What a collision can come to: bounds that no numbers within the tolerances leave.

    Attributes
    ----------
    restitution : (float, float) or None
        Lowest and highest e; None where it is undefined for some of the numbers.
    velocities_after : tuple of (float, float)
        Of the centres of mass, m/s.
    impulses : tuple of (float, float)
        At each contact, N s.
    durations : tuple of (float, float)
        How long each contact presses, s.
    formulas : int
        How many different histories there can be, each with a formula.
    tolerances : dict of str to (float, float)
        Lowest and highest value of each number, by path.
    """

    restitution: Bounds | None
    velocities_after: tuple[Bounds, ...]
    impulses: tuple[Bounds, ...]
    durations: tuple[Bounds, ...]
    formulas: int
    tolerances: dict[str, Bounds]

    def __str__(self) -> str:
        rows = [("e", self.restitution or (math.nan, math.nan), "")]
        for name, unit, of in (
            ("velocity after of body", "m/s", self.velocities_after),
            ("impulse at contact", "N s", self.impulses),
            ("duration of contact", "s", self.durations),
        ):
            rows += [(f"{name} {i}", bounds, unit) for i, bounds in enumerate(of)]
        return "\n".join(f"{name}: {format_si(low, unit, 9)} to {format_si(high, unit, 9)}"
                         for name, (low, high), unit in rows)


@np.errstate(under="ignore")  # bounds beside 0 are the smallest numbers there are
def enclosure(
    system: System, tolerances: Mapping[str, Any], *, most_cells: int = MOST_CELLS,
    max_events: int = 1000,
) -> Enclosure:
    """Bound the results of a collision whose numbers have tolerances.

    The bounds hold for all real numbers within the tolerances, whatever is rounded, and for as many
    formulas as meet there. On a border between two formulas the results are the limits of those on
    its sides, which the bounds hold as well.

    Parameters
    ----------
    system : System
        As for `closed_form`.
    tolerances : mapping
        By how much numbers can be larger or smaller than they are written, by the path of a number,
        such as ``bodies.0.length``, or by the last word of such paths, for all of these: in its
        unit, such as ``"0.1 mm"``, or as a share of it, ``"0.1 %"``. A modulus or a density that
        several rods have in common is one number.
    most_cells : int
        Cap on the histories.
    max_events : int
        Cap on the events of a run.

    Returns
    -------
    Enclosure

    Raises
    ------
    InvalidModel
        If a path names nothing, a tolerance is none, or something acts of which this method knows
        nothing; if it stays undecided which formulas hold within the tolerances, as beside numbers
        for which a collision does not end.
    ImportError
        Without SymPy, which the extra ``sympy`` brings.

    Examples
    --------
    >>> import rodimpact as ri
    >>> left = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
    >>> found = enclosure(ri.System([left, right]), {"length": "0.1 mm"})
    >>> [round(x, 5) for x in found.restitution]
    [0.39986, 0.40014]
    """
    check_cap("most_cells", most_cells)
    check_cap("max_events", max_events)
    if not isinstance(tolerances, Mapping) or not tolerances or not all(
            isinstance(path, str) for path in tolerances):
        message = 'must be tolerances by path, such as {"bodies.0.length": "0.1 mm"}'
        raise InvalidModel([("tolerances", f"{message}, got {shown(tolerances)}")])
    try:
        naming = Naming(system, list(tolerances))
    except InvalidModel as error:
        raise InvalidModel([("tolerances" if path == "symbols" else path, message)
                            for path, message in error.problems]) from None
    spans = _spans(naming, tolerances)
    covering = Covering(Field(naming), most_cells, max_events)
    restitution, velocities, impulses, durations = (
        tuple((min(low for low, _ in of), max(high for _, high in of))
              for of in zip(*parts, strict=True)) if all(parts) else ()
        for parts in zip(*covering.bounds({x: spans[x] for x in naming.leaves}), strict=True)
    )
    return Enclosure(
        restitution[0] if restitution else None, velocities, impulses, durations,
        len(covering.cells),
        {path: (float(spans[name][0]), float(spans[name][1]))
         for name, path in naming.paths.items()},
    )


def _spans(
    naming: Naming, tolerances: Mapping[str, Any]
) -> dict[str, tuple[Fraction, Fraction]]:
    """Lowest and highest value of each name, and of wave speeds."""
    problems: Problems = []
    sizes = {path: _size(problems, path, given) for path, given in tolerances.items()}
    spans: dict[str, tuple[Fraction, Fraction]] = {}
    for name, value in naming.base.items():
        path = naming.paths[name]
        word = path.rpartition(".")[2]
        key = naming.symbol_of(path)
        assert key is not None
        size, share = sizes[key]
        half = size * abs(value) if share else size
        if word != "velocity" and half >= value:
            message = f"must be below {path} itself, {float(value)!r}, got {float(half)!r}"
            problems.append((key, message))
        spans[name] = value - half, value + half
    if problems:
        raise InvalidModel(problems)
    for c, (E, rho) in naming.speeds.items():
        (low, high), (least, most) = (spans.get(x) or (Fraction(x), Fraction(x)) for x in (E, rho))
        spans[c] = _root(low / most)[0], _root(high / least)[1]
    return spans


def _size(problems: Problems, path: str, given: Any) -> tuple[Fraction, bool]:
    """A tolerance, and whether it is a share; 0 and a problem if it is none."""
    share = isinstance(given, str) and given.rstrip().endswith("%")
    unit = "" if share else UNITS[path.rpartition(".")[2]]
    if isinstance(given, str):
        try:
            given = parse(given, dimension_of(unit))
        except ValueError as error:
            problems.append((path, str(error)))
            return Fraction(0), share
    size = number(problems, path, given, unit, "non-negative")
    if isinstance(size, float):
        return Fraction(0) if math.isnan(size) else written(size), share
    problems.append((path, f"must be one number, got {shown(given)}"))
    return Fraction(0), share


def _root(square: Fraction) -> tuple[Fraction, Fraction]:
    """Fractions around a square root; twice itself if it is one."""
    exact = root(square)
    low, high = (exact, exact) if exact else around(nearly_root(square))
    return Fraction(low), Fraction(high)
