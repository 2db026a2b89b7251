"""Formulas derived by the front kernel on numbers that record their computation.

- Box 10.4: the coefficient of restitution of rods of one material and area is l1/l2.
- Pairs of Saint-Venant: the derived formula, at rational points of its cell, is
  compared with the sum of the steps of the force in fractions. The cell must be K T1 <
  T2 < (K + 1) T1, as in his theory.
- Rows of three rods: for equal impedances the formula must be T1/T3. For other
  impedances it is compared with runs on fractions.
- A stepped striker on a uniform rod is compared with runs on fractions.

Nothing is rounded anywhere, so the bounds are 0.

Source: textbook section 10.5, box 10.4; Saint-Venant 1867, see saint_venant.py.
"""

from fractions import Fraction
from itertools import product

import sympy

import rodimpact as ri

from .rational_proof import saint_venant
from .table import Case, Rows
from .unit import UNIT, rod

ZERO = Fraction(0)
FACTORS = [
    Fraction(98, 100),
    Fraction(101, 100),
]  # factors of the numbers of the system
T1, T2, T3, Z1, Z2, Z3 = sympy.symbols("T1:4 Z1:4", positive=True)


def run() -> Rows:
    """Compare the box, pairs, rows of three, a stepped striker."""
    yield from box()
    yield from pair((2, 5), (2, 3), {T1 < T2, Z1 < Z2})
    for K in (1, 2, 3):
        cell = {K * T1 < T2, T2 < (K + 1) * T1, Z2 < Z1}
        yield from pair((2, 2 * K + 1), (2, 1), cell)
    yield from three_equal_rods()
    yield from three_rods()
    yield from stepped_striker()


def box() -> Rows:
    """Formula and cell of rods of one material and area, lengths 2 : 5: e = l1/l2.

    The only inequality of the cell is l1 < l2. Rows count wrong results.
    """
    first = rod(2, velocity=1.0)
    second = rod(5)
    system = ri.System([first, second])
    form = ri.closed_form(system, ["length"])
    l1, l2 = sympy.symbols("l1 l2", positive=True)
    difference = one_unless_zero(form.restitution - l1 / l2)
    wrong = wrong_inequalities(form, {l1 < l2})
    case = Case(f"the box, e = {form.restitution}", "textbook, box 10.4: l1/l2")
    yield case.row("e - l1/l2", ZERO, difference, 0.0)
    yield case.row(
        "inequalities other than l1 < l2", ZERO, wrong, 0.0, source="Saint-Venant 1867"
    )


def pair(
    lengths: tuple[int, int], areas: tuple[int, int], cell: set[sympy.Expr]
) -> Rows:
    """e of a pair by its formula against Saint-Venant's, and the inequalities.

    e is compared at all products of the numbers with `FACTORS` that lie in the cell of
    the formula; the row counts wrong values. A second row counts the inequalities of
    the formula that differ from those in `cell`.
    """
    first_length, second_length = lengths
    first_area, second_area = areas
    first = rod(first_length, first_area, velocity=1.0)
    second = rod(second_length, second_area)
    system = ri.System([first, second])
    form = ri.closed_form(system)
    places = 0
    wrong = 0
    for factors in product(FACTORS, repeat=4):
        z1 = factors[0] * first_area
        t1 = factors[1] * first_length
        z2 = factors[2] * second_area
        t2 = factors[3] * second_length
        place = {"Z1": z1, "T1": t1, "Z2": z2, "T2": t2}
        if not form.holds(**place):  # outside the cell
            continue
        places += 1
        e = form.at(**place).restitution
        if e != saint_venant(z1, t1, z2, t2):
            wrong += 1
    name = f"pair, T {first_length} : {second_length}, Z {first_area} : {second_area}"
    case = Case(name, "Saint-Venant 1867")
    yield case.row(f"wrong ones of {places} places", ZERO, Fraction(wrong), 0.0)
    inequalities = ", ".join(sorted(map(str, cell)))
    quantity = f"inequalities other than {inequalities}"
    yield case.row(quantity, ZERO, wrong_inequalities(form, cell), 0.0)


