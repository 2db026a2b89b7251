"""Horns: tapered rods on a grid, with the front of a wave, closed forms, and as many steps.

- Cone, A ~ s^2, s the distance from the apex: s u obeys d'Alembert. With a speed V given to the
  smaller end, v = V s0/s behind the front and 0 before it, until the wave is back; with a pressure,
  s u = (P s0^2/E) (1 - exp(-(c t - x)/s0)) and v = (P c s0/(E s)) exp(-(c t - x)/s0).
- The front arrives after L/c, grown by A^(-1/2), in a cone and in an exponential horn alike: at the
  free end it doubles. Time of the passage of half of it.
- Exponential horn, A = A0 exp(2 beta x): omega^2 = c^2 (k^2 + beta^2). Between free ends, and
  between fixed ones, k = n pi/L, and u = exp(-beta x) (cos k x + (beta/k) sin k x) or
  exp(-beta x) sin k x. With beta L = 4 the lowest mode lies well above the cut-off c beta, below
  which no wave runs: without the taper it would lie below it. Read off as in `lateral_inertia`.
- A rod strikes a horn: on a grid, and as a rod of 200 steps by "fronts". They agree to
  1e-5 where the horn widens and the force falls to zero slowly. Where it narrows, the force ends in
  a jump, and what is left between them halves with the cells.

Source: Lord Rayleigh, The Theory of Sound, chapter XIV; A. G. Webster, Acoustical impedance, and
the theory of horns and of the phonograph, Proc. Natl. Acad. Sci. USA 5 (1919) 275-282; the modes by
hand.
"""

import math
from collections.abc import Callable

import numpy as np

import rodimpact as ri

from .lateral_inertia import frequency
from .table import Case, Row, Rows
from .unit import UNIT, rod

METHOD, CELLS = "finite-difference", 400
ALONG = np.linspace(0.0, 1.0, 8001)  # places of samples
APEX = 0.5  # from the smaller end of a cone


def run() -> Rows:
    """Cones, fronts, modes, steps."""
    return cone(), fronts(), modes(), steps()


def horn(
    area: Callable[[np.ndarray], np.ndarray], **moving: ri.Samples | float
) -> ri.Rod:
    """Of length 1."""
    return ri.Rod(segments=[ri.Segment(1.0, ri.Samples(area(ALONG)), UNIT)], **moving)


def conical(x: np.ndarray) -> np.ndarray:
    """Area of a cone, 1 at its smaller end."""
    return (1 + x / APEX) ** 2


def exponential(beta: float) -> Callable[[np.ndarray], np.ndarray]:
    """Area of an exponential horn, 1 at x = 0."""
    return lambda x: np.exp(2 * beta * x)


def cone() -> Rows:
    """A speed, then a pressure on the smaller end."""
    case = Case("cone, A1/A0 = 9", "s u obeys d'Alembert")
    t, x = np.array([0.3, 0.6, 0.9]), ((np.arange(2000) + 0.5) / 2000)[:, None]
    moved = on_grid(ri.Moved(1.0), t).velocity(0, x, t)
    exact = np.where(x < t, APEX / (APEX + x), 0.0)
    behind = x < t - 0.1
    pushed = on_grid(ri.Pushed(1.0), t).velocity(0, x, t)
    by_pressure = under_pressure(t, x)
    yield case.row(
        "given speed: velocity, mean difference",
        0.0,
        np.abs(moved - exact).mean(),
        2e-3,
    )
    yield case.row(
        "given speed: velocity 0.1 behind the front, largest difference",
        0.0,
        np.abs(moved - exact)[behind].max(),
        1e-3,
    )
    yield case.row(
        "given pressure: velocity, mean difference",
        0.0,
        np.abs(pushed - by_pressure).mean(),
        2e-3,
    )
    yield case.row(
        "given pressure: velocity 0.1 behind the front, largest difference",
        0.0,
        np.abs(pushed - by_pressure)[behind].max(),
        1e-3,
    )


