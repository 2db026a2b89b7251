"""Polygons, curves and numbers of the page are those of the solution."""

import dataclasses
import html
import json

import numpy as np
import pytest
from explore.scenes import shown

import rodimpact as ri
from rodimpact.explorer.design import LIBRARY, tables_of, with_gauges
from rodimpact.explorer.presets import presets
from rodimpact.explorer.solved import restitution_of_case, scene_of
from rodimpact.storage.case_reading import case_from

STEEL = ri.materials.steel
LEFT = ri.Rod(0.4, area=1e-4, material=STEEL, velocity=1.0)
RIGHT = ri.Rod(1.0, area=1e-4, material=STEEL)
PAIR = ri.System([LEFT, RIGHT])
COMPLIANT = ri.System([LEFT, RIGHT], contacts=[ri.Hertz(1e10)])
PRESETS = {preset.key: preset.case for preset in presets()}


def read_back(design):
    """The case that the page would give back for a design."""
    tables = json.loads(json.dumps(design["case"]))
    tables["gauges"] = design["gauges"]
    return dataclasses.replace(case_from(tables), path="")


# Tables


@pytest.mark.parametrize("key", PRESETS)
def test_a_preset_survives_the_way_to_the_page_and_back(key):
    assert read_back(tables_of(PRESETS[key])) == PRESETS[key]


def test_presets_show_what_their_remarks_say():
    """e and velocities afterwards of the presets are those of their texts."""
    remarks = {"identical": 1.0, "wall": 1.0, "unequal": 0.4, "equal-transits": 1.0}
    for key, e in remarks.items():
        outcome = ri.solve(PRESETS[key].system).outcome
        assert outcome.restitution == pytest.approx(e, abs=1e-14)
    chain = ri.solve(PRESETS["chain"].system).outcome
    assert chain.velocities_after == pytest.approx((0, 0, 0, 0, 1), abs=1e-14)
    bars = ri.solve(PRESETS["hopkinson"].system).outcome
    assert bars.velocities_after[0] == pytest.approx(0, abs=1e-13)


def test_a_material_of_ones_own_is_kept_and_those_of_the_library_go_by_name():
    """The tables of a row with an own material and steel hold the own one only, and are
    read as the same system.
    """
    material = ri.Material("own 0", youngs_modulus=50e9, density=7850.0)
    system = ri.System([LEFT, ri.Rod(1.0, area=1e-4, material=material)])
    design = tables_of(ri.Case(system))
    assert list(design["case"]["materials"]) == ["own 0"]
    assert read_back(design).system == system


def test_round_rods_reach_the_page_by_their_areas():
    """A diameter is turned into an area."""
    system = ri.System([ri.Rod(1.0, diameter=0.02, material=STEEL)])
    design = tables_of(ri.Case(system))
    assert "diameter" not in design["case"]["bodies"][0]
    (rod,) = read_back(design).system.bodies
    assert rod.segments[0].area == system.bodies[0].segments[0].area


# The page of a case


DRIVEN = (ri.Pushed(1e3), ri.Free())
OWN = ri.Law(lambda overlap, rate: 1e9 * overlap)

LOSSY = STEEL.damped(loss_factor=0.05, frequency=1e4)
ANIMATE = "; rodimpact animate CASE.toml -o FILE.gif makes a moving picture"


@pytest.mark.parametrize(
    ("system", "solve", "path", "words"),
    [
        (PAIR.replace(gravity=9.81), {"until": 1e-3}, "gravity", "gravity" + ANIMATE),
        (
            ri.System([LEFT, RIGHT], contacts=[ri.Yielding(1e9, yield_force=800.0)]),
            {},
            "contacts.0",
            'the contact law "yielding"' + ANIMATE,
        ),
        (
            ri.System(
                [ri.Rod(0.4, area=1e-4, material=LOSSY, velocity=1.0), ri.Wall()]
            ),
            {},
            "materials.steel.viscosity",
            "damping",
        ),
        (
            ri.System(
                [LEFT, ri.Rod(1.0, area=ri.Samples([1e-4, 2e-4]), material=STEEL)]
            ),
            {},
            "bodies.1.area",
            "tapered",
        ),
        (
            PAIR,
            {"method": "finite-difference"},
            "solve.method",
            'the method "finite-difference"',
        ),
    ],
)
def test_a_case_that_the_page_cannot_solve_is_refused_with_a_remedy(
    system, solve, path, words
):
    """`explore` refuses a case with one mistake, at a path, which says what the page
    cannot solve and recommends a film.
    """
    with pytest.raises(ri.InvalidModel) as refused:
        ri.explore(ri.Case(system, solve))
    ((path_of_problem, message),) = refused.value.problems
    assert path_of_problem == path
    assert message.startswith("the page cannot solve ")
    assert words in message
    assert message.endswith(ANIMATE)


