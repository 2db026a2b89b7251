"""Fits find the system that made a record, and say how well they know it."""

import csv
import math
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
import pytest
from exhaustive import few_of
from numpy.random import default_rng
from validation_cases import validation_module

import rodimpact as ri
from rodimpact.fitting import objective as objective_module
from rodimpact.fitting.additions import predicted_residuals
from rodimpact.fitting.notes import noise_before_pulse, notes_on_numbers
from rodimpact.fitting.objective import Objective, compute_strains
from rodimpact.fitting.parameters import (
    record_parameters,
    system_parameters,
    with_values,
)
from rodimpact.fitting.uncertainty import covariance
from rodimpact.methods.registry import Options
from rodimpact.units import format_si

STEEL = ri.materials.steel
UNTIL = 1.5e-4  # s
INTERVAL = 5e-7  # of a record, s
GAUGE = (1, 0.2)  # body, m from its left end
PULSE_INTERVAL = 4e-7  # s, of a pulse of the titanium bar
CUTOFF_TIMES_BLUR = 0.1325
"""-3 dB frequency times standard deviation of a Gaussian blur: sqrt(ln 2)/(2 pi)."""
LENGTH = "bodies.0.length"
VELOCITY = "bodies.0.velocity"


def rods(length=0.2, velocity=10.0, material=STEEL, **settings):
    """A striker and a bar of 0.6 m."""
    striker = ri.Rod(length, area=1e-4, material=material, velocity=velocity)
    bar = ri.Rod(0.6, area=1e-4, material=material)
    return ri.System([striker, bar], **settings)


def record(system, noise=0.0):
    """Strain of a system at the gauge, a signal, with white noise of this standard
    deviation.
    """
    solution = ri.solve(system, until=UNTIL)
    gauge = solution.gauge(*GAUGE)
    signal = gauge.signal(INTERVAL, name="gauge")
    rng = default_rng(7)
    white = rng.standard_normal(len(signal))
    values = signal.values + noise * white
    return signal.replace(values=values)


def measured(signal, shift=0.0, gain=1.0):
    """A record at the gauge; shift and gain are known, or (low, high)."""
    return ri.Measured(signal, GAUGE, shift=shift, gain=gain)


VARY_LENGTH = {LENGTH: (0.1, 0.4)}
VARY_VELOCITY = {VELOCITY: (1.0, 20.0)}


def fitted(records, vary, guess=None, **options):
    """Fit by one search, which begins at the system `guess`: at `rods()`, the true one
    of most records, if it is None.
    """
    if guess is None:
        guess = rods()
    return ri.fit(guess, records, vary, UNTIL, starts=1, **options)


def rods_with_law(law):
    """The striker and the bar with this law of their contact."""
    return rods(contacts=[law])


# Best values --------------------------------------------------------------------------


RELATIVE_NOISE = 0.02
"""Noise of the record of `noisy_fit` over its strain."""


@pytest.fixture(scope="module")
def noisy_fit():
    """Fit of length and velocity of the striker to a record with noise.

    The search begins at another striker, of 0.24 m and 5 m/s.
    """
    strain = 10.0 / (2 * STEEL.wave_speed)  # v/(2 c), of a striker of equal impedance
    noise = RELATIVE_NOISE * strain
    noisy = measured(record(rods(), noise))
    vary = {LENGTH: (0.15, 0.25), VELOCITY: (1.0, 20.0)}
    first_guess = rods(length=0.24, velocity=5.0)
    return ri.fit(first_guess, noisy, vary, UNTIL)


@pytest.mark.parametrize(("path", "true_value"), [(LENGTH, 0.2), (VELOCITY, 10.0)])
def test_a_fit_finds_the_system_that_made_a_record(noisy_fit, path, true_value):
    """Length and velocity are within 0.5 % and four standard errors of the true ones;
    there are no notes.
    """
    value = noisy_fit.values[path]
    assert value == pytest.approx(true_value, rel=5e-3)
    # Four standard errors are hardly ever passed.
    standard_error = noisy_fit.standard_errors[path]
    assert abs(value - true_value) < 4 * standard_error
    assert not noisy_fit.notes
    striker = noisy_fit.system.bodies[0]
    assert striker.length == noisy_fit.values[LENGTH]


def test_the_standard_error_is_that_of_a_mean_over_the_pulse(noisy_fit):
    """The error of the velocity is that of one sample over the root of the number of
    samples.
    """
    duration = 2 * 0.2 / STEEL.wave_speed  # s, two transits of the striker
    samples = int(duration / INTERVAL)
    error_of_a_sample = RELATIVE_NOISE * 10.0  # m/s
    expected = error_of_a_sample / samples**0.5
    standard_error = noisy_fit.standard_errors[VELOCITY]
    # The noise is estimated from 300 samples, so the error is known to some percent.
    assert standard_error == pytest.approx(expected, rel=0.2)


def test_the_misfit_is_that_of_the_prediction_and_as_large_as_the_noise(noisy_fit):
    """The misfit of a fit is the root mean square of prediction minus record, over the
    size of the record, and the relative noise to 10 %.
    """
    noisy = noisy_fit.measured[0]
    prediction = noisy_fit.predicted[0]
    difference = prediction.values - noisy.signal.values
    rms = math.sqrt(np.mean(difference**2))
    misfit = noisy_fit.misfits[0]  # over the size of the record
    absolute_misfit = misfit * noisy.size
    assert absolute_misfit == pytest.approx(rms, rel=1e-9)
    assert misfit == pytest.approx(RELATIVE_NOISE, rel=0.1)


