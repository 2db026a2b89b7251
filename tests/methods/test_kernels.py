"""Ticks and fronts at the level of the kernels, on lists and compiled."""

import ast
import math
import os
import re
import subprocess
import sys
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import pytest
from numpy.random import default_rng
from runs import bits_of, tracked
from systems import horizon, random_system

import rodimpact as ri
from rodimpact.methods import kernels
from rodimpact.methods.fronts import batch, members
from rodimpact.methods.pieces import march as pieces
from rodimpact.methods.record_lists import blank
from rodimpact.methods.tick_rule import DURATION, assign_ticks, recognise
from rodimpact.running import warming


def ticks_of(durations):
    """Ticks of each duration, and the unrounded number of ticks of the longest one."""
    spans = blank(len(durations), DURATION)
    for span, duration in zip(spans, durations, strict=True):
        span.time = duration
    ticks_of_longest = assign_ticks(spans, 49)  # up to 49 bits
    ticks = [span.ticks for span in spans]
    return ticks, ticks_of_longest


@pytest.mark.parametrize(
    "ratio", ["1/1", "1/3", "2/7", "1048575/1048576", "1/1048576", "355/1130"]
)
def test_ratios_of_small_numbers_are_recognised_also_beside_round_off(ratio):
    """`recognise` gives numerator and denominator of the ratio, also for the next float
    below.
    """
    x = Fraction(ratio)
    p, q = recognise(float(x))
    assert Fraction(p, q) == x
    next_below = math.nextafter(float(x), 0)
    p, q = recognise(next_below)
    assert Fraction(p, q) == x


@pytest.mark.parametrize("x", [math.sqrt(0.5), math.pi / 4, 1 / 3 + 1e-13, 1e-9])
def test_numbers_that_are_no_such_ratio_are_not_recognised(x):
    assert recognise(x) == (0, 0)


def test_ticks_do_not_depend_on_the_order_of_durations():
    """Six of eleven random durations are whole sevenths, whose ratios are recognised."""
    rng = default_rng(3)
    any_durations = rng.uniform(0.1, 1, 5)
    sevenths = rng.integers(1, 9, 6) / 7
    durations = [*any_durations, *sevenths]

    def ticks_by_duration(ordered):
        ticks, _ = ticks_of(ordered)
        return dict(zip(ordered, ticks, strict=True))

    expected = ticks_by_duration(durations)
    for _ in range(5):
        shuffled = list(rng.permutation(durations))
        assert ticks_by_duration(shuffled) == expected


def test_rounding_is_about_half_a_tick_at_most_where_ratios_are_unknown():
    """The ticks of forty random durations differ from the exact ones, in fractions, by
    5/8 at most.
    """
    rng = default_rng(5)
    long_durations = rng.uniform(0.01, 1, 20)
    short_durations = rng.uniform(1e-5, 1e-3, 20)
    durations = [*long_durations, *short_durations]
    ticks, ticks_of_longest = ticks_of(durations)
    ticks_per_second = Fraction(ticks_of_longest) / Fraction(max(durations))
    largest_error = Fraction(1, 2) + Fraction(1, 8)  # as ticks are computed in floats
    for duration, tick in zip(durations, ticks, strict=True):
        exact = Fraction(duration) * ticks_per_second
        assert abs(tick - exact) <= largest_error


def test_transit_times_of_one_material_are_in_the_ratio_of_their_lengths():
    """Ticks of rods of steel, 0.1, 0.25 and 1/3 m long, and of aluminium, 0.3 and 0.1 m
    long.
    """
    steel = ri.materials.steel
    aluminium = ri.materials.aluminium
    row = [
        (0.1, steel),
        (0.25, steel),
        (1 / 3, steel),
        (0.3, aluminium),
        (0.1, aluminium),
    ]
    rods = [ri.Rod(length, area=1e-4, material=stuff) for length, stuff in row]

    system = ri.System(rods)
    clock = tracked(system).clock

    ticks = clock.ticks[1:-1]  # of each rod; nothing lies beyond the ends
    assert ticks[0] * 5 == ticks[1] * 2  # 0.1 to 0.25
    assert ticks[1] * 4 == ticks[2] * 3  # 0.25 to 1/3
    assert ticks[3] == 3 * ticks[4]
    assert clock.transit_error < 1e-14


