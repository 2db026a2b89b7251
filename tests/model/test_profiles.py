"""Profiles along a rod and in time: what they say, and how functions become samples."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mistakes import assert_told

import rodimpact as ri
from rodimpact.model.profiles import (
    SAMPLES_ALONG_ROD,
    SAMPLES_IN_TIME,
    averages,
    extremes,
    profile_from,
    scaled,
)

STEEL = ri.materials.steel


def rod(**changes):
    """A rod 2 m long, with these parameters changed or added."""
    parameters = {"length": 2.0, "area": 1e-4, "material": STEEL}
    parameters.update(changes)
    return ri.Rod(**parameters)


# Samples
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "profile",
    [
        ri.Samples([1, 2, 3]),
        ri.Samples([0.0, 1.0], step=1e-6),
        ri.Samples([0.0, 1.0], [1e-6, 2e-6]),
        ri.Steps([1.0, 2.0], [0.5]),
    ],
)
def test_a_profile_survives_its_description(profile):
    assert profile_from(profile.to_dict()) == profile


def test_a_number_is_a_profile():
    assert profile_from(3.0) == 3.0


def test_values_of_samples_make_no_family_and_are_shared_by_members():
    """A rod with sampled velocity and five strains is a family of five over the strain;
    members share the samples, and the family survives `to_dict`.
    """
    velocity = ri.Samples([0.0, 1.0, 2.0])
    strains = np.zeros(5)  # of five members
    rods = rod(velocity=velocity, strain=strains)

    system = ri.System([rods, ri.Wall()])

    assert system.shape == (5,)
    assert list(system.parameters) == ["bodies.0.strain"]
    rod_of_family = system.bodies[0]
    rod_of_member = system[2].bodies[0]
    assert rod_of_member.velocity.values is rod_of_family.velocity.values
    restored = ri.System.from_dict(system.to_dict())
    assert restored == system


def test_the_step_between_samples_may_be_a_family():
    """Forces at an end with two sample steps make a family of two: the path of the step
    is its parameter, and the second member has the second step.
    """
    forces = ri.Samples([0.0, 1.0], step=[1e-6, 2e-6])
    row = ri.System([rod()], ends=(ri.Pushed(forces), ri.Free()))
    forces_of_second = ri.Samples([0.0, 1.0], step=2e-6)
    left_end_of_second = row[1].ends[0]
    assert list(row.parameters) == ["ends.left.value.step"]
    assert left_end_of_second == ri.Pushed(forces_of_second)


# Along a rod
# --------------------------------------------------------------------------------------


def sine_as_list(x):
    """A list of numbers for an array or list, a number for a number."""
    if np.ndim(x) == 0:
        return math.sin(x)
    return [math.sin(value) for value in x]


def sine_of_arrays_only(x):
    """An array; a single number is refused, as it is no sequence."""
    return np.array([math.sin(value) for value in x])


@pytest.mark.parametrize(
    "function", [np.sin, math.sin, sine_as_list, sine_of_arrays_only]
)
def test_functions_of_arrays_and_of_numbers_are_sampled_alike(function):
    """sin as a function of arrays, or of single numbers, becomes the same samples along
    a rod.
    """
    samples = rod(velocity=function).velocity
    places = np.linspace(0, 2.0, SAMPLES_ALONG_ROD)
    expected = np.sin(places)
    assert isinstance(samples, ri.Samples)
    assert samples.step is None
    assert samples.values == pytest.approx(expected, rel=1e-15)


def test_a_constant_function_makes_equal_samples():
    constant = 1e-3
    strain = rod(strain=lambda x: constant).strain
    values = np.full(SAMPLES_ALONG_ROD, constant)
    assert strain == ri.Samples(values)


def test_a_function_with_a_branch_is_sampled_place_by_place():
    """A comparison of a whole array would have no truth."""
    strain = rod(strain=lambda x: 1 if x < 1.0 else 0).strain
    half = SAMPLES_ALONG_ROD // 2
    first_half = [1.0] * half
    second_half = [0.0] * (half + 1)  # with the sample in the middle
    assert strain.values.tolist() == first_half + second_half


# In time
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize("drive", [ri.Pushed, ri.Moved])
def test_a_function_of_time_is_sampled(drive):
    """A drive given as a function becomes `SAMPLES_IN_TIME` equal steps over its
    duration.
    """
    duration = 2e-3  # s
    samples = drive(lambda t: 3 * t, duration=duration).value
    last_value = 3 * duration
    expected = np.linspace(0, last_value, SAMPLES_IN_TIME)
    assert samples.step == duration / (SAMPLES_IN_TIME - 1)
    assert samples.values == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    "values",
    [
        1.0,
        [],
        [1.0],
        [[1.0, 2.0], [3.0, 4.0]],
        "12",
        None,
        ["a", "b"],
        [True, False],
        {},
        [1, [2]],
    ],
)
def test_samples_are_a_list_of_two_numbers_or_more(values):
    assert_told(lambda: ri.Samples(values), {"values": ""})


def test_numbers_of_samples_are_finite_and_their_step_positive():
    """`Samples` with nan, inf and a step of 0 is refused with the first wrong value and
    the step.
    """
    values = [1.0, math.nan, math.inf]
    messages = {
        "values[1]": "=must be a finite number, got nan",
        "step": "positive number of seconds",
    }
    assert_told(lambda: ri.Samples(values, step=0.0), messages)


# Mistakes
# --------------------------------------------------------------------------------------


def infinite_at_the_end(x):
    """Finite but at the end of a rod of 2 m."""
    return math.inf if x > 1.999 else 0.0


@pytest.mark.parametrize(
    ("function", "message"),
    [
        pytest.param(
            lambda x: math.nan, "returns finite numbers, got nan at 0.0", id="nan"
        ),
        pytest.param(
            infinite_at_the_end, "returns finite numbers, got inf at 2.0", id="inf"
        ),
        pytest.param(
            lambda x: None,
            "returns numbers: must be a number of m/s, got [None, None",
            id="None",
        ),
        pytest.param(lambda x: [1.0, 2.0], "returns numbers, got", id="list"),
        pytest.param(
            lambda x: 1 / 0,
            "cannot be evaluated: ZeroDivisionError: division by zero",
            id="division by zero",
        ),
    ],
)
def test_functions_that_make_no_profile_are_refused(function, message):
    assert_told(lambda: rod(velocity=function, area=1.0), {"velocity": message})


@pytest.mark.parametrize(
    ("changes", "messages"),
    [
        pytest.param(
            {"length": [1.0, 2.0], "velocity": np.sin},
            {"velocity": "differ in length; give Samples"},
            id="a family of lengths",
        ),
        pytest.param(
            {
                "length": -1.0,
                "velocity": np.sin,
                "strain": ri.Samples([0, 1], step=1.0),
            },
            {"length": "", "strain.step": "from end to end; leave it out"},
            id="a step along a rod",
        ),
        pytest.param(
            {"velocity": ri.Steps([1, 2], [3.0]), "strain": "x"},
            {"velocity.at.0": "", "strain": ""},
            id="a jump beyond the rod",
        ),
    ],
)
def test_profiles_that_do_not_fit_their_rod_are_refused(changes, messages):
    assert_told(lambda: rod(**changes), messages)


@pytest.mark.parametrize("drive", [ri.Pushed, ri.Moved])
@pytest.mark.parametrize(
    ("arguments", "path", "message"),
    [
        ({"value": math.sin}, "duration", "is missing; give the seconds"),
        ({"value": math.sin, "duration": [1.0, 2.0]}, "duration", "single number"),
        ({"value": 1.0, "duration": 1.0}, "duration", "belongs to a function"),
        ({"value": ri.Samples([0, 1])}, "value.step", "is missing"),
        ({"value": lambda t: 1 / t, "duration": 1.0}, "value", "ZeroDivisionError"),
    ],
)
def test_mistakes_of_drives_are_refused(drive, arguments, path, message):
    assert_told(lambda: drive(**arguments), {path: message})


def test_a_function_is_taken_in_families_whose_rods_do_not_differ_in_length():
    family = rod(area=[1.0, 2.0], velocity=np.sin)
    assert family.velocity == rod(velocity=np.sin).velocity


# Turned round
# --------------------------------------------------------------------------------------


@pytest.fixture
def sampled():
    """A rod with samples of velocity and strain before a wall."""
    velocity = ri.Samples([1.0, 2.0, 4.0])
    strain = ri.Samples([0.0, 1e-3])
    return ri.System([rod(velocity=velocity, strain=strain), ri.Wall()])


def test_mirrors_turn_samples(sampled):
    """The mirrored rod has its sampled velocities negated and in reverse order, and its
    strains in reverse order. Mirrored twice, the system is itself.
    """
    image = sampled.mirrored().bodies[1]
    assert image.velocity == ri.Samples([-4.0, -2.0, -1.0])
    assert image.strain == ri.Samples([1e-3, 0.0])
    assert sampled.mirrored().mirrored() == sampled


def test_samples_change_sign_when_time_is_turned_round(sampled):
    back = sampled.reversed()
    assert back.bodies[0].velocity == ri.Samples([-1.0, -2.0, -4.0])
    assert back.reversed() == sampled


def test_the_error_of_a_scaled_profile_is_scaled_too():
    """Samples and polynomials scaled by a factor have its absolute value as the factor
    of their errors.
    """
    samples = ri.Samples([1.0, 2.0], error=0.25)
    polynomials = ri.Polynomials([[1.0, 2.0]], error=0.5)

    scaled_samples = scaled(samples, -2.0)
    scaled_polynomials = scaled(polynomials, 3.0)

    assert scaled_samples == ri.Samples([-2.0, -4.0], error=0.5)
    assert scaled_polynomials == ri.Polynomials([[3.0, 6.0]], error=1.5)


def test_scaled_steps_keep_their_places():
    steps = ri.Steps([1.0, 2.0], [0.5])
    assert scaled(steps, 3.0) == ri.Steps([3.0, 6.0], [0.5])


def test_a_number_is_scaled_as_a_profile():
    assert scaled(1.5, 2.0) == 3.0


def test_mirrors_turn_tapers():
    """The mirror image of a tapered rod has its areas in reverse order."""
    area = ri.Samples([1.0, 2.0, 4.0])
    tapered = ri.System([rod(area=area)])
    image = tapered.mirrored().bodies[0]
    (segment,) = image.segments
    assert segment.area == ri.Samples([4.0, 2.0, 1.0])


# Between places
# --------------------------------------------------------------------------------------


def integral_of_steps(steps, start, end):
    """Integral of a step profile from start to end: the sum of values times widths."""
    jumps = [x for x in steps.at if start < x < end]
    total = 0.0
    for a, b in pairwise([start, *jumps, end]):
        # The value between two jumps has the number of the jumps before it.
        jumps_before = [x for x in steps.at if x <= a]
        value = steps.values[len(jumps_before)]
        total += value * (b - a)
    return total


def integral_of_samples(samples, start, end, length):
    """Integral of piecewise linear samples from start to end, by the trapezoidal rule.
    Samples without a step of their own are spread evenly over the `length`.
    """
    n = len(samples.values) - 1
    width = samples.step
    if width is None:
        width = length / n
    knots = width * np.arange(n + 1)
    inside = [x for x in knots if start < x < end]
    x = np.array([start, *inside, end])
    values = np.interp(x, knots, samples.values)
    return np.trapezoid(values, x)


LENGTH = 2.0  # m
THOUSANDTHS = st.lists(st.integers(0, 1000), min_size=2, max_size=8, unique=True)
PLACES = THOUSANDTHS.map(lambda parts: np.array(sorted(parts)) / 1000 * LENGTH)
"""Some lie beyond the last of the samples in time."""
NUMBERS = st.floats(-10, 10)
VALUES = st.lists(NUMBERS, min_size=2, max_size=9)
THREE_VALUES = st.lists(NUMBERS, min_size=3, max_size=3)
TWO_PLACES = st.tuples(st.floats(0.1, 0.9), st.floats(1.0, 1.9))
PROFILES = st.one_of(
    st.builds(ri.Samples, VALUES),
    st.builds(ri.Samples, VALUES, step=st.just(0.17)),
    st.builds(ri.Steps, THREE_VALUES, TWO_PLACES),
)


@given(PROFILES, PLACES)
def test_averages_are_integrals_over_widths_and_lie_between_the_extremes(
    profile, edges
):
    """The averages of a random profile between edges are its integrals over the widths,
    and lie between the extremes, which are the smallest and largest value.
    """
    expected = []
    for start, end in pairwise(edges):
        if isinstance(profile, ri.Steps):
            integral = integral_of_steps(profile, start, end)
        else:
            integral = integral_of_samples(profile, start, end, LENGTH)
        mean = integral / (end - start)
        expected.append(mean)

    means = averages(profile, edges, LENGTH)
    low, high = extremes(profile)

    assert means == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert low == min(profile.values)
    assert high == max(profile.values)
    round_off = 1e-9
    assert np.all(means > low - round_off)
    assert np.all(means < high + round_off)


def test_a_number_is_its_own_average():
    """The means of a uniform profile over two intervals, and both its extremes, are its
    number.
    """
    edges = np.array([0.0, 0.1, 0.5])
    means = averages(3.0, edges, length=1.0)
    assert means.tolist() == [3.0, 3.0]
    assert extremes(3.0) == [3.0, 3.0]


def test_averages_of_steps_with_edges_at_their_jumps_and_across_them():
    """Averages of a step profile between edges: its values if edges are jumps, weighted
    means otherwise.
    """
    steps = ri.Steps([1.0, 2.0, 4.0], at=[0.25, 0.5])
    edges_at_jumps = np.array([0.0, 0.25, 0.5, 1.0])
    edges_across_jumps = np.array([0.0, 0.5, 0.75])
    at_jumps = averages(steps, edges_at_jumps, length=1.0)
    across_jumps = averages(steps, edges_across_jumps, length=1.0)
    assert at_jumps.tolist() == [1.0, 2.0, 4.0]
    assert across_jumps.tolist() == [1.5, 4.0]
