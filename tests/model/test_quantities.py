"""A quantity is converted by its own unit or refused; labels are never taken for
positions.
"""

import array
import datetime
import math
import re
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest
from exhaustive import few_of
from mistakes import problems

import rodimpact as ri
from rodimpact.fitting.parameters import checked_bounds
from rodimpact.model.frozen import Frozen
from rodimpact.model.quantities import _library_spelling, floats

STEEL = ri.materials.steel
UNITS = {  # factor to the unit of the SI, and that one as all libraries read it
    "mm": (1e-3, "m"),
    "cm^2": (1e-4, "m**(2)"),
    "cm^4": (1e-8, "m**(4)"),
    "GPa": (1e9, "Pa"),
    "g/cm^3": (1e3, "kg/m**(3)"),
    "mPa s": (1e-3, "Pa*s"),
    "kHz": (1e3, "Hz"),
    "%": (1e-2, ""),
    "km/s": (1e3, "m/s"),
    "g": (1e-3, "kg"),
    "cm/s^2": (1e-2, "m/s**(2)"),
    "ms": (1e-3, "s"),
    "kN": (1e3, "N"),
    "kN/mm": (1e6, "N/m"),
    "N s/mm": (1e3, "N*s/m"),
    "mV": (1e-3, "V"),
    "GN/m^1.5": (1e9, "N/m**(1.5)"),
    "s/mm": (1e3, "s/m"),
    "g/s": (1e-3, "kg/s"),
    "N ms": (1e-3, "N*s"),
    "1/mm": (1e3, "1/m"),
    "rad/ms": (1e3, "rad/s"),
    "rad/mm": (1e3, "rad/m"),
    "kN/N": (1e3, ""),
}
OTHER = {field: unit for unit, (_, field) in reversed(UNITS.items())}
"""A unit other than that of the SI, for each of the fields."""
EXAMPLES = [
    STEEL,
    ri.Segment(0.4, 1e-4, STEEL, polar_moment=1e-9, lateral_inertia="rayleigh-love"),
    ri.RigidMass(1.0),
    ri.Wall(),
    ri.Rod(0.4, area=1e-4, material=STEEL),
    ri.System([ri.Rod(0.4, area=1e-4, material=STEEL)]),
    ri.Rigid(0.5),
    ri.Joint(1.0),
    ri.Spring(1.0),
    ri.SpringDashpot(1.0, 0.0),
    ri.Hertz(1.0),
    ri.HuntCrossley(1.0, 0.0),
    ri.PowerLaw(1.0, 1.5),
    ri.Yielding(1e9, 1.0),
    ri.SmithToe(1e5, 1e-3),
    ri.Cushion(1e8, 0.5),
    ri.Soil(1e5, 1e-3),
    ri.Drag(1e3),
    ri.Tabulated([1.0], [1.0]),
    ri.Pushed(1.0),
    ri.Moved(1.0),
    ri.Incoming(0.0),
    ri.Samples([0.0, 1.0], step=1.0),
    ri.Polynomials([0.0, 1.0, 2.0, 3.0], [0.5]),
    ri.Steps([1.0], []),
]
SINGLE = [
    ri.waves.Bar(5e3, 0.3, 1.0),
    ri.Bridge("half", gauge_factor=2.0, excitation=1.0, poisson_ratio=0.3),
    ri.BarGauge(ri.Signal([0.0, 1.0], dt=1.0), 0.5),
    ri.Specimen(5e-3, area=1e-4, youngs_modulus=1e11),
    ri.Measured(ri.Signal([0.0, 1.0], dt=1.0), (1, 0.5), radius=1.0),
    ri.Options(),
]
"""Of these no number can be an array."""
APART = {
    "gaps": "a list",
    "diameter": "becomes an area",
    "exponent": "is at least 1",
    **dict.fromkeys(("values", "at", "compression", "force"), "a list"),
}
"""Fields that are tried by hand, in `FIELDS`."""


