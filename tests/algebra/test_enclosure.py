"""enclosure(): runs on fractions lie within, and it is hardly wider than these."""

import json
from fractions import Fraction

import numpy as np
import pytest
from exhaustive import few_of

import rodimpact as ri
from rodimpact.algebra.covering import Bent, Box, Covering
from rodimpact.algebra.formula import Field
from rodimpact.algebra.naming import Naming
from rodimpact.cli import main

STEEL = ri.materials.steel
RATIONAL = [ri.Material("with a rational wave speed", youngs_modulus=E, density=rho)
            for E, rho in ((100e9, 4e3), (400e9, 16e3), (225e9, 9e3), (64e9, 4e3))]


def pair(first=0.4, second=1.0, area=1e-4, material=STEEL):
    return ri.System([ri.Rod(first, area=1e-4, material=STEEL, velocity=1.0),
                      ri.Rod(second, area=area, material=material)])


def any_pair(rng, commensurate):
    def rod(velocity):
        length, area = rng.uniform(0.1, 1), rng.uniform(0.5, 2)
        if commensurate:
            length, area = rng.integers(1, 10) / 10, rng.integers(1, 4)
        return ri.Rod(round(float(length), 3), area=round(float(area), 3) * 1e-4,
                      material=RATIONAL[rng.integers(4)], velocity=velocity)

    return ri.System([rod(1.0), rod(float(rng.integers(-1, 2)) / 2)])


def check(found, run):
    """Whether a run on fractions lies within."""
    durations = [sum(end - start for start, end in of) for of in run.contact_times]
    for bounds, values in (
        ([found.restitution], [run.restitution]), (found.velocities_after, run.velocities_after),
        (found.impulses, run.impulses), (found.durations, durations),
    ):
        for (low, high), x in zip(bounds, values, strict=True):
            assert low <= x <= high


@pytest.mark.parametrize("seed", few_of(range(200), range(6)))
def test_runs_lie_within(seed):
    rng = np.random.default_rng([18, seed])
    system = any_pair(rng, seed % 3 == 0)
    found = ri.enclosure(system, dict.fromkeys(("length", "area", "velocity"), "0.1 %"))
    restitution = []
    for i in range(50):
        # the middle, corners, and places between, many of which are on borders of formulas
        shares = rng.integers(0, 65, len(found.tolerances)) if i % 2 else 64 * rng.integers(
            0, 2, len(found.tolerances))
        run = ri.exact(system, {
            path: Fraction(repr(low)) + (Fraction(repr(high)) - Fraction(repr(low)))
            * Fraction(int(share if i else 32), 64)
            for share, (path, (low, high)) in zip(shares, found.tolerances.items(), strict=True)})
        check(found, run)
        restitution.append(float(run.restitution))
    low, high = found.restitution
    assert high - low <= 4 * (max(restitution) - min(restitution)) + 1e-12


def test_the_box():
    found = ri.enclosure(pair(), {"length": 1e-4})
    assert found.velocities_after[0] == (0.0, 0.0)
    low, high = found.restitution
    assert low <= 0.3999 / 1.0001 < 0.4001 / 0.9999 <= high
    assert high - low == pytest.approx(0.4001 / 0.9999 - 0.3999 / 1.0001, rel=1e-9)


def test_a_border_between_formulas_is_kept():
    # e = l1/l2 below equal lengths, l2/l1 above, by formulas that end where these are equal
    found = ri.enclosure(pair(0.4, 0.4), {"bodies.0.length": 4e-4})
    assert found.formulas == 2
    assert found.restitution == pytest.approx((0.4 / 0.4004, 1.0), abs=4e-6)


def test_a_material_in_common_cancels():
    both = ri.enclosure(pair(), {"density": "0.1 %", "youngs_modulus": "0.1 %"})
    assert both.restitution == pytest.approx((0.4, 0.4), abs=1e-12)
    apart = ri.enclosure(pair(), {f"bodies.{i}.material.density": "0.1 %" for i in range(2)})
    assert set(apart.tolerances) == {f"bodies.{i}.material.density" for i in range(2)}
    rng = np.random.default_rng(0)
    densities = 7850.0 * (1 + 1e-3 * rng.choice([-1, 1, 0.5], (2, 40)))
    family = ri.System([
        ri.Rod(length, area=1e-4, velocity=v, material=ri.Material(
            "steel", youngs_modulus=STEEL.youngs_modulus, density=rho))
        for length, v, rho in zip((0.4, 1.0), (1.0, 0.0), densities, strict=True)])
    e = ri.sweep(family).restitution
    low, high = apart.restitution
    assert low <= e.min() <= e.max() <= high
    assert high - low < 2 * (e.max() - e.min())


