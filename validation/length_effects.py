"""What lengths do: families of pairs, blows on a rod with a nose, chains and cradles.

Hand values, in units of the transit time T and velocity v of the rod that comes:

- Two uniform rods of one material, at any lengths and areas, against the formula of Saint-Venant;
  of one area, e is the shorter length over the longer; at equal transit times e = 1.
- A rod of impedance 1 strikes one with a nose of impedance z > 1 and transit time L > T before a
  very heavy and long body. Force ends at 2 T and the striker goes back at (z - 1)/(z + 1). The blow
  runs through the nose and comes back with the fraction r = (Z - z)/(Z + z), Z the body's
  impedance: from 2 L to 2 L + 2 T it drives the struck end after the striker, at 2 r/(z + 1). They
  meet again if z < 1 + 2 r T/L.
- Chain of n equal rods: the last takes over the velocity of the first, all others stay at rest.
  The centre of mass of all that were struck moves off at v/(n - 1), so that between them and the
  first rod e is 1/(n - 1), the same as if they were bonded together.
- Five rods of one area, the first l0 long, the others l: as many go as fit into the length of the
  one that came. The last leaves at v if it is no longer than l0, the one before it takes what is
  left, and so on: velocities v, counted k = 0, 1, ... from the last, are l0/l - k between 0 and 1.
- Five rods of one length, the others a >= 1 times as thick as the first: only the first contact
  reflects. The first rod goes at (1 - a)/(1 + a), the last at 2/(1 + a), the others stay.

Source: B. de Saint-Venant, Sur le choc longitudinal de deux barres élastiques, Journal de
mathématiques pures et appliquées 12 (1867); the rest by hand: waves reflected at a step of
impedance, and waves of equal impedance, which pass through a closed contact unchanged.
"""

import numpy as np

import rodimpact as ri

from .table import Case, Row, Rows, largest
from .unit import UNIT, rod

STEEL, AREA = ri.materials.steel, 1e-4
BODY = 10.0, 20.0  # impedance and length


def run() -> Rows:
    """Pairs, second contacts, chains, cradles."""
    return pairs(), second_contacts(), chains(), cradles()


def pairs() -> Rows:
    """Maps over length and area, and lines on them."""
    lengths, areas = (
        np.geomspace(0.1, 10, 48)[:, None],
        AREA * np.geomspace(0.1, 10, 52),
    )
    first = ri.Rod(lengths, area=areas, material=STEEL, velocity=1.0)
    second = ri.Rod(1.0, area=AREA, material=STEEL)
    got = ri.sweep(ri.System([first, second]))
    exact = ri.theory.saint_venant(
        *(
            x
            for rod in (first, second)
            for x in (rod.segments[0].impedance, rod.transit_time)
        )
    )
    case = Case(
        f"steel rods, lengths and areas 0.1 to 10, {got.restitution.size} pairs",
        "Saint-Venant 1867",
    )
    yield case.zero("e, largest difference", got.restitution - exact.restitution, 1e-11)
    yield case.zero(
        "impulse, largest relative difference", got.impulse / exact.impulse - 1, 1e-11
    )
    yield case.zero(
        "vibration left - (1 - e^2) m_coll v_rel^2/2, relative to the kinetic energy",
        (got.vibration - exact.vibration_energy) / (first.mass / 2),
        1e-11,
        "rigid bodies with this e",
    )
    ratio = np.linspace(0.05, 3, 119)
    same = ri.Rod(ratio, area=AREA, material=STEEL, velocity=1.0)
    e = ri.sweep(ri.System([same, second])).restitution
    yield Row(
        "steel rods of one area, l1/l2 from 0.05 to 3",
        "e - shorter over longer, largest",
        "textbook, box 10.4",
        0.0,
        largest(e - np.minimum(ratio, 1 / ratio)),
        1e-13,
    )
    brass = ri.Rod(
        ri.materials.brass.wave_speed / STEEL.wave_speed,
        area=areas,
        material=ri.materials.brass,
    )
    e = ri.sweep(
        ri.System([ri.Rod(1.0, area=AREA, material=STEEL, velocity=1.0), brass])
    )
    yield Row(
        "steel on brass, equal transit times, areas 0.1 to 10",
        "e - 1, largest",
        "Saint-Venant 1867",
        0.0,
        largest(e.restitution - 1),
        1e-13,
    )


