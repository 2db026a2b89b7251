"""Scales of a row: the frame and the scale of velocities, and bounds of the numbers.

In a family numbers are arrays over the members, so that no branch here depends on a
number. The web page has the functions before the section "Bounds" as JavaScript.
"""

import sys
from typing import Any

import numpy as np

from ..model import InvalidModel
from ..model.profiles import extremes
from .link import Law

SMALLEST_FLOAT = sys.float_info.min
LARGEST_FLOAT = sys.float_info.max
SUM_MARGIN = 2.0**60  # factor to stay away from both, for sums over steps and cells
LARGEST_STIFFNESS = 2.0**80
"""Ratio of a contact stiffness to that of the rods above which it counts as rigid.

The stiffness of the rods is the least impedance over the longest transit time.
"""


def largest(values: Any) -> Any:
    """Largest of a list of one or more numbers.

    If any of them is an array of a family, the result is an array with the largest
    number of each member.
    """
    result = values[0]
    for value in values[1:]:
        if isinstance(value, float) and isinstance(result, float):
            result = max(result, value)
        else:
            result = np.maximum(result, value)
    return result


def smallest(values: Any) -> Any:
    """Smallest of a list of one or more numbers.

    If any of them is an array of a family, the result is an array with the smallest
    number of each member.
    """
    return -largest([-value for value in values])


def velocities_of(row: Any) -> list[Any]:
    """Velocities of masses, rods and walls at t = 0 and of fixed and moved ends, m/s.

    If a velocity varies, along a rod or in time, the list has its least and its largest
    value. Masses bonded together have one entry, the velocity of their centre of mass.
    """
    velocities = [*row.mass_velocity]
    for body in row.system.bodies:
        if body.kind != "mass":
            velocities.extend(extremes(body.velocity))
    for kind, value in row.boundaries:
        if kind == "velocity":
            velocities.extend(extremes(value))
    return velocities


def frame_of(row: Any) -> Any:
    """Velocity of the frame in which waves are counted, m/s.

    It is the mean velocity of the walls. Without walls it is the mean of the least and
    the largest velocity in `velocities_of`.
    """
    walls = [body.velocity for body in row.system.bodies if body.kind == "wall"]
    if len(walls) == 0:
        velocities = velocities_of(row)
        # The sum of the two could overflow, hence the sum of the halves.
        return smallest(velocities) / 2 + largest(velocities) / 2
    return sum(walls) / len(walls)


def wave_of_strain(row: Any, side: int) -> Any:
    """Ratio of wave, m/s, to strain for a wave that enters through an end.

    `side` is 0 for the left end and 1 for the right end. A single wave has v = -c
    strain if it travels to the right, and v = c strain if it travels to the left; as
    v = (a + b)/2, the wave is 2 v.
    """
    end_index = side * (len(row.segments) - 1)  # first or last segment
    end_segment = row.segments[end_index]
    return (4 * side - 2) * end_segment.wave_speed  # -2 c on the left, 2 c on the right


def least_impedance(row: Any) -> Any:
    """Smallest impedance rho c A of all segments, at their least area A, kg/s."""
    impedances = []
    for s in row.segments:
        least_area = extremes(s.area)[0]  # an area may vary along the segment
        impedances.append(s.material.density * s.wave_speed * least_area)
    return smallest(impedances)


