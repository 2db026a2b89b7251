"""Random input of every kind that people, programs and attackers give, and what must
come of it.

Each test goes through a number of examples; RODIMPACT_FUZZ=100 makes it a hundred times
as many, and RODIMPACT_FUZZ_SEED=7 makes it others.
"""

import linecache
import os
import re
import signal
from contextlib import contextmanager
from pathlib import Path

from exhaustive import few_of

import rodimpact as ri
from rodimpact.results.saved import case_of

TIMES = int(os.environ.get("RODIMPACT_FUZZ", "1"))  # factor of the numbers of examples
SEED = int(os.environ.get("RODIMPACT_FUZZ_SEED", "0"))
SEEDS = few_of(range(SEED, SEED + 3), [SEED])
PATIENCE = 600  # s, for what takes milliseconds, or a minute where it is compiled
ROOT = str(Path(ri.__file__).parent)
MOST_CHARACTERS = 2000  # of a message


@contextmanager
def patience(seconds=PATIENCE):
    """In the block: fail after `seconds`; without effect on systems that have no alarm."""

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


def saved_solution():
    """Case file, as text, of a solved collision of a mass and a rod, with its result."""
    mass = ri.RigidMass(1.0, velocity=1.0)
    rod = ri.Rod(0.2, area=1e-4, material=ri.materials.steel)
    system = ri.System([mass, rod], contacts=[ri.Hertz(1e9)])
    return ri.format_case(case_of(ri.solve(system, until=1e-4)))


# Text
# --------------------------------------------------------------------------------------

FOLDER = Path(__file__).parents[2] / "validation" / "cases"
FILES = [
    "unequal-rods",
    "dropped-bar",
    "clamped-bar",
    "hopkinson-specimen",
    "rounded-rod-on-wall",
    "newtons-cradle",
    "stepped-rods",
]
CASES = [
    *[(FOLDER / f"{name}.toml").read_text("utf-8") for name in FILES],
    """schema = 1
gravity = "-9.81 m/s^2"
bodies = [
  {kind = "wall", velocity = "1 cm/s"}, {kind = "mass", mass = "100 g", velocity = -1},
  {kind = "rod", length = 0.1, area = {samples = ["2 cm^2", 1e-4]}, material = "lossy"},
]
contacts = [{restitution = 0.5, gap = 1e-4},
            {law = "hunt-crossley", stiffness = 1e9, damping = 0.1}]
materials.lossy = {youngs_modulus = 2e11, density = 7850, loss_factor = 0.01, loss_frequency = 1e3}
ends.right = {kind = "pushed", value = {values = [0, 100, 0], at = [1e-5, "50 us"]}}
solve = {until = 1e-4, cells = 8, snapshots = 5}
""",
    saved_solution(),
]
"""Texts of right case files."""
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
"""Texts of numbers that hurt."""
WORDS = [
    '"steel"', '"chees"', '"rod"', '"mass"', '"wall"', '"inf"', '"nan"', '"1 mm"', '"1 furlong"',
    '"1e400 m"', '"-3 m/s"', '"1 m m"', '"\u00b5m"', '"1 \u00b5m"', '"\u0661 m"',
    '"' + "1" * 20000 + '"',
    '"' + "m" * 20000 + '"', '"1' + "*" * 500 + 'm"', '""', '" "', '"\\u0000"', '"\\u001b[31m"',
    '"\u202e\U0001f600"', '"auto"', '"fronts"', '"finite-difference"', '"bonded"', '"hertz"',
    '"spring"', '"circular"', '"fixed"', '"moved"', '"pushed"',
    "[]", "{}", "[1, 2]", "[[1]]", "{samples = [1, 2]}", "{values = [1, 2], at = [0.05]}",
    "{values = [1], at = []}", "{samples = [1, nan]}", "{samples = [1, 2], step = 1e-5}",
    "[" * 400 + "]" * 400, "{a = " * 90 + "1" + "}" * 90, "'''\n'''", '"""', "#", "=", "\n", ",",
    "[[bodies]]\n", "[solve]\n", "[output]\nsave = 'x.toml'\n", "[ends.left]\nkind = "
    "'fixed'\n",
    "until", "gap", "velocity", "law", "length", "kind", "stiffness", "damping", "a" * 5000,
    "\x00", "\ufeff", "\u2028", "\r",
]  # fmt: skip
"""Texts that are words of a case file, or stand for values of every other kind."""
TOKEN = re.compile(r"(?:\d|\.\d|-[\d.])[\w.+-]*|[^\W\d][\w-]*|\s+|.", re.DOTALL)


