"""What the page computes around the kernels: it is what the solution says."""

import operator
import tomllib
from functools import reduce

import numpy as np
import pytest
from exhaustive import few_of
from systems import random_system

import rodimpact as ri
from rodimpact.explorer import fronts, motion
from rodimpact.explorer.design import LIBRARY
from rodimpact.explorer.known import gauge_of
from rodimpact.explorer.tables import RULES, lacking, mistakes, request_of, system_of
from rodimpact.methods.fronts.family_layout import lay_out_family
from rodimpact.methods.registry import Options
from rodimpact.methods.row_builder import build_row
from rodimpact.results.front_polygons import polygons_of
from rodimpact.results.regions import regions_of
from rodimpact.storage.case_reading import case_from

STEEL = ri.materials.steel
ROD = {"kind": "rod", "length": 0.4, "area": 1e-4, "material": "steel", "velocity": 1.0}
WALL = {"kind": "wall", "velocity": 0.0}
STEPS = ri.Steps([1e3, 0.0, 5e2], [1e-4, 2e-4])


def tables_of(system, **solve):
    return {**tomllib.loads(ri.write_case(system)), "solve": solve}


def rows():
    yield from (
        (random_system(seed), {"until": 3e-4} if seed % 2 else {}) for seed in range(12)
    )
    rods = [ri.Rod(0.4, area=1e-4, material=STEEL, velocity=v) for v in (1.0, 0.0)]
    for ends in (
        (ri.Fixed(), ri.Absorbing()),
        (ri.Pushed(STEPS), ri.Free()),
        (ri.Incoming(ri.Steps([1e-4, 0.0], [5e-5])), ri.Fixed()),
        (ri.Moved(0.5), ri.Free()),
    ):
        yield ri.System(rods, ends=ends), {"until": 6e-4}
    yield (
        ri.System([ri.Wall(), *rods, ri.Wall()], contacts=[ri.Bonded()] * 3),
        {"until": 6e-4},
    )


@pytest.mark.parametrize("number", few_of(range(17), {1, 4, 7, 8, 12, 13, 14, 15, 16}))
def test_runs_and_curves_are_those_of_the_solution(number):
    system, solve = list(rows())[number]
    case = tables_of(system, **solve)
    theirs, asked = system_of(case, LIBRARY), request_of(case)
    plan, known = lay_out_family(build_row(theirs)), lay_out_family(build_row(system))
    assert plan[1:] == known[1:]
    solution = ri.solve(system, **solve, max_events=20_000)
    run = fronts.run_of(asked, True, fronts.space_of(plan))
    found, outcome = fronts.outcome_of(run, fronts.sentence_of(run)), solution.outcome
    assert found["status"] == solution.status
    assert found["after"] == list(outcome.velocities_after)
    assert found["why"] == outcome.why_no_restitution()
    assert found["vibration_after"] == pytest.approx(
        sum(outcome.vibration_after), rel=1e-12
    )
    before = outcome.kinetic_before + sum(outcome.vibration_before)
    assert found["energy_before"] == pytest.approx(before, rel=1e-12)
    moving = fronts.motion_of(run)
    stop = moving["now"]
    if not stop:
        return
    polygons = polygons_of(moving["rods"], moving["tick"], moving["frame"], 0, stop)
    known = regions_of(solution, stop=stop * solution.fields.clock.tick)
    for name in (
        "body",
        "start",
        "x",
        "t",
        "displacement",
        "velocity",
        "strain",
        "stress",
    ):
        np.testing.assert_array_equal(polygons[name], getattr(known, name))
    curves = fronts.contact_curves(run, stop)
    for curve, contact in zip(curves, solution.contacts, strict=True):
        times, force = map(np.array, curve["force"].values())
        assert (times[0], times[-1]) == (0.0, stop * moving["tick"])
        assert force[-1] == pytest.approx(contact.force(times[-1]), rel=1e-9, abs=1e-9)
        if curve["gap"] is not None:
            opened, gap = curve["gap"].values()
            assert gap == pytest.approx(contact.gap(opened), abs=1e-15)
        middles, long = (times[1:] + times[:-1]) / 2, np.diff(times) > 0
        known = contact.force(middles)[long]
        assert known == pytest.approx(force[:-1][long], rel=1e-9, abs=1e-9)
        assert known == pytest.approx(force[1:][long], rel=1e-9, abs=1e-9)
    body = next(i for i, b in enumerate(system.bodies) if isinstance(b, ri.Rod))
    s, x, _ = gauge_of(theirs, {"body": body, "fraction": 0.3})
    times, strain = motion.gauge_curve(
        moving, moving["row"].spans[body][0] - 1 + s, x
    ).values()
    middles, long = (np.array(times)[1:] + np.array(times)[:-1]) / 2, np.diff(times) > 0
    record = solution.gauge(body, 0.3 * system.bodies[body].length).strain_at(middles)[
        long
    ]
    assert record == pytest.approx(np.array(strain)[:-1][long], abs=1e-12)
    curve = motion.energy_curves(moving, polygons["t"])
    ledger = solution.energy(np.minimum(curve["t"], solution.t_end))
    scale = 1e-9 * ledger.total.max()
    for name, kind in (
        ("vibration, kinetic part", "vibrational_kinetic"),
        ("strain", "strain"),
        ("moving as a whole", "kinetic"),
        ("total", "total"),
    ):
        assert curve[name] == pytest.approx(getattr(ledger, kind), abs=scale)


