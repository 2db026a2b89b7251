"""Tables a person can read and JSON a program can trust."""

import json
import math

import pytest
from steel import rod

import rodimpact as ri
from rodimpact.storage import report, tables


@pytest.fixture
def unequal_solution():
    """The solution of a striker of 0.4 m on a rod of 1 m, at 1 m/s: e = 0.4."""
    return ri.solve(ri.System([rod(0.4, 1.0), rod(1.0)]))


def cells(text, start):
    """Cells after `start` of the first line that begins with it, without blanks.

    Cells of a table are at least two blanks apart.
    """
    lines = [line for line in text.splitlines() if line.startswith(start)]
    pieces = lines[0].removeprefix(start).split("  ")
    stripped = [piece.strip() for piece in pieces]
    return [piece for piece in stripped if piece]


def outcome_of(solution):
    """The outcome in the JSON of a solution, a dict."""
    return json.loads(report.solution_json(solution))["outcome"]


def test_a_table_has_masses_velocities_contacts_and_energies_with_units(
    unequal_solution,
):
    """The printed outcome of two unequal rods has these cells for bodies, contact, e
    and energy, and ends with the status.
    """
    text = str(unequal_solution.outcome)
    # mass, velocity before and after, vibration energy
    assert cells(text, "rod 1 ") == ["0.314 kg", "1 m/s", "0 m/s", "0 J"]
    assert cells(text, "rod 2 ") == ["0.785 kg", "0 m/s", "0.4 m/s", "94.2 mJ"]
    # impulse, peak force, force duration, number of episodes
    assert cells(text, "1-2") == ["314 mN s", "1.98116 kN", "158.493 us", "1"]
    assert cells(text, "coefficient of restitution e")[0] == "0.4"
    # before and after
    assert cells(text, "moving as a whole") == ["157 mJ", "62.8 mJ"]
    assert text.endswith(unequal_solution.status)


def test_columns_are_aligned_and_no_line_ends_with_blanks(unequal_solution):
    table_of_bodies, *_ = str(unequal_solution.outcome).split("\n\n")
    lengths = {len(line) for line in table_of_bodies.splitlines()}
    assert len(lengths) == 1
    for line in str(unequal_solution).splitlines():
        assert line == line.rstrip()


def test_round_off_prints_as_zero_but_json_keeps_it():
    """The striker of a final collision keeps a velocity and vibration of round-off: the
    printed table has 0, JSON the numbers themselves.
    """
    solution = ri.solve(ri.System([rod(0.45, 1.0), rod(1.0)]))
    outcome = solution.outcome
    velocity = outcome.velocities_after[0]
    vibration = outcome.vibration_after[0]
    assert 0 < abs(velocity) < 1e-14
    assert 0 < vibration < 1e-28

    *_, velocity_text, vibration_text = cells(str(outcome), "rod 1 ")
    in_json, _ = outcome_of(solution)["bodies"]

    assert velocity_text == "0 m/s"
    assert vibration_text == "0 J"
    assert in_json["velocity_after"] == velocity
    assert in_json["vibration_after"] == vibration


def test_small_but_real_numbers_are_not_taken_for_round_off():
    """Velocities of 1e-5 and 4e-10 m/s, after collisions of a short and a slow striker,
    are printed and not shown as 0.
    """
    short_striker = ri.collide(rod(1e-5, 1.0), rod(1.0))
    slow_striker = ri.collide(rod(0.4, 1e-9), rod(1.0))

    *_, velocity_after_short, _ = cells(str(short_striker), "rod 2 ")
    *_, velocity_after_slow, _ = cells(str(slow_striker), "rod 2 ")

    assert velocity_after_short == "1e-05 m/s"
    assert velocity_after_slow == "4e-10 m/s"


def test_differences_show_beside_a_large_common_velocity():
    """Two rods at 10 km/s approach at 1 mm/s: the table shows the change of the second
    by 0.4 mm/s, and its vibration in nJ.
    """
    # Rod 2 gains e = 0.4 of the relative velocity, 1 mm/s.
    collision = ri.collide(rod(0.4, 10_000.001), rod(1.0, 10_000.0))

    _, velocity_before, velocity_after, vibration = cells(str(collision), "rod 2 ")

    assert velocity_before == "10000 m/s"
    assert velocity_after == "10000.0004 m/s"
    assert vibration == "94.2 nJ"  # 94.2 mJ at 1 m/s


def test_undefined_restitution_is_a_dash_with_its_reason():
    """Rods that move apart: the table has "-" for e and the reason, JSON None and the
    reason.
    """
    solution = ri.solve(ri.System([rod(0.4, -1.0), rod(1.0)]))
    outcome = solution.outcome

    text = str(outcome)
    in_json = outcome_of(solution)

    restitution, *_ = cells(text, "coefficient of restitution e")
    *_, reason, _ = text.splitlines()  # the line before the status
    assert restitution == "-"
    assert "nothing collided; the bodies move apart" in reason
    assert in_json["restitution"] is None
    assert in_json["restitution_undefined"] == outcome.why_no_restitution()


def test_a_run_that_is_not_over_says_so_once_and_has_velocities_at_the_end():
    """A run that is cut short prints "velocity at the end" and its status once; t_final
    is None in JSON.
    """
    solution = ri.solve(ri.System([rod(0.4, 1.0), rod(1.0)]), until=1e-4)

    text = str(solution)
    in_json = json.loads(report.solution_json(solution))

    assert "velocity at the end" in text
    assert "velocity after" not in text
    assert text.count(solution.status) == 1
    assert in_json["t_final"] is None


