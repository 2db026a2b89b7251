"""Signals against closed forms of filters, pulses and shifts."""

import math

import numpy as np
import pytest
from exhaustive import few_of
from numpy.random import default_rng

import rodimpact as ri

BAR = ri.waves.Bar(wave_speed=5000.0, poisson_ratio=0.3, radius=5e-3)


def trapezoid(start=20e-6, rise=4e-6, width=60e-6, height=2.0, dt=1e-7, **names):
    """A pulse of 2001 samples whose half height lasts `width`, s.

    It begins at `start` and rises in `rise`, s. `names` may be the unit and the name.
    """
    corners = start + np.array([0, rise, width, width + rise])
    heights = [0, height, height, 0]
    t = dt * np.arange(2001)
    values = np.interp(t, corners, heights)
    return ri.Signal(values, t, **names)


def tone(frequency, dt=1e-7, count=8001):
    """A burst of one frequency, Hz, under a Gaussian curve about its middle."""
    t = dt * np.arange(count)
    middle = t[-1] / 2
    from_middle = (t - middle) / 5e-5
    envelope = np.exp(-(from_middle**2))
    carrier = np.cos(2 * np.pi * frequency * t)
    return ri.Signal(envelope * carrier, t)


def amplitude(signal, frequency):
    """Complex amplitude of a signal at a frequency: its Fourier integral."""
    phase = 2 * np.pi * frequency * signal.times
    wave = np.exp(-1j * phase)
    return np.sum(signal.values * wave) * signal.dt


def transfer(after, before, frequency):
    """Ratio of the complex amplitudes of a burst after and before it was changed."""
    amplitude_after = amplitude(after, frequency)
    return amplitude_after / amplitude(before, frequency)


def test_signals_are_equal_by_times_values_and_unit():
    """Signals given by a step or by the same times are equal; a signal in another unit
    is not.
    """
    times = [1.0, 1.000001, 1.000002]
    by_step = ri.Signal([0.0, 1.0, 1.0], dt=1e-6, start=1.0, unit="V", name="a")
    by_times = ri.Signal([0, 1, 1], times, unit="V", name="a")
    of_other_unit = by_step.replace(unit="N")
    assert by_step == by_times
    assert by_step != of_other_unit


def test_a_signal_has_a_length_a_start_and_an_end():
    signal = ri.Signal([0.0, 1.0, 1.0], dt=1e-6, start=1.0)
    assert len(signal) == 3
    assert signal.start == 1.0
    assert signal.end == 1.000002


def test_a_signal_is_immutable():
    """The samples of a signal do not follow the array from which it was made; writing
    them, or its unit, raises an error.
    """
    values = np.array([0.0, 1.0, 1.0])
    signal = ri.Signal(values, dt=1e-6)
    values[0] = 7.0
    assert signal.values.tolist() == [0.0, 1.0, 1.0]
    with pytest.raises(ValueError, match="read-only"):
        signal.values[0] = 1.0
    with pytest.raises(AttributeError, match="frozen"):
        signal.unit = "N"


def test_values_between_samples_lie_on_straight_lines():
    """A signal with uneven times is evaluated, and resampled by a step or by times:
    values are linear between its samples.
    """
    signal = ri.Signal([0.0, 2.0, 2.0], [0.0, 1.0, 4.0])
    between = signal.at([0.25, 3.0])
    by_step = signal.resampled(0.5)
    by_times = signal.resampled(times=[0.5, 2.5])
    assert between.tolist() == [0.5, 2.0]
    assert by_step.values.tolist() == [0, 1, 2, 2, 2, 2, 2, 2, 2]
    assert by_times.times.tolist() == [0.5, 2.5]
    assert by_times.values.tolist() == [1.0, 2.0]


def test_a_window_holds_the_samples_inside_and_a_shift_moves_their_times():
    """A window from 0.5 to 4 s of three samples has those at 1 and 4 s; a shift of -1 s
    moves all times.
    """
    signal = ri.Signal([0.0, 2.0, 2.0], [0.0, 1.0, 4.0])
    window = signal.window(0.5, 4.0)
    shifted = signal.shifted(-1.0)
    assert window.times.tolist() == [1.0, 4.0]
    assert shifted.times.tolist() == [-1.0, 0.0, 3.0]


