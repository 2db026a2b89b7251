"""The constants of the equations of a grid, as arrays of the kernels.

They follow from a mesh and a time step.
"""

from typing import Any, NamedTuple

import numpy as np

from ...model.frozen import InvalidModel
from ...model.profiles import averages, latest_border
from ..link import LINK, in_steps
from ..record_lists import as_records
from ..row import Array, Row
from ..scales import wave_of_strain
from ..states import BoundaryKind
from . import elimination_kernel as elimination
from . import records
from .mesh import Mesh, quotient
from .records import NONE, Grid, filled
from .soil import ground_velocities, shaft_bodies, soil_of

SMALLEST_STIFFNESS = 2.0**-800
"""Smallest stiffness of a contact with time in steps: below it forces underflow."""
VELOCITY_RTOL = 2.0**-40
"""Fraction of the velocity scale that may be round-off of many steps.

Closing velocities below it count as 0.
"""
KINDS = {
    "none": BoundaryKind.STEADY,
    "force": BoundaryKind.PUSHED,
    "velocity": BoundaryKind.MOVED,
    "absorbing": BoundaryKind.ENDLESS,
}
"""Kinds of ends, by the names of `Row.boundaries`."""


class Factors(NamedTuple):
    """LU factors of the equations of a step, see `elimination_kernel`, [node] each."""

    lower: Array
    inverse_diagonal: Array
    upper: Array


class Responses(NamedTuple):
    """Velocity changes in a step by unit forces on ends of pieces, (m/s)/N [node]."""

    by_first: Array  # by a unit force on the first node of each piece
    by_last: Array  # by a unit force on the last node of each piece


def grid_of(mesh: Mesh, step: float) -> Grid:
    """Make the grid of a mesh for time steps of `step`, s.

    The grid is at rest and without tension. Its links have the gaps of the row, and
    soil has its resistance at t = 0. Time is counted in steps, see `records`. The
    equations of a step are (M + J + D/2) dv = forces, see `grid_kernel`. A cell adds
    its J + D/2 to the diagonal at both of its nodes, and subtracts it off the diagonal.
    The diagonal also has half of the impedance of a semi-infinite bar and half of the
    damping of soil. A contact that is too soft for the step raises InvalidModel.
    """
    row = mesh.row
    n = len(mesh.mass)  # number of nodes; there is one cell more
    cells = mesh.cells
    impedance = _end_impedances(mesh)
    # Time is counted in steps h: masses M and inertias J become M/h and J/h, and a
    # stiffness k becomes k h; impedances and dashpots are not changed.
    inertia = mesh.mass / step
    # A semi-infinite bar pushes with Z (wave - v). The mean v over the step is the old
    # velocity plus dv/2, so Z/2 belongs to dv.
    inertia[mesh.ends] += impedance / 2
    off_diagonal = off_diagonal_of(mesh, step)
    # Node i lies between the cells i and i + 1.
    diagonal = inertia + off_diagonal[:-1] + off_diagonal[1:]
    soil = soil_of(mesh, step)
    # Smith's damping is proportional to the resistance: it changes from step to step.
    has_changing_damping = (soil["is_smith"] > 0) & (soil["damping_factor"] > 0)
    # Sum of the damping at each node, [node]; half, as for a semi-infinite bar
    soil_damping = np.bincount(soil["node"], soil["damping"] / 2, n)
    loaded_diagonal = diagonal + soil_damping
    factors = factorise(mesh, loaded_diagonal, off_diagonal)
    responses = responses_to_pushes(mesh, factors)
    coupling_share = quotient(cells.coupling**2, cells.stiffness)  # b^2/k
    return Grid(
        run=filled(
            records.RUN,
            1,
            velocity_tolerance=VELOCITY_RTOL * row.scale,
            has_radial_strain=mesh.has_radial_strain,
            is_implicit=mesh.couples_nodes or len(soil) > 0,
            shaft_count=len(shaft_bodies(row)),
            soil_changes_equations=bool(has_changing_damping.any()),
            **ground_velocities(mesh, step),
        ),
        velocity=np.zeros(n),
        force=np.zeros(n + 1),
        lower=factors.lower,
        inverse_diagonal=factors.inverse_diagonal,
        upper=factors.upper,
        velocity_by_first=responses.by_first,
        velocity_by_last=responses.by_last,
        stiffness=mesh.stiffness * step,
        pieces=filled(records.PIECE, len(mesh.starts), first_node=mesh.starts),
        viscous=mesh.viscous,
        lost=np.zeros(n + 1),
        change=np.zeros(n),
        old_velocity=np.zeros(n),
        radial_strain=np.zeros(n + 1),
        radial_rate=np.zeros(n + 1),
        inverse_radial_inertia=quotient(step, cells.radial_inertia),  # 1/(J/h)
        coupling=cells.coupling * step,
        radial_stiffness=(cells.radial_stiffness - coupling_share) * step,
        tension_share=quotient(cells.coupling, cells.stiffness),  # b h/(k h)
        # Node i lies between the cells i and i + 1; the last cell has no next cell.
        shear=np.append(mesh.shear_stiffness * step, 0.0),
        links=_links(mesh, step, responses),
        ends=filled(
            records.END,
            2,
            kind=[KINDS[kind] for kind, _ in row.boundaries],
            node=mesh.ends,
            impedance=impedance,
        ),
        soil=soil,
        off_diagonal=off_diagonal,
        diagonal=diagonal,
        loaded_diagonal=loaded_diagonal,
        is_prescribed=mesh.is_prescribed,
        recorded_nodes=np.array(mesh.recorded_nodes, np.int64),
        recorded_cells=np.array(mesh.recorded_cells, np.int64),
    )


