"""The first lines of a reduction say what the shot shows, and what contradicts it."""

import math
import re
import warnings

import numpy as np
import pytest
from exhaustive import few_of
from records import shots
from records.shots import BAR, INPUT_BAR, OUTPUT_BAR, SPECIMEN, STEEL

import rodimpact as ri


@pytest.fixture(scope="module")
def shot():
    """A solved `Shot` that runs for 1.2 ms."""
    return shots.pressure_bar_shot(until=1.2e-3)


def reduced(shot, bar=BAR, specimen=SPECIMEN, seed=0, **options):
    """Reduction of the records of two gauges with noise."""
    on_input = shot.gauge(INPUT_BAR, 0.75, seed=seed)
    on_output = shot.gauge(OUTPUT_BAR, 0.75, seed=seed + 1)
    return ri.reduce(on_input, on_output, bar, specimen, **options)


def bar_with(modulus):
    """The bar with this Young's modulus, Pa, in place of its own."""
    material = STEEL.replace(youngs_modulus=modulus)
    segment = BAR.segments[0]
    changed = segment.replace(material=material)
    return BAR.replace(segments=[changed])


def test_the_verdict_is_that_of_the_computed_specimen(shot):
    """Peak stress, strain there, energy and mean strain rate are those of the run until
    its largest stress.
    """
    result = reduced(shot)
    verdict = result.verdict

    times = result.times
    stress_of_run = shot.stress(times)
    peak = int(stress_of_run.argmax())
    times = times[: peak + 1]
    stress = shot.stress(times)
    strain = shot.strain(times)
    peak_stress = stress[peak]
    strain_at_peak = strain[peak]
    strain_rate = np.gradient(strain, times)
    is_on_plateau = stress >= 0.7 * peak_stress
    plateau_rate = strain_rate[is_on_plateau].mean()
    work_per_volume = np.trapezoid(stress, strain)
    volume = SPECIMEN.section * SPECIMEN.length
    energy = work_per_volume * volume
    assert str(result).startswith(str(verdict))
    assert verdict.peak_stress == pytest.approx(peak_stress, rel=0.01)
    assert verdict.strain_at_peak == pytest.approx(strain_at_peak, rel=0.01)
    assert verdict.energy == pytest.approx(energy, rel=0.02)
    assert verdict.mean_strain_rate == pytest.approx(plateau_rate, rel=0.03)


def test_from_the_strain_that_the_verdict_names_on_the_true_forces_balance(shot):
    """The verdict names the strain from which a shot is in equilibrium. Beyond 1.5 times
    this strain, the forces on both faces in the simulated shot differ by less than 5 %
    in the median.
    """
    result = reduced(shot)
    verdict = result.verdict

    assert verdict.in_equilibrium
    assert 0.002 < verdict.equilibrium_from < 0.02
    strain = shot.strain(result.times)
    is_in_equilibrium = strain > 1.5 * verdict.equilibrium_from
    times = result.times[is_in_equilibrium]
    input_contact, output_contact = shot.solution.contacts
    input_force = input_contact.force(times)
    output_force = output_contact.force(times)
    difference = np.abs(input_force - output_force)
    imbalance = difference / output_force
    assert np.median(imbalance) < 0.05


def test_good_shots_raise_no_doubt(shot):
    """Four reductions with different noise have no doubts, say that the specimen was in
    equilibrium, and print no "doubtful".
    """
    for seed in range(4):
        result = reduced(shot, seed=2 * seed)
        assert result.doubts == ()
        assert result.verdict.in_equilibrium
        assert "doubtful" not in str(result)


def test_a_shot_out_of_equilibrium_has_no_strain_of_equilibrium():
    """Waves need 50 us to cross a soft long specimen; the pulse is over after 60 us."""
    soft = ri.Material("soft", youngs_modulus=1e8, density=1000.0, poisson_ratio=0.3)
    shot = shots.pressure_bar_shot(duration=30e-6, rise=20e-6, material=soft, cells=450)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ri.DoubtfulReduction)
        result = reduced(shot)
    verdict = result.verdict
    assert verdict.in_equilibrium is not True  # False, or None: it cannot be judged
    assert math.isnan(verdict.equilibrium_from)
    assert "equilibrium is reached" not in str(result)


