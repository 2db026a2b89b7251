"""rodimpact sweep: printed tables, figures, saved files and exit statuses."""

import csv
import io
import json
import re
from pathlib import Path

import numpy as np
import pytest
from case_texts import UNEQUAL_RODS as CASE

import rodimpact as ri
from rodimpact.cli import main
from rodimpact.cli import sweep as command

ROOT = Path(__file__).parents[2]
# Lengths without a common measure, at which the number of fronts grows for ever.
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
    """A refusal comes before any work."""
    monkeypatch.setattr(command, "sweep", lambda *_, **__: pytest.fail("solved"))


def sweep(*argv):
    """Exit status of `rodimpact sweep`."""
    return main(["sweep", "case.toml", *argv])


@pytest.fixture
def swept(output_of):
    """Function that runs a sweep, and returns the printed text."""

    def call(*argv, **status):
        return output_of("sweep", "case.toml", *argv, **status)

    return call


@pytest.fixture
def refused(refuses):
    """Function like `refuses` for a sweep: first the message, then the options."""

    def call(message, *argv):
        return refuses(["sweep", "case.toml", *argv], message)

    return call


def lines_of(text, start):
    """Lines of a text that begin with `start`, each with single blanks between its
    words.
    """
    lines = []
    for line in text.splitlines():
        if line.lstrip().startswith(start):
            lines.append(" ".join(line.split()))
    return lines


def table_of(text):
    """Lines of the table of collisions, its head first."""
    _, _, table, *_ = text.split("\n\n")
    return table.splitlines()


# Printed tables


def test_the_table_names_the_parameters_and_the_extremes(case, capsys):
    """The table of a sweep over five lengths names the parameter with its range, the
    number of collisions, the smallest and largest e with their lengths; no line ends
    with a space.
    """
    assert sweep("--vary", LENGTHS) == 0

    out, err = capsys.readouterr()
    (least,) = lines_of(out, "smallest")
    (most,) = lines_of(out, "largest")
    assert err == ""
    assert lines_of(out, "bodies.0.length")[0] == "bodies.0.length 5 50 mm 1 m"
    assert "collisions 5 in a grid of 5" in lines_of(out, "collisions")
    assert least == "smallest coefficient of restitution e 0.05 bodies.0.length = 50 mm"
    assert most == "largest coefficient of restitution e 1 bodies.0.length = 1 m"
    assert "no e" not in out
    for line in out.splitlines():
        assert line == line.rstrip()


def test_the_table_has_the_results_of_each_collision(case, swept):
    """e = l1/l2, impulse m1 v, force duration 2 l1/c."""
    out = swept("--vary", LENGTHS)

    (short,) = lines_of(out, "287.5 mm")
    (equal,) = lines_of(out, "1 m")
    assert short == "287.5 mm 0.2875 225.688 mN s 1.98116 kN 113.917 us 1 80.4012 mJ"
    assert equal.endswith(" 1 0 J")


def test_energies_of_round_off_are_printed_as_0(case, swept):
    """For rods of equal length, which swap velocities, the table of a sweep prints e =
    1 and 0 J.
    """
    lengths = "bodies.0.length=1 m:2 m:2"
    velocities = "bodies.0.velocity=1.7:1.9:3"

    out = swept("--vary", lengths, "--vary", velocities)

    swapped = lines_of(out, "1 m")  # rods of one length swap their velocities
    assert len(swapped) == 3
    for line in swapped:
        assert line.endswith(" 1 0 J")


def test_the_first_grid_is_the_first_axis(case, swept):
    """A sweep over lengths and gaps: the table counts 10 collisions in a grid of 5 x 2,
    with the gap varying fastest.
    """
    out = swept("--vary", LENGTHS, "--vary", "contacts.0.gap=0,1 um")

    first, second = lines_of(out, "50 mm")
    assert "collisions 10 in a grid of 5 x 2" in lines_of(out, "collisions")
    assert first.startswith("50 mm 0 m ")
    assert second.startswith("50 mm 1 um ")