def off_diagonal_of(mesh: Mesh, step: float) -> Array:
    """Off-diagonal entries of the matrix M + J + D/2 with opposite sign, kg/s [cell].

    An entry is the lateral inertia of the cell divided by `step`, s, plus half of its
    viscosity. No entry is negative.
    """
    return np.asarray(mesh.lateral_inertia / step + mesh.viscous / 2)


def _end_impedances(mesh: Mesh) -> Array:
    """Impedances of semi-infinite bars beyond both ends, kg/s [end]; 0 without a bar.

    The impedance is sqrt(E A rho A) = sqrt((E A/dx) (rho A dx)) of the first or the
    last cell of the row. E A/dx is the relaxed stiffness, that for slow waves.
    """
    end_cells = mesh.end_cells  # indices of the first and the last cell
    has_bar = [kind == "absorbing" for kind, _ in mesh.row.boundaries]
    stiffness = mesh.cells.relaxed_stiffness[end_cells]
    impedances = np.sqrt(stiffness * mesh.cell_mass[end_cells])
    return np.where(has_bar, impedances, 0.0)


def factorise(mesh: Mesh, diagonal: Array, off_diagonal: Array) -> Factors:
    """LU factors of tridiagonal equations of a step, see `elimination_kernel`.

    The matrix has the entries `diagonal` [node] and -`off_diagonal` [cell]. A node
    whose velocity is prescribed in the mesh has the equation x[i] = right side. Nothing
    is changed.
    """
    n = len(diagonal)
    # The kernel runs in plain Python here, where lists are faster than arrays. It fills
    # these three lists.
    lower = [0.0] * n
    inverse_diagonal = [0.0] * n
    upper = [0.0] * n
    elimination.factor(
        off_diagonal.tolist(),
        diagonal.tolist(),
        mesh.is_prescribed.tolist(),
        lower,
        inverse_diagonal,
        upper,
    )
    return Factors(np.array(lower), np.array(inverse_diagonal), np.array(upper))


