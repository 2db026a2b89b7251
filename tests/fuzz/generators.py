"""Random input of every kind that people, programs and attackers give, and what must come of it.

Each test goes through a number of examples; RODIMPACT_FUZZ=100 makes it a hundred times as many,
and RODIMPACT_FUZZ_SEED=7 makes it others.
"""

import datetime
import decimal
import fractions
import linecache
import math
import os
import re
import signal
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import numpy as np
from exhaustive import few_of

import rodimpact as ri
from rodimpact.results.saved import case_of

TIMES = int(os.environ.get("RODIMPACT_FUZZ", "1"))
SEED = int(os.environ.get("RODIMPACT_FUZZ_SEED", "0"))
SEEDS = few_of(range(SEED, SEED + 3), [SEED])
PATIENCE = 600  # s, for what takes milliseconds, or a minute where a busy machine has to compile
ROOT = str(Path(ri.__file__).parent)


@contextmanager
def patience(seconds=PATIENCE):
    """TimeoutError where it hangs, on systems that have such an alarm."""

    def hung(*_):
        raise AssertionError(f"it takes more than {seconds} s")

    if not hasattr(signal, "SIGALRM"):
        yield
        return
    before = signal.signal(signal.SIGALRM, hung)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


STEEL = ri.materials.steel
SAVED = ri.write_case(
    case_of(
        ri.solve(
            ri.System(
                [
                    ri.RigidMass(1.0, velocity=1.0),
                    ri.Rod(0.2, area=1e-4, material=STEEL),
                ],
                contacts=[ri.Hertz(1e9)],
            ),
            until=1e-4,
        )
    )
)
"""A saved solution."""

# Text ---------------------------------------------------------------------------------------------

FOLDER = Path(__file__).parents[2] / "validation" / "cases"
CASES = [
    (FOLDER / f"{name}.toml").read_text("utf-8")
    for name in (
        "unequal-rods",
        "dropped-bar",
        "clamped-bar",
        "hopkinson-specimen",
        "rounded-rod-on-wall",
        "newtons-cradle",
        "stepped-rods",
    )
] + [
    """schema = 1
gravity = "-9.81 m/s^2"
bodies = [
  {kind = "wall", velocity = "1 cm/s"}, {kind = "mass", mass = "100 g", velocity = -1},
  {kind = "rod", length = 0.1, area = {samples = ["2 cm^2", 1e-4]}, material = "lossy"},
]
contacts = [{restitution = 0.5, gap = 1e-4},
            {law = "hunt-crossley", stiffness = 1e9, damping = 0.1}]
materials.lossy = {youngs_modulus = 2e11, density = 7850, loss_factor = 0.01, loss_frequency = 1e3}
ends.right = {kind = "force", value = {values = [0, 100, 0], at = [1e-5, "50 us"]}}
solve = {until = 1e-4, cells = 8, snapshots = 5}
""",
    SAVED,
]
NUMBERS = [
    "0",
    "-0.0",
    "1",
    "-1",
    "2",
    "0.1",
    "1e-4",
    "1e-30",
    "1e-160",
    "1e-308",
    "5e-324",
    "1e-400",
    "1e30",
    "1e150",
    "1e300",
    "1e308",
    "1e309",
    "nan",
    "inf",
    "-inf",
    "1_000",
    "0x10",
    "10" * 20,
    "9" * 400,
    "9" * 6000,
    "0.1" + "0" * 2000,
    "1e" + "9" * 30,
    "1979-05-27",
    "07:32:00",
    "true",
    "9223372036854775807",
    "9223372036854775808",
]
WORDS = [
    '"steel"', '"chees"', '"rod"', '"mass"', '"wall"', '"inf"', '"nan"', '"1 mm"', '"1 furlong"',
    '"1e400 m"', '"-3 m/s"', '"1 m m"', '"\u00b5m"', '"1 \u00b5m"', '"\u0661 m"',
    '"' + "1" * 20000 + '"',
    '"' + "m" * 20000 + '"', '"1' + "*" * 500 + 'm"', '""', '" "', '"\\u0000"', '"\\u001b[31m"',
    '"\u202e\U0001f600"', '"auto"', '"fronts"', '"finite-difference"', '"bonded"', '"hertz"',
    '"spring"', '"circular"', '"fixed"', '"velocity"', '"force"',
    "[]", "{}", "[1, 2]", "[[1]]", "{samples = [1, 2]}", "{values = [1, 2], at = [0.05]}",
    "{values = [1], at = []}", "{samples = [1, nan]}", "{samples = [1, 2], step = 1e-5}",
    "[" * 400 + "]" * 400, "{a = " * 90 + "1" + "}" * 90, "'''\n'''", '"""', "#", "=", "\n", ",",
    "[[bodies]]\n", "[solve]\n", "[output]\nsave = 'x.toml'\n", "[ends.left]\nkind = 'fixed'\n",
    "until", "gap", "velocity", "law", "length", "kind", "stiffness", "damping", "a" * 5000,
    "\x00", "\ufeff", "\u2028", "\r",
]  # fmt: skip
TOKEN = re.compile(r"(?:\d|\.\d|-[\d.])[\w.+-]*|[^\W\d][\w-]*|\s+|.", re.DOTALL)


