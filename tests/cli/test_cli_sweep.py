"""rodimpact sweep: what it prints, draws and saves, and how it ends."""

import csv
import io
import json
from pathlib import Path

import numpy as np
import pytest
from case_texts import UNEQUAL_RODS as CASE

import rodimpact as ri
from rodimpact.cli import main
from rodimpact.cli import sweep as command

ROOT = Path(__file__).parents[2]
# fronts multiply for ever where these lengths do not fit together
STEPPED = """\
schema = 1
bodies = [
    {kind = "wall"},
    {kind = "rod", velocity = -1.0, segments = [
        {length = 0.41421356, area = 1e-4, material = "steel"},
        {length = 0.73205081, area = 3e-4, material = "brass"},
    ]},
]
"""
LENGTHS = "bodies.0.length=50 mm:1 m:5"


@pytest.fixture
def no_sweep(monkeypatch):
    """Whatever is refused is refused before any work."""
    monkeypatch.setattr(command, "sweep", lambda *_, **__: pytest.fail("solved"))


def sweep(*argv):
    return main(["sweep", "case.toml", *argv])


@pytest.fixture
def swept(output_of):
    """What a sweep prints."""
    return lambda *argv, **status: output_of("sweep", "case.toml", *argv, **status)


@pytest.fixture
def refused(refuses):
    """As `refuses`, of a sweep: what is said comes first, the options after it."""
    return lambda said, *argv: refuses(["sweep", "case.toml", *argv], said)


def lines_of(text, start):
    return [
        " ".join(line.split())
        for line in text.splitlines()
        if line.lstrip().startswith(start)
    ]


# What is printed ----------------------------------------------------------------------------------


def test_the_table_tells_what_varied_and_what_came_out(case, capsys):
    assert sweep("--vary", LENGTHS) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert lines_of(out, "bodies.0.length")[0] == "bodies.0.length 5 50 mm 1 m"
    assert "collisions 5 in a grid of 5" in lines_of(out, "collisions")
    [least] = lines_of(out, "smallest")
    assert least == "smallest coefficient of restitution e 0.05 bodies.0.length = 50 mm"
    [most] = lines_of(out, "largest")
    assert most == "largest coefficient of restitution e 1 bodies.0.length = 1 m"
    # e = l1/l2; impulse m1 v; the force lasts 2 l1/c
    [row] = lines_of(out, "287.5 mm")
    assert row == "287.5 mm 0.2875 225.688 mN s 1.98116 kN 113.917 us 1 80.4012 mJ"
    [row] = lines_of(out, "1 m")
    assert row.endswith(" 1 0 J")
    assert "no e" not in out
    assert all(line == line.rstrip() for line in out.splitlines())


def test_energies_of_round_off_are_none(case, swept):
    out = swept(
        "--vary", "bodies.0.length=1 m:2 m:2", "--vary", "bodies.0.velocity=1.7:1.9:3"
    )
    swapped = lines_of(out, "1 m")  # rods of one length swap their velocities
    assert len(swapped) == 3
    assert all(line.endswith(" 1 0 J") for line in swapped)


def test_the_first_grid_is_the_first_axis(case, swept):
    out = swept("--vary", LENGTHS, "--vary", "contacts.0.gap=0,1 um")
    assert "collisions 10 in a grid of 5 x 2" in lines_of(out, "collisions")
    assert [line.split()[:4] for line in lines_of(out, "50 mm")] == [
        ["50", "mm", "0", "m"],
        ["50", "mm", "1", "um"],
    ]


def test_a_large_family_is_shown_in_part_with_the_way_to_all(case, swept):
    out = swept("--vary", "bodies.0.length=0.05:1:20")
    assert len(lines_of(out, "")) > 20
    assert "..." not in out
    out = swept("--vary", "bodies.0.length=0.05:1:21")
    rows = out.split("\n\n")[2].splitlines()
    assert len(rows) == 1 + 12 + 1
    assert rows[1].split()[:2] == ["50", "mm"]
    assert rows[12].split()[:2] == ["1", "m"]
    assert rows[13] == "... 12 of 21; --csv prints all, --save keeps them"


