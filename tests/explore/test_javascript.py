"""Kernels as JavaScript: what is translated and what is refused, and that nothing is lost."""

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
from rodimpact.explorer.fronts import outcome_of, run_of, space_of
from rodimpact.explorer.javascript import Untranslatable, javascript
from rodimpact.explorer.page_files import read
from rodimpact.explorer.presets import presets
from rodimpact.explorer.solved import scene_of
from rodimpact.explorer.solver import CONSTANTS, KNOWN
from rodimpact.explorer.tables import RULES, request_of, system_of
from rodimpact.methods import tick_rule
from rodimpact.methods.fronts import records as front_records
from rodimpact.methods.fronts.family_layout import lay_out_family
from rodimpact.methods.pieces import driver, finality, layout, march
from rodimpact.methods.pieces import records as piece_records
from rodimpact.methods.row_builder import build_row
from rodimpact.methods.states import Stop
from rodimpact.storage.casefile import case_from

FEW, MOST = 5000, 20_000


# What is translated


def arithmetic(a, b):
    return [a // b, a % b, a * b, a - b, min(a, b), max(a, b), abs(a), -a, a <= b]


def rounding(x):
    return [int(x), round(x), math.floor(x)]


def flipped(a, b):
    return a ^ b


def shifts(a, k):
    return [a >> k, a * 2.0**-k, (a % 8) << k]


def of_numbers(x):
    return [
        math.frexp(x)[0],
        math.frexp(x)[1],
        math.sqrt(abs(x)),
        math.isfinite(x),
        x**2,
    ]


def loops(items):
    total, found, last = 0, [], 0
    for i, item in enumerate(items):
        if item < 0:
            continue
        total += item
        last = i
    for k in range(len(items) - 1, 0, -2):
        found.append(items[k])
        if items[k] == 4:
            break
    while total > 10:
        total //= 2
    a, b = total, last
    a, b = b, a
    found.extend([x * 2 for x in items if x > 1])
    found.extend([i * j for i in range(3) for j in range(2)])
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
    return [named, total, found, a, b, *ends]


def texts(x, n):
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
    return a << k


LARGE = (2**52 - 1, 2**52 - 7, -(2**51) - 3, 2**50 + 1)
WHOLE = [
    (a, b) for a in (-7, -6, -1, 0, 1, 6, 7, *LARGE) for b in (-4, -3, 1, 3, 7, 1 << 20)
]
SIZES = (1.0, 0.1, -2.5, 1e-320, 12345.678, 1e22, -1e-7, 100.0, 1e5)


@needs_node
@pytest.mark.parametrize(
    ("function", "given"),
    [
        (arithmetic, [(a, b) for a, b in WHOLE if abs(a * b) < 2**53]),
        (
            rounding,
            [(x,) for x in (-2.5, -1.5, -0.4, 0.5, 1.5, 2.5, 2.0**52 + 1, -7.9)],
        ),
        (flipped, [(5, 1), (-5, 3), (2**31 - 1, 1)]),
        (shifts, [(a, k) for a in (*LARGE, -9, 0, 5) for k in (0, 1, 3, 40)]),
        (of_numbers, [(x,) for x in SIZES]),
        (loops, [([3, 1, 4, -1, 5, 9, 2, 6],), ([0, 8],)]),
        (texts, [(x, n) for x in SIZES for n in (1, 2, 6)]),
    ],
)
def test_javascript_computes_what_python_computes(function, given):
    text = javascript([function])
    answer = (
        f"const answer = (all) => all.map((given) => {function.__name__}(...given));"
    )
    script = f"{read('python.js')}\n{text}\n{answer}"
    expected = [json.loads(json.dumps(function(*arguments))) for arguments in given]
    assert run(script, given) == expected


@needs_node
@pytest.mark.parametrize(
    ("function", "given"),
    [
        (flipped, (2**31, 1)),
        (flipped, (1, 2**40)),
        (shifted, (2**40, 20)),
        (shifted, (1, -1)),
        (rounding, (2.0**53,)),
        (rounding, (math.inf,)),
    ],
)
def test_what_javascript_cannot_hold_is_refused_as_it_runs(function, given):
    """Not an infinity: JSON has none."""
    script = (
        f"{read('python.js')}\n{javascript([function])}\nconst answer = (given) => {{\n"
    )
    script += f"try {{ return {function.__name__}(...given.map(Number)); }}"
    script += " catch (error) { return error.name; } };"
    assert (
        run(script, [repr(x) if math.isfinite(x) else "Infinity" for x in given])
        == "RangeError"
    )


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
    ("function", "line", "what"),
    [
        (unknown_name, 1, "the name json"),
        (large_constant, 1, "9007199254740993"),
        (with_statement, 1, "With"),
        (of_an_array, 1, "the attribute shape"),
        (unknown_call, 1, "calling json.dumps"),
        (unknown_method, 1, "index"),
    ],
)
def test_what_is_not_translated_is_named_with_its_line(function, line, what):
    with pytest.raises(Untranslatable) as error:
        javascript([function])
    first = inspect.getsourcelines(function)[1]
    assert f"test_javascript.py:{first + line}: " in str(error.value)
    assert what in str(error.value)


