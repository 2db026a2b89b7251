"""The command line: printed texts, files and exit statuses."""

import argparse
import json
import math
import os
import re
import signal
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from case_texts import UNEQUAL_RODS as CASE
from cli.processes import ENVIRONMENT, ROOT, python, started
from exhaustive import few_of

import rodimpact as ri
from rodimpact.cli import COMMANDS, main, verify
from rodimpact.cli.box import RATIOS, VIEWS, Replay, box_page, draw
from rodimpact.cli.verify import Check, checks
from rodimpact.explorer.design import LIBRARY, tables_of, with_gauges
from rodimpact.explorer.solved import scene_of
from rodimpact.methods import kernels
from rodimpact.methods.registry import METHODS

ENDLESS = """\
schema = 1
bodies = [
    {kind = "wall"},
    {kind = "rod", velocity = 1.0, segments = [
        {length = 0.41421356, area = 1e-4, material = "steel"},
        {length = 0.73205081, area = 3e-4, material = "brass"},
        {length = 0.23606798, area = 1e-4, material = "copper"},
    ]},
    {kind = "wall"},
]
solve.until = 1.0
"""
SAMPLE = ["rigid", "--m1", "2", "--v1", "0.5", "--m2", "10", "--v2", "0.2"]
CASES = Path(__file__).parents[2] / "validation" / "cases"


def files_in(folder):
    """Names of the files of a folder."""
    return {path.name for path in folder.iterdir()}


def problems_in(error):
    """Paths and options that the lines of an error name."""
    return {line.split(": ")[1] for line in error.splitlines()}


def assert_ends_well(process):
    """A process has ended without an error."""
    assert process.returncode == 0
    assert process.stderr == ""


# The program


@pytest.mark.parametrize(
    ("option", "words"),
    [("--version", f"rodimpact {ri.__version__}\n"), ("--help", "usage: ")],
)
def test_version_and_help_need_no_numpy(option, words):
    """The options for version and help, in a process of their own, print their words
    and import neither numpy nor numba nor matplotlib.
    """
    code = """
import sys
from rodimpact.cli import main
main([sys.argv[1]])
assert not {"numpy", "numba", "matplotlib"} & set(sys.modules)
"""
    process = python("-c", code, option)

    assert_ends_well(process)
    assert process.stdout.startswith(words)


def test_help_lists_exit_statuses_and_commands_with_their_own_help(output_of):
    """`--help` lists the six exit statuses and every command, and each command has a
    help of its own.
    """
    text = output_of("--help")

    statuses = text.partition("exit status:")[2]
    numbers = re.findall(r"^  (\d+)  ", statuses, re.MULTILINE)
    assert numbers == ["0", "1", "2", "3", "4", "130"]
    for command in COMMANDS:
        assert f"\n  {command} " in text
        assert f"usage: rodimpact {command}" in output_of(command, "--help")


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_a_command_explains_each_option_and_argument(command):
    parser = argparse.ArgumentParser()
    import_module(f"rodimpact.cli.{command}").add_arguments(parser)

    assert [action.dest for action in parser._actions if not action.help] == []


@pytest.mark.parametrize(
    ("argv", "sentence"),
    [
        ([], "a command is missing; choose one of box, run"),
        (["verfy"], "unknown command 'verfy'; perhaps verify is meant"),
        (["zzz"], "choose one of box, run"),
        (["run"], "the following arguments are required: CASE.toml"),
        (["verify", "--js"], "unknown option --js; perhaps '--json' is meant"),
        (["version"], "unknown command 'version'; rodimpact --version prints it"),
        (["units"], "unknown command 'units'; rodimpact help units lists the units"),
        (
            ["run", "case.toml", "--until", "2", "ms"],
            'the number "2 ms" is parted; write it in quotes',
        ),
        (
            ["run", "--until", "1e-3", "s", "case.toml"],
            'the number "1e-3 s" is parted; write it in quotes',
        ),
        (
            ["run", "case.toml", "--csv"],
            "unknown option --csv; --gauges FILE.csv writes strains over time",
        ),
        (
            ["materials", "iron"],
            "NAME: there is no material 'iron'; use one of steel, aluminium",
        ),
        (["run", "."], ".: cannot be read: Is a directory; add the name of a file"),
        (["help", "cases"], "there is no text on 'cases'"),
        (["run", "missing.toml"], "missing.toml: cannot be read"),
        ([*SAMPLE, "-e", "1.5"], "-e: must lie in [-1, 1], got 1.5"),
        (
            [*SAMPLE, "-e", "1", "--m1", "-2"],
            "--m1: must be a positive number of kilograms",
        ),
        (
            [*SAMPLE, "-e", "1", "--v1", "0"],
            "--v1: must be above the velocity of body 2",
        ),
    ],
)
def test_a_wrong_call_ends_with_2_and_says_what_is_meant(argv, sentence, refuses):
    refuses(argv, sentence)


def test_an_internal_fault_ends_with_1_and_shows_where(monkeypatch, capsys):
    """A RuntimeError inside `verify`: status 1, and standard error has the error and
    says that it is a fault of rodimpact.
    """

    def broken():
        raise RuntimeError("boiler")

    monkeypatch.setattr("rodimpact.cli.verify.checks", broken)

    status = main(["verify"])

    assert status == 1
    err = capsys.readouterr().err
    assert "RuntimeError: boiler" in err
    assert "a fault of rodimpact, not yours" in err


