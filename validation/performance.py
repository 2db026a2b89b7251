"""Times of solvers, sweeps and commands, over those of a plain NumPy program.

    python -m validation.performance           tells what is slower than last time
    python -m validation.performance --keep    keeps these ratios for the next time

Each time is given as it is and as a ratio to the time of a yardstick, so that figures
of different machines can be compared. The yardstick is a leapfrog of staggered
velocities and stresses at Courant number 1, with 400 cells per unit length, that solves
the collision of two rods 0.4 : 1. It runs in the same process, just before and just
after the other measurements. A second yardstick is the same collision by Godunov's
method of first order with 100 cells per unit length, compiled. Times are medians of
several runs. Those marked "fresh" are taken in a new process that has not loaded numba.
The memory of a run of a million events is measured as well. All kernels are compiled,
and all modules are bytecode, before anything is measured: as they are from the second
run on.
"""

import json
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.random import default_rng

import rodimpact as ri
from rodimpact.methods import kernels
from rodimpact.methods.fronts import driver
from rodimpact.methods.fronts.batch import RunRequest
from rodimpact.methods.fronts.families import solve_family
from rodimpact.methods.fronts.family_layout import lay_out_family
from rodimpact.methods.grid.mesh import Mesh, stable_step
from rodimpact.methods.grid.method import COURANT
from rodimpact.methods.grid.run import GridRun
from rodimpact.methods.row_builder import build_row
from rodimpact.methods.run import MAX_EVENTS
from rodimpact.methods.states import Stop

from .unit import rod

CASE = Path(__file__).parent / "cases" / "unequal-rods.toml"
LAST_RATIOS = Path(__file__).parent / "performance.json"  # kept ratios
SLOWDOWN = 1.25  # ratio over that of last time from which a figure is called slower
STEEL = ri.materials.steel
AREA = 1e-4  # m^2
EVENTS = 500_000  # events of a run in which the time of one is measured
ENDLESS = 1e6  # end of such a run, which it does not reach, s
MEMORY_LIMIT = 100  # MB
RUNS_IN_PLAIN_PYTHON = 10  # runs of a Hertz pair at most: 1.5 s, where 0.5 s are enough
SHORT = 0.4  # length of the first rod of the yardsticks; that of the second is 1


def median_time(job: Callable[[], Any], runs: int = 7) -> float:
    """Median duration of a job, s.

    The job runs `runs` times.
    """
    durations = []
    for _ in range(runs):
        start = time.perf_counter()
        job()
        durations.append(time.perf_counter() - start)
    return statistics.median(durations)


def usual_environment() -> dict[str, str]:
    """The environment, in which Python keeps bytecode, as it does by default.

    Without bytecode a command is three times slower: it compiles all modules anew.
    """
    environment = dict(os.environ)
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    return environment


def number_printed_by(code: str) -> float:
    """Run a program in a new process, and read the number that it prints.

    CalledProcessError is raised if the program fails.
    """
    command = [sys.executable, "-c", code]
    process = subprocess.run(
        command, capture_output=True, text=True, check=True, env=usual_environment()
    )
    return float(process.stdout)


def time_of_command(*arguments: str) -> float:
    """Duration of the command line from the start of its process to its end, s.

    It is the median of several processes, after one that does not count.
    """
    command = [sys.executable, "-m", "rodimpact", *arguments]
    environment = usual_environment()

    def run() -> None:
        """Run the command once."""
        subprocess.run(command, capture_output=True, check=True, env=environment)

    run()  # writes bytecode
    return median_time(run)


# The yardsticks


def restitution_of(impulse: float, first: float, second: float) -> float:
    """e of rods of these masses, the first of which came at velocity 1."""
    return impulse * (1 / first + 1 / second) - 1


