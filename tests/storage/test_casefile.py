"""Files that are no cases are told as such; the worked cases say what comes out."""

import os
import re
from pathlib import Path

import numpy as np
import pytest
from case_texts import A_ROD, HEAD, ROD
from scipy.integrate import solve_ivp

import rodimpact as ri
from rodimpact.storage.casefile import Case, case_from, parse_case, read_case, write_case

CASES = Path(__file__).parents[2] / "validation" / "cases"


def test_byte_order_mark_and_line_ends_of_windows(tmp_path):
    path = tmp_path / "case.toml"
    path.write_bytes(b"\xef\xbb\xbf" + (HEAD + A_ROD).replace("\n", "\r\n").encode())
    assert read_case(path) == Case(ri.System([ROD]), path=str(path))
    assert read_case(str(path)).path == str(path)


# What is no TOML


def file_problem(path):
    with pytest.raises(ri.InvalidModel) as caught:
        read_case(path)
    [(where, message)] = caught.value.problems
    assert where == str(path)
    assert caught.value.__cause__ is None
    assert "\n" not in message
    return message


def test_files_that_cannot_be_read(tmp_path):
    assert "cannot be read: No such file" in file_problem(tmp_path / "none.toml")
    assert "cannot be read: Is a directory" in file_problem(tmp_path)
    assert "cannot be read: Not a directory" in file_problem(f"{__file__}/x.toml")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_what_may_never_end_is_not_read(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    assert "it is not a regular file; save the case in one" in file_problem(tmp_path / "pipe")
    assert "it is not a regular file" in file_problem("/dev/zero")


def test_a_file_too_large_for_a_case_is_not_read(tmp_path):
    path = tmp_path / "sparse.toml"
    with path.open("wb") as file:
        file.truncate(10**12)
    message = "cannot be read: it has 1000000000000 bytes, more than 10000000; is it a case file?"
    assert file_problem(path) == message


def test_a_name_with_a_null_byte_is_told_in_one_line():
    assert "null byte" in file_problem("a\0b")
    with pytest.raises(ri.InvalidModel, match=r"^a\\x00b: cannot be read"):
        read_case("a\0b")


@pytest.mark.parametrize("given", [None, 1, [], {1: 2}, b"case.toml", object()])
def test_what_is_no_case_at_all_is_refused(given):
    for refuse, name, kind in [
        (read_case, "path", "the name of a file"), (parse_case, "case", "the text of a case file"),
        (write_case, "case", "a Case or a System"),
        (lambda it: write_case(Case(it)), "case", "a Case or a System"),
    ]:
        with pytest.raises(ri.InvalidModel, match=f"^{name}: must be {kind}, got "):
            refuse(given)
    if not isinstance(given, dict):
        with pytest.raises(ri.InvalidModel, match="case: must be the tables of a case file, got "):
            case_from(given)
    if given is not None:
        with pytest.raises(ri.InvalidModel, match="vary: must name numbers by their paths"):
            parse_case(HEAD + A_ROD, vary=given)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"schema = 1\nlength 3\n", r"not valid TOML: .*line 2"),
        (b"schema = 1\n\nschema = 1\n", r"not valid TOML: .*line 3"),
        (b"[solve]\n[solve]\n", r"not valid TOML: .*line 2"),
        (b"a = " + b"9" * 5000, r"not valid TOML: .* value has 5000 digits$"),
        (b"a = " + b"[" * 50_000, "not valid TOML"),
        (b"schema = 1\n# L\xe4nge\n", r"not text in UTF-8 \(at line 2\)"),
        (b"PK\x03\x04\x00\xff", "not text in UTF-8|not valid TOML"),
    ],
)
def test_files_that_are_no_toml(tmp_path, content, said):
    path = tmp_path / "case.toml"
    path.write_bytes(content)
    assert re.search(said, file_problem(path))


# The worked cases say what comes out


def solved(name):
    case = read_case(CASES / f"{name}.toml")
    return ri.solve(case.system, **case.solve)