def declared(examples):
    """Every number that the classes of the examples declare: how to set it, and a
    unit.
    """
    for example in examples:
        kind = type(example)
        for name, field in kind.fields.items():
            # The power of such a unit is another number.
            has_variable_unit = re.search(r"\^\(?[a-z]", field.unit)
            if name in APART or has_variable_unit:
                continue

            def replaced(value, example=example, name=name):
                changed = example.replace(**{name: value})
                return getattr(changed, name)

            unit = OTHER[_library_spelling(field.unit)]
            yield f"{kind.__name__}.{name}", (replaced, unit)


def refuses(make, value, message):
    """Whether `make(value)` raises ValueError with a sentence that matches `message`;
    False if the value is taken.
    """
    try:
        make(value)
    except ValueError as error:
        sentence = str(error)
        return re.search(message, sentence) is not None
    return False


def taken_by(fields, value_for, message):
    """Names of the fields that do not refuse a value, by their unit, with this
    message.
    """
    taken = []
    for name, (make, unit) in fields.items():
        if not refuses(make, value_for(unit), message):
            taken.append(name)
    return taken


def loss_factor_of(material, frequency):
    """Loss factor of a viscous material at a frequency, Hz: 2 pi f viscosity/E."""
    return 2 * math.pi * frequency * material.viscosity / material.youngs_modulus


def radius_of(law):
    """Radius, m, of a sphere of steel on a flat of steel with this Hertz contact."""
    of_1_metre = ri.Hertz.from_radii(1.0, math.inf, STEEL, STEEL)
    ratio = law.stiffness / of_1_metre.stiffness
    return ratio**2


PULSE = ri.Signal([0.0, 1.0, 1.0], dt=1.0, unit="V")
FLYING = ri.System([ri.Rod(0.4, area=1e-4, material=STEEL, velocity=1.0)])
FLOWN = ri.solve(FLYING, until=5e-3)


def swept(**gauges_and_times):
    """Sweep of `FLYING`, with gauges of it at these times."""
    return ri.sweep(FLYING, until=5e-3, **gauges_and_times)


