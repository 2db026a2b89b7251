"""Results that the page computes around the kernels are those of the solution."""

import tomllib
from typing import NamedTuple

import numpy as np
import pytest
from exhaustive import few_of
from systems import random_system

import rodimpact as ri
from rodimpact.explorer import fronts
from rodimpact.explorer import motion as motions
from rodimpact.explorer.design import LIBRARY
from rodimpact.explorer.facts import locate_gauge
from rodimpact.explorer.tables import (
    PageSystem,
    lacking,
    mistakes,
    request_of,
    system_of,
)
from rodimpact.methods.fronts.family_layout import lay_out_family
from rodimpact.methods.registry import Options
from rodimpact.methods.row_builder import build_row
from rodimpact.methods.status import with_advice
from rodimpact.results.front_polygons import polygons_of
from rodimpact.results.regions import regions_of
from rodimpact.storage.case_reading import case_from

STEEL = ri.materials.steel
ROD = {"kind": "rod", "length": 0.4, "area": 1e-4, "material": "steel", "velocity": 1.0}
WALL = {"kind": "wall", "velocity": 0.0}
STEPS = ri.Steps([1e3, 0.0, 5e2], [1e-4, 2e-4])


def tables_of(system, **solve):
    """A case as the page gets it, with options of the run."""
    return {**tomllib.loads(ri.format_case(system)), "solve": solve}


def rows():
    """17 systems with options of their runs: random ones, driven ends, and bonds."""
    pairs = []
    for seed in range(12):
        options = {}
        if seed % 2 == 1:
            options["until"] = 3e-4
        system = random_system(seed)
        pairs.append((system, options))
    striker = ri.Rod(0.4, area=1e-4, material=STEEL, velocity=1.0)
    struck = striker.replace(velocity=0.0)
    wave = ri.Steps([1e-4, 0.0], [5e-5])
    options = {"until": 6e-4}
    for ends in (
        (ri.Fixed(), ri.Absorbing()),
        (ri.Pushed(STEPS), ri.Free()),
        (ri.Incoming(wave), ri.Fixed()),
        (ri.Moved(0.5), ri.Free()),
    ):
        with_ends = ri.System([striker, struck], ends=ends)
        pairs.append((with_ends, options))
    bodies = [ri.Wall(), striker, struck, ri.Wall()]
    bonds = [ri.Bonded()] * 3
    bonded = ri.System(bodies, contacts=bonds)
    pairs.append((bonded, options))
    return pairs


class SolvedTwice(NamedTuple):
    """A system that the page and the package have solved."""

    system: ri.System
    page_system: PageSystem
    run: fronts.PageRun
    solution: ri.Solution


@pytest.fixture(scope="module", params=few_of(range(17), {1, 12, 14, 16}))
def solved_twice(request):
    """One of `rows`, solved as the page does and by the package."""
    system, options = rows()[request.param]
    case = tables_of(system, **options)
    page_system = system_of(case, LIBRARY)
    layout = lay_out_family(build_row(page_system))
    collision = fronts.new_run(layout)
    run = fronts.run_to_end(request_of(case), run_past_proof=True, run=collision)
    solution = ri.solve(system, **options, max_events=20_000)
    return SolvedTwice(system, page_system, run, solution)


@pytest.fixture
def motion(solved_twice):
    """The motion that the page shows of the run; a run that lasts no time is skipped."""
    motion = fronts.motion_of_fronts(solved_twice.run)
    if motion["now"] == 0:
        pytest.skip("the run lasts no time")
    return motion


def tiling_of(motion):
    """The polygons of a motion from its start to its end."""
    rods = motion["rods"]
    start = 0  # ticks
    return polygons_of(rods, motion["tick"], motion["frame"], start, motion["now"])


def intervals_of(times):
    """Middles of the intervals between times, and whether each one lasts: a jump has
    no duration.
    """
    starts = np.asarray(times)[:-1]
    durations = np.diff(times)
    middles = starts + durations / 2
    return middles, durations > 0


def test_the_page_lays_a_system_out_as_the_package_does(solved_twice):
    layout = lay_out_family(build_row(solved_twice.system))
    assert solved_twice.run.layout[1:] == layout[1:]


def test_the_outcome_on_the_page_is_that_of_the_solution(solved_twice):
    """The page has the same sentences, except for advice to users of Python."""
    run = solved_twice.run
    solution = solved_twice.solution
    outcome = solution.outcome

    page = fronts.outcome_of(run, fronts.status_of(run))

    why = fronts.why_ended(run)
    status = page["status"].replace(why.statement, with_advice(why))
    assert status == solution.status
    no_restitution = outcome.why_no_restitution().removesuffix(f" {why.advice}")
    assert page["why"] == no_restitution
    velocities_after = list(outcome.velocities_after)
    assert page["after"] == velocities_after
    vibration_after = sum(outcome.vibration_after)
    assert page["vibration_after"] == pytest.approx(vibration_after, rel=1e-12)
    energy_before = outcome.kinetic_before + sum(outcome.vibration_before)
    assert page["energy_before"] == pytest.approx(energy_before, rel=1e-12)