@pytest.mark.parametrize("path", sorted(CASES.glob("*.toml")), ids=lambda p: p.stem)
def test_every_worked_case_is_read_and_written(path):
    case = read_case(path)
    assert parse_case(write_case(case), str(path)) == case
    assert path.read_text().startswith("# ")


def test_unequal_rods():
    solution = solved("unequal-rods")
    assert solution.outcome.restitution == pytest.approx(0.4, rel=1e-12)
    [episode] = solution.contacts[0].episodes
    assert episode.force_end == pytest.approx(0.1585e-3, rel=1e-3)
    assert episode.opening == pytest.approx(0.3962e-3, rel=1e-3)


def test_rod_on_wall():
    solution = solved("rod-on-wall")
    [episode] = solution.contacts[0].episodes
    assert episode.start == pytest.approx(0.5e-3)
    assert episode.opening - episode.start == pytest.approx(0.38545e-3, rel=1e-5)
    assert solution.contacts[0].peak_force == pytest.approx(1270.8, rel=1e-4)
    assert solution.outcome.restitution == pytest.approx(1.0, abs=1e-12)


def test_hopkinson_bar():
    solution = solved("hopkinson-bar")
    assert solution.contacts[0].duration == pytest.approx(51.06e-6, rel=2e-4)
    pulse = solution.gauge(body=1, x=0.635).strain
    assert pulse.min() == pytest.approx(-1.0e-3, rel=1e-2)
    assert solution.mean_velocity(body=0, t=solution.t_end) == pytest.approx(0.0, abs=1e-12)
    assert 45e-6 < solution.contacts[1].duration < solution.contacts[0].duration


def test_hopkinson_specimen():
    system = read_case(CASES / "hopkinson-specimen.toml").system
    solution = ri.solve(system, until=4e-4)
    bar, k = solution.system.bodies[1], solution.system.contacts[1].stiffness
    Z, force = bar.segments[0].impedance, bar.segments[0].impedance * 10 / 2
    pulse = solution.contacts[0]
    assert (pulse.peak_force, pulse.duration) == pytest.approx((7737, 51.06e-6), rel=2e-4)
    assert pulse.peak_force == pytest.approx(force, rel=1e-12)
    t = np.linspace(1e-6, 50e-6, 50)
    held_back = force * np.exp(-2 * k * t / Z)
    arrival, c = bar.transit_time, bar.segments[0].wave_speed
    transmitted, reflected = (
        sign * Z * c * solution.gauge(body, x).strain_at(arrival + t + 0.2 / c)
        for sign, body, x in ((-1, 2, 0.2), (1, 1, bar.length - 0.2)))
    assert transmitted == pytest.approx(force - held_back, abs=1e-3 * force)
    assert reflected == pytest.approx(held_back, abs=1e-3 * force)
    assert solution.contacts[1].peak_force == pytest.approx(0.733 * force, rel=1e-3)


def test_rounded_rod_on_wall():
    """Against the delay equation of the end: d' = a - F/Z, a(t) = a(t - 2T) - 2 F(t - 2T)/Z."""
    solution = solved("rounded-rod-on-wall")
    rod, k = solution.system.bodies[0], solution.system.contacts[0].stiffness
    Z, T = rod.segments[0].impedance, rod.transit_time

    def force(d):
        return k * max(d, 0.0) ** 1.5

    def first(t, y):
        return [1.0 - force(y[0]) / Z, force(y[0])]

    def second(t, y):
        arriving = 1.0 - 2 * force(early.sol(t - 2 * T)[0]) / Z
        return [arriving - force(y[0]) / Z, force(y[0])]

    def parted(t, y):
        return y[0]

    parted.terminal, parted.direction = True, -1
    exact = {"rtol": 1e-11, "atol": 1e-16, "method": "DOP853"}
    early = solve_ivp(first, (0, 2 * T), [0.0, 0.0], dense_output=True, **exact)
    late = solve_ivp(second, (2 * T, 4 * T), early.y[:, -1], events=parted, **exact)
    [[end]], [[(_, impulse)]] = late.t_events, late.y_events
    assert solution.contacts[0].impulse == pytest.approx(impulse, rel=1e-5)
    assert solution.contacts[0].duration == pytest.approx(end, abs=2e-3 * end)
    assert solution.outcome.restitution == pytest.approx(impulse / rod.mass - 1, abs=1e-5)
    assert solution.outcome.restitution == pytest.approx(0.9949, abs=5e-5)
    assert end == pytest.approx(0.1916e-3, rel=1e-3)


