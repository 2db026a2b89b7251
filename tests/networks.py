"""Random rows with every body, contact law and end that characteristics can carry."""

import math
from itertools import pairwise

import numpy as np

import rodimpact as ri

STEP = 1 / 32  # of a grid
UNIT = ri.Material("unit", youngs_modulus=1.0, density=1.0)
QUICK = ri.Material("quick", youngs_modulus=8.0, density=2.0)


def unit_rod(length=1.0, area=1.0, **state):
    """A rod whose transit time is its length and whose impedance is its area."""
    return ri.Rod(length, area=area, material=UNIT, **state)


def logarithmic(rng, low, high):
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def random_state(rng, length, scale):
    """A number, jumps or samples."""
    kind = rng.random()
    if kind < 0.5:
        return float(scale * rng.uniform(-1, 1))
    values = (scale * rng.uniform(-1, 1, rng.integers(2, 7))).tolist()
    if kind < 0.75:
        at = (
            np.sort(rng.choice(np.arange(1, 32), size=len(values) - 1, replace=False))
            / 32
        )
        return ri.Steps(values, (at * length).tolist())
    return ri.Samples(values)


def random_rod(rng):
    segments = [
        ri.Segment(
            float(
                rng.integers(4, 33) / 32 if rng.random() < 0.5 else rng.uniform(0.1, 1)
            ),
            logarithmic(rng, 0.1, 10),
            UNIT if rng.random() < 0.7 else QUICK,
        )
        for _ in range(rng.choice([1, 1, 1, 2, 3]))
    ]
    length = sum(s.length for s in segments)
    strain = random_state(rng, length, 0.5) if rng.random() < 0.3 else 0.0
    return ri.Rod(
        segments=segments, velocity=random_state(rng, length, 1.0), strain=strain
    )


def random_law(rng, *pair):
    if rng.random() < 0.12 and not all(isinstance(b, ri.Wall) for b in pair):
        return ri.Bonded()
    if rng.random() < 0.12:
        k = logarithmic(rng, 1e-1, 1e4)
        c = logarithmic(rng, 1e-2, 1e2)
        k, c = [(k, 0.0), (k, c), (0.0, c)][rng.integers(3)]
        return ri.Joint(k, c, stretch=float(rng.uniform(-0.3, 0.3)) / (1 + k))
    k = (
        logarithmic(rng, 1e-2, 1e3)
        if rng.random() < 0.7
        else logarithmic(rng, 1e3, 1e9)
    )
    kind = rng.integers(6)
    if kind == 0:
        has_rod = any(isinstance(b, ri.Rod) for b in pair)
        return (
            ri.Rigid()
            if has_rod
            else ri.Rigid(restitution=float(rng.choice([0, 1, 0.6])))
        )
    return [
        ri.Spring(k),
        ri.SpringDashpot(k, logarithmic(rng, 1e-3, 1e2)),
        ri.Hertz(k),
        ri.HuntCrossley(k, logarithmic(rng, 1e-2, 10)),
        ri.Yielding(
            k, logarithmic(rng, 1e-3, 1.0), float(k * rng.choice([0.0, 0.1, 0.8]))
        ),
    ][kind - 1]


def random_drive(rng, scale):
    kind = rng.integers(3)
    if kind == 0:
        return float(scale * rng.uniform(-1, 1))
    values = (scale * rng.uniform(-1, 1, 5)).tolist()
    return (
        ri.Steps(values, [0.5, 0.71, 1.9, 2.0])
        if kind == 1
        else ri.Samples(values, step=0.6)
    )


def random_end(rng, body, driven):
    if isinstance(body, ri.Wall):
        return ri.Free()
    kinds = [ri.Free, ri.Free]
    if isinstance(body, ri.Rod):
        kinds += [ri.Absorbing, ri.Fixed]
    if driven:
        kinds += [ri.Pushed] * 2
        kinds += [ri.Moved, ri.Moved, ri.Incoming] if isinstance(body, ri.Rod) else []
    kind = kinds[rng.integers(len(kinds))]
    if kind is ri.Pushed:
        return ri.Pushed(random_drive(rng, 1.0))
    return kind(random_drive(rng, 0.3)) if kind in (ri.Moved, ri.Incoming) else kind()


def move_together(row, contacts):
    """Give rigid bodies that are bonded the velocity of the first, or of their wall."""
    pairs = [(i, i + 1) for i in range(len(contacts))]
    for one, other in [*pairs, *((j, i) for i, j in reversed(pairs))]:
        law = contacts[min(one, other)]
        if (
            isinstance(law, ri.Bonded)
            and isinstance(row[other], ri.RigidMass)
            and not isinstance(row[one], ri.Rod)
        ):
            row[other] = ri.RigidMass(row[other].mass, velocity=row[one].velocity)


def random_network(seed, *, bodies=5, driven=False):
    """A row; only a driven one has gravity, moving walls and drives."""
    rng = np.random.default_rng(seed)
    row = [
        ri.RigidMass(logarithmic(rng, 0.02, 20), velocity=float(rng.uniform(-1, 1)))
        if rng.random() < 0.4
        else random_rod(rng)
        for _ in range(rng.integers(1, bodies + 1))
    ]
    if not any(isinstance(b, ri.Rod) for b in row):
        row[rng.integers(len(row))] = random_rod(rng)
    for place in (0, len(row) + 1):
        if rng.random() < 0.3:
            moving = driven and rng.random() < 0.5
            row.insert(place, ri.Wall(float(rng.uniform(-0.2, 0.2)) if moving else 0.0))
    contacts = [random_law(rng, *pair) for pair in pairwise(row)]
    move_together(row, contacts)
    gaps = [
        0.0 if not law.opens or rng.random() < 0.5 else float(rng.uniform(0, 0.3))
        for law in contacts
    ]
    ends = [random_end(rng, row[i], driven) for i in (0, -1)]
    gravity = float(rng.uniform(-1, 1)) if driven and rng.random() < 0.6 else 0.0
    return ri.System(row, gaps, contacts, gravity=gravity, ends=ends)


def shifted(system, v):
    """The same system seen by someone who moves at -v."""

    def profile(p):
        if isinstance(p, ri.Steps):
            return ri.Steps([x + v for x in p.values], p.at)
        return ri.Samples(p.values + v, p.step) if isinstance(p, ri.Samples) else p + v

    def body(b):
        if isinstance(b, ri.Rod):
            return ri.Rod(
                segments=b.segments, velocity=profile(b.velocity), strain=b.strain
            )
        if isinstance(b, ri.Wall):
            return ri.Wall(b.velocity + v)
        return ri.RigidMass(b.mass, velocity=b.velocity + v)

    def end(e):
        if isinstance(e, ri.Fixed):
            return ri.Moved(v)
        return ri.Moved(profile(e.value)) if isinstance(e, ri.Moved) else e

    return ri.System(
        [body(b) for b in system.bodies],
        system.gaps,
        system.contacts,
        gravity=system.gravity,
        ends=[end(e) for e in system.ends],
    )