FIELDS = {
    "diameter": (lambda q: ri.Segment(0.4, diameter=q, material=STEEL).area, "mm"),
    "exponent": (lambda q: ri.PowerLaw(1.0, q).exponent, "kN/N"),
    "compression": (lambda q: ri.Tabulated([q], [1.0]).compression[0], "mm"),
    "force": (lambda q: ri.Tabulated([1.0], [q]).force[0], "kN"),
    "rod": (lambda q: ri.Rod(q, area=1e-4, material=STEEL).length, "mm"),
    "stepped rod": (
        lambda q: ri.Rod(q, area=ri.Steps([1, 2], [1e-9]), material=STEEL).length,
        "mm",
    ),
    "loss factor": (lambda q: loss_factor_of(STEEL.damped(q, 1.0), 1.0), "%"),
    "frequency": (lambda q: 1 / loss_factor_of(STEEL.damped(1, q), 1.0), "kHz"),
    "radius": (
        lambda q: radius_of(ri.Hertz.from_radii(q, math.inf, STEEL, STEEL)),
        "mm",
    ),
    "gap": (lambda q: ri.System([*FLYING.bodies, ri.Wall()], [q]).gaps[0], "mm"),
    "a force's duration": (
        lambda q: ri.Pushed(lambda t: t, duration=q).value.values[-1],
        "ms",
    ),
    "a function's force": (
        lambda q: ri.Pushed(lambda t: q, duration=1.0).value.values[-1],
        "kN",
    ),
    "samples": (lambda q: ri.Samples([0.0, q]).values[1], "%"),
    "steps": (lambda q: ri.Steps([0.0, q], at=[1.0]).values[1], "%"),
    "places": (lambda q: ri.Steps([0.0, 1.0], at=[q]).at[0], "%"),
    "rigid.reduced_mass": (lambda q: ri.rigid.reduced_mass(q, math.inf), "g"),
    "rigid.collide": (
        lambda q: -ri.rigid.collide(1.0, q, 1.0, 0.0, 1.0).relative_velocity_before,
        "km/s",
    ),
    "rigid restitution": (
        lambda q: ri.rigid.collide(1.0, 1.0, 1.0, 0.0, q).relative_velocity_after,
        "%",
    ),
    "rigid.stack_drop": (
        lambda q: ri.rigid.stack_drop([1.0], [1.0], q).top_height,
        "mm",
    ),
    "theory impedance": (
        lambda q: ri.theory.rod_on_wall(q, 1.0, 1.0).peak_force,
        "g/s",
    ),
    "theory time": (lambda q: ri.theory.rod_on_wall(1.0, q, 1.0).duration / 2, "ms"),
    "theory taper": (lambda q: ri.theory.horn_frequency(1.0, 0.0, q), "1/mm"),
    "theory frequency": (
        lambda q: 1 / ri.theory.kelvin_voigt_decay(1e30, 1.0, q),
        "rad/ms",
    ),
    "signal": (lambda q: ri.Signal([0.0, q], dt=1.0, unit="V").values[1], "mV"),
    "signal's times": (lambda q: ri.Signal([0.0, 1.0], [0.0, q]).times[1], "ms"),
    "signal's step": (lambda q: ri.Signal([0.0, 1.0], dt=q).times[1], "ms"),
    "signal's start": (lambda q: ri.Signal([0.0, 1.0], dt=1.0, start=q).start, "ms"),
    "signal's delay": (lambda q: PULSE.shifted(q).start, "ms"),
    "signal at": (lambda q: PULSE.at(q), "ms"),
    "signal's offset": (lambda q: PULSE.as_measured(offset=q).values[0], "mV"),
    "measured gauge": (lambda q: ri.Measured(PULSE, gauge=(1, q)).gauge[1], "mm"),
    "measured level": (
        lambda q: ri.Measured(PULSE, gauge=(1, 0.5), level=q).size,
        "mV",
    ),
    "measured shift": (
        lambda q: ri.Measured(PULSE, gauge=(1, 0.5), shift=q).limits["shift"][1],
        "ms",
    ),
    "measured gain": (
        lambda q: ri.Measured(PULSE, gauge=(1, 0.5), gain=q).limits["gain"][1],
        "%",
    ),
    "measured blur": (
        lambda q: ri.Measured(PULSE, gauge=(1, 0.5), blur=q).limits["blur"][1],
        "ms",
    ),
    "bounds of a fit": (
        lambda q: checked_bounds("bodies.0.length", (q, 1.0), "m")[0],
        "mm",
    ),
    "phase velocity": (lambda q: SINGLE[0].phase_velocity(q), "kHz"),
    "place in a solution": (lambda q: FLOWN.position(0, q, 0.0), "mm"),
    "time in a solution": (lambda q: FLOWN.displacement(0, 0.0, q), "ms"),
    "gauge of a solution": (lambda q: FLOWN.gauge(0, q).x, "mm"),
    "gauges of a sweep": (
        lambda q: swept(gauges=[(0, q)], times=[0.0]).gauges[0][1],
        "mm",
    ),
    "times of a sweep": (lambda q: swept(gauges=[(0, 0.0)], times=[q]).times[0], "ms"),
    "theory wave number": (lambda q: ri.theory.horn_frequency(1.0, q, 0.0), "rad/mm"),
}
"""For each number that is tried by hand: how it is given, as q, to a call that tells it
back, and a unit.
"""
MODEL = dict(declared(EXAMPLES))
ALL = MODEL | dict(declared(SINGLE)) | FIELDS


class Quantity:
    """A number with a unit, as pint makes them."""

    names = ("magnitude", "units")

    def __init__(self, number, unit):
        """Keep number and unit, under the names of this library as well."""
        self.number = number
        self.unit_name = unit
        name_of_number, name_of_unit = self.names
        setattr(self, name_of_number, number)
        setattr(self, name_of_unit, unit)

    def to(self, unit):
        """The quantity in an SI unit. TypeError if its own unit does not convert to it."""
        factor, si = UNITS[self.unit_name]
        if unit != si:
            raise TypeError(f"cannot convert from {self.unit_name} to {unit}")
        return type(self)(self.number * factor, si)

    def __array__(self, dtype=None, copy=None):
        return np.array(self.number, dtype=dtype)

    def __float__(self):
        return float(self.number)

    def __repr__(self):
        return f"<{self.number} {self.unit_name}>"


