"""Stepped strikers: a hidden one is found from its pulse, and shapes are met."""

import re
from typing import NamedTuple

import numpy as np
import pytest
from exhaustive import few_of
from numpy.random import default_rng

import rodimpact as ri

STEEL = ri.materials.steel
BAR_AREA = 3e-4  # m^2
BAR = ri.Rod(2.0, area=BAR_AREA, material=STEEL)
BAR_IMPEDANCE = BAR.segments[0].impedance
SPEED = 10.0  # m/s
T = 100e-6  # duration of a pulse, s
PEAK = 0.8 * BAR_IMPEDANCE * SPEED / 2
WIDE = (np.exp(-4.0), np.exp(1.5))  # limits of area over that of the bar, for any lathe
STEPS = 10  # segments of a hidden striker


class Shape(NamedTuple):
    """A wanted pulse, and a bound of the misfit that ten steps leave."""

    wanted: ri.Signal
    misfit_percent: float


def half_sine():
    """Half a sine of force, a signal in N."""
    phase = np.linspace(0, 1, 1001)
    force = PEAK * np.sin(np.pi * phase)
    return ri.Signal(force, phase * T, unit="N")


def trapezoid():
    """A force that rises, stays and falls, a signal in N."""
    times = [0, 0.3 * T, 0.8 * T, T]
    force = [0, PEAK, PEAK, 0]
    return ri.Signal(force, times, unit="N")


def ramp():
    """A force that rises from 0 to the end, a signal in N."""
    return ri.Signal([0, PEAK], [0, T], unit="N")


SHAPES = {
    "half sine": Shape(half_sine(), 6.4),
    "trapezoid": Shape(trapezoid(), 8.6),
    "ramp": Shape(ramp(), 13.0),
}


def designed(wanted, **options):
    """Design of a striker for the bar, with the common speed and duration."""
    return ri.design.striker(wanted, BAR, velocity=SPEED, duration=T, **options)


def areas(design):
    """Areas of the segments of the designed striker, m^2, from its struck end
    backwards.
    """
    striker = design.system.bodies[0]
    values = [segment.area for segment in striker.segments]
    from_left = np.array(values)
    return from_left[::-1]


# A hidden striker


def pulse(impedances, steps):
    """Force over Z V of the bar, one value a round trip, of a bonded striker.

    This is a solver of its own: waves in the striker are followed from one segment to
    the next, all with equal transit times. A tick is that transit time.

    Parameters
    ----------
    impedances : array
        Impedances over that of the bar, from the struck end on.
    steps : int
        Round trips.

    Returns
    -------
    array
        Forces [steps].
    """
    Z = np.asarray(impedances)
    # Waves in each segment by the velocity that they would give a free end, over V.
    towards_bar = np.ones(len(Z))
    away = np.ones(len(Z))
    forces = []
    sums = Z[:-1] + Z[1:]
    for tick in range(2 * steps):
        force = towards_bar[0] / (1 / Z[0] + 1)
        if tick % 2 == 0:
            forces.append(force)
        from_left = Z[:-1] * away[:-1]
        from_right = Z[1:] * towards_bar[1:]
        joint_velocity = (from_left + from_right) / sums
        back_from_bar = towards_bar[0] - 2 * force / Z[0]
        back_from_free_end = away[-1]
        back_from_joints = 2 * joint_velocity - away[:-1]
        through_joints = 2 * joint_velocity - towards_bar[1:]
        towards_bar = np.append(back_from_joints, back_from_free_end)
        away = np.append(back_from_bar, through_joints)
    return np.array(forces)


def sensitivity(ratios):
    """Least change of the pulse, over Z V, for a change of the logarithms of areas by
    1.

    It is the least singular value of the derivatives, by central differences.
    """
    step = 1e-4  # of a logarithm
    changes = []
    for change in step * np.eye(len(ratios)):
        factor = np.exp(change)
        larger = pulse(ratios * factor, 2 * STEPS)
        smaller = pulse(ratios / factor, 2 * STEPS)
        slope = (larger - smaller) / (2 * step)
        changes.append(slope)
    _, singular_values, _ = np.linalg.svd(changes)
    return singular_values[-1]


@pytest.mark.parametrize("seed", few_of([*range(10), 82], [0]))
def test_a_hidden_striker_is_found_as_well_as_its_pulse_tells(seed):
    """A striker is designed for the pulse of a random striker, and has its areas. An
    area on which the pulse hardly depends is found with that much less accuracy.
    """
    rng = default_rng(seed)
    smallest, largest = np.log(WIDE)
    exponents = rng.uniform(smallest, largest, STEPS)
    ratios = np.exp(exponents)  # of areas to the bar's
    forces = pulse(ratios, 2 * STEPS) * SPEED * BAR_IMPEDANCE
    round_trip = T / STEPS
    edges = np.arange(1, 2 * STEPS) * round_trip
    wanted = ri.Steps(forces, edges)

    design = designed(wanted, contact=ri.Bonded(), area_ratio=WIDE)

    ratios_found = areas(design) / BAR_AREA
    errors = np.abs(ratios_found / ratios - 1)
    amplified_round_off = 2e-14 / sensitivity(ratios)
    assert errors.max() < max(1e-6, amplified_round_off)
    assert design.misfit < 1e-12


# Shapes


def root_mean_square(values):
    """Root of the mean square of an array."""
    mean_square = np.mean(values**2)
    return np.sqrt(mean_square)


