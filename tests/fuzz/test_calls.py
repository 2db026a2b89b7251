"""Public names called with things of every kind answer, or say in a sentence what is wrong."""

import inspect
import re
from types import FunctionType

import matplotlib.pyplot as plt
import numpy as np
import pytest
from fuzz.generators import (
    BAR,
    FAMILY,
    FLAGS,
    PAIR,
    RODS,
    SEEDS,
    SOLVED,
    STEEL,
    TIMES,
    VOLTS,
    called,
    likely,
    objects,
    one_of,
)

import rodimpact as ri

EXAMPLES = 150 * TIMES  # of each seed
USED = (
    "Absorbing", "Bonded", "Bridge", "Case", "Fixed", "Free", "Hertz", "HuntCrossley", "Incoming",
    "Joint", "Material", "Measured", "Moved", "Options", "PowerLaw", "Pushed", "Rigid", "RigidMass",
    "Rod", "Samples", "Segment", "Signal", "Spring", "SpringDashpot", "Steps", "System", "Wall",
    "Yielding", "atlas", "by_dimension", "closed_form", "collide", "enclosure", "exact", "fit",
    "gauges_to_csv", "gradient", "load", "parse_case", "read_case", "read_signals", "regions_of",
    "signals_from_xarray", "signals_to_xarray", "solve", "sweep", "write_case", "write_signals",
)
"""Public names that users call; the others are results."""
BRIDGE = ri.Bridge("quarter", gauge_factor=2.0, excitation=5.0)
READ_BACK = {"from_dict", "restored"}  # they take what files hold, which is checked there
PARTS = {"pair_numbers", "pair_restitution"}  # of `saint_venant`, which checks what they take


def of_modules():
    """Functions of the public modules, by name."""
    for module in (ri.rigid, ri.theory, ri.waves, ri.design, ri.plot):
        for name, function in inspect.getmembers(module, inspect.isfunction):
            own = function.__module__ == module.__name__ or module in (ri.design, ri.plot)
            if name[0] != "_" and own and name not in PARTS:
                yield f"{module.__name__}.{name}", function
    yield from {"units.parse": ri.units.parse, "units.format_si": ri.units.format_si}.items()


def of_results():
    """Methods of objects that users have in their hands, by name."""
    waves, grid = SOLVED(), ri.solve(PAIR, until=1e-4, cells=8)
    steps = ri.solve(ri.System(RODS, contacts=[ri.Spring(1e8)]), until=1e-4, dt=1e-6)
    things = [
        RODS[0], RODS[0].segments[0], STEEL, PAIR, FAMILY, waves, steps, grid,
        waves.contacts[0], steps.contacts[0], grid.contacts[0], waves.gauge(0, 0.1), waves.outcome,
        ri.sweep(FAMILY), ri.Hertz, ri.Spring(1e7), ri.Samples([1.0, 2.0]),
        ri.Steps([1.0, 0.0], [0.1]), ri.regions_of(waves), waves.energy([0.0, 1e-5]),
        BAR, VOLTS, BRIDGE,
    ]
    for thing in things:
        for name in dir(thing):
            if name[0] != "_" or name == "__getitem__":
                method = inspect.getattr_static(thing, name)
                kinds = classmethod if isinstance(thing, type) else FunctionType | classmethod
                if isinstance(method, kinds) and name not in READ_BACK:
                    yield f"{type(thing).__name__}.{name}", getattr(thing, name)


def arguments_for(rng, function):
    """Random arguments, positional and by name; some of them good, now and then one too many."""
    parameters = inspect.signature(function).parameters.values()
    things, good = objects(rng), rng.random()
    positional, named = [], {}
    for parameter in parameters:
        if parameter.default is not parameter.empty and rng.random() < 0.6:
            continue
        known = parameter.name in FLAGS or rng.random() < good
        value = likely(rng, parameter.name) if known else None
        value = one_of(rng, things) if value is None else value
        if parameter.kind is parameter.POSITIONAL_ONLY:
            positional.append(value)
        elif parameter.kind is parameter.VAR_KEYWORD:
            named[str(one_of(rng, ["length", "mass", "velocity", "area", "x"]))] = value
        elif parameter.kind is not parameter.VAR_POSITIONAL:
            named[parameter.name] = value
    if rng.random() < 0.02:
        named["lenght"] = 1.0
    return positional, named


@pytest.fixture(scope="module")
def calls():
    return [*((name, getattr(ri, name)) for name in USED), *of_modules(), *of_results()]


def test_every_public_name_is_called_or_is_a_result(calls):
    names = {name for name, _ in calls}
    for name in set(ri.__all__) - names:
        thing = getattr(ri, name)
        assert inspect.ismodule(thing) or isinstance(thing, type) or name == "warm", name