def test_newtons_cradle():
    solution = solved("newtons-cradle")
    assert solution.final
    assert solution.outcome.velocities_after == pytest.approx([0, 0, 0, 0, 1], abs=1e-13)
    assert solution.outcome.vibration_after == pytest.approx([0] * 5, abs=1e-13)
    assert solution.contacts[0].duration == pytest.approx(39.6e-6, rel=1e-3)
    assert solution.contacts[3].episodes[0].opening == pytest.approx(99.1e-6, rel=1e-3)


def test_stepped_rods():
    solution = solved("stepped-rods")
    assert solution.outcome.restitution == pytest.approx(0.9434, abs=5e-5)
    assert solution.contacts[0].duration == pytest.approx(158.5e-6, rel=1e-3)
    assert abs(solution.outcome.energy_residual) < 1e-14


def test_between_walls():
    solution = solved("between-walls")
    assert solution.stopped_by == "until"
    between = [e.opening + 1e-6 for c in solution.contacts for e in c.episodes]
    speeds = sorted(abs(float(solution.mean_velocity(body=1, t=t))) for t in between)
    assert speeds == pytest.approx([5, 5, 7, 7, 9])


def test_clamped_bar():
    solution = solved("clamped-bar")
    assert solution.contacts[0].episodes == ((1.0, 2.0, 2.0), (4.0, 5.0, 5.0))
    assert solution.velocity(1, 0.3, 2.9) == solution.velocity(1, 0.3, 5.9)


def test_lossy_rods():
    solution = solved("lossy-rods")
    assert solution.outcome.restitution == pytest.approx(0.4, abs=1e-4)
    found = solution.ring_down()
    lost = solution.energy(found.times[0])  # of 157 mJ, which the rods have to begin with
    assert found.times[0] == solution.t_final
    assert found.vibration[0] == pytest.approx(62.1e-3, rel=1e-2)
    assert found.vibration[0] + found.rigid + lost.damped + lost.numerical == pytest.approx(
        lost.total + lost.damped + lost.numerical, rel=1e-12)
    assert lost.total + lost.damped + lost.numerical == pytest.approx(157e-3, rel=1e-9)
    assert found.vibration[-1] < 1e-6 * found.rigid
    assert found.rigid == pytest.approx(62.8e-3, rel=1e-4)
    assert found.frequency == pytest.approx(2524, rel=1e-3)
    assert found.modal_decay_time == pytest.approx(1.249e-3, rel=1e-3)
    assert found.decay_time == pytest.approx(found.modal_decay_time, rel=1e-2)
    assert found.momentum_change < 1e-13
    assert "falls to 1/e in" in str(found)


def test_horn():
    case = read_case(CASES / "horn.toml")
    solution = ri.solve(case.system, 1.2e-4, "finite-difference", cells=300)
    arrival = solution.system.bodies[1].transit_time
    struck = solution.velocity(1, 0.0, 3e-6)
    free = solution.velocity(1, 0.5, arrival + 4e-6)
    assert struck == pytest.approx(0.5, rel=2e-2)
    assert free == pytest.approx(4 * struck, rel=6e-2)


def test_a_long_case_is_announced(monkeypatch):
    monkeypatch.setattr("rodimpact.methods.duration.LONG", 0.0)
    with (pytest.warns(ri.LongRun, match=r"MB of TOML\); a shorter file takes less"),
          pytest.raises(ri.InvalidModel)):
        ri.parse_case("a = 1")