def one_of(rng, things):
    """Any one of these."""
    return things[rng.integers(len(things))]


def random_number(rng, near="1"):
    """The text of a number: of those that hurt, of any magnitude, or not far from one given."""
    kind = rng.random()
    if kind < 0.2:
        return one_of(rng, NUMBERS)
    if kind < 0.4:
        return repr(float(rng.choice([-1, 1, 1]) * 10 ** rng.uniform(-12, 12)))
    try:
        return repr(float(near) * 10 ** rng.uniform(-1, 1))
    except ValueError:
        return "0.3"


def spoilt_text(rng, text):
    """A text with a few pieces of it replaced, left out, doubled or exchanged."""
    tokens = TOKEN.findall(text)
    for _ in range(rng.geometric(0.5)):
        i, j = rng.integers(len(tokens), size=2).tolist()
        numbers = [
            k for k, token in enumerate(tokens) if token.strip("-.")[:1].isdigit()
        ]
        words = [k for k, token in enumerate(tokens) if token[:1].isalpha()]
        kind = rng.integers(20)
        if kind < 12 and numbers:
            place = one_of(rng, numbers)
            odd = rng.random() < 0.2
            tokens[place] = (
                one_of(rng, WORDS) if odd else random_number(rng, tokens[place])
            )
        elif kind < 15 and words:
            tokens[one_of(rng, words)] = tokens[one_of(rng, words)]
        elif kind == 15:
            tokens[i] = one_of(rng, WORDS)
        elif kind == 16:
            tokens[i], tokens[j] = tokens[j], tokens[i]
        elif kind == 17:
            tokens = [*tokens[:i], *tokens[i + rng.geometric(0.3) :]] or [""]
        elif kind == 18:
            tokens[i:i] = tokens[j : j + rng.geometric(0.1)]
        else:
            tokens[i:i] = [one_of(rng, WORDS)]
    return "".join(tokens)


def spoilt_bytes(rng, text):
    """A file of it, now and then with bytes that are no text."""
    data = bytearray(text.encode("utf-8", "surrogatepass"))
    if rng.random() < 0.1:
        place = rng.integers(len(data) + 1)
        data[place:place] = rng.bytes(rng.integers(1, 30))
    return bytes(data) if rng.random() > 0.01 else rng.bytes(rng.integers(2000))


# Objects ------------------------------------------------------------------------------------------

RODS = [
    ri.Rod(0.2, area=1e-4, material=STEEL, velocity=1.0),
    ri.Rod(0.3, area=2e-4, material=STEEL),
]
PAIR = ri.System(RODS)
FAMILY = ri.System(
    [ri.Rod([0.1, 0.2], area=1e-4, material=STEEL, velocity=1.0), ri.Wall()]
)
VOLTS = ri.Signal(np.hanning(50), dt=1e-6, unit="V")
BAR = ri.waves.Bar(5000.0, 0.3, 0.01)
SOLVED = cache(lambda: ri.solve(PAIR))
FLAGS = {
    "force",
    "dimensionless",
    "across",
    "allow_energy_release",
}  # whatever has a truth


class Hostile:
    """No number, though it answers every question as one might."""

    def __repr__(self):
        return "Hostile()" * 100


def objects(rng):
    """Things of every kind, each made anew."""
    rod = ri.Rod(0.4, area=1e-4, material=STEEL, velocity=1.0)
    family = ri.Rod(np.array([0.1, 0.2]), area=1e-4, material=STEEL, velocity=1.0)
    x = float(rng.choice([-1, 1, 1, 1]) * 10 ** rng.uniform(-6, 6))
    return [
        x,
        x,
        x,
        1.0,
        0.5,
        0.0,
        -0.0,
        1e-160,
        5e-324,
        1e308,
        -1e308,
        math.nan,
        math.inf,
        -math.inf,
        0,
        1,
        2,
        3,
        -1,
        10**18,
        10**400,
        -(10**30),
        True,
        False,
        None,
        1j,
        "1",
        "1 m",
        "",
        "steel",
        "auto",
        "fronts",
        "characteristics",
        "finite-difference",
        "length",
        "m\x00",
        b"1",
        bytearray(b"1"),
        fractions.Fraction(1, 3),
        decimal.Decimal("0.1"),
        decimal.Decimal("sNaN"),
        np.float32(0.1),
        np.longdouble(0.1),
        np.float64(x),
        np.int8(3),
        np.uint64(2**63),
        np.bool_(True),
        np.datetime64("2000-01-01"),
        datetime.date(2000, 1, 1),
        np.array(0.3),
        np.array([]),
        np.array([0.1, 0.2]),
        np.array([[0.1], [x]]),
        np.ones((2, 0)),
        np.array([0.1, math.nan]),
        np.array(["1", "2"]),
        np.array([1, None], dtype=object),
        np.ma.masked_array([1.0, 2.0], [True, False]),
        np.array([1j]),
        np.ones(3, dtype=bool),
        np.ones((1,) * 33),
        [0.1, 0.2],
        [1, [2, 3]],
        [],
        [None],
        (1, 2),
        {},
        {"a": 1},
        {1, 2},
        range(3),
        iter([1.0]),
        (i for i in (1, 2)),
        print,
        float,
        ri.Rod,
        object(),
        Hostile(),
        STEEL,
        rod,
        family,
        ri.Wall(),
        ri.RigidMass(1.0, velocity=-1.0),
        ri.Rigid(),
        ri.Spring(1e7),
        ri.Bonded(),
        ri.Hertz(1e9),
        ri.Free(),
        ri.Fixed(),
        ri.Absorbing(),
        ri.Pushed(10.0),
        ri.Steps([1.0, 0.0], [0.1]),
        ri.Samples([1.0, 2.0]),
        ri.Segment(0.1, 1e-4, STEEL),
        [ri.Segment(0.1, 1e-4, STEEL)],
        [rod, ri.Wall()],
        ri.System([rod, ri.Wall()]),
        ri.System([family, rod]),
        ri.Options(),
        VOLTS,
    ]


