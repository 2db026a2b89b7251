"""The command line: what is printed, where, and with which exit status."""

import contextlib
import io
import json
import math
import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from case_texts import UNEQUAL_RODS as CASE
from cli.processes import ENVIRONMENT, ROOT, python, started

import rodimpact as ri
from rodimpact.cli import COMMANDS, main, verify
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


# The program --------------------------------------------------------------------------------------


def test_version_and_help_need_no_numpy():
    code = (
        "import sys; from rodimpact.cli import main; main([{!r}]);"
        "assert not {{'numpy', 'numba', 'matplotlib'}} & set(sys.modules)"
    )
    for option, sentence in (
        ("--version", f"rodimpact {ri.__version__}\n"),
        ("--help", "usage: "),
    ):
        done = python("-c", code.format(option))
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout.startswith(sentence)


def test_help_lists_exit_statuses_and_commands_with_their_own_help(output_of):
    text = output_of("--help")
    statuses = re.findall(r"^  (\d+)  ", text.partition("exit status:")[2], re.M)
    assert [int(status) for status in statuses] == [0, 1, 2, 3, 4, 130]
    for command in COMMANDS:
        assert f"\n  {command} " in text
        assert f"usage: rodimpact {command}" in output_of(command, "--help")


@pytest.mark.parametrize(
    ("argv", "sentence"),
    [
        ([], "unknown command ''; choose one of box, run"),
        (["verfy"], "unknown command 'verfy'; perhaps verify is meant"),
        (["zzz"], "choose one of box, run"),
        (["run"], "the following arguments are required: CASE.toml"),
        (["verify", "--js"], "unrecognized arguments: --js"),
        (["help", "cases"], "invalid choice: 'cases'"),
        (["run", "missing.toml"], "missing.toml: cannot be read"),
        (["run", "."], ".: cannot be read"),
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
    def broken():
        raise RuntimeError("boiler")

    monkeypatch.setattr("rodimpact.cli.verify.checks", broken)
    assert main(["verify"]) == 1
    err = capsys.readouterr().err
    assert "RuntimeError: boiler" in err
    assert "a fault of rodimpact, not yours" in err


@pytest.mark.skipif(os.name == "nt", reason="no such signals")
@pytest.mark.usefixtures("children_hear_signals")
def test_sigint_ends_a_long_run_with_130_and_without_traceback(case):
    case.write_text(ENDLESS)
    code = (
        "import sys; from rodimpact.cli import main, run;"
        "solve = run.solve;"
        "run.solve = lambda *a, **k: (print('solving', flush=True), solve(*a, **k))[1];"
        "sys.exit(main(['run', sys.argv[1]]))"
    )
    with started(
        "-c", code, case, env=ENVIRONMENT | {"NUMBA_DISABLE_JIT": "1"}
    ) as process:
        assert process.stdout.readline() == "solving\n"
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
    assert (process.returncode, out) == (130, "")
    lines = err.splitlines()  # it may have said how long it takes
    assert lines[-1] == "rodimpact: interrupted"
    assert all(line.startswith("rodimpact: ") for line in lines)


@pytest.mark.skipif(os.name == "nt", reason="no such pipes")
@pytest.mark.parametrize(
    "command",
    [
        ["materials"],
        ["--help"],
        ["sweep", "case.toml", "--vary", "bodies.0.length=1:2:300", "--csv"],
    ],
)
@pytest.mark.usefixtures("case")
def test_a_reader_who_has_gone_is_no_failure(command):
    reading, writing = os.pipe()
    os.close(reading)
    done = python("-m", "rodimpact", *command, stdout=writing)
    os.close(writing)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_full_disk_under_standard_output_ends_with_1():
    with open("/dev/full", "w") as full:
        done = python("-m", "rodimpact", "materials", stdout=full)
    assert done.returncode == 1
    assert done.stderr.startswith("rodimpact: cannot write the result: ")
    assert done.stderr.count("\n") == 1


def test_a_poor_encoding_of_the_output_is_no_fault(case):
    umlaut = CASE.replace('"steel"', '"St\u00e4hl"')
    material = "[materials.'St\u00e4hl']\nyoungs_modulus = 2e11\ndensity = 7850\n"
    case.write_text(umlaut + material, encoding="utf-8")
    poor = ENVIRONMENT | {"PYTHONIOENCODING": "ascii:strict"}
    done = python("-m", "rodimpact", "run", case, "--json", env=poor)
    assert (done.returncode, done.stderr) == (0, "")
    assert (
        json.loads(done.stdout)["system"]["bodies"][0]["material"]["name"]
        == "St\u00e4hl"
    )


@pytest.mark.skipif(os.name == "nt", reason="a directory in use stays")
def test_a_deleted_working_directory_is_named(case, tmp_path):
    code = (
        "import os, sys; from rodimpact.cli import main;"
        "os.mkdir('gone'); os.chdir('gone'); os.rmdir('../gone');"
        "sys.exit(main(['run', sys.argv[1], '--save', 'a.toml']))"
    )
    done = python("-c", code, case, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (1, "")
    assert "cannot write 'a.toml': No such file or directory" in done.stderr


@pytest.mark.skipif(os.name == "nt", reason="needs a shell of POSIX")
@pytest.mark.parametrize(
    ("argv", "status"), [(["run", "missing.toml"], 2), (["materials"], 0)]
)
def test_nothing_but_results_goes_to_standard_output_when_stderr_is_closed(
    output_of, argv, status
):
    closed = [
        "sh",
        "-c",
        'exec "$@" 2>&-',
        "sh",
        sys.executable,
        "-m",
        "rodimpact",
        *argv,
    ]
    done = subprocess.run(
        closed, env=ENVIRONMENT, stdout=subprocess.PIPE, text=True, check=False
    )
    expected = output_of(*argv, status=status)
    assert (done.returncode, done.stdout) == (status, expected)
    assert bool(expected) == (status == 0)


@pytest.mark.skipif(os.name == "nt", reason="no such signals")
@pytest.mark.usefixtures("case", "children_hear_signals")
def test_ctrl_c_while_a_file_is_written_leaves_nothing(tmp_path):
    code = (
        "import sys, time; from rodimpact.storage import writing;"
        "writing.os.fsync = lambda _: (print('writing', flush=True), time.sleep(60));"
        "from rodimpact.__main__ import main; main()"
    )
    with started("-c", code, "run", "case.toml", "--save", "a.toml") as process:
        assert process.stdout.readline() == "writing\n"
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
    assert (process.returncode, out, err) == (130, "", "rodimpact: interrupted\n")
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]


@pytest.mark.skipif(os.name == "nt", reason="no such signals")
@pytest.mark.usefixtures("children_hear_signals")
def test_ctrl_c_before_the_program_listens_shows_no_traceback(tmp_path):
    (tmp_path / "argparse.py").write_text(
        "print('starting', flush=True)\nimport time\ntime.sleep(60)\n"
    )
    path = os.pathsep.join([str(tmp_path), str(ROOT)])
    env = ENVIRONMENT | {"PYTHONPATH": path}
    with started("-m", "rodimpact", "materials", env=env, cwd=tmp_path) as process:
        assert process.stdout.readline() == "starting\n"
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=30)
    assert (process.returncode, err) == (130, "")


# run ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("argv", "remedy", "status"),
    [
        (["--until", "0"], "leave out --until to run", 2),
        (["--max-events", "1"], "Raise --max-events", 3),
    ],
)
def test_a_run_of_no_time_prints_its_table_and_tells_why_it_draws_nothing(
    case, capsys, argv, remedy, status
):
    outputs = ["--plot", "a.png", "--gauges", "a.csv", "--gauge", "a=1:0.5"]
    assert main(["run", "case.toml", *argv, *outputs]) == status
    out, err = capsys.readouterr()
    assert "momentum balance" in out
    lines = err.splitlines()
    assert len(lines) == 2
    for line, option in zip(lines, ("--plot", "--gauges"), strict=True):
        reason = "there is nothing to draw, the run ended at 0 s. "
        assert line.startswith(f"rodimpact: {option}: {reason}")
        assert remedy in line
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
    case.write_text(CASE + change)
    error = refuses([command[0], "case.toml", *command[1:]], sentence, remedy)
    assert "--until" not in error
    assert [path.name for path in case.parent.iterdir()] == ["case.toml"]


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
    monkeypatch.setattr(
        "rodimpact.cli.run.solve", lambda *_, **__: pytest.fail("solved")
    )
    Path("there.toml").write_text("precious")
    refuses(["run", str(case), *argv], sentence)
    assert {path.name for path in case.parent.iterdir()} == {"case.toml", "there.toml"}


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
    assert [path.name for path in case.parent.iterdir()] == ["case.toml"]