def leapfrog(
    cells_per_unit: int = 400, lengths: tuple[float, float] = (SHORT, 1.0)
) -> float:
    """Restitution of two rods, c = rho = A = 1, by staggered differences.

    Velocities sit on the nodes, stresses in the cells. The contact pushes the two end
    nodes, each of half a cell's mass, so that they do not overlap. At Courant number 1
    a time step is as long as a cell, h.
    """
    h = 1.0 / cells_per_unit
    first_cells = round(lengths[0] * cells_per_unit)
    second_cells = round(lengths[1] * cells_per_unit)
    velocities = [np.ones(first_cells + 1), np.zeros(second_cells + 1)]
    stresses = [np.zeros(first_cells), np.zeros(second_cells)]
    first, second = velocities
    gap = 0.0
    impulse = 0.0
    # One round trip of the longer rod, and a margin.
    for _ in range(round(2.1 * max(lengths) / h)):
        for v, sigma in zip(velocities, stresses, strict=True):
            sigma += v[1:] - v[:-1]
            v[1:-1] += sigma[1:] - sigma[:-1]
            v[0] += 2 * sigma[0]  # the end nodes have half the mass
            v[-1] -= 2 * sigma[-1]
        closing = first[-1] - second[0]
        if gap <= 0 and closing > 0:  # both end nodes get their mean velocity
            first[-1] -= closing / 2
            second[0] += closing / 2
            impulse += closing / 4 * h  # mass h/2 times closing/2
            closing = 0.0  # the nodes move together, and the gap stays
        gap = max(0.0, gap - closing * h)
    return restitution_of(impulse, *lengths)


def godunov(v: Any, sigma: Any, first_cells: int, steps: int) -> float:
    """Impulse between two rods of unit material by Godunov's method of first order.

    Waves go from cell to cell by the exact solution of each jump, at Courant number 1.
    An edge at the ends, or at an open contact, has no stress. The contact opens if it
    would pull, and stays open until its gap has closed. Velocities v and stresses
    sigma are [cell], those of the second rod from `first_cells` on, and are changed in
    place; times are in steps.
    """
    cells = len(v)
    gap = 0.0
    impulse = 0.0
    for _ in range(steps):
        left_v = v[0] + sigma[0]  # velocity at the left edge of the cell
        left_sigma = 0.0
        for i in range(cells):
            # Velocity and stress at the right edge of the cell.
            if i == cells - 1:
                edge_v = v[i] - sigma[i]
                edge_sigma = 0.0
            else:
                edge_v = (v[i] + v[i + 1] + sigma[i + 1] - sigma[i]) / 2
                edge_sigma = (sigma[i] + sigma[i + 1] + v[i + 1] - v[i]) / 2
            next_v = edge_v  # velocity beyond the edge: another one at an open contact
            if i == first_cells - 1:
                is_open = gap > 0
                would_pull = edge_sigma > 0
                if is_open or would_pull:
                    edge_v = v[i] - sigma[i]
                    next_v = v[i + 1] + sigma[i + 1]
                    edge_sigma = 0.0
                    gap = max(0.0, gap + next_v - edge_v)
                impulse -= edge_sigma  # compressive stress is negative
            v[i] = v[i] + edge_sigma - left_sigma
            sigma[i] = sigma[i] + edge_v - left_v
            left_v = next_v
            left_sigma = edge_sigma
    return impulse


def compiled_godunov(cells_per_unit: int = 100) -> Callable[[], float]:
    """A function that computes the restitution of two rods 0.4 : 1 by `godunov`.

    It is compiled and checked against 0.4 before it is returned.
    """
    import numba

    compiled = numba.njit(godunov)
    first_cells = round(SHORT * cells_per_unit)
    cells = (first_cells, cells_per_unit)
    steps = round(2.1 * cells_per_unit)

    def restitution() -> float:
        """e of the two rods, from their state at the start."""
        v = np.repeat([1.0, 0.0], cells)
        sigma = np.zeros(sum(cells))
        impulse = compiled(v, sigma, first_cells, steps)
        return float(restitution_of(impulse, *cells))

    assert abs(restitution() - SHORT) < 1e-12
    return restitution


class Yardsticks(NamedTuple):
    """Times of the two plain programs, s."""

    leapfrog: float
    godunov: float


def time_yardsticks(compiled: Callable[[], float]) -> Yardsticks:
    """Measure both yardsticks once."""
    leapfrog_time = median_time(leapfrog)
    godunov_time = median_time(compiled, runs=101)
    return Yardsticks(leapfrog_time, godunov_time)


