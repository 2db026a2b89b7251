"""Random rows with every body, contact law and end that characteristics can carry."""

import math
from itertools import pairwise

import numpy as np
from numpy.random import default_rng

import rodimpact as ri

STEP = 1 / 32
"""Time step of a grid, s."""
UNIT = ri.Material("unit", youngs_modulus=1.0, density=1.0)
"""Bar speed 1 m/s, and an impedance of 1 N s/m for each m^2."""
QUICK = ri.Material("quick", youngs_modulus=8.0, density=2.0)
"""Bar speed 2 m/s."""


def unit_rod(length=1.0, area=1.0, **state):
    """A rod of `UNIT`: its transit time is its length, and its impedance and its mass
    per length are its area. `state` is its velocity and strain.
    """
    return ri.Rod(length, area=area, material=UNIT, **state)


def logarithmic(rng, low, high):
    """A random number between two, its logarithm evenly distributed."""
    exponent = rng.uniform(math.log(low), math.log(high))
    return float(math.exp(exponent))


def random_state(rng, length, scale):
    """A profile along a rod: a number, steps at 32nds of its length, or samples.

    Its values lie between -scale and scale.
    """
    kind = rng.random()
    if kind < 0.5:
        return float(scale * rng.uniform(-1, 1))
    n_values = rng.integers(2, 7)
    values = scale * rng.uniform(-1, 1, n_values)
    if kind < 0.75:
        possible_jumps = np.arange(1, 32)
        jumps = rng.choice(possible_jumps, size=n_values - 1, replace=False)
        places = np.sort(jumps) / 32 * length
        return ri.Steps(values.tolist(), places.tolist())
    return ri.Samples(values.tolist())


def random_segment(rng):
    """A random segment; in half of the cases its length is a multiple of `STEP`."""
    if rng.random() < 0.5:
        length = rng.integers(4, 33) / 32
    else:
        length = rng.uniform(0.1, 1)
    area = logarithmic(rng, 0.1, 10)
    material = UNIT if rng.random() < 0.7 else QUICK
    return ri.Segment(float(length), area, material)


def random_rod(rng):
    """A rod of one to three segments with a profile of velocity, perhaps of strain."""
    n_segments = rng.choice([1, 1, 1, 2, 3])
    segments = [random_segment(rng) for _ in range(n_segments)]
    length = sum(segment.length for segment in segments)
    strain = 0.0
    if rng.random() < 0.3:
        strain = random_state(rng, length, 0.5)
    velocity = random_state(rng, length, 1.0)
    return ri.Rod(segments=segments, velocity=velocity, strain=strain)


def random_joint(rng):
    """A spring, a dashpot, or both."""
    stiffness = logarithmic(rng, 1e-1, 1e4)
    damping = logarithmic(rng, 1e-2, 1e2)
    kind = rng.integers(3)
    if kind == 0:
        damping = 0.0
    elif kind == 2:
        stiffness = 0.0
    length = float(rng.uniform(-0.3, 0.3))
    stretch = length / (1 + stiffness)  # stiff springs are stretched less
    return ri.Joint(stiffness, damping, stretch=stretch)


def random_law(rng, left, right):
    """A random contact law, bond or joint that may stand between these two bodies. In
    30 % of the compliant laws it is much stiffer than rods, whose stiffnesses are about
    1.
    """
    between_walls = isinstance(left, ri.Wall) and isinstance(right, ri.Wall)
    if rng.random() < 0.12 and not between_walls:
        return ri.Bonded()
    if rng.random() < 0.12:
        return random_joint(rng)
    if rng.random() < 0.7:
        stiffness = logarithmic(rng, 1e-2, 1e3)
    else:
        stiffness = logarithmic(rng, 1e3, 1e9)
    kind = rng.integers(6)
    if kind == 0:
        if isinstance(left, ri.Rod) or isinstance(right, ri.Rod):
            return ri.Rigid()
        # Between masses and walls no waves decide how the bodies part.
        restitution = float(rng.choice([0, 1, 0.6]))
        return ri.Rigid(restitution=restitution)
    # All laws are made, so that a seed makes the same row whatever its law is.
    laws = [
        ri.Spring(stiffness),
        ri.SpringDashpot(stiffness, logarithmic(rng, 1e-3, 1e2)),
        ri.Hertz(stiffness),
        ri.HuntCrossley(stiffness, logarithmic(rng, 1e-2, 10)),
        ri.Yielding(
            stiffness,
            yield_force=logarithmic(rng, 1e-3, 1.0),
            hardening=float(stiffness * rng.choice([0.0, 0.1, 0.8])),
        ),
    ]
    return laws[kind - 1]


