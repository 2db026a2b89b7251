"""What a run is asked for is checked in one place."""

import dataclasses
import inspect
import math
import pickle
import re

import numpy as np
import pytest
from mistakes import problems, refused

import rodimpact as ri
from rodimpact.methods.registry import METHODS, Options

ROD = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
STILL = ROD.replace(velocity=0.0)
ROW = ri.System([ROD, ri.Wall()])
MISTAKES = [
    ("until", -1.0),
    ("until", float("nan")),
    ("until", "1"),
    ("until", [1.0, 2.0]),
    ("dt", 0.0),
    ("rtol", -1e-3),
    ("rtol", True),
    ("cells", 0),
    ("cells", 2.5),
    ("max_events", 0),
    ("max_events", 1.5),
    ("max_events", True),
    ("method", "magic"),
]


@pytest.mark.parametrize(("name", "value"), MISTAKES)
@pytest.mark.parametrize("ask", [ri.solve, ri.sweep])
def test_mistakes_of_options_are_the_same_in_solve_and_sweep(name, value, ask):
    """`Options`, `solve` and `sweep` refuse a wrong value in the same words, by the
    name of the option.
    """
    options = {name: value}

    messages = problems(lambda: Options(**options))
    messages_of_call = problems(lambda: ask(ROW, **options))

    assert list(messages) == [name]
    assert messages_of_call == messages


@pytest.mark.parametrize(
    ("snapshots", "until", "message"),
    [
        ("soon", None, "a list of times from 0 s on, got 'soon'"),
        ([-1.0], None, "from 0 s on, got"),
        ([], None, "must be"),
        ([[1.0]], None, "must be"),
        ([2e-5], 1e-5, "from 0 s on up to until = 1e-05 s, got"),
    ],
)
def test_snapshots_are_a_number_or_times_within_the_run(snapshots, until, message):
    paths = refused(message, Options, until, snapshots=snapshots)
    assert paths == ["snapshots"]


ALL_WRONG = {
    "until": -1,
    "method": "magic",
    "max_events": 0,
    "dt": 1.0,
    "rtol": 1.0,
    "cells": 0,
}


@pytest.mark.parametrize(
    "wrong",
    [
        ALL_WRONG,
        {"dt": 0.0, "rtol": 1.0},
        {"cells": 0, "rtol": 1.0},
        {"dt": 1.0, "cells": 0, "rtol": 1.0},
    ],
)
def test_all_mistakes_are_told_once_each(wrong):
    """All are told except rtol, which is right, or wrong only beside the others."""
    paths = refused("must|give", Options, **wrong)
    expected = set(wrong) - {"rtol"}
    assert sorted(paths) == sorted(expected)


@pytest.mark.parametrize(
    ("options", "path", "message"),
    [
        (
            {"method": "fronts", "dt": 1e-6},
            "dt",
            'is for method "finite-difference", not "fronts"',
        ),
        ({"method": "fronts", "rtol": 1e-3}, "rtol", '"characteristics" or "finite'),
        (
            {"method": "characteristics", "cells": 9},
            "cells",
            'is for method "finite-difference"',
        ),
        (
            {"dt": 1e-6},
            "dt",
            'not "fronts", which "auto" takes; leave it out, or give another',
        ),
    ],
)
@pytest.mark.parametrize("ask", [ri.solve, ri.sweep])
def test_options_of_another_method_are_refused(options, path, message, ask):
    messages = problems(lambda: ask(ROW, **options))
    assert message in messages[path]


def driven_pair(end):
    """A moving rod with this left end, and one at rest 1 mm before it."""
    ends = (end, ri.Free())
    return ri.System([ROD, STILL], gaps=[1e-3], ends=ends)


PUSH_OF_10_US = ri.Steps([1.0, 0.0], at=[1e-5])
PUSHED_FOR_A_WHILE = ri.Pushed(PUSH_OF_10_US)
HANGING = (ri.Fixed(), ri.Free())
FALLING_FROM_AN_END = ri.System([ROD], gravity=9.81, ends=HANGING)


