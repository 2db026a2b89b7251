"""Three pulses cut out of their records, and records that begin just before their
pulse.
"""

import numpy as np
import pytest
from exhaustive import few_of
from numpy.random import default_rng
from records import shots
from records.shots import BAR, INPUT_BAR, OUTPUT_BAR, SPECIMEN

import rodimpact as ri

DISTANCE = 0.75  # m, from a gauge to the specimen
TRAVEL = DISTANCE / shots.STEEL.wave_speed  # s


@pytest.fixture(scope="module")
def shot():
    """A shot on a fine grid, whose errors are far below the bands."""
    return shots.pressure_bar_shot(cells=900)


def cut(gauge, start, end):
    """A gauge with a part of its record, from `start` to `end`, s."""
    part = gauge.signal.window(start, end)
    return gauge.replace(signal=part)


def cut_pulses(shot, rest=30e-6, seed=0):
    """Gauges of incident, reflected and transmitted pulse, with some rest before each.

    Both bars are twice as long as `DISTANCE`: the pulse passes the first gauge after
    one `TRAVEL`, and comes back to it, and to the second gauge, after three.
    """
    on_input = shot.gauge(INPUT_BAR, DISTANCE, seed=2 * seed)
    on_output = shot.gauge(OUTPUT_BAR, DISTANCE, seed=2 * seed + 1)
    comes_back = 3 * TRAVEL
    incident = cut(on_input, TRAVEL - rest, TRAVEL + 215e-6)
    reflected = cut(on_input, comes_back - rest, comes_back + 230e-6)
    transmitted = cut(on_output, comes_back - rest, comes_back + 230e-6)
    return incident, reflected, transmitted


def is_plastic(strain):
    """Whether each sample of a strain lies above 1 %, while loading."""
    sample = np.arange(len(strain))
    is_loading = sample <= strain.argmax()
    return is_loading & (strain > 0.01)


def rms(errors):
    """Root of the mean square."""
    mean_square = np.mean(errors**2)
    return np.sqrt(mean_square)


def errors_over_time(shot, result):
    """Root mean square relative error of the stress, and largest error of the strain
    over its largest value, above 1 % of strain while loading.
    """
    strain = shot.strain(result.times)
    stress = shot.stress(result.times)
    plastic = is_plastic(strain)
    stress_errors = result.stress[plastic] / stress[plastic] - 1
    strain_errors = np.abs(result.strain - strain)
    largest_strain_error = strain_errors[plastic].max() / strain.max()
    return rms(stress_errors), largest_strain_error


def stress_error_at_strain(shot, result):
    """Root mean square relative error of the stress at strains of 1.1 % and more."""
    times = np.arange(2.9e-4, 7e-4, 1e-6)
    strain = shot.strain(times)
    stress = shot.stress(times)
    n_loading = int(strain.argmax()) + 1  # samples up to the largest strain
    strain = strain[:n_loading]
    stress = stress[:n_loading]
    last_strain = 0.97 * strain.max()
    strains = np.linspace(0.011, last_strain, 200)
    true_stress = np.interp(strains, strain, stress)
    stress_found = result.at_strain(strains, result.stress)
    errors = stress_found / true_stress - 1
    return rms(errors)


def reduced(pulses, **options):
    """Reduction of cut pulses on `BAR` and `SPECIMEN`."""
    return ri.reduce(pulses=pulses, bars=BAR, specimen=SPECIMEN, **options)


@pytest.mark.parametrize("rest", few_of([30e-6, 1e-6], [1e-6]))
def test_cut_pulses_with_the_times_of_the_records_give_stress_and_strain(shot, rest):
    """Three pulses, cut with `rest` s before each, are reduced: stress and strain are
    right to 1 %, without doubts.
    """
    pulses = ri.CutPulses(*cut_pulses(shot, rest))
    result = reduced(pulses)
    stress_error, strain_error = errors_over_time(shot, result)
    assert stress_error < 0.01
    assert strain_error < 0.01
    assert result.doubts == ()


