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
def test_mistakes_are_the_same_whoever_asks(name, value):
    for ask in (
        lambda o: Options(**o),
        lambda o: ri.solve(ROW, **o),
        lambda o: ri.sweep(ROW, **o),
    ):
        found = problems(lambda ask=ask: ask({name: value}))
        assert list(found) == [name]
        assert found == problems(lambda: Options(**{name: value}))


@pytest.mark.parametrize(
    ("snapshots", "said"),
    [
        ("soon", "a list of times from 0 s on, got 'soon'"),
        ([-1.0], "from 0 s on, got"),
        ([], "must be"),
        ([[1.0]], "must be"),
        ([2e-5], "from 0 s on up to until = 1e-05 s, got"),
    ],
)
def test_snapshots_are_a_number_or_times_within_the_run(snapshots, said):
    until = 1e-5 if snapshots == [2e-5] else None
    assert refused(said, Options, until, snapshots=snapshots) == ["snapshots"]


@pytest.mark.parametrize(
    "wrong",
    [
        {
            "until": -1,
            "method": "magic",
            "max_events": 0,
            "dt": 1.0,
            "rtol": 1.0,
            "cells": 0,
        },
        {"dt": 0.0, "rtol": 1.0},
        {"cells": 0, "rtol": 1.0},
        {"dt": 1.0, "cells": 0, "rtol": 1.0},
    ],
)
def test_all_mistakes_are_told_once_each(wrong):
    assert sorted(refused("must|give", Options, **wrong)) == sorted({*wrong} - {"rtol"})


