"""Ticks and fronts at the level of the kernels, on lists and compiled."""

import ast
import math
import os
import re
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from runs import assembled

import rodimpact as ri
from rodimpact.methods import kernels, tick_rule_kernel
from rodimpact.methods.fronts import front_kernel, layout_kernel
from rodimpact.methods.fronts.tracking import track
from rodimpact.methods.tick_rule_kernel import assign_ticks, recognise
from rodimpact.results import field_kernel


def ticks_of(durations, bits=49):
    n = len(durations)
    ticks = [0] * n
    whole = assign_ticks(durations, bits, [0] * n, [0] * n, [0] * n, ticks)
    return ticks, whole


@pytest.mark.parametrize("ratio", ["1/1", "1/3", "2/7", "1048575/1048576", "1/1048576", "355/1130"])
def test_ratios_are_recognised(ratio):
    x = Fraction(ratio)
    assert Fraction(*recognise(float(x))) == x
    assert Fraction(*recognise(math.nextafter(float(x), 0))) == x


@pytest.mark.parametrize("x", [math.sqrt(0.5), math.pi / 4, 1 / 3 + 1e-13, 1e-9])
def test_other_numbers_are_not(x):
    assert recognise(x) == (0, 0)


def test_lengths_in_decimal_fractions_keep_their_ratio():
    (a, b, c), whole = ticks_of([0.3, 0.1, 1 / 3])
    assert 10 * a == 9 * c
    assert a == 3 * b
    assert abs(math.log2(whole) - 49) < 1e-3


def test_two_materials_make_two_classes():
    s, t = math.sqrt(3.0), math.sqrt(5.0)
    ticks, whole = ticks_of([0.3 * s, 0.1 * s, 0.25 * t, 0.5 * t, s])
    assert ticks[0] == 3 * ticks[1]
    assert ticks[3] == 2 * ticks[2]
    assert ticks[3] == pytest.approx(0.5 * t * whole / s, abs=1)


def test_ticks_do_not_depend_on_order():
    rng = np.random.default_rng(3)
    durations = [*rng.uniform(0.1, 1, 5), *(rng.integers(1, 9, 6) / 7)]
    reference = dict(zip(durations, ticks_of(durations)[0], strict=True))
    for _ in range(5):
        shuffled = list(rng.permutation(durations))
        assert dict(zip(shuffled, ticks_of(shuffled)[0], strict=True)) == reference


def test_rounding_is_at_most_half_a_tick_where_ratios_are_unknown():
    rng = np.random.default_rng(5)
    durations = [*rng.uniform(0.01, 1, 20), *rng.uniform(1e-5, 1e-3, 20)]
    ticks, whole = ticks_of(durations)
    scale = Fraction(whole) / Fraction(max(durations))
    for duration, tick in zip(durations, ticks, strict=True):
        assert abs(tick - Fraction(duration) * scale) <= Fraction(1, 2) + Fraction(1, 8)


def test_three_rods_whose_waves_meet_exactly():
    steel, aluminium = ri.materials.steel, ri.materials.aluminium
    row = [(0.1, steel), (0.25, steel), (1 / 3, steel), (0.3, aluminium), (0.1, aluminium)]
    a = assembled(ri.System([ri.Rod(L, area=1e-4, material=m) for L, m in row]))
    ticks = a.ticks[1:-1]
    assert ticks[1] * 4 == ticks[2] * 3
    assert ticks[0] * 5 == ticks[1] * 2
    assert ticks[3] == 3 * ticks[4]
    assert a.transit_error < 1e-14


