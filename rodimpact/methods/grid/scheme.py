"""The constants of the equations of a grid, as arrays of the kernels.

They follow from a mesh and a step.
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
"""Smallest stiffness of a contact with time in steps: below it forces vanish."""
VELOCITY_RTOL = 2.0**-40
"""Part of the velocity scale below which contacts graze: round-off of many steps."""
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
    """Velocities in a step by unit forces on all ends of pieces, m/s per N [node]."""

    by_first: Array  # on the first nodes
    by_last: Array  # on the last nodes


def grid_of(mesh: Mesh, step: float) -> Grid:
    """Make the grid of a mesh for steps of `step`, s.

    It is at rest, without tension, with the given gaps; soil has its resistance at
    t = 0. Time is counted in steps, see `records`. The equations of a step are
    (M + J + D/2) dv = forces, see `grid_kernel`: a cell adds J + D/2 to the diagonal of
    both of its nodes, and to the off-diagonal between them; half of the impedance of an
    endless bar and of the damping of soil are on the diagonal. A contact that is too
    soft for the step raises InvalidModel.
    """
    row = mesh.row
    n = len(mesh.mass)
    cells = mesh.cells
    # Time is counted in steps: M becomes M/h, and a stiffness k becomes k h.
    impedance = _end_impedances(mesh)
    inertia = mesh.mass / step
    # An endless bar pushes with Z (wave - v), v the mean over the step: half of dv.
    inertia[mesh.ends] += impedance / 2
    off_diagonal = off_diagonal_of(mesh, step)
    # Node i lies between the cells i and i + 1.
    diagonal = inertia + off_diagonal[:-1] + off_diagonal[1:]
    soil = soil_of(mesh, step)
    # Smith's damping follows the resistance, and changes the diagonal.
    has_changing_damping = (soil["is_smith"] > 0) & (soil["damping_factor"] > 0)
    soil_damping = np.bincount(soil["node"], soil["damping"] / 2, n)  # [node]
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
            is_implicit=mesh.implicit or len(soil) > 0,
            shafts=len(shaft_bodies(row)),
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
        inverse_radial_inertia=quotient(step, cells.radial_inertia),
        coupling=cells.coupling * step,
        radial_stiffness=(cells.radial_stiffness - coupling_share) * step,
        tension_share=quotient(cells.coupling, cells.stiffness),
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
        watched=np.array(mesh.watched, np.int64),
        pulled=np.array(mesh.pulled, np.int64),
    )


def off_diagonal_of(mesh: Mesh, step: float) -> Array:
    """Off-diagonal entries of the matrix M + J + D/2 with opposite sign, kg/s [cell].

    They are not negative: lateral inertia over the step, s, plus half of the viscosity.
    """
    return np.asarray(mesh.lateral_inertia / step + mesh.viscous / 2)


def _end_impedances(mesh: Mesh) -> Array:
    """Impedances of semi-infinite bars beyond both ends, kg/s [end]; 0 without a bar.

    They are sqrt(E A rho A) = sqrt((E A/dx) (rho A dx)) of the first and the last cell
    of the row. E A/dx is the relaxed stiffness, as slow waves feel it.
    """
    cells = mesh.end_cells
    has_bar = [kind == "absorbing" for kind, _ in mesh.row.boundaries]
    impedances = np.sqrt(mesh.cells.relaxed_stiffness[cells] * mesh.cell_mass[cells])
    return np.where(has_bar, impedances, 0.0)


def factorise(mesh: Mesh, diagonal: Array, off_diagonal: Array) -> Factors:
    """LU factors of the equations with these entries, see `elimination_kernel`.

    `diagonal` is [node]; `off_diagonal` [cell] has the opposite sign. Nodes whose
    velocity is prescribed in the mesh have the equation x[i] = right side.
    """
    n = len(diagonal)
    # The kernel runs in plain Python here, faster on lists than on arrays. It fills
    # these three.
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

    They solve the equations of the step. At nodes whose velocity is prescribed `forces`
    has the change itself. `forces` are not changed.
    """
    x = np.array(forces, float)
    elimination.substitute(*factors, x)
    return x