@pytest.mark.skipif(os.name == "nt", reason="no such signals")
@pytest.mark.usefixtures("children_hear_signals")
def test_sigint_ends_a_long_run_with_130_and_without_traceback(case):
    """`run` of an endless case is interrupted while it solves: status 130, nothing on
    standard output, and "rodimpact: interrupted" as the last line of standard error.
    """
    case.write_text(ENDLESS)
    code = """
import sys
from rodimpact.cli import main, run
solve = run.solve
def announced_solve(*arguments, **options):
    print("solving", flush=True)
    return solve(*arguments, **options)
run.solve = announced_solve
sys.exit(main(["run", sys.argv[1]]))
"""
    interpreted = ENVIRONMENT | {"NUMBA_DISABLE_JIT": "1"}

    with started("-c", code, case, env=interpreted) as process:
        assert process.stdout.readline() == "solving\n"
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)

    lines = err.splitlines()  # the first may announce how long the run takes
    *_, last_line = lines
    assert process.returncode == 130
    assert out == ""
    assert last_line == "rodimpact: interrupted"
    for line in lines:
        assert line.startswith("rodimpact: ")


@pytest.mark.skipif(os.name == "nt", reason="no such pipes")
@pytest.mark.parametrize(
    "command",
    [
        ["materials"],
        pytest.param(["--help"], marks=pytest.mark.exhaustive),
        pytest.param(
            ["sweep", "case.toml", "--vary", "bodies.0.length=1:2:300", "--csv"],
            marks=pytest.mark.exhaustive,
        ),
    ],
)
@pytest.mark.usefixtures("case")
def test_a_reader_who_has_gone_is_no_failure(command):
    """A command writes to a pipe that nobody reads: it ends well, with status 0 and
    nothing on standard error.
    """
    reading, writing = os.pipe()
    os.close(reading)

    # Nobody reads the pipe: writing to it fails.
    process = python("-m", "rodimpact", *command, stdout=writing)

    os.close(writing)
    assert_ends_well(process)


@pytest.mark.exhaustive
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_full_disk_under_standard_output_ends_with_1():
    """`materials` writes to a full device: status 1, and one line on standard error."""
    with open("/dev/full", "w") as full:
        process = python("-m", "rodimpact", "materials", stdout=full)

    assert process.returncode == 1
    assert process.stderr.startswith("rodimpact: cannot write the result: ")
    assert process.stderr.count("\n") == 1


@pytest.mark.exhaustive
def test_a_poor_encoding_of_the_output_is_no_fault(case):
    """`run --json` with a material whose name is not ASCII, to an output in ASCII, ends
    well, and the name is whole.
    """
    name = "St\u00e4hl"
    rods = CASE.replace('"steel"', f'"{name}"')
    material = f"[materials.'{name}']\nyoungs_modulus = 2e11\ndensity = 7850\n"
    case.write_text(rods + material, encoding="utf-8")
    poor = ENVIRONMENT | {"PYTHONIOENCODING": "ascii:strict"}

    process = python("-m", "rodimpact", "run", case, "--json", env=poor)

    assert_ends_well(process)
    first, _ = json.loads(process.stdout)["system"]["bodies"]
    assert first["material"]["name"] == name


@pytest.mark.exhaustive
@pytest.mark.skipif(os.name == "nt", reason="a directory in use stays")
def test_a_deleted_working_directory_is_named(case, tmp_path):
    """`run --save` in a folder that no longer exists ends with status 1, without a
    table, and names the file that it cannot write.
    """
    code = """
import os, sys
from rodimpact.cli import main
os.mkdir("gone")
os.chdir("gone")
os.rmdir("../gone")
sys.exit(main(["run", sys.argv[1], "--save", "a.toml"]))
"""
    process = python("-c", code, case, cwd=tmp_path)

    assert process.returncode == 1
    assert process.stdout == ""
    assert "cannot write 'a.toml': No such file or directory" in process.stderr


@pytest.mark.exhaustive
@pytest.mark.skipif(os.name == "nt", reason="needs a shell of POSIX")
@pytest.mark.parametrize(
    ("argv", "status"),
    [
        (["run", "missing.toml"], 2),
        pytest.param(["materials"], 0, marks=pytest.mark.exhaustive),
    ],
)
def test_nothing_but_results_goes_to_standard_output_when_stderr_is_closed(
    output_of, argv, status
):
    """With standard error closed, a command has the same status and standard output as
    otherwise; this output is empty unless the status is 0.
    """
    expected = output_of(*argv, status=status)
    shell = ["sh", "-c", 'exec "$@" 2>&-', "sh"]  # "$@": the program and its arguments
    program = [sys.executable, "-m", "rodimpact", *argv]

    process = subprocess.run(
        [*shell, *program],
        env=ENVIRONMENT,
        stdout=subprocess.PIPE,
        text=True,
        check=False,
    )

    assert process.returncode == status
    assert process.stdout == expected
    assert bool(expected) == (status == 0)


@pytest.mark.exhaustive
@pytest.mark.skipif(os.name == "nt", reason="no such signals")
@pytest.mark.usefixtures("case", "children_hear_signals")
def test_ctrl_c_while_a_file_is_written_leaves_nothing(tmp_path):
    """`run --save` is interrupted while the file is written: status 130, one message,
    and no file is left beside the case.
    """
    code = """
import time
from rodimpact.storage import writing
def slow_fsync(_):
    print("writing", flush=True)
    time.sleep(60)
writing.os.fsync = slow_fsync
from rodimpact.__main__ import main
main()
"""
    with started("-c", code, "run", "case.toml", "--save", "a.toml") as process:
        assert process.stdout.readline() == "writing\n"
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)

    assert process.returncode == 130
    assert out == ""
    assert err == "rodimpact: interrupted\n"
    assert files_in(tmp_path) == {"case.toml"}