def test_signals_and_numbers_are_added_and_multiplied():
    """Sums, differences, products, quotients and negatives of signals and numbers have
    the values of their samples.
    """
    high = trapezoid(height=2.0)
    low = trapezoid(height=1.0)

    nothing = high - low - low
    raised = 2 * low / 2 + 1.0
    raised_by_minus = 1 - -low

    expected = low.values + 1.0
    assert np.all(nothing.values == 0.0)
    assert raised.values == pytest.approx(expected, abs=1e-15)
    assert raised_by_minus.values == pytest.approx(expected, abs=1e-15)


def test_the_baseline_is_the_mean_of_a_stretch_and_is_subtracted():
    pulse = trapezoid()  # it begins after 20 us
    raised = pulse + 3.0
    lifted = raised.baseline(0.0, 19e-6)
    assert lifted.values == pytest.approx(pulse.values, abs=1e-15)


def test_a_pulse_has_plateau_width_at_half_height_rise_and_start():
    """A negative trapezoid has its negative plateau, its width at half height, its rise
    from 10 % to 90 %, and its start at 10 %.
    """
    start = 20e-6
    whole_rise = 4e-6
    width = 60e-6
    positive = trapezoid(start, whole_rise, width, height=2.0)
    signal = -1 * positive

    pulse = signal.pulse()

    assert pulse.plateau == -2.0
    assert pulse.width == pytest.approx(width, rel=1e-9)
    rise = 0.8 * whole_rise
    assert pulse.rise == pytest.approx(rise, rel=1e-9)
    tenth = start + 0.1 * whole_rise  # time at which the pulse has 10 % of its height
    assert pulse.start == pytest.approx(tenth, rel=1e-9)


def test_the_width_of_a_pulse_is_found_in_noise():
    """The width of a trapezoidal pulse with 1 % of noise is found to 0.1 us."""
    width = 60e-6
    clean = trapezoid(width=width)
    sample = np.arange(len(clean))
    noise = 0.01 * np.sin(sample**2)
    rough = clean.replace(values=clean.values + noise)
    pulse = rough.pulse()
    assert pulse.width == pytest.approx(width, abs=1e-7)


@pytest.mark.parametrize("seed", few_of(range(200), range(12)))
def test_a_shift_is_found_wherever_a_window_lies_or_ends_at_its_limit(seed):
    """A window of a random record is fitted to the record shifted by `delay`: the delay
    is found, or the bound is noted if the bounds leave it out.
    """
    rng = default_rng(seed)
    gaps = rng.uniform(2e-6, 2e-5, 40)
    heights = rng.uniform(-1, 1, 40)
    times = np.cumsum(gaps)
    record = ri.Signal(heights, times).resampled(1e-7)
    last_start = record.end - 6e-5
    start = rng.uniform(record.start, last_start)
    delay = rng.uniform(-1, 1) * 6e-4
    window = record.window(start, start + 6e-5)
    early = record.shifted(-delay)

    wrong_bounds = (delay - 1e-4, delay - 1e-7)  # all below the true delay

    free = window.misfit(early)
    bounded = window.misfit(early, shift=wrong_bounds)

    assert free.shift == pytest.approx(delay, abs=1e-9)
    assert free.rms < 1e-6
    assert bounded.at_limit == ("shift",)


def test_a_free_misfit_finds_shift_and_scale_in_any_unit():
    """The model is 0.4 times the record and comes 33.33 us earlier. `misfit` gives this
    shift, the scale 2.5 and a small rms, also for a model without a unit.
    """
    record = trapezoid(unit="V")
    model = (0.4 * record).shifted(-33.33e-6)

    misfit = record.misfit(model)

    assert misfit.shift == pytest.approx(33.33e-6, abs=1e-9)
    assert misfit.scale == pytest.approx(2.5, rel=1e-4)
    assert misfit.rms < 1e-4
    assert misfit.at_limit == ()
    model_without_unit = model.replace(unit="")
    assert record.misfit(model_without_unit).rms == misfit.rms


def test_a_bounded_misfit_ends_at_the_bounds_next_to_shift_and_scale():
    """The true shift, 33.33 us, and scale, 2.5, lie outside of the bounds."""
    record = trapezoid(unit="V")
    model = (0.4 * record).shifted(-33.33e-6)

    misfit = record.misfit(model, shift=(30e-6, 31e-6), scale=(0.9, 1.1))

    assert misfit.shift == pytest.approx(31e-6, abs=1e-8)
    assert misfit.scale == 1.1
    assert misfit.at_limit == ("shift", "scale")


