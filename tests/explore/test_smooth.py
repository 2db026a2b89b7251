"""Compliant contacts and rigid masses on the page: characteristics as JavaScript."""

import functools
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
from rodimpact.explorer.pieces import run_with_errors, solve_by_pieces
from rodimpact.explorer.solved import scene_of_solution
from rodimpact.explorer.solver import CONSTANTS, PROVIDED
from rodimpact.explorer.tables import lacking, mistakes, request_of, system_of
from rodimpact.methods.pieces.accuracy import measures_of, rounding_errors
from rodimpact.methods.row_builder import build_row

STEEL = ri.materials.steel
ALUMINIUM = ri.materials.aluminium


def random_law(rng):
    """A compliant contact law that is not plastic."""
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
        bodies.append(random_body(rng, is_first=i == 0))
    if rng.random() < 0.2:
        bodies.append(ri.Wall())
    contacts = []
    for left, right in pairwise(bodies):
        has_rod = isinstance(left, ri.Rod) or isinstance(right, ri.Rod)
        if has_rod and rng.random() < 0.2:
            contacts.append(ri.Rigid())
        else:
            contacts.append(random_law(rng))
    gaps = []
    for _ in contacts:
        gap = 0.0
        if rng.random() < 0.3:
            gap = float(rng.uniform(0, 1e-4))
        gaps.append(gap)
    options = {}
    if rng.random() < 0.3:
        options["until"] = float(rng.uniform(5e-4, 2e-3))
    return ri.Case(ri.System(bodies, gaps, contacts), options)


def random_body(rng, is_first):
    """A rod, of one or two segments, or a mass; the first one moves to the right."""
    if is_first:
        return ri.Rod(segments=random_segments(rng), velocity=1.0)
    velocity = float(rng.uniform(-1, 1))
    if rng.random() < 0.25:
        return ri.RigidMass(10.0 ** rng.uniform(-2, 0), velocity=velocity)
    return ri.Rod(segments=random_segments(rng), velocity=velocity)


def random_segments(rng):
    """One segment or two, with no common measure of transit times."""
    count = 1
    if rng.random() < 0.15:
        count = 2
    segments = []
    for _ in range(count):
        length = rng.uniform(0.1, 1.0)
        area = 1e-4 * rng.uniform(0.5, 2.0)
        material = ALUMINIUM
        if rng.random() < 0.7:
            material = STEEL
        segments.append(ri.Segment(length, area, material))
    return segments


def tables_of(case):
    """A case as the page gets it."""
    return {"solve": {}, **tomllib.loads(ri.format_case(case))}


@functools.cache
def script_of_the_page():
    """The solver of the page, and the scenes that it makes of cases."""
    functions = (
        system_of,
        request_of,
        lacking,
        mistakes,
        solve_by_pieces,
        scene_of_solution,
    )
    text = javascript(functions, CONSTANTS, PROVIDED)
    return f"""{read("python.js")}\n{read("numbers.js")}\n{text}
    const answer = ({{ cases, gauges, library }}) => cases.map((tables) => {{
      if (lacking(tables)[0] || mistakes(tables, gauges, library).length) return null;
      const system = system_of(tables, library);
      const solution = solve_by_pieces(system, request_of(tables), 1e-8);
      return {{ ...scene_of_solution(system, gauges, solution), outcome: solution.outcome }};
    }});"""


def solved_by_the_page(cases, gauges=()):
    """Scenes that the page makes of cases, each with its outcome; None for a case that
    it cannot solve.
    """
    data = {
        "cases": [tables_of(case) for case in cases],
        "gauges": list(gauges),
        "library": LIBRARY,
    }
    return run(script_of_the_page(), data)


def solve(case):
    return ri.solve(
        case.system, **case.solve, method="characteristics", max_events=20_000
    )


