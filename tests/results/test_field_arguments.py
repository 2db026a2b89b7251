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
TIME = 1.5e-4  # s
METHODS = ("fronts", "characteristics", "finite-difference")


@cache
def solved(method):
    """Two rods and a wall, with all that the method carries: damping, a mass, laws."""
    material = STEEL
    if method == "finite-difference":
        material = DAMPED
    bodies = [
        ri.Rod(0.4, area=1e-4, material=material, velocity=1.0),
        ri.Rod(0.7, area=2e-4, material=STEEL),
    ]
    contacts = [ri.Rigid(), ri.Rigid()]
    gaps = [0.0, 1e-3]
    if method != "fronts":
        bodies.append(ri.RigidMass(1.0))
        contacts = [ri.Hertz(1e10), ri.Hertz(2e10), ri.Spring(1e6)]
        gaps = [0.0, 0.0, 1e-3]
    row = ri.System([*bodies, ri.Wall()], contacts=contacts, gaps=gaps)
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
    """Pairs of a name and a function of times alone."""
    for name, field in fields_of(solution):
        yield name, partial(field, 0, PLACE)
    yield "wall", lambda t: solution.velocity(len(solution.system.bodies) - 1, 0, t)
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
    pint = pytest.importorskip("pint")
    return pint.application_registry.get().Quantity(number, unit)


def of_astropy(number, unit):
    return number * pytest.importorskip("astropy.units").Unit(unit)


@pytest.mark.parametrize("method", few_of(METHODS, ["fronts"]))
@pytest.mark.parametrize("quantity", few_of([of_pint, of_astropy], [of_pint]))
def test_places_and_times_with_units_are_converted(method, quantity):
    solution = solved(method)
    millimetres = np.array([100.0, 250.0])
    given_places = (
        (quantity(100.0, "mm"), 0.1),
        (quantity(millimetres, "mm"), [0.1, 0.25]),
        (quantity(millimetres[:, None], "mm"), [[0.1], [0.25]]),
        ([quantity(100.0, "mm"), quantity(0.25, "m")], [0.1, 0.25]),
    )
    for name, call in calls_with_a_place(solution):
        for value, metres in given_places:
            np.testing.assert_array_equal(call(value), call(metres), name)
    given_times = (
        (quantity(150.0, "us"), 150 * 1e-6),
        (quantity(np.array([50.0, 150.0]), "us"), [50 * 1e-6, 150 * 1e-6]),
    )
    for name, call in calls_with_a_time(solution):
        for value, seconds in given_times:
            converted = call(value)
            np.testing.assert_allclose(
                converted, call(seconds), rtol=1e-12, err_msg=name
            )
    gauge = solution.gauge(0, quantity(100.0, "mm"))
    np.testing.assert_array_equal(gauge.strain, solution.gauge(0, 0.1).strain)
    contact = solution.contacts[0]
    assert contact.law_at(quantity(150.0, "us")) == contact.law_at(TIME)
    continued = solution.system_at(quantity(150.0, "us"))
    assert continued.gaps == solution.system_at(150 * 1e-6).gaps


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
    solution = solved(method)
    for value in NO_NUMBERS:
        for _, call in calls_with_a_place(solution):
            assert refused("must|shape", call, value) == ["x"]
        for _, call in calls_with_a_time(solution):
            assert refused("must|shape", call, value) == ["t"]
        for name, call in calls_with_one_time(solution):
            argument = "t"
            if name == "signal":
                argument = "interval"
            if argument == "interval" and value is None:
                continue  # which stands for the usual one
            assert refused("must|shape", call, value) == [argument]


@pytest.mark.parametrize("method", ["characteristics", "finite-difference"])
def test_the_only_place_in_a_rigid_mass_or_a_wall_is_0(method):
    """They have no length; places and times broadcast as in rods."""
    solution = solved(method)
    mass = 2
    wall = 3
    for body in (mass, wall):
        for field in (solution.velocity, solution.displacement, solution.position):
            for value in NO_NUMBERS:
                assert refused("must|shape", field, body, value, TIME) == ["x"]
            at_places = field(body, [[0.0], [0.0]], [0.0, TIME, END])
            assert at_places.shape == (2, 3)
            np.testing.assert_array_equal(at_places[1], field(body, 0, [0, TIME, END]))
