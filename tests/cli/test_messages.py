"""Messages of the command line name options and entries of a case, not arguments and
calls.
"""

import re
from pathlib import Path

import pytest
from case_texts import A_MASS, A_ROD, A_WALL, HEAD

import rodimpact as ri
from rodimpact.cli import main
from rodimpact.cli.messages import PHRASES, as_options

PYTHON = re.compile(
    r"\bri\.|\brodimpact\.[a-z]|\b(outcome|result|solution|plot|rod)\.[a-z_]+"
    r"|\w+\(\)|\b[A-Z][a-zA-Z]+\(|(?<![-\w.])[a-z_]+=|velocities_after"
    r"|(?<!solve\.)\b(max_events|align_within|equal_forces)\b|resampled"
)
"""Arguments, calls and attributes of Python."""
MOVING = "velocity = 1\n"
HIT = HEAD + A_ROD + MOVING + A_ROD
THREE = HIT + A_ROD
UNEQUAL = HEAD + A_ROD + MOVING + A_ROD.replace("0.4", "0.437")
TAPERED = HIT + A_ROD.replace("1e-4", "{samples = [1e-4, 2e-4]}")
CAPPED = "[solve]\nmax_events = 3\n"
APART = HEAD + A_ROD + "velocity = -1\n" + A_ROD
STEP_IN_SEGMENT = (
    HEAD
    + """
[[bodies]]
kind = "rod"
[[bodies.segments]]
length = 1
area = {values = [1e-4, 2e-4], at = [0.5]}
material = "steel"
"""
)
ROUND_FACE = (
    HEAD
    + """
[materials.gum]
youngs_modulus = 1e9
density = 1e3
"""
    + A_ROD.replace("steel", "gum")
    + A_ROD
    + """
[[contacts]]
law = "hertz"
left_radius = 0.1
"""
)


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """The present directory, which is empty."""
    monkeypatch.chdir(tmp_path)


def printed_by(capsys, text, command, *options):
    """Standard output and standard error of a command on a case file with this text."""
    Path("case.toml").write_text(text)
    main([command, "case.toml", *options])
    printed = capsys.readouterr()
    return printed.out + printed.err


@pytest.mark.parametrize(
    ("text", "call", "sentence"),
    [
        (THREE, ["run"], "this row has 2; read the velocities instead"),
        (UNEQUAL, ["run", "--max-events", "3"], "Raise --max-events"),
        (HIT, ["run", "--until", "1 ns"], "Leave out --until"),
        (HIT + "[solve]\nuntil = 1e-9", ["run", "--json"], "Leave out solve.until"),
        pytest.param(
            UNEQUAL + CAPPED,
            ["animate", "-o", "film.gif", "--frames", "2"],
            "Raise solve.max_events",
            marks=pytest.mark.exhaustive,
        ),
        (
            UNEQUAL,
            ["sweep", "--vary", "gravity=0:1:2", "--max-events", "3"],
            "Raise --max-events",
        ),
        (TAPERED, ["run", "--method", "fronts"], "or give the area in steps, {values"),
        (
            HEAD + A_MASS + MOVING + A_MASS,
            ["run"],
            'give it a restitution or a compliant law such as "hertz"',
        ),
        (STEP_IN_SEGMENT, ["run"], "give the rod this area and no segments"),
        (ROUND_FACE, ["run"], "must be a material with a poisson_ratio, got"),
        (
            APART,
            ["sweep", "--vary", "bodies.0.length=1:2:2", "--plot", "e.png"],
            "--quantity: 'restitution' has no value anywhere in this family; the "
            "status",
        ),
        (HEAD + A_ROD + A_MASS, ["formula"], "leave it out, or take rodimpact run"),
        (
            HIT + '[ends.right]\nkind = "fixed"',
            ["formula"],
            'need free ends, got "fixed"; leave it out, or take rodimpact run',
        ),
        (UNEQUAL + CAPPED, ["formula"], "solve.max_events: the collis"),
        (HIT, ["run", "--cells", "9"], '--cells: is for method "finite-difference"'),
        (HIT, ["run", "--cells", "9", "--rtol", "1e-3"], "--rtol chooses it"),
        (
            HIT,
            ["run", "--method", "finite-difference", "--cells", "100000000"],
            "--cells: asks for",
        ),
        (
            HIT + '[solve]\ncells = 100000000\nmethod = "finite-difference"',
            ["run"],
            "solve.cells: asks for",
        ),
        (
            HIT,
            ["run", "--method", "finite-difference", "--until", "10000"],
            "--until: a run of",
        ),
        (TAPERED, ["run", "--dt", "1"], "--dt: must be"),
        (
            HIT + '[ends.right]\nkind = "pushed"\nvalue = 1',
            ["run"],
            "--until: must be given",
        ),
        (HIT, ["run", "--save", "case.toml"], "give --force to replace it"),
        (
            HEAD + A_ROD + "velocity = [1, 2]\n" + A_WALL,
            ["run"],
            "rodimpact sweep --vary bodies.0.velocity=start:stop:count varies it",
        ),
    ],
)
def test_a_message_names_options_and_entries_and_nothing_of_python(
    capsys, text, call, sentence
):
    printed = printed_by(capsys, text, *call)

    assert sentence in printed
    assert not PYTHON.search(printed)


@pytest.mark.parametrize(
    "sentence",
    [
        "these rows have 2 contacts that can open, not 1; use result.contacts",
        "draw them as points, such as plot.sweep(rodimpact.sweep(system[0, :]))",
        "3.2 s); use resampled(dt)",
        "use .resampled(times=...) with the times of one of them",
        "record earlier, or give cut pulses, ri.reduce(pulses=...)",
        'if the signs of all gauges differ, give compression="positive"; if that of '
        "this one alone does, reverse it by BarGauge(..., gain=-1)",
        'give clock="own" if each pulse has a time of its own',
        "or give the record of `signal` alone, ri.BarGauge(signal, distance)",
        "check gains (ri.calibrate finds gains from a shot with the bars together)",
        "which Specimen(wave_speed=...) corrects",
        "true stress: give Specimen(..., incompressible=True)",
        "give youngs_modulus=201 GPa, which is density times the square",
        "give a larger align_within than 2 us",
        "two gauges of a bar separate the waves; leave equal_forces out",
    ],
)
def test_sentences_of_rare_mistakes_are_translated(sentence):
    assert PYTHON.search(sentence)
    assert not PYTHON.search(as_options(sentence))


SOURCES_OF_WILDCARDS = {
    "\\w+": "{stronger}",
    ".*": "rodimpact.sweep(system[{', '.join(index)}]",
}
"""Text of the package where a phrase has a wildcard."""


def test_every_phrase_stands_in_the_package():
    """A phrase that nothing says any more is of no use."""
    package = Path(ri.__file__).parent
    texts = []
    for path in package.rglob("*.py"):
        if path.name != "messages.py":
            # Strings on several lines are joined.
            texts.append(re.sub(r'"\s*f?"', "", path.read_text("utf-8")))
    source = "\n".join(texts)
    missing = []
    for pattern in PHRASES:
        phrase = pattern
        for wildcard, words in SOURCES_OF_WILDCARDS.items():
            phrase = phrase.replace(wildcard, words)
        phrase = re.sub(r"\\(.)", r"\1", phrase)
        is_one_text = "|" not in phrase and "?" not in phrase
        if is_one_text and phrase not in source:
            missing.append(pattern)
    assert not missing
