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
RESISTANCES = [200e3, 400e3, 600e3, 800e3, 1000e3]  # N
ALL_FIVE = slice(None)  # of them
SECOND_AND_LAST = slice(1, None, 3)
PUBLISHED_BLOW_COUNTS = {
    "smith": [14.54, 28.71, 43.35, 58.44, 75.82],
    "viscous": [14.7, 29.0, 44.3, 59.9, 77.7],
}
"""Blows for a metre at each of `RESISTANCES`, by a lumped model of segments of 1 m,
whose cushion differs in details.
"""
HELMET = ri.RigidMass(5e3 / 9.81)


@needs_compiler
@pytest.mark.parametrize("law", few_of(["smith", "viscous"], ["smith"]))
@pytest.mark.parametrize("part", few_of([SECOND_AND_LAST, ALL_FIVE], [SECOND_AND_LAST]))
def test_blow_counts_are_published_ones_and_stated_errors_are_small(law, part):
    """Blow counts of a pipe pile are the published ones to 2.5 %; stated errors of set
    and compression are below 0.1 % and 0.5 %.
    """
    system = pipe_pile(law, HELMET)
    resistances = RESISTANCES[part]

    graph = ri.bearing_graph(system, resistances)

    assert graph.is_over
    published = PUBLISHED_BLOW_COUNTS[law][part]
    assert graph["blow_count"] == pytest.approx(published, rel=0.025)
    # Stated errors are bounds, several times the true errors.
    set_error = graph["set_error"]
    compression_error = graph["compression_error"]
    assert set_error.max() < 1e-3
    assert compression_error.max() < 5e-3


