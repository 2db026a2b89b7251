"""closed_form(): formulas against Saint-Venant's, and against runs on fractions elsewhere."""

import random
import sys
from fractions import Fraction

import pytest

import rodimpact as ri

sympy = pytest.importorskip("sympy")

UNIT = ri.Material("unit", youngs_modulus=1.0, density=1.0)
STEEL = ri.materials.steel


def row(lengths, areas, material=UNIT, **more):
    return ri.System(
        [
            ri.Rod(float(l), area=float(A), material=material, velocity=float(i == 0))
            for i, (l, A) in enumerate(zip(lengths, areas, strict=True))
        ],
        **more,
    )


def names(*bases):
    return sympy.symbols(
        [f"{base}{i}" for base in bases for i in (1, 2)], positive=True
    )


def same(formula, expected):
    return sympy.simplify(formula - expected) == 0


def test_the_box_is_the_ratio_of_lengths_on_both_sides_of_its_tie():
    form = ri.closed_form(row([0.4, 1.0], [1e-4, 1e-4], STEEL), ["length"])
    l1, l2 = names("l")
    assert same(form.restitution, l1 / l2)
    assert form.cell == (l1 < l2,)
    assert form.at().restitution == Fraction(2, 5)
    assert form.at(l1="1/3", l2=0.7).restitution == Fraction(10, 21)
    assert form.holds()
    assert form.holds(l1=0.99)
    assert not form.holds(l1=1)
    assert form.sides == ()
    E = STEEL.youngs_modulus
    ((start, end),) = form.contact_times[0]
    assert start == 0
    assert float(end.subs(l1, 0.4)) == pytest.approx(
        0.8 * (STEEL.density / E) ** 0.5, rel=1e-14
    )


def test_a_longer_rod_of_higher_impedance():
    form = ri.closed_form(row([2, 5], [1, 1.5]))
    T1, T2, Z1, Z2 = names("T", "Z")
    assert same(form.restitution, (2 * T1 * Z1 + (Z2 - Z1) * T2) / (T2 * (Z1 + Z2)))
    assert set(form.cell) == {Z1 < Z2, T1 < T2}
    assert same(form.impulses[0], 2 * T1 * Z1 * Z2 / (Z1 + Z2))
    assert form.contact_times == (((0, 2 * T1),),)


@pytest.mark.parametrize("K", [1, 2, 4])
def test_a_longer_rod_of_lower_impedance(K):
    form = ri.closed_form(row([2, 2 * K + 1], [2, 1]))
    T1, T2, Z1, Z2 = names("T", "Z")
    q = (Z1 - Z2) / (Z1 + Z2)
    impulse = (
        2
        * Z1
        * Z2
        / (Z1 + Z2)
        * (sum(q**k for k in range(K)) * T1 + q**K * (T2 - K * T1))
    )
    assert same(form.restitution, impulse * (1 / (Z1 * T1) + 1 / (Z2 * T2)) - 1)
    first = T1 < T2 if K == 1 else K * T1 < T2
    assert set(form.cell) == {Z2 < Z1, first, T2 < (K + 1) * T1}


def test_on_a_border_both_formulas_are_told():
    form = ri.closed_form(row([1, 2], [1, 0.5]))
    (other,) = form.sides
    T1, T2, *_ = names("T")
    borders = {T2 < 2 * T1, 2 * T1 < T2}
    assert len(borders & set(form.cell)) == len(borders & set(other.cell)) == 1
    assert form.restitution != other.restitution
    assert form.at().restitution == other.at().restitution == Fraction(7, 9)
    assert not form.holds()
    assert form.holds(T2=Fraction(21, 10)) != other.holds(T2=Fraction(21, 10))