# Tables


def changed(path, value):
    """A case of two rods and a wall with another number."""
    case = {
        "schema": 1,
        "bodies": [{**ROD}, {**ROD, "velocity": 0.0}, {**WALL}],
        "contacts": [{"gap": 0.0, "law": "rigid"}, {"gap": 1e-5, "law": "rigid"}],
        "materials": {"own": {"youngs_modulus": 1e11, "density": 5e3}},
    }
    *inside, last = path
    reduce(operator.getitem, inside, case)[last] = value
    return case


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (["bodies", 0, "length"], -1.0),
        (["bodies", 1, "area"], 0.0),
        (["bodies", 0, "length"], float("nan")),
        (["bodies", 0, "velocity"], float("inf")),
        (["bodies", 2, "velocity"], float("nan")),
        (["contacts", 1, "gap"], -1e-6),
        (["materials", "own", "density"], -5.0),
        (["bodies", 0, "length"], 1e200),
        (["bodies", 0, "length"], None),
        (["bodies", 0, "length"], "x"),
    ],
)
def test_a_mistake_is_told_in_the_words_of_the_model(path, value):
    case = changed(path, value)
    ((where, sentence),) = mistakes(case, [], LIBRARY, RULES)
    with pytest.raises(ri.InvalidModel) as error:
        case_from(case)
    theirs = dict(error.value.problems)
    assert where == ".".join(map(str, path))
    assert sentence.count("got") == 1
    unread = ("cannot read", "is missing")  # a file has no null, and a text has units
    if where in theirs and not any(words in theirs[where] for words in unread):
        assert theirs[where].partition(", got")[0] == sentence.partition(", got")[0]


BODY = {"kind": "rod", "length": 0.4, "area": 1e-4, "material": "steel"}


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"gravity": 9.81, "solve": {"until": 1e-3}},
        {"bodies": [{**BODY, "area": {"samples": [1e-4, 2e-4]}}, ROD]},
        {"bodies": [{**BODY, "velocity": {"samples": [1.0, 2.0]}}, ROD]},
        {"bodies": [{**BODY, "velocity": {"values": [1.0, 2.0], "at": [0.1]}}, ROD]},
        {
            "bodies": [
                {**BODY, "polar_moment": 1e-9, "lateral_inertia": "rayleigh-love"},
                ROD,
            ]
        },
        {
            "bodies": [
                {**BODY, "polar_moment": 1e-9, "lateral_inertia": "mindlin-herrmann"},
                ROD,
            ]
        },
        {"contacts": [{"law": "bonded"}]},
        {"ends": {"left": {"kind": "fixed"}}},
        {
            "ends": {
                "left": {
                    "kind": "force",
                    "value": {"samples": [1.0, 2.0], "step": 1e-4},
                }
            },
            "solve": {"until": 1e-3},
        },
        {"solve": {"method": "finite-difference", "until": 1e-3}},
        {"solve": {"method": "fronts"}},
        {
            "materials": {
                "own": {"youngs_modulus": 1e11, "density": 5e3, "viscosity": 1e4}
            },
            "bodies": [{**BODY, "material": "own"}, ROD],
        },
        {
            "materials": {
                "idle": {"youngs_modulus": 1e11, "density": 5e3, "viscosity": 1e4}
            }
        },
    ],
)
def test_the_page_solves_what_fronts_can_carry(change):
    case = {"schema": 1, "bodies": [ROD, {**ROD, "velocity": 0.0}], **change}
    known = case_from(case)
    options = Options(known.solve.get("until"), known.solve.get("method", "auto"), 100)
    assert (lacking(case) == ("", "")) == (options.method_for(known.system) == "fronts")