# Kernels


def time_of_event(T: Sequence[float], Z: Sequence[float], v: Sequence[float]) -> float:
    """Time of one event of a row of uniform rods that touch, s.

    It is the median of runs of half a million events. T, Z and v are the transit times,
    impedances and initial velocities of the rods.
    """
    rods = []
    for i in range(len(T)):
        rods.append(rod(T[i], Z[i], v[i]))
    row = build_row(ri.System(rods))
    layout = lay_out_family(row)
    request = RunRequest(until=ENDLESS, max_events=EVENTS)
    with kernels.forced(True):
        progress = driver.solve_one(layout, request).progress
        assert progress.stop_reason == Stop.CAP
        seconds = median_time(lambda: driver.solve_one(layout, request), runs=5)
        return seconds / progress.events


def event_of_free_pair() -> float:
    """Two free rods without a common tick that meet once and go on vibrating."""
    return time_of_event([math.sqrt(2), 3.0], [1.0, 2.0], [0.5, -0.5])


def event_of_row(n: int) -> float:
    """Time of an event of n random rods, all of which touch at first, s.

    The rows are the same in each call, see `time_of_event`.
    """
    rng = default_rng(0)
    T = rng.integers(1, 30, n)
    Z = rng.uniform(0.5, 2.0, n)
    v = rng.uniform(-1.0, 1.0, n)
    return time_of_event(T.tolist(), Z.tolist(), v.tolist())


def collision_of_family(pairs: int = 20_000) -> float:
    """Time of one collision of a long list of random pairs, s, without its table.

    It is the median time of the whole family divided by the number of pairs.
    """
    rng = default_rng(0)
    rods = []
    for velocity in (0.5, -0.5):
        T = rng.uniform(0.1, 1.0, pairs)
        logarithms = rng.uniform(0.0, math.log(3.0), pairs)
        Z = np.exp(logarithms)
        rods.append(rod(T, Z, velocity))
    row = build_row(ri.System(rods))
    with kernels.forced(True):
        return median_time(lambda: solve_family(row, None, MAX_EVENTS)) / pairs


# The package as its users meet it

PAIR = """
import sys
import numpy as np
from numpy.random import Generator, default_rng
import rodimpact as ri
from validation.performance import median_time
left = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
"""
COLLIDE = (
    PAIR
    + """
print(median_time(lambda: ri.collide(left, right), 500))
assert "numba" not in sys.modules
"""
)
FIELD = (
    PAIR
    + """
import numba
solution = ri.solve(ri.System([left, right]))
x = np.linspace(0, 1, 1000)[:, None]
t = np.linspace(0, solution.t_end, 1000)
solution.velocity(1, x, t)
print(median_time(lambda: solution.velocity(1, x, t), 21))
"""
)
WARM = "import rodimpact as ri; ri.warm()"
MEMORY = """
import resource, sys
import rodimpact as ri
def peak():
    size = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return size if sys.platform == "darwin" else size * 1024
def solve(events):
    rods = [ri.Rod(length, area=1e-4, material=ri.materials.steel, velocity=v)
            for length, v in ((0.5 ** 0.5, 1.0), (1.0, 0.0), (0.2 ** 0.5, -1.0))]
    row = ri.System([ri.Wall(), *rods, ri.Wall()], gaps=[1e-4] * 4)
    solution = ri.solve(row, max_events=events)
    assert solution.events >= events
    return solution
solve(100_000)
before = peak()
solve(1_000_000)
print(peak() - before)
"""


def processor_time_of_warm() -> float:
    """Processor time of a new process that compiles everything, s.

    The cache of compiled code is empty at first, and the time includes that of the
    system.
    """
    command = [sys.executable, "-c", WARM]
    with tempfile.TemporaryDirectory() as folder:
        environment = usual_environment()
        environment["NUMBA_CACHE_DIR"] = folder
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(command, capture_output=True, check=True, env=environment)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    user = after.ru_utime - before.ru_utime
    system = after.ru_stime - before.ru_stime
    return user + system