def test_all_searches_end_at_the_same_point(noisy_fit):
    """The three descents of a fit end at the same length to 1e-6."""
    assert len(noisy_fit.descents) == 3
    best = noisy_fit.values[LENGTH]
    for end in noisy_fit.descents:
        length = end.values[LENGTH]
        assert length == pytest.approx(best, rel=1e-6)


@pytest.mark.exhaustive
def test_records_have_shifts_of_their_own():
    """Two records of one run, late by 1 us and by 2 us, are fitted together; both
    shifts are found.
    """
    solution = ri.solve(rods(), until=UNTIL)
    places = [(1, 0.2), (1, 0.4)]
    shifts = [1e-6, 2e-6]  # s
    records = []
    for place, shift in zip(places, shifts, strict=True):
        signal = solution.gauge(*place).signal(INTERVAL)
        late = signal.shifted(shift)
        records.append(ri.Measured(late, place, gain=1.0))

    best = fitted(records, VARY_LENGTH)

    for i, true_shift in enumerate(shifts):
        shift = best.values[f"records.{i}.shift"]
        assert shift == pytest.approx(true_shift, abs=1e-9)


@pytest.mark.exhaustive
def test_searches_in_threads_find_the_same_numbers():
    """A fit with two starts gives the same values in one thread and in two."""
    noiseless = measured(record(rods()))
    arguments = (rods(), noiseless, VARY_LENGTH, UNTIL)

    alone = ri.fit(*arguments, starts=2)
    with ThreadPoolExecutor(2) as pool:
        in_threads = ri.fit(*arguments, starts=2, executor=pool)
    assert alone.values == in_threads.values


class Shot(NamedTuple):
    """Records of one pulse by two gauges of one amplifier, with and without noise."""

    records: list[ri.Measured]
    clean: list[ri.Signal]


SHOT_GAIN = 1.5
SHOT_SHIFT = 4e-6  # s
SHOT_BLUR = 3e-6  # s
SHOT_NOISE = 2e-5  # standard deviation, strain times gain


@pytest.fixture(scope="module")
def shot():
    """A `Shot` of the striker, with gain, shift, blur and noise of `SHOT_...`."""
    solution = ri.solve(rods(), until=UNTIL)
    random = default_rng(3)
    shot = Shot([], [])
    for gauge in ((1, 0.2), (1, 0.4)):
        sharp = solution.gauge(*gauge).signal(INTERVAL)
        strain = sharp.low_pass(CUTOFF_TIMES_BLUR / SHOT_BLUR)
        signal = strain.shifted(SHOT_SHIFT) * SHOT_GAIN
        white = random.standard_normal(len(signal))
        values = signal.values + SHOT_NOISE * white
        noisy = signal.replace(values=values)
        shot.records.append(ri.Measured(noisy, gauge))
        shot.clean.append(signal)
    return shot


@pytest.fixture(scope="module")
def tied_fit(shot):
    """Fit of the length of the striker, and of one gain, one shift and one blur for
    both records of a shot.
    """
    vary = {
        LENGTH: (0.1, 0.4),
        "records.*.gain": None,
        "records.*.shift": (-1e-5, 1e-5),
        "records.[01].blur": (0.0, 1e-5),
    }
    return fitted(shot.records, vary)


@pytest.mark.exhaustive
def test_records_share_the_numbers_that_are_tied(tied_fit):
    """Gain, shift and blur, each one for both records, are found within 2 % and four
    standard errors.
    """
    true_values = {
        LENGTH: 0.2,
        "records.*.gain": SHOT_GAIN,
        "records.*.shift": SHOT_SHIFT,
        "records.[01].blur": SHOT_BLUR,
    }
    assert tied_fit.values.keys() == true_values.keys()
    for name, true_value in true_values.items():
        value = tied_fit.values[name]
        assert value == pytest.approx(true_value, rel=2e-2), name
        error = abs(value - true_value)
        assert error < 4 * tied_fit.standard_errors[name], name


def test_shift_and_gain_are_known_nearly_as_well_as_each_alone(shot, tied_fit):
    """The standard errors of shift and gain in one fit of both are at least those of a
    fit of one number alone, and less than 1.5 times as large.
    """
    # The error of one number alone is sigma over the norm of the derivative by it.
    gain_derivatives_squared = 0.0
    shift_derivatives_squared = 0.0
    for signal in shot.clean:
        gain_derivative = signal.values / SHOT_GAIN
        shift_derivative = np.gradient(signal.values, INTERVAL)
        gain_derivatives_squared += float(gain_derivative @ gain_derivative)
        shift_derivatives_squared += float(shift_derivative @ shift_derivative)
    gain_error_alone = SHOT_NOISE / gain_derivatives_squared**0.5
    shift_error_alone = SHOT_NOISE / shift_derivatives_squared**0.5
    gain_error = tied_fit.standard_errors["records.*.gain"]
    shift_error = tied_fit.standard_errors["records.*.shift"]
    assert 1 <= gain_error / gain_error_alone < 1.5
    assert 1 <= shift_error / shift_error_alone < 1.5


@pytest.mark.exhaustive
def test_a_gain_of_one_record_is_known_less_well_than_a_common_one(shot, tied_fit):
    """The standard error of one gain for both records is below that of a gain for each."""
    vary = VARY_LENGTH | {"records.*.blur": (0.0, 1e-5)}
    separate = fitted(shot.records, vary)
    separate_numbers = {"records.0.shift", "records.1.shift", "records.1.gain"}
    assert separate_numbers < separate.values.keys()
    common_error = tied_fit.standard_errors["records.*.gain"]
    separate_error = separate.standard_errors["records.0.gain"]
    assert common_error < separate_error


# Additions ----------------------------------------------------------------------------