@pytest.mark.parametrize(
    "case", [PAIR, COMPLIANT, ri.Case(PAIR, {"max_events": 3}), *PRESETS.values()]
)
def test_a_case_that_the_page_can_solve_has_a_page(case):
    assert "</html>" in ri.explore(case).html


@pytest.mark.parametrize(
    ("case", "words"),
    [
        (3, "case: must be a System or a Case, got 3"),
        (
            ri.System([ri.RigidMass(1.0), ri.Wall()], contacts=[ri.Spring(1e6)]),
            "at least one rod",
        ),
        (ri.System([LEFT.replace(length=[0.1, 0.2]), RIGHT]), "a family of shape"),
        (ri.Case(PAIR, {"max_events": 1}), "solve: lasts no time to show"),
        (ri.System([LEFT, RIGHT], gaps=[1e9]), "Give until="),
        (ri.Case(PAIR, {"cells": 30}), "^solve.cells: is for method"),
        (ri.Case(PAIR.replace(ends=DRIVEN)), "^solve.until: must be given"),
        (
            ri.System([LEFT, RIGHT], contacts=[OWN]),
            "contacts.0: a law that is a Python",
        ),
    ],
)
def test_a_case_without_a_picture_or_with_a_mistake_has_no_page(case, words):
    with pytest.raises(ri.InvalidModel, match=words):
        ri.explore(case)


def test_a_notebook_shows_the_page_in_a_frame():
    """The HTML of a page in a notebook is an iframe that holds the whole page, escaped."""
    page = ri.explore(PAIR)
    frame = page._repr_html_()
    assert frame.startswith('<iframe srcdoc="')
    # All of the page is escaped.
    assert frame.count("<") == 2
    assert frame.count(">") == 2
    assert html.unescape(frame.split('"')[1]) == page.html


