"""Fits find the system that made a record, and say how well they know it."""

import csv
import math
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
import pytest
from exhaustive import few_of
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
UNTIL = 1.5e-4
INTERVAL = 5e-7
GAUGE = (1, 0.2)  # body, m from its left end
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
    """Strain at the gauge, with white noise of this standard deviation."""
    gauge = ri.solve(system, until=UNTIL).gauge(*GAUGE)
    signal = gauge.signal(INTERVAL, name="gauge")
    white = np.random.default_rng(7).standard_normal(len(signal))
    return signal.replace(values=signal.values + noise * white)


def measured(signal, shift=0.0, gain=1.0):
    """A record at the gauge; shift and gain are known, or (low, high)."""
    return ri.Measured(signal, GAUGE, shift=shift, gain=gain)


# Best values --------------------------------------------------------------------------


@pytest.fixture(scope="module")
def noisy_fit():
    """Fit of length and velocity of the striker to a record with 2 % of noise."""
    strain = 10.0 / (2 * STEEL.wave_speed)
    noisy = measured(record(rods(), 0.02 * strain))
    vary = {LENGTH: (0.15, 0.25), VELOCITY: (1.0, 20.0)}
    return ri.fit(rods(0.24, 5.0), noisy, vary, UNTIL)


@pytest.mark.parametrize(("path", "true_value"), [(LENGTH, 0.2), (VELOCITY, 10.0)])
def test_a_fit_finds_the_system_that_made_a_record(noisy_fit, path, true_value):
    value = noisy_fit.values[path]
    assert value == pytest.approx(true_value, rel=5e-3)
    # Four standard errors are hardly ever passed.
    assert abs(value - true_value) < 4 * noisy_fit.standard_errors[path]
    assert not noisy_fit.notes
    assert noisy_fit.system.bodies[0].length == noisy_fit.values[LENGTH]


def test_the_standard_error_is_that_of_a_mean_over_the_pulse(noisy_fit):
    duration = 2 * 0.2 / STEEL.wave_speed  # s, two transits of the striker
    samples = int(duration / INTERVAL)
    expected = 10.0 * 0.02 / samples**0.5  # m/s, 2 % of noise in each sample
    assert noisy_fit.standard_errors[VELOCITY] == pytest.approx(expected, rel=0.7)


def test_the_misfit_is_that_of_the_prediction_and_as_large_as_the_noise(noisy_fit):
    noisy = noisy_fit.measured[0]
    difference = noisy_fit.predicted[0].values - noisy.signal.values
    rms = math.sqrt(np.mean(difference**2))
    misfit = noisy_fit.misfits[0]  # over the size of the record
    assert misfit * noisy.size == pytest.approx(rms, rel=1e-9)
    assert misfit == pytest.approx(0.02, rel=0.1)


def test_all_searches_end_at_the_same_point(noisy_fit):
    assert len(noisy_fit.descents) == 3
    for end in noisy_fit.descents:
        best = noisy_fit.values[LENGTH]
        assert end.values[LENGTH] == pytest.approx(best, rel=1e-6)


def test_records_have_shifts_of_their_own_which_a_fit_in_threads_finds_as_well():
    solution = ri.solve(rods(), until=UNTIL)
    near = (1, 0.2)
    far = (1, 0.4)
    near_signal = solution.gauge(*near).signal(INTERVAL).shifted(1e-6)
    far_signal = solution.gauge(*far).signal(INTERVAL).shifted(2e-6)
    records = [
        ri.Measured(near_signal, near, gain=1.0),
        ri.Measured(far_signal, far, gain=1.0),
    ]
    vary = {LENGTH: (0.1, 0.4)}

    alone = ri.fit(rods(), records, vary, UNTIL, starts=2)
    with ThreadPoolExecutor(2) as pool:
        in_threads = ri.fit(rods(), records, vary, UNTIL, starts=2, executor=pool)

    assert alone.values == in_threads.values
    assert alone.values["records.0.shift"] == pytest.approx(1e-6, abs=1e-9)
    assert alone.values["records.1.shift"] == pytest.approx(2e-6, abs=1e-9)


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
    solution = ri.solve(rods(), until=UNTIL)
    random = np.random.default_rng(3)
    shot = Shot([], [])
    for gauge in ((1, 0.2), (1, 0.4)):
        sharp = solution.gauge(*gauge).signal(INTERVAL)
        strain = sharp.low_pass(CUTOFF_TIMES_BLUR / SHOT_BLUR)
        signal = strain.shifted(SHOT_SHIFT) * SHOT_GAIN
        noise = SHOT_NOISE * random.standard_normal(len(signal))
        noisy = signal.replace(values=signal.values + noise)
        shot.records.append(ri.Measured(noisy, gauge))
        shot.clean.append(signal)
    return shot