def test_a_small_family_is_shown_whole(case, swept):
    out = swept("--vary", "bodies.0.length=0.05:1:20")

    assert len(table_of(out)) == 1 + 20
    assert "..." not in out


def test_a_large_family_is_shown_in_part_with_the_way_to_all(case, swept):
    """The table of 21 members shows 12, with the first and the last one, and the
    options for all.
    """
    out = swept("--vary", "bodies.0.length=0.05:1:21")

    _, first, *others, last, rest = table_of(out)
    assert len(others) == 10
    assert first.split()[:2] == ["50", "mm"]
    assert last.split()[:2] == ["1", "m"]
    assert rest == "... 12 of 21; --csv prints all, --save keeps them"


def test_collisions_without_e_are_counted_with_the_reason(case, swept):
    """Two of four members do not collide: they have "-" for e, and a line counts them
    with a reason.
    """
    out = swept("--vary", "bodies.0.velocity=-2,0,1,2")

    _, *rows = table_of(out)
    restitutions = [row.split()[2] for row in rows]
    assert restitutions == ["-", "-", "0.4", "0.4"]
    assert "2 collisions have no e. At bodies.0.velocity = -2 m/s: " in out
    assert "nothing collided" in out.splitlines()[-1]
    assert out.endswith(".\n")


def test_one_collision_without_e_is_counted(case, swept):
    assert "1 collision has no e." in swept("--vary", "bodies.0.velocity=-2,1")


def test_a_long_row_shows_its_ends(case, swept):
    """The table of a sweep of ten rods has columns for the velocities of the first and
    the last four.
    """
    rod = '[[bodies]]\nkind="rod"\nlength=0.1\narea=1e-4\nmaterial="steel"\n'
    case.write_text("schema = 1\n" + rod + "velocity = 1\n" + 9 * rod)

    head, *_ = table_of(swept("--vary", "bodies.0.velocity=1,2"))

    shown = re.findall(r"velocity (\d) after", head)
    assert shown == ["0", "1", "2", "3", "6", "7", "8", "9"]


GRID = ["--vary", LENGTHS, "--vary", "bodies.0.velocity=-1,1"]


@pytest.fixture
def data(case, swept):
    """What a sweep over lengths and velocities prints as JSON."""
    return json.loads(swept(*GRID, "--json"))


def test_json_has_schema_method_shape_and_the_varied_numbers(data):
    """`sweep --json` over lengths and velocities has the schema, the method, the shape
    [5, 2], and path, unit and values of both.
    """
    lengths, velocities = data["varied"]
    assert data["schema_version"] == 1
    assert data["method"] == "fronts"
    assert data["shape"] == [5, 2]
    assert lengths == {
        "path": "bodies.0.length",
        "unit": "m",
        "values": np.linspace(0.05, 1, 5).tolist(),
    }
    assert velocities["path"] == "bodies.0.velocity"
    assert velocities["values"] == [-1, 1]


def test_json_has_the_columns_of_the_sweep(case, data):
    """`sweep --json` has the columns of the same sweep in Python; without a collision
    the restitution is None.
    """
    grids = {"bodies.0.length": "50 mm:1 m:5", "bodies.0.velocity": "-1,1"}
    result = ri.sweep(ri.read_case(case, grids).system)

    columns = data["columns"]
    assert columns["restitution"][::2] == [None] * 5
    assert columns["restitution"][1::2] == result.restitution[:, 1].tolist()
    assert columns["vibration"] == result.vibration.ravel().tolist()
    assert columns["final"] == [True] * 10
    assert columns["status"] == ["final"] * 10
    assert columns["episodes.0"][:2] == [0, 1]
    assert columns["bodies.0.velocity"] == [-1, 1] * 5


