"""Random rows for property tests: lengths with a common unit, so that fronts do not
multiply.
"""

import numpy as np
from numpy.random import default_rng

import rodimpact as ri

MATERIALS = [
    ri.Material("one", youngs_modulus=100e9, density=4000.0),
    ri.Material("heavy", youngs_modulus=400e9, density=16000.0),
    ri.Material("stiff", youngs_modulus=400e9, density=4000.0),
]
"""Bar speeds of 5000, 5000 and 10000 m/s, so that transit times have a common unit."""


STEEL = ri.materials.steel


def rod(length=1.0, velocity=0.0, area=1e-4, material=STEEL, **settings):
    """A rod of steel, 1 m long and 1 cm^2 thick, at rest, if nothing else is said.

    `settings` are other arguments of `ri.Rod`.
    """
    return ri.Rod(length, area=area, material=material, velocity=velocity, **settings)


def random_profile(rng, length, scale):
    """A number (in 70 % of the cases), or steps of one or two jumps along a length.

    Values lie between -scale and scale, jumps at sixteenths of the length.
    """
    if rng.random() < 0.7:
        return scale * rng.uniform(-1, 1)
    n_jumps = rng.integers(1, 3)
    sixteenths = rng.choice(np.arange(1, 16), size=n_jumps, replace=False)
    places = np.sort(sixteenths / 16 * length)
    values = [scale * rng.uniform(-1, 1) for _ in range(n_jumps + 1)]
    return ri.Steps(values, places.tolist())


def random_segment(rng, unit):
    """A random segment, whose length is one to eight times `unit`."""
    material = MATERIALS[rng.integers(len(MATERIALS))]
    length = float(unit * rng.integers(1, 9))
    area = float(rng.uniform(0.3, 3) * 1e-4)
    return ri.Segment(length, area, material)


def random_rod(rng, unit, may_vibrate, may_have_segments):
    """A rod whose segments are whole numbers of units long.

    It may have up to three segments, and may start with a profile of velocity (up to
    1 m/s) and one of strain; else it starts with one velocity and without strain.
    """
    count = 1
    if may_have_segments and rng.random() < 0.3:
        count = rng.integers(1, 4)
    segments = [random_segment(rng, unit) for _ in range(count)]
    length = sum(segment.length for segment in segments)
    if not may_vibrate or rng.random() < 0.6:
        return ri.Rod(segments=segments, velocity=float(rng.uniform(-1, 1)))
    velocity = random_profile(rng, length, scale=1.0)
    strain = 0.0
    if rng.random() < 0.5:
        strain = random_profile(rng, length, scale=1e-4)
    return ri.Rod(segments=segments, velocity=velocity, strain=strain)


def random_wall(rng, *, slowest, fastest, may_move):
    """A wall at rest; if it may move, in half of the cases with a velocity between
    two, m/s.
    """
    velocity = 0.0
    if rng.random() < 0.5 and may_move:
        velocity = float(rng.uniform(slowest, fastest))
    return ri.Wall(velocity)


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
    """A row of up to `bodies` rods, in rigid contact with gaps or without.

    The flags say what it may have, by chance: walls beside it, which may move;
    vibration at the start; rods of several segments; bonds. Lengths are whole numbers
    of `unit`, m.
    """
    rng = default_rng(seed)
    fewest = 1 if walls else 2
    row = []
    for _ in range(rng.integers(fewest, bodies + 1)):
        row.append(random_rod(rng, unit, vibrating, stepped))
    # Walls rather move towards the rods than away from them.
    if walls and rng.random() < 0.4:
        wall = random_wall(rng, slowest=-0.2, fastest=0.3, may_move=moving_walls)
        row.insert(0, wall)
    if walls and rng.random() < 0.4:
        wall = random_wall(rng, slowest=-0.3, fastest=0.2, may_move=moving_walls)
        row.append(wall)
    contacts = []
    for _ in row[1:]:
        is_bonded = bonded and rng.random() < 0.1
        contacts.append(ri.Bonded() if is_bonded else ri.Rigid())
    gaps = []
    for law in contacts:
        gap = 0.0
        if isinstance(law, ri.Rigid) and rng.random() >= 0.5:
            gap = float(rng.uniform(0, 5e-5))
        gaps.append(gap)
    return ri.System(row, gaps, contacts)


def horizon(system, transits=40.0):
    """Time of so many transits of the longest rod, s."""
    rods = [body for body in system.bodies if isinstance(body, ri.Rod)]
    return transits * max(rod.transit_time for rod in rods)


def random_drive(rng, scale, time):
    """A number between -scale and scale, or up to four jumps between such numbers.

    The jumps lie at sixteenths of a time, and before four times it.
    """
    if rng.random() < 0.3:
        return float(scale * rng.uniform(-1, 1))
    n_jumps = rng.integers(1, 5)
    sixteenths = rng.choice(np.arange(1, 64), size=n_jumps, replace=False)
    times = np.sort(sixteenths) / 16 * time
    values = scale * rng.uniform(-1, 1, n_jumps + 1)
    return ri.Steps(values.tolist(), times.tolist())


def random_end(rng, body, time, driven):
    """A random end of a row beside its last body; a driven one may push or move it.

    Drives jump at sixteenths of `time`, s, and make velocities of up to 1 m/s.
    """
    if isinstance(body, ri.Wall):
        return ri.Free()  # a wall is an end itself, and takes no other
    kinds = [ri.Free, ri.Fixed, ri.Absorbing, ri.Absorbing]
    if driven:
        kinds += [ri.Pushed, ri.Moved, ri.Incoming] * 2
    kind = kinds[rng.integers(len(kinds))]
    segment = body.segments[0]
    if kind is ri.Pushed:
        force_of_1_m_per_s = float(segment.impedance)
        return ri.Pushed(random_drive(rng, force_of_1_m_per_s, time))
    if kind is ri.Incoming:
        strain_of_half_a_m_per_s = 0.5 / segment.wave_speed
        return ri.Incoming(random_drive(rng, strain_of_half_a_m_per_s, time))
    if kind is ri.Moved:
        return ri.Moved(random_drive(rng, 0.5, time))
    return kind()


def with_ends(seed, driven=True, bodies=4, **switches):
    """A random row with random ends: free, fixed, absorbing, or driven if they may.

    `switches` are the flags of `random_system`.
    """
    system = random_system(seed, bodies=bodies, **switches)
    rng = default_rng([seed, 1])
    time = horizon(system, transits=1)
    left = random_end(rng, system.bodies[0], time, driven)
    right = random_end(rng, system.bodies[-1], time, driven)
    return system.replace(ends=(left, right))