def lumped_pipe_pile(law, resistance):
    """The pile of `pipe_pile` as a chain of masses, with an elastic cushion.

    Half of the resistance, N, acts along the shaft.
    """
    half = resistance / 2
    return LumpedPile(
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


@needs_compiler
@pytest.mark.parametrize("law", few_of(["smith", "viscous"], ["smith"]))
@pytest.mark.parametrize("resistance", few_of(RESISTANCES[::2], [800e3]))
def test_set_and_compression_are_those_of_a_chain_of_lumped_masses(law, resistance):
    """Set and largest compressive force of a pile with this soil are those of a chain
    of 300 lumped masses, to 0.1 % and 1 %.
    """
    chain = lumped_pipe_pile(law, resistance)
    duration = 0.05 * 800e3 / resistance  # s; a weak soil stops the pile later
    system = pipe_pile(law)
    elastic_cushion = ri.Spring(CUSHION)
    toe = system.contacts[1]
    system = system.replace(contacts=[elastic_cushion, toe])

    (point,) = ri.bearing_graph(system, resistance).points

    lumped = strike(chain, segments=300, duration=duration, step=2e-6)
    assert point.set == pytest.approx(lumped.toe_set, rel=1e-3)
    largest_force = point.compression * AREA
    assert largest_force == pytest.approx(lumped.largest_compression, rel=1e-2)


@needs_compiler
@pytest.mark.parametrize("seed", few_of(range(8), [1]))
def test_stated_errors_bound_those_against_a_fine_mesh(seed):
    """Set, compression and tension of a random pile on 40 cells differ from those on
    160 cells by the stated errors at most.
    """
    rng = np.random.default_rng(seed)
    law = str(rng.choice(["smith", "viscous"]))
    system = pipe_pile(law, HELMET)
    if seed % 3 == 0:
        system = system.replace(gravity=9.81)
    resistance = float(rng.uniform(150e3, 1200e3))
    share = float(rng.uniform(0.0, 0.9))

    coarse_graph = ri.bearing_graph(system, resistance, shaft_share=share, cells=40)
    fine_graph = ri.bearing_graph(system, resistance, shaft_share=share, cells=160)

    (stated,) = coarse_graph.points
    (fine,) = fine_graph.points

    # Stated errors are relative to the stated values.
    set_bound = stated.set_error * stated.set
    compression_bound = stated.compression_error * stated.compression
    tension_bound = stated.tension_error * stated.tension
    assert abs(stated.set - fine.set) <= set_bound
    assert abs(stated.compression - fine.compression) <= compression_bound
    assert abs(stated.tension - fine.tension) <= tension_bound


def test_resistance_is_shared_at_constant_quake_and_the_pile_begins_unstrained():
    """A pile with strain and mobilised soil gets a resistance of 1000 kN: 30 % go to
    the shaft in its own distribution, the rest to the toe; quakes stay, strain and
    mobilisation are 0.
    """
    per_length = ri.Steps([10e3, 30e3], [5.0])  # N/m; 350 kN along the 15 m
    soil = ri.Soil(per_length, QUAKE, mobilised=0.1)
    system = pipe_pile("smith")
    ram, pile, wall = system.bodies
    strained = pile.replace(shaft=soil, strain=1e-6)
    system = system.replace(bodies=[ram, strained, wall])
    row = bearing.check_pile(system)

    shared = bearing.with_resistance(system, row, 1000e3, shaft_share=0.3)

    _, pile, _ = shared.bodies
    assert pile.strain == 0.0
    shaft = pile.shaft
    assert shaft.quake == QUAKE
    assert shaft.mobilised == 0.0
    on_shaft = 0.3 * 1000e3  # N
    factor = on_shaft / 350e3
    expected = (10e3 * factor, 30e3 * factor)
    assert shaft.resistance.values == pytest.approx(expected)
    _, toe = shared.contacts
    assert toe.quake == QUAKE
    below_toe = 0.7 * 1000e3
    assert toe.resistance == pytest.approx(below_toe)


def test_without_a_share_of_the_shaft_the_pile_has_no_soil_along_it():
    system = pipe_pile("smith")
    row = bearing.check_pile(system)

    bare = bearing.with_resistance(system, row, 1000e3, shaft_share=0.0)

    assert bare.bodies[1].shaft is None


@pytest.mark.exhaustive
@needs_compiler
def test_the_order_of_the_resistances_and_the_workers_do_not_matter():
    """A graph keeps the order of its resistances, and a point solved by two workers is
    that solved alone.
    """
    system = pipe_pile("smith")

    both = ri.bearing_graph(system, [600e3, 300e3], cells=12, workers=2)
    alone = ri.bearing_graph(system, 300e3, cells=12, workers=1)

    resistances = both["resistance"].tolist()
    assert resistances == [600e3, 300e3]
    _, second_point = both.points
    (only_point,) = alone.points
    assert second_point == only_point


def pile_with_weight():
    """A pile with a helmet, on which gravity acts; not solved."""
    pile = pipe_pile("smith", HELMET, head=ri.Spring(2e9))
    return pile.replace(gravity=9.81)


def test_a_pile_with_weight_rests_before_the_blow_and_is_compressed_a_little_more():
    """The largest compression in a pile with weight exceeds that without weight by more
    than the stress of the helmet, and by 2 % at most.
    """
    system = pile_with_weight()
    without_weight = system.replace(gravity=0.0)

    graph = ri.bearing_graph(system, 600e3, cells=8, until=0.02)
    graph_without = ri.bearing_graph(without_weight, 600e3, cells=8, until=0.02)

    (point,) = graph.points
    (point_without,) = graph_without.points
    compression = point.compression  # Pa
    compression_without = point_without.compression
    stress_of_helmet = HELMET.mass * 9.81 / AREA
    assert compression > compression_without + stress_of_helmet
    assert compression == pytest.approx(compression_without, rel=0.02)


def test_a_resistance_that_does_not_bear_the_weight_is_refused():
    message = r"resistances: of 1 kN: bodies.2.shaft: cannot bear the weight"
    with pytest.raises(ri.InvalidModel, match=message):
        ri.bearing_graph(pile_with_weight(), [1e3], cells=8)


def test_soil_that_stops_the_pile_far_below_its_length_is_refused(monkeypatch):
    """A resistance that would stop the ram only below the length of the pile is refused
    before a run, with its energy and a remedy.
    """
    monkeypatch.setattr(bearing, "_blow", lambda *_: pytest.fail("solved"))
    energy = RAM.mass * RAM.velocity**2 / 2  # J
    weak = 0.99 * energy / LENGTH  # N

    message = r"resistances\[1\]: 1.8 kN is too small: the 27.3 kJ of the ram would "
    with pytest.raises(ri.InvalidModel, match=message) as caught:
        ri.bearing_graph(pipe_pile("smith"), [300e3, weak])

    remedy = "a number without a unit is in N; raise it, or end the blow by until="
    assert str(caught.value).endswith(remedy)


def test_a_weak_soil_may_be_struck_for_a_given_time():
    """A bearing graph until 1 ms has a point whose blow is not over."""
    weak = 200.0  # N

    graph = ri.bearing_graph(pipe_pile("smith"), weak, cells=8, until=1e-3)

    (point,) = graph.points
    assert not point.is_over


@pytest.mark.parametrize(
    ("until", "message"),
    [
        (None, "resistances: of 300 kN: a run of .* memory.*; end the blow by until="),
        (0.02, "until: a run of .*; end the blow earlier, or take fewer cells"),
    ],
)
def test_a_blow_without_enough_memory_is_refused_by_an_argument_that_was_given(
    until, message, monkeypatch
):
    """If memory is short, the refusal names `until` if it was given, otherwise
    `resistances`.
    """
    monkeypatch.setattr("rodimpact.methods.memory.MAX_BYTES", 1000.0)

    with pytest.raises(ri.InvalidModel, match=message):
        ri.bearing_graph(pipe_pile("smith"), 300e3, cells=8, until=until)


@pytest.fixture(scope="module")
def short_graph():
    """A graph of two blows that are cut short after 5 ms."""
    system = pipe_pile("smith")
    return ri.bearing_graph(system, [300e3, 500e3], cells=8, until=5e-3)


def test_a_graph_is_written_as_a_table_once(short_graph, tmp_path):
    """The CSV file of a bearing graph has its resistances, sets and times bit for bit,
    and no blow that is over; writing it again raises FileExistsError.
    """
    path = tmp_path / "graph.csv"

    short_graph.to_csv(path)

    with path.open() as file:
        rows = list(csv.DictReader(file))
    for row, point in zip(rows, short_graph.points, strict=True):
        resistance = float(row["resistance"])
        written_set = float(row["set"])
        compression_t = float(row["compression_t"])
        assert resistance == point.resistance
        assert written_set == point.set
        assert compression_t == point.compression_t
        assert row["is_over"] == "False"
    with pytest.raises(FileExistsError):
        short_graph.to_csv(path)


def test_a_graph_prints_its_resistances_and_blows_that_are_not_over(short_graph):
    text = str(short_graph)

    assert "300 kN" in text
    assert "At 500 kN: Not over after 5 ms" in text


def test_an_unknown_column_of_a_graph_is_refused(short_graph):
    with pytest.raises(KeyError, match="must be one of resistance, "):
        short_graph["sett"]


def test_a_blow_without_set_has_no_blow_count():
    """A blow is cut short before the toe moves: its set is 0, its blow count infinite,
    "-" in the table, and its graph is not drawn.
    """
    system = pipe_pile("smith")

    graph = ri.bearing_graph(system, [500e3], cells=8, until=2e-3)

    (point,) = graph.points
    assert point.set == 0.0
    assert math.isinf(point.blow_count)
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
    system = pipe_pile("smith")
    with pytest.raises(ri.InvalidModel, match=message):
        ri.bearing_graph(system, **arguments)


def test_a_toe_or_a_shaft_without_soil_is_refused():
    """`bearing_graph` refuses a pile whose toe is no `SmithToe`, and a positive
    `shaft_share` for a pile whose shaft has no soil.
    """
    system = pipe_pile("smith")
    cushion, _ = system.contacts
    without_toe = system.replace(contacts=[cushion, ri.Yielding(1e8, 1e5)])
    ram, pile, wall = system.bodies
    bare_pile = pile.replace(shaft=None)
    bare = system.replace(bodies=[ram, bare_pile, wall])

    with pytest.raises(ri.InvalidModel, match=r"contacts.1: must be SmithToe"):
        ri.bearing_graph(without_toe, 1e5)
    with pytest.raises(ri.InvalidModel, match=r"shaft_share: must be 0 for a pile"):
        ri.bearing_graph(bare, 1e5, shaft_share=0.5)


def test_the_figure_shows_what_the_table_says():
    """Resistances are given in falling order. The figure shows blow counts and stresses
    in rising order, in kN and MPa, and marks both blows as not over.
    """
    system = pipe_pile("smith")
    resistances = [500e3, 300e3]
    graph = ri.bearing_graph(system, resistances, cells=8, until=0.02, workers=1)

    picture = ri.plot.bearing(graph)

    # The figure sorts by resistance; the table keeps the order of the call.
    expected_counts = graph["blow_count"][::-1]
    expected_stresses = graph["compression"][::-1] / 1e6  # MPa
    kilonewtons, blow_counts = picture.blow_count.get_data()
    _, stresses = picture.compression.get_data()
    assert picture.stress_ax.get_xlabel() == "ultimate resistance (kN)"
    assert kilonewtons.tolist() == [300.0, 500.0]
    assert blow_counts.tolist() == expected_counts.tolist()
    assert stresses == pytest.approx(expected_stresses)
    # No blow is over after 20 ms: each is marked.
    marked = picture.unfinished.get_xdata()
    assert marked.tolist() == [300.0, 500.0]