def test_a_misfit_with_known_shift_and_scale_is_the_rms_over_the_peak():
    """The model is 10 % smaller than the record, so the difference is a tenth of it."""
    record = trapezoid(unit="V")

    weaker = record * 0.9
    peak = 2.0  # V

    misfit = record.misfit(weaker, shift=0.0, scale=1.0)

    rms_of_record = np.sqrt(np.mean(record.values**2))
    rms_of_difference = 0.1 * rms_of_record
    assert misfit.rms == pytest.approx(rms_of_difference / peak, rel=1e-9)
    assert misfit.shift == 0.0
    assert misfit.scale == 1.0
    assert misfit.at_limit == ()


@pytest.mark.parametrize(
    ("kind", "transfer_function"),
    [
        ("gaussian", lambda r: 2 ** (-(r**2) / 2)),
        ("first-order", lambda r: 1 / (1 + 1j * r)),
        ("second-order", lambda r: 1 / (1 - r * r + 1j * math.sqrt(2) * r)),
    ],
)
def test_a_low_pass_has_its_transfer_function_and_keeps_a_constant(
    kind, transfer_function
):
    """The argument of the transfer function is the frequency over the cut-off."""
    frequency = 50e3  # Hz
    burst = tone(frequency)
    for cut_off in (20e3, 50e3, 200e3):
        filtered = burst.low_pass(cut_off, kind)
        factor = transfer(filtered, burst, frequency)
        expected = transfer_function(frequency / cut_off)
        assert factor == pytest.approx(expected, abs=2e-4)
    values = np.full(100, 3.0)
    constant = ri.Signal(values, dt=1e-6)
    filtered = constant.low_pass(2e4, kind)
    np.testing.assert_allclose(filtered.values, 3.0, rtol=1e-12)


def test_a_first_order_low_pass_of_a_ramp_is_exact():
    """1/(1 + s tau) makes t - tau (1 - exp(-t/tau)) of t."""
    t = 1e-6 * np.arange(50)
    cut_off = 30e3  # Hz
    tau = 1 / (2 * math.pi * cut_off)
    expected = t + tau * np.expm1(-t / tau)
    ramp = ri.Signal(t, t)

    answer = ramp.low_pass(cut_off, "first-order")

    np.testing.assert_allclose(answer.values, expected, atol=1e-18)


def test_a_gauge_averages_along_its_length():
    """A gauge of 10 mm, over which waves take 2 us, leaves a straight rise as it is and
    rounds its corner.
    """
    pulse = trapezoid()
    averaging_time = 0.01 / 5000.0  # s, 2 us

    averaged = pulse.as_measured(gauge_length=0.01, wave_speed=5000.0)
    by_short_gauge = pulse.as_measured(gauge_length=1e-30, wave_speed=5000.0)

    # In the middle of the rise, from 20 us to 24 us, the mean is the value.
    t = averaged.times
    is_in_rise = (t > 21e-6) & (t < 23e-6)
    values = averaged.values[is_in_rise]
    expected = pulse.values[is_in_rise]
    np.testing.assert_allclose(values, expected, atol=1e-12)
    # At the corner half of the time is before the rise, whose slope is 0.5e6 1/s.
    corner = np.argmin(np.abs(t - 20e-6))
    half_time = averaging_time / 2
    triangle = 0.5e6 * half_time**2 / 2
    mean_at_corner = triangle / averaging_time
    value_at_corner = averaged.values[corner]
    assert value_at_corner == pytest.approx(mean_at_corner, rel=1e-9)
    assert by_short_gauge.values == pytest.approx(pulse.values, abs=1e-6)


def test_an_amplifier_filters_scales_and_adds_an_offset():
    """`as_measured` is a low pass of this order, times the scale, plus the offset;
    without arguments nothing changes.
    """
    pulse = trapezoid()
    amplified = pulse.as_measured(bandwidth=100e3, order=2, scale=3.0, offset=0.5)
    unchanged = pulse.as_measured()
    filtered = pulse.low_pass(100e3, "second-order")
    assert amplified == filtered * 3 + 0.5
    assert unchanged == pulse