# Kernels on records

KERNEL = march.run_nodes


def recorded(system, until):
    """The state of a system on the clock of the page, of lists of objects."""
    members = driver.Members(
        build_row(system), layout.RunRequest(until, 1e-8, 400, True)
    )
    members.batch.to_lists()
    for _ in range(2):
        members.batch.lengthen("log", "contact_log")
    members.load()
    return members.batch.state


def tables(objects):
    """Objects, or lists of numbers, as JSON has them."""
    return [
        one if isinstance(one, list) else dataclasses.asdict(one) for one in objects
    ]


@needs_node
def test_the_kernel_of_characteristics_does_the_same_on_the_same_records(monkeypatch):
    for module in (tick_rule, finality, layout, driver, march):
        for constant in CONSTANTS.keys() & vars(module).keys():
            monkeypatch.setattr(module, constant, CONSTANTS[constant])
    script = f"""{read("python.js")}\n{javascript([KERNEL], CONSTANTS)}
    const answer = (all) => all.map((state) => ({{ why: run_nodes(state), state }}));"""
    states = [
        recorded(random_network(seed, driven=driven), 0.7 if driven else None)
        for seed in range(16)
        for driven in [seed % 2 > 0]
    ]
    pages = run(
        script,
        [
            {name: tables(values) for name, values in state._asdict().items()}
            for state in states
        ],
    )
    assert {page["why"] for page in pages} == {Stop.FULL, Stop.DONE, Stop.CAP}
    for seed, (state, page) in enumerate(zip(states, pages, strict=True)):
        assert page["why"] == KERNEL(state)
        for name in set(state._fields) - {"matrix"}:
            pairs = zip(page["state"][name], tables(getattr(state, name)), strict=True)
            for i, (theirs, ours) in enumerate(pairs):
                for key, value in ours.items():
                    assert theirs[key] == value, (seed, name, i, key)


# The solver


def rows(seeds):
    """Random rows as tables, half of them with lengths that have no common measure."""
    found = []
    for seed in seeds:
        rng = np.random.default_rng(seed)
        system = random_system(seed, bodies=6 if seed % 2 else 3)
        case = tomllib.loads(ri.write_case(system))
        for body in case["bodies"]:
            for piece in body.get("segments", [body]):
                if (
                    seed % 2 == 0
                    and "length" in piece
                    and not isinstance(body["velocity"], dict)
                ):
                    piece["length"] *= float(rng.uniform(1.0, 1.1))
        found.append({**case, "solve": {}})
    return found


SOLVES = (
    system_of,
    request_of,
    build_row,
    lay_out_family,
    space_of,
    run_of,
    outcome_of,
)


def solved_by_the_page(cases):
    """Outcomes, events, and errors of transit times."""
    script = f"""{read("python.js")}\n{read("numbers.js")}\n{javascript(SOLVES, CONSTANTS, KNOWN)}
    const answer = ({{ cases, library }}) => cases.map((tables) => {{
      const plan = lay_out_family(build_row(system_of(tables, library)));
      const run = run_of(request_of(tables), false, space_of(plan));
      const outcome = outcome_of(run, "");
      const rounded = outcome.errors.velocity / (run.run.events * run.run.velocity_scale || 1);
      return {{ ...outcome, events: run.run.events, rounded }};
    }});"""
    return run(script, {"cases": cases, "library": LIBRARY})


def test_the_clock_of_the_page_sets_constants_that_there_are():
    """A constant that was renamed would leave the page on the clock of Python."""
    modules = (tick_rule, front_records, piece_records, explorer_fronts)
    names = {name for module in modules for name in vars(module)}
    assert set(CONSTANTS) <= names


