"""Measured over predicted signals, stations of gauges, and stress over strain."""

import dataclasses

import numpy as np
import pytest
from drawing import texts_of
from exhaustive import few_of
from matplotlib.figure import Figure

import rodimpact as ri
from rodimpact import plot
from rodimpact.units import TIMES

T = 2e-7 * np.arange(501)  # s
VOLTS = np.interp(T, [2e-5, 3e-5, 6e-5, 7e-5], [0, 2, 2, 0])
PULSE = ri.Signal(VOLTS, T, unit="V", name="bar")
PLATEAU = 2.0  # V


@pytest.fixture(scope="module")
def predicted_signal():
    """A predicted signal: the pulse, half as high and 4 us later."""
    return (0.5 * PULSE).shifted(4e-6)


@pytest.fixture(scope="module")
def comparison(predicted_signal):
    """The figure of the pulse and the predicted signal, neither shifted nor scaled."""
    return plot.comparison(PULSE, predicted_signal, shift=0.0, scale=1.0)


def test_measured_and_predicted_signal_are_drawn(comparison, predicted_signal):
    """The figure draws the measured values, and those of the prediction at the same
    times, in us and V, and names both.
    """
    predicted_values = np.interp(T, predicted_signal.times, predicted_signal.values)

    measured_line = comparison.measured
    predicted_line = comparison.predicted
    np.testing.assert_allclose(measured_line.get_xdata(), T * 1e6)
    np.testing.assert_allclose(measured_line.get_ydata(), PULSE.values)
    np.testing.assert_allclose(predicted_line.get_ydata(), predicted_values)
    assert predicted_line.get_label() == "predicted"
    assert comparison.ax.get_ylabel() == "bar (V)"


def test_the_residual_is_drawn_in_parts_of_the_plateau(comparison, predicted_signal):
    """The residual is drawn in % of the plateau of the measured pulse; the figure keeps
    the misfit and prints its rms.
    """
    predicted = np.interp(T, predicted_signal.times, predicted_signal.values)
    residual = (PULSE.values - predicted) / PLATEAU * 100
    misfit = PULSE.misfit(predicted_signal, shift=0.0, scale=1.0)

    drawn_residual = comparison.residual.get_ydata()
    np.testing.assert_allclose(drawn_residual, residual)
    assert comparison.misfit == misfit
    (text,) = texts_of(comparison.residual_ax.texts)
    assert text == f"misfit {100 * misfit.rms:.3g} % of the plateau"


def predictions():
    """Pairs of a predicted signal and the label that names its shift and its gain."""
    earlier = (0.5 * PULSE).shifted(4e-6)
    later = (-4 * PULSE).shifted(-4e-6)
    strain = (1e-3 * PULSE).shifted(4e-6).replace(unit="")
    force = (0.1 * PULSE).shifted(4e-6).replace(unit="N")
    return [
        (earlier, "predicted, 4 µs earlier, x 2"),
        (later, "predicted, 4 µs later, x -0.25"),
        (strain, "predicted, 4 µs earlier, x 1000 V"),
        (force, "predicted, 4 µs earlier, x 10 V/N"),
    ]


@pytest.mark.parametrize(("prediction", "label"), predictions())
def test_shift_and_gain_are_named(prediction, label):
    """The label of a shifted and scaled prediction names both, and its residual is
    nearly 0.
    """
    picture = plot.comparison(PULSE, prediction)

    drawn_label = picture.predicted.get_label()
    plain_label = drawn_label.replace(TIMES, "x").replace("\N{MINUS SIGN}", "-")
    assert plain_label == label
    residual = picture.residual.get_ydata()
    assert residual == pytest.approx(0.0, abs=0.1)


@pytest.mark.parametrize(
    ("ratio", "name"), [(0.05, "its band"), (1e-3, "its band, narrower than the line")]
)
def test_a_band_that_the_line_hides_says_so(ratio, name):
    """`ratio` is the width of the band over the pulse, and `name` its label."""
    band = ratio * PULSE

    picture = plot.comparison(PULSE, PULSE, shift=0.0, scale=1.0, band=band)

    assert picture.band.get_label() == name


