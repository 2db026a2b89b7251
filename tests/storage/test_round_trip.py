"""Systems of any bodies, laws, ends and profiles come back from their case files
equal.
"""

from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

import rodimpact as ri
from rodimpact import format_case, parse_case
from rodimpact.methods.run import MEASURES
from rodimpact.model.bodies import BODIES
from rodimpact.model.ends import ENDS
from rodimpact.model.laws import CONTACT_LAWS, Plastic
from rodimpact.storage.saved_result import SavedResult, names_of_numbers


def sizes(low=-6, high=6):
    """Positive numbers of any digits: floats of many magnitudes, and integers."""
    powers = st.floats(low, high).map(lambda power: 10.0**power)
    return st.one_of(powers, st.integers(1, 10**9), st.sampled_from([0.1, 1.0, 1]))


def shares(low, high):
    """Numbers of an interval, none of them tiny."""
    return st.integers(0, 1000).map(lambda n: low + (high - low) * n / 1000)


def signed(least=2.3e-308, most=1e150):
    """Numbers of both signs, -0.0 and the smallest and the largest among them."""
    extremes = [0, -0.0, least, -least, most, -most, 1, -3]
    usual = st.floats(-1e6, 1e6, allow_subnormal=False)
    return st.one_of(usual, st.sampled_from(extremes), st.integers(-(10**20), 10**20))


def or_left_out(**entries):
    """Dicts of these arguments, each of which may be left out."""
    return st.fixed_dictionaries({}, optional=entries)


SMALLEST = 5e-324
"""The smallest float above 0."""
SAMPLED = st.one_of(signed(), st.just(SMALLEST))
ANY_NAMES = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=8)
DIFFICULT_NAMES = st.sampled_from(["steel", "steel 2", "inf", "nan", "a.b", "'", '"'])


def material_of(name, youngs_modulus, density, others):
    """A material; `others` are its arguments that may be left out."""
    return ri.Material(name, youngs_modulus=youngs_modulus, density=density, **others)


MATERIALS = st.builds(
    material_of,
    st.one_of(ANY_NAMES, DIFFICULT_NAMES),
    sizes(),
    sizes(),
    or_left_out(
        poisson_ratio=shares(-0.9, 0.49),
        viscosity=st.one_of(st.just(0), sizes()),
    ),
)
INERTIA = st.sampled_from(
    [
        {},
        {"lateral_inertia": "rayleigh-love"},
        {"lateral_inertia": "mindlin-herrmann"},
        {"lateral_inertia": "rayleigh-love", "polar_moment": "circular"},
        {"lateral_inertia": "mindlin-herrmann", "polar_moment": 1e-9},
    ]
)
TAPERS = st.one_of(
    st.lists(sizes(), min_size=2, max_size=20).map(ri.Samples),
    st.sampled_from([lambda x: 1 + x * x, lambda x: 2.0 if x < 1 else 2.0 + x]),
)
SHAPES = st.one_of(
    sizes().map(lambda area: {"area": area}),
    sizes().map(lambda diameter: {"diameter": diameter}),
    TAPERS.map(lambda taper: {"area": taper}),
)


def segment_of(length, material, shape, inertia):
    """A segment; without lateral inertia if the material or shape do not allow it."""
    plain = ri.Segment(length, material=material, **shape)
    try:
        return plain.replace(**inertia)
    except ri.InvalidModel:
        return plain


SEGMENTS = st.builds(segment_of, sizes(), MATERIALS, SHAPES, INERTIA)


def steps(values, places):
    """Steps with jumps at these places, in whatever order they come.

    There may be up to four places and as few as two values: they are repeated.
    """
    at = sorted(set(places))
    enough = values * 5
    return ri.Steps(enough[: len(at) + 1], at)


LISTS = st.lists(SAMPLED, min_size=2, max_size=30)
CURVES = st.builds(
    ri.Samples,
    LISTS,
    smooth=st.booleans(),
    error=st.one_of(st.just(0), sizes(-20, -3)),
)
ALONG = st.one_of(
    signed(),
    st.builds(steps, LISTS, st.lists(sizes(-8, -6), max_size=4)),
    CURVES,
    st.just(np.sin),
    st.just(lambda x: float(x > 0.5)),
)
IN_TIME = st.one_of(
    signed(),
    st.builds(steps, LISTS, st.lists(sizes(), max_size=4)),
    st.builds(lambda curve, step: curve.replace(step=step), CURVES, sizes()),
)


def rod_of(segments, velocity, strain):
    """A rod; at rest and unstrained if the profiles do not fit into its length."""
    try:
        return ri.Rod(segments=segments, velocity=velocity, strain=strain)
    except ri.InvalidModel:
        return ri.Rod(segments=segments)


RODS = st.builds(rod_of, st.lists(SEGMENTS, min_size=1, max_size=3), ALONG, ALONG)
MASSES = st.builds(ri.RigidMass, sizes(), velocity=signed())


def hertz_of_ball_on_rigid_flat(radius, material):
    """Hertz's law of an elastic ball on a rigid flat."""
    return ri.Hertz.from_radii(
        left_radius=radius,
        right_radius=np.inf,
        left_material=material,
        right_material=None,
    )


def yielding_of(stiffness, yield_force, share):
    """A law that yields; `share` is the hardening over the stiffness."""
    return ri.Yielding(stiffness, yield_force, hardening=share * stiffness)


