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

    It is at rest, without force, with the given gaps. The equations of a step are
    (M + J + D/2) dv = forces, see `grid_kernel`: a cell adds J + D/2 to the diagonal of
    both of its nodes, and to the off-diagonal between them; half of the impedance of an
    endless bar and of the damping of soil are on the diagonal.
    """
    row = mesh.row
    n = len(mesh.mass)
    cells = mesh.cells
    # Time is counted in steps, see `records`: M becomes M/h,
    # and a stiffness k becomes k h.
    mass = mesh.mass / step
    impedance = _end_impedances(mesh)
    mass[mesh.ends] += impedance / 2
    off_diagonal = off_diagonal_of(mesh, step)
    diagonal = mass + off_diagonal[:-1] + off_diagonal[1:]
    soil = soil_of(mesh, step)
    loaded_diagonal = diagonal + np.bincount(soil["node"], soil["damping"] / 2, n)
    factors = factorise(mesh, loaded_diagonal, off_diagonal)
    responses = responses_to_pushes(mesh, factors)
    coupling_share = quotient(cells.coupling**2, cells.stiffness)
    return Grid(
        run=filled(
            records.RUN,
            1,
            velocity_tolerance=VELOCITY_RTOL * row.scale,
            has_radial_strain=mesh.has_radial_strain,
            is_implicit=mesh.implicit or len(soil) > 0,
            shafts=len(shaft_bodies(row)),
            soil_changes_equations=bool(
                np.any(soil["is_smith"] * soil["damping_factor"])
            ),
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
    """Off-diagonal entries of the matrix M + J + D/2, kg/s [cell].

    They have the opposite sign.
    """
    return np.asarray(mesh.lateral_inertia / step + mesh.viscous / 2)


def _end_impedances(mesh: Mesh) -> Array:
    """Impedances of semi-infinite bars beyond both ends, kg/s [end]; 0 without a bar.

    They are sqrt(E A rho A) = sqrt((E A/dx) (rho A dx)) of the first and the last cell
    of the row. E A/dx is the relaxed stiffness, as slow waves feel it.
    """
    cells = mesh.end_cells
    endless = [kind == "absorbing" for kind, _ in mesh.row.boundaries]
    impedances = np.sqrt(mesh.cells.relaxed_stiffness[cells] * mesh.cell_mass[cells])
    return np.where(endless, impedances, 0.0)


def factorise(mesh: Mesh, diagonal: Array, off_diagonal: Array) -> Factors:
    """LU factors of the equations with these entries, see `elimination_kernel`."""
    n = len(diagonal)
    factors = ([0.0] * n, [0.0] * n, [0.0] * n)
    elimination.factor(
        off_diagonal.tolist(), diagonal.tolist(), mesh.is_prescribed.tolist(), *factors
    )
    return Factors(*map(np.array, factors))


def velocity_changes(factors: Factors, forces: Any) -> Array:
    """Changes of velocity in a step by forces on the nodes, N; m/s [node].

    They solve the equations of the step. At nodes whose velocity is prescribed `forces`
    has the change itself.
    """
    x = np.array(forces, float)
    elimination.substitute(*factors, x)
    return x


def responses_to_pushes(mesh: Mesh, factors: Factors) -> Responses:
    """Velocities by unit forces on the ends of all pieces.

    They solve the equations with these factors. Forces on all pieces act at once, as
    pieces are not coupled. Prescribed nodes take none.
    """
    n = len(mesh.mass)
    unit_force = np.where(mesh.is_prescribed == 0, 1.0, 0.0)
    on_first = np.zeros(n)
    on_first[mesh.starts] = unit_force[mesh.starts]
    on_last = np.zeros(n)
    on_last[mesh.stops] = unit_force[mesh.stops]
    return Responses(
        velocity_changes(factors, on_first), velocity_changes(factors, on_last)
    )


# Links --------------------------------------------------------------------------------


def _links(mesh: Mesh, step: float, responses: Responses) -> Array:
    """Links between neighbouring pieces at t = 0, [link] `records.LINK`.

    Time is counted in steps. Links that are coupled make a chain, whose forces are
    solved together: `chain_end` is the last link of a chain at its first link, and NONE
    at the others.

    Raises
    ------
    InvalidModel
        If a contact is so soft in steps that its forces vanish.
    """
    laws = as_records([mesh.row.links[i] for i in mesh.touching], LINK)
    count = len(laws)
    in_time_steps = in_steps(laws, step)
    _refuse_soft(laws, in_time_steps["stiffness"], step)
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
    # Two links are coupled by a piece of one node, or by one that moves as a whole.
    # `left` of a link is the last node of the piece before it, whose first node the
    # link before pushes. Half of a velocity counts, as a closing is the mean of those
    # before and after the step.
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

    `laws` are the links with time in seconds, `stiffness` is theirs with time in steps
    of `step`, s.
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

    `coupling` is the mobility that a link shares with the one before it; 0 begins a
    chain.
    """
    begins = np.flatnonzero(coupling == 0)
    chain_end = np.full(len(coupling), NONE)
    # A chain ends before the next one begins.
    chain_end[begins] = np.append(begins[1:], len(coupling)) - 1
    return chain_end


# What drives the ends -----------------------------------------------------------------


def boundary_values(mesh: Mesh, step: float, side: int, steps: int) -> Array:
    """Value that is prescribed at an end in each of the first `steps` steps, [step].

    It is a force, N, a wave, m/s, or the velocity at the end of the step in the frame,
    m/s. `side` is 0 on the left, 1 on the right; `step` in s.
    """
    kind, value = mesh.row.boundaries[side]
    if kind == "velocity":
        times = step * np.arange(1, steps + 1)
        return boundary_velocity(mesh.row, step, value, times)
    # At each kick the mean over two steps, which waves can follow: four half steps
    # about the middle of the step. Before t = 0 the value is as in the first half step.
    halves = averages(value, step / 2 * np.arange(2 * steps + 2), 0.0)  # half steps
    around = np.concatenate((halves[:1], halves))
    first = around[:-3:2]  # half steps about the kick of each step
    second = around[1:-2:2]
    third = around[2:-1:2]
    fourth = around[3::2]
    pushes = np.asarray((first + second + third + fourth) / 4)
    if kind == "absorbing":
        return np.asarray(wave_of_strain(mesh.row, side) * pushes)
    return pushes


def boundary_velocity(row: Row, step: float, value: Any, t: Array) -> Array:
    """Velocity of a wall or a driven end in the frame, which falls, m/s.

    It is averaged over a step about each time; about t = 0 over the half step after it,
    as there is no value before. Times t, s, are a step apart.
    """
    edges = np.append(t - step / 2, t[-1:] + step / 2)
    # Duration of the value. After their last border polynomials in time are constant:
    # any time after it would do.
    end = max(edges.max(initial=0.0), 2 * latest_border(value))
    velocity = averages(value, np.maximum(edges, 0.0), end)
    return np.asarray(velocity - row.frame - row.system.gravity * t)
