"""Tables a person can read and JSON a program can trust."""

import json
import math

import pytest
from steel import rod

import rodimpact as ri
from rodimpact.storage import report, tables


@pytest.fixture
def unequal():
    return ri.solve(ri.System([rod(0.4, 1.0), rod(1.0)]))


def cells(text, start):
    """Cells of the first line that begins with `start`, after its name."""
    line = next(line for line in text.splitlines() if line.startswith(start))
    return [cell for cell in line[len(start) :].split("  ") if cell.strip()]


def outcome_of(solution):
    return json.loads(report.solution_json(solution))["outcome"]


def test_table_says_who_does_what_with_units(unequal):
    text = str(unequal.outcome)
    assert [c.strip() for c in cells(text, "rod 1 ")] == [
        "0.314 kg",
        "1 m/s",
        "0 m/s",
        "0 J",
    ]
    assert [c.strip() for c in cells(text, "rod 2 ")] == [
        "0.785 kg",
        "0 m/s",
        "0.4 m/s",
        "94.2 mJ",
    ]
    assert [c.strip() for c in cells(text, "1-2")] == [
        "314 mN s",
        "1.98116 kN",
        "158.493 us",
        "1",
    ]
    assert cells(text, "coefficient of restitution e")[0].strip() == "0.4"
    assert [c.strip() for c in cells(text, "moving as a whole")] == [
        "157 mJ",
        "62.8 mJ",
    ]
    assert text.endswith(unequal.status)


def test_columns_are_aligned(unequal):
    body = str(unequal.outcome).split("\n\n")[0].splitlines()
    assert len({len(line) for line in body}) == 1
    assert all(line == line.rstrip() for line in str(unequal).splitlines())


def test_round_off_prints_as_zero_but_json_keeps_it():
    solution = ri.solve(ri.System([rod(0.45, 1.0), rod(1.0)]))
    outcome = solution.outcome
    left, residue = outcome.velocities_after[0], outcome.vibration_after[0]
    assert 0 < abs(left) < 1e-14
    assert 0 < residue < 1e-28
    assert [c.strip() for c in cells(str(outcome), "rod 1 ")][-2:] == ["0 m/s", "0 J"]
    body = outcome_of(solution)["bodies"][0]
    assert body["velocity_after"] == left
    assert body["vibration_after"] == residue


def test_small_but_real_numbers_are_not_taken_for_round_off():
    outcome = ri.collide(rod(1e-5, 1.0), rod(1.0))
    assert cells(str(outcome), "rod 2 ")[-2].strip() == "1e-05 m/s"
    slow = ri.collide(rod(0.4, 1e-9), rod(1.0))
    assert [c.strip() for c in cells(str(slow), "rod 2 ")][-2] == "4e-10 m/s"


def test_differences_show_beside_a_large_common_velocity():
    text = str(ri.collide(rod(0.4, 10_000.001), rod(1.0, 10_000.0)))
    assert [c.strip() for c in cells(text, "rod 2 ")] == [
        "0.785 kg",
        "10000 m/s",
        "10000.0004 m/s",
        "94.2 nJ",
    ]


def test_undefined_restitution_is_a_dash_with_its_reason():
    solution = ri.solve(ri.System([rod(0.4, -1.0), rod(1.0)]))
    outcome = solution.outcome
    text = str(outcome)
    assert cells(text, "coefficient of restitution e")[0].strip() == "-"
    assert "nothing collided; the bodies move apart" in text.splitlines()[-2]
    data = outcome_of(solution)
    assert data["restitution"] is None
    assert data["restitution_undefined"] == outcome.why_no_restitution()


def test_a_run_that_is_not_over_says_so_once_and_calls_its_numbers_by_name():
    solution = ri.solve(ri.System([rod(0.4, 1.0), rod(1.0)]), until=1e-4)
    text = str(solution)
    assert "velocity at the end" in text
    assert "velocity after" not in text
    assert text.count(solution.status) == 1
    assert json.loads(report.solution_json(solution))["t_final"] is None


def test_walls_have_no_mass_and_bonds_no_episodes():
    system = ri.System(
        [ri.Wall(), rod(0.4), rod(0.3, -1.0), ri.Wall(-0.5)],
        gaps=[0, 1e-5, 1e-4],
        contacts=[ri.Bonded(), ri.Rigid(), ri.Rigid()],
    )
    solution = ri.solve(system, until=1e-3)
    text = str(solution)
    assert [c.strip() for c in cells(text, "wall ")] == ["-", "0 m/s", "0 m/s", "-"]
    episodes = cells(text, "wall-1 joined")[-1]
    assert episodes.strip() == "-"
    assert "work of moving walls" in text
    data = outcome_of(solution)
    assert data["bodies"][0]["mass"] is None
    assert [c["bonded"] for c in data["contacts"]] == [True, False, False]
    assert data["contacts"][0]["peak_force"] is None
    assert data["contacts"][1]["episodes"] == solution.outcome.contacts[1].episodes


def test_solution_table_tells_when_contacts_press_and_open(unequal):
    rows = [
        line.split() for line in str(unequal).splitlines() if line.startswith("1-2")
    ]
    assert rows[1] == ["1-2", "0", "s", "158.493", "us", "396.232", "us"]


def test_a_long_list_of_episodes_is_cut_and_counted():
    cradle = ri.solve(ri.System([rod(0.1, 1.0), *[rod(0.1)] * 20]))
    assert sum(len(contact.episodes) for contact in cradle.contacts) == 20
    assert f"... and {20 - report.MAX_LISTED_EPISODES} more" in str(cradle)


def test_json_is_complete_and_exact(unequal):
    data = json.loads(report.solution_json(unequal), parse_constant=pytest.fail)
    assert data["schema_version"] == 1
    assert data["outcome"]["restitution"] == unequal.outcome.restitution
    assert data["episodes"][0][0]["opening"] == unequal.contacts[0].episodes[0].opening
    assert ri.System.from_dict(data["system"]) == unequal.system
    assert data["outcome"]["final"] is data["final"] is True


def test_html_is_escaped(unequal):
    assert tables.as_html("a < b & c").endswith(">a &lt; b &amp; c</pre>")
    assert ">385 µs  2.5 µJ/m  us</pre>" in tables.as_html("385 us  2.5 uJ/m  us")
    assert '">body' in unequal.outcome._repr_html_()


@pytest.mark.parametrize(
    ("value", "scale", "text"),
    [
        (math.inf, math.inf, "inf J"),
        (2.0, math.inf, "2 J"),
        (1e-20, 1.0, "0 J"),
        (math.nan, math.inf, "-"),
    ],
)
def test_an_energy_that_overflows_is_not_0(value, scale, text):
    assert tables.joules(value, scale) == text
