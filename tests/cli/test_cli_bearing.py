"""rodimpact bearing: table, CSV, JSON, figure, and wrong calls."""

import csv
import io
import json

import pytest

import rodimpact as ri
from rodimpact.cli import bearing as command
from rodimpact.cli import main
from rodimpact.units import format_si

PILE = """\
schema = 1
bodies = [
    {kind = "mass", mass = 4500, velocity = 3.5},
    {kind = "rod", length = 15, area = 0.0094, material = "steel", shaft = \
{resistance = "300 kN", quake = "2.5 mm", damping = 0.16}},
    {kind = "wall"},
]
contacts = [
    {law = "cushion", loading = "500 MN/m", restitution = 0.8},
    {law = "smith-toe", resistance = "300 kN", quake = "2.5 mm", damping = 0.5},
]
"""
SHORT = ("--cells", "8", "--until", "30 ms", "--workers", "1")
GRID = ("--resistance", "300kN:500kN:2")


@pytest.fixture
def pile(case):
    """The case of a pile."""
    case.write_text(PILE)
    return case


def bearing(*argv):
    """Arguments of `rodimpact bearing` for that case."""
    return ["bearing", "case.toml", *argv]


@pytest.mark.usefixtures("pile")
def test_table_csv_json_and_figure_agree(output_of, tmp_path):
    """`bearing` draws a figure, and its table, CSV and JSON give the same blow counts
    for both resistances.
    """
    status = main(bearing(*GRID, *SHORT, "--plot", "graph.png"))
    assert (tmp_path / "graph.png").stat().st_size > 10_000

    table = output_of(*bearing(*GRID, *SHORT), status=status)
    lines = output_of(*bearing(*GRID, *SHORT, "--csv"), status=status)
    document = json.loads(output_of(*bearing(*GRID, *SHORT, "--json"), status=status))

    rows = list(csv.DictReader(io.StringIO(lines)))
    points = document["points"]
    assert document["shaft_share"] == 0.5
    assert [point["resistance"] for point in points] == [300e3, 500e3]
    # Notes follow the rows of the table.
    _, *lines_of_table = table.splitlines()
    for row, point, line in zip(rows, points, lines_of_table, strict=False):
        assert float(row["blow_count"]) == point["blow_count"]
        assert f"{point['blow_count']:.4g} 1/m" in line


@pytest.mark.usefixtures("pile")
def test_a_large_stated_error_names_a_remedy(output_of):
    table = output_of(*bearing("--resistance", "500kN", "--cells", "8"))

    assert "compression 2.2 %, tension 98 %. For tension take more cells" in table
    assert "give --cells, such as 200 or 400; the default is 100" in table


def test_resistances_are_required_and_the_usage_says_so(refuses, output_of):
    refuses(bearing(), "the following arguments are required: --resistance")

    text = output_of("bearing", "--help")
    assert "[--resistance" not in text  # brackets are for what may be left out
    assert "200kN:1000kN:5" in text
    assert "default until it is over" in text


@pytest.mark.usefixtures("pile")
def test_a_run_of_a_pile_prints_set_and_largest_stresses(output_of):
    """`run` of a pile prints the permanent set and the largest compression, with
    position and time, of the same solution in Python, and no tension.
    """
    text = output_of("run", "case.toml", "--until", "30 ms", "--cells", "20")

    run = ri.solve(ri.read_case("case.toml").system, 0.03, cells=20)
    compression = run.extreme_stress(1).compression
    permanent_set = format_si(run.contacts[1].permanent_set(), "m")
    stress = format_si(-compression.stress, "Pa")
    x = format_si(compression.x, "m")
    t = format_si(compression.t, "s")
    rows = [" ".join(line.split()) for line in text.splitlines()]
    assert f"permanent set, contact 2-wall {permanent_set}" in rows
    assert f"largest compression in rod 2 {stress} at {x} after {t}" in rows
    assert "largest tension in rod 2 none" in rows


@pytest.mark.usefixtures("pile")
def test_a_blow_that_is_cut_short_ends_with_3_and_says_so(output_of):
    """`bearing --until 2 ms`: status 3, and the text names the resistance and the
    remedy.
    """
    text = output_of(
        *bearing("--resistance", "300kN", "--cells", "8", "--until", "2 ms"), status=3
    )

    assert "At 300 kN: Not over after 2 ms" in text
    assert "raise --until, or" in text


@pytest.mark.usefixtures("pile")
@pytest.mark.parametrize(
    ("argv", "message"),
    [
        (("--resistance", "1:2"), "--resistance: must be start:stop:count"),
        (("--resistance", "3 mm"), "--resistance: "),
        ((*GRID, "--plot", "graph.txt"), "--plot: must end in one of"),
        ((*GRID, "--plot", "case.png"), "--plot: "),
    ],
)
def test_a_call_that_cannot_be_read_is_refused_before_the_graph_is_asked_for(
    argv, message, refuses, monkeypatch, tmp_path
):
    """`rodimpact bearing` refuses wrong resistances, a figure of unknown kind and a
    figure that exists, each by its option, before `bearing_graph` is called.
    """
    (tmp_path / "case.png").write_text("")
    monkeypatch.setattr(
        command, "bearing_graph", lambda *_, **__: pytest.fail("solved")
    )

    refuses(bearing(*argv), message)


@pytest.mark.usefixtures("pile")
@pytest.mark.parametrize(
    ("argv", "message"),
    [
        (("--resistance", "-3kN"), "--resistance: must be a finite positive"),
        ((*GRID, "--shaft-share", "1"), "--shaft-share: must be below 1"),
        (("--resistance", "200"), "--resistance: 200 N is too small: the 27.6 kJ"),
        ((*GRID, "--cells", "2"), "--cells: must be a whole number from 4"),
    ],
)
def test_a_wrong_number_is_refused_by_its_option(argv, message, refuses):
    refuses(bearing(*argv), message)


@pytest.mark.usefixtures("case")
def test_a_case_that_is_no_pile_is_refused(refuses):
    refuses(bearing(*GRID), "bodies: must end with a wall")
