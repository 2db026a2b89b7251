"""Places and times of every field and record: converted by their unit, alike by every
method.
"""

import datetime
from fractions import Fraction
from functools import cache, partial

import numpy as np
import pytest
from exhaustive import few_of
from mistakes import refused

import rodimpact as ri

STEEL = ri.materials.steel
DAMPED = STEEL.damped(loss_factor=0.02, frequency=1e3)
END = 4e-4  # s
PLACE = 0.1  # m
TIME = 1.5e-4  # s, that is 150 us
METHODS = ("fronts", "characteristics", "finite-difference")


@cache
def solved(method):
    """The solution, to `END`, of two rods and a wall, with all that the method carries.

    Fronts carry rigid contacts; characteristics a mass (body 2) and laws as well; a
    grid also damping.
    """
    material = STEEL
    if method == "finite-difference":
        material = DAMPED
    striker = ri.Rod(0.4, area=1e-4, material=material, velocity=1.0)
    struck = ri.Rod(0.7, area=2e-4, material=STEEL)
    if method == "fronts":
        bodies = [striker, struck, ri.Wall()]
        contacts = [ri.Rigid(), ri.Rigid()]
        gaps = [0.0, 1e-3]
    else:
        bodies = [striker, struck, ri.RigidMass(1.0), ri.Wall()]
        contacts = [ri.Hertz(1e10), ri.Hertz(2e10), ri.Spring(1e6)]
        gaps = [0.0, 0.0, 1e-3]
    row = ri.System(bodies, gaps, contacts)
    return ri.solve(row, until=END, method=method)


def fields_of(solution):
    """All fields: pairs of a name and a function of body, place and time."""
    for owner in (solution, solution.fields):
        for name in ("velocity", "strain", "displacement"):
            yield name, getattr(owner, name)
    for name in ("stress", "axial_force", "position"):
        yield name, getattr(solution, name)
    yield "strain_rate", solution.fields.strain_rate


def calls_with_a_place(solution):
    """Pairs of a name and a function of places alone."""
    for name, field in fields_of(solution):
        yield name, lambda x, field=field: field(0, x, TIME)


def calls_with_a_time(solution):
    """Yield pairs of a name and a function of times alone: fields, motions, energy and
    the records of a contact and a gauge of the solution.
    """
    for name, field in fields_of(solution):
        yield name, partial(field, 0, PLACE)
    wall = len(solution.system.bodies) - 1
    yield "wall", lambda t: solution.velocity(wall, 0, t)
    yield "momentum", lambda t: solution.fields.momentum(0, t)
    yield "mean_velocity", lambda t: solution.mean_velocity(0, t)
    yield "energy", lambda t: solution.energy(t).strain
    contact = solution.contacts[0]
    for name in ("force", "gap", "impulse_until", "work_until"):
        yield name, getattr(contact, name)
    yield "strain_at", solution.gauge(0, PLACE).strain_at
    if solution.run.coarser:
        yield "field_error", lambda t: solution.field_error(t).stress


def calls_with_one_time(solution):
    """Pairs of a name and a function of a single time, or of an interval of time."""
    yield "law_at", solution.contacts[0].law_at
    yield "system_at", solution.system_at
    yield "signal", solution.gauge(0, PLACE).signal


def of_pint(number, unit):
    """A number or array with its unit, as pint has it."""
    pint = pytest.importorskip("pint")
    registry = pint.application_registry.get()
    return registry.Quantity(number, unit)


def of_astropy(number, unit):
    """A number or array with its unit, as astropy has it."""
    units = pytest.importorskip("astropy.units")
    return number * units.Unit(unit)


every_method = pytest.mark.parametrize("method", few_of(METHODS, ["fronts"]))
every_package = pytest.mark.parametrize(
    "quantity", few_of([of_pint, of_astropy], [of_pint])
)