OFFSET_AND_TREND = {"records.0.offset": None, "records.0.trend": (-10.0, 10.0)}
ADDITIONS = {
    "offset and trend": OFFSET_AND_TREND,
    "blur": {"records.0.blur": (0.0, 1e-5)},
    "diameter": {"bodies.0.area": (5e-5, 2e-4)},
}
OFFSET = 8e-5  # strain, less than a tenth of the pulse
TREND = 0.5  # 1/s, strain over time


def changed_record(offset=0.0, trend=0.0, blur=0.0, area=1e-4):
    """A noisy record with an offset, a trend, a blur, or a striker of another area.

    The blur, s, is that of a low-pass filter; 0 is none. The trend, per second, is 0 in
    the middle of the record.
    """
    _, bar = rods().bodies
    striker = ri.Rod(0.2, area=area, material=STEEL, velocity=10.0)
    system = ri.System([striker, bar])
    signal = record(system, noise=1e-5)
    if blur:
        signal = signal.low_pass(CUTOFF_TIMES_BLUR / blur)
    middle = (signal.start + signal.end) / 2
    time_from_middle = signal.times - middle
    drift = offset + trend * time_from_middle
    values = signal.values + drift
    return measured(signal.replace(values=values))


@pytest.mark.exhaustive
def test_offset_and_trend_are_found_and_misfit_as_little_as_known_ones():
    """Offset and trend of a drifting record are found to a tenth and to four standard
    errors, with the velocity; the misfit is that of a fit to which both are known.
    """
    drifting = changed_record(OFFSET, TREND)
    known_drift = drifting.replace(offset=OFFSET, trend=TREND)
    vary = VARY_VELOCITY | OFFSET_AND_TREND

    found = fitted(drifting, vary)
    known = fitted(known_drift, VARY_VELOCITY)

    velocity = found.values[VELOCITY]
    assert velocity == pytest.approx(10.0, rel=2e-3)
    true_values = {"records.0.offset": OFFSET, "records.0.trend": TREND}
    for name, true_value in true_values.items():
        error = abs(found.values[name] - true_value)
        assert error < 4 * found.standard_errors[name]
        assert error < 0.1 * true_value
    misfit = found.misfits[0]
    assert known.misfits[0] == pytest.approx(misfit, rel=0.01)


class FitWithAdditions(NamedTuple):
    """A fit with `ADDITIONS`, and the addition that its record needs, or None."""

    needed: str | None
    fit: ri.Fit


@pytest.fixture(
    scope="module",
    params=[
        (None, {}),
        pytest.param(
            ("offset and trend", {"offset": OFFSET, "trend": TREND}),
            marks=pytest.mark.exhaustive,
        ),
        pytest.param(("blur", {"blur": 2e-6}), marks=pytest.mark.exhaustive),
        ("diameter", {"area": 1.1e-4}),
    ],
    ids=lambda param: param[0] or "nothing",
)
def with_additions(request):
    """`FitWithAdditions` of a record that was changed in one way, or in none."""
    needed, change = request.param
    noisy = changed_record(**change)
    fit = fitted(noisy, VARY_VELOCITY, additions=ADDITIONS)
    return FitWithAdditions(needed, fit)


@pytest.mark.exhaustive
def test_the_addition_that_a_record_needs_earns_its_place_and_predicts_best(
    with_additions,
):
    """The addition that a changed record needs earns its place and has the least misfit
    of blocks left out. For an unchanged record no addition earns its place.
    """
    additions = with_additions.fit.additions
    earning = [each.name for each in additions if each.earns_its_place]
    best = min(additions, key=lambda each: each.fit.misfit_left_out)
    if with_additions.needed is None:
        assert earning == []
    else:
        assert with_additions.needed in earning
        assert best.name == with_additions.needed


def test_a_fit_with_more_numbers_fits_no_worse(with_additions):
    without_addition = with_additions.fit.descents[0].misfit
    for addition in with_additions.fit.additions:
        misfit = addition.fit.descents[0].misfit
        assert misfit < 1.0001 * without_addition  # searches do not end exactly


def test_the_last_column_of_a_table_tells_which_additions_earn_their_place(
    with_additions,
):
    """The table of additions of a fit has a line "none" and one for each addition,
    which ends with "yes" exactly if this one earns its place; the printed fit has this
    table.
    """
    fit = with_additions.fit
    _, without_addition, *lines = fit.table_of_additions.splitlines()
    assert without_addition.startswith("none")
    for line, addition in zip(lines, fit.additions, strict=True):
        assert line.endswith("yes") == addition.earns_its_place
    assert fit.table_of_additions in str(fit)
    assert "earns its place" in str(fit)


def test_blocks_left_out_are_predicted_as_by_a_fit_of_the_others():
    """In a linear model with random data, `predicted_residuals` of every second block
    of 6 samples are those of a new fit to the other blocks.
    """
    random = default_rng(5)
    J = random.standard_normal((60, 3))  # [sample, number]
    values = random.standard_normal(60)
    block = np.arange(60) // 6  # number of the block of 6 samples
    is_left_out = block % 2 == 1
    is_kept = ~is_left_out
    best, *_ = np.linalg.lstsq(J, values, rcond=None)
    best_of_rest, *_ = np.linalg.lstsq(J[is_kept], values[is_kept], rcond=None)
    residuals = J @ best - values

    predicted = predicted_residuals(J, residuals, is_left_out)

    residuals_of_rest = J @ best_of_rest - values
    expected = residuals_of_rest[is_left_out]
    assert predicted == pytest.approx(expected)