def map_of_pairs() -> float:
    """Time of a map over lengths and impedances, s; prints its largest error of e.

    The map has 1000 x 1000 pairs; the time is a median.
    """
    lengths = np.linspace(0.05, 1.0, 1000)[:, None]
    impedances = np.geomspace(0.1, 10.0, 1000)
    first = rod(lengths, velocity=1.0)
    second = rod(1.0, impedances)
    system = ri.System([first, second])
    exact = ri.theory.saint_venant(
        first.segments[0].impedance,
        first.transit_time,
        second.segments[0].impedance,
        second.transit_time,
        closing_speed=1.0,
    )
    result = ri.sweep(system)
    error = np.abs(result.restitution - exact.restitution).max()
    print(f"largest error of e in a map of a million pairs: {error:.1e}")
    return median_time(lambda: ri.sweep(system), runs=5)


def hertz_pair() -> float:
    """Time of a pair of rods with rounded ends by `solve`, in machine code, s.

    It is a median. Earlier solutions, which run in plain Python, do not count.
    """
    first = ri.Rod(SHORT, area=AREA, material=STEEL, velocity=1.0)
    second = ri.Rod(1.0, area=AREA, material=STEEL)
    contact = ri.Hertz(1e10)
    system = ri.System([first, second], contacts=[contact])
    for _ in range(RUNS_IN_PLAIN_PYTHON):
        ri.solve(system)
    return median_time(lambda: ri.solve(system).outcome)


def row_between_walls(contact: ri.Rigid | ri.Hertz) -> float:
    """Time of five rods between walls, over 100 transits of the longest, s.

    The method of characteristics solves it. All contacts have the given law.
    """
    unit = 0.02
    bodies: list[Any] = [ri.Wall()]
    for n in (8, 10, 12, 14, 16):
        impedance = 1 + 0.1 * n
        velocity = 8 / n - 0.7
        bodies.append(rod(unit * n, impedance, velocity))
    bodies.append(ri.Wall())
    system = ri.System(bodies, gaps=[0.05] * 6, contacts=[contact] * 6)
    until = 100 * unit * 16

    def solve() -> ri.Solution:
        """Solve the row once."""
        return ri.solve(system, until, "characteristics")

    episodes = [tally.episodes for tally in solve().outcome.contacts]
    assert sum(episodes) > 20  # the rods meet often
    return median_time(solve, runs=3)


def cell_on_grid(material: ri.Material, theory: str | None = None) -> float:
    """Time of a cell and step of two rods with 800 cells on a grid, in cache, s.

    `theory` is that of lateral inertia. The time is the median of runs of 20 000 steps;
    compilation does not count.
    """
    cells = 400
    steps = 20_000
    rods = []
    for velocity in (1.0, 0.0):
        bar = ri.Rod(
            1.0,
            diameter=0.012,
            material=material,
            velocity=velocity,
            lateral_inertia=theory,
        )
        rods.append(bar)
    row = build_row(ri.System(rods))
    mesh = Mesh(row, [cells, cells])
    step = COURANT * stable_step(rods[0].segments[0], cells)
    expected_steps = 9 * steps  # at least those of all runs below
    run = GridRun(mesh, step, snapshots=4, expected_steps=expected_steps)
    run.advance(steps)  # compiles
    seconds = median_time(lambda: run.advance(run.steps + steps))
    assert len(run.force_intervals(0)) == 1  # the rods have met once
    return seconds / steps / (2 * cells)


