"""Wave speed and Poisson ratio of one bar from a pulse at two distances."""

import numpy as np
import pytest
from exhaustive import few_of
from numpy.random import default_rng

import rodimpact as ri

SPEED = 5000.0  # bar speed, m/s
RADIUS = 0.01  # m
RISE = 5e-6  # of the pulse, s
WIDTH = 1e-4  # of the pulse, s
DT = 2e-7  # interval of a record, s
TIMES = np.arange(-1e-4, 9e-4, DT)
TO_FIRST = 0.5  # m, way of the pulse to the first gauge
METAL = ri.Material(
    "metal", youngs_modulus=8000 * SPEED**2, density=8000.0, poisson_ratio=0.29
)
BAR = ri.Rod(4.0, diameter=2 * RADIUS, material=METAL)


def guess():
    """The bar with a wrong wave speed and Poisson ratio."""
    wrong_speed = 1.02 * SPEED
    wrong_modulus = METAL.density * wrong_speed**2
    material = METAL.replace(youngs_modulus=wrong_modulus, poisson_ratio=0.3)
    return ri.Rod(4.0, diameter=2 * RADIUS, material=material)


def record(distance, bar, noise=0.0, seed=0, factor=1.0):
    """A trapezoidal pulse of height 1 after a distance along a bar, m, times a factor.

    `noise` is the standard deviation of what is added.
    """
    up = TIMES / RISE
    down = (WIDTH + RISE - TIMES) / RISE
    slopes = np.minimum(up, down)
    shape = np.clip(slopes, 0, 1)
    pulse = ri.Signal(shape, TIMES)
    passing = pulse.propagated(distance, bar)
    values = factor * np.interp(TIMES, passing.times, passing.values)
    rng = default_rng(seed)
    white = rng.standard_normal(len(TIMES))
    return ri.Signal(values + noise * white, TIMES)


APART = 2.0  # distance of the second gauge from the first, m


def both_records(bar, noise=0.0, seed=0, factor=1.0):
    """Records of gauges that are `APART`, cut to the passages of the pulse.

    The second one is multiplied by a factor.
    """
    to_second = TO_FIRST + APART
    first = record(TO_FIRST, bar, noise, 2 * seed)
    second = record(to_second, bar, noise, 2 * seed + 1, factor)
    first_passage = first.window(0.0, 3e-4)
    second_passage = second.window(3e-4, 8.5e-4)
    return first_passage, second_passage


@pytest.mark.parametrize("seed", few_of([0, 1], [0]))
@pytest.mark.parametrize("poisson_ratio", few_of([0.25, 0.29, 0.34], [0.29]))
def test_speed_and_poisson_ratio_are_found_within_their_errors(poisson_ratio, seed):
    """Noise of 0.1 %: within 0.5 m/s and 0.001, and within 3 or 4 times the stated
    errors, which are standard deviations.
    """
    true_bar = ri.waves.Bar(SPEED, poisson_ratio, RADIUS)
    records = both_records(true_bar, noise=1e-3, seed=seed)

    calibration = ri.calibrate_bar(*records, APART, guess())

    speed_error = abs(calibration.wave_speed - SPEED)
    poisson_error = abs(calibration.poisson_ratio - poisson_ratio)
    gain_error = abs(calibration.gain - 1.0)
    assert speed_error < 0.5
    assert poisson_error < 1e-3
    assert speed_error < 3 * calibration.wave_speed_error
    assert poisson_error < 3 * calibration.poisson_ratio_error
    assert gain_error < 4 * calibration.gain_error
    assert calibration.wave_speed_error < 0.2
    assert calibration.poisson_ratio_error < 5e-4


@pytest.mark.exhaustive
def test_stated_errors_are_the_scatter():
    """Errors over stated errors have a standard deviation near 1."""
    true_bar = ri.waves.Bar(SPEED, 0.29, RADIUS)
    speed_ratios = []
    poisson_ratios = []
    for seed in range(12):
        records = both_records(true_bar, noise=2e-2, seed=seed)
        calibration = ri.calibrate_bar(*records, APART, BAR)
        speed_error = calibration.wave_speed - SPEED
        poisson_error = calibration.poisson_ratio - 0.29
        speed_ratio = speed_error / calibration.wave_speed_error
        poisson_ratio = poisson_error / calibration.poisson_ratio_error
        speed_ratios.append(speed_ratio)
        poisson_ratios.append(poisson_ratio)
    for ratios in (speed_ratios, poisson_ratios):
        mean_square = np.mean(np.square(ratios))
        scatter = np.sqrt(mean_square)
        assert 0.4 < scatter < 1.6


