"""closed_form(): formulas against Saint-Venant's, and against runs on fractions."""

import random
import sys
from fractions import Fraction

import pytest
from exhaustive import few_of

import rodimpact as ri
from rodimpact.algebra import rational_functions, traced_fraction

sympy = pytest.importorskip("sympy")

UNIT = ri.Material("unit", youngs_modulus=1.0, density=1.0)
STEEL = ri.materials.steel


def row(lengths, areas, material=UNIT, **settings):
    """A system of rods with these lengths and areas, of which the first moves at 1 m/s;
    `settings` are those of `System`; not solved.
    """
    rods = []
    velocity = 1.0
    for length, area in zip(lengths, areas, strict=True):
        rod = ri.Rod(
            float(length), area=float(area), material=material, velocity=velocity
        )
        rods.append(rod)
        velocity = 0.0
    return ri.System(rods, **settings)


BOX = row([0.4, 1.0], [1e-4, 1e-4], STEEL)
TWO_TO_FIVE = row([2, 5], [1, 1])


def only_contact(form):
    """Start and end of the contact of two rods that meet once."""
    ((episode,),) = form.contact_times  # of the only contact
    return episode


def names(*letters):
    """Positive symbols: for each letter, the letter with 1 and with 2, as a list."""
    numbered = []
    for letter in letters:
        numbered += [f"{letter}1", f"{letter}2"]
    return sympy.symbols(numbered, positive=True)


def same(formula, expected):
    """Whether two formulas are equal in all numbers."""
    return sympy.simplify(formula - expected) == 0


# Formulas of two rods


def test_the_formula_of_the_box_is_l1_over_l2_where_l1_is_below_l2():
    """Two rods that differ in length: e = l1/l2 in the cell l1 < l2, with exact values;
    `holds` is false at its border, and there are no other sides.
    """
    form = ri.closed_form(BOX, ["length"])

    l1, l2 = names("l")
    assert same(form.restitution, l1 / l2)
    assert form.cell == (l1 < l2,)
    assert form.at().restitution == Fraction(2, 5)
    assert form.at(l1="1/3", l2=0.7).restitution == Fraction(10, 21)
    assert form.holds()
    assert form.holds(l1=0.99)
    assert not form.holds(l1=1)
    assert form.sides == ()  # l1 = 0.4 m and l2 = 1 m lie on no border


def test_the_contact_of_the_box_lasts_two_transits_of_the_striker():
    """Start 0 and end of the contact, in the closed form, at a length of 0.4 m."""
    form = ri.closed_form(BOX, ["length"])

    start, end = only_contact(form)
    l1, _ = names("l")
    slowness = (STEEL.density / STEEL.youngs_modulus) ** 0.5
    assert start == 0
    duration = float(end.subs(l1, 0.4))
    assert duration == pytest.approx(0.8 * slowness, rel=1e-14)


@pytest.mark.exhaustive
def test_the_formula_for_a_longer_rod_of_higher_impedance_is_saint_venants():
    """The struck rod is longer and has the higher impedance: restitution, impulse, cell
    and duration, 2 T1, are those of Saint-Venant.
    """
    form = ri.closed_form(row([2, 5], [1, 1.5]))

    T1, T2, Z1, Z2 = names("T", "Z")
    e = (2 * T1 * Z1 + (Z2 - Z1) * T2) / (T2 * (Z1 + Z2))
    impulse = 2 * T1 * Z1 * Z2 / (Z1 + Z2)
    assert same(form.restitution, e)
    assert same(form.impulses[0], impulse)
    assert set(form.cell) == {Z1 < Z2, T1 < T2}
    start, end = only_contact(form)
    assert start == 0
    assert end == 2 * T1