@every_method
@every_package
def test_places_with_units_are_converted(method, quantity):
    """Every field and a gauge have the same values for positions in mm, or in several
    units, as for numbers in metres. One position, a list, and a column are given.
    """
    solution = solved(method)
    millimetres = np.array([100.0, 250.0])
    one_place = quantity(100.0, "mm")
    places = quantity(millimetres, "mm")
    column = quantity(millimetres[:, None], "mm")
    mixed_units = [quantity(100.0, "mm"), quantity(0.25, "m")]
    same_places = (
        (one_place, 0.1),
        (places, [0.1, 0.25]),
        (column, [[0.1], [0.25]]),
        (mixed_units, [0.1, 0.25]),
    )
    for name, call in calls_with_a_place(solution):
        for with_unit, metres in same_places:
            converted = call(with_unit)
            np.testing.assert_array_equal(converted, call(metres), name)
    gauge = solution.gauge(0, one_place)
    np.testing.assert_array_equal(gauge.strain, solution.gauge(0, 0.1).strain)


@every_method
@every_package
def test_times_with_units_are_converted(method, quantity):
    """Every field, record and contact has the same values for times in us as for
    numbers in seconds, for one time and for several.
    """
    solution = solved(method)
    one_time = quantity(150.0, "us")
    times = quantity(np.array([50.0, 150.0]), "us")
    same_times = ((one_time, TIME), (times, [50 * 1e-6, TIME]))
    for name, call in calls_with_a_time(solution):
        for with_unit, seconds in same_times:
            converted = call(with_unit)
            expected = call(seconds)
            np.testing.assert_allclose(converted, expected, rtol=1e-12, err_msg=name)
    contact = solution.contacts[0]
    assert contact.law_at(one_time) == contact.law_at(TIME)
    assert solution.system_at(one_time).gaps == solution.system_at(TIME).gaps


NO_NUMBERS = [
    "0.1",
    b"1",
    None,
    0.1j,
    True,
    datetime.datetime(2020, 1, 1, tzinfo=datetime.UTC),
    datetime.timedelta(seconds=1e-4),
    np.datetime64("2020-01-01"),
    np.timedelta64(100, "us"),
    np.array([100], "timedelta64[us]"),
    np.array([True]),
    ["0.1"],
    [[0.1], [0.1, 0.2]],
    {},
    {0.1},
    object(),
    len,
    np.ma.array([0.1], mask=[True]),
    10**400,
    float("nan"),
    float("inf"),
    -0.1,
    Fraction(37, 10),  # outside the bodies, and after the end
]


@pytest.mark.parametrize("method", few_of(METHODS, ["fronts"]))
def test_what_is_no_place_or_time_is_refused_by_the_name_of_the_argument(method):
    """Each of `NO_NUMBERS` is refused by every field as x, as t, or, by `signal`, as
    interval; None for an interval stands for the usual one and is not tried.
    """
    solution = solved(method)
    for value in NO_NUMBERS:
        for _, call in calls_with_a_place(solution):
            assert refused("must|shape", call, value) == ["x"]
        for _, call in calls_with_a_time(solution):
            assert refused("must|shape", call, value) == ["t"]
        for name, call in calls_with_one_time(solution):
            is_interval = name == "signal"
            if is_interval and value is None:
                continue  # which stands for the usual one
            argument = "interval" if is_interval else "t"
            assert refused("must|shape", call, value) == [argument]


@pytest.mark.parametrize("method", ["characteristics", "finite-difference"])
def test_the_only_place_in_a_rigid_mass_or_a_wall_is_0(method):
    """A mass and a wall have no length: what is no number is refused as x, and x = 0
    broadcasts with times as in rods.
    """
    solution = solved(method)
    mass = 2
    wall = 3
    times = [0.0, TIME, END]
    for body in (mass, wall):
        for field in (solution.velocity, solution.displacement, solution.position):
            for value in NO_NUMBERS:
                assert refused("must|shape", field, body, value, TIME) == ["x"]
            at_one_place = field(body, 0, times)
            at_two_places = field(body, [[0.0], [0.0]], times)
            assert at_two_places.shape == (2, 3)
            np.testing.assert_array_equal(at_two_places[1], at_one_place)