def test_gauges_of_the_case_are_written(case):
    text = case.read_text()
    case.write_text(
        text + '[[gauges]]\nbody = 1\nfraction = 0.5\nname = "far"\n'
        "[[gauges]]\nbody = 0\nfraction = 1\n"
    )
    rods = ri.read_case(case).system.bodies
    assert main(["run", str(case), "--gauges", "a.csv"]) == 0
    places = [
        f"far=1:{rods[1].length / 2}",
        f"rod 1 at {rods[0].length:g} m=0:{rods[0].length}",
    ]
    argv = [word for place in places for word in ("--gauge", place)]
    assert main(["run", str(case), "--gauges", "b.csv", *argv]) == 0
    assert Path("a.csv").read_text() == Path("b.csv").read_text()
    assert "far" in Path("a.csv").read_text()


@pytest.mark.skipif(os.name == "nt", reason="names are text there")
def test_names_that_are_no_text(case, refuses):
    name = os.fsdecode(b"\xff")
    case.rename(f"{name}.toml")
    assert (
        main(
            [
                "run",
                f"{name}.toml",
                "--save",
                f"{name}.saved.toml",
                "--plot",
                f"{name}.svg",
            ]
        )
        == 0
    )
    assert ri.load(f"{name}.saved.toml").final
    assert main(["export", f"{name}.toml", "-o", f"{name}.html"]) == 0
    assert "<title>\N{REPLACEMENT CHARACTER}</title>" in Path(f"{name}.html").read_text(
        "utf-8"
    )
    refuses(
        ["run", f"{name}.toml", "--gauges", "g.csv", "--gauge", f"{name}=1:0.5"],
        "a column is named by letters",
    )