@pytest.mark.parametrize("K", few_of([1, 2, 4], [2]))
def test_the_formula_for_a_longer_rod_of_lower_impedance_is_saint_venants(K):
    """The struck rod has the lower impedance and lasts K round trips of the striker,
    and a part of one. Restitution and cell of the closed form are those of
    Saint-Venant's geometric series.
    """
    # T1 = 2 s and T2 = 2 K + 1 s: K round trips of the first rod fit into the second.
    form = ri.closed_form(row([2, 2 * K + 1], [2, 1]))

    T1, T2, Z1, Z2 = names("T", "Z")
    q = (Z1 - Z2) / (Z1 + Z2)  # force of a round trip over that of the one before
    powers = [q**k for k in range(K)]
    whole_round_trips = sum(powers) * T1
    last_round_trip = q**K * (T2 - K * T1)
    impulse = 2 * Z1 * Z2 / (Z1 + Z2) * (whole_round_trips + last_round_trip)
    inverse_masses = 1 / (Z1 * T1) + 1 / (Z2 * T2)
    shortest = K * T1 < T2
    longest = T2 < (K + 1) * T1
    assert same(form.restitution, impulse * inverse_masses - 1)
    assert set(form.cell) == {Z2 < Z1, shortest, longest}


# Borders between formulas


def test_on_a_border_there_are_both_formulas():
    """Transit times 1 and 2 lie on the border T2 = 2 T1. There are two different
    formulas, one for each side; both give e = 7/9 here, and for a longer rod only one
    of them holds.
    """
    form = ri.closed_form(row([1, 2], [1, 0.5]))

    (other,) = form.sides
    T1, T2 = names("T")
    borders = {T2 < 2 * T1, 2 * T1 < T2}
    longer = Fraction(21, 10)
    assert len(borders & set(form.cell)) == 1
    assert len(borders & set(other.cell)) == 1
    assert form.restitution != other.restitution
    e = Fraction(7, 9)
    assert form.at().restitution == e
    assert other.at().restitution == e
    assert not form.holds()
    assert form.holds(T2=longer) != other.holds(T2=longer)


def test_a_formula_of_three_rods_prints_the_formula_that_it_meets():
    """The text of the formula of three equal rods has its condition T1 < T3 and the
    other formula, which holds for T3 < T1.
    """
    three = row([1, 1, 1], [1, 1, 1])

    form = ri.closed_form(three, ["transit_time"])

    _, _, _, *conditions = str(form).splitlines()  # after three lines of the formula
    assert conditions == [
        "where T1 < T3",
        "It meets another formula where T1 = T3, as here:",
        "V1 = 0, V2 = (T1 - T3)/T2, V3 = 1 where T3 < T1",
    ]


def test_a_formula_of_two_rods_prints_the_formula_that_it_meets():
    """The text of the closed form of the box has its condition, the border Z1 = Z2 on
    which the box lies, with e = 2/5, and the formula beyond it.
    """
    form = ri.closed_form(BOX)

    lines = str(form).splitlines()
    assert lines[1] == "where T1 < T2, Z1 < Z2"
    assert lines[2] == "It meets another formula where Z1 = Z2, as here (e = 2/5):"
    assert lines[3].endswith(" where Z2 < Z1")


def test_sides_beyond_the_cap_on_cells_are_announced(monkeypatch):
    monkeypatch.setattr("rodimpact.algebra.formula.MAX_CELLS", 1)

    form = ri.closed_form(row([1, 1], [1, 1]))

    assert form.unsolved
    assert str(form).endswith("cells, left out by max_events or by the cap on cells.")


# Other rows, other symbols


