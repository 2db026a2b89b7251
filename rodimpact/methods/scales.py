"""Scales of a row.

They are the frame and the scale in which methods count velocities, and their bounds. In
a family numbers are arrays, so nothing here is decided by one of them. The page has the
functions without numpy's errors as JavaScript.
"""

import sys
from typing import Any

import numpy as np

from ..model import InvalidModel
from ..model.profiles import extremes
from .link import Law

SMALLEST_FLOAT = sys.float_info.min
LARGEST_FLOAT = sys.float_info.max
SUM_MARGIN = 2.0**60  # distance from both, for sums over steps and cells
LARGEST_STIFFNESS = 2.0**80
"""Contact stiffness, times transit time over impedance, beyond which it is rigid."""


def largest(values: Any) -> Any:
    """Largest of one or more numbers.

    It is an array with the largest of each member if any of them is an array of a
    family.
    """
    result = values[0]
    for value in values[1:]:
        if isinstance(value, float) and isinstance(result, float):
            result = max(result, value)
        else:
            result = np.maximum(result, value)
    return result


def smallest(values: Any) -> Any:
    """Smallest of some numbers.

    There is one for each member, if any is an array of a family.
    """
    return -largest([-value for value in values])


def velocities_of(row: Any) -> list[Any]:
    """Velocities of masses, rods and walls at t = 0 and of fixed and moved ends, m/s.

    Where a velocity varies, along a rod or in time, its least and its largest value are
    in the list.
    """
    velocities = [*row.mass_velocity]  # masses bonded together have their mean
    for body in row.system.bodies:
        if body.kind != "mass":
            velocities.extend(extremes(body.velocity))
    for kind, value in row.boundaries:
        if kind == "velocity":
            velocities.extend(extremes(value))
    return velocities


def frame_of(row: Any) -> Any:
    """Velocity of the frame, m/s.

    It is the mean velocity of the walls. Without walls it is the middle between the
    least and the largest of `velocities_of`.
    """
    walls = [body.velocity for body in row.system.bodies if body.kind == "wall"]
    if len(walls) == 0:
        velocities = velocities_of(row)
        # Halves are added, as a sum may overflow.
        return smallest(velocities) / 2 + largest(velocities) / 2
    return sum(walls) / len(walls)


def wave_of_strain(row: Any, side: int) -> Any:
    """Wave, m/s, over strain of a wave that comes in through an end.

    The end is the left (0) or the right one (1). A wave alone has v = -c strain to the
    right and c strain to the left, and the wave is 2 v.
    """
    first_or_last = side * (len(row.segments) - 1)
    end_segment = row.segments[first_or_last]
    return (4 * side - 2) * end_segment.wave_speed  # -2 c on the left, 2 c on the right


def least_impedance(row: Any) -> Any:
    """Smallest impedance rho c A of all segments, at their least area A, kg/s."""
    impedances = []
    for s in row.segments:
        least_area = extremes(s.area)[0]  # an area may vary along the segment
        impedances.append(s.material.density * s.wave_speed * least_area)
    return smallest(impedances)


def scale_of(row: Any) -> Any:
    """Scale of velocities of a row with rods, m/s; 0 where nothing moves or acts.

    It is the spread of the velocities, plus c times the largest strain at t = 0 or 2 c
    times that of an incoming wave, plus the largest force of a pushed end, a joint or
    an overlap at t = 0 over the least impedance, plus g times the longest transit time.
    """
    strained = [0.0]  # velocities that strains make, m/s
    for body in row.system.bodies:
        if body.kind == "rod":
            c = largest([s.wave_speed for s in body.segments])
            for strain in extremes(body.strain):
                strained.append(c * abs(strain))
    pushed = [0.0]  # forces, N
    for side, (kind, value) in enumerate(row.boundaries):
        if kind == "force":
            for force in extremes(value):
                pushed.append(abs(force))
        elif kind == "absorbing":
            factor = wave_of_strain(row, side)  # 2 c, on the left -2 c
            for strain in extremes(value):
                strained.append(abs(strain * factor))
    for link in row.links:
        if link.law == Law.JOINT:
            pushed.append(abs(link.stiffness * link.stretch))
        elif link.law >= Law.SPRING:
            # A compliant contact may begin with an overlap: a gap below 0. A minus
            # alone would make -0.0 of a gap of 0.
            overlap = np.maximum(0.0 - link.gap, 0.0)
            pushed.append(link.stiffness * overlap**link.exponent)
    transit = largest([s.transit_time for s in row.segments])
    fall = abs(row.system.gravity) * transit  # velocity that gravity makes, m/s
    velocities = velocities_of(row)
    spread = largest(velocities) - smallest(velocities)
    return spread + largest(strained) + largest(pushed) / least_impedance(row) + fall


