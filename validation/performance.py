"""Speed and memory, each figure also as a ratio to a plain NumPy program for the same collision.

    python -m validation.performance           tells what is slower than in the last version
    python -m validation.performance --keep    keeps these ratios as those of the last version

The yardstick is a leapfrog of staggered velocities and stresses at Courant number 1, with 400 cells
per unit length, that solves the collision of two rods 0.4 : 1; it runs in the same process, just
before and just after the other measurements. A second one is the same collision by Godunov's method
of first order with 100 cells per unit length, compiled. Figures are medians of several runs. Those
marked "fresh" are taken in a new process that has not loaded numba.
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
from typing import Any

import numpy as np

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
STEEL = ri.materials.steel
RUN, LONG = 500_000, 1e6  # events, s
LAST = (
    Path(__file__).parent / "performance.json"
)  # ratios of the last version to the leapfrog
SLOWER = 1.25  # times the last ratio is told of


def median(job: Callable[[], Any], runs: int = 7) -> float:
    """Median duration of a job, s."""
    spans = []
    for _ in range(runs):
        begin = time.perf_counter()
        job()
        spans.append(time.perf_counter() - begin)
    return statistics.median(spans)


def fresh(code: str) -> float:
    """What a new process prints."""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    return float(done.stdout)


def processor_time() -> float:
    """Processor time of a new process that compiles everything, s."""
    with tempfile.TemporaryDirectory() as folder:
        place = {**os.environ, "NUMBA_CACHE_DIR": folder}
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [sys.executable, "-c", WARM], capture_output=True, check=True, env=place
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def command(*arguments: str) -> float:
    """Duration of the command line from the start of its process to its end, s."""
    whole = [sys.executable, "-m", "rodimpact", *arguments]
    return median(lambda: subprocess.run(whole, capture_output=True, check=True))


# The yardstick ----------------------------------------------------------------------------------


def leapfrog(
    cells_per_unit: int = 400, lengths: tuple[float, float] = (0.4, 1.0)
) -> float:
    """Restitution of two rods, c = rho = A = 1, by staggered differences.

    Velocities sit on the nodes, stresses in the cells; the contact pushes the two end nodes, each
    of half a cell's mass, so that they do not overlap.
    """
    h = 1.0 / cells_per_unit
    cells = [round(L * cells_per_unit) for L in lengths]
    v = [np.ones(cells[0] + 1), np.zeros(cells[1] + 1)]
    sigma = [np.zeros(x.size - 1) for x in v]
    gap = impulse = 0.0
    for _ in range(round(2.1 * max(lengths) / h)):
        for u, s in zip(v, sigma, strict=True):
            s += u[1:] - u[:-1]
            u[1:-1] += s[1:] - s[:-1]
            u[0] += 2 * s[0]
            u[-1] -= 2 * s[-1]
        closing = v[0][-1] - v[1][0]
        if gap <= 0 and closing > 0:
            v[0][-1] -= closing / 2
            v[1][0] += closing / 2
            impulse += closing / 4 * h
            closing = 0.0
        gap = max(0.0, gap - closing * h)
    return impulse * (1 / lengths[0] + 1 / lengths[1]) - 1


def godunov(v: Any, sigma: Any, first: int, steps: int) -> float:
    """Impulse between two rods of unit material; cells from `first` on are those of the second.

    Waves go from cell to cell by the exact solution of each jump, at Courant number 1; an edge at
    the ends, or at an open contact, has no stress. v, sigma : [cell], times are in steps.
    """
    n, gap, impulse = len(v), 0.0, 0.0
    for _ in range(steps):
        left_v, left_sigma = v[0] + sigma[0], 0.0  # at the left edge of the cell
        for i in range(n):
            if i == n - 1:
                edge_v, edge_sigma = v[i] - sigma[i], 0.0
            else:
                edge_v = (v[i] + v[i + 1] + sigma[i + 1] - sigma[i]) / 2
                edge_sigma = (sigma[i] + sigma[i + 1] + v[i + 1] - v[i]) / 2
            next_v = edge_v
            if i == first - 1:
                if gap > 0 or edge_sigma > 0:
                    edge_v, next_v = v[i] - sigma[i], v[i + 1] + sigma[i + 1]
                    edge_sigma = 0.0
                    gap = max(0.0, gap + next_v - edge_v)
                impulse -= edge_sigma
            v[i], sigma[i] = v[i] + edge_sigma - left_sigma, sigma[i] + edge_v - left_v
            left_v, left_sigma = next_v, edge_sigma
    return impulse


def compiled_godunov(per_unit: int = 100) -> Callable[[], float]:
    """The restitution of two rods 0.4 : 1 by `godunov`, to be called."""
    import numba

    fast, cells = numba.njit(godunov), (round(0.4 * per_unit), per_unit)

    def restitution() -> float:
        v, sigma = np.repeat([1.0, 0.0], cells), np.zeros(sum(cells))
        impulse = fast(v, sigma, cells[0], round(2.1 * per_unit))
        return float(impulse * (1 / cells[0] + 1 / cells[1]) - 1)

    assert abs(restitution() - 0.4) < 1e-12
    return restitution


# Kernels ----------------------------------------------------------------------------------------


def per_event(T: Sequence[float], Z: Sequence[float], v: Sequence[float]) -> float:
    """Median time of an event in a run of half a million of uniform rods that touch, s."""
    layout = lay_out_family(
        build_row(ri.System([rod(*of) for of in zip(T, Z, v, strict=True)]))
    )
    request = RunRequest(until=LONG, max_events=RUN)
    with kernels.forced(True):
        run = driver.solve_one(layout, request).progress
        assert run.stop_reason == Stop.CAP
        return median(lambda: driver.solve_one(layout, request), 5) / run.events


def free_pair() -> float:
    """Two free rods of incommensurate transit times that meet once and go on vibrating."""
    return per_event([math.sqrt(2), 3.0], [1.0, 2.0], [0.5, -0.5])


def long_row(n: int) -> float:
    """Rods of random lengths, impedances and velocities, all touching at first."""
    rng = np.random.default_rng(0)
    T = rng.integers(1, 30, n).tolist()
    return per_event(
        T, rng.uniform(0.5, 2.0, n).tolist(), rng.uniform(-1.0, 1.0, n).tolist()
    )


def family_of_pairs(pairs: int = 20_000) -> float:
    """Time of one collision of a long list of random pairs, s, without the table made of them."""
    rng = np.random.default_rng(0)
    rods = [
        rod(
            rng.uniform(0.1, 1.0, pairs),
            np.exp(rng.uniform(0.0, math.log(3.0), pairs)),
            v,
        )
        for v in (0.5, -0.5)
    ]
    row = build_row(ri.System(rods))
    with kernels.forced(True):
        return median(lambda: solve_family(row, None, MAX_EVENTS)) / pairs


# The package as its users meet it ---------------------------------------------------------------

PAIR = """
import sys
import numpy as np
import rodimpact as ri
from validation.performance import median
left = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
"""
COLLIDE = (
    PAIR
    + """