@pytest.mark.exhaustive
def test_a_soft_specimen_cannot_be_judged():
    """A shot at a soft specimen: the verdict has None for equilibrium, and its text
    says why it cannot be judged.
    """
    soft = ri.Material("soft", youngs_modulus=3e8, density=1100.0, poisson_ratio=0.3)
    shot = shots.pressure_bar_shot(material=soft, cells=450)
    verdict = reduced(shot).verdict
    assert verdict.in_equilibrium is None
    assert "equilibrium cannot be judged: F1 is the difference" in str(verdict)


@pytest.mark.parametrize("factor", few_of([0.92, 0.97, 1.03, 1.1], [0.97]))
def test_a_modulus_that_contradicts_the_echo_is_doubted(shot, factor):
    """With the modulus that the doubt names as its remedy there is no doubt."""
    true_modulus = STEEL.youngs_modulus
    wrong_bar = bar_with(factor * true_modulus)
    with pytest.warns(ri.DoubtfulReduction):
        doubts = reduced(shot, wrong_bar).doubts
    (doubt,) = [each for each in doubts if "comes back from the far end" in each]
    _, after = doubt.split("youngs_modulus=")
    number, *_ = after.split(" GPa")
    modulus_named = 1e9 * float(number)
    right_bar = bar_with(modulus_named)
    result = reduced(shot, right_bar)
    assert modulus_named == pytest.approx(true_modulus, rel=2e-3)
    assert result.doubts == ()


def test_an_alignment_states_its_limit_and_the_balance_over_all_loading(shot):
    """The text tells by how much waves may be moved, and which way the reflected one
    was.
    """
    elastic = SPECIMEN.replace(youngs_modulus=6e9)
    result = reduced(shot, specimen=elastic, align_within=3e-6)
    text = str(result)
    assert result.alignment.limit == 3e-6
    assert 0 < result.alignment.imbalance_after < 0.02
    assert "aligned by the start of loading alone, up to half of the" in text
    shift_reflected, _ = result.shifts
    direction = "earlier" if shift_reflected >= 0 else "later"
    moved = re.findall("wave taken [^,]* (earlier|later), transmitted", text)
    assert moved == [direction]


def test_without_an_alignment_none_is_stated(shot):
    result = reduced(shot)
    assert result.alignment is None


def test_an_alignment_that_makes_the_balance_worse_is_doubted(shot):
    """A modulus that is wrong by a factor of three pulls the waves apart."""
    stiff = SPECIMEN.replace(youngs_modulus=2e9)
    with pytest.warns(ri.DoubtfulReduction, match="makes the balance over all loading"):
        result = reduced(shot, specimen=stiff, align_within=20e-6)
    unaligned = reduced(shot)
    input_force = unaligned.input_force[unaligned.loading]
    output_force = unaligned.output_force[unaligned.loading]
    mean_force = (input_force + output_force).mean() / 2
    difference = np.abs(input_force - output_force).mean()
    imbalance = difference / mean_force
    imbalance_before = result.alignment.imbalance_before
    assert imbalance_before == pytest.approx(imbalance)
    assert result.alignment.imbalance_after > 0.05


def test_the_table_has_round_strains_and_the_peak(shot):
    """The printed reduction has rows for strains of 0.5, 1, 2 and 5 %, in this order,
    and one row for the peak stress.
    """
    result = reduced(shot)
    lines = str(result).splitlines()
    rows = [line for line in lines if " 1/s " in line[:40]]
    strains = [row.split("  ")[0] for row in rows]
    (peak,) = [line for line in lines if "(peak)" in line]
    peak_stress = result.verdict.peak_stress / 1e6  # MPa
    assert strains[:4] == ["0.5 %", "1 %", "2 %", "5 %"]
    assert f"{peak_stress:.4g} MPa" in peak


def test_a_mean_is_printed_as_a_table(shot):
    """The mean of three shots prints a title with the peak stress, heads, and rows for
    strains from 0.5 % on.
    """
    results = [reduced(shot, seed=seed) for seed in (0, 2, 4)]
    mean = ri.mean_of_shots(results)
    lines = str(mean).splitlines()
    title, heads, *rows = lines
    strains = [row.split("  ")[0] for row in rows]
    assert title.startswith("mean of 3 shots: peak stress 42")  # 42. MPa
    assert heads.split() == ["strain", "strain", "rate", "mean", "stress", "scatter"]
    assert strains[:4] == ["0.5 %", "1 %", "2 %", "5 %"]
    assert repr(mean).startswith("<MeanCurve of 3 shots")