def table_of(overlap_steps, force_steps):
    """A table of increasing overlaps and forces, which unloads almost rigidly."""
    overlaps = np.cumsum(overlap_steps)
    forces = np.cumsum(force_steps)
    return ri.Tabulated(overlaps, forces, unloading=1e30)


THREE_SIZES = st.lists(sizes(), min_size=3, max_size=3)
WITH_POISSON_RATIO = MATERIALS.filter(
    lambda material: material.poisson_ratio is not None
)
LAWS = {
    "rigid": st.just(ri.Rigid()),
    "bonded": st.just(ri.Bonded()),
    "joint": st.builds(ri.Joint, sizes(), sizes(), stretch=shares(-1e-3, 1e-3)),
    "spring": st.builds(ri.Spring, sizes()),
    "spring-dashpot": st.builds(ri.SpringDashpot, sizes(), sizes()),
    "hertz": st.one_of(
        st.builds(ri.Hertz, sizes()),
        st.builds(hertz_of_ball_on_rigid_flat, sizes(), WITH_POISSON_RATIO),
    ),
    "hunt-crossley": st.builds(ri.HuntCrossley, sizes(), sizes()),
    "power": st.builds(ri.PowerLaw, sizes(), shares(1, 5)),
    "yielding": st.builds(yielding_of, sizes(), sizes(), shares(0, 0.9)),
    "smith-toe": st.builds(ri.SmithToe, sizes(), sizes(), sizes()),
    "cushion": st.builds(ri.Cushion, sizes(), shares(0.1, 1)),
    "tabulated": st.builds(table_of, THREE_SIZES, THREE_SIZES),
}
END_OF = {
    "free": st.just(ri.Free()),
    "fixed": st.just(ri.Fixed()),
    "absorbing": st.just(ri.Absorbing()),
    "pushed": st.one_of(
        IN_TIME.map(ri.Pushed),
        st.builds(lambda t: ri.Pushed(np.cos, duration=t), shares(1e-3, 9)),
    ),
    "moved": IN_TIME.map(ri.Moved),
    "incoming": IN_TIME.map(ri.Incoming),
}


@st.composite
def laws_between(draw, left, right):
    """A law that goes between these bodies, and a gap, m; it may be below 0 where the
    law allows an overlap at the start.
    """
    law = draw(st.one_of(*LAWS.values()))
    are_both_rigid = not isinstance(left, ri.Rod) and not isinstance(right, ri.Rod)
    if are_both_rigid and law.law in ("rigid", "bonded"):
        # No wave decides an impact of rigid bodies: it needs a restitution.
        law = ri.Rigid(restitution=draw(shares(0, 1)))
    gap = 0
    if law.opens:
        gap = draw(sizes(-9, 0))
    may_overlap = law.law not in ("rigid", "bonded", "joint")
    if may_overlap and draw(st.booleans()):
        overlap = gap
        if isinstance(law, Plastic):
            # A contact begins pressed no farther than where it yields.
            overlap = min(overlap, law.yield_force / law.stiffness)
        gap = 0 - overlap
    return law, gap


KINDS_OF_ENDS = {
    ri.Rod: list(END_OF),
    ri.RigidMass: ["free", "pushed"],
    ri.Wall: ["free"],
}
"""Kinds of ends beside a last body."""


@st.composite
def systems(draw):
    """Rows of one to three rods and masses, perhaps before a wall, with any laws, ends
    and gravity.
    """
    bodies = draw(st.lists(st.one_of(RODS, MASSES), min_size=1, max_size=3))
    if draw(st.booleans()):
        bodies.append(ri.Wall(draw(signed())))
    laws = []
    gaps = []
    for left, right in pairwise(bodies):
        law, gap = draw(laws_between(left, right))
        laws.append(law)
        gaps.append(gap)
    ends = []
    for body in (bodies[0], bodies[-1]):
        choices = [END_OF[kind] for kind in KINDS_OF_ENDS[type(body)]]
        ends.append(draw(st.one_of(*choices)))
    return ri.System(bodies, gaps, laws, gravity=draw(signed()), ends=ends)


def test_no_class_of_the_model_is_left_out():
    assert set(LAWS) == set(CONTACT_LAWS)
    assert set(END_OF) == set(ENDS)
    assert set(BODIES) == {"rod", "mass", "wall"}


@given(systems())
def test_a_system_comes_back_equal(system):
    again = parse_case(format_case(system)).system

    assert again == system
    assert again.digest == system.digest
    assert repr(again) == repr(system)


FLOATS = st.floats(allow_nan=True, allow_infinity=True)
ERRORS = st.dictionaries(st.sampled_from(MEASURES), st.floats(0, np.inf))
TEXTS = st.text(st.characters(exclude_categories=["Cs"]))


NUMBERS = st.fixed_dictionaries(dict.fromkeys(names_of_numbers(2), FLOATS))
"""{name: value} of all numbers of the outcome of a row of two bodies."""


@given(NUMBERS, ERRORS, st.booleans(), TEXTS)
def test_an_outcome_comes_back_equal(numbers, errors, final, text):
    """A random saved result, also with nan, is written into a case file and read: its
    repr is the same.
    """
    result = SavedResult(
        version=text,
        method=text,
        stopped_by=text,
        status=text,
        final=final,
        numbers=numbers,
        accuracy=errors,
    )
    rod = ri.Rod(1.0, area=1.0, material=ri.materials.steel)
    case = ri.Case(ri.System([rod, ri.Wall()]), result=result)

    again = parse_case(format_case(case)).result

    # Their texts are compared, since nan is not equal to itself.
    assert repr(again) == repr(result)
