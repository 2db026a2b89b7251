"""What the page shows: its polygons, curves and numbers are those of the solution."""

import itertools
import json

import numpy as np
import pytest

import rodimpact as ri
from rodimpact.explore.comparison import solved_curve
from rodimpact.explore.design import MOST_BODIES, MOST_EVENTS, Design
from rodimpact.explore.presets import presets
from rodimpact.explore.scene import scene
from rodimpact.explore.tiling import grids
from rodimpact.results.regions import regions_of
from rodimpact.storage.casefile import GaugePlace

STEEL = ri.materials.steel
LEFT = ri.Rod(0.4, area=1e-4, material=STEEL, velocity=1.0)
RIGHT = ri.Rod(1.0, area=1e-4, material=STEEL)
PAIR = ri.System([LEFT, RIGHT])
COMPLIANT = ri.System([LEFT, RIGHT], contacts=[ri.Hertz(1e10)])
PRESETS = {preset.key: preset.design for preset in presets()}


def shown(system, **solve):
    design = Design.of(ri.Case(system, solve))
    solution = design.solve()
    return solution, scene(design, solution)


def polygons(tiling):
    for i, (start, stop) in enumerate(itertools.pairwise(tiling.start)):
        yield i, slice(start, stop)


def areas(tiling):
    found = []
    for _, part in polygons(tiling):
        x, t = tiling.x[part], tiling.t[part]
        found.append(abs(x @ np.roll(t, -1) - t @ np.roll(x, -1)) / 2)
    return np.array(found)


# Design


@pytest.mark.parametrize("key", PRESETS)
def test_a_preset_survives_the_way_to_the_page_and_back(key):
    sent = json.loads(json.dumps(PRESETS[key].to_dict()))
    assert Design.parse(sent) == PRESETS[key]


def test_presets_show_what_their_remarks_say():
    e = {key: PRESETS[key].solve().outcome for key in ("identical", "wall", "unequal")}
    assert [o.restitution for o in e.values()] == pytest.approx([1.0, 1.0, 0.4], abs=1e-14)
    assert PRESETS["equal-transits"].solve().outcome.restitution == pytest.approx(1.0, abs=1e-14)
    chain = PRESETS["chain"].solve().outcome.velocities_after
    assert chain == pytest.approx((0, 0, 0, 0, 1), abs=1e-14)
    assert PRESETS["hopkinson"].solve().outcome.velocities_after[0] == pytest.approx(0, abs=1e-13)


def test_a_material_of_ones_own_is_kept_and_those_of_the_library_go_by_name():
    own = ri.Material("own 0", youngs_modulus=50e9, density=7850.0)
    system = ri.System([LEFT, ri.Rod(1.0, area=1e-4, material=own)])
    sent = Design.of(ri.Case(system)).to_dict()["case"]
    assert list(sent["materials"]) == ["own 0"]
    assert Design.parse({"case": sent}).case.system == system


@pytest.mark.parametrize("love", [{}, {"lateral_inertia": "rayleigh-love"}])
def test_round_rods_reach_the_page_by_their_areas(love):
    system = ri.System([ri.Rod(1.0, diameter=0.02, material=STEEL, **love)])
    (sent,) = Design.of(ri.Case(system)).to_dict()["case"]["bodies"]
    assert "diameter" not in sent
    (rod,) = Design.parse({"case": {"schema": 1, "bodies": [sent]}}).case.system.bodies
    assert rod.segments[0].area == system.bodies[0].segments[0].area
    assert rod.segments[0].ideal == (not love)


def test_a_stepped_rod_and_a_profile_reach_the_page():
    rod = ri.Rod(
        segments=[ri.Segment(0.1, 1e-4, STEEL), ri.Segment(0.2, 2e-4, STEEL)],
        velocity=ri.Steps([1.0, 0.5], [0.1]),
    )
    design = Design.of(ri.Case(ri.System([rod, RIGHT])))
    assert Design.parse(design.to_dict()) == design


@pytest.mark.parametrize(
    ("change", "path"),
    [
        ({"case": {"schema": 1, "bodies": [{"kind": "rod"}]}}, "bodies.0.length"),
        ({"gauges": [{"body": 7, "fraction": 0.5}]}, "gauges.0.body"),
        ({"gauges": [{"body": 1, "fraction": 1.5}]}, "gauges.0.fraction"),
        ({"gauges": [{"body": 1, "fraction": "x"}]}, "gauges.0.fraction"),
        ({"gauges": [{"body": True, "fraction": 0.5}]}, "gauges.0.body"),
        ({"gauges": [3]}, "gauges"),
        ({"gauges": [{}] * 5}, "gauges"),
        ({"gauges": 3}, "gauges"),
        ({"more": 1}, "more"),
        ({"case": 1}, "case"),
    ],
)
def test_a_mistake_bears_the_path_of_its_field(change, path):
    with pytest.raises(ri.InvalidModel) as error:
        Design.parse({**Design.of(ri.Case(PAIR)).to_dict(), **change})
    assert path in [where for where, _ in error.value.problems]