@pytest.mark.parametrize("name", ["bodies.0.length", "restitution", "vibration"])
def test_csv_has_the_same_columns_in_full_precision(data, swept, name):
    """The CSV of a sweep has the columns of its JSON with the same numbers, and nothing
    for None.
    """
    columns = data["columns"]

    rows = list(csv.DictReader(io.StringIO(swept(*GRID, "--csv"))))

    assert list(rows[0]) == list(columns)
    for row, expected in zip(rows, columns[name], strict=True):
        if expected is None:
            assert row[name] == ""
        else:
            assert float(row[name]) == expected


def test_the_example_of_the_manual_runs(monkeypatch, tmp_path, case):
    """The `sweep` command in the manual, with smaller grids, writes its file and its
    figure.
    """
    text = (ROOT / "docs" / "input.md").read_text(encoding="utf-8")
    example = text.partition("rodimpact sweep case.toml")[2].partition("```")[0]
    options = example.replace("\\\n", " ").replace(":200", ":3")
    argv = [str(case), *options.split()]
    monkeypatch.chdir(tmp_path)
    assert main(["sweep", *argv]) == 0
    assert ri.load("map.npz").shape == (3, 3)
    assert Path("map.png").read_bytes().startswith(b"\x89PNG")


# Files


PLOT = ["--plot", "a.png"]


@pytest.mark.usefixtures("case", "no_sweep")
def test_a_figure_of_three_axes_is_refused_before_the_sweep(refused):
    message = "--plot: a figure has one or two axes, and 3 numbers vary"

    refused(message, *GRID, "--vary", "contacts.0.gap=0,1", *PLOT)


@pytest.mark.usefixtures("case", "no_sweep")
def test_a_figure_without_an_axis_is_refused_before_the_sweep(refused):
    refused("and 0 numbers vary", "--vary", "contacts.0.gap=1", *PLOT)


DRIVEN = "[ends.left]\nkind = 'force'\nvalue = 1\n[solve]\nuntil = 1e-4\n"
THIRD_ROD = "\n[[bodies]]" + CASE.rpartition("[[bodies]]")[2]


@pytest.mark.parametrize("more", [DRIVEN, THIRD_ROD])
@pytest.mark.usefixtures("no_sweep")
def test_a_figure_of_rows_without_e_is_refused_before_the_sweep(case, refused, more):
    case.write_text(CASE + more)

    message = "such a row has no e; name another --quantity"
    refused(message, "--vary", LENGTHS, *PLOT)


@pytest.mark.exhaustive
def test_rows_of_several_contacts_are_drawn_by_another_quantity(case, refused):
    """A sweep over a cradle is drawn by two of its columns; a velocity of a body that
    is not there is refused with those that are.
    """
    cradle = ROOT / "validation" / "cases" / "newtons-cradle.toml"
    case.write_text(cradle.read_text())
    argv = ["--vary", "bodies.0.velocity=1:2:3", "--plot"]
    for quantity in ("velocity_after.4", "duration.3"):
        assert sweep(*argv, f"{quantity}.png", "--quantity", quantity) == 0
        assert Path(f"{quantity}.png").read_bytes().startswith(b"\x89PNG")
    message = (
        "--quantity: there is no 'velocity_after.5'; use one of velocity_after.0, "
    )
    refused(message, *argv, "b.png", "--quantity", "velocity_after.5")
    assert not Path("b.png").exists()


def test_without_any_e_the_table_is_printed_and_the_figure_is_not(case, capsys):
    """A sweep in which no rods collide: status 2, the table says so, the family is
    saved, and one line says why there is no figure.
    """
    status = sweep("--vary", "bodies.0.velocity=-1,-2", *PLOT, "--save", "a.npz")

    assert status == 2
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


# Exit statuses