def test_polygons_on_the_page_are_the_regions_of_the_solution(solved_twice, motion):
    """The polygons of the page at a time have bodies, corners and fields of the regions
    of the solution, bit for bit.
    """
    solution = solved_twice.solution
    polygons = tiling_of(motion)
    stop = motion["now"] * solution.fields.clock.tick
    regions = regions_of(solution, stop=stop)
    names = "body start x t displacement velocity strain stress"
    for name in names.split():
        expected = getattr(regions, name)
        np.testing.assert_array_equal(polygons[name], expected)


def test_forces_and_gaps_on_the_page_are_those_of_the_contacts(solved_twice, motion):
    """The force is constant between jumps: it is the same at both ends of an interval."""
    stop = motion["now"]  # ticks
    contacts = solved_twice.solution.contacts
    curves = fronts.contact_curves(solved_twice.run, stop)
    for curve, contact in zip(curves, contacts, strict=True):
        times, force = map(np.array, curve["force"].values())
        end = times[-1]
        assert times[0] == 0.0
        assert end == stop * motion["tick"]
        last_force = contact.force(end)
        assert force[-1] == pytest.approx(last_force, rel=1e-9, abs=1e-9)
        middles, lasts = intervals_of(times)
        expected = contact.force(middles)[lasts]
        force_at_starts = force[:-1][lasts]
        force_at_ends = force[1:][lasts]
        assert expected == pytest.approx(force_at_starts, rel=1e-9, abs=1e-9)
        assert expected == pytest.approx(force_at_ends, rel=1e-9, abs=1e-9)
        if curve["gap"] is not None:
            gap_times, gap = curve["gap"].values()
            expected_gap = contact.gap(gap_times)
            assert gap == pytest.approx(expected_gap, abs=1e-15)


def test_a_gauge_on_the_page_records_the_strain_of_the_solution(solved_twice, motion):
    """A gauge at 0.3 of the length of the first rod: the strain of the page is that of
    the solution in each of its intervals.
    """
    bodies = solved_twice.system.bodies
    body = 0
    while not isinstance(bodies[body], ri.Rod):
        body += 1
    gauge = {"body": body, "fraction": 0.3}
    location = locate_gauge(solved_twice.page_system, gauge)
    first_segment, *_ = motion["row"].spans[body]  # the row counts segments from 1
    segment = first_segment - 1 + location.segment

    times, strain = motions.gauge_curve(motion, segment, location.x).values()

    middles, lasts = intervals_of(times)
    x = 0.3 * bodies[body].length
    record = solved_twice.solution.gauge(body, x).strain_at(middles)
    strain_at_starts = np.array(strain)[:-1]
    assert record[lasts] == pytest.approx(strain_at_starts[lasts], abs=1e-12)


def test_energies_on_the_page_are_those_of_the_ledger(solved_twice, motion):
    """The curves of energy that the explorer computes for the page are, at the times of
    these curves, those of `solution.energy`; the energy in contacts is not compared.
    """
    solution = solved_twice.solution

    corner_times = tiling_of(motion)["t"]  # s, when waves meet: energies change then
    energies = motions.energy_curves(motion, corner_times)

    # By round-off, the last time may be beyond the end of the solution.
    times = np.minimum(energies["t"], solution.t_end)
    ledger = solution.energy(times)
    tolerance = 1e-9 * ledger.total.max()
    for name, kind in (
        ("vibration, kinetic part", "vibrational_kinetic"),
        ("strain energy", "strain"),
        ("moving as a whole", "kinetic"),
        ("total", "total"),
    ):
        expected = getattr(ledger, kind)
        assert energies[name] == pytest.approx(expected, abs=tolerance)


# Tables


def case_with(path, value):
    """A case of two rods and a wall, as a dict, whose number at a path is `value`."""
    case = {
        "schema": 1,
        "bodies": [{**ROD}, {**ROD, "velocity": 0.0}, {**WALL}],
        "contacts": [{"gap": 0.0, "law": "rigid"}, {"gap": 1e-5, "law": "rigid"}],
        "materials": {"own": {"youngs_modulus": 1e11, "density": 5e3}},
    }
    *keys_of_table, name = path
    table = case
    for key in keys_of_table:
        table = table[key]
    table[name] = value
    return case


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (["bodies", 0, "length"], -1.0),
        (["bodies", 1, "area"], 0.0),
        (["contacts", 1, "gap"], -1e-6),
        (["materials", "own", "density"], -5.0),
        (["bodies", 0, "length"], 1e200),
    ],
)
def test_a_wrong_number_is_told_in_the_words_of_a_case_file(path, value):
    """The page shows the number beside the sentence, which does not repeat it."""
    mistake, message_of_file = mistakes_of_page_and_file(path, value)
    assert mistake.value == value
    sentence = f"{mistake.message}{mistake.unit}"
    assert message_of_file == f"{sentence}, got {value!r}"