class OtherQuantity(Quantity):
    """As astropy makes them; those of unyt have a value and units."""

    names = ("value", "unit")


class Labelled:
    """An array with named dimensions, as xarray makes them."""

    def __init__(self, values):
        self.values = np.asarray(values)
        self.dims = ("case",)

    def __array__(self, dtype=None, copy=None):
        return np.array(self.values, dtype=dtype)

    def __len__(self):
        return len(self.values)

    def __iter__(self):
        return map(Labelled, self.values)


def pint_quantity(number, unit):
    """A number or array with a unit, as pint has it."""
    pint = pytest.importorskip("pint")
    spelling = unit.replace("%", "percent")
    registry = pint.application_registry.get()
    return registry.Quantity(number, spelling)


def astropy_quantity(number, unit):
    """A number or array with a unit, as astropy has it."""
    units = pytest.importorskip("astropy.units")
    spelling = unit.replace("^1.5", "^(1.5)")
    return number * units.Unit(spelling)


QUANTITIES = [Quantity, OtherQuantity, pint_quantity, astropy_quantity]


# Units
# --------------------------------------------------------------------------------------


@pytest.mark.parametrize("quantity", few_of(QUANTITIES, [OtherQuantity, pint_quantity]))
def test_every_field_converts_by_the_unit_of_the_quantity(quantity):
    """Each of the fields `ALL` given as a quantity has the value of the converted
    number, without axes.
    """
    converted = {}
    expected = {}
    for name, (make, unit) in ALL.items():
        factor, _ = UNITS[unit]
        converted[name] = make(quantity(3.0, unit))
        expected[name] = make(3.0 * factor)
    axes = {np.ndim(value) for value in converted.values()}
    assert converted == pytest.approx(expected, rel=1e-14)
    assert axes == {0}


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_every_number_of_the_model_takes_an_array_with_a_unit(quantity):
    """Each entry of `MODEL` converts the array [3, 2] in its unit to SI units."""
    numbers = np.array([3.0, 2.0])
    for name, (make, unit) in MODEL.items():
        factor, _ = UNITS[unit]
        expected = numbers * factor
        converted = make(quantity(numbers, unit))
        assert converted == pytest.approx(expected, rel=1e-14), name


def subclasses(kind):
    """A class and all its subclasses, at any depth."""
    kinds = {kind}
    for subclass in kind.__subclasses__():
        kinds |= subclasses(subclass)
    return kinds


def test_every_class_that_declares_numbers_is_tried():
    """The public classes of the package that declare numbers are exactly those of the
    examples in this file.
    """
    declaring = set()
    for kind in subclasses(Frozen):
        is_public = not kind.__name__.startswith("_")
        is_of_package = kind.__module__.startswith("rodimpact.")
        if kind.fields and is_public and is_of_package:
            declaring.add(kind)
    tried = {type(example) for example in (*EXAMPLES, *SINGLE)}
    assert declaring == tried


def test_a_stiffness_of_any_power_must_be_bare():
    message = r"unit that converts to N/m\^p, got <3.0 kN/mm>"
    with pytest.raises(ri.InvalidModel, match=message):
        ri.PowerLaw(Quantity(3.0, "kN/mm"), 1.5)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_every_field_refuses_a_quantity_of_something_else(quantity):
    """Each field refuses a quantity of a wrong unit; the message has its number."""

    def wrong_quantity(unit):
        """Grams, or millimetres where grams would be right."""
        wrong_unit = "g"
        if unit == "g":
            wrong_unit = "mm"
        return quantity(4.0, wrong_unit)

    taken = taken_by(ALL, wrong_quantity, r"got .*\b4\b")
    assert taken == []


