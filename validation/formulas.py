"""Formulas derived by the front kernel on numbers that remember how they were made.

- The box: the coefficient of restitution of rods of one material and area is l1/l2.
- Saint-Venant's pairs: the derived formula, at rational places throughout its cell, against the sum
  of the force's steps in fractions; and the cell is K T1 < T2 < (K + 1) T1, as in his theory.
- Rows of three rods: T1/T3 of equal impedances; any impedances against runs on fractions.
- A stepped striker on a plain rod, against runs on fractions.

Nothing is rounded anywhere, so the bounds are 0.

Source: textbook section 10.5, box 10.4; Saint-Venant 1867, see saint_venant.py.
"""

from fractions import Fraction
from itertools import product

import sympy

import rodimpact as ri

from .rational_proof import saint_venant
from .table import Case, Row, Rows
from .unit import UNIT, rod

SHARES = [Fraction(98, 100), Fraction(101, 100)]  # of the numbers of the system
T1, T2, T3, Z1, Z2, Z3 = sympy.symbols("T1:4 Z1:4", positive=True)


def run() -> Rows:
    """The box, pairs, rows of three, a stepped striker."""
    return box(), pairs(), rows(), stepped()


def box() -> Rows:
    """Rods of 2 : 5."""
    form = ri.closed_form(ri.System([rod(2, velocity=1.0), rod(5)]), ["length"])
    l1, l2 = sympy.symbols("l1 l2", positive=True)
    case = Case(f"the box, e = {form.restitution}", "textbook, box 10.4: l1/l2")
    yield case.row("e - l1/l2", Fraction(0), fraction(form.restitution - l1 / l2), 0.0)
    yield case.row(
        "inequalities other than l1 < l2",
        Fraction(0),
        wrong(form, {l1 < l2}),
        0.0,
        "Saint-Venant 1867",
    )


def pairs() -> Rows:
    """A longer rod of higher impedance, and some of lower impedance."""
    for lengths, areas, cell in [
        ((2, 5), (2, 3), {T1 < T2, Z1 < Z2}),
        *(
            ((2, 2 * K + 1), (2, 1), {K * T1 < T2, T2 < (K + 1) * T1, Z2 < Z1})
            for K in (1, 2, 3)
        ),
    ]:
        system = ri.System([rod(lengths[0], areas[0], 1.0), rod(lengths[1], areas[1])])
        form = ri.closed_form(system)
        case = Case(
            f"pair, T {lengths[0]} : {lengths[1]}, Z {areas[0]} : {areas[1]}",
            "Saint-Venant 1867",
        )
        inside = apart = 0
        for shares in product(SHARES, repeat=4):
            z1, t1, z2, t2 = (
                share * x
                for share, x in zip(
                    shares, (areas[0], lengths[0], areas[1], lengths[1]), strict=True
                )
            )
            if form.holds(Z1=z1, T1=t1, Z2=z2, T2=t2):
                inside += 1
                e = form.at(Z1=z1, T1=t1, Z2=z2, T2=t2).restitution
                apart += e != saint_venant(z1, t1, z2, t2)
        yield case.row(
            f"wrong ones of {inside} places", Fraction(0), Fraction(apart), 0.0
        )
        yield case.row(
            "inequalities other than " + ", ".join(sorted(map(str, cell))),
            Fraction(0),
            wrong(form, cell),
            0.0,
        )


def rows() -> Rows:
    """Three equal rods, and three of different impedances."""
    form = ri.closed_form(
        ri.System([rod(1, velocity=1.0), rod(1), rod(1)]), ["transit_time"]
    )
    case = Case("three rods of one impedance", "the pulse passes through")
    for i, (v, expected) in enumerate(
        zip(form.velocities_after, (0, 0, T1 / T3), strict=True)
    ):
        yield case.row(
            f"velocity of rod {i + 1} after - {expected}, where T1 < T3",
            Fraction(0),
            fraction(v - expected),
            0.0,
        )
    system = ri.System([rod(2, 1, 1.0), rod(3, 2), rod(4, 0.75)])
    paths = {
        f"{letter}{i + 1}": f"bodies.{i}.{name}"
        for letter, name in (("T", "transit_time"), ("Z", "impedance"))
        for i in range(3)
    }
    yield against_runs(
        "three rods, T 2 : 3 : 4, Z 1 : 2 : 3/4",
        system,
        paths,
        ("transit_time", "impedance"),
    )


def stepped() -> Rows:
    """A striker of two pieces."""
    pieces = [ri.Segment(3.1, 1, UNIT), ri.Segment(2, 3, UNIT)]
    system = ri.System([ri.Rod(segments=pieces, velocity=1.0), rod(11.3, 2)])
    paths = {
        "l1": "bodies.0.segments.0.length",
        "l2": "bodies.0.segments.1.length",
        "l3": "bodies.1.length",
    }
    case = "striker of steps 3.1 and 2, areas 1 and 3, on 11.3, area 2"
    yield against_runs(case, system, paths, ("length",))


def against_runs(
    case: str, system: ri.System, paths: dict[str, str], symbols: tuple[str, ...]
) -> Row:
    """Velocities by formula against those of runs on fractions, at places of the cell."""
    form, inside, apart = ri.closed_form(system, symbols), 0, 0
    for shares in product(SHARES, repeat=3):
        shifts = dict(zip(paths, shares, strict=False))
        values = {name: x * shifts.get(name, 1) for name, x in form.values.items()}
        if form.holds(**values):
            inside += 1
            there = ri.exact(system, {paths[name]: x for name, x in values.items()})
            apart += form.at(**values) != there
    return Row(
        case,
        f"wrong ones of {inside} places",
        "run on fractions",
        Fraction(0),
        Fraction(apart),
        0.0,
    )


def fraction(x: sympy.Expr) -> Fraction:
    """0 of an expression that vanishes, else 1."""
    return Fraction(int(sympy.simplify(x) != 0))


def wrong(form: ri.ClosedForm, cell: set[sympy.Expr]) -> Fraction:
    """How many inequalities are in one cell and not in the other."""
    return Fraction(len(set(form.cell) ^ cell))