@pytest.mark.exhaustive
def test_a_bond_has_an_average_impulse_which_has_a_formula():
    """Two bonded rods strike a third. The closed form agrees with exact runs at random
    lengths, and the impulse of the bond is the momentum that the first rod loses.
    """
    first = ri.Rod(3.0, area=2.5, material=UNIT, velocity=1.0)
    second = ri.Rod(1.0, area=2.0, material=UNIT, velocity=0.5)
    third = ri.Rod(3.0, area=0.5, material=UNIT)
    contacts = [ri.Bonded(), ri.Rigid()]
    system = ri.System([first, second, third], contacts=contacts)
    rng = random.Random(2)

    form = ri.closed_form(system, ["length"])

    n_agreements = count_agreements(form, system, form.symbols, rng, 1)
    assert n_agreements > 0
    collision = ri.exact(system)
    mass = Fraction(15, 2)  # of the first rod, 3 m of 2.5 m^2; it had 1 m/s
    momentum_lost = mass * (1 - collision.velocities_after[0])
    assert collision.impulses[0] == momentum_lost


def test_gaps_and_velocities_may_be_symbols():
    """With gap, velocities and lengths as symbols: e, the cell l1 < l2 and v2 < v1, and
    the start of contact, g1/(v1 - v2).
    """
    system = row([1, 2], [1, 3], gaps=[0.25])

    form = ri.closed_form(system, ["gap", "velocity", "length"])

    start, _ = only_contact(form)
    l1, l2 = names("l")
    v1, v2 = sympy.symbols("v1 v2", real=True)
    g1 = sympy.Symbol("g1", positive=True)
    assert same(form.restitution, (l1 + l2) / (2 * l2))
    assert set(form.cell) == {l1 < l2, v2 < v1}
    assert same(start, g1 / (v1 - v2))


def test_moduli_and_densities_may_be_symbols():
    """With moduli and densities as symbols, e is 2/5, the duration has the wave speed
    in symbols, a negative modulus does not hold, and a rod without mass gives None for
    the duration.
    """
    system = row([2, 5], [1, 1], STEEL)

    form = ri.closed_form(system, ["youngs_modulus", "density"])

    E1, rho1 = sympy.symbols("E1 rho1", positive=True)
    _, end = only_contact(form)
    assert form.restitution == Fraction(2, 5)
    assert same(end, 4 * sympy.sqrt(rho1 / E1))
    assert not form.holds(E1=-1)
    without_mass = form.at(rho1=0)
    _, end = only_contact(without_mass)
    assert end is None  # 0/0 for a rod without mass


@pytest.mark.exhaustive
def test_formulas_of_a_stepped_striker_agree_with_runs_on_fractions():
    """The closed form of a striker of two segments, on both sides of its border, has
    the restitution of the exact run; at random lengths within its cell it agrees with
    further runs.
    """
    thin = ri.Segment(0.3, 1.0, UNIT)
    thick = ri.Segment(0.2, 3.0, UNIT)
    striker = ri.Rod(segments=[thin, thick], velocity=1.0)
    struck = ri.Rod(1.0, area=2.0, material=UNIT)
    system = ri.System([striker, struck])

    form = ri.closed_form(system, ["length"])

    e = ri.exact(system).restitution
    for side in (form, *form.sides):
        assert side.at().restitution == e
    paths = {
        "l1": "bodies.0.segments.0.length",
        "l2": "bodies.0.segments.1.length",
        "l3": "bodies.1.length",
    }
    n_agreements = count_agreements(form, system, paths, random.Random(1), 2)
    assert n_agreements > 0


# Random rows


def exact_at(system, paths, point):
    """The collision in fractions with the values of a point, by the paths of its
    names.
    """
    values = {paths[name]: value for name, value in point.items()}
    return ri.exact(system, values)


def point_near(form, rng, low, high, step):
    """{name: value} of the symbols, each changed by a random number of relative steps.

    The number lies in `low` to `high`.
    """
    point = {}
    for name, value in form.values.items():
        change = rng.randint(low, high) * step
        point[name] = value * (1 + change)
    return point


def count_agreements(form, system, paths, rng, count):
    """Compare the formulas with runs at points near the system.

    Return the number of comparisons.
    """
    comparisons = 0
    for _ in range(count):
        point = point_near(form, rng, -50, 50, Fraction(1, 1000))
        for side in (form, *form.sides):
            if side.holds(**point):
                assert side.at(**point) == exact_at(system, paths, point)
                comparisons += 1
    return comparisons