def test_a_refusal_names_field_value_and_unit():
    """A rod with a length in g and a strain in mm is refused with both fields, their
    values and the units that they need.
    """
    length = Quantity(4, "g")
    strain = Quantity(0.1, "mm")
    messages = problems(
        lambda: ri.Rod(length, area=1e-4, material=STEEL, strain=strain)
    )
    assert messages == {
        "length": "must be in a unit that converts to m, got <4 g>",
        "strain": "must have no unit, got <0.1 mm>",
    }


class Mute:
    """A number with a unit that says nothing of its conversion."""

    units = "furlongs"

    def __float__(self):
        return 2.0


def test_what_has_a_unit_and_does_not_convert_is_refused():
    """A length and a mass of the class `Mute` are refused by the unit they need."""
    message = "length: must be in a unit that converts to m"
    with pytest.raises(ri.InvalidModel, match=message):
        ri.Rod(Mute(), area=1e-4, material=STEEL)
    message = "m1: must be in a unit that converts to kg"
    with pytest.raises(ValueError, match=message):
        ri.rigid.reduced_mass(Mute(), 1.0)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_families_convert_as_arrays_and_as_lists(quantity):
    """Lengths in mm as an array, or mixed with numbers in lists, become the same array
    in m.
    """
    array = quantity(np.array([400.0, 1000.0]), "mm")
    mixed = [quantity(400.0, "mm"), 1.0]
    nested = ([quantity(400.0, "mm")], [1])
    for lengths in (array, mixed, nested):
        converted = ri.Rod(lengths, area=1e-4, material=STEEL).length
        assert isinstance(converted, np.ndarray)
        assert converted.ravel() == pytest.approx([0.4, 1.0], rel=1e-15)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_a_bad_member_of_a_quantity_is_named(quantity):
    lengths = quantity(np.array([1.0, -2.0]), "mm")
    message = r"length\[1\]: must be a finite positive number"
    with pytest.raises(ri.InvalidModel, match=message):
        ri.Rod(lengths, area=1e-4, material=STEEL)


def test_steps_of_a_quantity_are_refused_as_a_whole():
    velocities = Quantity(np.array([1.0, 2.0]), "km/s")
    with pytest.raises(ri.InvalidModel, match="values: must have no unit"):
        ri.Steps(velocities, at=[0.1])


ON_A_WALL = ri.System([*FLYING.bodies, ri.Wall()])
"""A rod that strikes a wall at 1 m/s."""
ON_GRID = {"method": "finite-difference", "until": 1e-4}


def test_solve_takes_an_end_with_a_unit():
    solution = ri.solve(ON_A_WALL, until=Quantity(0.25, "ms"))
    assert solution.t_end == 0.25e-3


def test_solve_refuses_an_end_that_is_no_time():
    length = Quantity(1.0, "mm")
    message = "until: must be in a unit that converts to s"
    with pytest.raises(ri.InvalidModel, match=message):
        ri.solve(ON_A_WALL, until=length)


def test_solve_takes_a_time_step_with_a_unit():
    converted = ri.solve(ON_A_WALL, dt=Quantity(0.001, "ms"), **ON_GRID).outcome
    bare = ri.solve(ON_A_WALL, dt=1e-6, **ON_GRID).outcome
    assert converted.velocities_after == bare.velocities_after


def test_solve_takes_snapshots_with_a_unit():
    """Snapshots in ms give the velocity of the same snapshots in s."""
    times = Quantity(np.array([0.0, 0.05]), "ms")
    converted = ri.solve(ON_A_WALL, snapshots=times, cells=10, **ON_GRID)
    bare = ri.solve(ON_A_WALL, snapshots=[0.0, 5e-5], cells=10, **ON_GRID)
    velocity = converted.velocity(0, 0.1, 5e-5)
    expected = bare.velocity(0, 0.1, 5e-5)
    assert velocity == expected


