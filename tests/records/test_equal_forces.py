"""Equal forces on both faces: one gauge a bar where waves overlap, and direct impact."""

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
    """The incident wave lasts 530 us; the reflected one is at the gauge after 200 us."""
    return shots.pressure_bar_shot(**LONG_PULSE)


def reduced(shot, distance=0.5, seed=0, bar=BAR, **changes):
    gauges = (
        shot.gauge(0, distance, seed=seed),
        shot.gauge(2, distance, seed=seed + 1),
    )
    specimen = SPECIMEN.replace(**changes)
    return ri.reduce(*gauges, bar, specimen, equal_forces=True)


def law_errors(shot, result, least=0.03):
    """Relative errors of the stress at strains from `least` on, while loading."""
    strain = shot.strain(result.times)
    peak = int(strain.argmax())
    strains = np.linspace(least, 0.97 * strain.max(), 200)
    truth = np.interp(strains, strain[:peak], shot.stress(result.times)[:peak])
    return result.at_strain(strains, result.stress) / truth - 1


def is_loading(shot, result, least=0.01):
    strain = shot.strain(result.times)
    return (strain > least) & (np.arange(len(strain)) <= strain.argmax())


@pytest.mark.parametrize("distance", few_of([0.25, 0.5], [0.5]))
def test_overlapping_waves_are_separated(shot, distance):
    with pytest.raises(ValueError, match="the reflected wave reaches the gauge before"):
        ri.reduce(shot.gauge(0, distance), shot.gauge(2, distance), BAR, SPECIMEN)
    result = reduced(shot, distance)
    strain = shot.strain(result.times)
    loading = is_loading(shot, result)
    error = np.abs(result.strain - strain)[loading].max()
    assert error < 0.01 * strain.max()
    assert np.sqrt(np.mean(law_errors(shot, result) ** 2)) < 0.01
    stress = shot.stress(result.times)[loading]
    relative = result.stress[loading] / stress - 1
    assert np.sqrt(np.mean(relative**2)) < 0.01
    assert result.doubts == ()


def test_bands_cover_the_truth_of_overlapping_waves(shot):
    covered = []
    for seed in range(0, 12, 2):  # `reduced` takes the next one, too
        result = reduced(shot, seed=seed)
        loading = is_loading(shot, result)
        stress_error = np.abs(result.stress - shot.stress(result.times))
        strain_error = np.abs(result.strain - shot.strain(result.times))
        covered.append(
            [
                np.mean((stress_error <= result.stress_band)[loading]),
                np.mean((strain_error <= result.strain_band)[loading]),
            ]
        )
    assert np.all(np.mean(covered, axis=0) > 0.93)


def test_the_output_bar_returns_the_wave_from_its_free_end(shot):
    """The curve goes on after the wave is back at the gauge, 400 us after it passed."""
    result = reduced(shot)
    round_trip = 2 * 1.0 / shots.STEEL.wave_speed
    assert result.times[-1] - result.times[0] > 2 * round_trip
    late = result.times > result.times[0] + 1.3 * round_trip
    force = shot.solution.contacts[1].force(result.times[late])
    assert np.abs(result.output_force[late] - force).max() < 0.04 * force.max()


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
    """The level at rest is subtracted, so an offset of the amplifier changes nothing."""
    gauges = [shot.gauge(0, 0.5), shot.gauge(2, 0.5, seed=1)]
    plain = ri.reduce(*gauges, BAR, SPECIMEN, equal_forces=True)
    gauges[0] = gauges[0].replace(signal=gauges[0].signal + 5e-5)
    moved = ri.reduce(*gauges, BAR, SPECIMEN, equal_forces=True)
    assert moved.strain == pytest.approx(plain.strain, abs=1e-9)


@pytest.mark.parametrize("is_rigid", [False, True])
def test_the_law_of_a_direct_impact(is_rigid):
    """A specimen that yields at 133 MPa and hardens, hit by a rod or by a rigid mass."""
    shot = shots.direct_impact_on_law(is_rigid)
    striker = STRIKER
    if is_rigid:
        striker = ri.RigidMass(STRIKER.mass, velocity=12.0)
    result = ri.reduce(
        output_gauges=shot.gauge(0.5), bars=BAR, specimen=SPECIMEN, striker=striker
    )
    errors = law_errors(shot, result)
    assert np.sqrt(np.mean(errors**2)) < 0.01
    assert np.median(np.abs(errors)) < 0.005
    strain = shot.strain(result.times)
    loading = is_loading(shot, result)
    strain_error = np.abs(result.strain - strain)
    assert strain_error[loading].max() < 0.01 * strain.max()
    assert np.mean((strain_error <= result.strain_band)[loading]) > 0.95
    stress_error = np.abs(result.stress - shot.stress(result.times))
    assert np.mean((stress_error <= result.stress_band)[loading]) > 0.95
    assert result.doubts == ()
    assert "momentum of the striker" in str(result.verdict)


def test_a_rod_is_no_rigid_mass():
    """The wave in a striker of 0.4 m goes to and fro in 159 us."""
    shot = shots.direct_impact_on_law()
    mass = ri.RigidMass(STRIKER.mass, velocity=12.0)
    gauges = shot.gauge(0.5)
    rod, rigid = (
        ri.reduce(output_gauges=gauges, bars=BAR, specimen=SPECIMEN, striker=striker)
        for striker in (STRIKER, mass)
    )
    strain = shot.strain(rod.times).max()
    assert rod.strain.max() == pytest.approx(strain, rel=0.01)
    assert rigid.strain.max() != pytest.approx(strain, rel=0.03)


def test_a_specimen_out_of_equilibrium_is_outside_the_assumptions():
    """The verdict tells from which strain on equal forces are to be expected."""
    shot = shots.direct_impact()
    result = ri.reduce(
        output_gauges=shot.gauge(2, 0.5),
        bars=BAR,
        specimen=SPECIMEN.replace(wave_speed=1118.0),
        striker=STRIKER,
    )
    assert "equilibrium is assumed" in str(result.verdict)
    strain_named = (
        float(str(result.verdict).split("expect it from ")[1].split(" %")[0]) / 100
    )
    before = np.abs(law_errors(shot, result, least=0.005))
    after = np.abs(law_errors(shot, result, least=3 * strain_named))
    assert before.max() > 0.2
    assert np.sqrt(np.mean(after**2)) < 0.02


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
    gauges = {
        "two": [shot.gauge(0, 0.5), shot.gauge(0, 0.6)],
        "near": shot.gauge(0, 0.0),
    }
    arguments = {
        "input_gauges": shot.gauge(0, 0.5),
        "output_gauges": shot.gauge(2, 0.5),
        "bars": BAR,
        "specimen": SPECIMEN,
        "equal_forces": True,
    }
    arguments |= change
    name = arguments["input_gauges"]
    if isinstance(name, str):
        arguments["input_gauges"] = gauges[name]
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
