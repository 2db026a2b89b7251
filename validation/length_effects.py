"""Effects of lengths: families of pairs, a rod with a nose, chains and cradles.

The expected values are computed by hand, in units of the transit time T and the
velocity v of the moving rod:

- Two uniform rods of one material, with any lengths and areas, are compared with the
  formula of Saint-Venant. If their areas are equal, e is the shorter length divided by
  the longer length. If their transit times are equal, e = 1.
- A rod of impedance 1 strikes a rod with a nose of impedance z > 1 and transit time L >
  T before a very heavy and long body of impedance Z. The force ends at 2 T, and the
  striker rebounds at (z - 1)/(z + 1). The pulse runs through the nose and is reflected
  with the factor r = (Z - z)/(Z + z). From 2 L to 2 L + 2 T the reflected pulse moves
  the struck end behind the striker at 2 r/(z + 1). The striker and the rod touch again
  if z < 1 + 2 r T/L.
- Chain of n equal rods: the last rod takes the velocity of the first, and all others
  are at rest. The centre of mass of all struck rods moves at v/(n - 1). So e between
  the struck rods and the first rod is 1/(n - 1), as if the struck rods were bonded
  together.
- Five rods of one area: the first rod has the length l0, the others have the length l.
  The number of rods that leave is the number that fits into l0. The last rod leaves at
  v if l <= l0, the rod before it takes the rest of the momentum, and so on. With k = 0,
  1, ... counted from the last rod, the velocity of rod k is v (l0/l - k), limited to
  the range from 0 to v.
- Five rods of one length: the area of the others is a >= 1 times the area of the first.
  Only the first contact reflects. The first rod leaves at (1 - a)/(1 + a) and the last
  rod at 2/(1 + a). The others are at rest.

Source: B. de Saint-Venant, Sur le choc longitudinal de deux barres élastiques, Journal
de mathématiques pures et appliquées 12 (1867); the rest by hand: waves reflected at a
step of impedance, and waves of equal impedance, which pass through a closed contact
unchanged.
"""

from typing import NamedTuple

import numpy as np

import rodimpact as ri

from .table import Case, Rows
from .unit import UNIT, rod

STEEL = ri.materials.steel
BRASS = ri.materials.brass
AREA = 1e-4  # m^2
LINK = 0.2  # m, length of one rod of a chain
BODY_IMPEDANCE = 10.0  # impedance of the heavy body behind a nose
BODY_LENGTH = 20.0


def run() -> Rows:
    """Compare maps of pairs, equal areas or transit times, noses, chains, cradles."""
    yield from map_of_pairs()
    yield from equal_areas()
    yield from equal_transit_times()
    yield from second_contacts()
    yield from chains()
    yield from cradles()


def map_of_pairs() -> Rows:
    """Errors of e, impulse and vibration over a map of lengths and areas of rods.

    The reference is Saint-Venant's formula.
    """
    lengths = np.geomspace(0.1, 10, 48)[:, None]
    areas = AREA * np.geomspace(0.1, 10, 52)
    first = ri.Rod(lengths, area=areas, material=STEEL, velocity=1.0)
    second = ri.Rod(1.0, area=AREA, material=STEEL)
    family = ri.System([first, second])
    result = ri.sweep(family)
    exact = ri.theory.saint_venant(
        first.segments[0].impedance,
        first.transit_time,
        second.segments[0].impedance,
        second.transit_time,
    )
    restitution_error = result.restitution - exact.restitution
    impulse_error = result.impulse / exact.impulse - 1
    kinetic_energy = first.mass / 2  # before, at 1 m/s
    vibration_error = (result.vibration - exact.vibration_energy) / kinetic_energy
    pairs = result.restitution.size
    name = f"steel rods, lengths and areas 0.1 to 10, {pairs} pairs"
    case = Case(name, "Saint-Venant 1867")
    yield case.zero("e, largest difference", restitution_error, 1e-11)
    yield case.zero("impulse, largest relative difference", impulse_error, 1e-11)
    yield case.zero(
        "vibration left - (1 - e^2) mu v_rel^2/2, relative to the kinetic energy",
        vibration_error,
        1e-11,
        source="rigid bodies with this e",
    )