def responses_to_pushes(mesh: Mesh, factors: Factors) -> Responses:
    """Velocities that unit forces on first or last nodes of pieces give in a step.

    They solve the equations with these factors. Forces on all pieces act at once, as
    pieces are not coupled. A node whose velocity is prescribed takes no force: a piece
    pushed there stays at 0.
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

    Time is counted in steps: stiffnesses and gaps are scaled, the other fields of the
    law are copied. Nodes, mobilities and chains follow from the mesh and `responses`;
    links that are coupled make a chain, whose forces are solved together. `is_closed`
    is set where the gap is 0. Forces and closings are 0.

    Raises
    ------
    InvalidModel
        If a contact is so soft in steps that its forces vanish.
    """
    laws = as_records([mesh.row.links[i] for i in mesh.touching], LINK)
    count = len(laws)
    in_time_steps = in_steps(laws, step)  # stiffness and gap
    _refuse_soft(laws, in_time_steps["stiffness"], step)
    # Last node of the piece on the left of each link, first node of that on its right
    left = np.array(mesh.stops[:-1], np.int64)
    right = np.array(mesh.starts[1:], np.int64)
    leftmost: Any
    rightmost: Any
    if mesh.implicit:  # a force changes the velocities of its whole piece in a step
        leftmost = mesh.starts[:-1]
        rightmost = mesh.stops[1:]
    else:  # or that of its node alone
        leftmost = left
        rightmost = right
    # A link is coupled to the one before it by the piece between both: a force in that
    # one, on the first node of the piece, moves its last node, `left` of this one. In
    # explicit steps only a piece of a single node does. Half of a velocity counts, as a
    # closing is the mean of those before and after the step.
    coupling = np.zeros(count)
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
    for name in laws.dtype.names:
        links[name] = laws[name]
    for name, values in in_time_steps.items():
        links[name] = values
    return links


def _refuse_soft(laws: Array, stiffness: Array, step: float) -> None:
    """Raise InvalidModel if a contact is so soft in steps that its forces vanish.

    `laws` are the links with time in seconds, `stiffness` [link] is theirs with time in
    steps of `step`, s; below `SMALLEST_STIFFNESS` it is too small. A stiffness of 0, as
    of a rigid contact, is none. The first such contact is told.
    """
    k = laws["stiffness"]
    p = laws["exponent"]
    for i in np.flatnonzero((k > 0) & (stiffness < SMALLEST_STIFFNESS)):
        message = (
            f"a force of {float(k[i])!r} times the indentation to the {p[i]:g} "
            f"vanishes in steps of {step:.3g} s; use a lower power"
        )
        raise InvalidModel([("contacts", message)])


def _chain_ends(coupling: Array) -> Array:
    """Last link of each chain, at its first link; NONE at the other links, [link].

    `coupling` [link] is the mobility that a link shares with the one before it: where
    it is 0 a chain begins, as at the first of all links.
    """
    begins = np.flatnonzero(coupling == 0)
    chain_end = np.full(len(coupling), NONE)
    # A chain ends before the next one begins, the last one with the last link.
    next_begins = np.append(begins[1:], len(coupling))
    chain_end[begins] = next_begins - 1
    return chain_end


# What drives the ends -----------------------------------------------------------------


def boundary_values(mesh: Mesh, step: float, side: int, steps: int) -> Array:
    """Value that is prescribed at an end in each of the first `steps` steps, [step].

    `side` is 0 on the left, 1 on the right; `step` in s. Of a moved end it is the
    velocity in the frame, m/s, as a mean over a step about the end of the step. Of a
    pushed end it is the force, N, of an endless bar the wave, m/s, both as means over
    two steps about the middle of the step. Of a free end it is 0.
    """
    kind, value = mesh.row.boundaries[side]
    if kind == "velocity":
        times = step * np.arange(1, steps + 1)
        return boundary_velocity(mesh.row, step, value, times)
    # The kick of a step is in its middle. Waves on the grid can follow means over two
    # steps about it: over four half steps. In time, values need no `length`.
    edges = step / 2 * np.arange(2 * steps + 2)  # of half steps from t = 0 on
    after_start = averages(value, edges, length=0.0)  # [half step]
    # Before t = 0 the value is as in the first half step.
    half_steps = np.concatenate((after_start[:1], after_start))
    # Step i has the entries 2 i to 2 i + 3.
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

    `value` is the velocity in the laboratory, of which the mean over a step about each
    time counts; about t = 0 that over the half step after it, as there is no value
    before. The velocity of the frame, row.frame + gravity t, is subtracted. Times t, s,
    are a step apart; without times the result is empty.
    """
    edges = np.append(t - step / 2, t[-1:] + step / 2)
    # Polynomials in time are constant after their last border. They need a `length` in
    # time, any one after this border and all edges; others do without.
    length = max(edges.max(initial=0.0), 2 * latest_border(value))
    velocity = averages(value, np.maximum(edges, 0.0), length)
    return np.asarray(velocity - row.frame - row.system.gravity * t)