def one_of(rng, things):
    """A random element of a list."""
    return things[rng.integers(len(things))]


def random_number(rng, near="1"):
    """The text of a number: one that hurts, one of any magnitude, or one within a
    factor of 10 of the number whose text is `near`.
    """
    kind = rng.random()
    if kind < 0.2:
        return one_of(rng, NUMBERS)
    if kind < 0.4:
        return repr(float(rng.choice([-1, 1, 1]) * 10 ** rng.uniform(-12, 12)))
    try:
        return repr(float(near) * 10 ** rng.uniform(-1, 1))
    except ValueError:  # `near` is the text of no number
        return "0.3"


def spoilt_text(rng, text):
    """The text with a few random pieces replaced, left out, doubled or exchanged."""
    tokens = TOKEN.findall(text)
    for _ in range(rng.geometric(0.5)):
        i, j = rng.integers(len(tokens), size=2).tolist()
        numbers = [
            k for k, token in enumerate(tokens) if token.strip("-.")[:1].isdigit()
        ]
        words = [k for k, token in enumerate(tokens) if token[:1].isalpha()]
        kind = rng.integers(20)
        if kind < 12 and numbers:
            # A number becomes another number, or a thing that is none.
            number = one_of(rng, numbers)
            if rng.random() < 0.2:
                tokens[number] = one_of(rng, WORDS)
            else:
                tokens[number] = random_number(rng, tokens[number])
        elif kind < 15 and words:
            # A word becomes another word of the text.
            new_word = tokens[one_of(rng, words)]
            tokens[one_of(rng, words)] = new_word
        elif kind == 15:
            tokens[i] = one_of(rng, WORDS)
        elif kind == 16:
            tokens[i], tokens[j] = tokens[j], tokens[i]
        elif kind == 17:
            end = i + rng.geometric(0.3)
            del tokens[i:end]
            if not tokens:
                tokens = [""]
        elif kind == 18:
            end = j + rng.geometric(0.1)
            tokens[i:i] = tokens[j:end]
        else:
            tokens.insert(i, one_of(rng, WORDS))
    return "".join(tokens)


def spoilt_bytes(rng, text):
    """The bytes of a text, now and then with bytes in it that are no text, and seldom
    random bytes alone.
    """
    data = bytearray(text.encode("utf-8", "surrogatepass"))
    if rng.random() < 0.1:
        start = rng.integers(len(data) + 1)
        data[start:start] = rng.bytes(rng.integers(1, 30))
    if rng.random() > 0.01:
        return bytes(data)
    return rng.bytes(rng.integers(2000))


def check_sentence(error, where):
    """Check that the package raised an error on purpose, in a text that is no trap.

    A text is a trap if it is empty, endless, or not printable. An error of the package
    is raised by a line of its own that begins with ``raise``; an error of an operation
    on a value that was never checked comes from another line, or from another package.
    Errors of the operating system, which name a file, are as good.
    """
    frame = error.__traceback__
    while frame.tb_next is not None:
        frame = frame.tb_next
    path = frame.tb_frame.f_code.co_filename
    line = linecache.getline(path, frame.tb_lineno).lstrip()
    is_our_own = path.startswith(ROOT) and line.startswith("raise")
    assert is_our_own or isinstance(error, OSError), f"{where}: {error!r}"
    text = str(error)
    assert text.strip(), where
    assert len(text) < MOST_CHARACTERS, where
    assert text.replace("\n", "").isprintable(), where


def called(function, *arguments, **named):
    """What a function returns, or the exception with which it refused the call; its
    message must be a sentence.
    """
    with patience():
        try:
            return function(*arguments, **named)
        except (ValueError, OSError, MemoryError, LookupError) as error:
            check_sentence(error, function.__name__)
            return error