@pytest.mark.parametrize(
    ("system", "cause", "acting"),
    [
        (ri.System([ROD, ri.Wall()], gravity=9.81), "gravity", "gravity"),
        (FALLING_FROM_AN_END, "gravity", "gravity"),
        (driven_pair(ri.Pushed(0.0)), "drives", "an end is driven"),
        (driven_pair(ri.Moved(0.0)), "drives", "an end is driven"),
        (driven_pair(PUSHED_FOR_A_WHILE), "drives", "an end is driven"),
    ],
    ids=["gravity", "gravity and a fixed end", "push", "motion", "steps"],
)
def test_a_row_on_which_something_acts_needs_an_end_and_is_never_final(
    system, cause, acting
):
    """`cause` is named where no end is given, `acting` by the status of a solution."""
    message = f"must be given: .*{cause}"
    for ask in (ri.solve, ri.sweep):
        paths = refused(message, ask, system)
        assert paths == ["until"]

    solution = ri.solve(system, until=1e-4)

    assert not solution.final
    outcome = solution.outcome
    assert outcome.driven
    assert acting in solution.status
    reason = "gravity, a driven end, soil or drag"
    if len(system.bodies) == 1:
        reason = "no contact of this row"
    assert reason in outcome.why_no_restitution()


def test_a_collision_of_bodies_that_fall_alike_is_final():
    """Gravity changes no relative velocity, so that no end of the run is needed."""
    pair = ri.System([ROD, STILL], gravity=1.0)
    assert ri.solve(pair).final


@pytest.mark.parametrize(
    ("method", "counted", "remedy"),
    [
        ("fronts", "events", "Raise max_events"),
        ("characteristics", "steps of nodes", "until="),
        ("finite-difference", "steps times ends", "until="),
    ],
)
@pytest.mark.parametrize("cap", [7, 100])
def test_the_cap_on_events_ends_a_run_and_says_what_it_counts(
    method, counted, remedy, cap
):
    """A rod between two walls, which would go on for ever."""
    bodies = [ri.Wall(), ROD, ri.Wall()]
    system = ri.System(bodies, gaps=[1e-3, 1e-3])

    solution = ri.solve(system, method=method, max_events=cap)

    assert solution.stopped_by == "max_events"
    assert not solution.final
    assert cap - 3 <= solution.events <= cap + 7  # events at one time are not divided
    assert math.isnan(solution.t_final)
    sentence = rf"Stopped by the cap of \d+ {counted}.*{remedy}"
    assert re.search(sentence, solution.status)


def test_rtol_chooses_a_method_that_takes_one():
    default = Options()
    with_tolerance = Options(rtol=1e-3)

    assert default.method_for(ROW) == "fronts"
    assert with_tolerance.method_for(ROW) == "characteristics"


OPTIONS_OF_GRID = [{"dt": 1e-6}, {"cells": 9}, {"snapshots": [0.0, 1e-5]}]
SPRING = [ri.Spring(1e8)]
MASS = ri.RigidMass(1.0, velocity=1.0)
MASS_ON_SPRING = ri.System([MASS, ri.Wall()], contacts=SPRING)


@pytest.mark.parametrize("options", OPTIONS_OF_GRID)
@pytest.mark.parametrize(
    "system",
    [ROW, ri.System([ROD, ri.Wall()], contacts=SPRING), MASS_ON_SPRING],
    ids=["fronts", "characteristics", "without a rod"],
)
def test_options_of_a_grid_are_refused_where_another_method_is_chosen(system, options):
    """An option of grids alone, for a system that is solved with another method, is the
    only mistake, and its message names both methods.
    """
    (option,) = options

    messages = problems(lambda: Options(**options).method_for(system))

    assert list(messages) == [option]
    message = messages[option]
    assert message.startswith('is for method "finite-difference", not "')