@pytest.mark.parametrize(
    "compiling",
    [
        False,
        pytest.param(
            True,
            marks=pytest.mark.skipif(
                not kernels.enabled(), reason="compiling is disabled"
            ),
        ),
    ],
)
def test_a_log_that_is_full_grows_and_the_run_goes_on(monkeypatch, compiling):
    """A run whose log has room for one row leaves the same bits as with room for all."""
    system = random_system(3)
    until = horizon(system, transits=8)
    expected = bits_of(system, until, compiling)
    monkeypatch.setattr(batch, "INITIAL_LOG_ROWS", 1)

    bits = bits_of(system, until, compiling)

    assert bits == expected


@pytest.mark.exhaustive
@pytest.mark.skipif(not kernels.enabled(), reason="compiling is disabled")
def test_a_variable_with_which_numba_does_not_start_is_named():
    """With NUMBA_NUM_THREADS = 0 `warm` compiles nothing and raises no error; a warning
    names the variable.
    """
    code = "import rodimpact as ri; print(ri.warm())"
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "NUMBA_NUM_THREADS": "0"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == "0.0\n"
    assert "NoCompiler: nothing can be compiled: numba does not start: " in done.stderr
    assert re.search("Mend or unset .*NUMBA_NUM_THREADS = '0'", done.stderr)


# What is worth compiling
# --------------------------------------------------------------------------------------


@pytest.fixture
def fresh(monkeypatch):
    """A `monkeypatch`, as if the process began with a numba and with an empty cache."""
    monkeypatch.delenv("NUMBA_DISABLE_JIT", raising=False)
    monkeypatch.setattr(kernels, "_spent", {})
    monkeypatch.setattr(kernels, "_ready", set())
    kernels._tell.cache_clear()
    monkeypatch.setattr(kernels, "_fault", lambda: "")
    kept_on_disk(monkeypatch, set())
    return monkeypatch


def kept_on_disk(monkeypatch, kernels_on_disk):
    """Let machine code of these kernels be on disk, and of no others."""

    def compiled(kernel):
        return SimpleNamespace(files=lambda: kernel in kernels_on_disk)

    monkeypatch.setattr(kernels, "compiled", compiled)


JOB = 0.125  # s, that a job would take in plain Python


def spent_before_compiling(kernel):
    """Seconds of jobs in plain Python until the next job is worth compiling the kernel."""
    count = 0
    while not kernels.worth_compiling(JOB, kernel):
        count += 1
        assert count < 10_000
    return count * JOB


FRONTS = members.run_members
PIECES = pieces.run_nodes


def test_plain_python_goes_on_until_it_has_taken_as_long_as_machine_code(fresh):
    assert spent_before_compiling(FRONTS) == kernels.COMPILING
    assert spent_before_compiling(FRONTS) == 0  # its machine code is there
    assert spent_before_compiling(PIECES) == kernels.COMPILING  # that of another is not


def test_machine_code_on_disk_costs_the_start_of_numba_and_its_loading(fresh):
    kept_on_disk(fresh, {FRONTS, PIECES})
    price = kernels.STARTING + kernels.LOADING
    assert price - JOB < spent_before_compiling(FRONTS) <= price
    assert spent_before_compiling(PIECES) == 0  # numba has started


def test_after_warming_every_run_of_the_process_is_compiled(fresh):
    """Kernels that `warm` has met are worth compiling at once; kernels met in a forced
    compilation only are not.
    """
    with kernels.forced(compiling=True):
        assert kernels.worth_compiling(0.0, PIECES)
    assert not kernels.worth_compiling(0.0, PIECES)

    def warm_one(name):
        with kernels.forced(compiling=True):
            kernels.worth_compiling(0.0, FRONTS)

    fresh.setattr(warming, "warm_method", warm_one)
    ri.warm()

    assert kernels.worth_compiling(0.0, FRONTS)
    assert not kernels.worth_compiling(0.0, PIECES)


def test_short_jobs_never_look_for_numba(fresh):
    """100 jobs, each of 1/100 of the start of numba, are not worth compiling, and do
    not look for machine code.
    """
    for name in ("_fault", "compiled"):
        fresh.setattr(kernels, name, None)  # a call would fail
    for _ in range(100):
        assert not kernels.worth_compiling(kernels.STARTING / 100, recognise)


