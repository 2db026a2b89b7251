"""Stepped strikers: a hidden one is found from its pulse, and shapes are met as well as can be."""

import re

import numpy as np
import pytest
from exhaustive import few_of

import rodimpact as ri

STEEL = ri.materials.steel
BAR = ri.Rod(2.0, area=3e-4, material=STEEL)
SPEED, T = 10.0, 100e-6
PEAK = 0.8 * BAR.segments[0].impedance * SPEED / 2
S = np.linspace(0, 1, 1001)
SHAPES = {
    "half sine": (ri.Signal(PEAK * np.sin(np.pi * S), S * T, unit="N"), 6.4),
    "trapezoid": (
        ri.Signal([0, PEAK, PEAK, 0], np.array([0, 0.3, 0.8, 1]) * T, unit="N"),
        8.6,
    ),
    "ramp": (ri.Signal([0, PEAK], [0, T], unit="N"), 13.0),
}
WIDE = np.exp([-4.0, 1.5])


def pulse(impedances, steps):
    """Force over Z V of the bar, one value a round trip, of a glued striker; struck end first."""
    Z = np.asarray(impedances)
    towards, away, force = np.ones(len(Z)), np.ones(len(Z)), []
    for tick in range(2 * steps):
        F = towards[0] / (1 / Z[0] + 1)
        if tick % 2 == 0:
            force.append(F)
        v = (Z[:-1] * away[:-1] + Z[1:] * towards[1:]) / (Z[:-1] + Z[1:])
        towards, away = (
            np.append(2 * v - away[:-1], away[-1]),
            np.append(towards[0] - 2 * F / Z[0], 2 * v - towards[1:]),
        )
    return np.array(force)


def areas(found):
    return np.array([piece.area for piece in found.system.bodies[0].segments])[::-1]


def hidden(seed, material=STEEL):
    ratios = np.exp(np.random.default_rng(seed).uniform(-4, 1.5, 10))
    segment = ri.Segment(1.0, BAR.segments[0].area, material)
    forces = pulse(ratios * segment.impedance / BAR.segments[0].impedance, 20)
    steps = ri.Steps(
        forces * SPEED * BAR.segments[0].impedance, np.arange(1, 20) * T / 10
    )
    found = ri.design.striker(
        steps,
        BAR,
        velocity=SPEED,
        duration=T,
        material=material,
        contact=ri.Bonded(),
        area_ratio=WIDE,
    )
    return ratios, np.abs(areas(found) / BAR.segments[0].area / ratios - 1).max(), found


def told(ratios):
    """Least change of the pulse, over Z V, for a change of the logarithms of areas by 1."""
    changes = [
        (pulse(ratios * np.exp(d), 20) - pulse(ratios * np.exp(-d), 20)) / 2e-4
        for d in 1e-4 * np.eye(10)
    ]
    return np.linalg.svd(changes)[1][-1]


@pytest.mark.parametrize("seed", few_of([*range(20), 82], (0, 1, 2, 82)))
def test_a_hidden_striker_is_found_as_well_as_its_pulse_tells(seed):
    ratios, worst, found = hidden(seed)
    assert worst < max(1e-6, 2e-14 / told(ratios))
    assert found.misfit < 1e-12


@pytest.mark.parametrize("shape", few_of(SHAPES, {"trapezoid"}))
def test_shapes_are_met_to_what_ten_steps_can(shape):
    wanted, percent = SHAPES[shape]
    found = ri.design.striker(wanted, BAR, velocity=SPEED, duration=T, area_ratio=WIDE)
    ratios = areas(found) / BAR.segments[0].area
    assert ratios.min() >= np.exp(-4) * (1 - 1e-9)
    assert ratios.max() <= np.exp(1.5) * (1 + 1e-9)
    fine = (np.arange(20_000) + 0.5) * T / 10_000
    force = ri.solve(found.system, until=2 * T).contacts[0].force(fine)
    off = (force - np.interp(fine, wanted.times, wanted.values, right=0.0)) / PEAK
    assert found.misfit == pytest.approx(np.sqrt(np.mean(off**2)), rel=1e-3)
    assert found.misfit < percent / 100
    in_steps = np.sqrt(np.mean(off.reshape(20, -1).mean(axis=1) ** 2))
    assert np.hypot(in_steps, found.staircase) == pytest.approx(found.misfit, rel=1e-3)


def test_one_misfit_is_told_everywhere():
    found = ri.design.striker(
        SHAPES["trapezoid"][0], BAR, velocity=SPEED, duration=T, segments=4
    )
    percent = f"{100 * found.misfit:.3g} %"
    assert percent in str(found)
    assert percent in ri.plot.design(found).reached.get_label()


def test_areas_at_a_limit_are_named():
    high = ri.Steps([5 * PEAK, 0.0], [T])
    found = ri.design.striker(high, BAR, velocity=SPEED, duration=T, segments=3)
    assert areas(found) == pytest.approx(9 / 4 * 3e-4)
    assert set(found.bounded.values()) == {"largest"}
    assert len(found.bounded) == len(areas(found))
    assert "largest" in str(found)
    assert "at a limit" in str(found)
    assert "at a limit" in ri.plot.design(found).reached.get_label()
    low = ri.design.striker(
        high, BAR, velocity=SPEED, duration=T, segments=3, area_ratio=(0.1, 99)
    )
    assert low.misfit < found.misfit


def test_a_single_segment_has_the_area_that_momentum_says():
    force = 0.3 * BAR.segments[0].impedance * SPEED
    wanted = ri.Steps([force, 0.0], [T])
    found = ri.design.striker(
        wanted, BAR, velocity=SPEED, duration=T, until=T, segments=1
    )
    assert areas(found) == pytest.approx([3e-4 * 0.3 / 0.7])
    assert (found.misfit, found.staircase) == pytest.approx((0, 0), abs=1e-12)
    assert found.reached.at([0, 0.5 * T, 0.99 * T]) == pytest.approx(force)
    assert not found.bounded
    assert str(found).splitlines()[-1].endswith("%")


GOOD = {"wanted": SHAPES["ramp"][0], "bar": BAR, "velocity": SPEED, "duration": T}


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"wanted": SHAPES["ramp"][0].values}, "wanted: must be a force over time"),
        (
            {"wanted": ri.Signal([0, 1], [0, T], unit="V")},
            "wanted: must be a force over time",
        ),
        (
            {"wanted": ri.Steps([1.0, np.array([1.0, 2.0])], [T])},
            "wanted: must be a force over time",
        ),
        (
            {"wanted": ri.Steps([1.0, -2.0], [T])},
            "wanted: pulls with 2.0 N, and faces only push",
        ),
        ({"wanted": ri.Steps([0.0, 1.0], [2 * T])}, "wanted: is 0 from impact on"),
        ({"bar": STEEL}, "bar: must be a Rod"),
        (
            {"bar": BAR.replace(velocity=1.0)},
            "bar: must be a single uniform rod at rest",
        ),
        (
            {"bar": ri.Rod([1.0, 2.0], area=1e-4, material=STEEL)},
            "bar: must be a single uniform rod",
        ),
        ({"material": "steel"}, "material: must be a Material"),
        (
            {"material": STEEL.replace(viscosity=1.0)},
            "material: must have no viscosity",
        ),
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
def test_what_is_no_design_is_refused(change, sentence):
    given = GOOD | change
    with pytest.raises(ValueError, match=re.escape(sentence)):
        ri.design.striker(given.pop("wanted"), given.pop("bar"), **given)
