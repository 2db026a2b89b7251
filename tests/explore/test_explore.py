"""What the page shows: its polygons, curves and numbers are those of the solution."""

import dataclasses
import html
import json

import numpy as np
import pytest
from explore.scenes import shown

import rodimpact as ri
from rodimpact.explorer.design import LIBRARY, tables_of, with_gauges
from rodimpact.explorer.presets import presets
from rodimpact.explorer.solved import e_of, scene_of
from rodimpact.explorer.tables import MAX_PAGE_EVENTS
from rodimpact.storage.case_reading import case_from

STEEL = ri.materials.steel
LEFT = ri.Rod(0.4, area=1e-4, material=STEEL, velocity=1.0)
RIGHT = ri.Rod(1.0, area=1e-4, material=STEEL)
PAIR = ri.System([LEFT, RIGHT])
COMPLIANT = ri.System([LEFT, RIGHT], contacts=[ri.Hertz(1e10)])
PRESETS = {preset.key: preset.case for preset in presets()}


def read_back(sent):
    """The case that the page would give back."""
    case = case_from({**json.loads(json.dumps(sent["case"])), "gauges": sent["gauges"]})
    return dataclasses.replace(case, path="")


# Tables


@pytest.mark.parametrize("key", PRESETS)
def test_a_preset_survives_the_way_to_the_page_and_back(key):
    assert read_back(tables_of(PRESETS[key])) == PRESETS[key]


def test_presets_show_what_their_remarks_say():
    found = {key: ri.solve(PRESETS[key].system).outcome for key in PRESETS}
    e = [
        found[key].restitution
        for key in ("identical", "wall", "unequal", "equal-transits")
    ]
    assert e == pytest.approx([1.0, 1.0, 0.4, 1.0], abs=1e-14)
    assert found["chain"].velocities_after == pytest.approx((0, 0, 0, 0, 1), abs=1e-14)
    assert found["hopkinson"].velocities_after[0] == pytest.approx(0, abs=1e-13)


def test_a_material_of_ones_own_is_kept_and_those_of_the_library_go_by_name():
    own = ri.Material("own 0", youngs_modulus=50e9, density=7850.0)
    system = ri.System([LEFT, ri.Rod(1.0, area=1e-4, material=own)])
    sent = tables_of(ri.Case(system))
    assert list(sent["case"]["materials"]) == ["own 0"]
    assert read_back(sent).system == system


def test_round_rods_reach_the_page_by_their_areas():
    system = ri.System([ri.Rod(1.0, diameter=0.02, material=STEEL)])
    sent = tables_of(ri.Case(system))
    assert "diameter" not in sent["case"]["bodies"][0]
    (rod,) = read_back(sent).system.bodies
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
def test_what_the_page_cannot_solve_is_told_with_a_remedy(system, solve, path, words):
    with pytest.raises(ri.InvalidModel) as refused:
        ri.explore(ri.Case(system, solve))
    ((where, message),) = refused.value.problems
    assert where == path
    assert message.startswith("the page cannot solve ")
    assert words in message
    assert message.endswith(ANIMATE)


@pytest.mark.parametrize(
    "case", [PAIR, COMPLIANT, ri.Case(PAIR, {"max_events": 3}), *PRESETS.values()]
)
def test_what_the_page_can_solve_has_a_page(case):
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
def test_what_has_no_page_is_told(case, words):
    with pytest.raises(ri.InvalidModel, match=words):
        ri.explore(case)


def test_a_notebook_shows_the_page_in_a_frame():
    page = ri.explore(PAIR)
    shown_there = page._repr_html_()
    assert shown_there.startswith('<iframe srcdoc="')
    assert (
        shown_there.count("<") == shown_there.count(">") == 2
    )  # all of the page is escaped
    assert html.unescape(shown_there.split('"')[1]) == page.html