def test_what_meets_the_formula_is_told():
    told = str(ri.closed_form(row([1, 1, 1], [1, 1, 1]), ["transit_time"])).splitlines()
    assert told[3:] == [
        "where T1 < T3",
        "It meets another formula where T1 = T3, as here:",
        "V1 = 0, V2 = (T1 - T3)/T2, V3 = 1 where T3 < T1",
    ]
    told = str(ri.closed_form(row([0.4, 1.0], [1e-4, 1e-4], STEEL))).splitlines()
    assert told[1] == "where T1 < T2, Z1 < Z2"
    assert told[2] == "It meets another formula where Z1 = Z2, as here (e = 2/5):"
    assert told[3].endswith(" where Z2 < Z1")


def test_that_a_cap_on_cells_leaves_out_sides_is_told(monkeypatch):
    monkeypatch.setattr("rodimpact.algebra.formula.MAX_CELLS", 1)
    form = ri.closed_form(row([1, 1], [1, 1]))
    assert form.unsolved
    assert str(form).endswith("cells, left out by max_events or by the cap on cells.")


def test_a_bond_has_an_average_impulse_which_has_a_formula():
    rods = [
        ri.Rod(T, area=Z, material=UNIT, velocity=v)
        for T, Z, v in [(3.0, 2.5, 1.0), (1.0, 2.0, 0.5), (3.0, 0.5, 0.0)]
    ]
    system = ri.System(rods, contacts=[ri.Bonded(), ri.Rigid()])
    form = ri.closed_form(system)
    assert agree(form, system, form.symbols, random.Random(2), 3)
    done = ri.exact(system)
    assert done.impulses[0] == Fraction(15, 2) * (1 - done.velocities_after[0])


def test_materials_gaps_and_velocities_in_symbols():
    form = ri.closed_form(
        row([1, 2], [1, 3], gaps=[0.25]), ["gap", "velocity", "length"]
    )
    l1, l2 = names("l")
    v1, v2 = sympy.symbols("v1 v2", real=True)
    g1 = sympy.Symbol("g1", positive=True)
    assert same(form.restitution, (l1 + l2) / (2 * l2))
    assert set(form.cell) == {l1 < l2, v2 < v1}
    assert same(form.contact_times[0][0][0], g1 / (v1 - v2))
    E1, rho1 = sympy.symbols("E1 rho1", positive=True)
    form = ri.closed_form(row([2, 5], [1, 1], STEEL), ["youngs_modulus", "density"])
    assert form.restitution == Fraction(2, 5)
    assert same(form.contact_times[0][0][1], 4 * sympy.sqrt(rho1 / E1))
    assert not form.holds(E1=-1)
    assert form.at(rho1=0).contact_times == (((0, None),),)


def test_a_stepped_striker():
    striker = ri.Rod(
        segments=[ri.Segment(0.3, 1.0, UNIT), ri.Segment(0.2, 3.0, UNIT)], velocity=1.0
    )
    system = ri.System([striker, ri.Rod(1.0, area=2.0, material=UNIT)])
    form = ri.closed_form(system, ["length"])
    for side in (form, *form.sides):
        assert side.at().restitution == ri.exact(system).restitution
    agree(
        form,
        system,
        {
            "l1": "bodies.0.segments.0.length",
            "l2": "bodies.0.segments.1.length",
            "l3": "bodies.1.length",
        },
        random.Random(1),
        4,
    )


def agree(form, system, paths, rng, count):
    """Compare the formulas with runs at places near the system; return how many there were."""
    places = 0
    for _ in range(count):
        near = {
            name: x * (1 + Fraction(rng.randint(-50, 50), 1000))
            for name, x in form.values.items()
        }
        for side in (form, *form.sides):
            if side.holds(**near):
                there = ri.exact(system, {paths[name]: x for name, x in near.items()})
                assert side.at(**near) == there
                places += 1
    return places


def agree_at_the_border(form, system, paths, rng):
    """Go from the system to where the formula ends, and compare there, just inside."""
    inside, outside = (
        {
            name: x * (1 + Fraction(rng.randint(-50, 100) * far, 100))
            for name, x in form.values.items()
        }
        for far in (Fraction(1, 500), 1)
    )
    if not form.holds(**inside) or form.holds(**outside):
        return 0
    for _ in range(20):
        middle = {name: (x + outside[name]) / 2 for name, x in inside.items()}
        if form.holds(**middle):
            inside = middle
        else:
            outside = middle
    assert form.at(**inside) == ri.exact(
        system, {paths[name]: x for name, x in inside.items()}
    )
    return 1