def test_a_page_is_saved_as_it_is_and_replaces_no_file(tmp_path):
    page = ri.explore(PAIR)
    page.save(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text(encoding="utf-8") == page.html
    with pytest.raises(FileExistsError):
        page.save(tmp_path / "page.html")


STEPPED = ri.Rod(
    velocity=1.0,
    segments=[
        ri.Segment(0.41421356, 1e-4, STEEL),
        ri.Segment(0.73205081, 3e-4, STEEL),
    ],
)


def test_fronts_that_multiply_are_not_for_the_page(monkeypatch):
    """`explore` of a row between walls with more events than the page follows is
    refused.
    """
    monkeypatch.setattr("rodimpact.explorer.tables.MAX_PAGE_EVENTS", 500)
    system = ri.System([ri.Wall(), STEPPED, ri.Wall()])
    case = ri.Case(system, {"until": 10.0, "max_events": 1000})
    message = "^solve: the page follows 500 arr"  # arrivals
    with pytest.raises(ri.InvalidModel, match=message):
        ri.explore(case)


def test_a_long_run_is_shown_until_there_are_too_many_regions(monkeypatch):
    monkeypatch.setattr("rodimpact.explorer.fronts.MAX_REGIONS", 9)
    solution, scene = shown(PAIR)
    assert 0 < scene["end"] < solution.t_end
    assert any("too many regions" in note for note in scene["notes"])


# Polygons


@pytest.mark.exhaustive
def test_points_of_grids_have_displacements_and_cells_the_mean_velocity():
    """The grids of two compliant rods on the page: their points have the displacements
    of the solution and span rod and run, and three cells of each have its mean
    velocity.
    """
    solution, scene = shown(COMPLIANT)
    grids = scene["tiling"]
    assert grids["body"] == [0, 1]
    first_cell = 0
    for body, length in enumerate((0.4, 1.0)):
        columns = grids["across"][body]  # of cells
        points = slice(grids["start"][body], grids["start"][body + 1])  # of this rod
        # Points are [time, position], one more than cells in each direction.
        x = np.reshape(grids["x"][points], (-1, columns + 1))
        t = np.reshape(grids["t"][points], (-1, columns + 1))
        displacement = np.reshape(grids["displacement"][points], (-1, columns + 1))
        expected = solution.displacement(body, x, t)
        assert displacement == pytest.approx(expected, abs=1e-12)
        assert x[0, 0] == 0.0
        assert x[0, -1] == length
        assert t[0, 0] == 0.0
        assert t[-1, 0] == pytest.approx(solution.t_end, rel=1e-12)
        rows = len(t) - 1
        for i, j in ((3, 0), (20, columns // 2), (rows - 1, columns - 1)):
            x_in_cell = np.linspace(x[0, j], x[0, j + 1], 41)[:, None]
            t_in_cell = np.linspace(t[i, 0], t[i + 1, 0], 41)
            mean = solution.velocity(body, x_in_cell, t_in_cell).mean()
            velocity = grids["velocity"][first_cell + i * columns + j]
            assert velocity == pytest.approx(mean, abs=0.03)
        first_cell += rows * columns


# Scene


def test_restitution_velocity_force_and_strain_are_those_of_the_solution():
    """The scene of a pair has the restitution of its solution, in numbers and text, its
    closed form, the velocity after, the peak force and the strain of the gauge.
    """
    solution, scene = shown(PAIR)
    outcome = solution.outcome

    restitution = scene["restitution"]
    force = scene["contacts"][0]["force"]
    _, gauges = scene["plots"]
    (gauge,) = gauges["series"]
    # Points 2 and 3 of the gauge are ends of the line between its first two jumps.
    middle = (gauge["t"][2] + gauge["t"][3]) / 2
    strain = 1e6 * solution.strain(1, 0.5, middle).item()
    closed_form = restitution["closed_form"]["restitution"]
    peak_force = outcome.contacts[0].peak_force
    assert restitution["value"] == outcome.restitution
    assert restitution["text"] == "0.4"
    assert closed_form == pytest.approx(0.4, abs=1e-15)
    assert ("velocity of rod 2 after", "0.4 m/s") in scene["results"]
    assert max(force["y"]) == pytest.approx(peak_force, rel=1e-8)
    assert gauge["y"][2:4] == pytest.approx([strain, strain], rel=1e-8)


def test_sentences_of_the_page_have_no_advice_that_only_python_can_follow():
    """A run that is cut short: the status of the solution recommends until=, no
    sentence of the page does, and each ends with one full stop.
    """
    options = {"until": 1e-4}
    solution, scene = shown(PAIR, **options)
    assert "until=" in solution.status
    sentences = [*scene["notes"], *scene["reason"], scene["restitution"]["why"]]
    assert "before the collision was final." in scene["notes"][0]
    for sentence in sentences:
        assert "until=" not in sentence
        assert sentence.endswith(".")
        assert not sentence.endswith("..")


# Comparison


def test_the_curve_of_e_is_that_of_saint_venant():
    """For 30 ratios of lengths, e on the page is the smaller of the ratio and its
    inverse.
    """
    ratios = np.linspace(0.1, 3.0, 30)
    restitutions = []
    for ratio in ratios:
        system = ri.System([LEFT.replace(length=ratio), RIGHT])
        case = tables_of(ri.Case(system))["case"]
        restitutions.append(restitution_of_case(case, LIBRARY))
    assert restitutions == pytest.approx(np.minimum(ratios, 1 / ratios), abs=1e-11)


def test_only_two_uniform_rods_have_a_ratio_of_lengths():
    _, scene_of_pair = shown(PAIR)
    _, scene_with_wall = shown(ri.System([LEFT, ri.Wall()]))
    assert scene_of_pair["ratio"] == pytest.approx(0.4)
    assert scene_with_wall["ratio"] is None


@pytest.mark.parametrize(("tolerance", "is_stated"), [(1e-3, True), (1e-7, False)])
def test_errors_above_half_of_the_last_digit_stand_beside_their_numbers(
    tolerance, is_stated
):
    """Restitution, impulse, peak force and velocity of a compliant collision on the
    page have a "±" for a coarse tolerance, and none for a fine one.
    """
    design = tables_of(with_gauges(ri.Case(COMPLIANT)))

    scene = scene_of(design["case"], design["gauges"], LIBRARY, tolerance)

    results = dict(scene["results"])
    texts = [scene["restitution"]["text"]]
    for name in ("impulse", "peak force", "velocity of rod 2 after"):
        texts.append(results[name])
    for text in texts:
        assert ("±" in text) == is_stated
    assert (scene["restitution"]["error"] != "") == is_stated