def scale_of(row: Any) -> Any:
    """Scale of velocities of a row with rods, m/s; 0 if nothing moves or acts.

    It is a sum of four terms: the spread of the velocities of bodies and ends; the
    largest of c times strain at t = 0 and 2 c times strain of an incoming wave; the
    largest force of a pushed end, a joint or an overlap at t = 0, over the least
    impedance; and g times the longest transit time.
    """
    strain_velocities = [0.0]  # velocities due to strains, m/s
    for body in row.system.bodies:
        if body.kind == "rod":
            c = largest([s.wave_speed for s in body.segments])
            for strain in extremes(body.strain):
                strain_velocities.append(c * abs(strain))
    forces = [0.0]  # N
    for side, (kind, value) in enumerate(row.boundaries):
        if kind == "force":
            for force in extremes(value):
                forces.append(abs(force))
        elif kind == "absorbing":
            factor = wave_of_strain(row, side)  # 2 c, on the left -2 c
            for strain in extremes(value):
                strain_velocities.append(abs(strain * factor))
    for link in row.links:
        if link.law == Law.JOINT:
            forces.append(abs(link.stiffness * link.stretch))
        elif link.law >= Law.SPRING:
            # A compliant contact may begin with an overlap, a gap below 0. For a gap
            # of 0, -gap would be -0.0.
            overlap = np.maximum(0.0 - link.gap, 0.0)
            forces.append(link.stiffness * overlap**link.exponent)
    transit = largest([s.transit_time for s in row.segments])
    fall = abs(row.system.gravity) * transit  # velocity due to gravity, m/s
    velocities = velocities_of(row)
    spread = largest(velocities) - smallest(velocities)
    force_velocity = largest(forces) / least_impedance(row)
    return spread + largest(strain_velocities) + force_velocity + fall


def scale_without_rods(row: Any, time: Any) -> Any:
    """Scale of velocities of a row without rods, m/s; 0 if nothing moves or acts.

    It is a sum: the spread of the velocities, g times `time`, F time/m for the force F
    of each pushed end, and sqrt(k d^(p + 1)/m) for each joint or compliant contact with
    the stretch or overlap d at t = 0. m is the least mass.

    Parameters
    ----------
    row : Row
    time : float or array
        Time in which forces act, s.
    """
    if row.masses:
        least_mass = smallest(row.masses)
    else:
        least_mass = np.inf  # all masses are bonded to walls, and cannot move
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

    The first one is that energies or forces overflow or vanish, see `energy_problem`.
    The others, one for each contact with a law, are that the contact is so stiff that
    its indentation is lost in round-off, see `stiffness_problems`. A number that is nan
    because of an overflow counts as a problem.

    Returns
    -------
    list of (bool or array, str, str)
        Whether the problem exists, its path and its sentence. In a family the first is
        an array of bool.
    """
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        return [energy_problem(row), *stiffness_problems(row)]


def energy_problem(row: Any) -> tuple[Any, str, str]:
    """Whether energies or forces of a row overflow or vanish, with path and sentence.

    The first result is True if they do; in a family it is an array of bool. With the
    velocity scale v, the heaviest mass m and the largest impedance Z, the energy m v^2
    and the square of the force Z v must lie between the smallest and the largest float,
    away from both by the factor `SUM_MARGIN`. A scale of 0 is no problem. The path is
    "bodies".
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

    The stiffness of the contact, k d^(p - 1) with d the velocity scale times the
    longest transit time, is divided by that of the rods, the least impedance over this
    transit time. The first result is True if the ratio exceeds `LARGEST_STIFFNESS` or
    is nan; in a family it is an array of bool.
    """
    transit: Any = largest([s.transit_time for s in row.segments])
    problems = []
    for k, i in row.unbonded_links.items():  # contact k is link i
        link = row.links[i]
        # k d^(p - 1), over the stiffness impedance/transit of the rods
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
        # For nan, `less_equal` is False, so that nan counts as rigid.
        is_rigid = ~np.less_equal(stiffness_ratio, LARGEST_STIFFNESS)
        problems.append((is_rigid, f"contacts.{k}.stiffness", message))
    return problems


def check_scales(row: Any) -> None:
    """Raise InvalidModel if numbers of a single row are out of bounds.

    If energies or forces overflow or vanish, the error has only this problem.
    Otherwise it has one for each contact that is as good as rigid.
    """
    problems = []
    for is_beyond, path, message in beyond_scales(row):
        if is_beyond:
            problems.append((path, message))
    if len(problems) == 0:
        return
    # If energies or forces overflow, the stiffness ratios of the contacts are
    # meaningless. This problem comes first.
    first_path, _ = problems[0]
    if first_path == "bodies":
        raise InvalidModel(problems[:1])
    raise InvalidModel(problems)