@pytest.mark.parametrize(
    ("given", "path", "said"),
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
def test_options_of_another_method_are_refused(given, path, said, ask):
    assert said in problems(lambda: ask(ROW, **given))[path]


@pytest.mark.parametrize(
    ("bodies", "more", "acting"),
    [
        ([ROD, ri.Wall()], {"gravity": 9.81}, "gravity"),
        ([ROD], {"gravity": 9.81, "ends": (ri.Fixed(), ri.Free())}, "gravity"),
        *(
            (
                [ROD, STILL],
                {"gaps": [1e-3], "ends": (end, ri.Free())},
                "an end is driven",
            )
            for end in (
                ri.Pushed(0.0),
                ri.Moved(0.0),
                ri.Pushed(ri.Steps([1.0, 0.0], [1e-5])),
            )
        ),
    ],
)
def test_a_row_on_which_something_acts_needs_an_end_and_is_never_final(
    bodies, more, acting
):
    row = ri.System(bodies, **more)
    for ask in (ri.solve, ri.sweep):
        assert refused(f"must be given: .*{acting.split()[-1][:5]}", ask, row) == [
            "until"
        ]
    solution = ri.solve(row, 1e-4)
    assert not solution.final
    assert solution.outcome.driven
    assert acting in solution.status
    said = "gravity or a driven end" if len(bodies) > 1 else "no contact of this row"
    assert said in solution.outcome.why_no_restitution()


def test_bodies_that_fall_alike_come_to_an_end():
    assert ri.solve(ri.System([ROD, STILL], gravity=1.0)).final


@pytest.mark.parametrize(
    ("method", "counted", "remedy"),
    [
        ("fronts", "events", "Raise max_events"),
        ("characteristics", "steps of nodes", "until="),
        ("finite-difference", "steps times ends", "until="),
    ],
)
@pytest.mark.parametrize("cap", [7, 100])
def test_the_cap_ends_a_run_that_does_not_end(method, counted, remedy, cap):
    row = ri.System([ri.Wall(), ROD, ri.Wall()], [1e-3, 1e-3])
    solution = ri.solve(row, method=method, max_events=cap)
    assert (solution.stopped_by, solution.final) == ("max_events", False)
    assert (
        cap - 3 <= solution.events <= cap + 7
    )  # what happens at once is taken together
    assert math.isnan(solution.t_final)
    assert re.search(rf"Stopped by the cap of \d+ {counted}.*{remedy}", solution.status)


def test_an_accuracy_that_is_asked_for_chooses_a_method_that_takes_one():
    assert Options().method_for(ROW) == "fronts"
    assert Options(rtol=1e-3).method_for(ROW) == "characteristics"


GRID = [{"dt": 1e-6}, {"cells": 9}, {"snapshots": [0.0, 1e-5]}]


@pytest.mark.parametrize("options", GRID)
@pytest.mark.parametrize(
    "row",
    [
        ROW,
        ri.System([ROD, ri.Wall()], contacts=[ri.Spring(1e8)]),
        ri.System(
            [ri.RigidMass(1.0, velocity=1.0), ri.Wall()], contacts=[ri.Spring(1e8)]
        ),
    ],
    ids=["fronts", "characteristics", "without a rod"],
)
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


@pytest.mark.parametrize(
    ("system", "options", "said"),
    [
        (
            ri.System([ROD, THICK]),
            {"cells": 20},
            'the slower method "finite-difference" because of bodies.1.lateral_inertia: the method '
            '"fronts" has no lateral inertia.',
        ),
        (
            ri.System([LOSSY, LOSSY], **PUSHED),
            {"cells": 20},
            'the slower method "finite-difference" because of '
            "bodies.0.material.viscosity and 1 more: "
            'the method "characteristics" has no damping.',
        ),
        (
            ri.System([ROD, ROD], gravity=9.81),
            {},
            'the slower method "characteristics" because of gravity: '
            'the method "fronts" has no gravity.',
        ),
        (ri.System([ROD, ROD]), {}, ""),
        (ri.System([ROD, ROD], **PUSHED), {}, ""),
        (ri.System([ROD, ROD], gravity=9.81), {"rtol": 1e-3}, ""),
        (ri.System([ROD, THICK]), {"method": "finite-difference", "cells": 20}, ""),
    ],
)
def test_the_status_names_the_entry_that_calls_for_a_slower_method(
    system, options, said
):
    status = ri.solve(system, until=1e-5, **options).status
    assert said in status
    assert ("slower" in status) == bool(said)


CONE = ri.Rod(0.4, area=ri.Samples([1e-4, 2e-4]), material=STEEL)
RAMP = ri.Samples([0.0, 1.0], step=1e-5)
MIXED = ri.Rod(
    segments=[
        ri.Segment(0.5, 1e-4, STEEL),
        ri.Segment(
            0.5,
            1e-4,
            LOSSY.segments[0].material,
            polar_moment=1e-8,
            lateral_inertia="rayleigh-love",
        ),
    ]
)


@pytest.mark.parametrize(
    ("needed", "bodies", "more", "lacked"),
    [
        ("characteristics", [ri.RigidMass(2.0), ROD], {}, {"bodies.0": "rigid masses"}),
        (
            "characteristics",
            [ROD, ROD],
            PUSHED,
            {"contacts.0.law": "compliant contacts"},
        ),
        ("characteristics", [ROD], {"gravity": 1.0}, {"gravity": "gravity"}),
        (
            "characteristics",
            [ROD, ROD],
            {"contacts": [ri.Joint(1.0)]},
            {"contacts.0.law": "joints"},
        ),
        (
            "characteristics",
            [ROD.replace(velocity=ri.Samples([0.0, 1.0]))],
            {},
            {"bodies.0.velocity": "profiles other than steps"},
        ),
        (
            "characteristics",
            [ROD],
            {"ends": (ri.Moved(RAMP), ri.Free())},
            {"ends.left.value": "drives other than steps"},
        ),
        (
            "finite-difference",
            [THICK, MIXED, CONE],
            {},
            {
                "bodies.0.lateral_inertia": "lateral inertia",
                "bodies.1.segments.1.material.viscosity": "damping",
                "bodies.1.segments.1.lateral_inertia": "lateral inertia",
                "bodies.2.area": "tapered rods",
            },
        ),
        (
            "finite-difference",
            [ROD, THICK.replace(lateral_inertia="mindlin-herrmann")],
            {},
            {"bodies.1.lateral_inertia": "lateral inertia"},
        ),
    ],
)
def test_a_method_says_what_it_lacks_and_which_has_it(needed, bodies, more, lacked):
    row = ri.System(bodies, **more)
    for method in list(METHODS)[: list(METHODS).index(needed)]:
        assert problems(
            lambda method=method: Options(method=method).method_for(row)
        ) == {
            path: f'method "{method}" has no {what}; method "{needed}" has'
            for path, what in lacked.items()
        }
    assert Options(until=1.0).method_for(row) == needed


def test_steps_are_a_remedy_where_all_that_is_lacked_is_a_taper():
    [said] = problems(
        lambda: Options(method="fronts").method_for(ri.System([CONE, ROD]))
    ).values()
    assert said.endswith('"finite-difference" has, or give rod.in_steps(n)')


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