def likely(rng, name):
    """What goes well with a parameter of this name; a number where nothing is known."""
    time, signal = [1e-5, np.array([0.0, 1e-5])], [VOLTS, -VOLTS]
    choices = {
        "area": [1e-4, ri.Samples([1e-4, 2e-4])],
        "material": [STEEL],
        "left": RODS,
        "right": RODS,
        "bodies": [RODS, [*RODS, ri.Wall()]],
        "contacts": [[ri.Rigid()]],
        "gaps": [[0.0]],
        "system": [
            PAIR,
            ri.System([RODS[0], ri.RigidMass(1.0)], [0.0], [ri.Spring(1e7)]),
        ],
        "contact": [ri.Rigid(), ri.Spring(1e8)],
        "case": [PAIR],
        "family": [FAMILY],
        "until": [1e-4],
        "method": ["auto"],
        "max_events": [1000],
        "dt": [1e-6],
        "rtol": [1e-2],
        "cells": [8],
        "snapshots": [3],
        "body": [0, 1],
        "index": [0],
        "n": [3],
        "limit": [100],
        "segments": [3],
        "frames": [2],
        "starts": [2],
        "most_cells": [5],
        "t": time,
        "step": time,
        "start": time,
        "end": [4e-5],
        "delay": time,
        "before": time,
        "times": [[1e-5, 2e-5]],
        "gauges": [[(0, 0.1)]],
        "values": [[1.0, 0.0]],
        "at": [[0.1]],
        "side": ["left", "right"],
        "text": ["1 mm", "2 s"],
        "dimension": ["length", "time"],
        "unit": ["V", ""],
        "units": ["V"],
        "path": ["file.npz", "file.toml", "file.csv"],
        "name": ["x"],
        "kind": ["quarter"],
        "wrt": [["bodies.0.length"]],
        "of": ["restitution"],
        "y": [("bodies.0.length", 0.1, 0.3)],
        "vary": [["bodies.0.length"], {"bodies.0.length": (0.1, 0.3)}],
        "bar": [BAR],
        "solution": [SOLVED()],
        "result": [ri.sweep(FAMILY)],
        "record": [SOLVED().gauge(0, 0.1)],
        "other": signal,
        "volts": signal,
        "measured": signal,
        "predicted": signal,
        "signal": signal,
        "signals": [{"a": VOLTS, "b": VOLTS}],
    }
    choices |= {flag: [False, True] for flag in FLAGS}
    return one_of(rng, choices.get(name, [0.1, 0.3, 2.0, np.array([0.1, 0.2])]))


def is_sentence(error):
    """Whether rodimpact raised it on purpose, or Python or NumPy for what it was asked.

    Errors of operations on what was never checked come from other lines, or other packages.
    """
    frames = [error.__traceback__]
    while frames[-1].tb_next:
        frames.append(frames[-1].tb_next)
    last = frames[-1]
    if isinstance(error, OSError | FloatingPointError) or "unexpected keyword" in str(
        error
    ):
        return True
    path, line = last.tb_frame.f_code.co_filename, last.tb_lineno
    if not path.startswith(ROOT):
        return isinstance(error, TypeError) and path == __file__
    return linecache.getline(path, line).lstrip().startswith("raise")


def called(function, *arguments, **named):
    """What comes of the call, or the error that says in a sentence what is wrong with it."""
    with patience():
        try:
            return function(*arguments, **named)
        except (
            ValueError,
            TypeError,
            OSError,
            MemoryError,
            LookupError,
            AttributeError,
            FloatingPointError,
        ) as error:
            if not is_sentence(error):
                raise
            text = str(error)
            assert text.strip()
            assert len(text) < 10_000
            return error