@pytest.mark.skipif(os.name == "nt", reason="no such signals")
@pytest.mark.usefixtures("children_hear_signals")
def test_ctrl_c_before_the_program_listens_shows_no_traceback(tmp_path):
    """The program is interrupted while it imports: it ends with status 130 and writes
    nothing to standard error.
    """
    # The program imports argparse before it listens: this module is found first.
    waiting = "print('starting', flush=True)\nimport time\ntime.sleep(60)\n"
    (tmp_path / "argparse.py").write_text(waiting)
    path = os.pathsep.join([str(tmp_path), str(ROOT)])
    env = ENVIRONMENT | {"PYTHONPATH": path}
    with started("-m", "rodimpact", "materials", env=env, cwd=tmp_path) as process:
        assert process.stdout.readline() == "starting\n"
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=30)

    assert process.returncode == 130
    assert err == ""


# run


@pytest.mark.parametrize(
    ("argv", "remedy", "status"),
    [
        (["--until", "0"], "Leave out --until to run", 2),
        (["--max-events", "1"], "Raise --max-events", 3),
    ],
)
def test_a_run_of_no_time_prints_its_table_and_tells_why_it_draws_nothing(
    case, capsys, argv, remedy, status
):
    """`run` of a case that ends at 0 s prints its table, writes neither figure nor
    gauges, and says why for each, with a remedy.
    """
    outputs = ["--plot", "a.png", "--gauges", "a.csv", "--gauge", "a=1:0.5"]
    reason = "there is nothing to draw, the run ended at 0 s. "

    assert main(["run", "case.toml", *argv, *outputs]) == status

    out, err = capsys.readouterr()
    plot_line, gauges_line = err.splitlines()
    assert "momentum balance" in out
    assert plot_line.startswith(f"rodimpact: --plot: {reason}")
    assert gauges_line.startswith(f"rodimpact: --gauges: {reason}")
    assert remedy in plot_line
    assert remedy in gauges_line
    assert not Path("a.png").exists()
    assert not Path("a.csv").exists()


@pytest.mark.parametrize(
    ("command", "sentence"),
    [
        (["export", "-o", "a.html"], "lasts no time to show"),
        (["animate", "-o", "a.gif"], "there is nothing to draw"),
    ],
)
@pytest.mark.parametrize(
    ("change", "remedy"),
    [
        ("[solve]\nmax_events = 1\n", "cap of 1 events"),
        ("[[contacts]]\ngap = 1e9\n", "Give solve.until"),
    ],
)
def test_a_run_of_no_time_is_no_page_and_no_film(
    case, refuses, command, sentence, change, remedy
):
    """A command that makes a page or a film of a case that ends at 0 s is refused with
    a remedy, and writes nothing.
    """
    case.write_text(CASE + change)
    name, *options = command

    error = refuses([name, "case.toml", *options], sentence, remedy)

    assert "--until" not in error
    assert files_in(case.parent) == {"case.toml"}


@pytest.mark.exhaustive
@pytest.mark.parametrize(
    "argv",
    [
        ["animate", "ball.toml", "-o", "a.gif"],
        ["export", "ball.toml", "-o", "a.html"],
        ["explore", "ball.toml", "--no-browser"],
    ],
)
def test_waves_of_rigid_masses_are_refused_with_the_command_that_draws_them(
    case, refuses, output_of, argv
):
    """A command that draws waves refuses a row of masses, writes nothing, and names a
    `run` command; this one then draws.
    """
    masses = [ri.RigidMass(1.0, velocity=1.0), ri.RigidMass(2.0)]
    system = ri.System(masses, contacts=[ri.Rigid(restitution=0.8)])
    Path("ball.toml").write_text(ri.format_case(system))
    command = "rodimpact run ball.toml --plot FILE.png"

    refuses(argv, "bodies: needs at least one rod", f"`{command}`")

    assert files_in(case.parent) == {"case.toml", "ball.toml"}
    _, *remedy = command.replace("FILE.png", "a.png").split()
    output_of(*remedy)
    assert Path("a.png").exists()


@pytest.mark.parametrize(
    ("argv", "sentence"),
    [
        (
            ["--save", "a.png", "--plot", "./a.png"],
            "--plot: './a.png' is the file of --save too",
        ),
        (["--save", "there.toml"], "--save: "),
        (["--plot", "a.xyz"], "--plot: must end in one of .png, .svg"),
    ],
)
def test_outputs_are_checked_before_solving(case, refuses, monkeypatch, argv, sentence):
    """`run` with outputs that cannot be written is refused before it solves; an
    existing file stays as it is.
    """
    monkeypatch.setattr(
        "rodimpact.cli.run.solve", lambda *_, **__: pytest.fail("solved")
    )
    Path("there.toml").write_text("precious")

    refuses(["run", str(case), *argv], sentence)

    assert files_in(case.parent) == {"case.toml", "there.toml"}
    assert Path("there.toml").read_text() == "precious"


@pytest.mark.parametrize(
    ("argv", "sentence"),
    [
        (["-o", "film.avi"], "--output: must end in one of .gif, .mp4, got 'film.avi'"),
        (
            ["-o", "film.gif", "--frames", "1"],
            "--frames: must be a whole number from 2",
        ),
        (["-o", "film.gif", "--until", "soon"], "--until: "),
        (["-o", "film.gif", "--until", "0"], "--until: there is nothing to draw"),
        (
            ["-o", "film.gif", "--magnify", "0"],
            "--magnify: must lie in [1e-12, 1e15]",
        ),
        (["-o", "film.gif", "--field", "heat"], "--field: invalid choice"),
        ([], "required: -o/--output"),
    ],
)
def test_a_film_that_cannot_be_made_is_refused(case, refuses, argv, sentence):
    refuses(["animate", "case.toml", *argv], sentence)

    assert files_in(case.parent) == {"case.toml"}