def second_contacts() -> Rows:
    """A rod with a nose before a heavy body, struck by a rod of impedance 1."""
    z, L = np.linspace(1.01, 2.6, 32)[:, None], np.linspace(1.05, 3.0, 40)
    Z, length = BODY
    struck = ri.Rod(segments=[ri.Segment(L, z, UNIT), ri.Segment(length, Z, UNIT)])
    result = swept(ri.System([rod(1.0, velocity=1.0), struck]))
    expected = np.where(z < 1 + 2 * (Z - z) / (Z + z) / L, 2, 1)
    case = Case(
        f"rods with a nose, impedances 1 : z : {Z:g}, {expected.size} pairs",
        "z < 1 + 2 r T/L",
    )
    yield case.row(
        "pairs with a second contact",
        float(np.sum(expected == 2)),
        np.sum(result.episodes == 2),
        0.0,
    )
    yield case.row(
        "pairs with another number of contacts than that",
        0.0,
        np.sum(result.episodes != expected),
        0.0,
    )


def chain(n: int) -> tuple[ri.Outcome, float, float]:
    """n equal rods, the first at 1 m/s; e of the first and all others, e of the first and last."""
    rods = [
        ri.Rod(0.2, area=AREA, material=STEEL, velocity=0.0 if i else 1.0)
        for i in range(n)
    ]
    outcome = ri.solve(ri.System(rods)).outcome
    v = outcome.velocities_after
    return outcome, sum(v[1:]) / (n - 1) - v[0], v[-1] - v[0]


def chains() -> Rows:
    """Chains of 2 to 10 equal rods."""
    velocity, of_all, of_last, bonded = [], [], [], []
    for n in range(2, 11):
        outcome, all_others, last = chain(n)
        velocity.append(largest(np.array(outcome.velocities_after) - np.eye(n)[-1]))
        of_all.append(all_others - 1 / (n - 1))
        of_last.append(last - 1)
        single = ri.Rod(0.2 * (n - 1), area=AREA, material=STEEL)
        first = ri.Rod(0.2, area=AREA, material=STEEL, velocity=1.0)
        bonded.append(all_others - ri.collide(first, single).restitution)
    case = Case("chains of 2 to 10 equal rods", "as many go as came")
    yield case.zero("velocities after - (0, ..., 0, 1) m/s, largest", velocity, 1e-13)
    yield case.zero("e of the first and the last - 1, largest", of_last, 1e-13)
    yield case.zero(
        "e of the first and all others - 1/(n - 1), largest", of_all, 1e-13, "momentum"
    )
    yield case.zero(
        "the same - e of the first and a rod as long as all others, largest",
        bonded,
        1e-13,
        "box 10.4",
    )


def swept(family: ri.System) -> ri.SweepResult:
    """Results of a family of which every member comes to its end."""
    result = ri.sweep(family)
    if result.incomplete.any():
        raise ValueError(result.explain(tuple(np.argwhere(result.incomplete)[0])))
    return result


def cradle(length: object = 1.0, area: object = 1.0) -> ri.SweepResult:
    """Five rods, the first of 1 m and 1 cm^2 at 1 m/s; the others so many times as long, thick."""
    others = ri.Rod(np.asarray(length), area=AREA * np.asarray(area), material=STEEL)
    first = ri.Rod(1.0, area=AREA, material=STEEL, velocity=1.0)
    return swept(ri.System([first, *[others] * 4]))


def cradles() -> Rows:
    """Newton's cradles of five rods, the first unlike the others."""
    ratio = np.linspace(0.26, 3.0, 138)
    velocities = np.array(cradle(length=ratio).velocities_after)
    lengths = [
        np.clip(1 / ratio - k, 0, 1) if k < 4 else np.zeros(ratio.shape)
        for k in (4, 3, 2, 1, 0)
    ]
    a = np.geomspace(1, 10, 41)
    rest = np.zeros(a.shape)
    areas = [(1 - a) / (1 + a), rest, rest, rest, 2 / (1 + a)]
    thick = np.array(cradle(area=a).velocities_after)
    yield Row(
        "Newton's cradle, four others 0.26 to 3 times as long",
        "velocities after, m/s, largest difference",
        "l0/l - k between 0 and 1",
        0.0,
        largest(velocities - lengths),
        1e-12,
    )
    yield Row(
        "Newton's cradle, four others 1 to 10 times as thick",
        "velocities after, m/s, largest difference",
        "(1 - a)/(1 + a), 0, 0, 0, 2/(1 + a)",
        0.0,
        largest(thick - areas),
        1e-12,
    )