def velocity_changes(factors: Factors, forces: Any) -> Array:
    """Changes of velocity in a step, m/s [node], by `forces` on the nodes, N [node].

    They solve the equations of the step. At a node whose velocity is prescribed the
    entry of `forces` is the change of velocity itself, m/s. `forces` is not changed.
    """
    x = np.array(forces, float)  # a copy, which becomes the solution
    elimination.substitute(*factors, x)
    return x


def responses_to_pushes(mesh: Mesh, factors: Factors) -> Responses:
    """Velocity changes in a step by unit forces on first or last nodes of pieces.

    They solve the equations with these factors. The unit forces act on all pieces at
    once, as pieces are not coupled. No force acts on a node whose velocity is
    prescribed: the velocities of a piece pushed there stay 0.
    """
    n = len(mesh.mass)
    unit_force = np.where(mesh.is_prescribed == 0, 1.0, 0.0)
    on_first = np.zeros(n)
    on_first[mesh.starts] = unit_force[mesh.starts]
    on_last = np.zeros(n)
    on_last[mesh.stops] = unit_force[mesh.stops]
    return Responses(
        by_first=velocity_changes(factors, on_first),
        by_last=velocity_changes(factors, on_last),
    )


# Links --------------------------------------------------------------------------------


def _links(mesh: Mesh, step: float, responses: Responses) -> Array:
    """Links between neighbouring pieces at t = 0, [link] `records.LINK`.

    Stiffnesses and gaps are those for time in steps; the other fields of the law are
    copied. Nodes, mobilities and chains follow from the mesh and `responses`. Coupled
    links make a chain, whose forces are solved together. `is_closed` is 1 where the gap
    is 0. Forces and closings are 0.

    Raises
    ------
    InvalidModel
        If a contact is so soft in steps that its forces vanish.
    """
    laws = as_records([mesh.row.links[i] for i in mesh.link_nodes], LINK)
    count = len(laws)
    in_time_steps = in_steps(laws, step)  # by name: stiffness and gap
    _refuse_soft(laws, in_time_steps["stiffness"], step)
    # Last node of the piece on the left of each link, first node of the piece on its
    # right
    left = np.array(mesh.stops[:-1], np.int64)
    right = np.array(mesh.starts[1:], np.int64)
    leftmost: Any
    rightmost: Any
    if mesh.couples_nodes:  # a force changes the velocities of its whole piece
        leftmost = mesh.starts[:-1]  # first node of the piece on the left
        rightmost = mesh.stops[1:]  # last node of the piece on the right
    else:  # a force changes the velocity of its node alone
        leftmost = left
        rightmost = right
    # The piece between two links couples them: the force of the link before acts on the
    # first node of the piece and moves its last node, the left node of this link. If
    # nodes are not coupled, only a piece of a single node does so. The closing velocity
    # of a step is the mean of the values before and after it, hence the factor 1/2.
    coupling = np.zeros(count)  # stays 0 for the first link
    coupling[1:] = responses.by_first[left[1:]] / 2
    links: Array = filled(
        records.LINK,
        count,
        chain_end=_chain_ends(coupling),
        left_node=left,
        right_node=right,
        leftmost_node=leftmost,
        rightmost_node=rightmost,
        self_mobility=responses.by_last[left] / 2 + responses.by_first[right] / 2,
        coupling_mobility=coupling,
        is_closed=in_time_steps["gap"] == 0,
    )
    # All fields of the laws; those for time in steps then replace stiffness and gap.
    for name in laws.dtype.names:
        links[name] = laws[name]
    for name, values in in_time_steps.items():
        links[name] = values
    return links