def equal_areas() -> Rows:
    """Largest error of e of steel rods of one area: shorter length over longer.

    The lengths are in the ratios 0.05 to 3, the first rod may be the longer one.
    """
    ratio = np.linspace(0.05, 3, 119)
    first = ri.Rod(ratio, area=AREA, material=STEEL, velocity=1.0)
    second = ri.Rod(1.0, area=AREA, material=STEEL)
    family = ri.System([first, second])
    e = ri.sweep(family).restitution
    error = e - np.minimum(ratio, 1 / ratio)
    name = "steel rods of one area, l1/l2 from 0.05 to 3"
    case = Case(name, "textbook, box 10.4")
    yield case.zero("e - shorter over longer, largest", error, 1e-13)


def equal_transit_times() -> Rows:
    """Largest error of e of steel on brass rods of equal transit times: e = 1.

    The areas of the second rod are 0.1 to 10 times that of the first.
    """
    length = BRASS.wave_speed / STEEL.wave_speed
    areas = AREA * np.geomspace(0.1, 10, 52)
    first = ri.Rod(1.0, area=AREA, material=STEEL, velocity=1.0)
    second = ri.Rod(length, area=areas, material=BRASS)
    family = ri.System([first, second])
    e = ri.sweep(family).restitution
    error = e - 1
    name = "steel on brass, equal transit times, areas 0.1 to 10"
    case = Case(name, "Saint-Venant 1867")
    yield case.zero("e - 1, largest", error, 1e-13)


def second_contacts() -> Rows:
    """Pairs with a second contact: a rod strikes a nose before a heavy body.

    The striker has impedance 1. The number of contacts follows from z < 1 + 2 r T/L.
    """
    z = np.linspace(1.01, 2.6, 32)[:, None]
    L = np.linspace(1.05, 3.0, 40)
    Z = BODY_IMPEDANCE
    nose = ri.Segment(L, z, UNIT)
    body = ri.Segment(BODY_LENGTH, Z, UNIT)
    struck = ri.Rod(segments=[nose, body])
    striker = rod(1.0, velocity=1.0)
    result = complete_sweep(ri.System([striker, struck]))
    reflection = (Z - z) / (Z + z)
    limit = 1 + 2 * reflection / L  # T = 1
    expected = np.where(z < limit, 2, 1)
    name = f"rods with a nose, impedances 1 : z : {Z:g}, {expected.size} pairs"
    case = Case(name, "z < 1 + 2 r T/L")
    expected_pairs = float(np.sum(expected == 2))
    pairs = np.sum(result.episodes == 2)
    wrong = np.sum(result.episodes != expected)
    yield case.row("pairs with a second contact", expected_pairs, pairs, 0.0)
    yield case.row("pairs with another number of contacts than that", 0.0, wrong, 0.0)


class Chain(NamedTuple):
    """The collision of a chain of equal rods, the first at 1 m/s."""

    outcome: ri.Outcome
    restitution_of_all: float  # e of the first rod and the centre of mass of all others
    restitution_of_last: float  # e of the first and the last rod


def chain(n: int) -> Chain:
    """Solve the collision of a chain of n equal rods; the first comes at 1 m/s.

    The result also has e of the first rod and the centre of mass of all others, and e
    of the first and the last rod.
    """
    rods = [ri.Rod(LINK, area=AREA, material=STEEL, velocity=1.0)]
    for _ in range(n - 1):
        rods.append(ri.Rod(LINK, area=AREA, material=STEEL))
    outcome = ri.solve(ri.System(rods)).outcome
    first, *struck = outcome.velocities_after
    mean = sum(struck) / (n - 1)
    restitution_of_all = mean - first  # at the closing speed 1
    restitution_of_last = struck[-1] - first
    return Chain(outcome, restitution_of_all, restitution_of_last)