HERTZ = {"law": "hertz", "stiffness": 1e10}
MASS = {"kind": "mass", "mass": 1.0}
STEPPED = {**ROD, "velocity": {"values": [1.0, 2.0], "at": [0.1]}}


@pytest.mark.parametrize(
    ("change", "path"),
    [
        ({"contacts": [HERTZ]}, ""),
        ({"solve": {"method": "characteristics"}}, ""),
        ({"bodies": [STEPPED, ROD], "contacts": [HERTZ]}, "bodies.0.velocity"),
        ({"bodies": [MASS, ROD], "solve": {"method": "fronts"}}, "bodies.0"),
        ({"contacts": [{"law": "joint", "stiffness": 1e8}]}, "contacts.0"),
        ({"contacts": [{**HERTZ, "colour": 1.0}]}, "contacts.0.colour"),
        (
            {"bodies": [MASS, MASS, ROD], "contacts": [{"law": "bonded"}, {}]},
            "contacts.0",
        ),
        (
            {
                "contacts": [HERTZ],
                "ends": {
                    "left": {
                        "kind": "velocity",
                        "value": {"values": [1.0, 2.0], "at": [1e-4]},
                    }
                },
            },
            "ends.left.value",
        ),
        ({"bodies": [{**BODY, "diameter": 0.01}, ROD]}, "bodies.0.diameter"),
        (
            {
                "bodies": [
                    {
                        "kind": "rod",
                        "segments": [
                            {**ROD, "kind": None, "velocity": None, "colour": "red"}
                        ],
                    },
                    ROD,
                ]
            },
            "bodies.0.colour",
        ),
    ],
)
def test_the_page_solves_compliant_contacts_and_masses(change, path):
    case = {"schema": 1, "bodies": [ROD, {**ROD, "velocity": 0.0}], **change}
    assert lacking(case)[0] == path


@pytest.mark.parametrize(
    ("change", "gauge", "path"),
    [
        ({"contacts": [{**HERTZ, "stiffness": -1.0}]}, None, "contacts.0.stiffness"),
        (
            {"bodies": [{**MASS, "mass": 0.0}, ROD], "contacts": [{}]},
            None,
            "bodies.0.mass",
        ),
        ({"bodies": [MASS, MASS, ROD], "contacts": [{}, {}]}, None, "contacts.0"),
        ({"bodies": [WALL, WALL], "contacts": [{}]}, None, "bodies"),
        ({"contacts": []}, None, "contacts"),
        ({"bodies": [ROD, WALL]}, {"body": 1, "fraction": 0.5}, "gauges.0.body"),
        ({"bodies": [ROD, WALL]}, {"body": 0, "fraction": 1.5}, "gauges.0.fraction"),
        ({"bodies": [ROD, WALL, ROD], "contacts": [{}, {}]}, None, "bodies.1"),
        (
            {"bodies": [{**ROD, "material": "none such"}, ROD]},
            None,
            "bodies.0.material",
        ),
        ({"contacts": [{"law": "bonded", "gap": 1e-3}]}, None, "contacts.0.gap"),
    ],
)
def test_rows_that_are_none_are_told(change, gauge, path):
    case = {"schema": 1, "bodies": [ROD, {**ROD, "velocity": 0.0}], **change}
    gauges = [gauge] if gauge else []
    assert [where for where, _ in mistakes(case, gauges, LIBRARY, RULES)] == [path]
    with pytest.raises(ri.InvalidModel) as error:
        case_from({**case, "gauges": gauges})
    assert path in dict(error.value.problems)