def test_each_vibration_propagates_at_its_own_speed_up_to_the_end_of_the_mode():
    """The phase of a burst is turned by its wave number times the distance; beyond the
    first mode, at 262 kHz, nothing arrives.
    """
    distance = 0.7
    for frequency in (20e3, 120e3, 240e3):
        burst = tone(frequency)
        arrived = burst.propagated(distance, BAR)
        factor = transfer(arrived, burst, frequency)
        phase = BAR.wavenumber(frequency) * distance
        exact = np.exp(-1j * phase)
        # The burst has some width in frequency, along which the speed changes.
        bound = 2e-3 + 0.05 * (frequency / 240e3) ** 2
        assert factor == pytest.approx(exact, abs=bound)
    beyond = tone(300e3)  # the first mode ends at 262 kHz
    arrived = beyond.propagated(distance, BAR)
    assert np.abs(arrived.values).max() < 1e-3


def test_a_propagated_pulse_varies_smoothly_with_the_bar():
    """The number of frequencies below the cut-off changes from one bar to the next, and
    the pulse does not jump with it.
    """
    pulse = trapezoid(rise=1e-6).extended(1e-4, 1e-4)
    speeds = np.linspace(5000.0, 5040.0, 41)
    propagated = []
    for speed in speeds:
        bar = ri.waves.Bar(speed, 0.29, 5e-3)
        arrived = pulse.propagated(0.5, bar)
        propagated.append(arrived.values)
    # The differences are [bar, sample].
    first_differences = np.diff(propagated, axis=0)
    second_differences = np.diff(first_differences, axis=0)
    largest_first = np.abs(first_differences).max()
    largest_second = np.abs(second_differences).max()
    assert largest_second < 0.1 * largest_first


def test_propagation_back_undoes_propagation():
    """A pulse propagated by 0.5 m in a dispersive bar and back is itself to 1e-5."""
    pulse = trapezoid(rise=20e-6).low_pass(60e3)
    longer = pulse.extended(1e-4, 1e-4)
    there = longer.propagated(0.5, BAR)
    back = there.propagated(-0.5, BAR)
    values = back.at(pulse.times)
    np.testing.assert_allclose(values, pulse.values, atol=1e-5)


def test_a_propagated_record_begins_later_by_the_way_over_the_wave_speed():
    """The start of a signal propagated over a distance is later by the distance over
    the wave speed of the bar.
    """
    pulse = trapezoid()
    distance = 0.5
    arrival = pulse.start + distance / BAR.wave_speed
    propagated = pulse.propagated(distance, BAR)
    assert propagated.start == pytest.approx(arrival, rel=1e-12)


def test_a_pulse_keeps_its_shape_without_dispersion():
    pulse = trapezoid(rise=20e-6).low_pass(60e3)
    without_dispersion = ri.waves.Bar(wave_speed=5000.0, poisson_ratio=0.0, radius=5e-3)
    arrived = pulse.propagated(0.5, without_dispersion)
    np.testing.assert_allclose(arrived.values, pulse.values, atol=1e-5)


def test_a_rod_is_a_bar_if_it_is_round_or_a_radius_is_given():
    """A pulse propagated along a round rod is that along its `Bar`, and that along
    another rod with this radius.
    """
    steel = ri.materials.steel
    rod = ri.Rod(1.0, diameter=0.02, material=steel)
    bar = ri.waves.Bar.of(rod)
    area = rod.segments[0].area
    not_round = ri.Rod(1.0, area=area, material=steel)
    pulse = trapezoid()

    propagated = pulse.propagated(0.2, rod)
    by_bar = pulse.propagated(0.2, bar)
    by_radius = pulse.propagated(0.2, not_round, radius=bar.radius)

    assert propagated == by_bar
    assert propagated == by_radius


def test_an_extended_signal_repeats_its_first_and_its_last_value():
    signal = ri.Signal([1.0, 2.0, 3.0], dt=0.5)
    extended = signal.extended(before=1.0, after=0.7)  # of 0.7 s, the next 2 samples
    assert extended.times.tolist() == [-1, -0.5, 0, 0.5, 1, 1.5, 2]
    assert extended.values.tolist() == [1, 1, 1, 2, 3, 3, 3]


