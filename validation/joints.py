"""Rods joined by a spring, by a dashpot, or by both.

Two free rods on a spring, of impedances Z1, Z2 and transit times T1, T2. A mode of frequency w is
a cos(w x/c) in each, x from its free end; its tension at the joint, Z w a sin(w T) but for the
sign, is that of the spring, and moves the ends apart by cot(w T)/(Z w) each for a unit of it. Hence

    w/k = cot(w T1)/Z1 + cot(w T2)/Z2.

Between two neighbouring poles of the right side it falls through all values, so there is one mode.
Its modal mass is the sum over the rods of Z a^2 (T/2 + sin(2 w T)/(4 w)), and a rod of velocity V
takes part by Z V a sin(w T)/w. Started with the shape of a mode the spring swings with w: measured
is the time of its tenth passage of 0. Started with one rod at velocity V its stretch is the sum of
all modes; compared are 501 times over five round trips. The sum of 5000 modes is good to 2e-10.

A dashpot c between endless bars. A wave of velocity v that comes through the first one pushes with
F = c (v1 - v2), v1 = 2 v - F/Z1, v2 = F/Z2: so F/(Z v) = 2 c/(2 c + Z) of it goes on where both
bars are alike, Z/(2 c + Z) comes back, and for c = Z/2 half of its energy is lost. Between a rod
and a wall c = Z takes all of it.

A mass M hangs by a spring and a dashpot on the end of an endless bar, which is a dashpot Z: a
linear system of three equations, whose solution is an exponential of a matrix.

Expected of characteristics at a relative tolerance of 1e-10: frequencies and stretches to 1e-8 of
the largest, and the energy, with what the spring holds and what the dashpot lost, to 1e-12, as
jumps at a dashpot. Expected of a grid of 200 cells to a transit: frequencies to 2e-5, stretches to
1e-4 of the largest (3e-4 with the mass), the impulse of a jump at a dashpot to 1e-6, and what is
lost there to 2e-2, as waves from node to node blur jumps; the energy to 1e-12.

Source: the derivations above; for modes of bars L. Meirovitch, Fundamentals of Vibrations,
McGraw-Hill 2001, ch. 8.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

import rodimpact as ri

from .table import Case, Row, Rows

MODES = "modes of two rods on a spring"
FIRST = ri.Material("first", youngs_modulus=1.0, density=1.0)
SECOND = ri.Material("second", youngs_modulus=6.0, density=1.5)  # c = 2, rho c = 3
STIFFNESS = 2.5
TRANSIT, IMPEDANCE = np.array([1.0, 0.72]), np.array([1.0, 2.1])
METHODS: dict[str, dict[str, Any]] = {
    "characteristics": {"rtol": 1e-10},
    "finite-difference": {"cells": 200},
}
COUNT = 5000  # modes
EXACT = "characteristics"


def run() -> Rows:
    """Modes, dashpots, a mass."""
    return frequencies(), motion(), dashpots(), mass_on_bar()


def rod(i: int, velocity: Any = 0.0) -> ri.Rod:
    """The first or the second rod."""
    return ri.Rod(
        (1.0, 1.44)[i],
        area=(1.0, 0.7)[i],
        material=(FIRST, SECOND)[i],
        velocity=velocity,
    )


def joined(left: ri.Rod, right: ri.Rod) -> ri.System:
    """Two rods on the spring."""
    return ri.System([left, right], contacts=[ri.Joint(STIFFNESS)])


def modes(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Frequencies of the lowest modes, amplitudes for a unit of tension [rod, mode], and masses."""
    poles = np.unique(
        np.concatenate([np.arange(count + 1) * math.pi / T for T in TRANSIT])
    )
    low, high = poles[:count].copy(), poles[1 : count + 1].copy()
    for _ in range(70):
        w = (low + high) / 2
        rising = w / STIFFNESS - (
            1 / (IMPEDANCE[:, None] * np.tan(w * TRANSIT[:, None]))
        ).sum(0)
        low, high = np.where(rising < 0, w, low), np.where(rising < 0, high, w)
    phase, Z = w * TRANSIT[:, None], IMPEDANCE[:, None]
    shape = np.array([[-1.0], [1.0]]) / (Z * w * np.sin(phase))
    mass = (Z * shape**2 * (TRANSIT[:, None] / 2 + np.sin(2 * phase) / (4 * w))).sum(
        axis=0
    )
    return w, shape, mass


def shaped(amplitude: float, phase: float, reversed_: bool) -> Callable[[float], float]:
    """Velocity along a rod that swings in a mode; the free end is the left, or the right one."""
    length = 1.44 if reversed_ else 1.0
    return lambda x: (
        amplitude * np.cos(phase * (1 - x / length if reversed_ else x / length))
    )


