"""Strains over many passages by images of the forces on the ends of a rod."""

import numpy as np
import pytest

import rodimpact as ri

UNTIL = 1e-3
INTERVAL = 5e-7
TO_GAUGE = 0.3
DIAMETER = 0.016


def metal(poisson_ratio):
    return ri.Material(
        "metal", youngs_modulus=2e11, density=8000.0, poisson_ratio=poisson_ratio
    )


def shot(poisson_ratio, end_stiffness=3e9, **theory):
    """A striker with round ends, an input bar, a specimen that yields, an output
    bar.
    """
    rods = []
    for length, velocity in ((0.2, 10.0), (1.0, 0.0), (1.0, 0.0)):
        rods.append(
            ri.Rod(
                length,
                diameter=DIAMETER,
                material=metal(poisson_ratio),
                velocity=velocity,
                **theory,
            )
        )
    specimen = ri.Yielding(stiffness=2e8, yield_force=1e4, hardening=1e7)
    return ri.System(rods, contacts=[ri.Hertz(end_stiffness), specimen])


def by_images(solution, body, distance=TO_GAUGE):
    """Strain at a distance from the left end of a body."""
    zeros = ri.Signal(np.ones(4), dt=INTERVAL)
    record = ri.Measured(zeros, (body, 0.0), distance=distance, passages="all")
    return record.place.strain(solution, INTERVAL)


def rms_over_peak(difference, signal):
    return np.sqrt(np.mean(difference**2)) / np.abs(signal.values).max()


@pytest.mark.parametrize("body", [1, 2])
def test_without_dispersion_images_are_the_waves_of_characteristics(body):
    solution = ri.solve(shot(0.0), until=UNTIL)
    strain = solution.gauge(body, TO_GAUGE).signal(INTERVAL)
    images = by_images(solution, body)
    assert rms_over_peak(images.values - strain.values, strain) < 5e-4


def test_images_follow_a_theory_of_dispersion_over_several_passages():
    """Mindlin and Herrmann's equations on a grid, with the same forces."""
    row = shot(0.3, end_stiffness=3e10, lateral_inertia="mindlin-herrmann")
    solution = ri.solve(row, until=UNTIL, method="finite-difference", cells=700)
    strain = solution.gauge(1, TO_GAUGE).signal(INTERVAL)
    images = by_images(solution, 1)
    by_characteristics = ri.solve(shot(0.3, end_stiffness=3e10), until=UNTIL)
    undispersed = by_characteristics.gauge(1, TO_GAUGE).signal(INTERVAL)
    difference = rms_over_peak(images.values - strain.values, strain)
    assert difference < 1e-2
    without_dispersion = rms_over_peak(undispersed.values - strain.values, strain)
    assert without_dispersion > 1.8 * difference


def test_the_first_passage_is_the_propagated_force():
    solution = ri.solve(shot(0.3), until=UNTIL)
    rod = solution.system.bodies[1]
    times = np.arange(0.0, 3e-4, INTERVAL)
    stiffness = 2e11 * np.pi * DIAMETER**2 / 4
    sent = ri.Signal(-solution.contacts[0].force(times) / stiffness, times)
    passing = sent.extended(1e-4, 1e-4).propagated(TO_GAUGE, rod)
    images = by_images(solution, 1)
    before_return = images.window(0.0, 1.65 / 5000.0)
    difference = before_return.values - passing.at(before_return.times)
    assert np.abs(difference).max() < 2e-6


def test_a_fit_of_three_passages_finds_the_striker():
    """The same record, taken as one passage, has a large misfit."""
    true_row = shot(0.3)
    record = by_images(ri.solve(true_row, until=UNTIL), 1).window(0.0, 6e-4)
    vary = {"bodies.0.velocity": (5.0, 20.0)}
    known = {"gauge": (1, 0.0), "distance": TO_GAUGE, "shift": 0.0, "gain": 1.0}
    misfits = {}
    for passages in ("first", "all"):
        measured = ri.Measured(record, passages=passages, **known)
        best = ri.fit(true_row, measured, vary, UNTIL, starts=1)
        misfits[passages] = best.misfits[0]
    assert best.values["bodies.0.velocity"] == pytest.approx(10.0, rel=1e-6)
    assert misfits["all"] < 1e-6
    assert misfits["first"] > 0.1


def test_a_rod_whose_end_is_held_has_no_images():
    held = ri.System(shot(0.3).bodies[:2], ends=[ri.Free(), ri.Fixed()])
    solution = ri.solve(held, until=UNTIL)
    with pytest.raises(ri.InvalidModel, match=r"ends\.1: must be free, or touch"):
        by_images(solution, 1)
    with pytest.raises(ri.InvalidModel, match="passages: must be one of"):
        ri.Measured(ri.Signal(np.ones(4), dt=1e-6), (1, 0.0), passages="both")