@needs_node
@pytest.mark.parametrize("seed", few_of(range(18), {11, 17}))
def test_random_rows_on_the_page_are_those_of_solve_within_the_stated_errors(seed):
    case = random_row(seed)
    (scene,) = solved_by_the_page([case])
    solution = solve(case)
    check_velocities(scene["outcome"], solution)
    check_contacts(scene["outcome"], solution)
    check_energies(scene["outcome"], solution.outcome)


@pytest.mark.exhaustive
@needs_node
def test_late_contacts_on_the_page_are_rounded_within_their_stated_error():
    """Rounded transit times of the page's clock have added up there."""
    cases = [random_row(seed) for seed in (24, 71)]
    for case, scene in zip(cases, solved_by_the_page(cases), strict=True):
        solution = ri.solve(case.system, method="characteristics", rtol=1e-11)
        check_velocities(scene["outcome"], solution)
        check_contacts(scene["outcome"], solution)


def test_the_errors_of_velocity_and_duration_count_rounded_transit_times():
    """Later events make both larger, and shorter contacts as well."""
    transit_error = 1e-12  # relative
    rods = [
        ri.Rod(1.0, area=1e-4, material=STEEL, velocity=1.0),
        ri.Rod(0.7, area=1e-4, material=STEEL),
    ]
    system = ri.System(rods, contacts=[ri.Spring(1e9)], gaps=[1e-5])
    tables = tables_of(ri.Case(system, {}))
    run = run_with_errors(
        build_row(system_of(tables, LIBRARY)), request_of(tables), 1e-8, np.inf
    )

    velocity, _, _, duration, time = rounding_errors(run["ended"], transit_error)

    _, _, _, (contact_duration,), times = measures_of(run["ended"])
    last_over_duration = max(times) / contact_duration
    assert time == transit_error
    assert velocity == pytest.approx(transit_error * (1 + last_over_duration))
    assert duration == pytest.approx(transit_error * (1 + 2 * last_over_duration))


def check_velocities(page, solution):
    """Velocities and e on the page are those of a solution, within both stated
    errors.
    """
    outcome = solution.outcome
    accuracy = solution.accuracy["velocity"] * solution.fields.clock.scale
    tolerance = accuracy + page["errors"]["velocity"]
    assert page["final"] == outcome.final
    assert page["before"] == pytest.approx(outcome.velocities_before, abs=1e-12)
    assert page["after"] == pytest.approx(
        outcome.velocities_after, rel=0, abs=tolerance
    )
    has_e = outcome.why_no_restitution() == ""
    assert (page["why"] == "") == has_e
    if has_e:
        e = outcome.restitution
        round_off = 1e-12
        assert page["restitution"] == pytest.approx(e, abs=page["error"] + round_off)


def check_contacts(page, solution):
    """Totals of the contacts on the page are those of a solution, within both
    errors.
    """
    tallies = solution.outcome.contacts
    for key in ("impulse", "peak_force", "duration"):
        values = [getattr(tally, key) for tally in tallies]
        accuracy = solution.accuracy[key.replace("_", " ")]
        tolerance = accuracy * max(values) + page["errors"][key]
        shown = [contact[key] for contact in page["contacts"]]
        assert shown == pytest.approx(values, rel=0, abs=tolerance)
    for contact, tally in zip(page["contacts"], tallies, strict=True):
        # Many episodes are grazes, of which another clock may count more or fewer.
        if tally.episodes <= 20:
            assert contact["episodes"] == tally.episodes


def check_energies(page, outcome):
    """Energies on the page are those of an outcome, within the stated error."""
    before = outcome.kinetic_before + sum(outcome.vibration_before)
    tolerance = page["errors"]["energy"] + 1e-12 * before
    vibration = sum(outcome.vibration_after)
    assert page["energy_before"] == pytest.approx(before, rel=1e-12)
    assert page["vibration_after"] == pytest.approx(vibration, rel=1e-9, abs=tolerance)


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


