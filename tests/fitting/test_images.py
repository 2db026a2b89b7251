"""Strains over many passages by images of the forces on the ends of a rod.

The wave that a force on an end sends passes the gauge, is reflected at the other end,
and passes again. The strain at the gauge is that of all these passages: of the wave of
the force and of its mirror images, each one dispersed along the distance that it has
run. A fit computes it when `passages="all"`.
"""

import numpy as np
import pytest

import rodimpact as ri

UNTIL = 1e-3  # s
INTERVAL = 5e-7  # of a record, s
TO_GAUGE = 0.3  # m, from the left end of a rod
DIAMETER = 0.016  # m
STRIKER_VELOCITY = 10.0  # m/s


def metal(poisson_ratio):
    """A metal whose bar speed is 5000 m/s."""
    return ri.Material(
        "metal", youngs_modulus=2e11, density=8000.0, poisson_ratio=poisson_ratio
    )


def shot(poisson_ratio, end_stiffness=3e9, **theory):
    """System of a striker with round ends, an input bar, a specimen that yields, and an
    output bar; it is not solved. `theory` holds other arguments of each rod.
    """
    rods = []
    for length, velocity in [(0.2, STRIKER_VELOCITY), (1.0, 0.0), (1.0, 0.0)]:
        rod = ri.Rod(
            length,
            diameter=DIAMETER,
            material=metal(poisson_ratio),
            velocity=velocity,
            **theory,
        )
        rods.append(rod)
    round_ends = ri.Hertz(end_stiffness)
    specimen = ri.Yielding(stiffness=2e8, yield_force=1e4, hardening=1e7)
    return ri.System(rods, contacts=[round_ends, specimen])


def strain_by_images(solution, body):
    """Strain `TO_GAUGE` from the left end of a body as a fit computes it, a Signal."""
    # A fit asks the record where its strain is; the values of the record do not matter.
    any_values = ri.Signal(np.ones(4), dt=INTERVAL)
    left_end = (body, 0.0)
    record = ri.Measured(any_values, left_end, distance=TO_GAUGE, passages="all")
    return record.place.strain(solution, INTERVAL)


def relative_difference(signal, reference):
    """Root mean square of the difference of two signals, over the peak of the second
    one.
    """
    difference = signal.values - reference.values
    rms = np.sqrt(np.mean(difference**2))
    peak = np.abs(reference.values).max()
    return rms / peak


@pytest.mark.parametrize("body", [1, 2])
def test_without_dispersion_images_are_the_waves_of_characteristics(body):
    """The strain is compared with that of a gauge of the run, over 1 ms."""
    row = shot(poisson_ratio=0.0)
    solution = ri.solve(row, until=UNTIL)
    gauge = solution.gauge(body, TO_GAUGE)
    strain = gauge.signal(INTERVAL)

    images = strain_by_images(solution, body)

    assert relative_difference(images, strain) < 5e-4


@pytest.mark.exhaustive
def test_images_follow_a_theory_of_dispersion_better_than_undispersed_waves():
    """The theory is Mindlin and Herrmann's, on a grid; the images use its forces."""
    theory = {"lateral_inertia": "mindlin-herrmann"}
    dispersive = shot(poisson_ratio=0.3, end_stiffness=3e10, **theory)
    on_grid = ri.solve(dispersive, until=UNTIL, method="finite-difference", cells=700)
    strain = on_grid.gauge(1, TO_GAUGE).signal(INTERVAL)
    without_theory = shot(poisson_ratio=0.3, end_stiffness=3e10)
    by_characteristics = ri.solve(without_theory, until=UNTIL)
    gauge = by_characteristics.gauge(1, TO_GAUGE)
    undispersed = gauge.signal(INTERVAL)

    images = strain_by_images(on_grid, body=1)

    difference = relative_difference(images, strain)
    without_dispersion = relative_difference(undispersed, strain)
    assert difference < 1e-2
    # Dispersion is seen in this shot: without it the difference is much larger.
    assert without_dispersion > 1.8 * difference


def test_the_first_passage_is_the_propagated_force():
    """Until the wave is back, the strain by images is that of the force on the end of
    the rod, propagated to the gauge.
    """
    row = shot(poisson_ratio=0.3)
    solution = ri.solve(row, until=UNTIL)
    rod = solution.system.bodies[1]
    wave_speed = 5000.0  # m/s, sqrt(2e11/8000)
    times = np.arange(0.0, 3e-4, INTERVAL)
    stiffness = 2e11 * np.pi * DIAMETER**2 / 4  # E A, N
    force = solution.contacts[0].force(times)
    sent = ri.Signal(-force / stiffness, times)
    longer = sent.extended(1e-4, 1e-4)
    passing = longer.propagated(TO_GAUGE, rod)

    images = strain_by_images(solution, body=1)

    # The wave is back at the gauge after 0.3 m and twice the other 0.7 m: 1.7 m.
    before_return = images.window(0.0, 1.65 / wave_speed)
    expected = passing.at(before_return.times)
    difference = before_return.values - expected
    assert np.abs(difference).max() < 2e-6


@pytest.mark.exhaustive
def test_a_fit_of_all_passages_finds_the_velocity_and_one_of_the_first_misfits():
    """The record holds three passages of the wave past the gauge."""
    true_row = shot(poisson_ratio=0.3)
    solution = ri.solve(true_row, until=UNTIL)
    strain = strain_by_images(solution, body=1)
    record = strain.window(0.0, 6e-4)
    vary = {"bodies.0.velocity": (5.0, 20.0)}
    known = {"gauge": (1, 0.0), "distance": TO_GAUGE, "shift": 0.0, "gain": 1.0}
    misfits = {}
    velocities = {}

    for passages in ("first", "all"):
        measured = ri.Measured(record, passages=passages, **known)
        best = ri.fit(true_row, measured, vary, UNTIL, starts=1)
        misfits[passages] = best.misfits[0]
        velocities[passages] = best.values["bodies.0.velocity"]

    assert velocities["all"] == pytest.approx(STRIKER_VELOCITY, rel=1e-6)
    assert misfits["all"] < 1e-6
    assert misfits["first"] > 0.1


def test_a_rod_whose_end_is_held_has_no_images():
    """`strain_by_images` of a bar with a fixed far end is refused at the path of this
    end.
    """
    striker, bar, _ = shot(poisson_ratio=0.3).bodies
    held = ri.System([striker, bar], ends=[ri.Free(), ri.Fixed()])
    solution = ri.solve(held, until=UNTIL)

    with pytest.raises(ri.InvalidModel, match=r"ends\.1: must be free, or touch"):
        strain_by_images(solution, body=1)


def test_passages_other_than_first_and_all_are_refused():
    signal = ri.Signal(np.ones(4), dt=1e-6)
    with pytest.raises(ri.InvalidModel, match="passages: must be one of"):
        ri.Measured(signal, (1, 0.0), passages="both")