def frequencies() -> Rows:
    """The three lowest, each in a run of its own."""
    (w, shape, _) = modes(3)
    for method, size in METHODS.items():
        for m in range(3):
            row = joined(
                *(
                    rod(i, shaped(shape[i, m], w[m] * TRANSIT[i], bool(i)))
                    for i in (0, 1)
                )
            )
            s = ri.solve(row, 10.4 * math.pi / w[m], method, **size)
            t, _, stretch = s.contacts[0].breakpoints()
            i = int(np.flatnonzero(np.diff(np.sign(stretch[1:])))[9]) + 1
            zero = brentq(s.contacts[0].gap, t[i], t[i + 1], xtol=1e-14)
            yield Row(
                f"two rods on a spring, {method}",
                f"frequency of mode {m + 1}, c/l1",
                MODES,
                float(w[m]),
                float(10 * math.pi / zero),
                1e-8 if method == EXACT else 2e-5,
            )


def stretch_of(t: np.ndarray) -> np.ndarray:
    """Stretch of the spring at times, where the first rod begins with 1 and the second at rest."""
    w, shape, mass = modes(COUNT)
    share = (
        IMPEDANCE[0] * shape[0] * np.sin(w * TRANSIT[0]) / w / (mass * w) / STIFFNESS
    )
    return np.array([share @ np.sin(w * time) for time in t])


def motion() -> Rows:
    """The stretch over five round trips of the first rod."""
    t = np.linspace(0.0, 10.0, 501)
    exact = stretch_of(t)
    for method, size in METHODS.items():
        s = ri.solve(joined(rod(0, 1.0), rod(1)), 10.0, method, **size)
        off = np.abs(s.contacts[0].gap(t) - exact).max() / np.abs(exact).max()
        case, energy = (
            f"two rods on a spring, one at speed 1, {method}",
            s.energy(t[::8]),
        )
        yield Row(
            case,
            "stretch, largest difference over its largest",
            MODES,
            0.0,
            float(off),
            1e-8 if method == EXACT else 1e-4,
        )
        yield Row(
            case,
            "energy missing, over all of it",
            "conserved",
            0.0,
            float(np.abs(energy.residual).max() / energy.total[0]),
            1e-12,
        )


def dashpots() -> Rows:
    """A pulse of strain that meets a dashpot between bars, and one before a wall."""
    (Z, other) = IMPEDANCE
    first = ri.Rod(
        1.0,
        area=1.0,
        material=FIRST,
        velocity=ri.Steps([0.0, 1.0, 0.0], [0.25, 0.75]),
        strain=ri.Steps([0.0, -1.0, 0.0], [0.25, 0.75]),
    )
    beyond: list[tuple[str, Any, float, float]] = [
        ("like bars, c = Z/2", rod(0), Z, Z / 2),
        ("unlike bars, c = 3 Z", rod(1), other, 3 * Z),
        ("a rod and a wall, c = Z", ri.Wall(), math.inf, Z),
    ]
    for method, size in METHODS.items():
        for name, second, Z2, c in beyond:
            ends = ri.Absorbing(), ri.Absorbing() if math.inf > Z2 else ri.Free()
            row = ri.System([first, second], contacts=[ri.Joint(0.0, c)], ends=ends)
            s = ri.solve(row, 3.0, method, **size)
            force, energy = 2 * c / (1 + c / Z + c / Z2), s.energy(3.0)
            exact = method == EXACT
            case = Case(f"dashpot between {name}, {method}", "waves at a dashpot")
            yield case.row(
                "impulse over Z v",
                force / 2,
                s.outcome.contacts[0].impulse,
                1e-12 if exact else 1e-6,
            )
            yield case.row(
                "lost there, of the energy that came",
                force**2 / c,
                2 * float(energy.dissipated),
                1e-12 if exact else 2e-2,
            )
            yield case.row("energy missing", 0.0, energy.residual, 1e-12, "conserved")


def mass_on_bar() -> Rows:
    """A mass at speed 1 that hangs on an endless bar: stretch over three of its swings."""
    (M, Z, k, c), t = (0.5, IMPEDANCE[1], 20.0, 0.8), np.linspace(0.0, 3.0, 301)
    rate = k / (1 + c / Z)  # F = (k x + c V)/(1 + c/Z) pushes, x' = V - F/Z
    A = np.array([[-rate / Z, 1 - c / (Z + c)], [-rate / M, -c / (1 + c / Z) / M]])
    exact = np.array([-(expm(A * time) @ [0.0, 1.0])[0] for time in t])
    for method, size in METHODS.items():
        row = ri.System(
            [ri.RigidMass(M, velocity=1.0), rod(1)],
            contacts=[ri.Joint(k, c)],
            ends=(ri.Free(), ri.Absorbing()),
        )
        s = ri.solve(row, 3.0, method, **size)
        off, energy = np.abs(s.contacts[0].gap(t) - exact).max(), s.energy(t)
        case = Case(f"mass on an endless bar, {method}", "exponential of a matrix")
        yield case.row(
            "stretch, largest difference over its largest",
            0.0,
            off / np.abs(exact).max(),
            1e-10 if method == EXACT else 3e-4,
        )
        yield case.row(
            "energy missing, over all of it",
            0.0,
            np.abs(energy.residual).max() / energy.total[0],
            1e-12,
            "conserved",
        )
