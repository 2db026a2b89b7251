"""Bearing graphs: numbers of the field, of a chain of lumped masses, and wrong
calls.
"""

import csv
import math

import numpy as np
import pytest
from exhaustive import few_of
from lumped_pile import LumpedPile, strike
from piles.pipe_pile import AREA, CUSHION, LENGTH, QUAKE, RAM, STEEL, pipe_pile

import rodimpact as ri
from rodimpact.methods import kernels
from rodimpact.piles import bearing

needs_compiler = pytest.mark.skipif(
    not kernels.enabled(), reason="takes long in plain Python"
)
RESISTANCES = [200e3, 400e3, 600e3, 800e3, 1000e3]
OF_SEGMENTS = {
    "smith": [14.54, 28.71, 43.35, 58.44, 75.82],
    "viscous": [14.7, 29.0, 44.3, 59.9, 77.7],
}
"""Blows for a metre by a lumped model of segments of 1 m, whose cushion differs in
details.
"""
HELMET = ri.RigidMass(5e3 / 9.81)


@needs_compiler
@pytest.mark.parametrize("law", few_of(["smith", "viscous"], ["smith"]))
def test_blow_counts_are_those_of_a_lumped_model_of_the_field(law):
    graph = ri.bearing_graph(pipe_pile(law, HELMET), RESISTANCES)

    assert graph["blow_count"] == pytest.approx(OF_SEGMENTS[law], rel=0.025)
    assert graph.is_over
    assert graph["set_error"].max() < 1e-3
    assert graph["compression_error"].max() < 5e-3  # a bound, several times the error


@needs_compiler
@pytest.mark.parametrize("law", few_of(["smith", "viscous"], ["smith"]))
@pytest.mark.parametrize("resistance", few_of(RESISTANCES[::2], [800e3]))
def test_a_point_is_the_blow_on_a_chain_of_lumped_masses(law, resistance):
    system = pipe_pile(law)
    elastic = system.replace(contacts=[ri.Spring(CUSHION), system.contacts[1]])
    half = resistance / 2
    chain = LumpedPile(
        ram_mass=RAM.mass,
        ram_velocity=RAM.velocity,
        cushion=CUSHION,
        length=LENGTH,
        area=AREA,
        modulus=STEEL.youngs_modulus,
        density=STEEL.density,
        shaft_resistance=half,
        toe_resistance=half,
        quake=QUAKE,
        shaft_damping=0.16,
        toe_damping=0.5,
        is_viscous=law == "viscous",
    )

    (point,) = ri.bearing_graph(elastic, resistance).points
    duration = 0.05 * 800e3 / resistance  # a weak soil stops the pile later
    lumped = strike(chain, segments=300, duration=duration, step=2e-6)

    assert point.set == pytest.approx(lumped.toe_set, rel=1e-3)
    compression = point.compression * AREA
    assert compression == pytest.approx(lumped.largest_compression, rel=1e-2)


@needs_compiler
@pytest.mark.parametrize("seed", few_of(range(8), [1]))
def test_stated_errors_bound_those_against_a_fine_mesh(seed):
    rng = np.random.default_rng(seed)
    system = pipe_pile(str(rng.choice(["smith", "viscous"])), HELMET)
    if seed % 3 == 0:
        system = system.replace(gravity=9.81)
    resistance = float(rng.uniform(150e3, 1200e3))
    share = float(rng.uniform(0.0, 0.9))

    (stated,) = ri.bearing_graph(system, resistance, shaft_share=share, cells=40).points
    (fine,) = ri.bearing_graph(system, resistance, shaft_share=share, cells=240).points

    assert abs(stated.set - fine.set) <= stated.set_error * stated.set
    change = abs(stated.compression - fine.compression)
    assert change <= stated.compression_error * stated.compression
    change = abs(stated.tension - fine.tension)
    assert change <= stated.tension_error * stated.tension


def test_resistance_is_shared_at_constant_quake():
    soil = ri.Soil(ri.Steps([10e3, 30e3], [5.0]), QUAKE, mobilised=0.1)
    system = pipe_pile("smith")
    ram, pile, wall = system.bodies
    system = system.replace(bodies=[ram, pile.replace(shaft=soil, strain=1e-6), wall])
    row = bearing.check_pile(system)

    shared = bearing.with_resistance(system, row, 1000e3, shaft_share=0.3)

    soil = shared.bodies[1].shaft
    assert soil.resistance.values == pytest.approx((300e3 / 35, 900e3 / 35))
    assert soil.quake == QUAKE
    assert soil.mobilised == 0.0
    assert shared.bodies[1].strain == 0.0
    assert shared.contacts[1].resistance == pytest.approx(700e3)
    assert shared.contacts[1].quake == QUAKE
    bare = bearing.with_resistance(system, row, 1000e3, shaft_share=0.0)
    assert bare.bodies[1].shaft is None


