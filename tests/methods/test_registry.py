"""What a run is asked for is checked in one place."""

import dataclasses
import inspect
import pickle

import numpy as np
import pytest
from mistakes import problems, refused

import rodimpact as ri
from rodimpact.methods.registry import Options

ROD = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
ROW = ri.System([ROD, ri.Wall()])
MISTAKES = [
    ("until", -1.0), ("until", float("nan")), ("until", "1"), ("until", [1.0, 2.0]),
    ("dt", 0.0), ("rtol", -1e-3), ("rtol", True), ("cells", 0), ("cells", 2.5),
    ("max_events", 0), ("max_events", 1.5), ("max_events", True), ("method", "magic"),
]


@pytest.mark.parametrize(("name", "value"), MISTAKES)
def test_mistakes_are_the_same_whoever_asks(name, value):
    for ask in (lambda o: Options(**o), lambda o: ri.solve(ROW, **o), lambda o: ri.sweep(ROW, **o)):
        found = problems(lambda ask=ask: ask({name: value}))
        assert list(found) == [name]
        assert found == problems(lambda: Options(**{name: value}))


@pytest.mark.parametrize(("snapshots", "said"), [
    ("soon", "a list of times from 0 s on, got 'soon'"), ([-1.0], "from 0 s on, got"),
    ([], "must be"), ([[1.0]], "must be"), ([2e-5], "from 0 s on up to until = 1e-05 s, got"),
])
def test_snapshots_are_a_number_or_times_within_the_run(snapshots, said):
    until = 1e-5 if snapshots == [2e-5] else None
    assert refused(said, Options, until, snapshots=snapshots) == ["snapshots"]


@pytest.mark.parametrize("wrong", [
    {"until": -1, "method": "magic", "max_events": 0, "dt": 1.0, "rtol": 1.0, "cells": 0},
    {"dt": 0.0, "rtol": 1.0}, {"cells": 0, "rtol": 1.0}, {"dt": 1.0, "cells": 0, "rtol": 1.0},
])
def test_all_mistakes_are_told_once_each(wrong):
    assert sorted(refused("must|give", Options, **wrong)) == sorted({*wrong} - {"rtol"})


@pytest.mark.parametrize(("given", "path", "said"), [
    ({"method": "fronts", "dt": 1e-6}, "dt", 'is for method "finite-difference", not "fronts"'),
    ({"method": "fronts", "rtol": 1e-3}, "rtol", '"characteristics" or "finite'),
    ({"method": "characteristics", "cells": 9}, "cells", 'is for method "finite-difference"'),
    ({"dt": 1e-6}, "dt", 'not "fronts", which "auto" takes; leave it out, or give another'),
])
@pytest.mark.parametrize("ask", [ri.solve, ri.sweep])
def test_options_of_another_method_are_refused(given, path, said, ask):
    assert said in problems(lambda: ask(ROW, **given))[path]


@pytest.mark.parametrize("ask", [ri.solve, ri.sweep])
def test_a_held_row_under_gravity_needs_an_end(ask):
    with pytest.raises(ri.InvalidModel, match="until: must be given"):
        ask(ri.System([ROD, ri.Wall()], gravity=9.81))


def test_an_accuracy_that_is_asked_for_chooses_a_method_that_takes_one():
    assert Options().method_for(ROW) == "fronts"
    assert Options(rtol=1e-3).method_for(ROW) == "characteristics"


GRID = [{"dt": 1e-6}, {"cells": 9}, {"snapshots": [0.0, 1e-5]}]


@pytest.mark.parametrize("options", GRID)
@pytest.mark.parametrize("row", [
    ROW, ri.System([ROD, ri.Wall()], contacts=[ri.Spring(1e8)]),
    ri.System([ri.RigidMass(1.0, velocity=1.0), ri.Wall()], contacts=[ri.Spring(1e8)]),
], ids=["fronts", "characteristics", "without a rod"])
def test_options_of_a_grid_do_not_choose_it(row, options):
    [(path, message)] = problems(lambda: Options(**options).method_for(row)).items()
    assert path == next(iter(options))
    assert message.startswith('is for method "finite-difference", not "')


@pytest.mark.parametrize("options", GRID)
def test_options_of_a_grid_are_taken_where_the_row_needs_one(options):
    assert Options(**options).method_for(ri.System([LOSSY])) == "finite-difference"


STEEL = ri.materials.steel
THICK = ri.Rod(0.4, diameter=0.01, material=STEEL, lateral_inertia="rayleigh-love")
LOSSY = ri.Rod(0.4, area=1e-4, material=STEEL.damped(0.01, 1e4))
PUSHED = {"contacts": [ri.Spring(1e8)]}


@pytest.mark.parametrize(("system", "options", "said"), [
    (ri.System([ROD, THICK]), {},
     'the slower method "finite-difference" because of bodies.1.lateral_inertia: the method '
     '"fronts" has no lateral inertia.'),
    (ri.System([LOSSY, LOSSY], **PUSHED), {},
     'the slower method "finite-difference" because of bodies.0.material.viscosity and 1 more: '
     'the method "characteristics" has no damping.'),
    (ri.System([ROD, ROD], gravity=9.81), {},
     'the slower method "characteristics" because of gravity: the method "fronts" has no gravity.'),
    (ri.System([ROD, ROD]), {}, ""), (ri.System([ROD, ROD], **PUSHED), {}, ""),
    (ri.System([ROD, ROD], gravity=9.81), {"rtol": 1e-3}, ""),
    (ri.System([ROD, THICK]), {"method": "finite-difference"}, ""),
])
def test_the_status_names_the_entry_that_calls_for_a_slower_method(system, options, said):
    status = ri.solve(system, until=1e-5, **options).status
    assert said in status
    assert ("slower" in status) == bool(said)


def test_options_are_values():
    options = Options(until=1, max_events=np.int64(5), snapshots=[0.0])
    assert type(options.until) is float
    assert type(options.max_events) is int
    assert pickle.loads(pickle.dumps(options)) == options
    assert hash(options) == hash(Options(until=1.0, max_events=5, snapshots=(0.0,)))


def test_solve_and_sweep_take_every_option():
    names = {field.name for field in dataclasses.fields(Options)}
    assert names <= set(inspect.signature(ri.solve).parameters)
    assert names - {"snapshots"} <= set(inspect.signature(ri.sweep).parameters)


@pytest.mark.parametrize("kind", [np.float32, np.longdouble, np.float16, int])
@pytest.mark.parametrize("name", ["until", "dt", "rtol"])
def test_numbers_of_any_precision_become_floats(name, kind):
    value = getattr(Options(**{name: kind(2)}), name)
    assert (type(value), value) == (float, 2.0)