def test_gauges_of_the_case_are_written(case):
    """`run --gauges` writes the same file for two gauges of the case as for the same
    gauges given as options; a gauge without a name is named after its rod and position.
    """
    far_gauge = '[[gauges]]\nbody = 1\nfraction = 0.5\nname = "far"\n'
    end_gauge = "[[gauges]]\nbody = 0\nfraction = 1\n"
    case.write_text(CASE + far_gauge + end_gauge)
    first, second = ri.read_case(case).system.bodies
    far = f"far=1:{second.length / 2}"
    end = f"rod 1 at {first.length:g} m=0:{first.length}"

    of_case = main(["run", str(case), "--gauges", "a.csv"])
    gauges = ["--gauge", far, "--gauge", end]
    of_options = main(["run", str(case), "--gauges", "b.csv", *gauges])

    assert of_case == of_options == 0
    assert Path("a.csv").read_text() == Path("b.csv").read_text()
    assert "far" in Path("a.csv").read_text()


def test_the_interval_of_gauges_resolves_a_short_blow(case, refuses):
    """`run --gauges --interval` writes rows 2 us apart; --interval without --gauges is
    refused.
    """
    gauges = ["--gauges", "a.csv", "--gauge", "a=1:0.5"]

    status = main(["run", str(case), *gauges, "--interval", "2 us"])
    times = [line.split(",")[0] for line in Path("a.csv").read_text().splitlines()]

    assert status == 0
    assert float(times[2]) == 2e-6
    message = "--interval: goes with --gauges, whose rows it spaces"
    refuses(["run", str(case), "--interval", "2 us"], message)


@pytest.mark.exhaustive
@pytest.mark.skipif(os.name == "nt", reason="names are text there")
def test_file_names_that_are_no_text_are_used_and_names_of_gauges_refused(
    case, refuses
):
    """A case file with a byte as its name that is no text is run, saved, exported and
    loaded; as the name of a gauge it is refused.
    """
    name = os.fsdecode(b"\xff")
    case.rename(f"{name}.toml")
    gauges = ["--gauges", "g.csv", "--gauge", f"{name}=1:0.5"]

    assert main(["run", f"{name}.toml", "--save", f"{name}.saved.toml"]) == 0
    assert main(["export", f"{name}.toml", "-o", f"{name}.html"]) == 0

    page = Path(f"{name}.html").read_text("utf-8")
    assert ri.load(f"{name}.saved.toml").final
    assert "<title>\N{REPLACEMENT CHARACTER}</title>" in page
    refuses(["run", f"{name}.toml", *gauges], "a column is named by letters")


@pytest.mark.exhaustive
@pytest.mark.skipif(os.name == "nt", reason="names are text there")
def test_a_figure_whose_name_is_no_text(case):
    name = os.fsdecode(b"\xff.svg")
    assert main(["run", str(case), "--plot", name]) == 0
    assert Path(name).exists()


def test_run_prints_the_table(case, capsys):
    assert main(["run", str(case)]) == 0
    out, err = capsys.readouterr()
    assert "coefficient of restitution e" in out
    assert "158.493 us" in out
    assert err == ""  # the notes that files were written are for terminals


def test_run_prints_json_in_full_precision(case, output_of):
    """`run --json` has the restitution of `collide` bit for bit."""
    steel = ri.materials.steel
    first = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    second = ri.Rod(1.0, area=1e-4, material=steel)
    expected = ri.collide(first, second)

    data = json.loads(output_of("run", str(case), "--json"))

    assert data["schema_version"] == 1
    assert data["outcome"]["restitution"] == expected.restitution


@pytest.mark.parametrize(
    ("command", "unwanted"),
    [
        (["run", "--save", "a.toml"], "matplotlib numba scipy"),
        pytest.param(
            ["sweep", "--vary", "bodies.0.length=50 mm:1 m:5", "--save", "a.npz"],
            "matplotlib",
            marks=pytest.mark.exhaustive,
        ),
    ],
)
@pytest.mark.usefixtures("case")
def test_without_plots_packages_that_are_not_needed_are_not_imported(command, unwanted):
    """A command in a process of its own, without figures, ends well and imports none of
    the unwanted packages.
    """
    # sys.argv is "-c", the unwanted packages, and the command.
    code = """
import sys
from rodimpact.cli import main
_, unwanted, *command = sys.argv
assert main([*command, "case.toml"]) == 0
assert not set(unwanted.split()) & set(sys.modules)
"""
    process = python("-c", code, unwanted, *command)

    assert_ends_well(process)


def test_notes_go_to_a_terminal(case, capsys, monkeypatch):
    """If standard error is a terminal, `run --save` notes there the file that it wrote;
    never on standard output.
    """
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)

    assert main(["run", str(case), "--save", "a.toml"]) == 0

    out, err = capsys.readouterr()
    assert err == "wrote a.toml\n"
    assert "wrote" not in out


def test_options_overrule_the_case(case, output_of):
    """--until and --save of `run` replace those of the case file."""
    case.write_text(CASE + '[solve]\nuntil = "0.1 ms"\n[output]\nsave = "b.toml"\n')
    options = ["--until", "200 us", "--save", "c.toml"]

    text = output_of("run", str(case), "--json", *options)

    assert json.loads(text)["t_end"] == 2e-4
    assert Path("c.toml").exists()
    assert not Path("b.toml").exists()