def test_collisions_without_e_are_counted_with_the_reason(case, swept):
    out = swept("--vary", "bodies.0.velocity=-2,0,1,2")
    rows = out.split("\n\n")[2].splitlines()[1:]
    assert [row.split()[2] for row in rows] == ["-", "-", "0.4", "0.4"]
    assert "2 collisions have no e. At bodies.0.velocity = -2 m/s: " in out
    assert "nothing collided" in out.splitlines()[-1]
    assert out.endswith(".\n")
    assert "1 collision has no e." in swept("--vary", "bodies.0.velocity=-2,1")


def test_a_long_row_shows_its_ends(case, swept):
    rod = '[[bodies]]\nkind="rod"\nlength=0.1\narea=1e-4\nmaterial="steel"\n'
    case.write_text("schema = 1\n" + rod + "velocity = 1\n" + 9 * rod)
    head = swept("--vary", "bodies.0.velocity=1,2").split("\n\n")[2].splitlines()[0]
    assert [i for i in range(10) if f"velocity {i} after" in head] == [
        0,
        1,
        2,
        3,
        6,
        7,
        8,
        9,
    ]


def test_csv_and_json_have_the_same_columns_in_full_precision(case, swept):
    argv = ["--vary", LENGTHS, "--vary", "bodies.0.velocity=-1,1"]
    data = json.loads(swept(*argv, "--json"))
    assert (data["schema_version"], data["method"], data["shape"]) == (
        1,
        "fronts",
        [5, 2],
    )
    assert data["varied"][0] == {
        "path": "bodies.0.length",
        "unit": "m",
        "values": np.linspace(0.05, 1, 5).tolist(),
    }
    assert data["varied"][1]["values"] == [-1, 1]
    columns = data["columns"]
    result = ri.sweep(
        ri.read_case(
            case, {"bodies.0.length": "50 mm:1 m:5", "bodies.0.velocity": "-1,1"}
        ).system
    )
    assert columns["restitution"][::2] == [None] * 5
    assert columns["restitution"][1::2] == result.restitution[:, 1].tolist()
    assert columns["vibration"] == result.vibration.ravel().tolist()
    assert columns["final"] == [True] * 10
    assert columns["status"] == ["final"] * 10
    assert columns["episodes.0"][:2] == [0, 1]
    assert columns["bodies.0.velocity"] == [-1, 1] * 5
    rows = list(csv.DictReader(io.StringIO(swept(*argv, "--csv"))))
    assert list(rows[0]) == list(columns)
    for name in ("bodies.0.length", "restitution", "vibration"):
        assert [float(row[name]) if row[name] else None for row in rows] == columns[
            name
        ]


def test_the_example_of_the_manual_runs(monkeypatch, tmp_path, case):
    text = (ROOT / "docs" / "input.md").read_text(encoding="utf-8")
    example = text.partition("rodimpact sweep case.toml")[2].partition("```")[0]
    argv = (str(case) + example.replace("\\\n", " ")).replace(":200", ":3").split()
    monkeypatch.chdir(tmp_path)
    assert main(["sweep", *argv]) == 0
    assert ri.load("map.npz").shape == (3, 3)
    assert Path("map.png").read_bytes().startswith(b"\x89PNG")


# Files --------------------------------------------------------------------------------------------


def test_what_no_figure_can_show_is_refused_before_the_sweep(case, no_sweep, refused):
    three = [
        "--vary",
        LENGTHS,
        "--vary",
        "bodies.0.velocity=1,2",
        "--vary",
        "contacts.0.gap=0,1",
    ]
    refused(
        "--plot: a figure has one or two axes, and 3 numbers vary",
        *three,
        "--plot",
        "a.png",
    )
    refused("and 0 numbers vary", "--vary", "contacts.0.gap=1", "--plot", "a.png")
    case.write_text(
        CASE + "[ends.left]\nkind = 'force'\nvalue = 1\n[solve]\nuntil = 1e-4\n"
    )
    one = ["--vary", LENGTHS, "--plot", "a.png"]
    refused("such a row has no e; name another --quantity", *one)
    rod = CASE.rpartition("[[bodies]]")[2]
    case.write_text(CASE + "\n[[bodies]]" + rod)
    refused("such a row has no e; name another --quantity", *one)