def random_row(rng, count):
    common = rng.random() < 0.4
    T = [
        Fraction(rng.randint(1, 9)) if common else Fraction(rng.randint(100, 900), 100)
        for _ in range(count)
    ]
    Z = [
        Fraction(rng.randint(1, 6), 2)
        if common
        else Fraction(rng.randint(30, 300), 100)
        for _ in range(count)
    ]
    return row(T, Z)


@pytest.mark.parametrize(
    ("bodies", "rows"),
    [
        (2, 8),
        (3, 2),
        *(
            pytest.param(*case, marks=pytest.mark.exhaustive)
            for case in [(2, 40), (3, 8)]
        ),
    ],
)
def test_random_rows_agree_with_runs_on_fractions(bodies, rows):
    rng, places, borders = random.Random(rows), 0, 0
    for _ in range(rows):
        system = random_row(rng, bodies)
        form = ri.closed_form(system)
        there = ri.exact(system)
        if form.holds():
            assert form.at() == there
        else:  # on a border the formulas meet, or the run does as one of them
            results = [
                (at.velocities_after, at.impulses)
                for at in (side.at() for side in (form, *form.sides))
            ]
            assert (there.velocities_after, there.impulses) in results
        places += agree(form, system, form.symbols, rng, 3)
        borders += agree_at_the_border(form, system, form.symbols, rng)
    assert places >= rows
    assert borders >= rows / 8


@pytest.mark.parametrize(
    ("symbols", "cap", "said"),
    [
        (
            ["lenght"],
            9,
            "symbols: 'lenght' names no number .*; perhaps 'length' is meant",
        ),
        (
            ["transit_time", "length"],
            9,
            "symbols: 'length' names no number of the formula beside",
        ),
        (["gap"], 9, "symbols: 'gap' names no number of"),
        ([], 9, "symbols: must name a number"),
        (["length"], 1, "max_events: the collision is not over after 1"),
    ],
)
def test_mistakes_and_a_cap_are_told(symbols, cap, said):
    with pytest.raises(ri.InvalidModel, match=said):
        ri.closed_form(row([2, 5], [1, 1]), symbols, max_events=cap)
    with pytest.raises(ri.InvalidModel, match="l3: is no symbol here"):
        ri.closed_form(row([2, 5], [1, 1]), ["length"]).at(l3=1)


def test_without_sympy_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "sympy", None)
    with pytest.raises(
        ImportError, match=r"sympy is not installed; pip install 'rodimpact\[sympy"
    ):
        ri.closed_form(row([2, 5], [1, 1]))


def test_notebooks_show_latex():
    form = ri.closed_form(row([2, 5], [1, 1]), ["length"])
    assert r"\frac{l_{1}}{l_{2}}" in form._repr_latex_()
    assert "l_{1} < l_{2}" in form._repr_latex_()


def test_a_formula_that_would_be_too_long_is_refused_with_a_remedy(monkeypatch):
    three = row([0.4, 1.0, 0.7], [1e-4, 2e-4, 3e-4])
    monkeypatch.setattr("rodimpact.algebra.rational_functions.MAX_PRODUCT_TERMS", 20)
    with pytest.raises(ri.InvalidModel, match=r"symbols: a formula .* name fewer"):
        str(ri.closed_form(three))
    assert "l1" in str(ri.closed_form(three, ["bodies.0.length"]))


def test_the_steps_of_a_formula_are_counted_over_all_its_parts():
    heard = []
    form = ri.closed_form(
        row([0.4, 1.0], [1e-4, 2e-4]), ["length"], progress=lambda *at: heard.append(at)
    )
    assert str(form)
    steps = [done for done, _ in heard]
    assert steps == list(range(1, len(steps) + 1))
    assert {total for _, total in heard} == {None}