STEEL = ri.materials.steel
THICK = ri.Rod(0.4, diameter=0.01, material=STEEL, lateral_inertia="rayleigh-love")
VISCOUS_STEEL = STEEL.damped(0.01, 1e4)
LOSSY = ri.Rod(0.4, area=1e-4, material=VISCOUS_STEEL)
ON_GRID = {"method": "finite-difference", "cells": 20}


@pytest.mark.parametrize("options", OPTIONS_OF_GRID)
def test_options_of_a_grid_are_taken_where_the_row_needs_one(options):
    """A damped rod needs a grid."""
    row = ri.System([LOSSY])
    method = Options(**options).method_for(row)
    assert method == "finite-difference"


@pytest.mark.parametrize(
    ("system", "options", "sentence"),
    [
        pytest.param(
            ri.System([ROD, THICK]),
            {"cells": 20},
            'the slower method "finite-difference" because of bodies.1.lateral_inertia: '
            'the method "fronts" has no lateral inertia.',
            id="lateral inertia",
        ),
        pytest.param(
            ri.System([LOSSY, LOSSY], contacts=SPRING),
            {"cells": 20},
            'the slower method "finite-difference" because of '
            "bodies.0.material.viscosity and 1 more: "
            'the method "characteristics" has no damping.',
            id="damping",
        ),
        pytest.param(
            ri.System([ROD, ROD], gravity=9.81),
            {},
            'the slower method "characteristics" because of gravity: '
            'the method "fronts" has no gravity.',
            id="gravity",
        ),
    ],
)
def test_the_status_names_the_entry_that_calls_for_a_slower_method(
    system, options, sentence
):
    solution = ri.solve(system, until=1e-5, **options)
    assert sentence in solution.status


@pytest.mark.parametrize(
    ("system", "options"),
    [
        pytest.param(ri.System([ROD, ROD]), {}, id="fronts"),
        pytest.param(ri.System([ROD, ROD], contacts=SPRING), {}, id="characteristics"),
        pytest.param(ri.System([ROD, ROD], gravity=9.81), {"rtol": 1e-3}, id="rtol"),
        pytest.param(ri.System([ROD, THICK]), ON_GRID, id="grid"),
    ],
)
def test_the_status_names_no_entry_where_nothing_slower_was_chosen(system, options):
    solution = ri.solve(system, until=1e-5, **options)
    assert "slower" not in solution.status


# What methods lack
# --------------------------------------------------------------------------------------

TAPER = ri.Samples([1e-4, 2e-4])  # areas, m^2
CONE = ri.Rod(0.4, area=TAPER, material=STEEL)
RAMP = ri.Samples([0.0, 1.0], step=1e-5)
LOSSY_AND_THICK = ri.Segment(
    0.5,
    area=1e-4,
    material=VISCOUS_STEEL,
    polar_moment=1e-8,
    lateral_inertia="rayleigh-love",
)
PLAIN = ri.Segment(0.5, area=1e-4, material=STEEL)
MIXED = ri.Rod(segments=[PLAIN, LOSSY_AND_THICK])
STRAIGHT_LINE = ri.Samples([0.0, 1.0])
SMOOTH = ROD.replace(velocity=STRAIGHT_LINE)
BY_MINDLIN_AND_HERRMANN = THICK.replace(lateral_inertia="mindlin-herrmann")
FOR_CHARACTERISTICS = {  # a row, and by path what fronts lack
    "mass": (ri.System([ri.RigidMass(2.0), ROD]), {"bodies.0": "rigid masses"}),
    "law": (
        ri.System([ROD, ROD], contacts=SPRING),
        {"contacts.0.law": "compliant contacts"},
    ),
    "gravity": (ri.System([ROD], gravity=1.0), {"gravity": "gravity"}),
    "joint": (
        ri.System([ROD, ROD], contacts=[ri.Joint(1.0)]),
        {"contacts.0.law": "joints"},
    ),
    "samples": (
        ri.System([SMOOTH]),
        {"bodies.0.velocity": "profiles other than steps"},
    ),
    "drive": (
        ri.System([ROD], ends=(ri.Moved(RAMP), ri.Free())),
        {"ends.left.value": "drives other than steps"},
    ),
}
FOR_A_GRID = {  # a row, and by path what the other methods lack
    "three rods": (
        ri.System([THICK, MIXED, CONE]),
        {
            "bodies.0.lateral_inertia": "lateral inertia",
            "bodies.1.segments.1.material.viscosity": "damping",
            "bodies.1.segments.1.lateral_inertia": "lateral inertia",
            "bodies.2.area": "tapered rods",
        },
    ),
    "Mindlin and Herrmann": (
        ri.System([ROD, BY_MINDLIN_AND_HERRMANN]),
        {"bodies.1.lateral_inertia": "lateral inertia"},
    ),
}