def test_the_band_is_scaled_with_the_prediction():
    """A prediction is scaled by -2 to fit the pulse: its band becomes twice as wide."""
    band = 0.05 * PULSE

    picture = plot.comparison(PULSE, -0.5 * PULSE, shift=0.0, band=band)

    # The prediction is scaled by -2, so that the band of 0.1 V is one of 0.2 V.
    (outline,) = picture.band.get_paths()
    top = outline.vertices[:, 1].max()
    assert top == pytest.approx(PLATEAU + 0.2)


@pytest.mark.parametrize(
    ("band", "message"),
    [
        (PULSE.replace(unit="N"), "band: must be in the unit of the prediction"),
        (0.1, "band: must be a Signal"),
    ],
)
def test_a_wrong_band_is_refused(band, message):
    with pytest.raises(ValueError, match=message):
        plot.comparison(PULSE, PULSE, band=band)


def test_a_pair_of_axes_is_used_and_a_single_one_refused():
    """A comparison is drawn on two given Axes: the signals on the first, their residual
    on the second. A single Axes is refused.
    """
    upper, lower = Figure().subplots(2, 1)

    picture = plot.comparison(PULSE, PULSE, [upper, lower], shift=0.0)

    assert picture.ax is upper
    assert picture.residual_ax is lower
    message = "ax: needs a pair of Axes, for signals and residual"
    with pytest.raises(ValueError, match=message):
        plot.comparison(PULSE, PULSE, upper)


def test_long_records_are_thinned():
    """A comparison of records with more than 100,000 samples draws fewer than 3,000 of
    them.
    """
    long = PULSE.resampled(1e-9)
    assert len(long) > 100_000

    picture = plot.comparison(long, long, shift=0.0)

    drawn_times = picture.measured.get_xdata()
    assert drawn_times.size < 3000


def solved_rods(**contacts):
    """The solution of a rod of 0.3 m that strikes one of 1 m at 10 m/s, until 400 us."""
    steel = ri.materials.steel
    first = ri.Rod(0.3, area=1e-4, material=steel, velocity=10.0)
    second = ri.Rod(1.0, area=1e-4, material=steel)
    return ri.solve(ri.System([first, second], **contacts), until=4e-4)


BY_FRONTS = solved_rods()
BY_CHARACTERISTICS = solved_rods(contacts=[ri.Spring(1e8)])


def diagram_with_gauges(solution, across):
    """Space-time diagram with two gauges and displacements magnified ten times."""
    gauges = {"incident": solution.gauge(1, 0.5), "struck end": solution.gauge(1, 0.0)}
    return plot.spacetime(
        solution, gauges=gauges, across=across, magnification=10.0, coordinates="lab"
    )


@pytest.mark.parametrize("across", few_of([False, True], [True]))
def test_stations_are_named(across):
    """Both gauges of a space-time diagram have lines with their names, and texts."""
    picture = diagram_with_gauges(BY_FRONTS, across)

    expected = {"incident", "struck end"}
    labels = {line.get_label() for line in picture.gauges}
    assert labels == expected
    assert expected <= set(texts_of(picture.ax.texts))


def assert_moves_with_its_rod(x_drawn, time_us, solution, start):
    """The station 0.5 m behind the struck end is drawn at `start`, m, plus ten times its
    displacement, from 0 to 400 us.
    """
    # Round-off must not lead beyond the solved time.
    times = np.clip(time_us / 1e6, 0, 4e-4)  # s
    expected = start + 10.0 * solution.displacement(1, 0.5, times)
    assert x_drawn == pytest.approx(expected, abs=1e-12)
    assert time_us[0] == pytest.approx(0.0)
    assert time_us[-1] == pytest.approx(400.0)


def test_stations_move_with_their_rod():
    incident, _ = diagram_with_gauges(BY_FRONTS, across=False).gauges

    x_drawn, time = incident.get_data()
    assert_moves_with_its_rod(x_drawn, time, BY_FRONTS, start=0.8)