def test_tolerances_of_some_percent_are_nearly_exact():
    system = pair(0.41, 1.03, 0.7e-4)
    low, high = ri.enclosure(system, {"length": "2 %"}).restitution
    first, second = np.meshgrid([0.41 * 0.98, 0.41 * 1.02], [1.03 * 0.98, 1.03 * 1.02])
    e = ri.sweep(pair(first, second, 0.7e-4)).restitution
    assert (low, high) == pytest.approx((e.min(), e.max()), rel=1e-9)


@pytest.mark.exhaustive
def test_where_many_formulas_meet():
    striker = ri.Rod(segments=[ri.Segment(0.2, 1e-4, STEEL), ri.Segment(0.2, 2e-4, STEEL)],
                     velocity=1.0)
    system = ri.System([striker, ri.Rod(1.0, area=1e-4, material=STEEL)])
    found = ri.enclosure(system, {"length": "0.1 %"})
    assert found.formulas > 10
    rng = np.random.default_rng(0)
    e = []
    for _ in range(60):
        run = ri.exact(system, {
            path: Fraction(repr(low)) + (Fraction(repr(high)) - Fraction(repr(low)))
            * Fraction(int(rng.integers(0, 5)), 4) for path, (low, high) in found.tolerances.items()
        })
        assert found.restitution[0] <= run.restitution <= found.restitution[1]
        e.append(run.restitution)
    assert found.restitution[1] - found.restitution[0] < 2 * (max(e) - min(e))


def test_where_e_is_not_everywhere():
    found = ri.enclosure(pair(), {"bodies.0.velocity": 0.5, "bodies.1.velocity": 0.6})
    assert found.restitution is None
    # V2 = (2 v1 + 3 v2)/5 where they collide, v2 where they do not
    assert found.velocities_after[1] == pytest.approx((-0.16, 0.96), rel=1e-9)


@pytest.mark.parametrize(("tolerances", "path", "sentence"), [
    ({}, "tolerances", "must be tolerances by path"),
    ({1: 2}, "tolerances", "must be tolerances by path"),
    ({"lenth": 1e-4}, "tolerances", "perhaps 'length' is meant"),
    ({"length": "0.1 furlong"}, "length", "unknown unit 'furlong'"),
    ({"length": 0.4}, "length", "must be below bodies.0.length itself, 0.4, got 0.4"),
    ({"length": [1e-4]}, "length", "must be one number"),
    ({"length": -1e-4}, "length", "non-negative"),
    pytest.param({"length": "60 %", "area": "60 %"}, "tolerances", "undecided in",
                 marks=pytest.mark.exhaustive),
])
def test_refusals(tolerances, path, sentence):
    with pytest.raises(ri.InvalidModel, match=sentence) as refused:
        ri.enclosure(pair(), tolerances)
    assert refused.value.problems[0][0] == path


def test_caps():
    system = pair(0.4, 0.4)
    with pytest.raises(ri.InvalidModel, match="undecided after 1 formulas"):
        ri.enclosure(system, {"length": "1 %"}, most_cells=1)
    with pytest.raises(ri.InvalidModel, match="not over after 2 events"):
        ri.enclosure(system, {"length": "1 %"}, max_events=2)


def test_command_line(tmp_path, capsys):
    case = tmp_path / "case.toml"
    case.write_text(ri.write_case(pair()))
    assert main(["run", str(case), "--tolerance", "length=0.1 mm", "--json"]) == 0
    low, high = json.loads(capsys.readouterr().out)["enclosure"]["restitution"]
    assert low < 0.4 < high
    assert main(["run", str(case), "--tolerance", "length=0.1 mm"]) == 0
    assert "within the tolerances:\ne: 0.39986" in capsys.readouterr().out
    assert main(["run", str(case), "--tolerance", "length"]) == 2
    assert "--tolerance: must be PATH=SIZE" in capsys.readouterr().err


def test_nothing_is_taken_as_empty_without_a_proof():
    covering = Covering(Field(Naming(pair(), ["length"])), 1, 1)
    first, second, *_ = covering.field.ring.gens
    box = Box({"l1": (Fraction(3, 10), Fraction(1, 2)), "l2": (Fraction(9, 10), Fraction(11, 10))},
              {"l1": Fraction(1, 5), "l2": Fraction(1, 5)})
    at_both_ends = (5 * first - 2) ** 2 * 8 - 1  # not where it is straight
    with pytest.raises(Bent):
        covering.find(box, [at_both_ends])
    three_that_add_up_to_0 = [5 * first - 2, 5 * second - 5 * first - 3, 5 - 5 * second]
    assert covering.find(box, three_that_add_up_to_0) is None
    assert covering.find(box, [100 * first - 41, 5 * second - 5 * first - 4]) is None  # far away
    place = covering.find(box, [100 * first - 49, 5 * second - 5])
    assert place["l1"] > Fraction(49, 100)
    assert place["l2"] > 1