def test_run_prints_the_table(case, capsys):
    assert main(["run", str(case)]) == 0
    out, err = capsys.readouterr()
    assert "coefficient of restitution e" in out
    assert "158.493 us" in out
    assert err == ""  # notes are for terminals


def test_run_prints_json_in_full_precision(case, output_of):
    data = json.loads(output_of("run", str(case), "--json"))
    expected = ri.collide(
        ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0),
        ri.Rod(1.0, area=1e-4, material=ri.materials.steel),
    )
    assert data["schema_version"] == 1
    assert data["outcome"]["restitution"] == expected.restitution


@pytest.mark.parametrize(
    ("command", "missing"),
    [
        (["run", "--save", "a.toml"], "matplotlib numba scipy"),
        (
            ["sweep", "--vary", "bodies.0.length=50 mm:1 m:5", "--save", "a.npz"],
            "matplotlib",
        ),
    ],
)
@pytest.mark.usefixtures("case")
def test_without_plots_no_matplotlib_is_imported(command, missing):
    code = (
        "import sys; from rodimpact.cli import main;"
        "assert main([*sys.argv[2:], 'case.toml']) == 0;"
        "assert not set(sys.argv[1].split()) & set(sys.modules)"
    )
    done = python("-c", code, missing, *command)
    assert (done.returncode, done.stderr) == (0, "")


