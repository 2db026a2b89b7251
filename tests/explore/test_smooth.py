"""Compliant contacts and rigid masses on the page: characteristics as JavaScript."""

import tomllib
from itertools import pairwise

import numpy as np
import pytest
from exhaustive import few_of
from in_node import needs_node, run

import rodimpact as ri
from rodimpact.explorer.design import LIBRARY
from rodimpact.explorer.javascript import javascript
from rodimpact.explorer.page_files import read
from rodimpact.explorer.pieces import solved_by_pieces
from rodimpact.explorer.solved import shown_of
from rodimpact.explorer.solver import CONSTANTS, KNOWN
from rodimpact.explorer.tables import RULES, lacking, mistakes, request_of, system_of

STEEL, ALUMINIUM = ri.materials.steel, ri.materials.aluminium


def random_law(rng):
    k = 10.0 ** rng.uniform(6, 10)
    return [
        ri.Spring(k),
        ri.SpringDashpot(k, damping=10.0 ** rng.uniform(0, 4)),
        ri.Hertz(100 * k),
        ri.HuntCrossley(100 * k, damping=rng.uniform(0.01, 0.5)),
        ri.PowerLaw(k, exponent=rng.uniform(1.0, 2.0)),
    ][rng.integers(5)]


def random_row(seed):
    """Two to four rods, masses and walls, with compliant contacts or masses."""
    rng = np.random.default_rng(seed)
    bodies = []
    for i in range(rng.integers(2, 5)):
        speed = float(rng.uniform(-1, 1)) if i else 1.0
        if i and rng.random() < 0.25:
            bodies.append(ri.RigidMass(10.0 ** rng.uniform(-2, 0), velocity=speed))
        else:
            segments = [
                ri.Segment(
                    rng.uniform(0.1, 1.0),
                    1e-4 * rng.uniform(0.5, 2.0),
                    STEEL if rng.random() < 0.7 else ALUMINIUM,
                )
                for _ in range(1 + (rng.random() < 0.15))
            ]
            bodies.append(ri.Rod(segments=segments, velocity=speed))
    if rng.random() < 0.2:
        bodies.append(ri.Wall())
    contacts = []
    for pair in pairwise(bodies):
        rods = any(isinstance(body, ri.Rod) for body in pair)
        contacts.append(ri.Rigid() if rods and rng.random() < 0.2 else random_law(rng))
    gaps = [
        float(rng.uniform(0, 1e-4)) if rng.random() < 0.3 else 0.0 for _ in contacts
    ]
    until = float(rng.uniform(5e-4, 2e-3)) if rng.random() < 0.3 else None
    return ri.Case(
        ri.System(bodies, gaps, contacts), {} if until is None else {"until": until}
    )


def tables_of(case):
    return {"solve": {}, **tomllib.loads(ri.write_case(case))}


def known_by_the_page(cases, gauges=()):
    """What the page knows of cases."""
    functions = (system_of, request_of, lacking, mistakes, solved_by_pieces, shown_of)
    text = javascript(functions, CONSTANTS, KNOWN)
    script = f"""{read("python.js")}\n{read("numbers.js")}\n{text}
    const answer = ({{ cases, gauges, library, rules }}) => cases.map((tables) => {{
      if (lacking(tables)[0] || mistakes(tables, gauges, library, rules).length) return null;
      const system = system_of(tables, library);
      const solved = solved_by_pieces(system, request_of(tables), 1e-8);
      return {{ ...shown_of(system, gauges, solved), outcome: solved.outcome }};
    }});"""
    given = {
        "cases": [*map(tables_of, cases)],
        "gauges": list(gauges),
        "library": LIBRARY,
        "rules": RULES,
    }
    return run(script, given)


def solve(case):
    return ri.solve(
        case.system, **case.solve, method="characteristics", max_events=20_000
    )


@needs_node
@pytest.mark.parametrize("block", few_of(range(3), {0}))
def test_random_rows_within_the_stated_error(block):
    cases = [random_row(seed) for seed in range(10 * block, 10 * block + 10)]
    for case, page in zip(cases, known_by_the_page(cases), strict=True):
        solution, found = solve(case), page["outcome"]
        outcome, own = solution.outcome, solution.accuracy
        assert found["final"] == outcome.final
        assert (found["why"] == "") == (outcome.why_no_restitution() == "")
        speed = (
            own["velocity"] * solution.fields.clock.scale + found["errors"]["velocity"]
        )
        assert found["after"] == pytest.approx(
            outcome.velocities_after, rel=0, abs=speed
        )
        assert found["before"] == pytest.approx(outcome.velocities_before, abs=1e-12)
        for key, name in (
            ("impulse", "impulse"),
            ("peak_force", "peak force"),
            ("duration", "duration"),
        ):
            theirs = [getattr(tally, key) for tally in outcome.contacts]
            off = own[name] * max(theirs) + found["errors"][key]
            assert [c[key] for c in found["contacts"]] == pytest.approx(
                theirs, rel=0, abs=off
            )
        for c, tally in zip(found["contacts"], outcome.contacts, strict=True):
            assert (
                c["episodes"] == tally.episodes or tally.episodes > 20
            )  # with grazes among them
        before = outcome.kinetic_before + sum(outcome.vibration_before)
        assert found["energy_before"] == pytest.approx(before, rel=1e-12)
        assert found["vibration_after"] == pytest.approx(
            sum(outcome.vibration_after),
            rel=1e-9,
            abs=found["errors"]["energy"] + 1e-12 * before,
        )
        if not found["why"]:
            assert found["restitution"] == pytest.approx(
                outcome.restitution, abs=found["error"] + 1e-12
            )