def bonded_chain_restitution(n: int) -> float:
    """e of the first rod of a chain and a single rod as long as all others."""
    first = ri.Rod(LINK, area=AREA, material=STEEL, velocity=1.0)
    bonded = ri.Rod(LINK * (n - 1), area=AREA, material=STEEL)
    return ri.collide(first, bonded).restitution


def chains() -> Rows:
    """Chains of 2 to 10 equal rods: errors of the velocities, and of e.

    e is that of the first and the last rod, 1, and of the first rod and the centre of
    mass of all others, 1/(n - 1). A rod on a rod as long as all others has this e, too.
    """
    velocity_errors = []
    errors_of_all = []
    errors_of_last = []
    bonded_errors = []
    for n in range(2, 11):
        solved = chain(n)
        expected = np.zeros(n)
        expected[-1] = 1.0
        velocities = np.array(solved.outcome.velocities_after)
        velocity_errors.extend(velocities - expected)
        errors_of_all.append(solved.restitution_of_all - 1 / (n - 1))
        errors_of_last.append(solved.restitution_of_last - 1)
        bonded = bonded_chain_restitution(n)
        bonded_errors.append(solved.restitution_of_all - bonded)
    case = Case("chains of 2 to 10 equal rods", "as many go as came")
    yield case.zero(
        "velocities after - (0, ..., 0, 1) m/s, largest", velocity_errors, 1e-13
    )
    yield case.zero("e of the first and the last - 1, largest", errors_of_last, 1e-13)
    yield case.zero(
        "e of the first and all others - 1/(n - 1), largest",
        errors_of_all,
        1e-13,
        source="momentum",
    )
    yield case.zero(
        "the same - e of the first and a rod as long as all others, largest",
        bonded_errors,
        1e-13,
        source="box 10.4",
    )


def complete_sweep(family: ri.System) -> ri.SweepResult:
    """Results of a family; ValueError if a member does not come to its end."""
    result = ri.sweep(family)
    if result.incomplete.any():
        incomplete = np.argwhere(result.incomplete)
        first = tuple(incomplete[0])
        raise ValueError(result.explain(first))
    return result


def cradle(length: object = 1.0, area: object = 1.0) -> ri.SweepResult:
    """Sweep of five rods, the first of 1 m and 1 cm^2 at 1 m/s.

    Lengths and areas of the four others are given as ratios to those of the first.
    """
    first = ri.Rod(1.0, area=AREA, material=STEEL, velocity=1.0)
    other = ri.Rod(np.asarray(length), area=AREA * np.asarray(area), material=STEEL)
    return complete_sweep(ri.System([first, other, other, other, other]))


def cradles() -> Rows:
    """Velocities after of cradles of five rods, the first unlike the others.

    The others are longer or shorter, then thicker. The velocities are compared with
    formulas.
    """
    length_ratio = np.linspace(0.26, 3.0, 138)
    expected = [np.zeros(length_ratio.shape)]
    for k in (3, 2, 1, 0):  # of rods 2 to 5, counted from the last
        expected.append(np.clip(1 / length_ratio - k, 0, 1))
    velocities = np.array(cradle(length=length_ratio).velocities_after)
    case = Case(
        "Newton's cradle, four others 0.26 to 3 times as long",
        "l0/l - k between 0 and 1",
    )
    quantity = "velocities after, m/s, largest difference"
    error = velocities - expected
    yield case.zero(quantity, error, 1e-12)

    a = np.geomspace(1, 10, 41)
    resting = np.zeros(a.shape)
    first = (1 - a) / (1 + a)
    last = 2 / (1 + a)
    expected = [first, resting, resting, resting, last]
    velocities = np.array(cradle(area=a).velocities_after)
    case = Case(
        "Newton's cradle, four others 1 to 10 times as thick",
        "(1 - a)/(1 + a), 0, 0, 0, 2/(1 + a)",
    )
    error = velocities - expected
    yield case.zero(quantity, error, 1e-12)