@pytest.mark.exhaustive
@needs_node
@pytest.mark.parametrize("name", few_of(PICTURES, {"ends"}))
def test_grids_paths_and_curves_of_the_page_are_those_of_the_solution(name):
    options = {}
    if name == "ends":
        options["until"] = 6e-4  # a driven run needs an end
    case = ri.Case(PICTURES[name], options)
    rods = [i for i, body in enumerate(case.system.bodies) if isinstance(body, ri.Rod)]
    last_rod = rods[-1]
    (scene,) = solved_by_the_page([case], [{"body": last_rod, "fraction": 0.3}])
    solution = solve(case)
    energy, gauge = scene["plots"]
    check_grids(scene["tiling"], solution)
    check_paths(scene["bodies"], solution)
    check_forces_and_gaps(scene["contacts"], solution)
    check_energy_curves(energy["series"], solution)
    check_gauge(gauge["series"][0], solution, last_rod)


def middles_of(times):
    return (np.array(times)[1:] + np.array(times)[:-1]) / 2


def check_grids(grids, solution):
    """Points of the grids are displaced as in the solution."""
    assert max(grids["t"]) == pytest.approx(solution.t_end, rel=1e-9)
    for g, body in enumerate(grids["body"]):
        points = slice(grids["start"][g], grids["start"][g + 1])
        x = np.array(grids["x"][points])
        t = np.minimum(grids["t"][points], solution.t_end)
        shown = np.array(grids["displacement"][points])
        displacement = solution.displacement(body, x, t)
        tolerance = 1e-13 + 1e-7 * max(abs(shown))
        assert shown == pytest.approx(displacement, abs=tolerance)


def check_paths(bodies, solution):
    """Masses and walls move as in the solution; rods have no path."""
    for i, body in enumerate(solution.system.bodies):
        path = bodies[i]["path"]
        assert (path is None) == isinstance(body, ri.Rod)
        if path is not None:
            t = np.minimum(path["t"], solution.t_end)
            displacement = solution.displacement(i, 0.0, t)
            assert path["displacement"] == pytest.approx(
                displacement, rel=1e-6, abs=1e-12
            )


def check_forces_and_gaps(contacts, solution):
    """Curves of the contacts are those of the solution; an impact has no force."""
    peaks = [contact.peak_force for contact in solution.contacts]
    tolerance = 0.02 * np.nanmax(peaks)
    for contact, page in zip(solution.contacts, contacts, strict=True):
        force = page["force"]
        if not np.isnan(contact.peak_force):
            middles = middles_of(force["t"])
            shown = np.interp(middles, force["t"], force["y"])
            assert shown == pytest.approx(contact.force(middles), abs=tolerance)
        t = np.minimum(page["gap"]["t"], solution.t_end)
        assert page["gap"]["y"] == pytest.approx(contact.gap(t), abs=1e-11)


KIND_OF_ENERGY = {
    "moving as a whole": "kinetic",
    "vibration, kinetic part": "vibrational_kinetic",
    "strain energy": "strain",
    "total": "total",
    "in compliant contacts": "contact",
}


def check_energy_curves(curves, solution):
    """Energies are those of the ledger; the strain energy is a sum over few points."""
    ledger = solution.energy(np.minimum(curves[0]["t"], solution.t_end))
    for curve in curves:
        kind = KIND_OF_ENERGY[curve["name"]]
        rtol = 1e-6
        if kind in ("strain", "vibrational_kinetic"):
            rtol = 0.003
        energy = getattr(ledger, kind)[1:]
        tolerance = rtol * ledger.total.max()
        assert curve["y"][1:] == pytest.approx(energy, abs=tolerance)


def check_gauge(curve, solution, body):
    """A gauge at 0.3 of a rod records the strain of the solution, in 1e-6."""
    x = 0.3 * solution.system.bodies[body].length
    middles = middles_of(curve["t"])[np.diff(curve["t"]) > 0]
    strain = 1e6 * solution.gauge(body, x).strain_at(middles)
    shown = np.interp(middles, curve["t"], curve["y"])
    assert shown == pytest.approx(strain, abs=0.01 * max(abs(strain)))