print(median(lambda: ri.collide(left, right), 500))
assert "numba" not in sys.modules
"""
)
FIELD = (
    PAIR
    + """
solution = ri.solve(ri.System([left, right]))
x, t = np.linspace(0, 1, 1000)[:, None], np.linspace(0, solution.t_end, 1000)
solution.velocity(1, x, t)
print(median(lambda: solution.velocity(1, x, t), 21))
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


def map_of_pairs() -> tuple[float, float]:
    """Time of a map over lengths and impedances, s, and its largest error of e."""
    system = ri.System(
        [
            rod(np.linspace(0.05, 1.0, 1000)[:, None], velocity=1.0),
            rod(1.0, np.geomspace(0.1, 10.0, 1000)),
        ]
    )
    result = ri.sweep(system)
    first, second = (body.segments[0] for body in system.bodies)
    exact = ri.theory.saint_venant(
        first.impedance, first.transit_time, second.impedance, second.transit_time, 1.0
    ).restitution
    return median(lambda: ri.sweep(system), 5), float(
        np.abs(result.restitution - exact).max()
    )


def hertz_pair() -> float:
    """Time of a pair of rods with rounded ends by `solve`, once its machine code is there, s."""
    rods = [
        ri.Rod(length, area=1e-4, material=STEEL, velocity=v)
        for length, v in ((0.4, 1.0), (1.0, 0.0))
    ]
    system = ri.System(rods, contacts=[ri.Hertz(1e10)])
    ri.solve(system)
    return median(lambda: ri.solve(system).outcome)