def test_a_run_that_stops_early_ends_with_3_and_still_reports_and_saves(
    case, output_of
):
    """`run` of an endless case with few events: status 3, a table with velocities at
    the end and advice, and a saved solution.
    """
    case.write_text(f"{ENDLESS}solve.max_events = 40\n")
    options = ["--max-events", "50", "--save", "a.toml"]

    out = output_of("run", "case.toml", *options, status=3)

    assert "velocity at the end" in out
    assert "Raise --max-events" in out
    assert ri.load("a.toml").stopped_by == "max_events"


@pytest.mark.exhaustive
def test_a_film_of_a_run_that_stops_early_ends_with_3(case, output_of):
    case.write_text(f"{ENDLESS}solve.max_events = 40\n")

    out = output_of("animate", "case.toml", "-o", "a.gif", "--frames", "2", status=3)

    assert "cap of 40 events" in out
    assert Path("a.gif").exists()


def test_a_page_of_a_run_that_stops_early_says_so_itself(case, output_of):
    """`export` of a case with a cap of 40 events succeeds without a message: the notes
    of the page name the cap.
    """
    case.write_text(f"{ENDLESS}solve.max_events = 40\n")

    output_of("export", "case.toml", "-o", "a.html")

    tables = tables_of(with_gauges(ri.read_case(case)))
    scene = scene_of(tables["case"], tables["gauges"], LIBRARY)
    assert "cap of 40 events" in scene["notes"][0]


def test_an_existing_file_needs_force_and_is_left_alone(case, refuses):
    Path("a.toml").write_text("precious")
    refuses(["run", str(case), "--save", "a.toml"], "rodimpact: --save: ", "--force")
    assert Path("a.toml").read_text() == "precious"
    assert main(["run", str(case), "--save", "a.toml", "--force"]) == 0
    assert ri.load("a.toml").final


def test_a_saved_solution_is_a_case_with_its_gauges(case, output_of, capsys):
    """A saved solution is read as a case with its gauges, run with the same table,
    saved again as the same file, and swept, without a warning.
    """
    case.write_text(CASE + "[[gauges]]\nbody = 1\nfraction = 0.5\n")
    outputs = ["--save", "again.toml", "--gauges", "a.csv"]

    table = output_of("run", str(case), "--save", "run.toml")

    saved = ri.read_case("run.toml")
    assert saved.gauges == ri.read_case(case).gauges
    assert output_of("run", "run.toml") == table
    assert output_of("run", "run.toml", *outputs) == table
    assert Path("again.toml").read_bytes() == Path("run.toml").read_bytes()
    assert output_of("sweep", "run.toml", "--vary", "bodies.0.velocity=1,2")
    assert capsys.readouterr().err == ""


def test_a_falsified_outcome_is_told_where_the_same_run_is_made(case, capsys):
    """The peak force in a saved solution is changed: `run` of it warns in one line of
    the difference, and stays silent with another `--until`, which is another run.
    """
    main(["run", str(case), "--save", "run.toml"])
    text = Path("run.toml").read_text("utf-8")
    falsified = re.sub('"peak_force.0" = .*', '"peak_force.0" = 1.0', text)
    Path("run.toml").write_text(falsified)
    capsys.readouterr()

    assert main(["run", "run.toml"]) == 0

    warning = capsys.readouterr().err
    message = "rodimpact: run.toml: the outcome differs from the stored one"
    assert warning.startswith(message)
    assert "peak_force.0 is " in warning
    assert warning.count("\n") == 1
    assert main(["run", "run.toml", "--until", "1 ms"]) == 0
    assert capsys.readouterr().err == ""


def test_all_mistakes_of_a_saved_solution_are_reported_at_once(case, refuses):
    """A saved solution is edited with four mistakes and run with a wrong `--save`: all
    six paths are reported.
    """
    main(["run", str(case), "--save", "run.toml"])
    text = Path("run.toml").read_text("utf-8")
    text = text.replace("length = 0.4", "length = -1")
    text = text.replace("final = true", "final = 1")
    text = text.replace('episodes.0" = 1', 'episodes.0" = "x"')
    text = text.replace("dissipated", "disipated")
    Path("run.toml").write_text(text)

    error = refuses(["run", "run.toml", "--save", "again.npz"])

    assert problems_in(error) >= {
        "--save",
        "bodies.0.length",
        "result.final",
        "result.numbers.episodes.0",
        "result.numbers.disipated",
        "result.numbers.dissipated",
    }


def test_all_mistakes_are_reported_at_once(case, refuses):
    """The case saves its solution in a file that is there, and a figure is no .toml."""
    Path("a.toml").write_text("precious")
    text = CASE.replace('"0.4 m"', "-1")
    text = text.replace('"steel"', '"stel"', 1)
    case.write_text(text + '[output]\nsave = "a.toml"\n')
    limits = ["--until", "3 kg", "--max-events", "0"]
    grid = ["--cells", "1.5", "--snapshots", "no"]

    error = refuses(["run", str(case), *limits, *grid, "--plot", "a.toml"])

    options = {"--until", "--max-events", "--cells", "--snapshots", "--plot"}
    assert problems_in(error) >= options | {
        "bodies.0.length",
        "bodies.0.material",
    }
    for line in error.splitlines():
        assert line.startswith("rodimpact: ")
        if "--until" in line:
            assert "unit of mass" in line
    assert Path("a.toml").read_text() == "precious"