@pytest.mark.parametrize(
    ("additions", "says"),
    [
        ([1.0], "additions: must be such as"),
        ({"blur": None}, "additions.blur: must name numbers"),
        ({"speed": VARY_VELOCITY}, "which already varies"),
    ],
)
def test_mistakes_in_additions_are_named(additions, says):
    noisy = changed_record()
    with pytest.raises(ri.InvalidModel, match=says):
        fitted(noisy, VARY_VELOCITY, additions=additions)


@pytest.mark.exhaustive
def test_searches_on_a_grid_begin_with_half_of_its_cells(monkeypatch):
    """More than two thirds of all runs have half of the cells; the velocity is found."""
    cells_of_runs = []

    def counted(system, options, places, interval):
        cells_of_runs.append(options.cells)
        return compute_strains(system, options, places, interval)

    monkeypatch.setattr(objective_module, "compute_strains", counted)
    cells = 240
    noisy = changed_record()

    found = fitted(noisy, VARY_VELOCITY, method="finite-difference", cells=cells)

    coarse_runs = cells_of_runs.count(cells // 2)
    fine_runs = cells_of_runs.count(cells)
    velocity = found.values[VELOCITY]
    assert velocity == pytest.approx(10.0, rel=5e-3)
    assert coarse_runs + fine_runs == len(cells_of_runs)
    assert coarse_runs > 2 * fine_runs
    assert fine_runs > 0


# Standard errors ----------------------------------------------------------------------


def objective_of(measured_record, vary):
    """The `Objective` of a fit of `vary` to one record, by fronts."""
    return Objective(
        system=rods(),
        measured=[measured_record],
        parameters=system_parameters(rods(), vary),
        record_parameters=record_parameters(rods(), [measured_record], {}, UNTIL),
        options=Options(UNTIL, "fronts"),
        interval=INTERVAL,
        executor=None,
    )


def derivatives_of(objective, point):
    """Central differences [sample, number] of the residuals by each number of a point.

    The point holds the shares of length and velocity, shift, gain, blur, offset, trend.
    """
    # Small beside the range of each of these numbers
    steps = [1e-5, 1e-5, 1e-10, 1e-5, 1e-9, 1e-5, 1.0]
    columns = []
    for k, step in enumerate(steps):
        higher = point.copy()
        lower = point.copy()
        higher[k] += step
        lower[k] -= step
        residuals_above = objective.residuals(higher)
        residuals_below = objective.residuals(lower)
        change = residuals_above - residuals_below
        columns.append(change / (2 * step))
    return np.stack(columns, axis=1)


def coloured(random, n, steps):
    """n samples of noise of variance 1, whose correlation falls to 1/e within `steps`
    samples.
    """
    correlation = 0.0  # of neighbouring samples
    if steps > 0:
        correlation = math.exp(-1 / steps)
    noise = [random.standard_normal()]
    white_part = math.sqrt(1 - correlation**2)
    white_noise = white_part * random.standard_normal(n - 1)
    for white in white_noise:
        correlated_part = correlation * noise[-1]  # of the sample before
        noise.append(correlated_part + white)
    return np.array(noise)


def assert_errors_are_the_scatter(errors, values):
    """Standard errors of many fits agree with the standard deviation of their values.

    Both are [fit, number].
    """
    mean_error = np.mean(errors, axis=0)
    scatter = np.std(values, axis=0)
    ratio = mean_error / scatter
    # The scatter of 50 fits is itself known to a tenth, 1/sqrt(2 * 50).
    assert ratio.min() > 0.8, ratio
    assert ratio.max() < 1.3, ratio


@pytest.mark.exhaustive
@pytest.mark.parametrize("correlation_time", [0.0, 5e-6])
def test_standard_errors_are_the_scatter_of_fits(correlation_time):
    """Length, velocity, shift and blur of 200 noisy records scatter by their stated
    errors. Instead of fits, values are changed by the pseudo-inverse of the derivatives
    times the noise, as fits are linear in small noise.
    """
    signal = record(rods())
    noiseless = ri.Measured(signal, GAUGE, gain=1.0, blur=(0.0, 1e-5))
    vary = VARY_LENGTH | VARY_VELOCITY
    objective = objective_of(noiseless, vary)
    length_share = 1 / 3  # 0.2 m in 0.1 to 0.4
    velocity_share = 9 / 19  # 10 m/s in 1 to 20
    blur = 2e-6  # s
    shift = 0.0
    gain = 1.0
    offset = 0.0
    trend = 0.0
    shares = [length_share, velocity_share]
    point = np.array([*shares, shift, gain, blur, offset, trend])
    derivatives = derivatives_of(objective, point)
    J = derivatives[:, objective.is_free]
    # Shift and blur are varied as shares of their ranges, UNTIL and 1e-5 s.
    J *= [1.0, 1.0, UNTIL, 1e-5]
    pseudo_inverse = np.linalg.pinv(J)
    random = default_rng(2)

    values = []
    errors = []
    for _ in range(200):
        correlation_steps = correlation_time / INTERVAL
        noise = 0.02 * coloured(random, len(J), correlation_steps)
        value = pseudo_inverse @ noise
        residuals = J @ value - noise
        values.append(value)
        covariances = covariance(J, residuals, [len(J)])
        errors.append(np.sqrt(np.diag(covariances)))

    assert_errors_are_the_scatter(errors, values)


@pytest.mark.exhaustive
def test_all_searches_for_a_measured_pulse_end_at_one_point():
    """Three searches for the pulse of a titanium bar end within 1 % of a standard
    error.
    """
    pulses = validation_module("measured_pulses")
    vary = {**pulses.STIFFNESS_BOUNDS, pulses.SPEED: (4200.0, 5400.0)}
    best = pulses.fitted(pulses.TITANIUM, vary, starts=3)
    for end in best.descents:
        for name, value in end.values.items():
            difference = abs(value - best.values[name])
            assert difference < 0.01 * best.standard_errors[name]
    assert best.misfits[0] < 0.02


def clean_pulse(solution, place, distance, bar):
    """Strain at a distance behind `place`, a body and a place on it, without noise.

    The exact mode carries it there; the measuring chain blurs it by 2 us. It is
    computed with a quarter of the interval at which it is kept.
    """
    sharp = solution.gauge(*place).signal(PULSE_INTERVAL / 4)
    longer = sharp.extended(1e-4, 1e-4)
    pulse = longer.propagated(distance, bar)
    blurred = pulse.low_pass(CUTOFF_TIMES_BLUR / 2e-6)
    times = np.arange(5e-5, 2e-4, PULSE_INTERVAL)
    return blurred.resampled(times=times)


@pytest.mark.exhaustive
def test_standard_errors_are_the_scatter_of_fits_of_noisy_pulses():
    """50 fits of a computed pulse of a titanium bar, each with other coloured noise,
    scatter by their stated errors.
    """
    until = 2.5e-4
    correlation_time = 5e-6  # s; white noise is tested above
    pulses = validation_module("measured_pulses")
    shot = pulses.TITANIUM
    start = 0.02  # m, from the struck end to where the exact mode begins
    distance = shot.to_gauge - start
    system = pulses.row_of(
        shot, shot.bar.wave_speed, law=ri.Hertz(6e10), theory=None, until=until
    )
    solution = ri.solve(system, until=until)
    clean = clean_pulse(solution, (1, start), distance, shot.bar)
    noise_level = 0.02 * np.abs(clean.values).max()
    vary = {
        pulses.LENGTH: shot.length_bounds,
        **pulses.STIFFNESS_BOUNDS,
        **pulses.BLUR_BOUNDS,
    }
    random = default_rng(4)

    values_of_fits = []
    errors = []
    for _ in range(50):
        noise = coloured(random, len(clean), correlation_time / PULSE_INTERVAL)
        values = clean.values + noise_level * noise
        noisy = clean.replace(values=values)
        at_gauge = ri.Measured(
            noisy, (1, start), distance=distance, radius=shot.bar.radius
        )
        best = ri.fit(system, at_gauge, vary, until, starts=1)
        best_values = best.values.values()
        standard_errors = best.standard_errors.values()
        values_of_fits.append(list(best_values))
        errors.append(list(standard_errors))

    assert_errors_are_the_scatter(errors, values_of_fits)


@pytest.mark.exhaustive
@pytest.mark.parametrize("repetitions", [1, 10])
def test_the_standard_error_of_a_mean(repetitions):
    """A mean of n samples, of which r = `repetitions` in a row are equal, has by
    `covariance` the variance sigma^2 r/n, to 20 %, on average over 150 records.
    """
    random = default_rng(1)
    n = 1200
    J = np.ones((n, 1))
    variances = []
    for _ in range(150):
        independent = random.standard_normal(n // repetitions)
        noise = np.repeat(independent, repetitions)
        residuals = noise - noise.mean()
        covariances = covariance(J, residuals, [n // 2, n // 2])
        variances.append(covariances[0, 0])
    expected = repetitions / n
    assert 0.8 < np.mean(variances) / expected < 1.2


# Shifts, blurs and other laws ---------------------------------------------------------


@pytest.mark.exhaustive
def test_another_law_tells_by_how_much_numbers_change():
    """`against` adds notes on the change of a number from a rigid contact to a spring."""
    noisy = measured(record(rods(), 1e-5))
    rigid = fitted(noisy, VARY_LENGTH)
    with_spring = rods_with_law(ri.Spring(3e8))
    soft = fitted(noisy, VARY_LENGTH, guess=with_spring)

    both = rigid.against(soft)

    change = soft.values[LENGTH] - rigid.values[LENGTH]
    change_text = format_si(change, "m", 3)
    sentence = f"With the other law or theory {LENGTH} changes by {change_text}"
    assert abs(change) > 5 * rigid.standard_errors[LENGTH]
    # `against` adds two notes; all else is that of the first fit.
    *first_notes, change_note, _ = both.notes
    assert change_note.startswith(sentence)
    assert tuple(first_notes) == tuple(rigid.notes)
    assert both.fitted == rigid.fitted
    assert sentence in str(both)


@pytest.mark.exhaustive
def test_fits_of_other_numbers_cannot_be_compared():
    """`against` refuses a fit of the velocity beside one of the length."""
    noisy = measured(record(rods(), 1e-5))
    of_length = fitted(noisy, VARY_LENGTH)
    of_velocity = fitted(noisy, VARY_VELOCITY)
    with pytest.raises(ri.InvalidModel, match="other: has no number in common"):
        of_length.against(of_velocity)


@pytest.mark.exhaustive
@pytest.mark.parametrize("seed", few_of(range(20), [0]))
def test_a_shift_is_found_wherever_a_window_of_a_record_lies_or_bounds_are_noted(seed):
    """Random steps of strain run along a bar and back; its length is varied as well.

    The record is a window of the strain, with a random shift and 2.5 times as large.
    """
    random = default_rng(seed)
    until = 4e-4
    place = (0, 0.2)
    gain = 2.5
    values = random.uniform(-1e-3, 1e-3, 30).tolist()
    intervals = random.uniform(5e-6, 2e-5, 29)
    times = np.cumsum(intervals).tolist()
    wave = ri.Steps(values, at=times)
    ends = (ri.Incoming(wave), ri.Free())
    bar = ri.Rod(0.5, area=1e-4, material=STEEL)
    driven = ri.System([bar], ends=ends)
    solution = ri.solve(driven, until=until)
    whole = solution.gauge(*place).signal(INTERVAL)
    start = random.uniform(5e-5, 3.2e-4)
    delay = random.uniform(-4e-4, 4e-4)
    part = whole.window(start, start + 7e-5)
    window = part.shifted(delay) * gain
    vary = {LENGTH: (0.45, 0.55)}
    too_early = (delay - 1e-4, delay - 1e-6)  # bounds without the true shift
    free_record = ri.Measured(window, place)
    bounded_record = ri.Measured(window, place, shift=too_early)

    free = ri.fit(driven, free_record, vary, until, starts=1)
    bounded = ri.fit(driven, bounded_record, vary, until, starts=1)

    shift = free.values["records.0.shift"]
    assert shift == pytest.approx(delay, abs=1e-8)
    gain_found = free.values["records.0.gain"]
    assert gain_found == pytest.approx(gain, rel=1e-4)
    assert "at its bound" not in " ".join(free.notes)
    is_noted = "records.0.shift is at its bound" in " ".join(bounded.notes)
    bounded_shift = bounded.values["records.0.shift"]
    assert bounded_shift <= delay - 1e-6
    # If the shift ends between its bounds, a large misfit tells that it is wrong.
    assert is_noted or bounded.misfits[0] > 0.05


def rounded_rods(random):
    """Rods with rounded ends; length of the striker and stiffness are random."""
    length = float(random.uniform(0.1, 0.3))
    stiffness = float(10 ** random.uniform(9, 12))
    return rods(length, contacts=[ri.Hertz(stiffness)])


@pytest.mark.exhaustive
@pytest.mark.parametrize("seed", [2, 5, 9, 12, 16, 19])
def test_a_fit_with_a_blur_ends_no_worse_than_one_without(seed):
    """A noisy window of the strain of random rounded rods is fitted with and without a
    blur, with one start each: the misfit with the blur is not larger, as once it was.
    """
    random = default_rng(seed)
    true_system = rounded_rods(random)
    until = float(random.uniform(1.2e-4, 3.5e-4))
    solution = ri.solve(true_system, until=until)
    strain = solution.gauge(*GAUGE).signal(1e-6)
    start = float(random.uniform(0, 0.3)) * until
    duration = float(random.uniform(0.3, 0.65)) * until
    window = strain.window(start, start + duration)
    peak = float(np.abs(window.values).max())
    noise = 0.01 * peak * random.standard_normal(len(window))
    noisy_window = window.replace(values=window.values + noise)
    noisy = ri.Measured(noisy_window, GAUGE)
    guess = rounded_rods(random)
    numbers = {LENGTH: (0.08, 0.35), "contacts.0.stiffness": (1e7, 1e13)}
    blur = {"records.0.blur": (0.0, 1e-5)}

    without_blur = ri.fit(guess, noisy, numbers, until, starts=1)
    with_blur = ri.fit(guess, noisy, numbers | blur, until, starts=1)

    misfit = with_blur.misfits[0]
    misfit_without_blur = without_blur.misfits[0]
    assert misfit <= misfit_without_blur * (1 + 1e-6)


# Notes --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("how", "vary", "until", "sentences"),
    [
        # The amplitude is velocity times gain.
        (
            {"gain": (0.1, 10.0)},
            {VELOCITY: (1.0, 100.0)},
            UNTIL,
            ("not determined", "hardly distinguishable"),
        ),
        ({}, {LENGTH: (0.1, 0.15)}, UNTIL, (f"{LENGTH} is at its bound, 150 mm",)),
        # No wave from the far end of the bar reaches the gauge in time.
        (
            {},
            {"bodies.1.length": (0.58, 0.6)},
            1e-4,
            ("bodies.1.length is not determined",),
        ),
    ],
)
def test_numbers_that_are_not_determined_are_named(how, vary, until, sentences):
    """The notes of a fit hold one of these sentences; `how` are arguments of the
    record.
    """
    noisy = measured(record(rods(), 1e-5), **how)
    best = ri.fit(rods(), noisy, vary, until, starts=1)
    notes = " ".join(best.notes)
    assert any(sentence in notes for sentence in sentences)


INDEPENDENT = np.diag([1e-4, 1e-4])


def notes_of(*ends, relative_covariance=INDEPENDENT):
    """Notes on two numbers, a and b, after searches with these ends.

    The covariance is that of their errors over their values.
    """
    a = ri.Fitted("a", "m", value=1.0, standard_error=0.01, low=0.0, high=2.0)
    b = a._replace(name="b")
    return notes_on_numbers([a, b], relative_covariance, ends)


def test_searches_that_end_elsewhere_are_noted():
    """Two notes: on other values with the same misfit, and on larger misfits."""
    best = ri.Descent(0.02, {"a": 1.0, "b": 1.0}, complete=True)
    equal_misfit = best._replace(values={"a": 1.5, "b": 1.0})
    larger_misfit = equal_misfit._replace(misfit=0.04)

    (note_on_values,) = notes_of(best, equal_misfit)
    (note_on_misfits,) = notes_of(best, larger_misfit)

    assert note_on_values == (
        "Searches with the same misfit ended at different values of a: 1 m to 1.5 m."
    )
    assert "1 of 2 searches ended at larger misfits, 4 % and more" in note_on_misfits


def test_numbers_with_correlated_errors_are_noted():
    """A fit of a and b gets one note if the correlation of their errors is 0.99."""
    best = ri.Descent(0.02, {"a": 1.0, "b": 1.0}, complete=True)
    correlated = np.array([[1e-4, 0.99e-4], [0.99e-4, 1e-4]])
    (note,) = notes_of(best, relative_covariance=correlated)
    assert "a and b are hardly distinguishable" in note
    assert "the correlation of their errors is 0.990" in note


@pytest.mark.parametrize(
    ("number", "beginning"),
    [
        # 3e13 lies in the middle of 1e7 to 1e19: bounds this far apart are a ratio.
        (ri.Fitted("k", "N/m", 3e13, 1e12, 1e7, 1e19), None),
        (ri.Fitted("k", "N/m", 1.01e7, 1e12, 1e7, 1e19), "k is at its bound, 10 MN/m"),
        (ri.Fitted("k", "N/m", 9.9e18, 1e12, 1e7, 1e19), "k is at its bound"),
        (ri.Fitted("x", "m", 0.1005, 1e-5, 0.1, 0.9), "x is at its bound, 100 mm"),
    ],
)
def test_a_bound_is_as_near_as_the_scale_of_its_range_says(number, beginning):
    """Near its bound a number is noted, on a logarithmic scale if the bounds are far
    apart. `beginning` is that of the note; None if there is no note.
    """
    end = ri.Descent(0.02, {number.name: number.value}, complete=True)
    covariance_matrix = np.array([[1e-4]])
    notes = notes_on_numbers([number], covariance_matrix, [end])
    if beginning is None:
        assert notes == []
    else:
        (note,) = notes
        assert note.startswith(beginning)


@pytest.mark.exhaustive
def test_a_misfit_far_above_the_noise_before_the_pulse_is_noted():
    """Flat ends do not make the record of rounded ends."""
    relative_noise = 0.002
    rounded = rods_with_law(ri.Hertz(1e10))
    clean = record(rounded)
    peak = float(np.abs(clean.values).max())
    noisy = measured(record(rounded, relative_noise * peak))

    flat = fitted(noisy, VARY_LENGTH)
    right = fitted(noisy, VARY_LENGTH, guess=rounded)

    noise = noise_before_pulse(noisy, flat.predicted[0])
    (note,) = [note for note in flat.notes if "noise before the pulse" in note]
    assert noise == pytest.approx(relative_noise, rel=0.3)
    assert flat.misfits[0] > 0.03
    assert note.startswith("gauge: the misfit, ")
    assert f"{100 * noise:.2g} %" in note
    assert "noise before the pulse" not in " ".join(right.notes)


# Paths, tables and mistakes -----------------------------------------------------------


def test_paths_name_numbers_of_materials_and_contacts_which_values_replace():
    """Parameters for numbers of a material and of a contact have their units and first
    values; `with_values` puts other values in their place.
    """
    titanium = ri.Material("titanium", youngs_modulus=100e9, density=4400)
    hertz = ri.Hertz(1e10)
    system = rods(material=titanium, contacts=[hertz], gaps=[1e-3])
    vary = {
        "materials.titanium.wave_speed": (4000, 6000),
        "materials.titanium.density": (4e3, 5e3),
        "contacts.0.stiffness": (1e8, 1e12),
        "contacts.0.gap": (0.0, 1e-2),
    }
    stiffness_of_alloy = 4500 * 5000.0**2  # density times wave speed squared, Pa
    alloy = ri.Material("titanium", youngs_modulus=stiffness_of_alloy, density=4500)
    stiffer = ri.Hertz(1e11)
    values = [5000.0, 4500.0, 1e11, 2e-3]

    parameters = system_parameters(system, vary)
    changed = with_values(system, parameters, values)

    units = [parameter.unit for parameter in parameters]
    assert units == ["m/s", "kg/m^3", "N/m^1.5", "m"]
    wave_speed = parameters[0]
    assert wave_speed.initial == titanium.wave_speed
    assert changed == rods(material=alloy, contacts=[stiffer], gaps=[2e-3])


def test_a_share_of_the_range_of_a_number_leads_back_to_its_value():
    """`Parameter.value` undoes `Parameter.share`, for a length and a stiffness. Half the
    range of the length is the mean of its bounds, that of the stiffness, whose bounds
    differ by 10^4, their geometric mean.
    """
    vary = {LENGTH: (0.1, 0.4), "contacts.0.stiffness": (1e8, 1e12)}
    system = rods_with_law(ri.Hertz(1e10))
    length, stiffness = system_parameters(system, vary)
    for parameter in (length, stiffness):
        value = 0.7 * parameter.low + 0.3 * parameter.high
        share = parameter.share(value)
        assert parameter.value(share) == pytest.approx(value)
    middle_of_length = length.value(0.5)
    assert middle_of_length == pytest.approx((0.1 + 0.4) / 2)
    middle_of_stiffness = stiffness.value(0.5)
    assert middle_of_stiffness == pytest.approx(math.sqrt(1e8 * 1e12))


def test_a_path_may_lead_into_a_profile():
    """A path replaces the second value of steps of velocity."""
    velocity = ri.Steps([1.0, 2.0], at=[0.1])
    system = rods(velocity=velocity)
    second_value = {"bodies.0.velocity.values.1": (0, 9)}
    parameters = system_parameters(system, second_value)
    changed = with_values(system, parameters, [3.0])
    changed_velocity = ri.Steps([1.0, 3.0], at=[0.1])
    assert changed == rods(velocity=changed_velocity)


@pytest.fixture(scope="module")
def length_fit():
    """A fit of the length of a striker to a record with little noise."""
    noisy = measured(record(rods(), 1e-5))
    return fitted(noisy, VARY_LENGTH)


def test_a_result_prints_what_errors_are_not_and_has_one_picture(length_fit):
    assert "do not include model error" in str(length_fit)
    assert length_fit._repr_html_().count("<img") == 1


def test_a_figure_of_a_result_has_its_misfit_and_moves_nothing(length_fit):
    """The figure of a fit has its misfit, with shift 0 and scale 1: the prediction is
    not fitted again.
    """
    misfit = ri.plot.fit(length_fit).misfit

    expected = length_fit.misfits[0]
    assert misfit.rms == pytest.approx(expected, rel=1e-9)
    assert misfit.shift == 0
    assert misfit.scale == 1


def test_a_figure_of_a_record_that_there_is_not_is_refused(length_fit):
    message = "record: must be a whole number from 0 to 0, got 1"
    with pytest.raises(ValueError, match=message):
        ri.plot.fit(length_fit, record=1)


def test_a_result_is_written_as_a_table_once(length_fit, tmp_path):
    """A second call does not overwrite the file."""
    path = tmp_path / "fit.csv"
    length_fit.to_csv(path)
    lines = path.read_text().splitlines()
    (row,) = csv.DictReader(lines)
    assert row == {
        "number": LENGTH,
        "unit": "m",
        "value": repr(length_fit.values[LENGTH]),
        "standard error": repr(length_fit.standard_errors[LENGTH]),
        "low": "0.1",
        "high": "0.4",
    }
    assert float(row["standard error"]) > 0
    with pytest.raises(FileExistsError):
        length_fit.to_csv(path)


FLAT = ri.Signal([0.0, 1.0, 1.0, 0.0], dt=1e-5, name="flat")
STRAINS = ri.Measured(FLAT, GAUGE)
IN_VOLTS = FLAT.replace(unit="V")
VOLTS = ri.Measured(IN_VOLTS, GAUGE)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"vary": {}}, "vary: must name numbers with their bounds"),
        (
            {"vary": {"bodies.0.lenght": (0.1, 0.2)}},
            "perhaps 'bodies.0.length' is meant",
        ),
        (
            {"vary": {LENGTH: (0.2, 0.1)}},
            r"vary.bodies.0.length: must be \(low, high\)",
        ),
        ({"vary": {LENGTH: 0.1}}, r"vary.bodies.0.length: must be \(low, high\)"),
        (
            {"vary": {LENGTH: ("a", 1)}},
            "vary.bodies.0.length: must be a number of metres",
        ),
        (
            {
                "vary": {
                    "materials.steel.wave_speed": (4e3, 6e3),
                    "bodies.1.material.youngs_modulus": (1e11, 3e11),
                }
            },
            "already varied as materials",
        ),
        (
            {"vary": {"bodies.0.area": (-1e-4, -1e-5)}},
            "the bounds allow an invalid system",
        ),
        (
            {"vary": {"materials.steel.wave_speed": (-5e3, -4e3)}},
            "allow an invalid system",
        ),
        (
            {"vary": {"bodies.1.length": (0.05, 0.6)}},
            "the bounds put a gauge outside its rod",
        ),
        (
            {"vary": {"records.0.shfit": (0, 1)}},
            "vary.records.0.shfit: is not one number of records",
        ),
        (
            {"vary": {"records.*.*": (0, 1)}},
            "is not one number of records, in one unit; give a name",
        ),
        (
            {"vary": {"records.0.blur": None}},
            "vary.records.0.blur: must be a number of seconds",
        ),
        (
            {"vary": {"records.*.gain": None, "records.0.gain": None}},
            "names records.0.gain, which",
        ),
        (
            {"vary": {"records.*.gain": None}, "measured": [STRAINS, VOLTS]},
            "is not one number of records",
        ),
        ({"measured": FLAT}, "measured: must be a Measured"),
        ({"measured": []}, "measured: must be a Measured"),
        ({"measured": ri.Measured(FLAT, (1, 2.0))}, "gauges.0.x: must lie in body 1"),
        ({"measured": ri.Measured(FLAT, (3, 0.2))}, "gauges.0.body: must be a rod"),
        ({"until": None}, "until: is missing"),
        ({"until": -1.0}, "until: must be"),
        ({"starts": 0}, "starts: must be a positive whole number"),
        ({"interval": 0.0}, "interval: must be a finite positive number of seconds"),
        ({"system": rods(velocity=np.array([1.0, 2.0]))}, "system: must be one system"),
        ({"system": 3}, "system: must be a System"),
    ],
)
def test_mistakes_are_named(change, sentence):
    """One argument of `fit` is replaced by a wrong one: InvalidModel has a fitting
    sentence.
    """
    arguments = {
        "system": rods(),
        "measured": STRAINS,
        "vary": {LENGTH: (0.1, 0.2)},
        "until": UNTIL,
    }
    arguments |= change
    with pytest.raises(ri.InvalidModel, match=sentence):
        ri.fit(**arguments)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"signal": [1, 2]}, "signal: must be a Signal"),
        ({"gauge": 1}, r"gauge: must be \(body, x\)"),
        ({"distance": math.inf}, "distance.*finite"),
        ({"shift": (1.0, 0.0)}, r"shift: must be a number, or \(low, high\)"),
        ({"gain": "x"}, "gain: must be a number"),
        ({"blur": (-1e-6, 1e-6)}, "blur: must be 0 s or more"),
        ({"level": -1.0}, "level.*positive"),
        ({"seen": 3}, "seen: must be a function"),
        ({"signal": 0 * FLAT}, "there is no pulse"),
    ],
)
def test_mistakes_of_records_are_named(change, sentence):
    arguments = {"signal": FLAT, "gauge": GAUGE}
    arguments |= change
    with pytest.raises(ValueError, match=sentence):
        ri.Measured(**arguments)