@pytest.mark.parametrize(
    ("case", "path"),
    [
        ({"bodies": [{"kind": "rod"}] * (MOST_BODIES + 1)}, "bodies"),
        ({"bodies": [{"kind": "rod", "segments": [{}] * 25}]}, "bodies"),
        ({"bodies": [{"kind": "rod", "velocity": {"samples": [0.0] * 9999}}]}, "case"),
        ({"solve": {"max_events": 10**9}}, "solve.max_events"),
        ({"solve": {"until": 0}}, "solve.until"),
    ],
)
def test_more_than_a_page_may_ask_for_is_refused(case, path):
    whole = {**Design.of(ri.Case(PAIR)).to_dict()["case"], **case}
    with pytest.raises(ri.InvalidModel) as error:
        Design.parse({"case": whole})
    assert path in [where for where, _ in error.value.problems]


def test_an_end_beyond_the_clock_is_refused_by_its_path():
    with pytest.raises(ri.InvalidModel, match="more than the clock can count") as told:
        Design.of(ri.Case(COMPLIANT, {"until": 1e9})).solve()
    assert [path for path, _ in told.value.problems] == ["solve.until"]


def test_fronts_that_multiply_stop_at_the_cap():
    pieces = [ri.Segment(L, A, STEEL) for L, A in ((0.41421356, 1e-4), (0.73205081, 3e-4))]
    system = ri.System([ri.Wall(), ri.Rod(segments=pieces, velocity=1.0), ri.Wall()])
    solution, found = shown(system, until=10.0)
    assert solution.events <= MOST_EVENTS + 10
    assert found["end"] < solution.t_end
    assert any("too many regions" in note for note in found["notes"])


@pytest.mark.parametrize("solve", [{"max_events": 1}, {"until": 1e-30}])
def test_a_run_that_lasts_no_time_is_told_with_its_remedy(solve):
    design = Design.of(ri.Case(PAIR, solve))
    with pytest.raises(ri.InvalidModel, match="solve: there is nothing to draw") as error:
        scene(design, design.solve())
    assert error.value.problems[0][1].endswith(design.solve().status)


def test_a_gap_that_the_clock_cannot_close_is_told():
    design = Design.of(ri.Case(ri.System([LEFT, RIGHT], gaps=[1e9])))
    with pytest.raises(ri.InvalidModel, match="Give until="):
        scene(design, design.solve())


@pytest.mark.exhaustive
def test_springs_are_solved_on_steps_that_need_not_divide_the_transits():
    left = LEFT.replace(length=0.413)
    row = ri.System([left, RIGHT, RIGHT], contacts=[ri.Hertz(1e10), ri.Spring(1e10)])
    found, known = Design.of(ri.Case(row)).solve(), ri.solve(row, rtol=1e-4)
    assert found.outcome.final
    assert found.outcome.velocities_after == pytest.approx(known.outcome.velocities_after, abs=1e-3)


def test_too_many_regions_from_the_start_are_shown_in_cells():
    jumps = np.linspace(0.0, 0.4, 3201)[1:-1]
    left = ri.Rod(0.4, area=1e-4, material=STEEL, velocity=ri.Steps(np.arange(3200.0) % 2, jumps))
    solution, picture = shown(ri.System([left, RIGHT]))
    assert solution.method == "fronts"
    assert not picture["exact"]
    assert picture["tiling"]["across"] == grids(solution)["across"]


# Polygons


def test_polygons_tile_the_plane():
    solution = ri.solve(PAIR)
    tiling = regions_of(solution)
    for body, length in ((0, 0.4), (1, 1.0)):
        total = areas(tiling)[tiling.body == body].sum()
        assert total == pytest.approx(length * solution.t_end, rel=1e-12)


def test_vertices_carry_the_displacement_of_the_solution():
    solution = ri.solve(PAIR)
    tiling = regions_of(solution)
    for i, part in polygons(tiling):
        u = solution.displacement(tiling.body[i], tiling.x[part], tiling.t[part])
        assert tiling.displacement[part] == pytest.approx(u, abs=1e-12)