@pytest.mark.exhaustive
@pytest.mark.usefixtures("all_draws")
@pytest.mark.parametrize("count", few_of([3, 8], [3]))
def test_the_band_of_cut_pulses_covers_90_percent_of_the_stress(shot, count):
    """`count` shots with different noise are reduced from cut pulses: on average the
    true stress lies in its band for 90 % of the plastic samples.
    """
    covered = []
    for seed in range(count):
        pulses = ri.CutPulses(*cut_pulses(shot, seed=seed))
        result = reduced(pulses)
        strain = shot.strain(result.times)
        stress = shot.stress(result.times)
        plastic = is_plastic(strain)
        error = np.abs(result.stress - stress)
        is_within = error <= result.stress_band
        covered.append(np.mean(is_within[plastic]))
    assert np.mean(covered) > 0.9


def pulses_from_0(shot):
    """Gauges of the cut pulses with times of their own, which begin together, to some
    microseconds.
    """
    offsets = (0.0, 3e-6, -7e-6)  # s, by which they begin before 0
    gauges = []
    gauges_cut = cut_pulses(shot)
    for gauge, offset in zip(gauges_cut, offsets, strict=True):
        start = gauge.signal.start + offset
        from_0 = gauge.signal.shifted(-start)
        gauges.append(gauge.replace(signal=from_0))
    return gauges


def test_cut_pulses_with_times_of_their_own_give_the_stress_if_that_is_said(shot):
    """Three pulses that all begin at 0 are reduced with clock="own" and aligned by the
    modulus of the specimen: the stress is right to 1 %, without doubts.
    """
    gauges = pulses_from_0(shot)
    pulses = ri.CutPulses(*gauges, clock="own")
    elastic = SPECIMEN.replace(youngs_modulus=6e9)

    result = ri.reduce(pulses=pulses, bars=BAR, specimen=elastic, align_within=10e-6)

    assert result.doubts == ()
    assert stress_error_at_strain(shot, result) < 0.01


def test_cut_pulses_that_begin_together_are_refused_if_it_is_not_said(shot):
    pulses = ri.CutPulses(*pulses_from_0(shot))
    with pytest.raises(ri.InvalidModel, match='clock="own"'):
        reduced(pulses)


def test_gauges_with_a_gain_and_opposite_sides_are_cut_too(shot):
    """The transmitted pulse in volts of two opposite gauges, with bending of a tenth,
    gives the same stress.
    """
    incident, reflected, transmitted = cut_pulses(shot)
    gain = 5.0
    volts = transmitted.signal / gain
    # The same strain, with bending of a tenth
    more = 1.1 * volts
    less = 0.9 * volts
    in_volts = transmitted.replace(signal=more, opposite=less, gain=gain)
    pulses = ri.CutPulses(incident, reflected, transmitted)
    pulses_in_volts = ri.CutPulses(incident, reflected, in_volts)

    result = reduced(pulses)
    by_volts = reduced(pulses_in_volts)

    expected = result.stress
    assert by_volts.stress == pytest.approx(expected, rel=1e-9, abs=1.0)


def test_mistakes_of_cut_pulses_are_named(shot):
    """Pulses beside gauges, something that is no pulses, different distances, an
    unknown clock, and a pulse that is cut too short are refused, each in its words.
    """
    incident, reflected, transmitted = cut_pulses(shot)
    pulses = ri.CutPulses(incident, reflected, transmitted)
    with pytest.raises(ri.InvalidModel, match="either pulses or gauges"):
        reduced(pulses, input_gauges=incident)
    with pytest.raises(ri.InvalidModel, match="must be a CutPulses"):
        reduced(incident)
    elsewhere = reflected.replace(distance=0.5)
    with pytest.raises(ri.InvalidModel, match="that of the incident pulse"):
        ri.CutPulses(incident, elsewhere, transmitted)
    with pytest.raises(ri.InvalidModel, match="one of 'common', 'own'"):
        ri.CutPulses(incident, reflected, transmitted, clock="none")
    without_end = cut(incident, 0, TRAVEL + 100e-6)
    cut_short = ri.CutPulses(without_end, reflected, transmitted)
    with pytest.raises(ri.InvalidModel, match="of its largest strain"):
        reduced(cut_short)


