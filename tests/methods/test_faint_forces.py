"""Forces that decay for ever count as zero from some time on: the error of durations
says so.
"""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

import rodimpact as ri

UNIT = ri.Material("unit", youngs_modulus=1.0, density=1.0)


def long_contact(area, length):
    """A short thick rod that pushes a long one: its force decays by a factor each round
    trip.
    """
    short = ri.Rod(1.0, area=area, material=UNIT, velocity=1.0)
    return ri.System([short, ri.Rod(float(length), area=1.0, material=UNIT)])


@given(st.fractions(1, 8), st.integers(2, 30))
def test_the_stated_error_of_durations_covers_the_exact_one(area, length):
    solution = ri.solve(long_contact(float(area), length))
    values = {"bodies.0.impedance": area, "bodies.0.transit_time": 1}
    values |= {"bodies.1.impedance": 1, "bodies.1.transit_time": length}
    exact = ri.exact(solution.system, values)
    spans = exact.contact_times[0]
    true_duration = sum(float(end - begin) for begin, end in spans)
    tally = solution.outcome.contacts[0]
    stated = solution.accuracy.get("duration", 0.0) * tally.duration
    assert abs(true_duration - tally.duration) <= stated * (1 + 1e-12) + 1e-12
    late = abs(float(spans[-1][1]) - tally.last)
    assert late <= solution.accuracy.get("time", 0.0) * 2 * length * (1 + 1e-12) + 1e-9
    assert ("decays" in solution.status) == (stated > 0)


def test_a_decaying_force_is_cut_off_with_a_sentence():
    solution = ri.solve(long_contact(1.2, 20))
    assert solution.outcome.contacts[0].duration == pytest.approx(28.0)
    assert solution.accuracy["duration"] * 28 == pytest.approx(12.0)
    assert "it may last up to 12 s longer" in solution.status


def test_waves_that_cancel_end_a_force_without_an_error():
    left = ri.Rod(0.4, area=1.0, material=UNIT, velocity=1.0)
    right = ri.Rod(1.0, area=1.0, material=UNIT)
    assert ri.solve(ri.System([left, right])).accuracy == {}


def test_a_force_that_decays_for_ever_has_no_known_duration():
    """A short thick rod stays against a bar without an end."""
    system = long_contact(1.2, 2).replace(ends=(ri.Free(), ri.Absorbing()))
    solution = ri.solve(system)
    assert solution.final
    assert solution.accuracy["duration"] == math.inf
    assert "it may go on for ever" in solution.status
