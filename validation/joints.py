"""Rods joined by a spring, by a dashpot, or by both.

Two free rods, joined by a spring of stiffness k, have the impedances Z1, Z2 and the
transit times T1, T2. In a mode of angular frequency w the velocity of each rod is a
cos(w x/c), with x from its free end. Except for the sign, the tension at the joint is Z
a sin(w T). The same tension acts in the spring. A unit tension moves the end of each
rod by cot(w T)/(Z w). Hence

    w/k = cot(w T1)/Z1 + cot(w T2)/Z2.

Between two neighbouring poles the right side falls through all values, so there is
exactly one mode. Its modal mass is the sum over the rods of Z a^2 (T/2 + sin(2 w T)/(4
w)), and a rod of velocity V contributes Z V a sin(w T)/w. If the rods start with the
shape of a mode, the spring oscillates with w, and the time of its tenth passage through
0 is compared. If one rod starts with the velocity V, the stretch is the sum of all
modes, and its values at 501 times over five round trips are compared. The sum of 5000
modes is accurate to 2e-10.

A dashpot c joins two infinite bars. A wave of velocity v in the first bar causes the
force F = c (v1 - v2), where v1 = 2 v - F/Z1 and v2 = F/Z2. If both bars are equal,

    F/(Z v) = 2 c/(2 c + Z) is transmitted, Z/(2 c + Z) is reflected,

and for c = Z/2 half of the energy is lost. Between a rod and a wall a dashpot c = Z
absorbs all of the energy.

A mass M is joined by a spring and a dashpot to the end of an infinite bar, which acts
as a dashpot Z. This is a linear system of equations. Its solution is the exponential of
a matrix.

Expected accuracy of characteristics at a relative tolerance of 1e-10: frequencies and
stretches to 1e-8 of the largest value; the energy balance, with spring and dashpot, and
jumps at a dashpot to 1e-12. Expected accuracy of a grid with 200 cells per transit:
frequencies to 2e-5, stretches to 1e-4 of the largest value (3e-4 with the mass), the
impulse of a jump at a dashpot to 1e-6. The loss of a jump in the dashpot is expected
only to 2e-2, because the grid blurs jumps. The energy balance is expected to 1e-12.

Source: the derivations above; for modes of bars L. Meirovitch, Fundamentals of
Vibrations, McGraw-Hill 2001, ch. 8.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

import rodimpact as ri

from .table import Case, Rows, largest_magnitude

SUM_OF_MODES = "modes of two rods on a spring"
FIRST = ri.Material("first", youngs_modulus=1.0, density=1.0)
SECOND = ri.Material("second", youngs_modulus=6.0, density=1.5)  # c = 2, rho c = 3
FIRST_LENGTH = 1.0
SECOND_LENGTH = 1.44
STIFFNESS = 2.5
TRANSIT_TIMES = np.array([1.0, 0.72])
IMPEDANCES = np.array([1.0, 2.1])
MODES_OF_SUM = 5000
BISECTIONS = 70  # halvings of an interval, which then is as small as round-off


class Method(NamedTuple):
    """A method, its options, and bounds on its errors."""

    name: str
    options: dict[str, Any]
    frequency: float
    stretch: float  # over the largest stretch
    stretch_with_mass: float
    impulse: float  # bound for the impulse of a dashpot
    loss: float  # bound for the loss in a dashpot


METHODS = (
    Method(
        "characteristics",
        {"rtol": 1e-10},
        frequency=1e-8,
        stretch=1e-8,
        stretch_with_mass=1e-10,
        impulse=1e-12,
        loss=1e-12,
    ),
    Method(
        "finite-difference",
        {"cells": 200},
        frequency=2e-5,
        stretch=1e-4,
        stretch_with_mass=3e-4,
        impulse=1e-6,
        loss=2e-2,
    ),
)
ENERGY_BOUND = 1e-12  # energy that may be missing in the balance, by any method


def run() -> Rows:
    """Compare modes and motion of rods on a spring, dashpots, and a mass.

    Each is computed by each method.
    """
    for method in METHODS:
        yield from frequencies(method)
    for method in METHODS:
        yield from motion(method)
    for method in METHODS:
        for junction in junctions():
            yield from dashpot(method, junction)
    for method in METHODS:
        yield from mass_on_bar(method)


def first_rod(velocity: Any = 0.0) -> ri.Rod:
    """Rod 1, whose impedance is 1."""
    return ri.Rod(FIRST_LENGTH, area=1.0, material=FIRST, velocity=velocity)


def second_rod(velocity: Any = 0.0) -> ri.Rod:
    """Rod 2, whose impedance is 2.1."""
    return ri.Rod(SECOND_LENGTH, area=0.7, material=SECOND, velocity=velocity)


def joined(left: ri.Rod, right: ri.Rod) -> ri.System:
    """Two rods on the spring."""
    return ri.System([left, right], contacts=[ri.Joint(STIFFNESS)])


class Modes(NamedTuple):
    """The lowest modes of two rods on the spring."""

    frequencies: np.ndarray  # angular, [mode]
    shapes: np.ndarray  # velocity amplitudes for a unit of tension, [rod, mode]
    masses: np.ndarray  # modal masses, [mode]


def mode_frequencies(count: int) -> np.ndarray:
    """The lowest roots of w/k = cot(w T1)/Z1 + cot(w T2)/Z2, one between two poles.

    Poles are the multiples of pi/T1 and pi/T2; all roots are bisected together.
    """
    T = TRANSIT_TIMES[:, None]
    Z = IMPEDANCES[:, None]
    poles = [np.arange(count + 1) * math.pi / transit for transit in TRANSIT_TIMES]
    poles = np.unique(np.concatenate(poles))
    low = poles[:count].copy()
    high = poles[1 : count + 1].copy()
    for _ in range(BISECTIONS):
        w = (low + high) / 2
        cotangents = 1 / (Z * np.tan(w * T))
        # This rises from -inf to inf between two poles.
        rising = w / STIFFNESS - cotangents.sum(0)
        is_below = rising < 0
        low = np.where(is_below, w, low)
        high = np.where(is_below, high, w)
    return w


def modes(count: int) -> Modes:
    """The lowest modes of two rods on the spring, for a tension of 1 in the spring.

    A rod has the velocity a cos(w x/c) with a = 1/(Z w sin(w T)), the first one with
    the opposite sign, and adds Z a^2 (T/2 + sin(2 w T)/(4 w)) to the modal mass.
    """
    T = TRANSIT_TIMES[:, None]
    Z = IMPEDANCES[:, None]
    w = mode_frequencies(count)
    phase = w * T
    signs = np.array([[-1.0], [1.0]])
    shapes = signs / (Z * w * np.sin(phase))
    lengths = T / 2 + np.sin(2 * phase) / (4 * w)
    masses = (Z * shapes**2 * lengths).sum(axis=0)
    return Modes(w, shapes, masses)


def from_left_end(amplitude: float, phase: float) -> Callable[[float], float]:
    """Velocity along rod 1 in a mode, whose free end is the left one."""
    return lambda x: amplitude * np.cos(phase * (x / FIRST_LENGTH))


def from_right_end(amplitude: float, phase: float) -> Callable[[float], float]:
    """Velocity along rod 2 in a mode, whose free end is the right one."""
    return lambda x: amplitude * np.cos(phase * (1 - x / SECOND_LENGTH))


def tenth_zero(contact: ri.ContactHistory) -> float:
    """Time of the tenth passage of 0 of the stretch of a spring, after the start."""
    t, _, stretch = contact.breakpoints()
    # The stretch is 0 at the start, which is left out: change i is behind time i + 1.
    changes = np.flatnonzero(np.diff(np.sign(stretch[1:])))
    i = int(changes[9]) + 1
    return brentq(contact.gap, t[i], t[i + 1], xtol=1e-14)


def frequencies(method: Method) -> Rows:
    """Frequencies of the three lowest modes of two rods on a spring, by one method.

    Each mode is started alone in a run of its own. Its frequency follows from the tenth
    zero of the stretch.
    """
    w, shapes, _ = modes(count=3)
    case = Case(f"two rods on a spring, {method.name}", SUM_OF_MODES)
    for m in range(3):
        frequency = float(w[m])
        first_phase, second_phase = frequency * TRANSIT_TIMES
        left = from_left_end(shapes[0, m], first_phase)
        right = from_right_end(shapes[1, m], second_phase)
        system = joined(first_rod(left), second_rod(right))
        until = 10.4 * math.pi / frequency  # ten half periods, and a little more
        solution = ri.solve(system, until, method.name, **method.options)
        computed = 10 * math.pi / tenth_zero(solution.contacts[0])
        quantity = f"frequency of mode {m + 1}, c/l1"
        yield case.row(quantity, frequency, computed, method.frequency)


def stretch_by_modes(t: np.ndarray) -> np.ndarray:
    """Stretch of the spring at times t; first rod 1 has velocity 1, rod 2 rests.

    It is the sum of 5000 modes.
    """
    w, shapes, masses = modes(MODES_OF_SUM)
    # Modal momentum of rod 1: the integral of its shape times mass per time, Z
    momentum = IMPEDANCES[0] * shapes[0] * np.sin(w * TRANSIT_TIMES[0]) / w
    amplitudes = momentum / (masses * w) / STIFFNESS
    stretches = [amplitudes @ np.sin(w * time) for time in t]
    return np.array(stretches)


def motion(method: Method) -> Rows:
    """Stretch and energy of two rods on a spring over five round trips of rod 1.

    Rod 1 starts at velocity 1. The reference is the sum over modes.
    """
    t = np.linspace(0.0, 10.0, 501)
    exact = stretch_by_modes(t)
    left = first_rod(velocity=1.0)
    right = second_rod()
    system = joined(left, right)
    solution = ri.solve(system, 10.0, method.name, **method.options)
    spring = solution.contacts[0]
    error = largest_magnitude(spring.gap(t) - exact) / largest_magnitude(exact)
    energy = solution.energy(t[::8])  # every eighth time, to save some
    missing = largest_magnitude(energy.residual) / energy.total[0]
    case = Case(f"two rods on a spring, one at speed 1, {method.name}", SUM_OF_MODES)
    yield case.row(
        "stretch, largest difference over its largest", 0.0, error, method.stretch
    )
    yield case.row(
        "energy missing, over all of it",
        0.0,
        missing,
        ENERGY_BOUND,
        source="conserved",
    )


class Junction(NamedTuple):
    """A dashpot at the end of rod 1."""

    name: str
    body: ri.Rod | ri.Wall  # body beyond the dashpot
    impedance: float  # impedance of that body
    damping: float  # c of the dashpot
    end: ri.Absorbing | ri.Free  # condition at the far end of that body


def junctions() -> list[Junction]:
    """Dashpots before a like bar, an unlike bar, and a wall.

    A bar or wall is what a pulse in another bar meets behind the dashpot.
    """
    Z, unlike = IMPEDANCES
    like_bar = Junction("like bars, c = Z/2", first_rod(), Z, Z / 2, ri.Absorbing())
    unlike_bar = Junction(
        "unlike bars, c = 3 Z", second_rod(), unlike, 3 * Z, ri.Absorbing()
    )
    wall = Junction("a rod and a wall, c = Z", ri.Wall(), math.inf, Z, ri.Free())
    return [like_bar, unlike_bar, wall]


def dashpot(method: Method, junction: Junction) -> Rows:
    """Impulse, loss and energy of a pulse of strain that meets a dashpot.

    The force is F = 2 c v/(1 + c/Z1 + c/Z2), with v = 1 and Z1 = 1, for the time 1/2.
    """
    edges = [0.25, 0.75]
    velocity = ri.Steps([0.0, 1.0, 0.0], edges)
    strain = ri.Steps([0.0, -1.0, 0.0], edges)
    pulse = ri.Rod(
        FIRST_LENGTH, area=1.0, material=FIRST, velocity=velocity, strain=strain
    )
    c = junction.damping
    contact = ri.Joint(stiffness=0.0, damping=c)
    ends = (ri.Absorbing(), junction.end)
    system = ri.System([pulse, junction.body], contacts=[contact], ends=ends)
    solution = ri.solve(system, 3.0, method.name, **method.options)
    impulse = solution.outcome.contacts[0].impulse
    energy = solution.energy(3.0)
    lost = 2 * float(energy.dissipated)  # the pulse came with the energy 1/2
    # The pulse, and so the force, lasts 1/2.
    force = 2 * c / (1 + c / IMPEDANCES[0] + c / junction.impedance)
    residual = energy.residual
    case = Case(f"dashpot between {junction.name}, {method.name}", "waves at a dashpot")
    yield case.row("impulse over Z v", force / 2, impulse, method.impulse)
    yield case.row(
        "lost there, of the energy that came", force**2 / c, lost, method.loss
    )
    yield case.row("energy missing", 0.0, residual, ENERGY_BOUND, source="conserved")


MASS = 0.5
MASS_STIFFNESS = 20.0
MASS_DAMPING = 0.8


def stretch_with_mass(t: np.ndarray) -> np.ndarray:
    """Stretch of the joint of a mass and an endless bar, by an exponential of a matrix.

    With the shortening x and the velocity V of the mass, the force that pushes the bar
    is F = (k x + c V)/(1 + c/Z), with x' = V - F/Z and V' = -F/M.
    """
    M = MASS
    Z = IMPEDANCES[1]
    k = MASS_STIFFNESS
    c = MASS_DAMPING
    rate = k / (1 + c / Z)
    stretch_row = [-rate / Z, 1 - c / (Z + c)]
    velocity_row = [-rate / M, -c / (1 + c / Z) / M]
    A = np.array([stretch_row, velocity_row])
    start = [0.0, 1.0]  # x and V
    # exp(A t) (x, V)(0) starts with the shortening x(t)
    stretches = [-(expm(A * time) @ start)[0] for time in t]
    return np.array(stretches)


def mass_on_bar(method: Method) -> Rows:
    """Stretch and energy of a mass at speed 1 on an endless bar, up to t = 3.

    A joint with stiffness and damping connects them. The reference is the exponential
    of a matrix.
    """
    t = np.linspace(0.0, 3.0, 301)
    exact = stretch_with_mass(t)
    mass = ri.RigidMass(MASS, velocity=1.0)
    bar = second_rod()
    contact = ri.Joint(MASS_STIFFNESS, MASS_DAMPING)
    ends = (ri.Free(), ri.Absorbing())
    system = ri.System([mass, bar], contacts=[contact], ends=ends)
    solution = ri.solve(system, 3.0, method.name, **method.options)
    joint = solution.contacts[0]
    error = largest_magnitude(joint.gap(t) - exact) / largest_magnitude(exact)
    energy = solution.energy(t)
    missing = largest_magnitude(energy.residual) / energy.total[0]
    case = Case(f"mass on an endless bar, {method.name}", "exponential of a matrix")
    yield case.row(
        "stretch, largest difference over its largest",
        0.0,
        error,
        method.stretch_with_mass,
    )
    yield case.row(
        "energy missing, over all of it",
        0.0,
        missing,
        ENERGY_BOUND,
        source="conserved",
    )