def messages_of(method, system):
    """What a method says that it lacks, by path."""
    return problems(lambda: Options(method=method).method_for(system))


@pytest.mark.parametrize(
    ("system", "lacked"), FOR_CHARACTERISTICS.values(), ids=FOR_CHARACTERISTICS
)
def test_fronts_say_what_they_lack_and_which_method_has_it(system, lacked):
    """A system that fronts cannot solve is refused with its features of `lacked`, by
    path, and with "characteristics" as the method that has them, which "auto" takes.
    """
    remedy = 'method "characteristics" has'
    expected = {}
    for path, feature in lacked.items():
        expected[path] = f'method "fronts" has no {feature}; {remedy}'

    assert messages_of("fronts", system) == expected
    assert Options(until=1.0).method_for(system) == "characteristics"


@pytest.mark.parametrize("method", ["fronts", "characteristics"])
@pytest.mark.parametrize(("system", "lacked"), FOR_A_GRID.values(), ids=FOR_A_GRID)
def test_methods_say_what_they_lack_and_that_the_grid_has_it(system, lacked, method):
    """A system that a method cannot solve is refused with its features of `lacked`, by
    path, and with "finite-difference" as the method that has them, which "auto" takes.
    """
    remedy = 'method "finite-difference" has'
    expected = {}
    for path, feature in lacked.items():
        expected[path] = f'method "{method}" has no {feature}; {remedy}'

    assert messages_of(method, system) == expected
    assert Options(until=1.0).method_for(system) == "finite-difference"


def test_methods_are_tried_in_this_order():
    assert list(METHODS) == ["fronts", "characteristics", "finite-difference"]


def test_steps_are_a_remedy_where_all_that_is_lacked_is_a_taper():
    row_with_taper = ri.System([CONE, ROD])

    (message,) = messages_of("fronts", row_with_taper).values()

    assert message.endswith('"finite-difference" has, or give rod.in_steps(n)')


def test_options_are_converted_pickled_and_hashed_as_values():
    """Options become floats and ints, are equal after pickling, and have the hash of
    equal options.
    """
    options = Options(until=1, max_events=np.int64(5), snapshots=[0.0])
    same = Options(until=1.0, max_events=5, snapshots=(0.0,))

    assert type(options.until) is float
    assert type(options.max_events) is int
    assert pickle.loads(pickle.dumps(options)) == options
    assert hash(options) == hash(same)


def test_solve_takes_every_option_and_sweep_all_but_snapshots():
    """The signatures of `solve` and `sweep` name all fields of `Options`; `sweep` may
    lack `snapshots`.
    """
    names = {field.name for field in dataclasses.fields(Options)}

    of_solve = set(inspect.signature(ri.solve).parameters)
    of_sweep = set(inspect.signature(ri.sweep).parameters)

    assert names <= of_solve
    assert names - {"snapshots"} <= of_sweep