@pytest.mark.exhaustive
def test_a_run_that_no_picture_can_show_keeps_its_table(case, capsys):
    """`run --plot` of a rod with too many pieces ends with status 2: it prints its
    table, says why, and writes no picture.
    """
    count = 11_000  # pieces of the velocity along the first rod, 0.4 m
    velocities = [i % 7 for i in range(count)]
    jumps = [0.4 * i / count for i in range(1, count)]
    velocity = f"{{values = {velocities}, at = {jumps}}}"
    case.write_text(CASE.replace("velocity = 1.0", f"velocity = {velocity}"))

    status = main(["run", str(case), "--plot", "run.png"])

    out, err = capsys.readouterr()
    assert status == 2
    assert err.startswith("rodimpact: --plot: solution: has more than 20000 regions")
    assert out.startswith("body")
    assert not Path("run.png").exists()


# rigid


def test_rigid_prints_velocities_and_impulses_of_both_bodies(output_of):
    """The rigid masses of sample 10.19."""
    _, first, second, *_ = output_of(*SAMPLE, "-e", "1").splitlines()

    assert " ".join(first.split()) == "1 2 kg 0.5 m/s 0 m/s 1 N s 0 N s"
    assert " ".join(second.split()) == "2 10 kg 0.2 m/s 0.3 m/s 2 N s 3 N s"


def test_rigid_takes_units_signs_walls_and_percent(output_of):
    """`rigid` of a mass that meets a moving wall: velocity and impulse by its formula;
    mass and energy of the wall are None.
    """
    body = ["--m1", "500 g", "--v1", "10"]
    wall = ["--m2", "inf", "--v2", "-20cm/s"]

    data = json.loads(output_of("rigid", *body, *wall, "-e", "90%", "--json"))

    assert data["m2"] is None
    assert data["energy_before"] is None
    # The body approaches the wall with 10.2 m/s.
    assert data["velocity_1"] == pytest.approx(-0.2 - 0.9 * 10.2, rel=1e-14)
    assert data["impulse"] == pytest.approx(0.5 * (1 + 0.9) * 10.2, rel=1e-14)


def test_rigid_reports_all_mistakes_at_once(refuses):
    argv = ["rigid", "--m1", "2 m", "--v1", "x", "--m2", "1", "--v2", "0", "-e", "1 s"]

    error = refuses(argv)

    assert problems_in(error) == {"--m1", "--v1", "-e"}


def test_rigid_refuses_energy_unless_it_is_released(refuses, output_of):
    refuses([*SAMPLE, "-e", "1.5"], "--energy-release")
    assert "-93.75 mJ" in output_of(*SAMPLE, "-e", "1.5", "--energy-release")


# verify, materials, doctor


def test_verify_checks_each_method_and_names_the_validation_pages(output_of):
    """`verify` prints an "ok" for each method, that all passed, and a path of the
    validation pages that exists.
    """
    text = output_of("verify")

    *_, verdict = text.splitlines()
    assert text.count("  ok\n") == len(METHODS)
    assert verdict.startswith(f"All {len(METHODS)} checks passed. ")
    pages = re.search(r"validation pages .* \((\S+)\)", verdict)[1]
    assert (Path(__file__).parents[2] / pages).exists()


@pytest.mark.parametrize(
    ("computed", "sentence", "status"),
    [
        (1.0 + 9e-10, "All 2 checks passed", 0),
        (1.0 - 2e-9, "1 of 2 checks FAILED", 4),
        (math.nan, "1 of 2 checks FAILED", 4),
    ],
)
def test_verify_ends_with_4_if_a_number_is_off(
    monkeypatch, output_of, computed, sentence, status
):
    """`verify` with two checks, of which the second may be wrong: text, JSON and status
    say whether it passed.
    """
    result = [Check("a", 1.0, 1.0, 1e-9), Check("b", 1.0, computed, 1e-9)]
    monkeypatch.setattr("rodimpact.cli.verify.checks", lambda: result)

    text = output_of("verify", status=status)
    data = json.loads(output_of("verify", "--json", status=status))

    first, second = data["checks"]
    assert sentence in text
    assert data["passed"] is (status == 0)
    assert first["passed"] is True
    assert second["passed"] is (status == 0)


@pytest.mark.parametrize("method", few_of(METHODS, {"characteristics"}))
def test_a_wrong_solver_is_noticed(monkeypatch, method):
    """The restitution of one method is made wrong by 2 %: exactly one of the checks of
    `verify` does not pass.
    """
    right = verify.solve

    def wrong(system, **options):
        solution = right(system, **options)
        if options["method"] == method:
            e = solution.outcome.restitution * 1.02
            return SimpleNamespace(outcome=SimpleNamespace(restitution=e))
        return solution

    monkeypatch.setattr(verify, "solve", wrong)
    assert sum(not check.passed for check in checks()) == 1


def test_materials_are_listed_by_name(output_of):
    """`materials brass oak` prints these two with their units and no other; with
    `--json` it gives the same names as data.
    """
    text = output_of("materials", "brass", "oak")
    data = json.loads(output_of("materials", "brass", "--json"))

    names = [line.split()[0] for line in lines_with_units(text)]
    assert names == ["brass", "oak"]
    assert "brass: " in text
    assert "steel" not in text
    assert [material["name"] for material in data["materials"]] == ["brass"]


def lines_with_units(text):
    """Lines of a table of materials, which have a bar speed."""
    return [line for line in text.splitlines() if " m/s" in line]


def test_materials_prints_the_numbers_of_each(output_of):
    text = output_of("materials")

    (steel,) = re.findall("^steel .*", text, re.MULTILINE)
    assert " ".join(steel.split()) == "steel 200 GPa 7850 kg/m^3 5048 m/s 0.29"