def test_notes_go_to_a_terminal(case, capsys, monkeypatch):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    assert main(["run", str(case), "--save", "a.toml"]) == 0
    out, err = capsys.readouterr()
    assert err == "wrote a.toml\n"
    assert "wrote" not in out


def test_options_overrule_the_case(case, output_of):
    case.write_text(CASE + '[solve]\nuntil = "0.1 ms"\n[output]\nsave = "b.toml"\n')
    text = output_of(
        "run", str(case), "--json", "--until", "200 us", "--save", "c.toml"
    )
    assert json.loads(text)["t_end"] == 2e-4
    assert Path("c.toml").exists()
    assert not Path("b.toml").exists()


def test_a_run_that_stops_early_ends_with_3_and_still_reports_and_saves(
    case, output_of
):
    case.write_text(f"{ENDLESS}solve.max_events = 40\n")
    out = output_of(
        "run", "case.toml", "--max-events", "50", "--save", "a.toml", status=3
    )
    assert "velocity at the end" in out
    assert "Raise --max-events" in out
    assert ri.load("a.toml").stopped_by == "max_events"
    out = output_of("animate", "case.toml", "-o", "a.gif", "--frames", "2", status=3)
    assert "cap of 40 events" in out
    assert Path("a.gif").exists()


def test_a_page_of_a_run_that_stops_early_says_so_itself(case, output_of):
    case.write_text(f"{ENDLESS}solve.max_events = 40\n")
    output_of("export", "case.toml", "-o", "a.html")
    sent = tables_of(with_gauges(ri.read_case(case)))
    notes = scene_of(sent["case"], sent["gauges"], LIBRARY)["notes"]
    assert "cap of 40 events" in notes[0]


def test_an_existing_file_needs_force_and_is_left_alone(case, refuses):
    Path("a.toml").write_text("precious")
    refuses(["run", str(case), "--save", "a.toml"], "rodimpact: --save: ", "--force")
    assert Path("a.toml").read_text() == "precious"
    assert main(["run", str(case), "--save", "a.toml", "--force"]) == 0
    assert ri.load("a.toml").final


def test_a_saved_solution_is_a_case_with_its_gauges(case, output_of, capsys):
    case.write_text(CASE + "[[gauges]]\nbody = 1\nfraction = 0.5\n")
    table = output_of("run", str(case), "--save", "run.toml")
    saved = ri.read_case("run.toml")
    assert saved.gauges == ri.read_case(case).gauges
    assert output_of("run", "run.toml") == table
    assert (
        output_of("run", "run.toml", "--save", "again.toml", "--gauges", "a.csv")
        == table
    )
    assert Path("again.toml").read_bytes() == Path("run.toml").read_bytes()
    assert output_of("sweep", "run.toml", "--vary", "bodies.0.velocity=1,2")
    assert capsys.readouterr().err == ""


def test_a_falsified_outcome_is_told_where_the_same_run_is_made(case, capsys):
    main(["run", str(case), "--save", "run.toml"])
    text = Path("run.toml").read_text("utf-8")
    Path("run.toml").write_text(
        re.sub('"peak_force.0" = .*', '"peak_force.0" = 1.0', text)
    )
    capsys.readouterr()
    assert main(["run", "run.toml"]) == 0
    printed = capsys.readouterr().err
    assert printed.startswith(
        "rodimpact: run.toml: the outcome differs from the stored one"
    )
    assert "peak_force.0 is " in printed
    assert printed.count("\n") == 1
    assert main(["run", "run.toml", "--until", "1 ms"]) == 0
    assert capsys.readouterr().err == ""


def test_all_mistakes_of_a_saved_solution_are_reported_at_once(case, refuses):
    main(["run", str(case), "--save", "run.toml"])
    text = Path("run.toml").read_text("utf-8")
    text = text.replace("length = 0.4", "length = -1").replace(
        "final = true", "final = 1"
    )
    text = text.replace('episodes.0" = 1', 'episodes.0" = "x"').replace(
        "dissipated", "disipated"
    )
    Path("run.toml").write_text(text)
    lines = refuses(["run", "run.toml", "--save", "again.npz"]).splitlines()
    paths = {line.split(": ")[1] for line in lines}
    assert paths >= {
        "--save",
        "bodies.0.length",
        "result.final",
        "result.numbers.episodes.0",
        "result.numbers.disipated",
        "result.numbers.dissipated",
    }