@pytest.mark.parametrize(
    ("path", "value", "got"),
    [
        (["bodies", 0, "length"], float("nan"), "nan"),
        (["bodies", 0, "velocity"], float("inf"), "inf"),
        (["bodies", 2, "velocity"], float("nan"), "nan"),
        (["bodies", 0, "length"], None, "no number"),
        (["bodies", 0, "length"], "x", "no number"),
    ],
)
def test_a_value_that_no_file_can_hold_is_told_in_the_words_of_the_page(
    path, value, got
):
    """A file has no null, and its texts have units: its reader has other words."""
    mistake, message_of_file = mistakes_of_page_and_file(path, value)
    assert mistake.value is None
    sentence = f"{mistake.message}{mistake.unit}"
    assert sentence.endswith(f", got {got}")
    assert message_of_file.startswith(("cannot read", "is missing"))


def mistakes_of_page_and_file(path, value):
    """The only mistake on the page, and the message of the file's reader at its
    path.
    """
    case = case_with(path, value)
    (mistake,) = mistakes(case, [], LIBRARY)
    assert mistake.path == ".".join(map(str, path))
    with pytest.raises(ri.InvalidModel) as error:
        case_from(case)
    message_by_path = dict(error.value.problems)
    return mistake, message_by_path[mistake.path]


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
                    "kind": "pushed",
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
def test_the_page_solves_by_fronts_the_cases_that_fronts_can_carry_and_no_others(
    change,
):
    """For a changed pair, `lacking` names nothing exactly if Python would choose the
    method of fronts.
    """
    case = changed_pair(change)
    model = case_from(case)
    until = model.solve.get("until")
    method = model.solve.get("method", "auto")
    options = Options(until, method, max_events=100)
    goes_by_fronts = options.method_for(model.system) == "fronts"

    path, what = lacking(case)

    lacks_nothing = path == "" and what == ""
    assert lacks_nothing == goes_by_fronts


def changed_pair(change):
    """A case of a rod that strikes its like, with these tables changed or added."""
    struck = {**ROD, "velocity": 0.0}
    return {"schema": 1, "bodies": [ROD, struck], **change}


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
                        "kind": "moved",
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
def test_the_page_solves_compliant_contacts_and_masses_or_names_what_it_lacks(
    change, path
):
    """An empty path stands for a case that the page can solve."""
    case = changed_pair(change)
    path_of_lacking, _ = lacking(case)
    assert path_of_lacking == path


@pytest.mark.parametrize(
    ("change", "gauges", "path"),
    [
        ({"contacts": [{**HERTZ, "stiffness": -1.0}]}, [], "contacts.0.stiffness"),
        (
            {"bodies": [{**MASS, "mass": 0.0}, ROD], "contacts": [{}]},
            [],
            "bodies.0.mass",
        ),
        ({"bodies": [MASS, MASS, ROD], "contacts": [{}, {}]}, [], "contacts.0"),
        ({"bodies": [WALL, WALL], "contacts": [{}]}, [], "bodies"),
        ({"contacts": []}, [], "contacts"),
        ({"bodies": [ROD, WALL]}, [{"body": 1, "fraction": 0.5}], "gauges.0.body"),
        ({"bodies": [ROD, WALL]}, [{"body": 0, "fraction": 1.5}], "gauges.0.fraction"),
        ({"bodies": [ROD, WALL, ROD], "contacts": [{}, {}]}, [], "bodies.1"),
        (
            {"bodies": [{**ROD, "material": "none such"}, ROD]},
            [],
            "bodies.0.material",
        ),
        ({"contacts": [{"law": "bonded", "gap": 1e-3}]}, [], "contacts.0.gap"),
    ],
)
def test_mistakes_of_rows_and_gauges_have_one_path_on_the_page_and_in_the_file(
    change, gauges, path
):
    """A wrong pair of rods, or a wrong gauge, is refused by the page with one mistake,
    at the path at which the reader of case files refuses it.
    """
    case = changed_pair(change)
    (mistake,) = mistakes(case, gauges, LIBRARY)
    assert mistake.path == path
    with pytest.raises(ri.InvalidModel) as error:
        case_from({**case, "gauges": gauges})
    assert path in dict(error.value.problems)