def test_stations_move_with_their_rod_where_time_runs_across():
    incident, _ = diagram_with_gauges(BY_FRONTS, across=True).gauges

    time, x_drawn = incident.get_data()
    assert_moves_with_its_rod(x_drawn, time, BY_FRONTS, start=0.8)


@pytest.mark.exhaustive
def test_stations_beyond_a_spring_begin_behind_it():
    """The spring is drawn between the rods, less than 0.1 m wide."""
    incident, _ = diagram_with_gauges(BY_CHARACTERISTICS, across=False).gauges

    x_drawn, time = incident.get_data()
    start, *_ = x_drawn
    drawn_width_of_spring = start - 0.8
    assert 0 < drawn_width_of_spring < 0.1
    assert_moves_with_its_rod(x_drawn, time, BY_CHARACTERISTICS, start)


def reduced_record():
    """A record whose transmitted pulse is 0.8 of the incident one, and its
    reduction.
    """
    t = np.arange(400)  # us
    rise = (t - 100) / 10
    fall = (250 - t) / 10
    trapezoid = np.clip(np.minimum(rise, fall), 0, 1)
    incident = ri.Signal(-1e-3 * trapezoid, dt=1e-6)
    transmitted = (0.8 * incident).shifted(2e-4).extended(before=2e-4)
    reflected = (-0.2 * incident).shifted(2e-4).extended(before=2e-4)
    times = np.arange(0, 5.9e-4, 1e-6)
    first = np.interp(times, incident.times, incident.values)
    second = np.interp(times, reflected.times, reflected.values)
    record = ri.Signal(first + second, times)
    material = ri.Material("m", youngs_modulus=2e11, density=8000)
    bar = ri.Rod(1.5, area=1e-4, material=material)
    specimen = ri.Specimen(5e-3, area=1e-4)
    incident_gauge = ri.BarGauge(record, 0.5)
    transmitted_gauge = ri.BarGauge(transmitted, 0.5)
    return record, ri.reduce(incident_gauge, transmitted_gauge, bar, specimen)


def test_a_reduction_shows_stress_and_strain_rate_over_strain():
    """The figure of a reduction draws nominal stress in MPa and strain rate over the
    strain in %, over loading only, with a largest stress of 160 MPa; its axes name
    both.
    """
    _, reduction = reduced_record()

    picture = plot.reduction(reduction)

    stress = reduction.stress[reduction.loading] / 1e6  # MPa
    strain = 100 * reduction.strain[reduction.loading]  # %
    drawn_strain, drawn_stress = picture.stress.get_data()
    np.testing.assert_allclose(drawn_strain, strain)
    np.testing.assert_allclose(drawn_stress, stress)
    np.testing.assert_allclose(picture.rate.get_xdata(), strain)
    # 0.8 of 1e-3 of strain, in a bar of 200 GPa as thick as the specimen
    assert drawn_stress.max() == pytest.approx(160)
    assert picture.ax.get_ylabel() == "nominal stress (MPa)"
    strain_label = picture.rate_ax.get_xlabel()
    assert strain_label == "nominal strain (%), positive in compression"


@pytest.mark.exhaustive
def test_a_reduction_shows_a_negative_stress_of_the_input_face():
    """The axis of stress goes below 0 only where the stress of the input face does."""
    _, reduction = reduced_record()
    force = np.abs(reduction.output_force)  # N
    pressed = dataclasses.replace(reduction, input_force=force)
    # 20 MPa less, on a section of 1 cm^2
    pulled = dataclasses.replace(reduction, input_force=force - 2000.0)

    lowest_of_pressed, _ = plot.reduction(pressed).ax.get_ylim()  # MPa
    lowest_of_pulled, _ = plot.reduction(pulled).ax.get_ylim()

    assert lowest_of_pressed == 0
    assert lowest_of_pulled < -20


def test_a_signal_is_no_reduction():
    record, _ = reduced_record()

    with pytest.raises(ValueError, match="curve: must be a Reduction"):
        plot.reduction(record)