def plain_state(T, Z, v, convert, status=None):
    """Uniform rods in a row, touching, on lists of any kind of number."""
    from rodimpact.methods.fronts.assembly import start

    n = len(T)
    one, zero = convert(1), convert(0)
    waves = [[], []] + [[(-T[s // 2], convert(v[s // 2]))] for s in range(2 * n)]
    inner = [front_kernel.FREE, *[front_kernel.TOUCH] * (n - 1), front_kernel.FREE]
    return start(
        [0, *T, 0], [zero, *(one / convert(z) for z in Z), zero], status or inner,
        [zero] * (n + 1), (zero, zero), waves, 5000,
    )


@pytest.mark.parametrize(("T", "Z", "e"), [
    ((1, 2), (1, 1), "1/2"), ((2, 7), (1, 1), "2/7"), ((3, 3), (1, 5), "1"),
    ((1, 2), (1, 2), "2/3"), ((1, 2), (2, 1), "7/9"), ((1, 5), (3, 1), "11/20"),
])
def test_fractions_give_exact_restitution(T, Z, e):
    row, tally, log, clock = plain_state(T, Z, (1, 0), Fraction)
    flag = front_kernel.play(row, tally, log, clock, -2 * max(T), 10**6, Fraction(0), 1)
    assert flag == front_kernel.FINAL
    masses = [Fraction(z * t) for z, t in zip(Z, T, strict=True)]
    assert tally.impulse[1] * (1 / masses[0] + 1 / masses[1]) - 1 == Fraction(e)


def test_a_full_log_is_grown_and_the_run_goes_on():
    state = plain_state((3, 10), (5, 1), (1.0, 0.0), float)
    small = front_kernel.Log(*(x[:8] for x in state[2][:4]), *(x[:1] for x in state[2][4:]))
    flags = []
    row, tally, log, clock = state[0], state[1], small, state[3]
    while not flags or flags[-1] == front_kernel.FULL:
        flags.append(front_kernel.play(row, tally, log, clock, -20, 10**6, 1e-12, 1))
        log = front_kernel.Log(*(x + [0 * x[0]] * 3 for x in log))
    assert len(flags) > 3
    assert flags[-1] == front_kernel.FINAL
    other = plain_state((3, 10), (5, 1), (1.0, 0.0), float)
    front_kernel.play(*other, -20, 10**6, 1e-12, 1)
    assert tally == other[1]
    assert row == other[0]


def chain(n):
    m = ri.Material("m", youngs_modulus=1.0, density=1.0)
    rods = [ri.Rod(1.0 + i % 3, area=1.0 + i % 2, material=m, velocity=1.0 if i == 0 else 0.0)
            for i in range(n)]
    return ri.System(rods)


@pytest.mark.parametrize("events", [1, 7, 100])
def test_the_cap_ends_in_a_status(events):
    run = track(assembled(chain(6)), None, events)
    assert run.stopped_by == "max_events"
    assert events <= run.events <= events + 7  # the events of one tick are taken together


def test_a_row_of_many_rods_uses_the_same_rule():
    m = ri.Material("m", youngs_modulus=1.0, density=1.0)
    lengths = [float(x) for x in np.random.default_rng(1).uniform(0.5, 1.0, 300)]
    lengths[17], lengths[200] = 0.3, 0.1
    a = assembled(ri.System([ri.Rod(x, area=1.0, material=m) for x in lengths]))
    b = assembled(ri.System([ri.Rod(x, area=1.0, material=m) for x in lengths[:18]]))
    assert a.transit_error < 1e-12
    assert len(b.ticks) == 20


@pytest.mark.parametrize("module", [tick_rule_kernel, layout_kernel, front_kernel, field_kernel])
def test_kernel_files_stand_alone(module):
    """They run where there is nothing but Python, and the tick rule."""
    tree = ast.parse(Path(module.__file__).read_text())
    imported = {
        name.name if isinstance(node, ast.Import) else node.module
        for node in ast.walk(tree)
        if isinstance(node, ast.Import | ast.ImportFrom)
        for name in node.names
    }
    allowed = {"__future__", "math", "typing"}
    assert imported <= allowed | ({"tick_rule_kernel"} if module is layout_kernel else set())


@pytest.mark.skipif(not kernels.enabled(), reason="compiling is disabled")
class TestCompiled:
    def test_tick_rule_is_the_same(self):
        rng = np.random.default_rng(11)
        fast = kernels.compiled(assign_ticks)
        for _ in range(50):
            durations = np.concatenate((rng.uniform(0.1, 1, 4), rng.integers(1, 9, 4) / 7))
            work = [np.zeros(8, dtype=np.int64) for _ in range(4)]
            whole = fast(durations, 49, *work)
            assert (work[3].tolist(), whole) == ticks_of(durations.tolist())


def test_disabled_compiling_returns_the_kernel_itself(monkeypatch):
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    kernels._compiled.cache_clear()
    try:
        assert kernels.compiled(recognise) is recognise
    finally:
        kernels._compiled.cache_clear()


@pytest.mark.skipif(not kernels.enabled(), reason="compiling is disabled")
def test_a_variable_with_which_numba_does_not_start_is_named():
    """A long job goes on in plain Python."""
    code = "import rodimpact as ri; print(ri.warm())"
    done = subprocess.run(
        [sys.executable, "-c", code], env={**os.environ, "NUMBA_NUM_THREADS": "0"},
        capture_output=True, text=True, check=True,
    )
    assert done.stdout == "0.0\n"
    assert "NoCompiler: nothing can be compiled: numba does not start: " in done.stderr
    assert re.search("Mend or unset .*NUMBA_NUM_THREADS = '0'", done.stderr)


# What is worth compiling --------------------------------------------------------------------------


@pytest.fixture
def fresh(monkeypatch):
    """As if the process began, with a numba that is there and a cache that is empty."""
    monkeypatch.delenv("NUMBA_DISABLE_JIT", raising=False)
    monkeypatch.setattr(kernels, "_spent", {})
    monkeypatch.setattr(kernels, "_ready", set())
    monkeypatch.setattr(kernels, "_told", [])
    monkeypatch.setattr(kernels, "_fault", lambda: "")
    monkeypatch.setattr(kernels, "_on_disk", lambda kernel: False)
    return monkeypatch


def spent_before_compiling(job, *kernel, **ahead):
    """Seconds of plain Python until jobs of one length run compiled."""
    count = 0
    while not kernels.worth_compiling(job, *kernel, **ahead):
        count += 1
        assert count < 10_000
    return count * job


def test_plain_python_goes_on_until_it_has_taken_as_long_as_compiling(fresh):
    play, lay_out = front_kernel.play, layout_kernel.lay_out
    cold = spent_before_compiling(0.1, play)
    assert kernels.STARTING < cold < 60
    assert spent_before_compiling(0.1, play) == 0  # its machine code is there
    assert spent_before_compiling(0.1, lay_out) > 0.5
    fresh.setattr(kernels, "_ready", set())
    fresh.setattr(kernels, "_spent", {})
    fresh.setattr(kernels, "_on_disk", lambda kernel: True)
    warm = spent_before_compiling(0.1, play)
    assert kernels.STARTING - 0.1 < warm < cold / 2
    assert kernels.worth_compiling(0.1, lay_out)  # numba has started


def test_what_is_ahead_counts_as_soon_as_it_is_known(fresh):
    assert not kernels.worth_compiling(0.01, recognise, ahead=0.3)
    assert kernels.worth_compiling(0.01, recognise, ahead=60.0)


def test_a_job_shorter_than_a_compiled_call_stays_plain_and_never_looks_for_numba(fresh):
    fresh.setattr(kernels, "_fault", None)
    for _ in range(10_000):
        assert not kernels.worth_compiling(kernels.CALLING / 2, recognise)
    assert not kernels.worth_compiling(kernels.STARTING / 2, recognise)


@pytest.mark.parametrize(("terminal", "long"), [(False, False), (True, False), (False, True)])
def test_one_line_says_how_long_compiling_takes_in_a_file_if_it_is_long(
    fresh, capsys, terminal, long
):
    fresh.setattr(sys.stderr, "isatty", lambda: terminal, raising=False)
    fresh.setattr(kernels, "COMPILING", 1e-3 if long else 1e-5)
    assert kernels.worth_compiling(60.0, front_kernel.play)
    assert kernels.worth_compiling(60.0, layout_kernel.lay_out)
    told = capsys.readouterr().err
    assert told.count("compiling once, about") == told.count("\n") == int(terminal or long)


def test_without_numba_a_long_job_is_plain_and_the_user_is_told_once(fresh):
    fresh.setattr(kernels, "_fault", lambda: "numba is not installed")
    kernels._tell_of_no_compiler.cache_clear()
    assert not kernels.worth_compiling(0.5, front_kernel.play)
    with pytest.warns(ri.NoCompiler, match="numba is not installed; long runs go in plain Python"):
        assert not kernels.worth_compiling(60.0, front_kernel.play)
    assert not kernels.worth_compiling(60.0, front_kernel.play)
    with kernels.forced(True):
        assert not kernels.worth_compiling(60.0, front_kernel.play)
    with pytest.warns(ri.NoCompiler, match="nothing can be compiled: numba is not installed"):
        assert ri.warm() == 0.0


@pytest.mark.exhaustive
def test_everything_that_may_run_compiled_is_warmed(monkeypatch):
    """Kernels that `worth_compiling` is asked about anywhere are among those that `warm` meets."""
    package = Path(ri.__file__).parent
    asked = {
        argument.id
        for path in package.rglob("*.py") for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)
        and node.func.attr == "worth_compiling"
        for argument in node.args[1:] if isinstance(argument, ast.Name)
    }
    met = set()
    monkeypatch.setattr(kernels, "worth_compiling", lambda seconds, *kernel, ahead=0.0: bool(
        met.update(k.__name__ for k in kernel)))
    monkeypatch.setattr(kernels, "why_not", lambda: "")
    ri.warm()
    assert "run" in asked
    asked = asked - {"kernel"} | {"family", "family_with_reading"}  # one of these two
    assert asked <= met


FORKS = """
import os, sys, threading, time
import numpy as np
from rodimpact.methods import kernels, tick_rule_kernel
from rodimpact.results.field_kernel import sum_on_grid

ticks, values = np.array([0]), np.array([1.0])

def work():
    with kernels.forced(True):
        kernels.worth_compiling(0.0, sum_on_grid)
        kernels.compiled(sum_on_grid)(np.empty((1, 1)), ticks, ticks, values, ticks, ticks, values,
                                      ticks, 1.0, 0.0)

thread = threading.Thread(target=work)
thread.start()
for wait in (0.0, 0.1, 0.3, 1.0):  # while numba starts, and while it compiles
    time.sleep(wait)
    child = os.fork()
    if child == 0:
        work()
        os._exit(0)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
thread.join()
"""


LOGS = """
import os, threading, time
from rodimpact.methods import kernels
import logging

inside = threading.Event()

def start_numba():
    with kernels._ONE_AT_A_TIME:
        inside.set()
        time.sleep(0.5)
        logging.getLogger("numba")

threading.Thread(target=start_numba).start()
inside.wait()
child = os.fork()
if child == 0:
    os._exit(0)
os.waitpid(child, 0)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
@pytest.mark.parametrize("script", [FORKS, LOGS], ids=["compiling", "logging"])
def test_a_child_forked_while_a_thread_compiles_ends(script, tmp_path):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-W", "ignore", "-c", script]
    done = subprocess.run(command, env=environment, timeout=240, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