def agrees_at_its_border(form, system, paths, rng):
    """Compare the formula with a run just inside the border where it ends.

    False if no border was found between two random points.
    """
    inside = point_near(form, rng, -50, 100, Fraction(1, 50_000))
    outside = point_near(form, rng, -50, 100, Fraction(1, 100))
    if not form.holds(**inside) or form.holds(**outside):
        return False
    for _ in range(20):
        middle = {name: (inside[name] + outside[name]) / 2 for name in inside}
        if form.holds(**middle):
            inside = middle
        else:
            outside = middle
    assert form.at(**inside) == exact_at(system, paths, inside)
    return True


def random_row(rng, count):
    """A row of `count` rods with random rational transit times and impedances; in 40 %
    of the rows these are small multiples of one unit.
    """
    commensurate = rng.random() < 0.4
    T = []
    Z = []
    for _ in range(count):
        if commensurate:
            T.append(Fraction(rng.randint(1, 9)))
        else:
            T.append(Fraction(rng.randint(100, 900), 100))
    for _ in range(count):
        if commensurate:
            Z.append(Fraction(rng.randint(1, 6), 2))
        else:
            Z.append(Fraction(rng.randint(30, 300), 100))
    return row(T, Z)  # E = rho = 1: a length is a transit time, an area an impedance


def check_formula_at_its_system(form, collision):
    """Assert that the formula, at the numbers of its own system, agrees with the exact
    run; on a border, one of the formulas on its sides must.
    """
    if form.holds():
        assert form.at() == collision
        return
    results = []
    for side in (form, *form.sides):
        values = side.at()
        results.append((values.velocities_after, values.impulses))
    assert (collision.velocities_after, collision.impulses) in results


@pytest.mark.parametrize(
    ("bodies", "rows"),
    [
        (2, 8),
        pytest.param(3, 2, marks=pytest.mark.exhaustive),
        pytest.param(2, 16, marks=pytest.mark.exhaustive),
        pytest.param(3, 4, marks=pytest.mark.exhaustive),
    ],
)
def test_random_rows_agree_with_runs_on_fractions(bodies, rows):
    """The closed forms of random rows agree with exact runs at their own numbers, at
    random numbers in their cell, and on both sides of a border, which enough rows have.
    """
    rng = random.Random(rows)
    comparisons = 0
    borders = 0
    for _ in range(rows):
        system = random_row(rng, bodies)
        form = ri.closed_form(system)
        check_formula_at_its_system(form, ri.exact(system))
        comparisons += count_agreements(form, system, form.symbols, rng, 3)
        borders += agrees_at_its_border(form, system, form.symbols, rng)
    assert comparisons >= rows
    # Two random points seldom have a border between them.
    assert borders >= rows / 8


# Mistakes and texts


@pytest.mark.parametrize(
    ("symbols", "cap", "message"),
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
def test_mistakes_and_a_cap_are_named(symbols, cap, message):
    with pytest.raises(ri.InvalidModel, match=message):
        ri.closed_form(TWO_TO_FIVE, symbols, max_events=cap)


def test_a_cell_that_needs_endless_events_is_refused():
    """The short rod parts from the long one at once, and vibrates until waves
    return.
    """
    endless = row([0.4, 1e30], [1, 2])
    message = "max_events: where the formula holds is not known after 80 events"

    with pytest.raises(ri.InvalidModel, match=message):
        ri.closed_form(endless, ["length"], max_events=10)


def test_a_formula_of_too_long_fractions_is_refused(monkeypatch):
    monkeypatch.setattr(traced_fraction, "MAX_BITS", 64)

    with pytest.raises(ri.InvalidModel, match="symbols: fractions of a formula"):
        ri.closed_form(TWO_TO_FIVE, ["length", "area"])


def test_a_value_of_an_unknown_symbol_is_refused():
    form = ri.closed_form(TWO_TO_FIVE, ["length"])

    with pytest.raises(ri.InvalidModel, match="l3: is no symbol here"):
        form.at(l3=1)


def test_without_sympy_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "sympy", None)
    message = r"sympy is not installed; pip install 'rodimpact\[sympy"

    with pytest.raises(ImportError, match=message):
        ri.closed_form(TWO_TO_FIVE)


