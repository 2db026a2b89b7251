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
)

STEEL = ri.materials.steel


def rod(**changes):
    parameters = {"length": 2.0, "area": 1e-4, "material": STEEL}
    parameters.update(changes)
    return ri.Rod(**parameters)


# Samples


@pytest.mark.parametrize(
    "profile",
    [
        ri.Samples([1, 2, 3]),
        ri.Samples([0.0, 1.0], step=1e-6),
        ri.Samples([0.0, 1.0], [1e-6, 2e-6]),
        ri.Steps([1.0, 2.0], [0.5]),
        3.0,
    ],
)
def test_a_profile_survives_its_description(profile):
    described = profile if isinstance(profile, float) else profile.to_dict()
    assert profile_from(described) == profile


def test_samples_are_one_thing_and_no_family():
    row = ri.System(
        [rod(velocity=ri.Samples([0.0, 1.0, 2.0]), strain=np.zeros(5)), ri.Wall()]
    )
    assert row.shape == (5,)
    assert list(row.parameters) == ["bodies.0.strain"]
    assert row[2].bodies[0].velocity.values is row.bodies[0].velocity.values
    assert ri.System.from_dict(row.to_dict()) == row


def test_the_step_between_samples_may_be_a_family():
    drive = ri.Pushed(ri.Samples([0.0, 1.0], step=[1e-6, 2e-6]))
    row = ri.System([rod()], ends=(drive, ri.Free()))
    assert list(row.parameters) == ["ends.left.value.step"]
    assert row[1].ends[0] == ri.Pushed(ri.Samples([0.0, 1.0], step=2e-6))


# Along a rod


@pytest.mark.parametrize(
    "function",
    [
        np.sin,
        math.sin,
        lambda x: [math.sin(v) for v in x] if np.ndim(x) else math.sin(x),
        lambda x: np.array([math.sin(v) for v in x]),  # of arrays only
    ],
)
def test_functions_of_arrays_and_of_numbers_are_sampled_alike(function):
    samples = rod(velocity=function).velocity
    assert isinstance(samples, ri.Samples)
    assert samples.step is None
    places = np.linspace(0, 2.0, SAMPLES_ALONG_ROD)
    assert samples.values == pytest.approx(np.sin(places), rel=1e-15)


def test_a_constant_function_and_one_with_a_branch():
    assert rod(strain=lambda x: 1e-3).strain == ri.Samples(
        np.full(SAMPLES_ALONG_ROD, 1e-3)
    )
    values = rod(strain=lambda x: 1 if x < 1.0 else 0).strain.values
    assert values.tolist() == [1.0] * (SAMPLES_ALONG_ROD // 2) + [0.0] * (
        SAMPLES_ALONG_ROD // 2 + 1
    )


# In time


@pytest.mark.parametrize("drive", [ri.Pushed, ri.Moved])
def test_a_function_of_time_is_sampled(drive):
    value = drive(lambda t: 3 * t, duration=2e-3).value
    assert value.step == 2e-3 / (SAMPLES_IN_TIME - 1)
    assert value.values == pytest.approx(
        np.linspace(0, 6e-3, SAMPLES_IN_TIME), rel=1e-14
    )


# Mistakes

NO_SAMPLES = [
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
]
NO_PROFILES = [
    (lambda x: math.nan, "returns finite numbers, got nan at 0.0"),
    (
        lambda x: math.inf if x > 1.999 else 0.0,
        "returns finite numbers, got inf at 2.0",
    ),
    (lambda x: None, "returns numbers: must be a number of m/s, got [None, None"),
    (lambda x: [1.0, 2.0], "returns numbers, got"),
    (lambda x: 1 / 0, "cannot be evaluated: ZeroDivisionError: division by zero"),
]


@pytest.mark.parametrize(
    ("make", "wanted"),
    [
        *(
            (lambda values=values: ri.Samples(values), {"values": ""})
            for values in NO_SAMPLES
        ),
        (
            lambda: ri.Samples([1.0, math.nan, math.inf], step=0.0),
            {
                "values[1]": "=must be a finite number, got nan",
                "step": "positive number of seconds",
            },
        ),
        *(
            (
                lambda function=function: rod(velocity=function, area=1.0),
                {"velocity": said},
            )
            for function, said in NO_PROFILES
        ),
        (
            lambda: rod(length=[1.0, 2.0], velocity=np.sin),
            {"velocity": "differ in length; give Samples"},
        ),
        (
            lambda: rod(
                length=-1.0, velocity=np.sin, strain=ri.Samples([0, 1], step=1.0)
            ),
            {"length": "", "strain.step": "from end to end; leave it out"},
        ),
        (
            lambda: rod(velocity=ri.Steps([1, 2], [3.0]), strain="x"),
            {"velocity.at.0": "", "strain": ""},
        ),
        *(
            (lambda drive=drive, given=given: drive(**given), {path: said})
            for drive in (ri.Pushed, ri.Moved)
            for given, path, said in (
                ({"value": math.sin}, "duration", "is missing; give the seconds"),
                (
                    {"value": math.sin, "duration": [1.0, 2.0]},
                    "duration",
                    "single number",
                ),
                ({"value": 1.0, "duration": 1.0}, "duration", "belongs to a function"),
                ({"value": ri.Samples([0, 1])}, "value.step", "is missing"),
                (
                    {"value": lambda t: 1 / t, "duration": 1.0},
                    "value",
                    "ZeroDivisionError",
                ),
            )
        ),
    ],
)
def test_mistakes_of_profiles(make, wanted):
    assert_told(make, wanted)