@pytest.fixture(scope="module")
def tied_fit(shot):
    """Fit of one gain, one shift and one blur of both records."""
    vary = {
        LENGTH: (0.1, 0.4),
        "records.*.gain": None,
        "records.*.shift": (-1e-5, 1e-5),
        "records.[01].blur": (0.0, 1e-5),
    }
    return ri.fit(rods(), shot.records, vary, UNTIL, starts=1)


def test_records_share_the_numbers_that_are_tied(tied_fit):
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
        assert abs(value - true_value) < 4 * tied_fit.standard_errors[name], name


def test_shift_and_gain_are_known_nearly_as_well_as_each_alone(shot, tied_fit):
    # The error of one number alone is sigma over the norm of the derivative by it.
    gain_derivatives_squared = 0.0
    shift_derivatives_squared = 0.0
    for signal in shot.clean:
        gain_derivative = signal.values / SHOT_GAIN
        shift_derivative = np.gradient(signal.values, INTERVAL)
        gain_derivatives_squared += float(np.sum(gain_derivative**2))
        shift_derivatives_squared += float(np.sum(shift_derivative**2))
    gain_error_alone = SHOT_NOISE / gain_derivatives_squared**0.5
    shift_error_alone = SHOT_NOISE / shift_derivatives_squared**0.5
    gain_error = tied_fit.standard_errors["records.*.gain"]
    shift_error = tied_fit.standard_errors["records.*.shift"]
    assert 1 <= gain_error / gain_error_alone < 1.5
    assert 1 <= shift_error / shift_error_alone < 1.5


def test_a_gain_of_one_record_is_known_less_well_than_a_common_one(shot, tied_fit):
    vary = {LENGTH: (0.1, 0.4), "records.*.blur": (0.0, 1e-5)}
    separate = ri.fit(rods(), shot.records, vary, UNTIL, starts=1)
    separate_numbers = {"records.0.shift", "records.1.shift", "records.1.gain"}
    assert separate_numbers < separate.values.keys()
    common_error = tied_fit.standard_errors["records.*.gain"]
    assert common_error < separate.standard_errors["records.0.gain"]


# Additions ----------------------------------------------------------------------------

VARY_VELOCITY = {VELOCITY: (1.0, 20.0)}
OFFSET_AND_TREND = {"records.0.offset": None, "records.0.trend": (-10.0, 10.0)}
ADDITIONS = {
    "offset and trend": OFFSET_AND_TREND,
    "blur": {"records.0.blur": (0.0, 1e-5)},
    "diameter": {"bodies.0.area": (5e-5, 2e-4)},
}
OFFSET = 8e-5  # strain
TREND = 0.5  # 1/s, strain over time


def changed_record(offset=0.0, trend=0.0, blur=0.0, area=1e-4):
    """A noisy record with an offset, a trend, a blur, or a thicker striker.

    The trend is 0 in the middle of the record.
    """
    system = rods()
    striker = ri.Rod(0.2, area=area, material=STEEL, velocity=10.0)
    signal = record(ri.System([striker, system.bodies[1]]), noise=1e-5)
    if blur:
        signal = signal.low_pass(CUTOFF_TIMES_BLUR / blur)
    time_from_middle = signal.times - (signal.start + signal.end) / 2
    drift = offset + trend * time_from_middle
    return measured(signal.replace(values=signal.values + drift))


def test_offset_and_trend_are_found_and_misfit_as_little_as_known_ones():
    drifting = changed_record(OFFSET, TREND)
    known_drift = drifting.replace(offset=OFFSET, trend=TREND)
    vary = VARY_VELOCITY | OFFSET_AND_TREND

    found = ri.fit(rods(), drifting, vary, UNTIL, starts=1)
    known = ri.fit(rods(), known_drift, VARY_VELOCITY, UNTIL, starts=1)

    assert found.values[VELOCITY] == pytest.approx(10.0, rel=2e-3)
    for name, true_value in (("records.0.offset", OFFSET), ("records.0.trend", TREND)):
        error = abs(found.values[name] - true_value)
        assert error < 4 * found.standard_errors[name]
        assert error < 0.1 * true_value
    assert known.misfits[0] == pytest.approx(found.misfits[0], rel=0.01)


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({}, []),
        ({"offset": 8e-5, "trend": 0.5}, ["offset and trend"]),
        ({"blur": 2e-6}, ["blur"]),
        ({"area": 1.1e-4}, ["diameter"]),
    ],
)
def test_the_addition_that_a_record_needs_earns_its_place_and_predicts_best(
    change, expected
):
    noisy = changed_record(**change)

    found = ri.fit(rods(), noisy, VARY_VELOCITY, UNTIL, starts=1, additions=ADDITIONS)

    earning = [each.name for each in found.additions if each.earns_its_place]