def under_pressure(t: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Velocity at x and t in the cone whose smaller end a pressure of 1 pushes from t = 0."""
    behind = np.maximum(t - x, 0.0)
    return np.where(x < t, APEX / (APEX + x) * np.exp(-behind / APEX), 0.0)


def on_grid(end: ri.Moved | ri.Pushed, times: np.ndarray) -> ri.Solution:
    """The cone, driven at its smaller end."""
    row = ri.System([horn(conical)], ends=(end, ri.Free()))
    longest_step = 0.999 / CELLS  # by which waves disperse least; the end is a multiple
    until = longest_step * math.ceil(times[-1] / longest_step)
    return ri.solve(row, method=METHOD, cells=CELLS, until=until, snapshots=times)


def fronts() -> Rows:
    """Through a horn and to its free end."""
    for case, area in (
        ("cone, A1/A0 = 9", conical),
        ("exponential horn, beta L = 1", exponential(1.0)),
    ):
        t = np.linspace(0.98, 1.05, 701)
        row = ri.System([horn(area)], ends=(ri.Moved(1.0), ri.Free()))
        v = ri.solve(row, method=METHOD, cells=CELLS, until=1.05, snapshots=t).velocity(
            0, 1.0, t
        )
        growth = 2 * ri.theory.horn_amplification(1.0, float(area(np.array(1.0))))
        i = int(np.argmax(v > growth / 2))
        yield Row(case, "front arrives, L/c", "L/c", 1.0, float(t[i]), 5e-3)
        yield Row(
            case,
            "velocity of the free end behind the front",
            "2 (A0/A1)^(1/2)",
            growth,
            float(np.interp(1.01, t, v)),
            0.02 * growth,
        )


def modes() -> Rows:
    """Of an exponential horn."""
    beta, dt = 4.0, 0.999 / CELLS
    for case, ends in (
        ("free", (ri.Free(), ri.Free())),
        ("fixed", (ri.Fixed(), ri.Fixed())),
    ):
        for n in (1, 2, 3):
            k = n * math.pi
            shape = np.sin(k * ALONG)
            if case == "free":
                shape = np.cos(k * ALONG) + beta / k * shape
            rod = horn(
                exponential(beta), velocity=ri.Samples(np.exp(-beta * ALONG) * shape)
            )
            times = 10 * dt * np.arange(300)
            solution = ri.solve(
                ri.System([rod], ends=ends),
                method=METHOD,
                dt=dt,
                until=float(times[-1]),
                snapshots=times,
            )
            v = solution.velocity(0, 0.0 if case == "free" else 0.5 / n, times)
            exact = float(ri.theory.horn_frequency(1.0, k, beta))
            yield Row(
                f"exponential horn, beta L = 4, {case} ends",
                f"angular frequency of mode {n}",
                "c (k^2 + beta^2)^(1/2)",
                exact,
                frequency(v, 10 * dt),
                1e-4 * exact,
            )


def steps() -> Rows:
    """A rod strikes the smaller, and the larger end of a horn."""
    striker = rod(0.3, velocity=1.0)
    for case, area, bound in (
        ("rod strikes a cone, A1/A0 = 9", conical, 5e-5),
        ("rod strikes an exponential horn, beta L = 1", exponential(1.0), 5e-5),
        ("rod strikes an exponential horn, beta L = -1", exponential(-1.0), 2e-3),
    ):
        struck = horn(area)
        stepped = ri.solve(
            ri.System([striker, struck.in_steps(200)]), method="fronts"
        ).outcome
        o = ri.solve(ri.System([striker, struck]), method=METHOD, cells=CELLS).outcome
        source = "200 steps by fronts"
        yield Row(case, "e", source, stepped.restitution, o.restitution, bound)
        yield Row(case, "impulse", source, stepped.impulse, o.impulse, bound)
