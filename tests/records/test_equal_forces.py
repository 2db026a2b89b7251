"""Equal forces on both faces: one gauge a bar where waves overlap, and direct
impact.
"""

import numpy as np
import pytest
from exhaustive import few_of
from records import shots
from records.shots import BAR, SPECIMEN, STRIKER

import rodimpact as ri

LONG_PULSE = {
    "duration": 500e-6,
    "until": 1.3e-3,
    "material": shots.SOFT,
    "cells": 900,
}


@pytest.fixture(scope="module")
def shot():
    """The incident wave lasts 530 us; the reflected one is at the gauge after 200
    us.
    """
    return shots.pressure_bar_shot(**LONG_PULSE)


def reduced(shot, distance=0.5, seed=0, bar=BAR, **changes):
    first = shot.gauge(0, distance, seed=seed)
    second = shot.gauge(2, distance, seed=seed + 1)
    specimen = SPECIMEN.replace(**changes)
    return ri.reduce(first, second, bar, specimen, equal_forces=True)


def rms(values):
    return np.sqrt(np.mean(values**2))


def law_errors(shot, result, least=0.03):
    """Relative errors of the stress at strains from `least` on, while loading."""
    strain = shot.strain(result.times)
    peak = int(strain.argmax())
    stress = shot.stress(result.times)
    strains = np.linspace(least, 0.97 * strain.max(), 200)
    truth = np.interp(strains, strain[:peak], stress[:peak])
    return result.at_strain(strains, result.stress) / truth - 1


def is_loading(shot, result, least=0.01):
    strain = shot.strain(result.times)
    is_before_peak = np.arange(len(strain)) <= strain.argmax()
    return is_before_peak & (strain > least)


def parts_within_bands(shot, result):
    """Parts of the loading in which the bands of stress and strain contain the
    truth.
    """
    loading = is_loading(shot, result)
    stress_error = np.abs(result.stress - shot.stress(result.times))
    strain_error = np.abs(result.strain - shot.strain(result.times))
    by_stress = np.mean((stress_error <= result.stress_band)[loading])
    by_strain = np.mean((strain_error <= result.strain_band)[loading])
    return by_stress, by_strain


@pytest.mark.parametrize("distance", few_of([0.25, 0.5], [0.5]))
def test_overlapping_waves_are_separated(shot, distance):
    first = shot.gauge(0, distance)
    second = shot.gauge(2, distance)
    with pytest.raises(ValueError, match="the reflected wave reaches the gauge before"):
        ri.reduce(first, second, BAR, SPECIMEN)

    result = reduced(shot, distance)

    loading = is_loading(shot, result)
    strain = shot.strain(result.times)
    strain_error = np.abs(result.strain - strain)[loading].max()
    assert strain_error < 0.01 * strain.max()
    assert rms(law_errors(shot, result)) < 0.01
    stress = shot.stress(result.times)[loading]
    assert rms(result.stress[loading] / stress - 1) < 0.01
    assert result.doubts == ()


def test_bands_cover_the_truth_of_overlapping_waves(shot):
    covered = []
    for seed in range(0, 12, 2):  # `reduced` takes the next one, too
        result = reduced(shot, seed=seed)
        covered.append(parts_within_bands(shot, result))
    assert np.all(np.mean(covered, axis=0) > 0.93)


def test_the_output_bar_returns_the_wave_from_its_free_end(shot):
    """The curve goes on after the wave is back at the gauge, 400 us after it passed."""
    round_trip = 2 * 1.0 / shots.STEEL.wave_speed

    result = reduced(shot)

    start = result.times[0]
    assert result.times[-1] > start + 2 * round_trip
    is_late = result.times > start + 1.3 * round_trip
    force = shot.solution.contacts[1].force(result.times[is_late])
    force_error = np.abs(result.output_force[is_late] - force).max()
    assert force_error < 0.04 * force.max()


def test_the_verdict_says_assumed(shot):
    result = reduced(shot)
    verdict = result.verdict
    assert verdict.in_equilibrium is None
    assert np.isnan(verdict.imbalance)
    text = str(result)
    assert text.startswith("equilibrium is assumed, not measured")
    assert "give Specimen(wave_speed=...)" in text
    assert "adds once every 198 us" in text
    verdict_text = str(reduced(shot, wave_speed=1118.0))
    assert "it takes some 14.3 us, 4 transit times" in verdict_text


def test_an_offset_is_taken_out(shot):
    """The level at rest is subtracted, so an offset of the amplifier changes
    nothing.
    """
    first = shot.gauge(0, 0.5)
    second = shot.gauge(2, 0.5, seed=1)
    with_offset = first.replace(signal=first.signal + 5e-5)

    plain = ri.reduce(first, second, BAR, SPECIMEN, equal_forces=True)
    moved = ri.reduce(with_offset, second, BAR, SPECIMEN, equal_forces=True)

    assert moved.strain == pytest.approx(plain.strain, abs=1e-9)