def _refuse_soft(laws: Array, stiffness: Array, step: float) -> None:
    """Raise InvalidModel if a contact is so soft in steps that its forces vanish.

    `laws` are the links with time in seconds. `stiffness` [link] is their stiffness
    with time in steps of `step`, s; below `SMALLEST_STIFFNESS` it is too small. Links
    without a stiffness (0), as rigid contacts, are not checked. The error states the
    law of the first contact that is too soft.
    """
    k = laws["stiffness"]
    p = laws["exponent"]
    is_soft = (k > 0) & (stiffness < SMALLEST_STIFFNESS)
    for i in np.flatnonzero(is_soft):  # the first one raises
        message = (
            f"a force of {float(k[i])!r} times the indentation to the {p[i]:g} "
            f"vanishes in steps of {step:.3g} s; use a lower power"
        )
        raise InvalidModel([("contacts", message)])


def _chain_ends(coupling: Array) -> Array:
    """Last link of each chain, stored at its first link; NONE at other links, [link].

    `coupling` [link] is the mobility that a link shares with the link before it. A
    chain begins at each link where it is 0, as at the first of all links.
    """
    begins = np.flatnonzero(coupling == 0)  # first link of each chain
    chain_end = np.full(len(coupling), NONE)
    # A chain ends one link before the next chain begins, the last chain with the last
    # link.
    next_begins = np.append(begins[1:], len(coupling))
    chain_end[begins] = next_begins - 1
    return chain_end


# What drives the ends -----------------------------------------------------------------


def boundary_values(mesh: Mesh, step: float, side: int, steps: int) -> Array:
    """Value that is prescribed at an end in each of the first `steps` steps, [step].

    `side` is 0 on the left and 1 on the right; `step` is in s. At a moved end the value
    is the velocity in the frame, m/s, averaged over one step about the end of each
    step. At a pushed end it is the force, N, and at a semi-infinite bar the incoming
    wave, m/s; both are averaged over two steps about the middle of each step. The mean
    of the first step reaches half a step before t = 0, where the value of the first
    half step is taken. At a free end the value is 0.
    """
    kind, value = mesh.row.boundaries[side]
    if kind == "velocity":
        times = step * np.arange(1, steps + 1)
        return boundary_velocity(mesh.row, step, value, times)
    # The kick of a step is in its middle. The value is averaged over two steps about
    # the kick, that is four half steps: waves on the grid can follow such a mean. The
    # half steps between these edges go from t = 0 to half a step after the last step.
    edges = step / 2 * np.arange(2 * steps + 2)
    # Only polynomials need the length; forces and strains in time are never these.
    after_start = averages(value, edges, length=0.0)  # [half step]
    # In the half step before t = 0 the value is that of the first half step.
    half_steps = np.concatenate((after_start[:1], after_start))
    # Step i takes the entries 2 i to 2 i + 3. So each slice begins one entry later than
    # the slice before, and takes every second entry.
    first = half_steps[:-3:2]
    second = half_steps[1:-2:2]
    third = half_steps[2:-1:2]
    fourth = half_steps[3::2]
    means = np.asarray((first + second + third + fourth) / 4)
    if kind == "absorbing":  # the value is the strain of the wave
        return np.asarray(wave_of_strain(mesh.row, side) * means)
    return means


def boundary_velocity(row: Row, step: float, value: Any, t: Array) -> Array:
    """Velocity of a wall or a moved end at the times t in the frame, m/s [time].

    The velocity `value` in the laboratory is averaged over one step about each time; at
    t = 0 over the half step after it, as no value is given before. The velocity of the
    frame, row.frame + gravity t, is subtracted. The times t, s, are one step apart.
    Without times the result is empty.
    """
    # Edges of the intervals about the times: the left ones, and the last right one
    edges = np.append(t - step / 2, t[-1:] + step / 2)
    # Only polynomials need a `length`: any time after all edges and after their last
    # border, from which on they are constant.
    length = max(edges.max(initial=0.0), 2 * latest_border(value))
    from_start = np.maximum(edges, 0.0)  # no value is given before t = 0
    velocity = averages(value, from_start, length)
    return np.asarray(velocity - row.frame - row.system.gravity * t)