@pytest.mark.parametrize("watched", [False, True])
def test_one_line_tells_who_watches_that_compiling_takes_long(fresh, capsys, watched):
    """On a terminal, and only there, one line announces compiling, also for two
    kernels.
    """
    fresh.setattr(sys.stderr, "isatty", lambda: watched, raising=False)
    assert kernels.worth_compiling(60.0, FRONTS)
    assert kernels.worth_compiling(60.0, PIECES)  # a second kernel tells nothing more
    output = capsys.readouterr().err
    assert output.count("compiling once, ") == int(watched)
    assert output.count("\n") == int(watched)


def test_where_compiling_is_disabled_nothing_is(fresh):
    """With NUMBA_DISABLE_JIT, no job is worth compiling, even if forced, and `warm`
    warns and returns 0.
    """
    fresh.setenv("NUMBA_DISABLE_JIT", "1")
    assert not kernels.worth_compiling(60.0, FRONTS)
    with kernels.forced(compiling=True):
        assert not kernels.worth_compiling(60.0, FRONTS)
    with pytest.warns(ri.NoCompiler, match="disabled by NUMBA_DISABLE_JIT"):
        assert ri.warm() == 0.0


def test_without_numba_a_long_job_is_plain_and_the_user_is_told_once(fresh):
    """A short job tells nothing, a long one warns once, and `warm` warns that nothing
    can be compiled.
    """
    fresh.setattr(kernels, "_fault", lambda: "numba is not installed")
    assert not kernels.worth_compiling(0.5, FRONTS)
    with pytest.warns(
        ri.NoCompiler, match="numba is not installed; long runs go in plain Python"
    ):
        assert not kernels.worth_compiling(60.0, FRONTS)
    assert not kernels.worth_compiling(60.0, FRONTS)
    with kernels.forced(compiling=True):
        assert not kernels.worth_compiling(60.0, FRONTS)
    with pytest.warns(
        ri.NoCompiler, match="nothing can be compiled: numba is not installed"
    ):
        assert ri.warm() == 0.0


def calls_in_package():
    """Yield each call in the modules of the package, as a node of its syntax tree, and
    the name of the module.
    """
    root = Path(ri.__file__).parents[1]
    for path in root.glob("rodimpact/**/*.py"):
        name = ".".join(path.relative_to(root).with_suffix("").parts)
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Call):
                yield node, name


def asked_about():
    """Kernels that `worth_compiling` is asked about anywhere.

    A batch asks about the kernel that its class hands to `Batch`.
    """
    kernels_asked_about = set()
    for call, module in calls_in_package():
        function = ast.unparse(call.func)
        is_of_batch = function == "super().__init__" and module.endswith(".batch")
        kernel = None
        if function == "kernels.worth_compiling":
            kernel = ast.unparse(call.args[1])
        elif is_of_batch or function == "Batch[State]":
            kernel = ast.unparse(call.args[0])
        if kernel is not None and kernel != "self.kernel":
            names = vars(import_module(module))
            kernels_asked_about.add(eval(kernel, names))
    return kernels_asked_about


@pytest.mark.exhaustive
def test_everything_that_may_run_compiled_is_warmed(monkeypatch):
    """`warm` meets every kernel that `worth_compiling` is asked about anywhere."""
    met = set()

    def never_worth_compiling(seconds, kernel, ahead=0.0):
        met.add(kernel)
        return False

    monkeypatch.setattr(kernels, "worth_compiling", never_worth_compiling)
    monkeypatch.setattr(kernels, "why_not", lambda: "")
    ri.warm()
    assert {FRONTS, PIECES} <= asked_about() <= met


FORKS = """
import os, sys, threading, time
from rodimpact.methods import kernels
from rodimpact.methods.tick_rule import recognise

def work():
    with kernels.forced(compiling=True):
        kernels.worth_compiling(0.0, recognise)
        kernels.compiled(recognise)(0.5)

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
    with kernels.ONE_AT_A_TIME:
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


@pytest.mark.exhaustive
@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
@pytest.mark.parametrize(
    "script",
    [
        pytest.param(
            FORKS,
            id="compiling",
            marks=[
                pytest.mark.exhaustive,
                pytest.mark.skipif(
                    not kernels.enabled(), reason="compiling is disabled"
                ),
            ],
        ),
        pytest.param(LOGS, id="logging"),
    ],
)
def test_a_child_forked_while_a_thread_compiles_ends(script, tmp_path):
    """A script that forks while a thread compiles ends within 240 s with status 0."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-W", "ignore", "-c", script]
    done = subprocess.run(
        command, env=environment, timeout=240, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