@pytest.mark.parametrize(
    "value",
    [
        1.0,
        2,
        2**70,
        np.float32(0.5),
        np.int8(3),
        np.longdouble(2),
        Fraction(1, 4),
        [1.0, 2],
        [1.0, [2, 3.0][0]],
        ((1,), [Fraction(1, 2)]),
        range(3),
        np.arange(3.0),
        np.arange(3, dtype="u8"),
        np.array([Fraction(1, 2), 3], dtype=object),
        array.array("d", [1.0, 2.0]),
    ],
)
def test_numbers_of_any_type_become_new_floats(value):
    """`floats` returns a new array of float64 with the same values, which shares no
    memory.
    """
    converted = floats(value, "m")
    expected = np.array(value, dtype=float)
    shares_memory = np.shares_memory(converted, np.asarray(value))
    assert type(converted) is np.ndarray
    assert converted.dtype == np.float64
    assert converted.tolist() == expected.tolist()
    assert not shares_memory


class Broken:
    """An array that cannot be read."""

    def __array__(self, dtype=None, copy=None):
        raise TypeError


DEEP = [1.0]
for _ in range(3000):
    DEEP = [DEEP]
NO_NUMBERS = {
    "None": (None, "got None"),
    "truth": (True, "got True"),
    "truth of NumPy": (np.True_, "got np.True_"),
    "a truth among numbers": ([1.0, True], r"got \[1.0, True\]"),
    "truths in an array among numbers": ([np.array([True]), [2.0]], "got "),
    "text": ("1 m", "got '1 m'; units.parse reads text"),
    "a bytearray": (bytearray(b"12"), "got bytearray"),
    "a bytearray among numbers": ([bytearray(b"1"), [2]], "got "),
    "a date": (datetime.date(2020, 1, 1), "got datetime.date"),
    "a date of NumPy": (np.datetime64("2020-01-01"), "got np.datetime64"),
    "an imaginary part": (1 + 2j, r"got \(1\+2j\)"),
    "a dictionary": ({"a": 1.0}, "got {'a'"),
    "a broken array": (Broken(), "got <"),
    "a mask among numbers": ([np.ma.masked, 1.0], "its mask would be lost"),
    "an integer beyond a float": (
        10**400,
        "got 10000.*; it is too large for a floating-point",
    ),
    "a fraction beyond a float": (Fraction(10**400, 3), "it is too large"),
    "lists of unequal lengths": ([[1.0], [1.0, 2.0]], "lists must be of equal lengths"),
    "lists of 3000 levels": (DEEP, r"got \[\[\[\["),
}
TAKERS = {
    "a field": lambda value: ri.RigidMass(1.0, velocity=value),
    "an argument": lambda value: ri.rigid.reduced_mass(value, 1.0),
    "theory": lambda value: ri.theory.rod_on_wall(value, 1.0, 1.0),
    "steps": lambda value: ri.Steps([0.0, value], at=[1.0]),
}


@pytest.mark.parametrize("take", TAKERS.values(), ids=TAKERS)
@pytest.mark.parametrize(("value", "message"), NO_NUMBERS.values(), ids=NO_NUMBERS)
def test_what_is_no_number_is_refused_wherever_it_is_given(take, value, message):
    """Each of `TAKERS`, and samples, refuse each value of `NO_NUMBERS`, the former in
    less than 200 characters.
    """
    with pytest.raises(ValueError, match=message) as error:
        take(value)
    assert len(str(error.value)) < 200
    with pytest.raises(ValueError, match="values: must be"):
        ri.Samples([0.0, value])


def test_a_number_too_large_for_a_float_is_infinite_and_refused():
    with pytest.raises(ri.InvalidModel, match="mass: must be a finite positive number"):
        ri.RigidMass(np.longdouble("1e4000"))


