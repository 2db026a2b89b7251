"""Records of strain gauges: pulses are shaded from their beginning to their end."""

import numpy as np
import pytest
from drawing import C, legend, rod
from matplotlib.figure import Figure

import rodimpact as ri
from rodimpact import plot

COMPRESSION_SIGN = -1  # sign of the strain: its window lies below 0
TENSION_SIGN = 1
TRANSIT = 1e6 / C  # of 1 m, us


def draw(record, **options):
    """The picture of a record on Axes of its own."""
    ax = Figure(figsize=(5, 4)).add_subplot()
    return plot.gauge(record, ax, **options)


def window(picture, name):
    """Begin and end of a window, us, and the sign of the strains that it holds."""
    box = picture.windows[name]
    start = box.get_x()
    return start, start + box.get_width(), np.sign(box.get_height())


@pytest.fixture(scope="module")
def struck_bar_solution():
    """The solution of a bar that a shorter one strikes, until 600 us."""
    striker = rod(0.2, 10.0)
    system = ri.System([striker, rod()])
    return ri.solve(system, 6e-4)


@pytest.mark.exhaustive
@pytest.mark.parametrize("strain", [1e-4, -3e-4])
def test_the_limits_hold_all_that_is_drawn_and_no_more_than_twice_as_much(strain):
    """The strain axis of a gauge contains all strains, and is at most twice as long as
    their range.
    """
    system = ri.System([rod(0.5, strain=strain)])
    solution = ri.solve(system, 3e-4)

    picture = draw(solution.gauge(0, 0.2))

    values = picture.strain.get_data().values
    low, high = picture.ax.get_ylim()
    assert low <= values.min() < values.max() <= high
    assert high - low < 2 * np.ptp(values)


def test_the_limits_of_a_force_begin_at_0():
    solution = ri.solve(ri.System([rod(0.4, 1.0), rod()]))

    picture = plot.contact(solution)

    low, high = picture.force_ax.get_ylim()
    peak_force = 1.98  # kN, rho c A v/2
    assert low == 0
    assert peak_force <= high <= 1.5 * peak_force


def test_incident_and_reflected_pulse_of_a_struck_bar_are_shaded(struck_bar_solution):
    """The windows of both pulses have their times and signs; the legend names strain,
    waves and pulses.
    """
    picture = draw(struck_bar_solution.gauge(1, 0.4))

    incident = (0.4 * TRANSIT, 0.8 * TRANSIT, COMPRESSION_SIGN)
    reflected = (1.6 * TRANSIT, 2.0 * TRANSIT, TENSION_SIGN)
    assert window(picture, "incident") == pytest.approx(incident)
    assert window(picture, "reflected") == pytest.approx(reflected)
    waves = ["wave running right", "wave running left"]
    assert legend(picture) == ["strain", *waves, "incident", "reflected"]


def test_the_transmitted_pulse_beyond_a_specimen_is_drawn_and_shaded():
    """Of a striker, two bars and a thin specimen, the windows of the incident,
    reflected and transmitted pulse have the expected times and signs; the transmitted
    strain is drawn and named.
    """
    striker = rod(0.2, 10.0)
    specimen = rod(0.02, area=2e-5)
    system = ri.System([striker, rod(), specimen, rod()])
    solution = ri.solve(system, 5e-4)
    on_first_bar = solution.gauge(1, 0.5)
    on_second_bar = solution.gauge(3, 0.3)

    picture = draw(on_first_bar, transmitted=on_second_bar)

    # The pulse is as long as the round trip of the striker, of 0.4 m.
    incident = (0.5 * TRANSIT, 0.9 * TRANSIT, COMPRESSION_SIGN)
    reflected = (1.5 * TRANSIT, 1.9 * TRANSIT, TENSION_SIGN)
    # It has run through a bar and the specimen, and 0.3 m of the second bar.
    transmitted = (1.32 * TRANSIT, 1.72 * TRANSIT, COMPRESSION_SIGN)
    assert window(picture, "incident") == pytest.approx(incident)
    assert window(picture, "reflected") == pytest.approx(reflected)
    assert window(picture, "transmitted") == pytest.approx(transmitted, rel=2e-3)
    drawn = picture.transmitted.get_data().values  # 1e-6
    largest_compression = 1e6 * on_second_bar.strain.min()
    assert drawn.min() == pytest.approx(largest_compression)
    assert "transmitted strain" in legend(picture)


@pytest.mark.exhaustive
def test_windows_of_smooth_waves_are_those_of_the_pulse_of_the_striker():
    """With a spring between two bars, the windows of all three pulses begin and end, to
    1 us, as for the pulse of the striker.
    """
    bars = [rod(0.2, 10.0), rod(), rod()]
    system = ri.System(bars, contacts=[ri.Rigid(), ri.Spring(4e8)])
    solution = ri.solve(system, 4.5e-4, "characteristics")

    on_first_bar = solution.gauge(1, 0.5)
    on_second_bar = solution.gauge(2, 0.5)

    picture = draw(on_first_bar, transmitted=on_second_bar)

    incident = (0.5 * TRANSIT, 0.9 * TRANSIT, COMPRESSION_SIGN)
    reflected = (1.5 * TRANSIT, 1.9 * TRANSIT, TENSION_SIGN)
    transmitted = (1.5 * TRANSIT, 1.9 * TRANSIT)
    assert window(picture, "incident") == pytest.approx(incident, abs=0.3)
    assert window(picture, "reflected") == pytest.approx(reflected, abs=0.5)
    start, end, _ = window(picture, "transmitted")
    assert (start, end) == pytest.approx(transmitted, abs=1.0)


def vibrating_bar():
    """A bar that starts with a strain in one half, and touches another; not solved."""
    strain = ri.Steps([1e-4, 0.0], at=[0.5])
    vibrating = rod(strain=strain)
    return ri.System([vibrating, rod()])


def receding_bars():
    """Two bars that touch, and part at once; not solved."""
    receding = rod(velocity=-1.0)
    return ri.System([receding, rod()])


@pytest.mark.parametrize("system", [vibrating_bar(), receding_bars()])
def test_without_a_pulse_nothing_is_shaded(system):
    """The signal of a gauge without a pulse is drawn without windows."""
    solution = ri.solve(system, 3e-4)

    picture = draw(solution.gauge(0, 0.3))

    assert picture.windows == {}
    assert len(legend(picture)) == 3


def test_a_gauge_at_a_free_end_has_an_incident_pulse(struck_bar_solution):
    picture = draw(struck_bar_solution.gauge(1, 1.0))

    start, _, _ = window(picture, "incident")
    assert start == pytest.approx(TRANSIT)


@pytest.mark.parametrize(
    "options",
    [
        {"method": "fronts"},
        {"method": "characteristics"},
        {"method": "finite-difference", "cells": 100},
    ],
)
def test_a_record_is_drawn_to_its_end(options):
    """The strain of a gauge and the contact force are drawn as steps from 0 to 600 us,
    the end of the run.
    """
    striker = rod(0.2, 10.0)
    system = ri.System([striker, rod()])
    solution = ri.solve(system, 6e-4, **options)

    strain = draw(solution.gauge(1, 0.4)).strain
    (force,) = plot.contact(solution).forces

    for steps in (strain, force):
        values, edges, _ = steps.get_data()
        assert edges[0] == pytest.approx(0.0)
        assert edges[-1] == pytest.approx(600.0)  # us
        assert edges.size == values.size + 1