@needs_compiler
def test_the_order_of_the_resistances_and_the_workers_do_not_matter():
    system = pipe_pile("smith")

    both = ri.bearing_graph(system, [600e3, 300e3], cells=12, workers=2)
    alone = ri.bearing_graph(system, 300e3, cells=12, workers=1)

    assert both.points[1] == alone.points[0]
    assert both["resistance"].tolist() == [600e3, 300e3]


def test_a_pile_rests_before_the_blow_where_gravity_acts():
    system = pipe_pile("smith", HELMET, head=ri.Spring(2e9)).replace(gravity=9.81)

    (point,) = ri.bearing_graph(system, 600e3, cells=8, until=0.02).points

    assert point.compression > 0
    message = r"resistances: of 1 kN: bodies.2.shaft: cannot bear the weight"
    with pytest.raises(ri.InvalidModel, match=message):
        ri.bearing_graph(system, [1e3], cells=8)


def test_a_graph_is_a_table_that_other_programs_read(tmp_path):
    graph = ri.bearing_graph(pipe_pile("smith"), [300e3, 500e3], cells=8, until=5e-3)
    path = tmp_path / "graph.csv"

    graph.to_csv(path)

    with path.open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["resistance"]) for row in rows] == [300e3, 500e3]
    assert [float(row["set"]) for row in rows] == graph["set"].tolist()
    assert rows[0]["is_over"] == "False"
    assert [float(row["compression_t"]) for row in rows] == [
        point.compression_t for point in graph.points
    ]
    text = str(graph)
    assert "300 kN" in text
    assert "At 500 kN: Not over after 5 ms" in text
    with pytest.raises(FileExistsError):
        graph.to_csv(path)
    with pytest.raises(KeyError, match="must be one of resistance, "):
        graph["sett"]


def test_a_blow_without_set_has_no_blow_count():
    graph = ri.bearing_graph(pipe_pile("smith"), [500e3], cells=8, until=2e-3)

    assert graph["set"].tolist() == [0.0]
    assert math.isinf(graph.points[0].blow_count)
    assert " - " in str(graph)
    with pytest.raises(ri.InvalidModel, match="graph: has no blow count"):
        ri.plot.bearing(graph)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"resistances": []}, "resistances: must be 1 to 10000 numbers"),
        ({"resistances": [1e5, -1.0]}, r"resistances\[1\]: must be a finite positive"),
        ({"resistances": 1e5, "shaft_share": 1.0}, "shaft_share: must be below 1"),
        ({"resistances": 1e5, "shaft_share": -0.1}, "shaft_share: must be"),
        ({"resistances": 1e5, "cells": 3}, "cells: must be a whole number from 4"),
        ({"resistances": 1e5, "until": 0.0}, "until: must be a finite positive"),
        ({"resistances": 1e5, "workers": 0}, "workers: must be a positive"),
    ],
)
def test_wrong_arguments_are_refused(arguments, message):
    with pytest.raises(ri.InvalidModel, match=message):
        ri.bearing_graph(pipe_pile("smith"), **arguments)


def test_a_toe_or_a_shaft_without_soil_is_refused():
    system = pipe_pile("smith")
    ram, pile, wall = system.bodies
    hard = system.replace(contacts=[system.contacts[0], ri.Yielding(1e8, 1e5)])
    with pytest.raises(ri.InvalidModel, match=r"contacts.1: must be SmithToe"):
        ri.bearing_graph(hard, 1e5)
    bare = system.replace(bodies=[ram, pile.replace(shaft=None), wall])
    with pytest.raises(ri.InvalidModel, match=r"shaft_share: must be 0 for a pile"):
        ri.bearing_graph(bare, 1e5, shaft_share=0.5)


def test_the_figure_shows_what_the_table_says():
    graph = ri.bearing_graph(
        pipe_pile("smith"), [500e3, 300e3], cells=8, until=0.02, workers=1
    )

    picture = ri.plot.bearing(graph)

    x, y = picture.blow_count.get_data()
    assert x.tolist() == [300.0, 500.0]
    assert y.tolist() == graph["blow_count"][::-1].tolist()
    _, stress = picture.compression.get_data()
    assert stress == pytest.approx(graph["compression"][::-1] / 1e6)
    assert picture.stress_ax.get_xlabel() == "ultimate resistance (kN)"
    unfinished = [not point.is_over for point in graph.points]
    assert (picture.unfinished is not None) == any(unfinished)