def test_a_function_bears_other_sizes_than_the_length_in_a_family():
    assert (
        rod(area=[1.0, 2.0], velocity=np.sin).velocity == rod(velocity=np.sin).velocity
    )


# Turned round


def test_mirrors():
    moving = rod(velocity=ri.Samples([1.0, 2.0, 4.0]), strain=ri.Samples([0.0, 1e-3]))
    row = ri.System([moving, ri.Wall()])
    image = row.mirrored().bodies[1]
    assert image.velocity == ri.Samples([-4.0, -2.0, -1.0])
    assert image.strain == ri.Samples([1e-3, 0.0])
    assert row.mirrored().mirrored() == row
    assert row.reversed().bodies[0].velocity == ri.Samples([-1.0, -2.0, -4.0])
    assert row.reversed().reversed() == row
    image = ri.System([rod(area=ri.Samples([1.0, 2.0, 4.0]))]).mirrored().bodies[0]
    assert image.segments[0].area == ri.Samples([4.0, 2.0, 1.0])


# Between places


def integral_of_steps(steps, start, end):
    """Sum of values times widths."""
    jumps = [x for x in steps.at if start < x < end]
    total = 0.0
    for a, b in pairwise([start, *jumps, end]):
        jumps_before = [x for x in steps.at if x <= a]
        total += (b - a) * steps.values[len(jumps_before)]
    return total


def integral_of_samples(samples, start, end, length):
    """Trapezoidal rule on a grid that has every knot on it."""
    n = len(samples.values) - 1
    width = samples.step
    if width is None:
        width = length / n
    knots = width * np.arange(n + 1)
    inside = [x for x in knots if start < x < end]
    x = np.array([start, *inside, end])
    return np.trapezoid(np.interp(x, knots, samples.values), x)


def integral(profile, start, end, length):
    if isinstance(profile, ri.Steps):
        return integral_of_steps(profile, start, end)
    return integral_of_samples(profile, start, end, length)


NUMBERS = st.floats(-10, 10)
PLACES = st.lists(st.integers(0, 1000), min_size=2, max_size=8, unique=True).map(
    lambda ticks: np.array(sorted(ticks)) / 500
)  # some beyond the last of the samples in time
PROFILED = st.one_of(
    st.lists(NUMBERS, min_size=2, max_size=9).map(ri.Samples),
    st.lists(NUMBERS, min_size=2, max_size=9).map(
        lambda values: ri.Samples(values, step=0.17)
    ),
    st.tuples(
        st.lists(NUMBERS, min_size=3, max_size=3),
        st.floats(0.1, 0.9),
        st.floats(1.0, 1.9),
    ).map(lambda drawn: ri.Steps(drawn[0], drawn[1:])),
)


@given(PROFILED, PLACES)
def test_averages_are_integrals_over_widths(profile, edges):
    expected = []
    for a, b in pairwise(edges):
        expected.append(integral(profile, a, b, 2.0) / (b - a))
    means = averages(profile, edges, 2.0)
    assert means == pytest.approx(expected, rel=1e-9, abs=1e-9)
    low, high = extremes(profile)
    assert (low, high) == (min(profile.values), max(profile.values))
    assert np.all((means > low - 1e-9) & (means < high + 1e-9))


def test_a_number_is_its_own_average():
    assert averages(3.0, np.array([0.0, 0.1, 0.5]), 1.0).tolist() == [3.0, 3.0]
    assert extremes(3.0) == [3.0, 3.0]


def test_averages_of_steps_between_edges_at_their_jumps():
    steps = ri.Steps([1.0, 2.0, 4.0], at=[0.25, 0.5])
    at_jumps = averages(steps, np.array([0.0, 0.25, 0.5, 1.0]), 1.0)
    assert at_jumps.tolist() == [1.0, 2.0, 4.0]
    across_jumps = averages(steps, np.array([0.0, 0.5, 0.75]), 1.0)
    assert across_jumps.tolist() == [1.5, 4.0]