def test_collisions_that_stop_early_are_recorded_and_end_with_3(case, swept):
    """Two members stop at the cap on events: status 3, advice in the table, and
    "max_events" in the JSON.
    """
    case.write_text(STEPPED)
    argv = ["--vary", "bodies.1.segments.0.length=0.41421356,0.5", "--max-events", "5"]

    out = swept(*argv, status=3)
    data = json.loads(swept(*argv, "--json", status=3))

    assert "2 collisions have no e." in out
    assert "Raise --max-events" in out
    assert data["columns"]["status"] == ["max_events"] * 2


@pytest.mark.usefixtures("case", "no_sweep")
def test_a_saved_family_is_no_table(refused):
    error = refused(
        "--save: must end in .npz, got 'e.csv'", "--vary", LENGTHS, "--save", "e.csv"
    )
    assert "--csv prints a table: end the command with > FILE.csv" in error


def test_all_mistakes_are_reported_at_once(case, no_sweep, refused):
    """`sweep` of a wrong case with many wrong options names all ten of them, with a
    suggestion for a misspelt path, and does not sweep.
    """
    Path("a.npz").write_text("precious")
    case.write_text(CASE.replace('"1 m"', "-1") + "[solve]\nuntil = 1\n")
    grids = [
        "bodies.0.lenth=1,2",
        "bodies.0.area=1:2",
        "x",
        "=1,2",
        "contacts.0.gap=0,1",
        "contacts.0.gap=0:1:3",
    ]
    argv = ["--workers", "0", "--max-events", "many", "--save", "a.npz"]
    for grid in grids:
        argv += ["--vary", grid]

    err = refused("is varied twice", *argv, "--plot", "a.gif")

    named = [line.split(": ")[1] for line in err.splitlines()]
    assert sorted(named) == [
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
    "value", ["0", "-1", "1.5", "many", "\u00b2", "9" * 30, "9" * 5000]
)
@pytest.mark.parametrize("option", ["--workers", "--max-events"])
def test_options_that_are_no_positive_whole_numbers_are_refused(
    case, no_sweep, refused, option, value
):
    """`sweep` refuses a count that is no positive whole number with a message that
    names the option, and starts no sweep.
    """
    message = f"rodimpact: {option}: must be a positive whole number"

    refused(message, "--vary", LENGTHS, option, value)


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
    """A wrong `[solve]` table or option is refused by `sweep` and by `run` with the
    same text, which names its path.
    """
    case.write_text(CASE + f"[solve]\n{solve}\n")

    of_sweep = refused(f"rodimpact: {path}: ", "--vary", LENGTHS, *argv)
    of_run = refuses(["run", "case.toml", *argv], sentence)

    assert of_run == of_sweep


@pytest.fixture
def recorded(case, monkeypatch):
    """Arguments of the last call of the sweep, of a case with options of its own."""
    arguments = {}

    def recording_sweep(system, **options):
        arguments.update(options, shape=system.shape)
        return ri.sweep(system)

    monkeypatch.setattr(command, "sweep", recording_sweep)
    case.write_text(CASE + "[solve]\nmethod = 'fronts'\nmax_events = 7\n")
    return arguments


OPTIONS_OF_CASE = {
    "shape": (5,),
    "method": "fronts",
    "max_events": 7,
    "checkpoint": None,
    "also": [],
    "workers": None,
}


def test_the_options_of_the_case_reach_the_sweep(recorded):
    assert sweep("--vary", LENGTHS) == 0

    assert recorded == OPTIONS_OF_CASE


def test_the_options_of_the_call_reach_the_sweep(recorded):
    options = ["--workers", "2", "--max-events", "8", "--checkpoint", "d"]

    assert sweep("--vary", LENGTHS, *options) == 0

    changed = {"workers": 2, "max_events": 8, "checkpoint": "d"}
    assert recorded == OPTIONS_OF_CASE | changed