def test_materials_of_json_have_sources(output_of):
    """`materials --json` lists all materials of the package, each with a source."""
    data = json.loads(output_of("materials", "--json"))

    names = set()
    for material in data["materials"]:
        names.add(material["name"])
        assert material["source"]
    assert names == set(ri.materials.TABLE)


def test_doctor_shows_versions_the_compiler_and_the_cache(output_of):
    """`doctor` gives, as JSON, the versions, whether there is a compiler, and the
    folder of the cache, if any; its text names this folder.
    """
    data = json.loads(output_of("doctor", "--json"))
    text = output_of("doctor")
    assert data["versions"]["rodimpact"] == ri.__version__
    assert data["versions"]["numpy"] == np.__version__
    assert bool(data["no_compiler"]) is not kernels.enabled()
    # A cache is there unless no folder can be written.
    cache = data["cache_directory"]
    if cache is not None:
        assert Path(cache).is_dir()
        assert cache in text


def test_doctor_says_how_long_it_took_to_compile_everything(monkeypatch, output_of):
    """`doctor --warm` reports the seconds as text and as JSON, and that machine code
    has no folder where it can be kept. Compiling is replaced.
    """
    monkeypatch.setattr(kernels, "why_not", lambda: "")
    monkeypatch.setattr(kernels, "compiled", lambda kernel: SimpleNamespace(place=""))
    monkeypatch.setattr("rodimpact.cli.doctor.warm", lambda: 24.04)
    data = json.loads(output_of("doctor", "--warm", "--json"))
    assert data["seconds_to_compile_all"] == 24.04
    text = output_of("doctor", "--warm")
    assert "none: no folder can be written; set NUMBA_CACHE_DIR" in text
    assert "in 24.0 s" in text


def test_doctor_says_why_it_compiles_nothing(monkeypatch, output_of):
    monkeypatch.setattr(kernels, "why_not", lambda: "numba is not installed")
    assert "none: numba is not installed" in output_of("doctor")
    assert "none: numba is not installed" in output_of("doctor", "--warm", status=1)


# box


@pytest.fixture
def no_figures(monkeypatch):
    """`rodimpact box` draws nothing, which saves time; its page is written."""
    monkeypatch.setattr("rodimpact.cli.box.draw", lambda *_: [])


@pytest.fixture
def box_text(no_figures, tmp_path, output_of):
    """What `box` prints."""
    return output_of("box", "-o", str(tmp_path))


def test_box_draws_the_law(tmp_path):
    path = tmp_path / "restitution.png"
    draw([], RATIOS, [path], force=False)
    assert path.read_bytes().startswith(b"\x89PNG")


@pytest.mark.exhaustive
def test_box_draws_each_collision_and_the_law(tmp_path):
    """`draw` writes all views of a collision, and the figure of the restitution, as
    PNG, also over a file of an earlier run.
    """
    rods = [ri.Rod(1.0, area=1e-4, material=ri.materials.steel) for _ in range(2)]
    solution = ri.solve(ri.System([rods[0].replace(velocity=1.0), rods[1]]))
    replay = Replay("Identical rods", ("left rod", "right rod"), solution)
    paths = [tmp_path / f"{name}.png" for name in (*VIEWS, "restitution")]
    paths[0].write_text("of an earlier run")

    draw([replay], RATIOS, paths, force=True)

    for path in paths:
        assert path.read_bytes().startswith(b"\x89PNG")


def story(text, title):
    """Lines of stages and results of one collision, with one blank between words."""
    _, _, after_title = text.partition(f"\n{title}")
    part, _, _ = after_title.partition("\n\n\n")
    lines = []
    for line in part.splitlines():
        lines.append(" ".join(line.split()))
    return lines


def test_box_tells_the_stages_of_identical_rods(box_text):
    """`box` tells, for identical rods, the times at which the wave turns back and the
    force ends, with the velocity and stress of both rods before and after each.
    """
    lines = story(box_text, "Identical rods")
    turn = "the wave turns back at the free end of the"
    first_turn = lines.index(f"198.116 us {turn} left rod")
    assert lines[first_turn - 2 : first_turn] == [
        "left rod 1 m/s, no stress <| 0.5 m/s, 19.8 MPa compression",
        "right rod 0.5 m/s, 19.8 MPa compression |> 0 m/s, no stress",
    ]
    assert lines[first_turn + 1 : first_turn + 9] == [
        f"{turn} right rod",
        "left rod 0 m/s, no stress |> 0.5 m/s, 19.8 MPa compression",
        "right rod 0.5 m/s, 19.8 MPa compression <| 1 m/s, no stress",
        "396.232 us the wave is back at the contact",
        "the contact force ends",
        "the gap opens",
        "left rod 0 m/s, no stress",
        "right rod 1 m/s, no stress",
    ]


def test_box_puts_theory_beside_its_results(box_text):
    """`box` prints computed values with the closed forms beside them, for unequal rods
    and for a wall, and the crossing of two fronts.
    """
    lines = story(box_text, "Rods of different length, l1/l2 = 0.4")
    lines_of_wall = story(box_text, "A rod on a rigid wall")

    assert "coefficient of restitution e 1 1" in lines_of_wall
    for line in (
        "coefficient of restitution e 0.4 0.4",
        "force duration 158.493 us 158.493 us",
        "time until the gap opens 396.232 us 396.232 us",
        "vibration energy after 94.2 mJ 94.2 mJ",
        "277.363 us two fronts cross in the right rod, 600 mm from its left end",
    ):
        assert line in lines