def three_equal_rods() -> Rows:
    """Formulas of the velocities of three rods of one impedance: 0, 0 and T1/T3.

    All three transit times are equal there, so that other formulas meet this one.
    """
    first = rod(1, velocity=1.0)
    resting = rod(1)
    system = ri.System([first, resting, resting])
    form = ri.closed_form(system, ["transit_time"])
    case = Case("three rods of one impedance", "the pulse passes through")
    expected_velocities = (0, 0, T1 / T3)
    for i, expected in enumerate(expected_velocities):
        velocity = form.velocities_after[i]
        difference = one_unless_zero(velocity - expected)
        quantity = f"velocity of rod {i + 1} after - {expected}, where T1 < T3"
        yield case.row(quantity, ZERO, difference, 0.0)


def three_rods() -> Rows:
    """Formulas of three rods of different impedances, against runs on fractions.

    The first moves at 1, the others are at rest and touch. See `against_runs`.
    """
    first = rod(2, impedance=1, velocity=1.0)
    second = rod(3, impedance=2)
    third = rod(4, impedance=0.75)
    system = ri.System([first, second, third])
    symbols = ("transit_time", "impedance")
    paths = {}
    for letter, name in zip("TZ", symbols, strict=True):
        for i in range(3):
            paths[f"{letter}{i + 1}"] = f"bodies.{i}.{name}"
    case = "three rods, T 2 : 3 : 4, Z 1 : 2 : 3/4"
    yield from against_runs(case, system, paths, symbols)


def stepped_striker() -> Rows:
    """Formulas of a striker of two pieces on a plain rod, against runs on fractions.

    The striker moves at 1. Lengths have names, areas keep their values. See
    `against_runs`.
    """
    first = ri.Segment(3.1, 1, UNIT)
    second = ri.Segment(2, 3, UNIT)
    striker = ri.Rod(segments=[first, second], velocity=1.0)
    struck = rod(11.3, 2)
    system = ri.System([striker, struck])
    paths = {
        "l1": "bodies.0.segments.0.length",
        "l2": "bodies.0.segments.1.length",
        "l3": "bodies.1.length",
    }
    case = "striker of steps 3.1 and 2, areas 1 and 3, on 11.3, area 2"
    yield from against_runs(case, system, paths, ("length",))


def against_runs(
    name: str, system: ri.System, paths: dict[str, str], symbols: tuple[str, ...]
) -> Rows:
    """Results by formula against those of runs on fractions, at points of the cell.

    The first three numbers of the system are multiplied by factors near 1, in all
    combinations; points outside the cell are left out. The row counts wrong points.
    """
    form = ri.closed_form(system, symbols)
    varied = list(paths)[:3]
    places = 0
    wrong = 0
    for factors in product(FACTORS, repeat=3):
        values = dict(form.values)
        for symbol, factor in zip(varied, factors, strict=True):
            values[symbol] = form.values[symbol] * factor
        if not form.holds(**values):
            continue
        places += 1
        numbers = {paths[symbol]: value for symbol, value in values.items()}
        if form.at(**values) != ri.exact(system, numbers):
            wrong += 1
    case = Case(name, "run on fractions")
    yield case.row(f"wrong ones of {places} places", ZERO, Fraction(wrong), 0.0)


def one_unless_zero(x: sympy.Expr) -> Fraction:
    """0 for an expression that vanishes, else 1, in exact arithmetic."""
    if sympy.simplify(x) == 0:
        return Fraction(0)
    return Fraction(1)


def wrong_inequalities(form: ri.ClosedForm, cell: set[sympy.Expr]) -> Fraction:
    """Number of inequalities that only the form's cell or only the given cell has."""
    difference = set(form.cell) ^ cell
    return Fraction(len(difference))