def test_a_record_that_begins_after_its_wave_left_the_specimen_gives_the_same_stress(
    shot,
):
    """A recorder of its own for the output bar begins 30 us before the pulse is
    there.
    """
    on_input = shot.gauge(INPUT_BAR, DISTANCE)
    on_output = shot.gauge(OUTPUT_BAR, DISTANCE, seed=1)
    arrival = 3 * TRAVEL
    late = cut(on_output, arrival - 30e-6, 7e-4)

    by_whole = ri.reduce(on_input, on_output, BAR, SPECIMEN)
    by_late = ri.reduce(on_input, late, BAR, SPECIMEN)

    difference = np.abs(by_late.stress - by_whole.stress)
    peak_stress = by_whole.stress.max()
    assert difference.max() < 0.01 * peak_stress


def ramp_record(rest, rise, end):
    """A slow ramp to a strain of -1e-3 after some rest, with noise, and its equally
    slow fall: rest, rise and end in s.
    """
    times = np.arange(0.0, end, 1e-6)
    fall_end = rest + 2.2 * rise
    up = (times - rest) / rise
    down = (fall_end - times) / rise
    slopes = np.minimum(up, down)
    level = np.clip(slopes, 0, 1)
    rng = default_rng(0)
    noise = 1e-6 * rng.standard_normal(len(times))
    return ri.Signal(-1e-3 * level + noise, times)


def test_as_much_rest_as_the_rise_is_enough():
    """400 us of rest before a ramp of 400 us, which a stiff specimen transmits.

    The level and noise of the records are those of their rest.
    """
    record = ramp_record(rest=400e-6, rise=400e-6, end=5e-3)
    metal = ri.Material("metal", youngs_modulus=2e11, density=8e3)
    bar = ri.Rod(8.0, area=1e-4, material=metal)
    distance = 3.9  # m, from a gauge to the specimen
    travel = 2 * distance / metal.wave_speed  # s, from one gauge to the other
    on_input = ri.BarGauge(record, distance)
    late_record = record.shifted(travel)
    on_output = ri.BarGauge(late_record, distance)
    specimen = ri.Specimen(5e-3, area=1e-4)

    result = ri.reduce(on_input, on_output, bar, specimen)

    # The specimen transmits all of 1e-3 of strain, with the modulus of the bar.
    peak_stress = result.stress.max()
    assert peak_stress == pytest.approx(200e6, rel=0.02)


def gauges_with_rest(count):
    """Two gauges whose records have `count` samples at rest, 1 us apart, before a ramp."""
    rest = count * 1e-6  # s
    record = ramp_record(rest=rest, rise=40e-6, end=6e-4)
    on_input = ri.BarGauge(record, DISTANCE)
    late_record = record.shifted(3e-4)
    on_output = ri.BarGauge(late_record, DISTANCE)
    return on_input, on_output


def test_16_samples_at_rest_are_needed_and_told():
    """Records with 14 samples before a ramp are refused: the message names the 6 to 13
    that it counts, as up to 8 before the rise do not count, and the 16 that are needed.
    """
    with pytest.raises(ri.InvalidModel) as caught:
        ri.reduce(*gauges_with_rest(14), BAR, SPECIMEN)

    (message,) = dict(caught.value.problems).values()
    _, after = message.split("has ")
    number, *_ = after.split(" ")
    samples_named = int(number)
    assert 14 - 8 <= samples_named < 14
    assert "16 are needed, 16 us" in message


def test_24_samples_at_rest_are_enough():
    """Records with 24 samples before a ramp are reduced, with the right peak stress to
    2 %.
    """
    result = ri.reduce(*gauges_with_rest(24), BAR, SPECIMEN)

    # The specimen transmits all of the strain of 1e-3.
    bar_area = BAR.segments[0].area
    force = 1e-3 * shots.STEEL.youngs_modulus * bar_area
    stress = force / SPECIMEN.section
    peak_stress = result.stress.max()
    assert peak_stress == pytest.approx(stress, rel=0.02)
