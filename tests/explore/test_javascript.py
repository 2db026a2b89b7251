"""Kernels as JavaScript: what is translated and what is refused, and that nothing is
lost.
"""

import dataclasses
import inspect
import json
import math
import tomllib

import numpy as np
import pytest
from exhaustive import few_of
from in_node import needs_node, run
from networks import random_network
from systems import random_system

import rodimpact as ri
from rodimpact.explorer import fronts as explorer_fronts
from rodimpact.explorer.design import LIBRARY, tables_of, with_gauges
from rodimpact.explorer.fronts import new_run, outcome_of, run_to_end
from rodimpact.explorer.javascript import Untranslatable, javascript
from rodimpact.explorer.page_files import read
from rodimpact.explorer.presets import presets
from rodimpact.explorer.solved import scene_of
from rodimpact.explorer.solver import CONSTANTS, PROVIDED
from rodimpact.explorer.tables import request_of, system_of
from rodimpact.methods import tick_rule
from rodimpact.methods.fronts import records as front_records
from rodimpact.methods.fronts.family_layout import lay_out_family
from rodimpact.methods.pieces import driver, finality, layout, march
from rodimpact.methods.pieces import records as piece_records
from rodimpact.methods.row_builder import build_row
from rodimpact.methods.states import Stop
from rodimpact.storage.casefile import case_from

FEW_EVENTS = 5000
"""Events of a run in which the rounding of the clock does not matter."""
MAX_EVENTS = 20_000


# What is translated