@pytest.fixture
def bonded_solution():
    """The solution of a rod that strikes one bonded to a wall; behind it is a moving
    wall.
    """
    system = ri.System(
        [ri.Wall(), rod(0.4), rod(0.3, -1.0), ri.Wall(-0.5)],
        gaps=[0, 1e-5, 1e-4],
        contacts=[ri.Bonded(), ri.Rigid(), ri.Rigid()],
    )
    return ri.solve(system, until=1e-3)


def test_a_table_has_dashes_for_masses_of_walls_and_episodes_of_bonds(bonded_solution):
    text = str(bonded_solution)
    # mass, velocity before and after, vibration energy
    assert cells(text, "wall ") == ["-", "0 m/s", "0 m/s", "-"]
    *_, episodes = cells(text, "wall-1 joined")
    assert episodes == "-"
    assert "work of moving walls" in text


def test_json_has_no_mass_of_a_wall_and_no_peak_force_of_a_bond(bonded_solution):
    """In JSON, the mass of a wall and the peak force of a bond are None; contacts say
    whether they are bonded, and count episodes.
    """
    in_json = outcome_of(bonded_solution)
    wall, *_ = in_json["bodies"]
    bond, contact, last_contact = in_json["contacts"]
    assert wall["mass"] is None
    assert bond["bonded"]
    assert not contact["bonded"]
    assert not last_contact["bonded"]
    assert bond["peak_force"] is None
    assert contact["episodes"] == bonded_solution.outcome.contacts[1].episodes


def test_solution_table_tells_when_contacts_press_and_open(unequal_solution):
    """The printed solution has a line for the episode of contact 1-2, with its start,
    the end of the force and the opening.
    """
    lines = [
        line for line in str(unequal_solution).splitlines() if line.startswith("1-2")
    ]
    _, episode = lines  # the first line is that of the outcome
    assert cells(episode, "1-2") == ["0 s", "158.493 us", "396.232 us"]


@pytest.fixture(scope="module")
def ball_solution():
    """The solution of a ball that falls on a wall, bounces and comes to rest."""
    law = ri.Rigid(restitution=0.8)
    row = ri.System([ri.Wall(), ri.RigidMass(0.06)], [1.0], [law], gravity=-9.81)
    return ri.solve(row, until=5.0)


def test_a_long_list_of_episodes_is_cut_and_counted(ball_solution):
    """The episodes of a bouncing ball: the first ones, the number left out, and the
    last one are printed.
    """
    (contact,) = ball_solution.contacts
    n_left_out = len(contact.episodes) - report.MAX_LISTED_EPISODES - 1
    lines = str(ball_solution).splitlines()
    listed = [line for line in lines if line.startswith("wall-1")]

    assert f"... and {n_left_out} more; the last ones of contacts are:" in lines
    assert len(listed) == 1 + report.MAX_LISTED_EPISODES + 1  # the line of the outcome


def test_the_last_episode_of_a_ball_tells_when_it_came_to_rest(ball_solution):
    """A ball with e = 0.8 falls from 1 m: its last episode, in the solution and in the
    printed list, starts at the sum of all flights.
    """
    (contact,) = ball_solution.contacts
    fall = math.sqrt(2 * 1.0 / 9.81)  # s, from 1 m
    e = 0.8
    rest = fall * (1 + e) / (1 - e)  # the sum of all flights, each e times the last
    lines = str(ball_solution).splitlines()

    listed = [line for line in lines if line.startswith("wall-1")]

    *_, last_episode = contact.episodes
    assert last_episode.start == pytest.approx(rest, rel=1e-5)
    *_, last_line = listed
    start, *_ = cells(last_line, "wall-1")
    assert start == f"{rest:.6g} s"


def test_single_episodes_of_many_contacts_are_cut_and_counted():
    """20 contacts with an episode each: the printed solution ends their list with "...
    and N more".
    """
    # The pulse passes each of the 20 contacts of equal rods once.
    n_contacts = 20
    striker = rod(0.1, 1.0)
    struck = [rod(0.1)] * n_contacts
    cradle = ri.solve(ri.System([striker, *struck]))
    n_episodes = sum(len(contact.episodes) for contact in cradle.contacts)
    n_left_out = n_contacts - report.MAX_LISTED_EPISODES
    assert n_episodes == n_contacts
    assert f"... and {n_left_out} more" in str(cradle).splitlines()


def test_json_has_system_outcome_and_episodes_without_loss(unequal_solution):
    """The JSON of a solution is strict, and has its system, restitution, finality and
    the opening of its one episode exactly.
    """
    # `parse_constant` is called for numbers that are not finite.
    data = json.loads(
        report.solution_json(unequal_solution), parse_constant=pytest.fail
    )
    outcome = data["outcome"]
    assert data["schema_version"] == 1
    assert data["final"] is True
    assert outcome["final"] is True
    assert outcome["restitution"] == unequal_solution.outcome.restitution
    system = ri.System.from_dict(data["system"])
    assert system == unequal_solution.system
    ((episode_in_json,),) = data["episodes"]  # the only one, of the only contact
    (contact,) = unequal_solution.contacts
    (episode,) = contact.episodes
    assert episode_in_json["opening"] == episode.opening


def test_html_is_escaped_and_micro_is_written_as_a_sign(unequal_solution):
    assert tables.as_html("a < b & c").endswith(">a &lt; b &amp; c</pre>")
    assert ">385 µs  2.5 µJ/m  us</pre>" in tables.as_html("385 us  2.5 uJ/m  us")
    assert '">body' in unequal_solution.outcome._repr_html_()


@pytest.mark.parametrize(
    ("value", "scale", "text"),
    [
        (math.inf, math.inf, "inf J"),
        (2.0, math.inf, "2 J"),
        (1e-20, 1.0, "0 J"),
        (math.nan, math.inf, "-"),
    ],
)
def test_an_energy_is_0_only_beside_a_finite_scale(value, scale, text):
    assert tables.joules(value, scale) == text