def scale_without_rods(row: Any, time: Any) -> Any:
    """Scale of velocities of a row without rods, m/s; 0 where nothing moves or acts.

    It is the spread of the velocities, plus g times the time, plus the velocities that
    the least mass gets: F time/m from each pushed end, and sqrt(k d^(p + 1)/m) from
    each joint or compliant contact that is stretched or overlaps by d at t = 0.

    Parameters
    ----------
    row : Row
    time : float or array
        Time in which forces act, s.
    """
    if row.masses:
        least_mass = smallest(row.masses)
    else:
        least_mass = np.inf  # all masses are bonded to walls: forces move nothing
    scale = np.abs(row.system.gravity) * time
    for kind, value in row.boundaries:
        if kind == "force":
            scale = scale + largest(np.abs(extremes(value))) * time / least_mass
    velocities = velocities_of(row)
    scale = scale + largest(velocities) - smallest(velocities)
    for link in row.links:
        if link.law == Law.JOINT:
            extension = np.abs(link.stretch)
        elif link.law >= Law.SPRING:
            # A compliant contact may begin with an overlap.
            extension = np.maximum(-np.asarray(link.gap), 0.0)
        else:
            continue  # rigid contacts, bonds and pushes store no energy
        # The energy k d^(p + 1)/(p + 1) becomes m v^2/2. The factor 2/(p + 1) of v^2
        # does not matter for a scale.
        stored = link.stiffness * extension ** (link.exponent + 1)
        scale = scale + np.sqrt(stored / least_mass)
    return scale


# Bounds -------------------------------------------------------------------------------


def beyond_scales(row: Any) -> list[tuple[Any, str, str]]:
    """Possible problems with the numbers of a row.

    Energies or forces overflow or vanish, or a contact is as good as rigid. A contact
    that is too stiff for its law to matter beside these rods loses its indentation in
    round-off. What is nan, as it comes of an overflow, counts as beyond.

    Returns
    -------
    list of (bool or array, str, str)
        Whether there is the problem, its path and its sentence.
    """
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        return [energy_problem(row), *stiffness_problems(row)]


def energy_problem(row: Any) -> tuple[Any, str, str]:
    """Whether energies or forces of a row overflow or vanish, path and sentence.

    The first of the three is True where they do, in a family an array of bool. With the
    velocity scale v, the heaviest mass m and the largest impedance Z, the energy m v^2
    and the square of the force Z v must be between the bounds of floats, and far from
    both. A scale of 0 is no problem. The path is "bodies".
    """
    scale: Any = row.scale
    heaviest: Any = largest([*row.masses, *(s.mass for s in row.segments)])
    impedances = []
    for s in row.segments:
        largest_area = extremes(s.area)[1]
        impedances.append(s.material.density * s.wave_speed * largest_area)
    force = scale * largest(impedances)
    energy = scale * scale * heaviest
    force_squared = force * force
    smaller = np.minimum(energy, force_squared)
    larger = np.maximum(energy, force_squared)
    is_large_enough = np.less(SMALLEST_FLOAT * SUM_MARGIN, smaller)
    is_small_enough = np.less(larger, LARGEST_FLOAT / SUM_MARGIN)
    message = (
        f"velocities and strains of {np.max(scale):.6g} m/s make energies or forces "
        "that overflow or vanish; use smaller or larger ones"
    )
    is_beyond = np.not_equal(scale, 0) & ~(is_large_enough & is_small_enough)
    return is_beyond, "bodies", message


def stiffness_problems(row: Any) -> list[tuple[Any, str, str]]:
    """For each contact with a law: whether it is as good as rigid, path and sentence.

    Its stiffness, k d^(p - 1) at d = velocity scale times longest transit, is compared
    with that of the rods, the least impedance over that transit. Where the ratio
    exceeds `LARGEST_STIFFNESS` or is nan, the first of the three is True, in a family
    an array of bool.
    """
    transit: Any = largest([s.transit_time for s in row.segments])
    problems = []
    for k, i in row.by_law.items():  # contact k is link i
        link = row.links[i]
        # Over the stiffness of the rods, impedance over transit
        stiffness_ratio = (
            link.stiffness
            * (transit / least_impedance(row))
            * np.power(row.scale * transit, np.asarray(link.exponent) - 1)
        )
        rigid_law = "Bonded" if link.law == Law.JOINT else "Rigid"
        message = (
            f"is as good as rigid beside these rods, got {link.stiffness!r}; use "
            f"{rigid_law}()"
        )
        # Not `greater`, which would let nan pass.
        is_rigid = ~np.less_equal(stiffness_ratio, LARGEST_STIFFNESS)
        problems.append((is_rigid, f"contacts.{k}.stiffness", message))
    return problems


def check_scales(row: Any) -> None:
    """Raise InvalidModel if numbers of a single row are out of bounds.

    They overflow or vanish, or a contact is as good as rigid. If numbers overflow or
    vanish, contacts are not reported, else the error has all that are too stiff.
    """
    problems = []
    for is_beyond, path, message in beyond_scales(row):
        if is_beyond:
            problems.append((path, message))
    # The path "bodies" is that of `energy_problem`, which comes first: energies
    # overflow or vanish, and ratios of the contacts say nothing.
    if problems and problems[0][0] == "bodies":
        raise InvalidModel(problems[:1])
    if problems:
        raise InvalidModel(problems)
