"""Records of strain gauges: the pulses in them are shaded when and as long as they pass."""

import numpy as np
import pytest
from drawing import C, legend, rod
from matplotlib.figure import Figure

import rodimpact as ri
from rodimpact import plot


def draw(record, **kwargs):
    return plot.gauge(record, Figure(figsize=(5, 4)).add_subplot(), **kwargs)


def spans(picture):
    """By name: when a window begins and ends, in µs, and on which side of 0 it lies."""
    return {
        name: (w.get_x(), w.get_x() + w.get_width(), np.sign(w.get_height()))
        for name, w in picture.windows.items()
    }


@pytest.mark.parametrize("strain", [1e-4, -3e-4])
def test_the_limits_hold_all_that_is_drawn(strain):
    """And no more than twice as much."""
    solution = ri.solve(ri.System([rod(0.5, strain=strain)]), 3e-4)
    picture = draw(solution.gauge(0, 0.2))
    values = picture.strain.get_data().values
    low, high = picture.ax.get_ylim()
    assert low <= values.min() < values.max() <= high
    assert high - low < 2 * np.ptp(values)
    force = plot.contact(ri.solve(ri.System([rod(0.4, 1.0), rod()]))).force_ax
    assert 1.0 <= force.get_ylim()[1] / 1.98 <= 1.5  # kN
    assert force.get_ylim()[0] == 0


def test_incident_and_reflected_pulse_of_a_struck_bar():
    solution = ri.solve(ri.System([rod(0.2, 10.0), rod()]), 6e-4)
    picture = draw(solution.gauge(1, 0.4))
    windows = spans(picture)
    assert windows["incident"] == pytest.approx((0.4e6 / C, 0.8e6 / C, -1))
    assert windows["reflected"] == pytest.approx((1.6e6 / C, 2.0e6 / C, 1))
    assert legend(picture) == [
        "strain",
        "wave running right",
        "wave running left",
        "incident",
        "reflected",
    ]


def test_transmitted_pulse_beyond_a_specimen():
    bars = [rod(0.2, 10.0), rod(), rod(0.02, area=2e-5), rod()]
    solution = ri.solve(ri.System(bars), 5e-4)
    picture = draw(solution.gauge(1, 0.5), transmitted=solution.gauge(3, 0.3))
    windows = spans(picture)
    assert windows["incident"] == pytest.approx((0.5e6 / C, 0.9e6 / C, -1))
    assert windows["reflected"] == pytest.approx((1.5e6 / C, 1.9e6 / C, 1))
    assert windows["transmitted"] == pytest.approx(
        (1.32e6 / C, 1.72e6 / C, -1), rel=2e-3
    )
    drawn = picture.transmitted.get_data().values
    assert drawn.min() == pytest.approx(1e6 * solution.gauge(3, 0.3).strain.min())
    assert "transmitted strain" in legend(picture)


def test_on_a_time_step_the_windows_are_the_same():
    bars = ri.System(
        [rod(0.2, 10.0), rod(), rod()], contacts=[ri.Rigid(), ri.Spring(4e8)]
    )
    solution = ri.solve(bars, 4.5e-4, "characteristics")
    windows = spans(draw(solution.gauge(1, 0.5), transmitted=solution.gauge(2, 0.5)))
    assert windows["incident"] == pytest.approx((0.5e6 / C, 0.9e6 / C, -1), abs=0.3)
    assert windows["reflected"] == pytest.approx((1.5e6 / C, 1.9e6 / C, 1), abs=0.5)
    assert windows["transmitted"][:2] == pytest.approx((1.5e6 / C, 1.9e6 / C), abs=1.0)


@pytest.mark.parametrize(
    "system",
    [
        ri.System(
            [rod(strain=ri.Steps([1e-4, 0.0], at=[0.5])), rod()]
        ),  # the bar vibrates
        ri.System([rod(velocity=-1.0), rod()]),  # nothing collides
    ],
)
def test_where_there_is_no_pulse_nothing_is_shaded(system):
    picture = draw(ri.solve(system, 3e-4).gauge(0, 0.3))
    assert picture.windows == {}
    assert len(legend(picture)) == 3


def test_a_gauge_at_a_free_end_has_windows_too():
    solution = ri.solve(ri.System([rod(0.2, 10.0), rod()]), 6e-4)
    assert spans(draw(solution.gauge(1, 1.0)))["incident"][0] == pytest.approx(1e6 / C)


@pytest.mark.parametrize("method", ["fronts", "characteristics", "finite-difference"])
def test_a_record_is_drawn_to_its_end(method):
    solution = ri.solve(ri.System([rod(0.2, 10.0), rod()]), 6e-4, method)
    steps = draw(solution.gauge(1, 0.4)).strain, plot.contact(solution).forces[0]
    for values, edges, _ in (drawn.get_data() for drawn in steps):
        assert edges[[0, -1]] == pytest.approx([0.0, 600.0])
        assert edges.size == values.size + 1