def test_all_mistakes_are_reported_at_once(case, refuses):
    Path("a.toml").write_text("precious")
    case.write_text(
        CASE.replace('"0.4 m"', "-1").replace('"steel"\n\n', '"stel"\n\n', 1)
        + '[output]\nsave = "a.toml"\n'
    )
    argv = [
        "run",
        str(case),
        "--until",
        "3 kg",
        "--max-events",
        "0",
        "--cells",
        "1.5",
        "--snapshots",
        "no",
        "--plot",
        "a.toml",
    ]
    lines = refuses(argv).splitlines()
    sentence = {line.split(": ")[1]: line for line in lines}
    assert all(line.startswith("rodimpact: ") for line in lines)
    options = {"--until", "--max-events", "--cells", "--snapshots", "--plot"}
    assert options | {"bodies.0.length"} <= set(sentence)
    assert "unit of mass" in sentence["--until"]


PROFILE = {
    "values": [i % 7 for i in range(11_000)],
    "at": [0.4 * i / 11_000 for i in range(1, 11_000)],
}


@pytest.mark.exhaustive
def test_a_run_that_no_picture_can_show_keeps_its_table(case, capsys):
    velocity = f"{{values = {PROFILE['values']}, at = {PROFILE['at']}}}"
    case.write_text(CASE.replace("velocity = 1.0", f"velocity = {velocity}"))
    assert main(["run", str(case), "--plot", "run.png"]) == 2  # such a call cannot work
    out, err = capsys.readouterr()
    assert err.startswith("rodimpact: --plot: solution: has more than 20000 regions")
    assert out.startswith("body")
    assert not Path("run.png").exists()


# rigid --------------------------------------------------------------------------------------------


def test_rigid_prints_sample_10_19(output_of):
    lines = output_of(*SAMPLE, "-e", "1").splitlines()
    assert " ".join(lines[1].split()) == "1 2 kg 0.5 m/s 0 m/s 1 N s 0 N s"
    assert " ".join(lines[2].split()) == "2 10 kg 0.2 m/s 0.3 m/s 2 N s 3 N s"


def test_rigid_takes_units_signs_walls_and_percent(output_of):
    data = json.loads(
        output_of(
            "rigid",
            "--m1",
            "500 g",
            "--v1",
            "10",
            "--m2",
            "inf",
            "--v2",
            "-20cm/s",
            "-e",
            "90%",
            "--json",
        )
    )
    assert data["m2"] is data["energy_before"] is None
    assert data["velocity_1"] == pytest.approx(-0.2 - 0.9 * 10.2, rel=1e-14)
    assert data["impulse"] == pytest.approx(0.5 * 1.9 * 10.2, rel=1e-14)


def test_rigid_reports_all_mistakes_at_once(refuses):
    argv = ["rigid", "--m1", "2 m", "--v1", "x", "--m2", "1", "--v2", "0", "-e", "1 s"]
    lines = refuses(argv).splitlines()
    assert {line.split(": ")[1] for line in lines} == {"--m1", "--v1", "-e"}


def test_rigid_refuses_energy_unless_it_is_released(refuses, output_of):
    refuses([*SAMPLE, "-e", "1.5"], "--energy-release")
    assert "-93.75 mJ" in output_of(*SAMPLE, "-e", "1.5", "--energy-release")


# verify, materials, doctor ------------------------------------------------------------------------


