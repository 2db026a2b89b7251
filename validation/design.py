"""Designs solved backwards and forwards: stepped strikers, a momentum trap.

Stepped strikers: ten segments of a transit T/20, areas from e^-4 to e^1.5 of the bar's, a pulse of
duration T whose peak is 0.8 of that of an equal bar. The misfit here is the root of the mean
square of the means of the force over each step, over 2 T, ringing included, over the peak; beside
it the best staircase differs from the wanted shape within its steps by 4.5, 5.9 and 2.0 %.
Expected: 0, with bounds a little above what least squares from many random starts reaches.

Hidden strikers: twenty of ten such steps, glued so that they can pull, with the logarithms of
their areas evenly spread over the limits. The pulse over 2 T is computed here, by the reflections
at each step. Where steep steps hide those behind them, the sixteen digits of a pulse do not tell
the areas to 1e-6: of a hundred two were such, of the twenty one may be.

Trap: the striker's pulse of momentum m V goes to and fro in the bar and leaves it at its second
arrival; the gap is what the bar's end moves meanwhile, V 2 L/c.

Source: closed forms; for traps in tension bars S. Nemat-Nasser, J. B. Isaacs and J. E. Starrett,
Proceedings of the Royal Society A 435 (1991) 371.
"""

import math

import numpy as np

import rodimpact as ri
from rodimpact.model.quantities import Floats

from .table import Case, Row, Rows

STEEL = ri.materials.steel
C = STEEL.wave_speed
BAR = ri.Rod(1.0, area=3e-4, material=STEEL)
Z = BAR.segments[0].impedance
SPEED, T = 10.0, 100e-6
SEGMENTS = 10
WIDE = (math.exp(-4.0), math.exp(1.5))  # area ratios


def run() -> Rows:
    """Rows of the table."""
    return shapes(), hidden(), trap()


def shapes() -> Rows:
    """Strikers for three pulses."""
    s = np.linspace(0, 1, 2001)
    peak = 0.8 * Z * SPEED / 2
    wanted = {
        "half sine": (np.sin(np.pi * s), 0.045),
        "trapezoid, corners at 0, .3, .8, 1": (
            np.interp(s, [0, 0.3, 0.8, 1], [0, 1, 1, 0]),
            0.062,
        ),
        "ramp, then 0": (s, 0.128),
    }
    for name, (shape, bound) in wanted.items():
        pulse = ri.Signal(peak * shape, s * T, unit="N")
        found = ri.design.striker(
            pulse, BAR, velocity=SPEED, duration=T, segments=SEGMENTS, area_ratio=WIDE
        )
        yield Row(
            f"striker for a pulse: {name}",
            "misfit of the steps over the peak",
            "the wanted shape",
            0.0,
            math.sqrt(found.misfit**2 - found.staircase**2),
            bound,
        )


def glued(ratios: Floats, steps: int) -> Floats:
    """Force over Z V on a bar that a striker is glued to, one value a round trip of a segment.

    `ratios` are impedances over that of the bar, from the struck end on.
    """
    towards, away, force = np.ones(len(ratios)), np.ones(len(ratios)), []
    for tick in range(2 * steps):
        F = towards[0] / (1 / ratios[0] + 1)
        if tick % 2 == 0:
            force.append(F)
        v = (ratios[:-1] * away[:-1] + ratios[1:] * towards[1:]) / (
            ratios[:-1] + ratios[1:]
        )
        towards, away = (
            np.append(2 * v - away[:-1], away[-1]),
            np.append(towards[0] - 2 * F / ratios[0], 2 * v - towards[1:]),
        )
    return np.array(force)


def hidden() -> Rows:
    """Strikers from their pulses."""
    worst, misfits, step = [], [], T / SEGMENTS
    for seed in range(20):
        ratios = np.exp(np.random.default_rng(seed).uniform(-4, 1.5, SEGMENTS))
        force = Z * SPEED * glued(ratios, 2 * SEGMENTS)
        found = ri.design.striker(
            ri.Steps(force, step * np.arange(1, force.size)),
            BAR,
            velocity=SPEED,
            duration=T,
            contact=ri.Bonded(),
            area_ratio=WIDE,
        )
        areas = np.array([piece.area for piece in found.system.bodies[0].segments])[
            ::-1
        ]
        worst.append(np.abs(areas / BAR.segments[0].area / ratios - 1).max())
        misfits.append(found.misfit)
    case = Case("20 hidden strikers of ten steps", "the hidden one")
    yield case.row(
        "areas, largest relative error, median of the strikers",
        0.0,
        np.median(worst),
        1e-9,
    )
    yield case.row(
        "strikers with an area off by more than 1e-6",
        0.0,
        np.sum(np.array(worst) > 1e-6),
        1.0,
        "the hidden ones",
    )
    yield case.row(
        "largest misfit of the pulse over the peak",
        0.0,
        max(misfits),
        1e-12,
        "reflections step by step",
    )


def trap() -> Rows:
    """A trap that takes the second pulse of a striker."""
    striker = ri.Rod(0.2, area=3e-4, material=STEEL, velocity=SPEED)
    found = ri.design.momentum_trap(
        ri.System([striker, BAR]), after=1.4 / C, until=3.4 / C
    )
    end = 10 / C
    solution = ri.solve(found.system, until=end)
    x = np.linspace(0, 1, 101)
    left = np.concatenate(
        [solution.velocity(1, x, end) / SPEED, solution.strain(1, x, end) * C / SPEED]
    )
    case = Case(
        "momentum trap behind a bar of 1 m, striker of 0.2 m at 10 m/s", "the striker's"
    )
    yield case.row(
        "gap, mm", 1e3 * SPEED * 0.4 / C, 1e3 * found.system.gaps[1], 1e-12, "V 2 L/c"
    )
    yield case.row("length of the trap, m", 0.2, found.system.bodies[2].length, 1e-12)
    yield case.row(
        "velocity of the trap, m/s", SPEED, solution.mean_velocity(2, end), 1e-10
    )
    yield case.zero(
        "v or c strain left in the bar over V, largest", left, 1e-12, "at rest"
    )