def measure() -> dict[str, float]:
    """Measure all times except those of the yardsticks; s, by name."""
    times = {}
    times["collide() of two rods, interpreted, fresh"] = number_printed_by(COLLIDE)
    times["a compiled collision of two rods, proof included"] = collision_of_family()
    times["an event of a long free pair"] = event_of_free_pair()
    times["an event of a row of 30 rods"] = event_of_row(30)
    times["an event of a row of 1000 rods"] = event_of_row(1000)
    name = "a map of 1000 x 1000 lengths and impedances, two threads"
    times[name] = map_of_pairs()
    times["solve() of a Hertz pair"] = hertz_pair()
    times["warm(), empty cache, processor time"] = processor_time_of_warm()
    name = "five rods between walls, 100 transits"
    times[f"{name}, rigid contacts"] = row_between_walls(ri.Rigid())
    times[f"{name}, Hertz"] = row_between_walls(ri.Hertz(10.0))
    damped = STEEL.damped(1e-3, 1e4)
    name = "a cell and step on a grid"
    times["a cell and step of two rods and their contact"] = cell_on_grid(STEEL)
    times[f"{name}, damped"] = cell_on_grid(damped)
    times[f"{name}, mindlin-herrmann"] = cell_on_grid(STEEL, "mindlin-herrmann")
    times["velocity on 1000 x 1000 points, compiled"] = number_printed_by(FIELD)
    times["rodimpact --version"] = time_of_command("--version")
    times[f"rodimpact run {CASE.name}"] = time_of_command("run", str(CASE))
    return times


def time_text(seconds: float) -> str:
    """A duration with a fitting unit.

    The unit is s, ms, us or ns; the number has three digits.
    """
    for unit, scale in (("s", 1.0), ("ms", 1e3), ("us", 1e6)):
        if seconds * scale >= 1:
            return f"{seconds * scale:.3g} {unit}"
    return f"{seconds * 1e9:.3g} ns"


def last_ratios() -> dict[str, float]:
    """Ratios to the leapfrog that were kept last time."""
    if not LAST_RATIOS.exists():
        return {}
    return json.loads(LAST_RATIOS.read_text())


def print_table(times: dict[str, float], yardsticks: Yardsticks) -> dict[str, float]:
    """Print a line for each time; return the ratios to the leapfrog, three digits.

    A line also has the ratio kept before, the ratio to Godunov's method, and "slower"
    if the ratio has grown by more than `SLOWDOWN`.
    """
    last = last_ratios()
    ratios = {}
    print(
        f"{'figure':56} {'median':>8} {'leapfrogs':>10} {'before':>10} {'Godunovs':>10}"
    )
    for name, seconds in times.items():
        ratio = float(f"{seconds / yardsticks.leapfrog:.3g}")
        ratios[name] = ratio
        before = last.get(name, math.nan)
        godunovs = seconds / yardsticks.godunov
        remark = ""
        if ratio > SLOWDOWN * before:
            remark = "  slower"
        print(
            f"{name:56} {time_text(seconds):>8} {ratio:10.3g} {before:10.3g} "
            f"{godunovs:10.2g}{remark}"
        )
    return ratios


def main() -> None:
    """Measure everything, print the table, and keep the ratios if that is asked for.

    The yardsticks are measured before and after all others, and the means are taken.
    The peak of memory is printed, too. --keep keeps the ratios.
    """
    # What is not compiled yet would go in plain Python, or take the memory of a
    # compiler.
    subprocess.run([sys.executable, "-c", WARM], check=True, env=usual_environment())
    # A process inherits the peak of the one that starts it, so memory comes first.
    memory = number_printed_by(MEMORY) / 1e6
    compiled = compiled_godunov()
    before = time_yardsticks(compiled)
    times = measure()
    after = time_yardsticks(compiled)
    leapfrog_mean = (before.leapfrog + after.leapfrog) / 2
    godunov_mean = (before.godunov + after.godunov) / 2
    yardsticks = Yardsticks(leapfrog_mean, godunov_mean)
    leapfrog_time = time_text(yardsticks.leapfrog)
    godunov_time = time_text(yardsticks.godunov)
    print(f"NumPy leapfrog, 400 cells per unit length: {leapfrog_time}")
    print(f"compiled Godunov, 100 cells per unit length: {godunov_time}")
    ratios = print_table(times, yardsticks)
    print(
        f"\nmemory of a run of a million events: {memory:.0f} MB of {MEMORY_LIMIT} MB"
    )
    if sys.argv[1:] == ["--keep"]:
        LAST_RATIOS.write_text(json.dumps(ratios, indent=1) + "\n")


if __name__ == "__main__":
    main()