@pytest.mark.exhaustive
def test_no_library_of_units_or_labels_is_imported():
    """A process that imports rodimpact and makes a rod has imported none of pint,
    astropy, unyt, xarray and pandas.
    """
    script = """
import sys
import rodimpact as ri
ri.Rod([1, 2], area=1, material=ri.materials.steel)
libraries = {'pint', 'astropy', 'unyt', 'xarray', 'pandas'}
print(libraries & set(sys.modules))
"""
    command = [sys.executable, "-c", script]
    ran = subprocess.run(command, capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "set()"


# Labels
# --------------------------------------------------------------------------------------


def labelled():
    """Two numbers with the name of their dimension."""
    return Labelled([1.0, 2.0])


def data_array():
    """The same by xarray."""
    xarray = pytest.importorskip("xarray")
    return xarray.DataArray([1.0, 2.0], dims="case")


def series():
    """Two numbers with an index, by pandas."""
    pandas = pytest.importorskip("pandas")
    return pandas.Series([1.0, 2.0], index=[1, 0])


def masked():
    """Two numbers, of which the first one is masked."""
    return np.ma.array([1.0, 2.0], mask=[True, False])


BY_NAME = "dimensions are not matched by name here; give .values of arrays from"

LABELLED = [
    (labelled, BY_NAME),
    (data_array, BY_NAME),
    (series, "its index is not matched; give .to_numpy()"),
    (masked, "its mask would be lost; give .compressed() or .filled(...)"),
]


@pytest.mark.parametrize(("make_labels", "remedy"), LABELLED)
def test_every_field_refuses_labelled_and_masked_arrays(make_labels, remedy):
    labels = make_labels()
    message = re.escape(remedy)
    taken = taken_by(ALL, lambda unit: labels, message)
    assert taken == []


def test_labels_are_refused_in_lists_and_lists_of_steps_too():
    """A list of labelled arrays as a length, and one of them in steps, are refused."""
    message = "length: must be bare numbers, got a Lab"
    with pytest.raises(ri.InvalidModel, match=message):
        ri.Rod([labelled(), labelled()], area=1e-4, material=STEEL)
    message = "values: must be bare numbers, got a Labelled"
    with pytest.raises(ri.InvalidModel, match=message):
        ri.Steps(labelled(), at=[0.1])


# Shapes
# --------------------------------------------------------------------------------------

THREE = np.ones(3)
FOUR = np.ones(4)
SHAPES = {
    "length and area": (
        lambda: ri.Rod(THREE, area=FOUR, material=STEEL),
        ["length", "area"],
    ),
    "length and material": (
        lambda: ri.Segment(
            THREE, 1.0, ri.Material("a", youngs_modulus=1.0, density=FOUR)
        ),
        ["length", "material.density"],
    ),
    "material": (
        lambda: ri.Material("a", youngs_modulus=THREE, density=FOUR),
        ["youngs_modulus", "density"],
    ),
    "mass": (lambda: ri.RigidMass(THREE, velocity=FOUR), ["mass", "velocity"]),
    "radii": (
        lambda: ri.Hertz.from_radii(THREE, FOUR, STEEL, STEEL),
        ["left_radius", "right_radius"],
    ),
    "steps": (
        lambda: ri.Steps([1.0, 2.0, THREE], at=[1.0, 1.0 + FOUR]),
        ["values.2", "at.1"],
    ),
    "places": (
        lambda: ri.Steps([1.0, 2.0, 3.0], at=[THREE, 2 * FOUR]),
        ["at.0", "at.1"],
    ),
    "places along a rod": (
        lambda: ri.Rod(
            THREE, area=1.0, material=STEEL, velocity=ri.Steps([1.0, 0.0], [FOUR / 2])
        ),
        ["length", "velocity.at.0"],
    ),
    "system": (
        lambda: ri.System(
            [ri.Rod(THREE, area=1.0, material=STEEL, velocity=1.0), ri.RigidMass(FOUR)]
        ),
        ["bodies.0.length", "bodies.1.mass"],
    ),
    "gap": (
        lambda: ri.System([ri.Rod(THREE, area=1.0, material=STEEL), ri.Wall()], [FOUR]),
        ["bodies.0.length", "contacts.0.gap"],
    ),
}


@pytest.mark.parametrize(("make", "fields"), SHAPES.values(), ids=SHAPES)
def test_arrays_that_do_not_broadcast_are_named_with_their_shapes(make, fields):
    first, second = fields
    message = (
        f"arrays do not broadcast: {first} has shape (3,), {second} has shape (4,)"
    )
    assert problems(make) == {first: message}