def arithmetic(a, b):
    """Results of operators and functions of two numbers."""
    return [a // b, a % b, a * b, a - b, min(a, b), max(a, b), abs(a), -a, a <= b]


def rounding(x):
    """A number rounded in three ways."""
    return [int(x), round(x), math.floor(x)]


def flipped(a, b):
    """a with the bits of b flipped."""
    return a ^ b


def shifts(a, k):
    """a shifted by k bits: down, as a float, and its last three bits up."""
    return [a >> k, a * 2.0**-k, (a % 8) << k]


def of_numbers(x):
    """Results of functions of a number x, as a list, which JavaScript must compute as
    Python does.
    """
    return [
        math.frexp(x)[0],
        math.frexp(x)[1],
        math.sqrt(abs(x)),
        math.isfinite(x),
        x**2,
    ]


def loops(items):
    """Loops, comprehensions and slices of a list of numbers, in a list of results."""
    total = 0
    numbers = []
    last = 0
    for i, item in enumerate(items):
        if item < 0:
            continue
        total += item
        last = i
    for k in range(len(items) - 1, 0, -2):
        numbers.append(items[k])
        if items[k] == 4:
            break
    while total > 10:
        total //= 2
    a = total
    b = last
    a, b = b, a
    numbers.extend([x * 2 for x in items if x > 1])
    numbers.extend([i * j for i in range(3) for j in range(2)])
    for k in range(3):
        last = k
    for k in range(5):
        if k == items[0]:
            break
    named = {f"{k}": k, "last": last}
    ends = [
        items[-1],
        items[1:3],
        sorted(items),
        any(x > 6 for x in items),
        sum(x for x in items),
        max([0, *items]),
        4 in items,
    ]
    return [named, total, numbers, a, b, *ends]


def texts(x, n):
    """Formatted texts and dictionaries, in a list of results."""
    inner = {"x": x}
    table = {"name": "rod", "more": [1, 2], **inner}
    return [
        f"{x:.9g}",
        f"{x:.{n}g}",
        f"body {n} of {table['name']}",
        ", ".join(["a", "b"]),
        table.get("none", 3),
        "x" in table,
        n in (1, 2),
        [key for key, _ in table.items()],
        "rod"[:1].upper(),
        isinstance(table, dict),
        isinstance([], list),
        isinstance(x, float),
    ]


def shifted(a, k):
    """a shifted up by k bits."""
    return a << k


LARGE = (2**52 - 1, 2**52 - 7, -(2**51) - 3, 2**50 + 1)
WHOLE = [
    (a, b) for a in (-7, -6, -1, 0, 1, 6, 7, *LARGE) for b in (-4, -3, 1, 3, 7, 1 << 20)
]
SIZES = (1.0, 0.1, -2.5, 1e-320, 12345.678, 1e22, -1e-7, 100.0, 1e5)


@needs_node
@pytest.mark.parametrize(
    ("function", "arguments"),
    [
        (arithmetic, [(a, b) for a, b in WHOLE if abs(a * b) < 2**53]),
        (
            rounding,
            [(x,) for x in (-2.5, -1.5, -0.4, 0.5, 1.5, 2.5, 2.0**52 + 1, -7.9)],
        ),
        pytest.param(
            flipped, [(5, 1), (-5, 3), (2**31 - 1, 1)], marks=pytest.mark.exhaustive
        ),
        (shifts, [(a, k) for a in (*LARGE, -9, 0, 5) for k in (0, 1, 3, 40)]),
        (of_numbers, [(x,) for x in SIZES]),
        (loops, [([3, 1, 4, -1, 5, 9, 2, 6],), ([0, 8],)]),
        (texts, [(x, n) for x in SIZES for n in (1, 2, 6)]),
    ],
)
def test_javascript_computes_what_python_computes(function, arguments):
    """`arguments` are lists of arguments, one for each call."""
    text = javascript([function])
    answer = (
        f"const answer = (lists) => lists.map((list) => {function.__name__}(...list));"
    )
    script = f"{read('python.js')}\n{text}\n{answer}"
    in_python = [function(*list_of_call) for list_of_call in arguments]
    in_javascript = run(script, arguments)
    expected = json.loads(json.dumps(in_python))  # JSON makes lists of tuples
    assert in_javascript == expected


@needs_node
@pytest.mark.parametrize(
    ("function", "arguments"),
    [
        (flipped, (2**31, 1)),
        pytest.param(flipped, (1, 2**40), marks=pytest.mark.exhaustive),
        (shifted, (2**40, 20)),
        pytest.param(shifted, (1, -1), marks=pytest.mark.exhaustive),
        pytest.param(rounding, (2.0**53,), marks=pytest.mark.exhaustive),
        (rounding, (math.inf,)),
    ],
)
def test_a_number_that_javascript_cannot_hold_is_an_error_as_it_runs(
    function, arguments
):
    """A function translated to JavaScript throws RangeError for these arguments."""
    script = f"""{read("python.js")}\n{javascript([function])}
    const answer = (texts) => {{
      try {{ return {function.__name__}(...texts.map(Number)); }}
      catch (error) {{ return error.name; }}
    }};"""
    texts = [repr(x).replace("inf", "Infinity") for x in arguments]  # JSON has no inf
    assert run(script, texts) == "RangeError"


# Functions whose first line has something that is not translated


def unknown_name():
    return json


def unknown_call(a):
    return json.dumps(a)


def unknown_method(a):
    return a.index(3)


def large_constant():
    return 9007199254740993


def with_statement(a):
    with a:
        pass


def of_an_array(a):
    return a.shape[0]


@pytest.mark.parametrize(
    ("function", "line", "syntax"),
    [
        (unknown_name, 1, "the name json"),
        (large_constant, 1, "9007199254740993"),
        (with_statement, 1, "With"),
        (of_an_array, 1, "the attribute shape"),
        (unknown_call, 1, "calling json.dumps"),
        (unknown_method, 1, "index"),
    ],
)
def test_syntax_that_is_not_translated_is_named_with_its_line(function, line, syntax):
    """`line` counts from that of `def`."""
    with pytest.raises(Untranslatable) as error:
        javascript([function])
    message = str(error.value)
    _, line_of_def = inspect.getsourcelines(function)
    assert f"test_javascript.py:{line_of_def + line}: " in message
    assert syntax in message


# Kernels on records

KERNEL = march.run_nodes


def state_of(system, until):
    """The state of a system on the clock of the page, of lists of objects."""
    request = layout.RunRequest(
        until, tolerance=1e-8, max_steps=400, keeps_history=True
    )
    members = driver.Members(build_row(system), request)
    batch = members.batch
    batch.to_lists()
    for _ in range(2):  # so that short runs are not stopped by a full log
        batch.lengthen("log", "contact_log")
    members.load()
    return batch.state


def tables_of_records(objects):
    """Objects as dicts, as JSON has them; a list of anything else is returned as it is."""
    if not objects or not dataclasses.is_dataclass(objects[0]):
        return objects
    first = objects[0]
    names = [field.name for field in dataclasses.fields(first)]
    tables = []
    for record in objects:
        tables.append({name: getattr(record, name) for name in names})
    return tables


def tables_of_state(state):
    """{name: records} of a state, as JSON has them."""
    tables = {}
    for name, records in state._asdict().items():
        tables[name] = tables_of_records(records)
    return tables


@needs_node
@pytest.mark.parametrize("seeds", few_of([range(3), range(6)], [range(3)]))
def test_the_kernel_of_characteristics_does_the_same_on_the_same_records(
    monkeypatch, seeds
):
    """The kernel in Python and its translation to JavaScript run on the same states of
    random rows: they stop for the same reason and leave the same tables. Every reason
    for stopping occurs.
    """
    for module in (tick_rule, finality, layout, driver, march):
        for constant in CONSTANTS.keys() & vars(module).keys():
            monkeypatch.setattr(module, constant, CONSTANTS[constant])
    script = f"""{read("python.js")}\n{javascript([KERNEL], CONSTANTS)}
    const answer = (all) => all.map((state) => ({{ why: run_nodes(state), state }}));"""
    states = []
    for seed in seeds:
        is_driven = seed % 2 > 0
        until = 0.7 if is_driven else None
        system = random_network(seed, driven=is_driven)
        states.append(state_of(system, until))
    pages = run(script, [tables_of_state(state) for state in states])
    reasons = {page["why"] for page in pages}
    assert reasons == {Stop.FULL, Stop.DONE, Stop.CAP}  # each occurs
    for seed, state, page in zip(seeds, states, pages, strict=True):
        # The kernel changes the state in place.
        assert page["why"] == KERNEL(state)
        tables = tables_of_state(state)
        # The matrix is memory that is reused: what is left in it has no meaning.
        for name in set(state._fields) - {"matrix"}:
            assert page["state"][name] == tables[name], (seed, name)


# The solver


def rows(seeds):
    """Random rows as tables, half of them with lengths that have no common measure."""
    cases = []
    for seed in seeds:
        rng = np.random.default_rng(seed)
        if seed % 2:
            system = random_system(seed, bodies=6)
            case = tomllib.loads(ri.format_case(system))
        else:
            system = random_system(seed, bodies=3)
            case = tomllib.loads(ri.format_case(system))
            for body in case["bodies"]:
                stretch_segments(body, rng)
        case["solve"] = {}
        cases.append(case)
    return cases


def stretch_segments(body, rng):
    """Make the segments of a body up to a tenth longer, in place.

    A body whose velocity has steps is left as it is. Steps of strain keep their places,
    which are inside the longer body, too.
    """
    if isinstance(body["velocity"], dict):
        return
    for segment in body.get("segments", [body]):
        if "length" in segment:
            segment["length"] *= float(rng.uniform(1.0, 1.1))


SOLVES = (
    system_of,
    request_of,
    build_row,
    lay_out_family,
    new_run,
    run_to_end,
    outcome_of,
)


def solved_by_the_page(cases):
    """Outcomes of cases on the page, each with two more entries: the number of
    `events`, and `rounded`, the relative error by rounding to ticks.

    Runs stop at the proof, and their outcomes have no status.
    """
    kernels = javascript(SOLVES, CONSTANTS, PROVIDED)
    script = f"""{read("python.js")}\n{read("numbers.js")}\n{kernels}
    const answer = ({{ cases, library }}) => cases.map((tables) => {{
      const plan = lay_out_family(build_row(system_of(tables, library)));
      const past_the_proof = false;
      const run = run_to_end(request_of(tables), past_the_proof, new_run(plan));
      const no_status = "";
      const outcome = outcome_of(run, no_status);
      const {{ events, velocity_scale }} = run.record;
      const rounded = outcome.errors.velocity / (events * velocity_scale || 1);
      return {{ ...outcome, events, rounded }};
    }});"""
    return run(script, {"cases": cases, "library": LIBRARY})


def test_the_clock_of_the_page_sets_constants_that_there_are():
    """A constant that was renamed would leave the page on the clock of Python."""
    modules = (tick_rule, front_records, piece_records, explorer_fronts)
    names = {name for module in modules for name in vars(module)}
    assert set(CONSTANTS) <= names


@needs_node
@pytest.mark.parametrize(
    "seeds", few_of([range(8), range(8, 100), range(100, 200)], [range(8)])
)
def test_the_page_solves_rows_as_solve_does(seeds):
    """The page and `solve` agree on finality, velocities and e of random rows:
    velocities to 1e-11 of the closing speed, or to the rounding of the clock if there
    are many events.
    """
    cases = rows(seeds)
    n_exact = 0
    for case, page in zip(cases, solved_by_the_page(cases), strict=True):
        if page["events"] >= MAX_EVENTS:
            # The page and `solve` may cut the run at different times.
            continue
        system = case_from(case).system
        outcome = ri.solve(system, max_events=MAX_EVENTS).outcome
        tolerance = 2 * page["errors"]["velocity"]
        if page["events"] < FEW_EVENTS and page["rounded"] < 2.0**-42:
            n_exact += 1
            closing = max(outcome.velocities_before) - min(outcome.velocities_before)
            tolerance = 1e-11 * max(closing, 1e-3)
        assert page["final"] == outcome.final
        velocities = outcome.velocities_after
        assert page["after"] == pytest.approx(velocities, abs=tolerance)
        has_e = outcome.why_no_restitution() == ""
        page_has_e = page["why"] == ""
        assert page_has_e == has_e
        if has_e:
            error = abs(page["restitution"] - outcome.restitution)
            assert error <= 1e-9
            assert error <= page["error"] + 1e-12  # Python rounds transit times, too
    assert n_exact >= len(seeds) / 2  # at least half hold the narrow bound


# The scene


def plain(value):
    """A scene without what differs in writing only: the minus, the space and the µ of
    units.
    """
    if isinstance(value, str):
        return value.replace("\u2212", "-").replace("\u00a0", " ").replace("µ", "u")
    if isinstance(value, dict):
        return {key: plain(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [plain(entry) for entry in value]
    return value


def assert_alike(page, python, path=""):
    """Assert that the answer of the page has all entries of that of Python.

    Floats are equal to 1e-7 and an absolute tolerance, 1e-9 for one alone and 1e-8 of
    the largest in a list; texts, flags, whole numbers and None are equal. `path` is
    that of an entry in the answer, for messages.
    """
    if isinstance(python, dict):
        assert set(page) >= set(python), path
        for key, value in python.items():
            assert_alike(page[key], value, f"{path}.{key}")
    # A list that begins with a float has floats only.
    elif isinstance(python, list) and python and isinstance(python[0], float):
        scale = max(map(abs, python))
        np.testing.assert_allclose(
            page, python, rtol=1e-7, atol=1e-8 * scale, err_msg=path
        )
    elif isinstance(python, list):
        assert len(page) == len(python), path
        for i, entry in enumerate(python):
            assert_alike(page[i], entry, f"{path}.{i}")
    elif isinstance(python, float):
        assert page == pytest.approx(python, rel=1e-7, abs=1e-9), path
    else:
        assert page == python, path


STEEL = ri.materials.steel
LEFT = ri.Rod(0.4, area=1e-4, material=STEEL, velocity=1.0)
STEPPED = ri.Rod(
    segments=[ri.Segment(0.1, 1e-4, STEEL), ri.Segment(0.2, 2e-4, STEEL)],
    velocity=ri.Steps([1.0, 0.5], [0.1]),
    strain=1e-5,
)
SYSTEMS = {
    **{preset.key: (preset.case.system, {}) for preset in presets()},
    "stepped": (ri.System([STEPPED, LEFT.replace(velocity=0.0)]), {}),
    "moving wall": (ri.System([LEFT, ri.Wall(velocity=-0.5)], [1e-5]), {}),
    "bonded": (
        ri.System([LEFT, LEFT.replace(velocity=0.0)], contacts=[ri.Bonded()]),
        {"until": 1e-3},
    ),
    "pushed": (
        ri.System(
            [LEFT, LEFT], ends=(ri.Pushed(ri.Steps([1e3, 0.0], [1e-4])), ri.Absorbing())
        ),
        {"until": 1e-3},
    ),
    "apart": (ri.System([LEFT.replace(velocity=-1.0), LEFT]), {}),
}
DESIGNS = {}
for key, (system, options) in SYSTEMS.items():
    DESIGNS[key] = tables_of(with_gauges(ri.Case(system, options)))


PAGE_SCRIPTS = (
    "numbers.js",
    "python.js",
    "kernels.js",
    "fields.js",
    "solver.js",
    "curves.js",
    "toml.js",
)


def answers(function, designs):
    """Results of a function of the page, run in JavaScript for each of the designs."""
    script = "\n".join(map(read, PAGE_SCRIPTS))
    script += f"""
    const setTimeout = () => 0;  // curves are solved at rest, of the design on the page
    let embedded;
    const answer = (data) => {{
      embedded = data.embedded;
      return data.designs.map((design) => {function}(design, embedded.materials));
    }};
    """
    embedded = {"materials": LIBRARY}
    return run(script, {"embedded": embedded, "designs": designs})


@pytest.mark.exhaustive
@needs_node
def test_joints_too_many_fronts_and_lengths_that_are_no_number_are_told_on_the_page():
    """The translated page refuses a joint, a rod with too many fronts, and a length
    "x", each with a message.
    """
    with_joint = ri.System([LEFT, LEFT], contacts=[ri.Joint(1e10)])
    n_pieces = 3200  # of the velocity along the rod, 0.4 m
    jumps = np.linspace(0.0, 0.4, n_pieces + 1)[1:-1]  # inside the rod
    velocities = np.arange(float(n_pieces)) % 2  # 0 and 1 m/s in turn
    steps = ri.Steps(velocities, jumps)
    crowded = ri.System([LEFT.replace(velocity=steps), LEFT])
    rod_of_no_length, _ = tables_of(ri.Case(with_joint))["case"]["bodies"]
    rod_of_no_length["length"] = "x"
    designs = [
        tables_of(ri.Case(with_joint)),
        tables_of(ri.Case(crowded)),
        {"case": {"bodies": [rod_of_no_length]}},
    ]

    pages = answers("sceneOf", designs)

    of_joint, of_fronts, of_length = [page["problems"][0]["message"] for page in pages]
    assert 'law "joint"; Python can' in of_joint
    assert "too many fronts" in of_fronts
    assert of_length == "must be a finite positive number of metres, got no number"


@needs_node
def test_scenes_of_the_page_are_those_of_python_with_the_same_functions():
    """For each of `DESIGNS`, the scene made in JavaScript equals that made in Python as
    nearly as is drawn; in Python fronts run on a longer clock. Restitutions are those
    of closed forms.
    """
    pages = answers("sceneOf", [*DESIGNS.values()])
    for key, answer in zip(DESIGNS, pages, strict=True):
        design = DESIGNS[key]
        scene = scene_of(design["case"], design["gauges"], LIBRARY)
        python = json.loads(json.dumps(scene, allow_nan=False))
        restitution = python["restitution"]
        if restitution["closed_form"]:
            closed_form = restitution["closed_form"]["restitution"]
            assert restitution["value"] == pytest.approx(closed_form, abs=1e-12)
        assert_alike(plain(answer["scene"]), plain(python), key)


@needs_node
def test_the_page_writes_the_case_file_of_its_design():
    pages = answers("tomlOf", [*DESIGNS.values()])
    for design, text in zip(DESIGNS.values(), pages, strict=True):
        assert tables_of(ri.parse_case(text)) == design