def test_a_signal_is_written_as_a_table_once_and_read_back_equal(tmp_path):
    """A signal in CSV has a head with name and unit and is read back equal; writing it
    again raises FileExistsError.
    """
    path = tmp_path / "a.csv"
    signal = trapezoid(unit="V", name="incident bar")

    signal.to_csv(path)

    head, *_ = path.read_text().splitlines()
    assert head == "time [s],incident bar [V]"
    assert ri.read_signals(path) == {"incident bar": signal}
    with pytest.raises(FileExistsError):
        signal.to_csv(path)


def test_a_signal_whose_name_breaks_a_table_is_not_written(tmp_path):
    signal = trapezoid(unit="V", name="a,b")
    with pytest.raises(ri.InvalidModel, match="name: a column is named by"):
        signal.to_csv(tmp_path / "b.csv")


def test_a_signal_comes_back_equal_from_xarray():
    pytest.importorskip("xarray")
    signal = trapezoid(unit="V", name="incident")

    data = signal.to_xarray()

    assert data.attrs == {"long_name": "incident", "units": "V"}
    assert data["time"].attrs == {"long_name": "time", "units": "s"}
    assert ri.Signal.from_xarray(data) == signal


def test_units_of_a_data_array_are_converted_and_must_be_there():
    """An xarray array in microstrain over us becomes a signal in SI units; one without
    units, or a number, is refused.
    """
    xarray = pytest.importorskip("xarray")
    times = ("t", [0.0, 2.0], {"units": "us"})
    unit = {"units": "microstrain"}
    strain = xarray.DataArray([0.0, 500.0], {"t": times}, "t", "bar", unit)
    expected = ri.Signal([0.0, 5e-4], [0.0, 2e-6], name="bar")
    without_units = xarray.DataArray([0.0, 500.0], {"t": [0.0, 2.0]}, "t")

    assert ri.Signal.from_xarray(strain) == expected
    with pytest.raises(ValueError, match="unknown unit None"):
        ri.Signal.from_xarray(without_units)
    with pytest.raises(ValueError, match="must be a DataArray of one dimension"):
        ri.Signal.from_xarray(3)


@pytest.mark.parametrize(
    ("kind", "nu", "strain_per_ratio"),
    [
        ("quarter", None, 4.0),
        ("half", None, 2.0),
        ("half", 0.25, 3.2),
        ("full", 0.25, 1.6),
    ],
)
def test_a_bridge_makes_strain_of_volts_and_refuses_another_unit(
    kind, nu, strain_per_ratio
):
    """`strain_per_ratio` is gauge factor times strain over the ratio of voltages."""
    gauge_factor = 2.0
    excitation = 10.0  # V
    gain = 50.0
    bridge = ri.Bridge(
        kind,
        gauge_factor=gauge_factor,
        excitation=excitation,
        gain=gain,
        poisson_ratio=nu,
    )
    volts = trapezoid(height=2.0, unit="V", name="a")

    strain = bridge.strain(volts)

    ratio_of_voltages = 2.0 / gain / excitation
    plateau = strain_per_ratio * ratio_of_voltages / gauge_factor
    pulse = strain.pulse()
    assert pulse.plateau == pytest.approx(plateau, rel=1e-12)
    assert strain.unit == ""
    assert strain.name == "a"
    message = "volts: must be a signal in V, got 'a' in pure numbers"
    with pytest.raises(ValueError, match=message):
        bridge.strain(strain)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"kind": "third"},
            "kind: must be one of 'quarter', 'half', 'full', got 'third'",
        ),
        ({"kind": "full"}, "poisson_ratio: is missing"),
        ({"poisson_ratio": 0.3}, "poisson_ratio: is for gauges across"),
        ({"gain": 0}, "gain: must not be 0"),
        ({"excitation": -1.0}, "excitation: must be a finite"),
        ({"gauge_factor": [2.0, 2.1]}, "gauge_factor: must be a single number"),
    ],
)
def test_wrong_bridges_are_refused(changes, said):
    arguments = {"kind": "quarter", "gauge_factor": 2.0, "excitation": 10.0}
    arguments |= changes
    with pytest.raises(ri.InvalidModel, match=said):
        ri.Bridge(**arguments)