ROD = ri.Rod(0.4, area=1e-4, material=STEEL, velocity=1.0)
PICTURES = {
    "hertz": ri.System([ROD, ROD.replace(velocity=-0.2)], contacts=[ri.Hertz(1e10)]),
    "strained": ri.System(
        [ROD.replace(strain=1e-5), ri.RigidMass(0.5), ri.Wall()],
        [1e-5, 2e-5],
        [ri.Spring(1e9), ri.Hertz(1e11)],
    ),
    "ends": ri.System(
        [ROD, ROD],
        contacts=[ri.SpringDashpot(1e8, damping=500.0)],
        ends=(ri.Moved(0.5), ri.Absorbing()),
    ),
    "blow": ri.System(
        [ri.RigidMass(0.5, velocity=2.0), ri.RigidMass(0.5, velocity=1.0), ROD],
        [0.0, 1e-5],
        [ri.Rigid(restitution=0.8), ri.Rigid()],
    ),
}


@needs_node
@pytest.mark.parametrize("name", PICTURES)
def test_the_picture_is_that_of_the_solution(name):
    driven = name == "ends"
    case = ri.Case(PICTURES[name], {"until": 6e-4} if driven else {})
    rods = [i for i, body in enumerate(case.system.bodies) if isinstance(body, ri.Rod)]
    (page,) = known_by_the_page([case], [{"body": rods[-1], "fraction": 0.3}])
    solution, polygons = solve(case), page["tiling"]
    assert max(polygons["t"]) == pytest.approx(solution.t_end, rel=1e-9)
    for g, body in enumerate(polygons["body"]):
        inside = slice(*polygons["start"][g : g + 2])
        x, t, u = (
            np.array(polygons[key][inside]) for key in ("x", "t", "displacement")
        )
        known = solution.displacement(body, x, np.minimum(t, solution.t_end))
        assert u == pytest.approx(known, abs=1e-13 + 1e-7 * max(abs(u)))
    for i, body in enumerate(page["bodies"]):
        assert (body["path"] is None) == (i in rods)
        if body["path"] is not None:
            t = np.minimum(body["path"]["t"], solution.t_end)
            assert body["path"]["displacement"] == pytest.approx(
                solution.displacement(i, 0.0, t), rel=1e-6, abs=1e-12
            )
    energy, gauge = (plot["series"] for plot in page["plots"])
    scale = max(
        contact.peak_force
        for contact in solution.contacts
        if contact.peak_force == contact.peak_force
    )
    for contact, told in zip(solution.contacts, page["contacts"], strict=True):
        curve, opening = told["force"], told["gap"]
        middles = (np.array(curve["t"])[1:] + np.array(curve["t"])[:-1]) / 2
        if contact.peak_force == contact.peak_force:  # a blow has none
            shown = np.interp(middles, curve["t"], curve["y"])
            assert shown == pytest.approx(contact.force(middles), abs=0.02 * scale)
        t = np.minimum(opening["t"], solution.t_end)
        assert opening["y"] == pytest.approx(contact.gap(t), abs=1e-11)
    t = np.minimum(energy[0]["t"], solution.t_end)
    ledger = solution.energy(t)
    whole = ledger.total.max()
    for curve in energy:
        kind = {
            "moving as a whole": "kinetic",
            "vibration, kinetic part": "vibrational_kinetic",
            "in compliant contacts": "contact",
        }.get(curve["name"], curve["name"])
        off = (
            0.003 if kind in ("strain", "vibrational_kinetic") else 1e-6
        )  # at even places
        assert curve["y"][1:] == pytest.approx(
            getattr(ledger, kind)[1:], abs=off * whole
        )
    x = 0.3 * case.system.bodies[rods[-1]].length
    middles = (np.array(gauge[0]["t"])[1:] + np.array(gauge[0]["t"])[:-1]) / 2
    middles = middles[np.diff(gauge[0]["t"]) > 0]
    known = 1e6 * solution.gauge(rods[-1], x).strain_at(middles)
    shown = np.interp(middles, gauge[0]["t"], gauge[0]["y"])
    assert shown == pytest.approx(known, abs=0.01 * max(abs(known)))
