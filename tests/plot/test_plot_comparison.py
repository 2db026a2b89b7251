"""Measured over predicted, and stations of gauges in space and time."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import rodimpact as ri
from rodimpact import plot
from rodimpact.units import TIMES

T = 2e-7 * np.arange(501)
PULSE = ri.Signal(
    np.interp(T, [2e-5, 3e-5, 6e-5, 7e-5], [0, 2, 2, 0]), T, unit="V", name="bar"
)


def test_what_is_drawn_is_measured_predicted_and_their_difference():
    model = (0.5 * PULSE).shifted(4e-6)
    picture = plot.comparison(PULSE, model, shift=0.0, scale=1.0)
    assert picture.misfit == PULSE.misfit(model, shift=0.0, scale=1.0)
    np.testing.assert_allclose(picture.measured.get_xdata(), T * 1e6)
    np.testing.assert_allclose(picture.measured.get_ydata(), PULSE.values)
    wanted = np.interp(T, model.times, model.values)
    np.testing.assert_allclose(picture.predicted.get_ydata(), wanted)
    np.testing.assert_allclose(
        picture.residual.get_ydata(), (PULSE.values - wanted) / 2 * 100
    )
    assert picture.predicted.get_label() == "predicted"
    assert picture.ax.get_ylabel() == "bar (V)"
    (text,) = picture.residual_ax.texts
    assert text.get_text() == f"misfit {100 * picture.misfit.rms:.3g} % of the plateau"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda s: (0.5 * s).shifted(4e-6), "predicted, 4 µs earlier, x 2"),
        (lambda s: (-4 * s).shifted(-4e-6), "predicted, 4 µs later, x -0.25"),
        (
            lambda s: (1e-3 * s).shifted(4e-6).replace(unit=""),
            "predicted, 4 µs earlier, x 1000 V",
        ),
        (
            lambda s: (0.1 * s).shifted(4e-6).replace(unit="N"),
            "predicted, 4 µs earlier, x 10 V/N",
        ),
    ],
)
def test_shift_and_gain_are_told(change, said):
    picture = plot.comparison(PULSE, change(PULSE))
    label = (
        picture.predicted.get_label().replace(TIMES, "x").replace("\N{MINUS SIGN}", "-")
    )
    assert label == said
    residual = picture.residual.get_ydata()
    assert residual == pytest.approx(0.0, abs=0.1)


def test_the_band_is_scaled_with_the_prediction():
    picture = plot.comparison(PULSE, -0.5 * PULSE, shift=0.0, band=0.05 * PULSE)
    top = picture.band.get_paths()[0].vertices[:, 1].max()
    assert top == pytest.approx(2.2)
    for band, said in (
        (PULSE.replace(unit="N"), "band: must be in the unit of the prediction"),
        (0.1, "band: must be a Signal"),
    ):
        with pytest.raises(ValueError, match=said):
            plot.comparison(PULSE, PULSE, band=band)


def test_axes_are_a_pair_and_long_records_are_thinned():
    pair = Figure().subplots(2, 1)
    long = PULSE.resampled(1e-9)
    picture = plot.comparison(long, long, pair, shift=0.0)
    assert (picture.ax, picture.residual_ax) == tuple(pair)
    assert picture.measured.get_xdata().size < 3000 < len(long)
    with pytest.raises(
        ValueError, match="ax: needs a pair of Axes, for signals and residual"
    ):
        plot.comparison(PULSE, PULSE, pair[0])


def rods(**law):
    steel = ri.materials.steel
    both = [
        ri.Rod(L, area=1e-4, material=steel, velocity=v)
        for L, v in ((0.3, 10.0), (1.0, 0.0))
    ]
    return ri.solve(ri.System(both, **law), until=4e-4)


@pytest.mark.parametrize(
    "solution",
    [rods(), rods(contacts=[ri.Spring(1e8)])],
    ids=["fronts", "characteristics"],
)
@pytest.mark.parametrize("across", [False, True])
def test_stations_move_with_their_rod(solution, across):
    gauges = {"incident": solution.gauge(1, 0.5), "struck end": solution.gauge(1, 0.0)}
    picture = plot.spacetime(
        solution, gauges=gauges, across=across, magnification=10.0, coordinates="lab"
    )
    assert [line.get_label() for line in picture.gauges] == list(gauges)
    place, time = picture.gauges[0].get_data()[:: -1 if across else 1]
    spring = (
        0.0 if isinstance(solution.system.contacts[0], ri.Rigid) else place[0] - 0.8
    )
    wanted = (
        0.8
        + spring
        + 10.0 * solution.displacement(1, 0.5, np.clip(time / 1e6, 0, 4e-4))
    )
    assert 0 <= spring < 0.1
    assert place == pytest.approx(wanted, abs=1e-12)
    assert (time[0], time[-1]) == pytest.approx((0.0, 400.0))
    assert {"incident", "struck end"} <= {text.get_text() for text in picture.ax.texts}


def test_a_reduction_shows_stress_with_its_band_over_strain():
    ramp = np.clip(np.minimum(np.arange(400) - 100, 250 - np.arange(400)) / 10, 0, 1)
    incident = ri.Signal(-1e-3 * ramp, dt=1e-6)
    transmitted = (0.8 * incident).shifted(2e-4).extended(before=2e-4)
    back = (-0.2 * incident).shifted(2e-4).extended(before=2e-4)
    times = np.arange(0, 5.9e-4, 1e-6)
    both = ri.Signal(
        np.interp(times, incident.times, incident.values)
        + np.interp(times, back.times, back.values),
        times,
    )
    bar = ri.Rod(
        1.5, area=1e-4, material=ri.Material("m", youngs_modulus=2e11, density=8000)
    )
    found = ri.reduce(
        ri.BarGauge(both, 0.5),
        ri.BarGauge(transmitted, 0.5),
        bar,
        ri.Specimen(5e-3, area=1e-4),
    )
    picture = plot.reduction(found)
    assert picture.ax.get_ylabel() == "stress (MPa)"
    np.testing.assert_allclose(
        picture.stress.get_ydata(), found.stress[found.loading] / 1e6
    )
    np.testing.assert_allclose(
        picture.rate.get_xdata(), 100 * found.strain[found.loading]
    )
    assert picture.stress.get_ydata().max() == pytest.approx(160)
    with pytest.raises(ValueError, match="curve: must be a Reduction"):
        plot.reduction(both)