def test_a_checkpoint_keeps_the_sweep(case, refused, swept):
    """A sweep with a checkpoint prints the same a second time; another sweep with this
    folder is refused in one line.
    """
    checkpoint = ["--checkpoint", "kept"]

    first = swept("--vary", LENGTHS, *checkpoint)
    second = swept("--vary", LENGTHS, *checkpoint)

    assert second == first
    message = "rodimpact: kept: holds another sweep"
    other = "bodies.0.length=50 mm:1 m:6"
    err = refused(message, "--vary", other, *checkpoint)
    assert err.count("\n") == 1


@pytest.mark.filterwarnings("default::rodimpact.DamagedChunks")
def test_a_damaged_checkpoint_is_announced_in_a_line(case, capsys, swept):
    """A file of a checkpoint loses a byte: the same sweep succeeds with the same
    output, and one line names the file and says what is done.
    """
    before = swept("--vary", LENGTHS, "--checkpoint", "kept")
    (path,) = Path("kept").iterdir()
    path.write_bytes(path.read_bytes()[:-1])
    assert sweep("--vary", LENGTHS, "--checkpoint", "kept") == 0
    out, err = capsys.readouterr()
    assert out == before
    (line,) = err.splitlines()
    assert line.startswith(f"rodimpact: {path}: is not a whole NPZ file")
    assert line.endswith("it is put aside, and its members are run again")


def test_extra_quantities_have_columns(case, refused, swept):
    """`sweep --also` adds columns to CSV and table; displacements are refused without
    --until.
    """
    extra = ["--also", "dissipated", "--also", "largest_stress"]

    table = swept("--vary", LENGTHS, *extra)
    head, *_ = swept("--vary", LENGTHS, *extra, "--csv").splitlines()

    names = head.split(",")
    assert names[-3:] == ["dissipated", "largest_stress.0", "largest_stress.1"]
    assert "largest stress in rod 1" in table
    refused("--until", "--vary", LENGTHS, "--also", "displacement")


YIELDING = """\
schema = 1
bodies = [
    {kind = "mass", mass = 1, velocity = 5},
    {kind = "rod", length = 1, area = 1e-4, material = "steel"},
]
contacts = [{law = "yielding", stiffness = 1e8, yield_force = 1e3, hardening = 1e6}]
"""


def test_tied_numbers_follow_a_variable_which_is_the_axis_of_table_and_figure(
    case, swept
):
    """Two lengths follow a variable L: the CSV has the second length as twice the
    first, and table and figure name L.
    """
    vary = ["--vary", "L=100mm:400mm:4"]
    vary += ["--vary", "bodies.0.length=L", "--vary", "bodies.1.length = 2*L"]

    rows = list(csv.DictReader(io.StringIO(swept(*vary, "--csv"))))
    table = swept(*vary, "--plot", "e.svg", "--quantity", "impulse.0")

    for row in rows:
        length = float(row["bodies.0.length"])
        assert float(row["bodies.1.length"]) == 2 * length
    assert table.splitlines()[1].split() == ["L", "4", "100", "mm", "400", "mm"]
    assert ">L (m)<" in Path("e.svg").read_text(encoding="utf-8")


def test_a_file_after_a_flag_that_prints_is_answered_by_a_redirection(refused):
    message = "does not take 'out.csv'; --csv prints; end the command with > out.csv"
    refused(message, "--vary", LENGTHS, "--csv", "out.csv")


@pytest.mark.exhaustive
def test_a_figure_of_an_extra_quantity(case, swept, refused):
    """`sweep --plot` of the permanent set needs `--also set`; without it, or for a
    contact that is not there, it is refused.
    """
    case.write_text(YIELDING)
    vary = ["--vary", "bodies.0.velocity=1,2", "--until", "0.2 ms"]
    figure = ["--plot", "set.svg", "--quantity"]

    swept(*vary, *figure, "set.0", "--also", "set")

    assert "permanent set" in Path("set.svg").read_text()
    message = "--quantity: 'set.0' is not computed; add --also set"
    refused(message, *vary, *figure, "set.0")
    refused("there is no 'set.1'", *vary, "--also", "set", *figure, "set.1")