def test_verify_checks_each_method_and_names_the_validation_pages(output_of):
    *table, verdict = output_of("verify").splitlines()
    passed = [line for line in table if line.endswith("  ok")]
    assert len(passed) == len(METHODS)
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
    result = [Check("a", 1.0, 1.0, 1e-9), Check("b", 1.0, computed, 1e-9)]
    monkeypatch.setattr("rodimpact.cli.verify.checks", lambda: result)
    assert sentence in output_of("verify", status=status)
    data = json.loads(output_of("verify", "--json", status=status))
    assert data["passed"] is (status == 0)
    assert [check["passed"] for check in data["checks"]] == [True, status == 0]


@pytest.mark.parametrize("method", METHODS)
def test_a_wrong_solver_is_noticed(monkeypatch, method):
    right = verify.solve

    def wrong(system, **options):
        solution = right(system, **options)
        if options["method"] == method:
            e = solution.outcome.restitution * 1.02
            return SimpleNamespace(outcome=SimpleNamespace(restitution=e))
        return solution

    monkeypatch.setattr(verify, "solve", wrong)
    assert sum(not check.passed for check in checks()) == 1


def test_materials_names_speeds_and_sources(output_of):
    out = output_of("materials")
    steel = next(line for line in out.splitlines() if line.startswith("steel"))
    assert steel.split() == [
        "steel",
        "200",
        "GPa",
        "7850",
        "kg/m^3",
        "5048",
        "m/s",
        "0.29",
    ]
    data = json.loads(output_of("materials", "--json"))["materials"]
    assert {m["name"] for m in data} == set(ri.materials.TABLE)
    assert all(m["source"] for m in data)


def test_doctor_shows_versions_and_the_cache(output_of):
    data = json.loads(output_of("doctor", "--json"))
    assert data["versions"]["rodimpact"] == ri.__version__
    assert data["versions"]["numpy"] == np.__version__
    assert bool(data["no_compiler"]) is not kernels.enabled()
    cache = data["cache_directory"]
    assert cache is None or Path(cache).is_dir()
    assert cache is None or cache in output_of("doctor")


def test_doctor_says_how_long_it_took_to_compile_everything(monkeypatch, output_of):
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


# box ----------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def box(tmp_path_factory):
    """What `box` prints, and the directory it fills."""
    directory = tmp_path_factory.mktemp("box")
    (directory / "restitution.png").write_text("of an earlier run")
    with contextlib.redirect_stdout(io.StringIO()) as out:
        assert main(["box", "-o", str(directory), "--force"]) == 0
    return out.getvalue(), directory


def story(text, title):
    """Stages and results of one collision, without the blanks between words."""
    part = text.split(f"\n{title}")[1].split("\n\n\n")[0]
    return [" ".join(line.split()) for line in part.splitlines()]


def test_box_tells_the_stages_of_identical_rods(box):
    lines = story(box[0], "Identical rods")
    turn = "the wave turns back at the free end of the"
    at = lines.index(f"198.116 us {turn} left rod")
    assert lines[at - 2 : at] == [
        "left rod 1 m/s, no stress <| 0.5 m/s, 19.8 MPa compression",
        "right rod 0.5 m/s, 19.8 MPa compression |> 0 m/s, no stress",
    ]
    assert lines[at + 1 : at + 9] == [
        f"{turn} right rod",
        "left rod 0 m/s, no stress |> 0.5 m/s, 19.8 MPa compression",
        "right rod 0.5 m/s, 19.8 MPa compression <| 1 m/s, no stress",
        "396.232 us the wave is back at the contact",
        "the contact force ends",
        "the gap opens",
        "left rod 0 m/s, no stress",
        "right rod 1 m/s, no stress",
    ]


def test_box_puts_theory_beside_what_it_found_and_says_where_the_textbook_lets_rods_part(
    box,
):
    lines = story(box[0], "Rods of different length, l1/l2 = 0.4")
    for line in (
        "coefficient of restitution e 0.4 0.4",
        "contact force lasts 158.493 us 158.493 us",
        "gap opens after 396.232 us 396.232 us",
        "energy left in vibration 94.2 mJ 94.2 mJ",
        "277.363 us two fronts cross in the right rod, 600 mm from its left end",
    ):
        assert line in lines
    sentence = "The force ends after 158.493 us. In the textbook the rods part then."
    assert sentence in " ".join(lines)
    assert "In the textbook" not in " ".join(story(box[0], "Identical rods"))
    assert "coefficient of restitution e 1 1" in story(box[0], "A rod on a rigid wall")