def reduced_impact(gauge, striker, specimen=SPECIMEN):
    """Reduction of a direct impact, of which the output bar alone has a gauge."""
    return ri.reduce(output_gauges=gauge, bars=BAR, specimen=specimen, striker=striker)


@pytest.mark.parametrize("is_rigid", few_of([False, True], [False]))
def test_the_law_of_a_direct_impact(is_rigid):
    """A specimen that yields at 133 MPa and hardens, hit by a rod or by a rigid
    mass.
    """
    shot = shots.direct_impact_on_law(is_rigid)
    striker = STRIKER
    if is_rigid:
        striker = ri.RigidMass(STRIKER.mass, velocity=12.0)

    result = reduced_impact(shot.gauge(0.5), striker)

    errors = law_errors(shot, result)
    assert rms(errors) < 0.01
    assert np.median(np.abs(errors)) < 0.005
    strain = shot.strain(result.times)
    strain_error = np.abs(result.strain - strain)[is_loading(shot, result)]
    assert strain_error.max() < 0.01 * strain.max()
    assert min(parts_within_bands(shot, result)) > 0.95
    assert result.doubts == ()
    assert "momentum of the striker" in str(result.verdict)


def test_a_rod_is_no_rigid_mass():
    """The wave in a striker of 0.4 m goes to and fro in 159 us."""
    shot = shots.direct_impact_on_law()
    mass = ri.RigidMass(STRIKER.mass, velocity=12.0)
    gauge = shot.gauge(0.5)

    by_rod = reduced_impact(gauge, STRIKER)
    by_mass = reduced_impact(gauge, mass)

    strain = shot.strain(by_rod.times).max()
    assert by_rod.strain.max() == pytest.approx(strain, rel=0.01)
    assert by_mass.strain.max() != pytest.approx(strain, rel=0.03)


def test_a_specimen_out_of_equilibrium_is_outside_the_assumptions():
    """The verdict tells from which strain on equal forces are to be expected."""
    shot = shots.direct_impact()
    specimen = SPECIMEN.replace(wave_speed=1118.0)

    result = reduced_impact(shot.gauge(2, 0.5), STRIKER, specimen)

    verdict = str(result.verdict)
    assert "equilibrium is assumed" in verdict
    percent = verdict.split("expect it from ")[1].split(" %")[0]
    strain_named = float(percent) / 100
    from_start = law_errors(shot, result, least=0.005)
    after = law_errors(shot, result, least=3 * strain_named)
    assert np.abs(from_start).max() > 0.2
    assert rms(after) < 0.02


@pytest.mark.parametrize(
    ("change", "path", "says"),
    [
        ({"align_within": 1e-6}, "align_within", "equal forces are assumed"),
        ({"equal_forces": 1}, "equal_forces", "True or False"),
        ({"input_gauges": "two"}, "input_gauges", "leave equal_forces out"),
        ({"input_gauges": "near"}, "input_gauges", "further away"),
    ],
)
def test_mistakes_of_equal_forces_are_named(shot, change, path, says):
    first = shot.gauge(0, 0.5)
    arguments = {
        "input_gauges": first,
        "output_gauges": shot.gauge(2, 0.5),
        "bars": BAR,
        "specimen": SPECIMEN,
        "equal_forces": True,
    }
    arguments |= change
    if arguments["input_gauges"] == "two":
        arguments["input_gauges"] = [first, shot.gauge(0, 0.6)]
    if arguments["input_gauges"] == "near":
        arguments["input_gauges"] = shot.gauge(0, 0.0)

    with pytest.raises(ri.InvalidModel, match=says) as caught:
        ri.reduce(**arguments)
    assert path in dict(caught.value.problems)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"striker": STRIKER.replace(velocity=0.0)}, "velocity above 0"),
        ({"striker": 3.0}, "a rigid mass or a uniform rod"),
        ({"bars": (BAR, BAR)}, "the output bar alone"),
        ({"input_gauges": "output_gauges"}, "give output_gauges alone"),
    ],
)
def test_mistakes_of_a_direct_impact_are_named(change, says):
    gauge = shots.direct_impact_on_law().gauge(0.5)
    arguments = {
        "output_gauges": gauge,
        "bars": BAR,
        "specimen": SPECIMEN,
        "striker": STRIKER,
    }
    arguments |= change
    if "input_gauges" in change:
        arguments["input_gauges"] = gauge
    with pytest.raises(ri.InvalidModel, match=says):
        ri.reduce(**arguments)