def test_rows_of_several_contacts_are_drawn_by_another_quantity(case, refused):
    case.write_text((ROOT / "validation" / "cases" / "newtons-cradle.toml").read_text())
    argv = ["--vary", "bodies.0.velocity=1:2:3", "--plot"]
    for quantity in ("velocity_after.4", "duration.3"):
        assert sweep(*argv, f"{quantity}.png", "--quantity", quantity) == 0
        assert Path(f"{quantity}.png").read_bytes().startswith(b"\x89PNG")
    refused(
        "--quantity: there is no 'velocity_after.5'; use one of velocity_after.0, ",
        *argv,
        "b.png",
        "--quantity",
        "velocity_after.5",
    )
    assert not Path("b.png").exists()


def test_where_no_collision_has_e_the_table_is_there_and_the_figure_is_not(
    case, capsys
):
    assert (
        sweep("--vary", "bodies.0.velocity=-1,-2", "--plot", "a.png", "--save", "a.npz")
        == 2
    )
    out, err = capsys.readouterr()
    assert "2 collisions have no e." in out
    assert err.startswith("rodimpact: --plot: ")
    assert err.count("\n") == 1
    assert not Path("a.png").exists()
    assert ri.load("a.npz").shape == (2,)


def test_files_of_the_case_are_for_a_single_run(case):
    case.write_text(CASE + "[output]\nsave = 'b.npz'\n")
    assert sweep("--vary", LENGTHS) == 0
    assert not Path("b.npz").exists()


# How it ends --------------------------------------------------------------------------------------


def test_collisions_that_stop_early_are_recorded_and_end_with_3(case, swept):
    case.write_text(STEPPED)
    argv = ["--vary", "bodies.1.segments.0.length=0.41421356,0.5", "--max-events", "5"]
    out = swept(*argv, status=3)
    assert "2 collisions have no e." in out
    assert "Raise --max-events" in out
    data = json.loads(swept(*argv, "--json", status=3))
    assert data["columns"]["status"] == ["max_events"] * 2


def test_all_mistakes_are_reported_at_once(case, no_sweep, refused):
    Path("a.npz").write_text("precious")
    case.write_text(CASE.replace('"1 m"', "-1") + "[solve]\nuntil = 1\n")
    argv = [
        "--vary",
        "bodies.0.lenth=1,2",
        "--vary",
        "bodies.0.area=1:2",
        "--vary",
        "x",
        "--vary",
        "=1,2",
        "--vary",
        "contacts.0.gap=0,1",
        "--vary",
        "contacts.0.gap=0:1:3",
        "--workers",
        "0",
        "--max-events",
        "many",
        "--save",
        "a.npz",
        "--plot",
        "a.gif",
    ]
    err = refused("is varied twice", *argv)
    lines = err.splitlines()
    assert sorted(line.split(": ")[1] for line in lines) == [
        "--max-events",
        "--plot",
        "--save",
        "--vary",
        "--vary",
        "--workers",
        "bodies.0.area",
        "bodies.0.lenth",
        "bodies.1.length",
        "contacts.0.gap",
    ]
    assert "must be PATH=GRID, such as bodies.0.length=0.05:1:200, got 'x'" in err
    assert "perhaps 'bodies.0.length' is meant" in err


@pytest.mark.parametrize(
    "arguments", ["0", "-1", "1.5", "many", "\u00b2", "9" * 30, "9" * 5000]
)
@pytest.mark.parametrize("option", ["--workers", "--max-events"])
def test_whole_numbers(case, no_sweep, refused, option, arguments):
    refused(
        f"rodimpact: {option}: must be a positive whole number",
        "--vary",
        LENGTHS,
        option,
        arguments,
    )


def test_something_must_vary(case, no_sweep, refused):
    refused("rodimpact: --vary: name what to vary: --vary bodies.0.length=0.05:1:200\n")


def test_a_sweep_keeps_no_states(case, no_sweep, refused):
    case.write_text(CASE + "[solve]\nsnapshots = 1\n")
    refused("rodimpact: solve.snapshots: a sweep keeps no states", "--vary", LENGTHS)