def test_notebooks_show_the_formula_and_its_condition_in_latex():
    form = ri.closed_form(TWO_TO_FIVE, ["length"])

    latex = form._repr_latex_()

    assert r"\frac{l_{1}}{l_{2}}" in latex
    assert "l_{1} < l_{2}" in latex


def test_a_formula_that_would_be_too_long_is_refused_with_a_remedy(monkeypatch):
    """With a small limit on products, the closed form of three rods is refused with the
    advice to name fewer symbols, which works.
    """
    three = row([0.4, 1.0, 0.7], [1e-4, 2e-4, 3e-4])
    monkeypatch.setattr(rational_functions, "MAX_PRODUCT_TERMS", 8)

    with pytest.raises(ri.InvalidModel, match=r"symbols: a formula .* name fewer"):
        ri.closed_form(three)

    # The remedy helps.
    shorter = ri.closed_form(three, ["bodies.0.length"])
    assert "l1" in str(shorter)


def test_a_formula_says_if_its_conditions_are_too_long(monkeypatch):
    """With a small limit on products, text and LaTeX of a formula say that its
    conditions are too long to print; `holds` still works, and `cell` is refused.
    """
    form = ri.closed_form(row([2, 5], [1, 2]), ["length", "area"])
    monkeypatch.setattr(rational_functions, "MAX_PRODUCT_TERMS", 1)

    first, last = str(form).splitlines()

    assert first == f"e = {form.restitution}"
    assert last.startswith("where conditions hold that are too long to print: ")
    assert last in form._repr_latex_()
    assert form.holds()
    with pytest.raises(ri.InvalidModel, match="symbols: a formula"):
        _ = form.cell


STEPPED_PAIR = ri.System(
    [
        ri.Rod(
            segments=[
                ri.Segment(0.3, area=2e-4, material=STEEL),
                ri.Segment(0.3, area=1e-4, material=STEEL),
            ],
            velocity=1.0,
        ),
        ri.Rod(1.5, area=1e-4, material=STEEL),
    ]
)


@pytest.mark.exhaustive
def test_conditions_of_a_stepped_rod_are_not_worked_on_without_bound(monkeypatch):
    """The conditions of three segments would take more than ten minutes: the text says
    that they are too long, and `cell` is refused with advice.
    """
    monkeypatch.setattr(rational_functions, "MAX_CONDITION_TERMS", 500)
    form = ri.closed_form(STEPPED_PAIR, ["area"])

    assert "\nwhere conditions hold that are too long to print: fewer" in str(form)
    with pytest.raises(
        ri.InvalidModel, match=r"conditions .* are too long: name fewer"
    ):
        _ = form.cell


def test_a_printed_formula_of_a_stepped_rod_tells_its_symbols_apart():
    printed = str(ri.closed_form(STEPPED_PAIR, ["area"])).splitlines()

    assert printed[0] == "A1: bodies.0.segments.0.area"
    assert printed[2] == "A3: bodies.1.area"


def test_the_steps_of_a_formula_are_counted_over_all_its_parts():
    """`progress` is called with 1, 2, 3 and so on over the making of a formula and its
    printing, and with None as the total.
    """
    steps = []
    totals = set()

    def progress(step, total):
        steps.append(step)
        totals.add(total)

    system = row([0.4, 1.0], [1e-4, 2e-4])
    form = ri.closed_form(system, ["length"], progress=progress)

    assert "e = " in str(form)
    assert steps == list(range(1, len(steps) + 1))
    assert totals == {None}  # the number of all steps is not known