def random_drive(rng, scale):
    """A random function of time: a number, steps or samples, with values within
    +-scale.
    """
    kind = rng.integers(3)
    if kind == 0:
        return float(scale * rng.uniform(-1, 1))
    values = scale * rng.uniform(-1, 1, 5)
    if kind == 1:
        return ri.Steps(values.tolist(), [0.5, 0.71, 1.9, 2.0])
    return ri.Samples(values.tolist(), step=0.6)


def random_end(rng, body, driven):
    """A random end of a row at this outermost body, free at a wall; only a driven row
    has pushed, moved or incoming ends.
    """
    if isinstance(body, ri.Wall):
        return ri.Free()  # a wall is an end itself, and takes no other
    kinds = [ri.Free, ri.Free]
    if isinstance(body, ri.Rod):
        kinds += [ri.Absorbing, ri.Fixed]
    if driven:
        kinds += [ri.Pushed, ri.Pushed]
    if driven and isinstance(body, ri.Rod):
        kinds += [ri.Moved, ri.Moved, ri.Incoming]
    kind = kinds[rng.integers(len(kinds))]
    if kind is ri.Pushed:
        return ri.Pushed(random_drive(rng, 1.0))
    if kind in (ri.Moved, ri.Incoming):
        return kind(random_drive(rng, 0.3))
    return kind()


def move_together(bodies, contacts):
    """Give rigid bodies that are bonded one velocity: of the first, or of their wall.

    Masses in `bodies` are replaced in place. The velocity is handed on from body to
    body, first to the right, then to the left, as a wall may stand on either side.
    """
    rightward = [(i, i + 1) for i in range(len(contacts))]
    leftward = [(j, i) for i, j in reversed(rightward)]
    for leader, follower in [*rightward, *leftward]:
        law = contacts[min(leader, follower)]  # the contact between both
        follows = isinstance(bodies[follower], ri.RigidMass)
        leads = not isinstance(bodies[leader], ri.Rod)
        if isinstance(law, ri.Bonded) and follows and leads:
            velocity = bodies[leader].velocity
            mass = bodies[follower].mass
            bodies[follower] = ri.RigidMass(mass, velocity=velocity)


def random_body(rng):
    """A rod or a rigid mass."""
    if rng.random() < 0.4:
        mass = logarithmic(rng, 0.02, 20)
        velocity = float(rng.uniform(-1, 1))
        return ri.RigidMass(mass, velocity=velocity)
    return random_rod(rng)


def random_network(seed, *, bodies=5, driven=False):
    """A row of up to `bodies` rods and masses, at least one of them a rod.

    It may have walls beside these. Only a driven one has gravity, moving walls and
    drives.
    """
    rng = default_rng(seed)
    row = [random_body(rng) for _ in range(rng.integers(1, bodies + 1))]
    if not any(isinstance(body, ri.Rod) for body in row):
        row[rng.integers(len(row))] = random_rod(rng)
    # A wall before the first body shifts the last one; without it, insert() appends.
    for index in (0, len(row) + 1):
        if rng.random() < 0.3:
            velocity = 0.0
            if driven and rng.random() < 0.5:
                velocity = float(rng.uniform(-0.2, 0.2))
            row.insert(index, ri.Wall(velocity))
    contacts = [random_law(rng, left, right) for left, right in pairwise(row)]
    move_together(row, contacts)
    gaps = []
    for law in contacts:
        gap = 0.0
        if law.opens and rng.random() >= 0.5:
            gap = float(rng.uniform(0, 0.3))
        gaps.append(gap)
    left_end = random_end(rng, row[0], driven)
    right_end = random_end(rng, row[-1], driven)
    gravity = 0.0
    if driven and rng.random() < 0.6:
        gravity = float(rng.uniform(-1, 1))
    return ri.System(row, gaps, contacts, gravity=gravity, ends=(left_end, right_end))


def shifted_body(body, v):
    """A body that is faster by v, m/s."""
    return body.replace(velocity=shifted_profile(body.velocity, v))


def shifted_end(end, v):
    """The end of a row seen from a frame that moves at -v: a fixed or moved end is
    faster by v, m/s, and any other end is unchanged.
    """
    if isinstance(end, ri.Fixed):
        return ri.Moved(v)
    if isinstance(end, ri.Moved):
        return ri.Moved(shifted_profile(end.value, v))
    return end


def shifted_profile(profile, v):
    """A velocity, a number, steps or samples, that is larger by v, m/s."""
    if isinstance(profile, ri.Steps):
        return ri.Steps([value + v for value in profile.values], profile.at)
    if isinstance(profile, ri.Samples):
        return ri.Samples(profile.values + v, profile.step)
    return profile + v


def shifted(system, v):
    """The same system seen by someone who moves at -v."""
    bodies = [shifted_body(body, v) for body in system.bodies]
    ends = [shifted_end(end, v) for end in system.ends]
    return system.replace(bodies=bodies, ends=ends)