@pytest.mark.parametrize("seed", SEEDS)
def test_calls_answer_or_refuse_in_a_sentence(monkeypatch, tmp_path, calls, seed):
    rng = np.random.default_rng(seed)
    monkeypatch.chdir(tmp_path)
    refused = 0
    for _ in range(EXAMPLES):
        _, function = one_of(rng, calls)
        positional, named = arguments_for(rng, function)
        refused += isinstance(called(function, *positional, **named), Exception)
        plt.close("all")
    assert EXAMPLES / 10 < refused < EXAMPLES
    assert not list(tmp_path.rglob(".rodimpact*"))


REFUSED = [
    (lambda: ri.load(0), "path: must be the name of a file, got 0"),
    (lambda: ri.read_case(None), "path: must be the name of a file, got None"),
    (lambda: SOLVED().save(b"x.npz"), "path: must be the name of a file"),
    (lambda: ri.plot.save(SOLVED(), 3), "path: must be the name of a file, got 3"),
    (lambda: ri.sweep(FAMILY, checkpoint=[1]), "path: must be the name of a file, got [1]"),
    (lambda: ri.parse_case("", source=1), "source: must be the name of a case, got 1"),
    (lambda: ri.plot.energy(3), "solution: must be a Solution"),
    (lambda: ri.plot.overview(PAIR), "solution: must be a Solution"),
    (lambda: ri.regions_of({}), "solution: must be a Solution"),
    (lambda: ri.plot.sweep(SOLVED()), "result: must be a SweepResult"),
    (lambda: ri.plot.gauge(0.1), "record: must be a Gauge"),
    (lambda: ri.plot.energy(SOLVED(), ax=STEEL), "ax: must be an Axes"),
    (lambda: ri.plot.contact(SOLVED(), ax=[1, 2]), "ax: needs a pair of Axes"),
    (lambda: ri.plot.contact(SOLVED(), contact=0.5), "contact: must be from 0 to 0, got 0.5"),
    (lambda: ri.plot.animation(SOLVED(), frames=[2]), "frames: must be a single number"),
    (lambda: ri.plot.snapshots(SOLVED(), times={}), "times: must be a number of seconds"),
    (lambda: ri.plot.spacetime(SOLVED(), magnification=[1, 2]), "magnification: must be a single"),
    (lambda: ri.regions_of(SOLVED(), limit=[1]), "limit: must be a single number"),
    (lambda: SOLVED().gauge(0, [0.1, 0.2]), "x: must be a single number"),
    (lambda: SOLVED().system_at([0.0, 1e-5]), "t: must be a single number"),
    (lambda: SOLVED().strain(0, 0.1, 0.0, None), 'side: must be "right" or "left", got None'),
    (lambda: SOLVED().contacts[0].force(0.0, 1), 'side: must be "right" or "left", got 1'),
    (lambda: SOLVED().displacement(0, [0, 0.1], [0, 0, 0]), "x: shape (2,) does not broadcast"),
    (lambda: ri.gauges_to_csv("x.csv", [(0, 0.1)]), "gauges: must be records by name"),
    (lambda: PAIR[0], "0 picks nothing of a family of shape ()"),
    (lambda: FAMILY["a"], "'a' picks nothing of a family of shape (2,)"),
    (lambda: FAMILY[2**63], "9223372036854775808 picks nothing"),
    (lambda: FAMILY[[1, [2, 3]]], "[1, [2, 3]] picks nothing of a family of shape (2,)"),
    (lambda: ri.solve(PAIR, progress=3), "progress: must be a function, got 3"),
    (lambda: ri.sweep(FAMILY, progress=STEEL), "progress: must be a function, got"),
    (lambda: ri.sweep(FAMILY).explain([0, 1]), "index: must pick one member"),
    (lambda: ri.sweep(FAMILY).table(0.5), "start, stop: must be whole numbers"),
    (lambda: ri.sweep(FAMILY, gauges=3), "gauges: must be [(body, x), ...], got 3"),
    (lambda: ri.sweep(FAMILY, on_error=[]), 'on_error: must be "raise" or "record", got []'),
    (lambda: ri.rigid.contact_mass([1, 2], [1, 2, 3]), "m1 has shape (2,), m2 has shape (3,)"),
    (lambda: ri.Segment(1.0, 1e-4, STEEL).area_between(0.1), "edges: must be two places or more"),
    (lambda: ri.Segment(1.0, 1e-4, STEEL).polar_moments("1"), "areas: must be a number"),
    (lambda: ri.Spring(1e7).stored(-1.0), "indentation = -1.0: must be 0 or more"),
    (lambda: ri.Spring(1e7).stored(1e200), "indentation = 1e+200: must be 0 or more, and not too"),
    (lambda: ri.units.parse("1 m", 3), "unknown dimension 3"),
    (lambda: ri.units.format_si("1", "m"), "cannot write '1' in 'm'"),
]


@pytest.mark.parametrize(("call", "sentence"), REFUSED)
def test_what_was_found_is_refused(monkeypatch, tmp_path, call, sentence):
    monkeypatch.chdir(tmp_path)
    with pytest.raises((ValueError, IndexError), match=re.escape(sentence)):
        call()
    assert not list(tmp_path.iterdir())