@pytest.mark.parametrize(
    ("solve", "argv", "path", "sentence"),
    [
        ("", ["--dt", "1 us", "--method", "fronts"], "--dt", "leave it out"),
        (
            "cells = 20",
            ["--method", "fronts"],
            "solve.cells",
            'is for method "finite-difference"',
        ),
        ("dt = 1e-6\nmethod = 'fronts'", [], "solve.dt", "leave it out"),
        ("", ["--until", "soon"], "--until", "cannot read 'soon' as time"),
    ],
)
@pytest.mark.usefixtures("no_sweep")
def test_options_are_checked_as_for_a_single_run(
    case, refuses, refused, solve, argv, path, sentence
):
    case.write_text(CASE + f"[solve]\n{solve}\n")
    swept = refused(f"rodimpact: {path}: ", "--vary", LENGTHS, *argv)
    assert refuses(["run", "case.toml", *argv], sentence) == swept


def test_the_options_reach_the_sweep(case, monkeypatch):
    arguments = {}

    def spy(system, **options):
        arguments.update(options, shape=system.shape)
        return ri.sweep(system)

    monkeypatch.setattr(command, "sweep", spy)
    case.write_text(CASE + "[solve]\nmethod = 'fronts'\nmax_events = 7\n")
    assert sweep("--vary", LENGTHS) == 0
    expected = {
        "shape": (5,),
        "method": "fronts",
        "max_events": 7,
        "checkpoint": None,
        "also": [],
        "workers": None,
    }
    assert arguments == expected
    assert (
        sweep(
            "--vary",
            LENGTHS,
            "--workers",
            "2",
            "--max-events",
            "8",
            "--checkpoint",
            "d",
        )
        == 0
    )
    changed = {"workers": 2, "max_events": 8, "checkpoint": "d"}
    assert arguments == expected | changed


def test_a_checkpoint_keeps_the_sweep(case, refused, swept):
    first = swept("--vary", LENGTHS, "--checkpoint", "kept")
    assert swept("--vary", LENGTHS, "--checkpoint", "kept") == first
    err = refused(
        "rodimpact: kept: holds another sweep",
        "--vary",
        "bodies.0.length=50 mm:1 m:6",
        "--checkpoint",
        "kept",
    )
    assert err.count("\n") == 1


@pytest.mark.filterwarnings("default::rodimpact.DamagedChunks")
def test_a_damaged_checkpoint_is_told_in_a_line(case, capsys, swept):
    before = swept("--vary", LENGTHS, "--checkpoint", "kept")
    (path,) = Path("kept").iterdir()
    path.write_bytes(path.read_bytes()[:-1])
    assert sweep("--vary", LENGTHS, "--checkpoint", "kept") == 0
    out, err = capsys.readouterr()
    assert out == before
    (line,) = err.splitlines()
    assert line.startswith(f"rodimpact: {path}: is not a whole NPZ file")
    assert line.endswith("it is put aside, and its members are run again")


def test_what_else_is_wanted_has_columns(case, refused, capsys, swept):
    arguments = "--vary", LENGTHS, "--also", "dissipated", "--also", "largest_stress"
    assert sweep(*arguments, "--csv") == 0
    names = capsys.readouterr().out.partition("\n")[0].split(",")
    assert names[-3:] == ["dissipated", "largest_stress.0", "largest_stress.1"]
    assert "largest stress in rod 1" in swept(*arguments)
    refused("--until", "--vary", LENGTHS, "--also", "displacement")


YIELDING = """\
schema = 1
bodies = [
    {kind = "mass", mass = 1, velocity = 5},
    {kind = "rod", length = 1, area = 1e-4, material = "steel"},
]
contacts = [{law = "yielding", stiffness = 1e8, yield_force = 1e3, hardening = 1e6}]
"""


def test_a_figure_of_what_also_computes(case, swept, refused):
    case.write_text(YIELDING)
    vary = ("--vary", "bodies.0.velocity=1,2", "--until", "0.2 ms")
    figure = ("--plot", "set.svg", "--quantity", "set.0")
    refused("--quantity: 'set.0' is not computed; add --also set", *vary, *figure)
    swept(*vary, *figure, "--also", "set")
    assert "permanent set" in Path("set.svg").read_text()
    refused("there is no 'set.1'", *vary, "--also", "set", *figure[:3], "set.1")
