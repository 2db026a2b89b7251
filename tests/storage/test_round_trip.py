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


SAMPLED = st.one_of(signed(), st.just(5e-324))
NAMES = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=8)
MATERIALS = st.builds(
    lambda name, modulus, density, more: ri.Material(
        name, youngs_modulus=modulus, density=density, **more
    ),
    st.one_of(
        NAMES, st.sampled_from(["steel", "steel 2", "inf", "nan", "a.b", "'", '"'])
    ),
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


def made_or(plain, kind, *arguments, **more):
    """An object of the model, or `plain` where the arguments do not go together."""
    try:
        return kind(*arguments, **more)
    except ri.InvalidModel:
        return plain


SEGMENTS = st.builds(
    lambda length, material, shape, inertia: made_or(
        ri.Segment(length, material=material, **shape),
        ri.Segment,
        length,
        material=material,
        **shape,
        **inertia,
    ),
    sizes(),
    MATERIALS,
    SHAPES,
    INERTIA,
)


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
RODS = st.builds(
    lambda segments, velocity, strain: made_or(
        ri.Rod(segments=segments),
        ri.Rod,
        segments=segments,
        velocity=velocity,
        strain=strain,
    ),
    st.lists(SEGMENTS, min_size=1, max_size=3),
    ALONG,
    ALONG,
)
MASSES = st.builds(ri.RigidMass, sizes(), velocity=signed())
LAWS = {
    "rigid": st.just(ri.Rigid()),
    "bonded": st.just(ri.Bonded()),
    "joint": st.builds(ri.Joint, sizes(), sizes(), stretch=shares(-1e-3, 1e-3)),
    "spring": st.builds(ri.Spring, sizes()),
    "spring-dashpot": st.builds(ri.SpringDashpot, sizes(), sizes()),
    "hertz": st.one_of(
        st.builds(ri.Hertz, sizes()),
        st.builds(
            lambda radius, material: ri.Hertz.from_radii(
                radius, np.inf, material, right_material=None
            ),
            sizes(),
            MATERIALS.filter(lambda material: material.poisson_ratio is not None),
        ),
    ),
    "hunt-crossley": st.builds(ri.HuntCrossley, sizes(), sizes()),
    "power": st.builds(ri.PowerLaw, sizes(), shares(1, 5)),
    "yielding": st.builds(
        lambda k, force, share: ri.Yielding(k, force, share * k),
        sizes(),
        sizes(),
        shares(0, 0.9),
    ),
    "smith-toe": st.builds(ri.SmithToe, sizes(), sizes(), sizes()),
    "cushion": st.builds(ri.Cushion, sizes(), shares(0.1, 1)),
    "tabulated": st.builds(
        lambda overlaps, forces: ri.Tabulated(
            np.cumsum(overlaps), np.cumsum(forces), unloading=1e30
        ),
        st.lists(sizes(), min_size=3, max_size=3),
        st.lists(sizes(), min_size=3, max_size=3),
    ),
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
    """A law that goes between these bodies, and a gap."""
    law = draw(st.one_of(*LAWS.values()))
    rigid_pair = not isinstance(left, ri.Rod) and not isinstance(right, ri.Rod)
    if rigid_pair and law.law in ("rigid", "bonded"):
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
    """Rows of one to four bodies."""
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


NAMES_OF_NUMBERS = names_of_numbers(2)  # of a row of two bodies
NUMBERS = st.lists(
    FLOATS, min_size=len(NAMES_OF_NUMBERS), max_size=len(NAMES_OF_NUMBERS)
)


@given(NUMBERS, ERRORS, st.booleans(), TEXTS)
def test_an_outcome_comes_back_equal(numbers, errors, final, text):
    numbers = dict(zip(NAMES_OF_NUMBERS, numbers, strict=True))
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
