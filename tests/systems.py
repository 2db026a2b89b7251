"""Random rows for property tests: lengths with a common unit, so that fronts do not multiply."""

import numpy as np

import rodimpact as ri

MATERIALS = [
    ri.Material("one", youngs_modulus=100e9, density=4000.0),
    ri.Material("heavy", youngs_modulus=100e9 * 4, density=4000.0 * 4),
    ri.Material("stiff", youngs_modulus=100e9 * 4, density=4000.0),
]


STEEL = ri.materials.steel


def rod(length=1.0, velocity=0.0, area=1e-4, material=STEEL, **more):
    return ri.Rod(length, area=area, material=material, velocity=velocity, **more)


def random_profile(rng, length, scale):
    if rng.random() < 0.7:
        return scale * rng.uniform(-1, 1)
    at = sorted(
        rng.choice(np.arange(1, 16), size=rng.integers(1, 3), replace=False)
        / 16
        * length
    )
    return ri.Steps(
        [scale * rng.uniform(-1, 1) for _ in range(len(at) + 1)], list(map(float, at))
    )


def random_rod(rng, unit, vibrating, stepped):
    def segment():
        material = MATERIALS[rng.integers(len(MATERIALS))]
        length = float(unit * rng.integers(1, 9))
        return ri.Segment(length, float(rng.uniform(0.3, 3) * 1e-4), material)

    count = rng.integers(1, 4) if stepped and rng.random() < 0.3 else 1
    segments = [segment() for _ in range(count)]
    length = sum(s.length for s in segments)
    if not vibrating or rng.random() < 0.6:
        return ri.Rod(segments=segments, velocity=float(rng.uniform(-1, 1)))
    return ri.Rod(
        segments=segments,
        velocity=random_profile(rng, length, 1.0),
        strain=random_profile(rng, length, 1e-4) if rng.random() < 0.5 else 0.0,
    )


def random_system(
    seed,
    *,
    bodies=6,
    walls=True,
    moving_walls=True,
    vibrating=True,
    stepped=True,
    bonded=True,
    unit=0.05,
):
    rng = np.random.default_rng(seed)
    row = [
        random_rod(rng, unit, vibrating, stepped)
        for _ in range(rng.integers(1 if walls else 2, bodies + 1))
    ]

    def random_wall(slowest, fastest):
        moves = rng.random() < 0.5 and moving_walls
        return ri.Wall(float(rng.uniform(slowest, fastest)) if moves else 0.0)

    if walls and rng.random() < 0.4:
        row.insert(0, random_wall(-0.2, 0.3))
    if walls and rng.random() < 0.4:
        row.append(random_wall(-0.3, 0.2))
    pairs = len(row) - 1
    contacts = [
        ri.Bonded() if bonded and rng.random() < 0.1 else ri.Rigid()
        for _ in range(pairs)
    ]
    gaps = [
        0.0
        if isinstance(c, ri.Bonded) or rng.random() < 0.5
        else float(rng.uniform(0, 5e-5))
        for c in contacts
    ]
    return ri.System(row, gaps, contacts)


def horizon(system, transits=40.0):
    """Time of some transits of the longest rod."""
    return transits * max(
        b.transit_time for b in system.bodies if isinstance(b, ri.Rod)
    )


def random_drive(rng, scale, time):
    """A number, or steps at sixteenths of a time."""
    if rng.random() < 0.3:
        return float(scale * rng.uniform(-1, 1))
    at = (
        np.sort(rng.choice(np.arange(1, 64), size=rng.integers(1, 5), replace=False))
        / 16
        * time
    )
    return ri.Steps((scale * rng.uniform(-1, 1, len(at) + 1)).tolist(), at.tolist())


def random_end(rng, body, time, driven):
    if isinstance(body, ri.Wall):
        return ri.Free()
    kinds = [ri.Free, ri.Fixed, ri.Absorbing, ri.Absorbing]
    drives = [ri.Pushed, ri.Moved, ri.Incoming] * 2
    kind = (kinds + drives * driven)[rng.integers(4 + 6 * driven)]
    if kind is ri.Pushed:
        return ri.Pushed(random_drive(rng, float(body.segments[0].impedance), time))
    if kind is ri.Incoming:
        return ri.Incoming(random_drive(rng, 0.5 / body.segments[0].wave_speed, time))
    return ri.Moved(random_drive(rng, 0.5, time)) if kind is ri.Moved else kind()


def with_ends(seed, driven=True, bodies=4, **switches):
    """A random row with random ends."""
    system = random_system(seed, bodies=bodies, **switches)
    rng = np.random.default_rng([seed, 1])
    ends = [
        random_end(rng, system.bodies[i], horizon(system, 1), driven) for i in (0, -1)
    ]
    return ri.System(system.bodies, system.gaps, system.contacts, ends=ends)