PULSE = trapezoid()
LINE = ri.Signal([0.0, 2.0, 2.0], [0.0, 1.0, 4.0])
ROD = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: ri.Signal([1.0, 2.0]), "times: give either the times, or dt"),
        (
            lambda: ri.Signal([1.0, 2.0], [0.0, 1.0], dt=1.0),
            "times: give either the times, or dt",
        ),
        (
            lambda: ri.Signal([1.0], dt=1.0),
            "values: must be a list of two or more numbers",
        ),
        (
            lambda: ri.Signal([1.0, math.nan], dt=1.0),
            r"values\[1\]: must be a finite number, got nan",
        ),
        (
            lambda: ri.Signal([1.0, 2.0, 3.0], [0.0, 1.0]),
            "times: must be as many as values, got 2",
        ),
        (
            lambda: ri.Signal([1.0, 2.0, 3.0], [0.0, 2.0, 1.0]),
            r"times\[1\]: must increase, got 1.0",
        ),
        (
            lambda: ri.Signal([1.0, 2.0], dt=0.0),
            "dt: must be a finite positive .*, got 0.0",
        ),
        (
            lambda: ri.Signal([1.0, 2.0], dt=1.0, unit="mV"),
            "unit: must be an SI unit, got 'mV'; "
            "give the values in V, multiplied by 0.001",
        ),
        (lambda: ri.Signal([1.0, 2.0], dt=1.0, unit=3), "unit: must be a word, got 3"),
        (lambda: ri.Signal("12", dt=1.0), "values: must be a number"),
        (
            lambda: LINE.at(4.1),
            "t: must be from 0.0 to 4.0 s, as the signal is, got 4.1",
        ),
        (
            lambda: LINE.dt,
            "are not at equal steps .sample 1 is at 1.0 s.; use resampled",
        ),
        (
            lambda: LINE.window(1.5, 3.0),
            "fewer than two .* 3.0 s; the signal runs from 0.0",
        ),
        (lambda: LINE.resampled(), "give either dt or times"),
        (lambda: LINE.resampled(5.0), "makes 1.8 samples"),
        (lambda: LINE.resampled(times=[1.0, 5.0]), r"t\[1\]: must be .*, got 5.0"),
        (lambda: PULSE + PULSE.shifted(1e-6), "have different times; use .resampled"),
        (
            lambda: PULSE + PULSE.replace(unit="V"),
            "is in pure numbers and signal in V; they cannot be add",
        ),
        (lambda: PULSE * PULSE, "number: must"),
        (lambda: PULSE / 0, "number: must not be 0"),
        (lambda: PULSE + "1", "number: must be a number"),
        (lambda: (PULSE * 0).pulse(), "is 0 everywhere"),
        (lambda: PULSE.window(30e-6, 2e-4).pulse(), "cuts the pulse off"),
        (lambda: PULSE.window(0.0, 60e-6).pulse(), "cuts the pulse off"),
        (
            lambda: PULSE.replace(unit="V").misfit(PULSE, scale=1.0),
            "is in V and signal in pure numbers",
        ),
        (lambda: PULSE.misfit(3), "other: must be a Signal"),
        (
            lambda: PULSE.misfit(PULSE, shift=(2.0, 1.0)),
            "shift: must be a number, or .low, high",
        ),
        (lambda: (PULSE * 0).misfit(PULSE), "0 everywhere"),
        (
            lambda: PULSE.low_pass(6e6),
            "must be below half of the sampling rate, 10 MHz",
        ),
        (lambda: PULSE.low_pass(1e-6), "dt: 1e-07 makes the filtered record longer"),
        (lambda: PULSE.low_pass(5e-324), "frequency: must be 0 or of a magnitude from"),
        (lambda: PULSE.low_pass(1e4, "boxcar"), "kind: must be one of 'gaussian'"),
        (lambda: PULSE.as_measured(gauge_length=0.01), "wave_speed: must be a number"),
        (
            lambda: PULSE.as_measured(gauge_length=-0.01),
            "gauge_length: must be .*, got -0.01",
        ),
        (
            lambda: PULSE.as_measured(bandwidth=1e5, order=3),
            "order: must be 1 or 2, got 3",
        ),
        (lambda: PULSE.propagated(0.2, ROD), "bar.section: is not said to be round"),
        (lambda: PULSE.propagated(0.2, BAR, radius=1.0), "radius: belongs to a rod"),
        (
            lambda: PULSE.propagated(0.2, 5000.0),
            "bar: must be a Bar, such as waves.Bar",
        ),
        (lambda: PULSE.propagated(1e9, BAR), "dt: .* makes the filtered record longer"),
        (lambda: LINE.propagated(1.0, BAR), "not at equal steps"),
        (lambda: PULSE.extended(-1.0), "before: must be 0 or more"),
    ],
)
def test_mistakes_are_refused(call, said):
    with pytest.raises(ValueError, match=said):
        call()


