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
    """A case of two to four random bodies, sometimes with a wall behind them; contacts
    are compliant, or rigid beside a rod; some cases have an end, `until`. Not solved.
    """
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
    """One random segment, or two in 15 % of the cases, of steel or aluminium, as a
    list.
    """
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
    """The solution of a case by characteristics."""
    return ri.solve(
        case.system, **case.solve, method="characteristics", max_events=20_000
    )


@needs_node
@pytest.mark.parametrize("seed", few_of(range(18), {11}))
def test_random_rows_on_the_page_are_those_of_solve_within_the_stated_errors(seed):
    """Velocities, contacts and energies of a random row on the page are those of
    `solve`, to the stated errors.
    """
    case = random_row(seed)
    (scene,) = solved_by_the_page([case])
    solution = solve(case)
    check_velocities(scene["outcome"], solution)
    check_contacts(scene["outcome"], solution)
    check_energies(scene["outcome"], solution.outcome)


@pytest.mark.exhaustive
@needs_node
def test_late_contacts_on_the_page_are_rounded_within_their_stated_error():
    """Two rows with late contacts, when the errors of the page's clock, which rounds
    transit times, have added up: velocities and contacts agree with `solve` to the
    stated errors.
    """
    cases = [random_row(seed) for seed in (24, 71)]
    scenes = solved_by_the_page(cases)
    for case, scene in zip(cases, scenes, strict=True):
        solution = ri.solve(case.system, method="characteristics", rtol=1e-11)
        check_velocities(scene["outcome"], solution)
        check_contacts(scene["outcome"], solution)


def test_the_errors_of_velocity_and_duration_count_rounded_transit_times():
    """Later events make both larger, and shorter contacts as well."""
    transit_error = 1e-12  # relative
    striker = ri.Rod(1.0, area=1e-4, material=STEEL, velocity=1.0)
    struck = ri.Rod(0.7, area=1e-4, material=STEEL)
    system = ri.System([striker, struck], contacts=[ri.Spring(1e9)], gaps=[1e-5])
    tables = tables_of(ri.Case(system, {}))
    row = build_row(system_of(tables, LIBRARY))
    run = run_with_errors(row, request_of(tables), 1e-8, np.inf)
    ended = run["ended"]

    velocity, _, _, duration, time = rounding_errors(ended, transit_error)

    _, _, _, (contact_duration,), times = measures_of(ended)
    last_over_duration = max(times) / contact_duration
    velocity_error = transit_error * (1 + last_over_duration)
    duration_error = transit_error * (1 + 2 * last_over_duration)
    assert time == transit_error
    assert velocity == pytest.approx(velocity_error)
    assert duration == pytest.approx(duration_error)


def check_velocities(page, solution):
    """Velocities and e on the page are those of a solution, within both stated
    errors.
    """
    outcome = solution.outcome
    assert page["final"] == outcome.final
    before = outcome.velocities_before
    assert page["before"] == pytest.approx(before, abs=1e-12)
    after = outcome.velocities_after
    error_of_solution = solution.accuracy["velocity"] * solution.fields.clock.scale
    tolerance = error_of_solution + page["errors"]["velocity"]
    assert page["after"] == pytest.approx(after, rel=0, abs=tolerance)
    has_e = outcome.why_no_restitution() == ""
    page_has_e = page["why"] == ""
    assert page_has_e == has_e
    if has_e:
        e = outcome.restitution
        round_off = 1e-12
        tolerance = page["error"] + round_off
        assert page["restitution"] == pytest.approx(e, abs=tolerance)


def check_contacts(page, solution):
    """Totals of the contacts on the page are those of a solution, within both
    errors.
    """
    tallies = solution.outcome.contacts
    for key in ("impulse", "peak_force", "duration"):
        values = [getattr(tally, key) for tally in tallies]
        accuracy = solution.accuracy[key.replace("_", " ")]
        tolerance = accuracy * max(values) + page["errors"][key]
        values_on_page = [contact[key] for contact in page["contacts"]]
        assert values_on_page == pytest.approx(values, rel=0, abs=tolerance)
    for contact, tally in zip(page["contacts"], tallies, strict=True):
        # Many episodes are grazes, of which another clock may count more or fewer.
        if tally.episodes <= 20:
            assert contact["episodes"] == tally.episodes


