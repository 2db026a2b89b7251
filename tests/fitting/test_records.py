"""The fit of a measured pulse, and standard errors against the scatter of fits."""

import numpy as np
import pytest
from scipy.signal import lfilter
from validation_cases import validation_module

import rodimpact as ri

STEP = 4e-7  # s, between samples of a record
NEAR = 1, 0.02  # gauge from where the exact mode carries the pulse
UNTIL = 2.5e-4  # s


@pytest.mark.exhaustive
def test_all_searches_for_a_measured_pulse_end_at_one_place():
    pulses = validation_module("measured_pulses")
    vary = {**pulses.ENDS, pulses.SPEED: (4200.0, 5400.0)}
    found = pulses.fitted(pulses.TITANIUM, vary, starts=3)
    for end in found.descents:
        for name, value in end.values.items():
            assert abs(value - found.values[name]) < 0.01 * found.standard_errors[name]
    assert found.misfits[0] < 0.02


@pytest.mark.exhaustive
@pytest.mark.parametrize("correlation", [0.0, 1e-6, 5e-6])
def test_standard_errors_are_the_scatter_of_fits_of_noisy_pulses(correlation):
    pulses = validation_module("measured_pulses")
    shot, random = pulses.TITANIUM, np.random.default_rng(4)
    system = pulses.row_of(shot, shot.bar.wave_speed, ri.Hertz(6e10), None, UNTIL)
    carried = {"distance": 0.361, "radius": shot.bar.radius}
    strain = ri.solve(system, until=UNTIL).gauge(*NEAR).signal(STEP / 4).extended(1e-4, 1e-4)
    pulse = strain.propagated(carried["distance"], shot.bar).low_pass(0.1325 / 2e-6)
    clean = pulse.resampled(times=np.arange(5e-5, 2e-4, STEP))
    fade = np.exp(-STEP / correlation) if correlation else 0.0
    values, errors = [], []
    for _ in range(50):
        white = random.standard_normal(len(clean) + 500) * np.sqrt(1 - fade**2)
        noise = 0.02 * np.abs(clean.values).max() * lfilter([1.0], [1.0, -fade], white)[500:]
        measured = ri.Measured(clean.replace(values=clean.values + noise), NEAR, **carried)
        vary = {pulses.LENGTH: shot.length, **pulses.ENDS, "records.0.blur": (0.0, 1e-5)}
        found = ri.fit(system, measured, vary, UNTIL, starts=1)
        values.append(list(found.values.values()))
        errors.append(list(found.standard_errors.values()))
    ratio = np.mean(errors, axis=0) / np.std(values, axis=0)
    assert (ratio > 0.8).all(), ratio
    assert (ratio < 1.3).all(), ratio