# Several signals in one table or Dataset, and back

RNG = default_rng(5)
INTERVALS = RNG.uniform(0.99e-7, 1.01e-7, 500)
T = np.cumsum(INTERVALS) - 2e-5
UNITS = {
    "bar 1 (mV)": "V",
    "Länge/2": "",
    "入力棒": "N",
    "2": "Pa",
    "b_V": "m/s^2",
    "in a.b:c-d": "m",
    "x" * 60: "",
}
SIGNALS = {}
for exponent, (name, unit) in enumerate(UNITS.items()):
    values = RNG.normal(size=500) * 10.0**exponent
    SIGNALS[name] = ri.Signal(values, T, unit=unit, name=name)


def test_a_table_is_read_as_it_was_written_and_replaced_only_by_force(tmp_path):
    """Signals are written and read back equal; the file is replaced with force=True
    only.
    """
    path = tmp_path / "a.csv"
    other = {"2": SIGNALS["2"]}

    ri.write_signals(path, SIGNALS)

    assert ri.read_signals(path) == SIGNALS
    with pytest.raises(FileExistsError):
        ri.write_signals(path, other)
    ri.write_signals(path, other, force=True)
    assert ri.read_signals(path) == other


def test_a_dataset_is_read_as_it_was_made():
    """Signals that are put into a dataset come back equal; units are attributes."""
    pytest.importorskip("xarray")
    data = ri.signals_to_xarray(SIGNALS)
    restored = ri.signals_from_xarray(data)
    assert data["b_V"].attrs["units"] == "m/s^2"
    assert data["time"].attrs["units"] == "s"
    assert restored == SIGNALS


def test_what_is_no_dataset_has_no_signals():
    with pytest.raises(ValueError, match="data: must be an xarray Dataset, got 3"):
        ri.signals_from_xarray(3)


@pytest.mark.parametrize(
    ("signals", "said"),
    [
        ({}, "signals: must be signals by name"),
        ([SIGNALS["2"]], "signals: must be signals by name"),
        ({"a": 1.0}, "signals.a: must be a Signal"),
        (
            {"a": SIGNALS["2"], "b": SIGNALS["2"].shifted(1.0)},
            "'b' and 'a' have different times",
        ),
        ({"a,b": SIGNALS["2"]}, "signals: a column is named by"),
        ({"Time 2": SIGNALS["2"]}, "signals: a column is named by"),
        ({"a_": SIGNALS["2"]}, "signals: a column is named by"),
        ({"a  b": SIGNALS["2"]}, "signals: a column is named by"),
        (
            {"a": SIGNALS["2"].replace(unit="m,s")},
            "unit: a unit in a table has no brackets",
        ),
    ],
)
def test_signals_that_make_no_table_are_refused_and_write_no_file(
    tmp_path, signals, said
):
    path = tmp_path / "a.csv"
    with pytest.raises(ri.InvalidModel, match=said):
        ri.write_signals(path, signals)
    assert not path.exists()


ONES = np.ones(len(PULSE))


@pytest.mark.parametrize(
    "call",
    [
        lambda: ONES + PULSE,
        lambda: PULSE + ONES,
        lambda: ONES - PULSE,
        lambda: ONES * PULSE,
        lambda: PULSE / ONES,
    ],
)
def test_arrays_are_refused_in_arithmetic(call):
    with pytest.raises(ri.InvalidModel, match="number: must be a single number or"):
        call()


@pytest.mark.parametrize("two", [np.float64(2.0), np.float32(2.0), np.array(2.0)])
def test_numbers_of_numpy_are_taken_in_arithmetic(two):
    assert two * PULSE == 2.0 * PULSE
    assert two + PULSE == 2.0 + PULSE