def check_energies(page, outcome):
    """Assert that the energies on the page are those of an outcome: before to 1e-12,
    after within the stated error.
    """
    before = outcome.kinetic_before + sum(outcome.vibration_before)
    assert page["energy_before"] == pytest.approx(before, rel=1e-12)
    vibration = sum(outcome.vibration_after)
    round_off = 1e-12 * before
    tolerance = page["errors"]["energy"] + round_off
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
    """The page solves a case with smooth waves: fields, paths of bodies, forces, gaps,
    energies and the record of a gauge agree with the solution in Python.
    """
    options = {}
    if name == "ends":
        options["until"] = 6e-4  # a driven run needs an end
    case = ri.Case(PICTURES[name], options)
    bodies = case.system.bodies
    *_, last_rod = [i for i, body in enumerate(bodies) if isinstance(body, ri.Rod)]
    gauge = {"body": last_rod, "fraction": 0.3}
    (scene,) = solved_by_the_page([case], [gauge])
    solution = solve(case)
    check_grids(scene["tiling"], solution)
    check_paths(scene["bodies"], solution)
    check_forces_and_gaps(scene["contacts"], solution)
    energy_plot, gauge_plot = scene["plots"]
    check_energy_curves(energy_plot["series"], solution)
    (gauge_curve,) = gauge_plot["series"]
    check_gauge(gauge_curve, solution, last_rod)


def middles_of(times):
    """Middles of the intervals between times, one fewer than times."""
    times = np.array(times)
    return (times[1:] + times[:-1]) / 2


def check_grids(grids, solution):
    """Points of the grids are displaced as in the solution."""
    end = solution.t_end
    starts = grids["start"]  # of the points of each grid
    assert max(grids["t"]) == pytest.approx(end, rel=1e-9)
    for g, body in enumerate(grids["body"]):
        points = slice(starts[g], starts[g + 1])
        x = np.array(grids["x"][points])
        t = np.minimum(grids["t"][points], end)  # without round-off
        on_page = np.array(grids["displacement"][points])
        displacement = solution.displacement(body, x, t)
        tolerance = 1e-13 + 1e-7 * max(abs(on_page))
        assert on_page == pytest.approx(displacement, abs=tolerance)


def check_paths(bodies, solution):
    """Masses and walls move as in the solution; rods have no path."""
    for i, body in enumerate(solution.system.bodies):
        path = bodies[i]["path"]
        if isinstance(body, ri.Rod):
            assert path is None
            continue
        t = np.minimum(path["t"], solution.t_end)  # without round-off
        displacement = solution.displacement(i, 0.0, t)
        on_page = path["displacement"]
        assert on_page == pytest.approx(displacement, rel=1e-6, abs=1e-12)


def check_forces_and_gaps(contacts, solution):
    """Curves of the contacts are those of the solution; an impact has no force."""
    peaks = [contact.peak_force for contact in solution.contacts]
    tolerance = 0.02 * np.nanmax(peaks)
    for contact, page in zip(solution.contacts, contacts, strict=True):
        force_curve = page["force"]
        if not np.isnan(contact.peak_force):
            times = force_curve["t"]
            middles = middles_of(times)
            force_on_page = np.interp(middles, times, force_curve["y"])
            force = contact.force(middles)
            assert force_on_page == pytest.approx(force, abs=tolerance)
        gap_curve = page["gap"]
        t = np.minimum(gap_curve["t"], solution.t_end)  # without round-off
        gap = contact.gap(t)
        assert gap_curve["y"] == pytest.approx(gap, abs=1e-11)


KIND_OF_ENERGY = {
    "moving as a whole": "kinetic",
    "vibration, kinetic part": "vibrational_kinetic",
    "strain energy": "strain",
    "total": "total",
    "in compliant contacts": "contact",
}


def check_energy_curves(curves, solution):
    """Assert that the energies at all times but the first are those of the ledger, to
    1e-6 of the total; strain and vibration, sums over few points, to 0.3 %.
    """
    first_curve, *_ = curves
    times = np.minimum(first_curve["t"], solution.t_end)  # the same for all curves
    ledger = solution.energy(times)
    for curve in curves:
        kind = KIND_OF_ENERGY[curve["name"]]
        rtol = 1e-6
        if kind in ("strain", "vibrational_kinetic"):
            rtol = 0.003
        tolerance = rtol * ledger.total.max()
        energy = getattr(ledger, kind)
        _, *after_start = energy
        _, *on_page = curve["y"]
        assert on_page == pytest.approx(after_start, abs=tolerance)


def check_gauge(curve, solution, body):
    """A gauge at 0.3 of a rod records the strain of the solution, in 1e-6."""
    x = 0.3 * solution.system.bodies[body].length
    times = curve["t"]
    lasts = np.diff(times) > 0  # a jump has two points at one time
    middles = middles_of(times)[lasts]
    strain = 1e6 * solution.gauge(body, x).strain_at(middles)
    strain_on_page = np.interp(middles, times, curve["y"])
    tolerance = 0.01 * max(abs(strain))
    assert strain_on_page == pytest.approx(strain, abs=tolerance)