def test_box_says_when_rods_part_in_the_textbook(box_text):
    """`box` says for rods of different length that in the textbook they part as the
    force ends, and nothing of it for equal rods.
    """
    unequal = " ".join(story(box_text, "Rods of different length, l1/l2 = 0.4"))
    equal = " ".join(story(box_text, "Identical rods"))

    sentence = "The force ends after 158.493 us. In the textbook the rods part then."
    assert sentence in unequal
    assert "In the textbook" not in equal


@pytest.mark.exhaustive
def test_box_draws_another_format_material_and_look_and_a_dowel(tmp_path, output_of):
    """`box` with SVG, dark colours, brass and a dowel: the text has the wave speed of
    brass and the closed form of the dowel; 21 dark figures are written, and the page
    shows all of them.
    """
    options = ["--format", "svg", "--dark", "--material", "brass", "--dowel"]
    text = output_of("box", *options, "-o", str(tmp_path))
    assert "3434 m/s" in text
    dowel = story(text, "A wooden dowel, 3 ft long, on a stone floor")
    assert "coefficient of restitution e 1 1" in dowel
    duration = 2 * 3 * 0.3048 / ri.materials.oak.wave_speed
    microseconds = f"{1e6 * duration:.3f} us"
    assert f"force duration {microseconds} {microseconds}" in dowel
    figures = sorted(path.name for path in tmp_path.glob("*.svg"))
    assert len(figures) == 21
    assert "#14161a" in (tmp_path / "dowel-stages.svg").read_text(encoding="utf-8")
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert sorted(re.findall(r'<img src="([^"]+)"', page)) == figures


def test_box_defaults_to_a_directory_of_its_own(no_figures, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["box"]) == 0
    assert (tmp_path / "rodimpact-box").is_dir()
    assert main(["box", "-o", "a/b"]) == 0
    assert (tmp_path / "a" / "b").is_dir()


@pytest.mark.parametrize("ratio", ["0", "1.5", "-0.4", "x"])
def test_box_refuses_a_ratio_that_is_none(no_figures, tmp_path, refuses, ratio):
    folder = tmp_path / "new"

    refuses(["box", "--ratio", ratio, "-o", str(folder)], "rodimpact: --ratio: ")

    assert not folder.exists()


def test_box_leaves_files_that_are_there(no_figures, tmp_path, refuses):
    """`box` into a folder that holds one of its files is refused, with the advice of
    --force, and leaves the file; with --force it succeeds.
    """
    (tmp_path / "wall-energy.png").write_text("precious")
    refuses(["box", "-o", str(tmp_path)], "holds wall-energy.png already", "--force")
    assert (tmp_path / "wall-energy.png").read_text() == "precious"
    assert main(["box", "-o", str(tmp_path), "--force"]) == 0


def test_the_page_of_the_box_shows_signs_of_html_as_they_are():
    page = box_page(["l1 < l2 & no gap\n\nl2 > l1"], [["a.png"]])
    assert "<title>l1 &lt; l2 &amp; no gap</title>" in page
    assert "<h1>l1 &lt; l2 &amp; no gap</h1>" in page
    assert 'alt="l1 &lt; l2 &amp; no gap: a"' in page
    assert "l2 &gt; l1" in page


def test_the_page_of_the_box_has_a_margin_and_signs_of_mathematics(box_text):
    """The HTML page of the box has a padding, and superscripts and Greek letters in
    place of "^" and names.
    """
    page = box_page([f"Title\n\n{box_text}"], [[]])
    style = page.partition("</style>")[0]

    assert "padding: 0 1.5rem" in style
    assert "area 1 cm²" in page
    assert "(1 - e²) μ v²/2" in page
    assert "^" not in page


def test_the_page_of_the_box_has_paragraphs_and_tables():
    page = box_page(["Title\n\nWords of 385 us.\n\na  1\nb  2"], [[]])
    assert "<p>Words of 385 µs.</p>" in page
    assert ">a  1\nb  2</pre>" in page


def test_box_needs_a_directory(no_figures, case, refuses, capsys):
    refuses(["box", "-o", "case.toml"], "is not a directory")
    assert main(["box", "-o", "case.toml/in"]) == 1
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.exhaustive
def test_options_replace_what_they_exclude_in_the_case(
    tmp_path, monkeypatch, output_of
):
    """`run --rtol` and `run --cells` of a case that gives cells: each replaces this
    number, as the status says.
    """
    monkeypatch.chdir(tmp_path)
    text = (CASES / "lossy-rods.toml").read_text()
    text = text.replace("cells = 100", "cells = 20")
    text = text.replace('until = "20 ms"', 'until = "1 ms"')
    Path("lossy.toml").write_text(text)

    by_rtol = json.loads(output_of("run", "lossy.toml", "--rtol", "0.05", "--json"))
    by_cells = json.loads(output_of("run", "lossy.toml", "--cells", "10", "--json"))

    assert "Stated relative error: " in by_rtol["outcome"]["status"]
    # 10 cells in the longest rod are 14 in the row.
    assert "14 cells" in by_cells["outcome"]["status"]


@pytest.mark.parametrize("date", ["x", "", "-1", "1e9", "9" * 30])
def test_a_date_of_files_that_is_none_is_refused(case, refuses, monkeypatch, date):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", date)
    refuses(
        ["run", "case.toml"], "SOURCE_DATE_EPOCH: must be a whole number of seconds"
    )


def test_all_cases_of_the_validation_can_be_run():
    """Every case file of the validation is read, and its options select one of
    `METHODS`; nothing is solved.
    """
    paths = sorted(CASES.glob("*.toml"))
    assert len(paths) > 5
    for path in paths:
        case = ri.read_case(path)
        method = ri.Options(**case.solve).method_for(case.system)
        assert method in METHODS, path