def row_between_walls(law: Any) -> float:
    """Time of five rods between walls, over 100 transits of the longest, by characteristics, s."""
    lengths, unit = (8, 10, 12, 14, 16), 0.02
    rods = [rod(unit * n, 1 + 0.1 * n, 8 / n - 0.7) for n in lengths]
    system = ri.System(
        [ri.Wall(), *rods, ri.Wall()], gaps=[0.05] * 6, contacts=[law] * 6
    )

    def solved() -> ri.Solution:
        return ri.solve(system, 100 * unit * lengths[-1], "characteristics")

    assert sum(c.episodes for c in solved().outcome.contacts) > 20
    return median(solved, 3)


def cell_on_grid(material: ri.Material, theory: str | None = None) -> float:
    """Time of a cell and step of two rods with 800 cells on a grid, in cache, s."""
    cells, steps = 400, 20_000
    row = [
        ri.Rod(
            1.0, diameter=0.012, material=material, velocity=v, lateral_inertia=theory
        )
        for v in (1.0, 0.0)
    ]
    mesh = Mesh(build_row(ri.System(row)), [cells] * 2)
    step = COURANT * stable_step(row[0].segments[0], cells)
    run = GridRun(mesh, step, 4, 9 * steps)
    run.advance(steps)  # so that machine code is there
    seconds = median(lambda: run.advance(run.steps + steps))
    assert len(run.pressed(0)) == 1
    return seconds / steps / 800


def measure() -> dict[str, float]:
    """Every figure but the yardstick's, s."""
    seconds, error = map_of_pairs()
    print(f"largest error of e in a map of a million pairs: {error:.1e}")
    return {
        "collide() of two rods, interpreted, fresh": fresh(COLLIDE),
        "a compiled collision of two rods, proof included": family_of_pairs(),
        "an event of a long free pair": free_pair(),
        **{f"an event of a row of {n} rods": long_row(n) for n in (30, 1000)},
        "a map of 1000 x 1000 lengths and impedances, two threads": seconds,
        "solve() of a Hertz pair": hertz_pair(),
        "warm(), empty cache, processor time": processor_time(),
        **{
            f"five rods between walls, 100 transits, {name}": row_between_walls(law)
            for name, law in (("rigid contacts", ri.Rigid()), ("Hertz", ri.Hertz(10.0)))
        },
        "a cell and step of two rods and their contact": cell_on_grid(STEEL),
        "a cell and step on a grid, damped": cell_on_grid(STEEL.damped(1e-3, 1e4)),
        "a cell and step on a grid, mindlin-herrmann": cell_on_grid(
            STEEL, "mindlin-herrmann"
        ),
        "velocity on 1000 x 1000 points, compiled": fresh("import numba\n" + FIELD),
        "rodimpact --version": command("--version"),
        f"rodimpact run {CASE.name}": command("run", str(CASE)),
    }


def shown(seconds: float) -> str:
    """A duration with a fitting unit."""
    for unit, scale in (("s", 1.0), ("ms", 1e3), ("us", 1e6)):
        if seconds * scale >= 1:
            return f"{seconds * scale:.3g} {unit}"
    return f"{seconds * 1e9:.3g} ns"


def main() -> None:
    """Print the table."""
    memory = fresh(
        MEMORY
    )  # first: a process inherits the peak of the one that starts it
    second = compiled_godunov()
    before, godunov_before = median(leapfrog), median(second, 101)
    figures = measure()
    yardstick = (before + median(leapfrog)) / 2
    other = (godunov_before + median(second, 101)) / 2
    print(f"NumPy leapfrog, 400 cells per unit length: {shown(yardstick)}")
    print(f"compiled Godunov, 100 cells per unit length: {shown(other)}")
    last = json.loads(LAST.read_text()) if LAST.exists() else {}
    ratios = {
        name: float(f"{value / yardstick:.3g}") for name, value in figures.items()
    }
    print(
        f"{'figure':56} {'median':>8} {'leapfrogs':>10} {'before':>10} {'Godunovs':>10}"
    )
    for name, value in figures.items():
        before = last.get(name, math.nan)
        late = "  slower" if ratios[name] > SLOWER * before else ""
        print(
            f"{name:56} {shown(value):>8} {ratios[name]:10.3g} {before:10.3g} "
            f"{value / other:10.2g}{late}"
        )
    print(f"\nmemory of a run of a million events: {memory / 1e6:.0f} MB of 100 MB")
    if sys.argv[1:] == ["--keep"]:
        LAST.write_text(json.dumps(ratios, indent=1) + "\n")


if __name__ == "__main__":
    main()
