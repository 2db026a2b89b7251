"""Command lines of all commands with options of every kind: done, or refused in
sentences.
"""

import argparse
from importlib import import_module

import pytest
from fuzz.generators import CASES, NUMBERS, SEEDS, TIMES, WORDS, one_of, patience
from numpy.random import default_rng

from rodimpact.cli import COMMANDS, main
from rodimpact.cli.exit_status import DONE, FAULT, INCOMPLETE, MISTAKE

EXAMPLES = 10 * TIMES  # of each seed
WITHOUT_CASE = ("doctor", "verify")  # not tried here: they take seconds
SLOW = ("animate", "box", "export", "explore")  # tried seldom
QUICK = sorted({*COMMANDS} - {*WITHOUT_CASE, *SLOW})
# Without --symbols a formula takes long; that has a test of its own.
ALWAYS = ("-o", "--no-browser", "--symbols")
VALUES = [
    *NUMBERS,
    *(word.strip("\"'") for word in WORDS if "\x00" not in word),
    "1 ms",
    "0.1 ms",
    "10 us",
    "x.npz",
    "x.toml",
    "x.png",
    "x.html",
    "x.csv",
    "x.gif",
    ".",
    "/dev/null",
    "/dev/full",
    "case.toml",
    "no/such/folder/x.png",
    "x" * 300 + ".npz",
    "a=0:0.1",
    "a=1:1 mm",
    "a,b=0:0.1",
    "=:",
    "a=9:9",
    "bodies.0.length=0.1:1:3",
    "bodies.0.velocity=1,2,3",
    "contacts.0.gap=1e-6:1e-3:3:log",
    "bodies.0.length=0:1:1000000000",
    "bodies.9.length=1,2",
    "=",
    "fronts",
    "record",
    "raise",
    "velocity",
    "stress",
    "2",
    "3",
    "65536",
    "-",
    "--",
]
"""Values that may be given to any option."""
RECORD = "time [us],a [V]\n" + "".join(f"{i},{min(i % 50, 9)}\n" for i in range(100))
LIKELY = {
    "--start": "0",
    "--stop": "40 us",
    "--carried": "0.1",
    "--radius": "5 mm",
    "--bridge": "half",
    "--gauge-factor": "2",
    "--excitation": "5 V",
    "--scale": "1",
    "--shift": "1 us",
    "--until": "0.1 ms",
    "--max-events": "500",
    "--dt": "1 us",
    "--frames": "2",
    "--save": "x.toml",
    "--plot": "x.png",
    "-o": "x.html",
    "--gauges": "g.csv",
    "--gauge": "a=0:0.1",
    "--m1": "1",
    "--vary": "bodies.0.velocity=1,2,3",
    "--workers": "1",
    "--checkpoint": "checkpoint",
    "--length": "5 mm",
    "--diameter": "5 mm",
    "--csv": "reduced.csv",
    "--decimal": ".",
    "--m2": "2",
    "--v1": "1",
    "--v2": "0",
    "--restitution": "0.5",
    "--method": "fronts",
    "--symbols": "bodies.0.length",
    "record": "record.csv",
    "topic": "case",
    "names": "steel",
    "FILE.npz": "x.npz",
}
"""Values by option, argument or kind of file with which a command is likely to work."""


def command_line(rng):
    """One command with some of the options that it knows, likely values and others."""
    commands = QUICK
    if rng.random() < 0.1:
        commands = SLOW
    command = one_of(rng, commands)
    parser = argparse.ArgumentParser(add_help=False)
    import_module(f"rodimpact.cli.{command}").add_arguments(parser)
    words = []
    share_of_likely_values = rng.random()
    for option in parser._actions:
        if not option.option_strings:
            words.append(LIKELY.get(option.dest, "case.toml"))
            continue
        name = option.option_strings[0]
        if rng.random() < 0.4 or option.required or name in ALWAYS:
            words.append(name)
            takes_value = option.nargs != 0
            if takes_value and rng.random() < share_of_likely_values:
                words.append(one_of(rng, likely_values(option, name)))
            elif takes_value:
                words.append(one_of(rng, VALUES))
    if rng.random() < 0.05:
        words.insert(rng.integers(len(words) + 1), one_of(rng, VALUES))
    return [command, *words]


def likely_values(option, name):
    """Values with which an option is likely to work: its choices, if it has some."""
    if option.metavar in LIKELY:  # --save of a family is no case
        return [LIKELY[option.metavar]]
    if name in LIKELY:
        return [LIKELY[name]]
    return list(option.choices or VALUES)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("seed", SEEDS)
def test_command_lines_are_done_or_refused_in_a_sentence(
    capsys, monkeypatch, tmp_path, seed
):
    """Random command lines run in folders of their own: there is no traceback, a
    message goes with a status for it, and no temporary file is left. More than a
    quarter are refused.
    """
    rng = default_rng(seed)
    refused = 0
    for i in range(EXAMPLES):
        folder = tmp_path / str(i)
        folder.mkdir()
        monkeypatch.chdir(folder)
        monkeypatch.setattr("tempfile.tempdir", str(folder))
        (folder / "case.toml").write_text(one_of(rng, CASES))
        (folder / "record.csv").write_text(RECORD)
        with patience():
            status = main(command_line(rng))
        _, errors = capsys.readouterr()
        assert "Traceback" not in errors
        assert "fault of rodimpact" not in errors
        if errors:
            assert status in (FAULT, MISTAKE)
        else:
            assert status in (DONE, INCOMPLETE)
        # No temporary file is left.
        assert not list(folder.rglob(".rodimpact*"))
        refused += status == MISTAKE
    assert EXAMPLES / 4 < refused < EXAMPLES


SHORT_FORMULAS = [text for text in CASES if "Two stepped rods" not in text]


@pytest.mark.exhaustive
@pytest.mark.parametrize("text", SHORT_FORMULAS)
def test_formulas_of_all_symbols_are_found_or_refused(
    capsys, monkeypatch, tmp_path, text
):
    """`formula` without --symbols prints a formula, or is refused with a message on
    standard error and without output.
    """
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_text(text)
    status = main(["formula", "case.toml"])
    printed, said = capsys.readouterr()
    if status == DONE:
        assert printed
        assert not said
    else:
        assert status == MISTAKE
        assert not printed
        assert said
    assert "fault of rodimpact" not in said
