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
    trip, of 2 s, until the wave in the long one is back.
    """
    short = ri.Rod(1.0, area=area, material=UNIT, velocity=1.0)
    long = ri.Rod(float(length), area=1.0, material=UNIT)
    return ri.System([short, long])


@given(st.fractions(1, 8), st.integers(2, 30))
def test_stated_errors_cover_those_of_the_duration_and_of_the_last_force(area, length):
    """Duration and last time of a `long_contact` differ from those of `ri.exact` by
    their stated errors at most. The status says that the force decays exactly if an
    error is stated.
    """
    values = {
        "bodies.0.impedance": area,
        "bodies.0.transit_time": 1,
        "bodies.1.impedance": 1,
        "bodies.1.transit_time": length,
    }

    system = long_contact(float(area), length)
    solution = ri.solve(system)
    exact = ri.exact(solution.system, values)

    spans = exact.contact_times[0]  # begin and end of each of the forces
    durations = [float(end - begin) for begin, end in spans]
    exact_duration = sum(durations)
    _, exact_last = spans[-1]
    accuracy = solution.accuracy  # empty where nothing is stated
    contact = solution.outcome.contacts[0]
    longest_time = 2 * length  # s, until the wave in the long rod is back
    duration_bound = accuracy.get("duration", 0.0) * contact.duration
    time_bound = accuracy.get("time", 0.0) * longest_time
    round_off = 1e-12
    duration_error = abs(exact_duration - contact.duration)
    assert duration_error <= duration_bound * (1 + round_off) + round_off
    error_of_last = abs(float(exact_last) - contact.last)
    assert error_of_last <= time_bound * (1 + round_off) + 1e-9
    says_that_it_decays = "decays" in solution.status
    assert says_that_it_decays == (duration_bound > 0)


def test_a_decaying_force_is_cut_off_with_a_sentence():
    """A force falls to (1.2 - 1)/(1.2 + 1) = 1/11 in each round trip of 2 s: after 28 s
    it is 3e-15 and counts as none, though it would last for 40 s. The stated error of
    the duration is the difference, and the status names it.
    """
    cut_off = 28.0  # s
    end = 40.0
    system = long_contact(area=1.2, length=20)

    solution = ri.solve(system)

    duration = solution.outcome.duration
    assert duration == pytest.approx(cut_off)
    stated = solution.accuracy["duration"] * duration
    assert stated == pytest.approx(end - cut_off)
    assert "it may last up to 12 s longer" in solution.status


def test_nothing_is_stated_of_a_force_that_waves_end_by_cancelling():
    """The force of equal impedances ends when the wave in the shorter rod is back."""
    left = ri.Rod(0.4, area=1.0, material=UNIT, velocity=1.0)
    right = ri.Rod(1.0, area=1.0, material=UNIT)
    system = ri.System([left, right])

    solution = ri.solve(system)

    assert solution.accuracy == {}


def test_a_force_that_decays_for_ever_has_no_known_duration():
    """A short thick rod stays against a bar without an end."""
    ends = (ri.Free(), ri.Absorbing())
    contact = long_contact(area=1.2, length=2)
    system = contact.replace(ends=ends)

    solution = ri.solve(system)

    assert solution.final
    assert solution.accuracy["duration"] == math.inf
    assert "it may go on for ever" in solution.status