@pytest.mark.exhaustive
@pytest.mark.parametrize("shape", SHAPES)
def test_shapes_are_met_within_the_limits_by_the_misfit_that_is_stated(shape):
    """Areas keep to their limits, and the stated misfit is that of the force of a run."""
    wanted, misfit_percent = SHAPES[shape]

    design = designed(wanted, area_ratio=WIDE)

    smallest, largest = WIDE
    ratios = areas(design) / BAR_AREA
    assert ratios.min() >= smallest * (1 - 1e-9)
    assert ratios.max() <= largest * (1 + 1e-9)

    # 10,000 middles of intervals in a pulse, and as many after it
    interval = T / 10_000
    times = (np.arange(20_000) + 0.5) * interval
    solution = ri.solve(design.system, until=2 * T)
    force = solution.contacts[0].force(times)
    wanted_force = np.interp(times, wanted.times, wanted.values, right=0.0)
    difference = (force - wanted_force) / PEAK
    misfit = root_mean_square(difference)
    assert design.misfit == pytest.approx(misfit, rel=1e-3)
    assert design.misfit < misfit_percent / 100

    # A striker of ten steps makes a staircase, whose steps can at best have the mean of
    # the wanted force: the misfit is that of the means and that of any staircase.
    differences_of_steps = difference.reshape(20, -1)  # ten in a pulse, ten after it
    step_means = differences_of_steps.mean(axis=1)
    misfit_of_means = root_mean_square(step_means)
    total = np.hypot(misfit_of_means, design.staircase)
    assert total == pytest.approx(design.misfit, rel=1e-3)


def test_one_misfit_is_shown_everywhere():
    """The text and the picture of a design name the same percentage."""
    wanted = SHAPES["trapezoid"].wanted

    design = designed(wanted, segments=4)

    picture = ri.plot.design(design)
    percent = f"{100 * design.misfit:.3g} %"
    assert percent in str(design)
    assert percent in picture.reached.get_label()


def test_areas_at_a_limit_are_reported_in_the_design_and_in_its_picture():
    """A wanted force too high for the default limit makes all areas the largest."""
    high = ri.Steps([5 * PEAK, 0.0], [T])

    design = designed(high, segments=3)

    picture = ri.plot.design(design)
    default_limit = 9 / 4 * BAR_AREA
    areas_found = areas(design)
    assert areas_found == pytest.approx(default_limit)
    assert set(design.bounded.values()) == {"largest"}
    assert len(design.bounded) == len(areas_found)
    assert "largest" in str(design)
    assert "at a limit" in str(design)
    assert "at a limit" in picture.reached.get_label()


@pytest.mark.exhaustive
def test_wider_limits_bring_the_pulse_nearer():
    """A striker of three segments is designed for a pulse that is too high: with a
    wider range of areas the misfit is smaller.
    """
    high = ri.Steps([5 * PEAK, 0.0], [T])

    narrow = designed(high, segments=3)
    wide = designed(high, segments=3, area_ratio=(0.1, 99))

    assert wide.misfit < narrow.misfit


def test_a_single_segment_has_the_area_of_the_momentum():
    """A constant force F is made by the impedance Z with F = Z Zbar/(Z + Zbar) V."""
    force = 0.3 * BAR_IMPEDANCE * SPEED
    area = BAR_AREA * 0.3 / 0.7
    wanted = ri.Steps([force, 0.0], [T])

    design = designed(wanted, until=T, segments=1)

    times = [0, 0.5 * T, 0.99 * T]
    reached = design.reached.at(times)
    *_, last_line = str(design).splitlines()
    assert areas(design) == pytest.approx([area])
    assert abs(design.misfit) < 1e-12
    assert abs(design.staircase) < 1e-12
    assert reached == pytest.approx(force)
    assert not design.bounded
    assert last_line.endswith("%")  # no line on limits follows that of the misfit


# Mistakes


RAMP = SHAPES["ramp"].wanted
VALID = {"wanted": RAMP, "bar": BAR, "velocity": SPEED, "duration": T}
VOLTS = ri.Signal([0, 1], [0, T], unit="V")
FAMILY = ri.Steps([1.0, np.array([1.0, 2.0])], [T])
PULLING = ri.Steps([1.0, -2.0], [T])
LATE = ri.Steps([0.0, 1.0], [2 * T])
MOVING_BAR = BAR.replace(velocity=1.0)
BARS = ri.Rod([1.0, 2.0], area=1e-4, material=STEEL)
VISCOUS = STEEL.replace(viscosity=1.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"wanted": RAMP.values}, "wanted: must be a force over time"),
        ({"wanted": VOLTS}, "wanted: must be a force over time"),
        ({"wanted": FAMILY}, "wanted: must be a force over time"),
        ({"wanted": PULLING}, "wanted: pulls with 2.0 N, and faces only push"),
        ({"wanted": LATE}, "wanted: is 0 from impact on"),
        ({"bar": STEEL}, "bar: must be a Rod"),
        ({"bar": MOVING_BAR}, "bar: must be a single uniform rod at rest"),
        ({"bar": BARS}, "bar: must be a single uniform rod"),
        ({"material": "steel"}, "material: must be a Material"),
        ({"material": VISCOUS}, "material: must have no viscosity"),
        (
            {"velocity": -1.0},
            "velocity: must be a finite positive number of m/s, got -1.0",
        ),
        ({"duration": [T, T]}, "duration: must be a single number"),
        (
            {"until": T / 2},
            "until: must be from the duration, 0.0001 s, to 20 times that, got 5e-05",
        ),
        ({"segments": 0}, "segments: must be a whole number from 1 to 50, got 0"),
        ({"area_ratio": 0.5}, "area_ratio: must be (smallest, largest), got 0.5"),
        ({"contact": ri.Spring(1e8)}, "contact: must be Rigid() or Bonded()"),
    ],
)
def test_invalid_arguments_are_refused(change, message):
    arguments = VALID | change

    with pytest.raises(ValueError, match=re.escape(message)):
        ri.design.striker(**arguments)