@needs_node
@pytest.mark.parametrize("block", few_of(range(3), {0}))
def test_the_page_solves_rows_as_solve_does(block):
    """To 1e-11 of the closing speed where events are few, elsewhere to what the clock rounds."""
    cases, few = rows(range(100 * block, 100 * block + 100)), 0
    for case, page in zip(cases, solved_by_the_page(cases), strict=True):
        if page["events"] >= MOST:  # cut short, nobody knows where
            continue
        outcome = ri.solve(case_from(case).system, max_events=MOST).outcome
        assert page["final"] == outcome.final
        worst = 2 * page["errors"]["velocity"]
        if page["events"] < FEW and page["rounded"] < 2.0**-42:
            few += 1
            closing = max(outcome.velocities_before) - min(outcome.velocities_before)
            worst = 1e-11 * max(closing, 1e-3)
        assert page["after"] == pytest.approx(outcome.velocities_after, abs=worst)
        why = outcome.why_no_restitution()
        assert (page["why"] == "") == (why == "")
        if not why:
            assert page["restitution"] == pytest.approx(outcome.restitution, abs=1e-9)
            off = abs(page["restitution"] - outcome.restitution)
            assert off <= page["error"] + 1e-12  # in Python transits are rounded, too
    assert few >= 50


# The scene


def plain(found):
    """A scene without what differs in writing only: the minus, the space and the µ of units."""
    if isinstance(found, str):
        return found.replace("\u2212", "-").replace("\u00a0", " ").replace("µ", "u")
    if isinstance(found, dict):
        return {key: plain(value) for key, value in found.items()}
    return (
        [plain(value) for value in found] if isinstance(found, list | tuple) else found
    )


def assert_alike(page, python, path=""):
    """Texts are equal and numbers as near as what is drawn."""
    if isinstance(python, dict):
        assert set(page) >= set(python), path
        for key, value in python.items():
            assert_alike(page[key], value, f"{path}.{key}")
    elif isinstance(python, list) and python and isinstance(python[0], float):
        scale = max(map(abs, python))
        np.testing.assert_allclose(
            page, python, rtol=1e-7, atol=1e-8 * scale, err_msg=path
        )
    elif isinstance(python, list):
        assert len(page) == len(python), path
        for i, (one, other) in enumerate(zip(page, python, strict=True)):
            assert_alike(one, other, f"{path}.{i}")
    elif isinstance(python, float) and not isinstance(python, bool):
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
DESIGNS = {
    key: tables_of(with_gauges(ri.Case(*given))) for key, given in SYSTEMS.items()
}


def answers(function, designs):
    """What a function of the page makes of designs, in a page that solves by itself."""
    script = "\n".join(
        map(read, ("numbers.js", "python.js", "kernels.js", "controls.js", "solver.js"))
    )
    script += f"""
    const setTimeout = () => 0;  // curves are solved at rest, of the design on the page
    let start;
    const answer = (data) => {{
      start = data.start;
      return data.designs.map((design) => {function}(design, start.materials));
    }};
    """
    start = {"materials": LIBRARY, "rules": RULES}
    return run(script, {"start": start, "designs": designs})


@needs_node
def test_what_the_page_cannot_solve_is_told():
    jumps = np.linspace(0.0, 0.4, 3201)[1:-1]
    crowded = LEFT.replace(velocity=ri.Steps(np.arange(3200.0) % 2, jumps))
    designs = [
        tables_of(ri.Case(system))
        for system in (
            ri.System([LEFT, LEFT], contacts=[ri.Joint(1e10)]),
            ri.System([crowded, LEFT]),
        )
    ]
    designs.append({"case": {"bodies": [{"kind": "rod", "length": "x"}]}})
    told = [page["problems"][0]["message"] for page in answers("sceneOf", designs)]
    for words, message in zip(
        ('law "joint"; Python can', "too many fronts", ""), told, strict=True
    ):
        assert words in message


@needs_node
def test_the_page_shows_what_python_finds_with_the_same_functions():
    """In Python fronts run on a longer clock."""
    pages = answers("sceneOf", [*DESIGNS.values()])
    for (key, sent), answer in zip(DESIGNS.items(), pages, strict=True):
        page = answer["data"]
        here = json.loads(
            json.dumps(scene_of(sent["case"], sent["gauges"], LIBRARY), allow_nan=False)
        )
        e = here["restitution"]
        if e["closed_form"]:
            assert e["value"] == pytest.approx(
                e["closed_form"]["restitution"], abs=1e-12
            )
        assert_alike(plain(page), plain(here), key)


@needs_node
def test_the_page_writes_the_case_file_of_its_design():
    pages = answers("tomlOf", [*DESIGNS.values()])
    for sent, text in zip(DESIGNS.values(), pages, strict=True):
        assert tables_of(ri.parse_case(text)) == sent