@pytest.mark.exhaustive
def test_box_draws_another_format_material_and_look_and_a_dowel(tmp_path, output_of):
    options = ["--format", "svg", "--dark", "--material", "brass", "--dowel"]
    text = output_of("box", *options, "-o", str(tmp_path))
    assert "3434 m/s" in text
    dowel = story(text, "A wooden dowel, 3 ft long, on a stone floor")
    assert "coefficient of restitution e 1 1" in dowel
    trips = 2 * 3 * 0.3048 / ri.materials.oak.wave_speed
    assert f"contact force lasts {1e6 * trips:.3f} us {1e6 * trips:.3f} us" in dowel
    figures = sorted(path.name for path in tmp_path.glob("*.svg"))
    assert len(figures) == 21
    assert "#14161a" in (tmp_path / "dowel-stages.svg").read_text(encoding="utf-8")
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert sorted(re.findall(r'<img src="([^"]+)"', page)) == figures


@pytest.fixture
def no_figures(monkeypatch):
    monkeypatch.setattr("rodimpact.cli.box.draw", lambda *_: [])


def test_box_defaults_to_a_directory_of_its_own(no_figures, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["box"]) == 0
    assert (tmp_path / "rodimpact-box").is_dir()
    assert main(["box", "-o", "a/b"]) == 0
    assert (tmp_path / "a" / "b").is_dir()


@pytest.mark.parametrize("ratio", ["0", "1.5", "-0.4", "x"])
def test_box_refuses_a_ratio_that_is_none(no_figures, tmp_path, refuses, ratio):
    refuses(
        ["box", "--ratio", ratio, "-o", str(tmp_path / "new")], "rodimpact: --ratio: "
    )
    assert not (tmp_path / "new").exists()


def test_box_leaves_files_that_are_there(no_figures, tmp_path, refuses):
    (tmp_path / "wall-energy.png").write_text("precious")
    refuses(["box", "-o", str(tmp_path)], "holds wall-energy.png already", "--force")
    assert main(["box", "-o", str(tmp_path), "--force"]) == 0


def test_box_needs_a_directory(no_figures, case, refuses, capsys):
    refuses(["box", "-o", "case.toml"], "is not a directory")
    assert main(["box", "-o", "case.toml/in"]) == 1
    assert "Traceback" not in capsys.readouterr().err


def test_options_replace_what_they_exclude_in_the_case(
    tmp_path, monkeypatch, output_of
):
    monkeypatch.chdir(tmp_path)
    cases = Path(__file__).parents[2] / "validation" / "cases"
    text = (cases / "lossy-rods.toml").read_text().replace("cells = 100", "cells = 20")
    Path("lossy.toml").write_text(text.replace('until = "20 ms"', 'until = "1 ms"'))
    result = json.loads(output_of("run", "lossy.toml", "--rtol", "0.05", "--json"))
    assert "Stated relative error: " in result["outcome"]["status"]
    result = json.loads(output_of("run", "lossy.toml", "--cells", "10", "--json"))
    assert "14 cells" in result["outcome"]["status"]


@pytest.mark.parametrize("date", ["x", "", "-1", "1e9", "9" * 30])
def test_a_date_of_files_that_is_none_is_refused(case, refuses, monkeypatch, date):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", date)
    refuses(
        ["run", "case.toml"], "SOURCE_DATE_EPOCH: must be a whole number of seconds"
    )


def test_all_cases_of_the_validation_can_be_run():
    cases = Path(__file__).parents[2] / "validation" / "cases"
    paths = sorted(cases.glob("*.toml"))
    assert len(paths) > 5
    for path in paths:
        case = ri.read_case(path)
        if not case.system.shape:
            assert ri.Options(**case.solve).method_for(case.system)