@pytest.mark.exhaustive
def test_an_echo_from_a_free_end_is_as_good_as_a_second_gauge():
    """A bar is calibrated by a record and its echo from a free end: wave speed and
    gain, -1, are found, the bar has the wave speed and Poisson's ratio, and nothing is
    doubtful.
    """
    true_bar = ri.waves.Bar(SPEED, 0.29, RADIUS)
    first, echo = both_records(true_bar, noise=1e-3, factor=-1.0)

    calibration = ri.calibrate_bar(first, echo, APART, guess())

    material = calibration.bar.segments[0].material
    assert calibration.wave_speed == pytest.approx(SPEED, abs=0.5)
    assert calibration.gain == pytest.approx(-1.0, abs=1e-3)
    assert material.wave_speed == calibration.wave_speed
    assert material.poisson_ratio == calibration.poisson_ratio
    assert "Doubtful" not in str(calibration)


@pytest.mark.exhaustive
def test_a_pulse_that_is_cut_off_in_the_second_record_is_doubtful():
    """The second record of a bar becomes 0 when half of the pulse has passed: the
    calibration has a misfit above 5 % and is called doubtful.
    """
    true_bar = ri.waves.Bar(SPEED, 0.29, RADIUS)
    first, second = both_records(true_bar)
    # Half of the pulse has passed the second gauge, 2.5 m on, after 0.55 ms.
    has_passed = second.times < 5.5e-4
    values = np.where(has_passed, second.values, 0.0)
    cut_off = second.replace(values=values)

    calibration = ri.calibrate_bar(first, cut_off, APART, guess())

    assert calibration.misfit > 0.05
    assert "Doubtful" in str(calibration)


def test_mistakes_are_named():
    """Each change alone spoils a call that is right."""
    true_bar = ri.waves.Bar(SPEED, 0.29, RADIUS)
    first, second = both_records(true_bar)
    before_pulse_ends = first.window(0.0, 5e-5)
    in_volts = second.replace(unit="V")
    not_round = ri.Rod(4.0, area=1e-4, material=METAL)
    mistakes = [
        ("distance", 0.0, "distance: must be a finite positive"),
        ("distance", 2.5, "distance: takes 10 % more or less time"),
        ("second", before_pulse_ends, "second: must contain the pulse"),
        ("second", in_volts, "second: must be in the unit of first"),
        ("bar", not_round, "diameter"),
        ("first", [0.0, 1.0], "first: must be"),
    ]
    for name, value, message in mistakes:
        arguments = {"first": first, "second": second, "distance": APART, "bar": BAR}
        arguments[name] = value
        with pytest.raises(ri.InvalidModel, match=message):
            ri.calibrate_bar(**arguments)


def test_a_joint_that_reflects_too_much_is_told():
    """The second bar is thinner than it is said to be."""
    metal = ri.Material("metal", youngs_modulus=2e11, density=8000)
    striker = ri.Rod(0.3, area=1e-4, material=metal, velocity=10.0)
    bar = ri.Rod(1.5, area=1e-4, material=metal)
    thin = ri.Rod(1.5, area=8e-5, material=metal)
    row = ri.System([striker, bar, thin])
    run = ri.solve(row, until=1.5e-3)
    from_joint = 0.75  # m, in the middle of either bar
    first_record = run.gauge(1, from_joint).signal(1e-6)
    second_record = run.gauge(2, from_joint).signal(1e-6)
    on_first = ri.BarGauge(first_record, from_joint)
    on_second = ri.BarGauge(second_record, from_joint)

    message = "clean and align the faces"
    with pytest.warns(ri.DoubtfulCalibration, match=message) as warned:
        as_equal = ri.calibrate(on_first, on_second, bar)
    as_thin = ri.calibrate(on_first, on_second, (bar, thin))

    sentence = "reflects -11.1 % of the incident strain, 1.2 % of its energy"
    assert sentence in str(as_equal)
    assert warned[0].filename == __file__  # the warning names the line of the user
    assert as_thin.doubts == ()