def test_a_page_is_saved_as_it_is_and_replaces_no_file(tmp_path):
    page = ri.explore(PAIR)
    page.save(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text(encoding="utf-8") == page.html
    with pytest.raises(FileExistsError):
        page.save(tmp_path / "page.html")


STEPPED = ri.Rod(
    velocity=1.0,
    segments=[
        ri.Segment(L, A, STEEL) for L, A in ((0.41421356, 1e-4), (0.73205081, 3e-4))
    ],
)


def test_fronts_that_multiply_are_not_for_the_page():
    system = ri.System([ri.Wall(), STEPPED, ri.Wall()])
    case = ri.Case(system, {"until": 10.0, "max_events": MAX_PAGE_EVENTS + 10_000})
    with pytest.raises(
        ri.InvalidModel, match=f"^solve: the page follows {MAX_PAGE_EVENTS} arr"
    ):
        ri.explore(case)


def test_a_long_run_is_shown_until_there_are_too_many_regions(monkeypatch):
    monkeypatch.setattr("rodimpact.explorer.fronts.MOST_REGIONS", 9)
    solution, found = shown(PAIR)
    assert 0 < found["end"] < solution.t_end
    assert any("too many regions" in note for note in found["notes"])


# Polygons


def test_cells_of_grids_hold_the_mean_state():
    solution, picture = shown(COMPLIANT)
    found, before = picture["tiling"], 0
    assert found["body"] == [0, 1]
    for g, (body, across) in enumerate(
        zip(found["body"], found["across"], strict=True)
    ):
        part = slice(*found["start"][g : g + 2])
        x, t, u = (
            np.array(found[name][part]).reshape(-1, across + 1)
            for name in ("x", "t", "displacement")
        )
        assert u == pytest.approx(solution.displacement(body, x, t), abs=1e-12)
        assert (x[0, 0], x[0, -1], t[0, 0]) == (0.0, (0.4, 1.0)[g], 0.0)
        assert t[-1, 0] == pytest.approx(solution.t_end, rel=1e-12)
        rows = len(t) - 1
        velocity = np.array(found["velocity"][before:]).reshape(-1)[: rows * across]
        before += rows * across
        for i, j in ((3, 0), (20, across // 2), (rows - 1, across - 1)):
            xs = np.linspace(x[0, j], x[0, j + 1], 41)[:, None]
            mean = solution.velocity(
                body, xs, np.linspace(t[i, 0], t[i + 1, 0], 41)
            ).mean()
            assert velocity[i * across + j] == pytest.approx(mean, abs=0.03)


# Scene


def test_numbers_are_those_of_the_solution():
    solution, found = shown(PAIR)
    assert found["restitution"]["value"] == solution.outcome.restitution
    assert found["restitution"]["text"] == "0.4"
    assert found["restitution"]["closed_form"]["restitution"] == pytest.approx(
        0.4, abs=1e-15
    )
    assert ["velocity of rod 2 after", "0.4 m/s"] in [
        list(row) for row in found["results"]
    ]
    force = found["contacts"][0]["force"]
    assert max(force["y"]) == pytest.approx(
        solution.outcome.contacts[0].peak_force, rel=1e-8
    )
    gauge = next(plot for plot in found["plots"] if plot["key"] == "gauge")["series"][0]
    middle = (gauge["t"][2] + gauge["t"][3]) / 2  # between its first two jumps
    assert (
        gauge["y"][2]
        == gauge["y"][3]
        == pytest.approx(1e6 * solution.strain(1, 0.5, middle).item(), rel=1e-8)
    )


# Comparison


def test_the_curve_of_e_is_that_of_saint_venant():
    ratios = np.linspace(0.1, 3.0, 30)
    cases = [
        tables_of(ri.Case(ri.System([LEFT.replace(length=r), RIGHT])))["case"]
        for r in ratios
    ]
    assert [e_of(case, LIBRARY) for case in cases] == pytest.approx(
        np.minimum(ratios, 1 / ratios), abs=1e-11
    )


def test_a_curve_needs_two_uniform_rods():
    assert shown(PAIR)[1]["ratio"] == pytest.approx(0.4)
    assert shown(ri.System([LEFT, ri.Wall()]))[1]["ratio"] is None


def test_numbers_have_their_error_beside_them_where_it_is_above_half_of_the_last_digit():
    sent = tables_of(with_gauges(ri.Case(COMPLIANT)))
    for tolerance, told in ((1e-3, True), (1e-9, False)):
        page = scene_of(sent["case"], sent["gauges"], LIBRARY, tolerance)
        results = dict(page["results"])
        texts = [
            page["restitution"]["text"],
            results["impulse"],
            results["peak force"],
            results["velocity of rod 2 after"],
        ]
        assert ["±" in text for text in texts] == [told] * 4