def test_cells_of_grids_hold_the_mean_state():
    solution = ri.solve(COMPLIANT)
    found, before = grids(solution), 0
    assert found["body"] == [0, 1]
    for g, (body, across) in enumerate(zip(found["body"], found["across"], strict=True)):
        part = slice(*found["start"][g : g + 2])
        x, t, u = (np.array(found[name][part]).reshape(-1, across + 1)
                   for name in ("x", "t", "displacement"))
        assert u == pytest.approx(solution.displacement(body, x, t), abs=1e-12)
        assert (x[0, 0], x[0, -1], t[0, 0]) == (0.0, (0.4, 1.0)[g], 0.0)
        assert t[-1, 0] == pytest.approx(solution.t_end, rel=1e-12)
        rows = len(t) - 1
        velocity = np.array(found["velocity"][before:]).reshape(-1)[: rows * across]
        before += rows * across
        for i, j in ((3, 0), (20, across // 2), (rows - 1, across - 1)):
            xs = np.linspace(x[0, j], x[0, j + 1], 41)[:, None]
            mean = solution.velocity(body, xs, np.linspace(t[i, 0], t[i + 1, 0], 41)).mean()
            assert velocity[i * across + j] == pytest.approx(mean, abs=0.03)


# Scene


@pytest.mark.parametrize("key", PRESETS)
def test_a_scene_is_strict_json_with_whole_polygons(key):
    found = json.loads(json.dumps(scene(PRESETS[key], PRESETS[key].solve()), allow_nan=False))
    tiling = found["tiling"]
    count = len(tiling["body"])
    assert len(tiling["start"]) == count + 1
    assert len(tiling["velocity"]) == len(tiling["stress"]) == count
    sizes = {len(tiling[name]) for name in ("x", "t", "displacement")}
    assert sizes == {tiling["start"][-1]}
    assert {plot["key"] for plot in found["plots"]} == {"force", "gap", "energy", "gauge"}


def lengths_at(found, t):
    """Lengths of the rods that the polygons show at a time, bodies from left to right."""
    tiling, lengths = found["tiling"], {}
    for i, (start, stop) in enumerate(itertools.pairwise(tiling["start"])):
        x, times = np.array(tiling["x"][start:stop]), np.array(tiling["t"][start:stop])
        places = []
        for a, b, from_x, to_x in zip(times, np.roll(times, -1), x, np.roll(x, -1), strict=True):
            if min(a, b) <= t <= max(a, b):
                share = 0.0 if a == b else (t - a) / (b - a)
                places += [from_x + (to_x - from_x) * share]
                places += [to_x] if a == b else []
        body = tiling["body"][i]
        lengths[body] = lengths.get(body, 0.0) + (max(places) - min(places) if places else 0.0)
    return lengths


@pytest.mark.parametrize("key", PRESETS)
def test_whole_rods_are_shown_from_the_first_instant_to_the_last(key):
    solution, found = shown(PRESETS[key].case.system)
    rods = {
        i: body.length for i, body in enumerate(solution.system.bodies) if isinstance(body, ri.Rod)
    }
    for share in (0.0, 0.123, 1.0):
        assert lengths_at(found, share * found["end"]) == pytest.approx(rods, rel=1e-7)


def test_numbers_are_those_of_the_solution():
    solution, found = shown(PAIR)
    assert found["restitution"]["value"] == solution.outcome.restitution
    assert found["restitution"]["text"] == "0.4"
    assert found["restitution"]["closed_form"] == pytest.approx(0.4, abs=1e-15)
    assert ["velocity of rod 2 after", "0.4 m/s"] in [list(row) for row in found["results"]]
    force = next(plot for plot in found["plots"] if plot["key"] == "force")["series"][0]
    assert max(force["y"]) == pytest.approx(solution.outcome.contacts[0].peak_force, rel=1e-8)
    gauge = next(plot for plot in found["plots"] if plot["key"] == "gauge")["series"][0]
    middle = (gauge["t"][1] + gauge["t"][2]) / 2
    assert gauge["y"][1] == pytest.approx(
        1e6 * solution.strain(1, 0.5, middle).item(), rel=1e-8)


def test_rods_that_touch_touch_in_the_picture():
    solution, found = shown(PAIR)
    row = found["row"]
    for t in (0.0, 50e-6, 150e-6):
        places = [
            row["left"][i] + x + row["magnification"] * (
                row["apart"][i] + solution.displacement(i, x, t) - row["frame"] * t)
            for i, x in ((0, 0.4), (1, 0.0))
        ]
        assert places[0] == pytest.approx(places[1], abs=1e-12)


def test_a_row_that_flies_past_is_seen_from_beside_it():
    rods = [
        ri.Rod(0.4, area=1e-4, material=STEEL, velocity=101.0),
        ri.Rod(1.0, area=1e-4, material=STEEL, velocity=100.0),
    ]
    _, found = shown(ri.System(rods))
    assert found["row"]["frame"] == 100.0
    assert "frame moving at 100 m/s" in found["row"]["note"]
    assert found["row"]["magnification"] > 100


@pytest.mark.parametrize("method", ["characteristics", "finite-difference"])
def test_what_is_sampled_says_so(method):
    """The page has a coarser mesh than `rodimpact run`, but the same polynomial pieces."""
    solution, found = shown(COMPLIANT, method=method)
    assert solution.method == method
    assert not found["exact"]
    assert "means over cells" in " ".join(found["notes"])
    coarse = "rodimpact run is more accurate" in " ".join(found["notes"])
    assert coarse == (method == "finite-difference")


def test_masses_and_walls_bring_their_paths():
    system = ri.System([ri.RigidMass(0.5, velocity=2.0), RIGHT, ri.Wall()])
    solution, found = shown(system, until=1e-3)
    mass, rod, wall = found["bodies"]
    assert rod["path"] is None
    assert mass["path"]["displacement"][-1] == pytest.approx(
        solution.displacement(0, 0.0, 1e-3).item(), rel=1e-8)
    assert wall["path"]["displacement"] == [0.0, 0.0]
    assert mass["width"] > 0 == wall["width"]


def test_a_row_that_never_meets_has_a_picture_too():
    _, found = shown(ri.System([RIGHT, RIGHT], [1e-3]))
    assert found["restitution"]["value"] is None
    assert "nothing collided" in found["restitution"]["why"]


# Comparison


def test_the_curve_of_e_is_that_of_saint_venant():
    _, found = shown(PAIR)
    curve = found["curve"]
    assert curve["values"] == pytest.approx([min(r, 1 / r) for r in curve["ratios"]], abs=1e-11)
    solved = solved_curve(Design.of(ri.Case(PAIR)))
    assert solved["values"] == pytest.approx([min(r, 1 / r) for r in solved["ratios"]], abs=1e-12)
    assert solved["source"] == "solved at 20 ratios"


def test_a_curve_needs_two_uniform_rods():
    wall = ri.System([LEFT, ri.Wall()])
    assert solved_curve(Design.of(ri.Case(wall))) is None
    _, found = shown(wall)
    assert found["ratio"] is None
    assert found["curve"] is None
    assert shown(PAIR)[1]["ratio"] == pytest.approx(0.4)
    profile = ri.System([LEFT.replace(velocity=ri.Steps([1.0, 0.5], [0.1])), RIGHT])
    assert shown(profile)[1]["curve"] is None
    assert solved_curve(Design.of(ri.Case(profile))) is None


def test_a_curve_has_holes_where_there_is_no_collision():
    apart = Design.of(ri.Case(ri.System([RIGHT, LEFT])))
    assert set(solved_curve(apart)["values"]) == {None}


def test_a_gauge_place_is_a_fraction_of_the_rod():
    design = Design.of(ri.Case(PAIR))
    assert design.case.gauges == (GaugePlace(1, 0.5),)


def test_lossy_and_tapered_rods_are_shown_from_a_grid():
    """Damping, tapers: the page solves them on few cells, in bounded time."""
    data = {"case": {
        "schema": 1, "materials": {"lossy": {
            "youngs_modulus": 2e11, "density": 7850, "loss_factor": 0.05, "loss_frequency": 1e4}},
        "bodies": [
            {"kind": "rod", "length": 0.4, "area": 1e-4, "material": "steel", "velocity": 1.0},
            {"kind": "rod", "length": 1.0, "area": {"samples": [1e-4, 3e-4]}, "material": "lossy"},
        ],
    }}
    design = Design.parse(data)
    page = scene(design, design.solve())
    assert not page["exact"]
    assert page["restitution"]["closed_form"] is None
    energy = next(plot for plot in page["plots"] if plot["key"] == "energy")
    kinds = {series["name"]: series["y"] for series in energy["series"]}
    assert kinds["lost in material"][-1] > 0
    assert dict(page["bodies"][1]["given"])["area"] == "1 to 3 cm²"
    data["case"]["solve"] = {"until": 10.0}
    with pytest.raises(ri.InvalidModel, match=r"solve\.until: must not exceed"):
        Design.parse(data).solve()
