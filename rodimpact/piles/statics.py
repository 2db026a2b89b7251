"""Equilibrium of a row in soil: displacements from a state without equilibrium.

The row is on the mesh of the method "finite-difference": nodes i with a weight w_i and
the static resistance R_i of soil, and between the nodes i - 1 and i a spring, a cell of
a rod or a contact. From the tensions T_i of the springs follow the displacements u_i
that make the forces balance::

    T_(i+1) + s_(i+1) (u_(i+1) - u_i)
        - T_i - s_i (u_i - u_(i-1)) - R_i - k_i u_i + w_i = 0

with the stiffness s of springs and k of soil that does not yield. A contact is a spring
that cannot pull: where it would, it opens.
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import solveh_banded

from ..methods.grid.mesh import Mesh
from ..methods.grid.soil import shaft_bodies, soil_of
from ..methods.row import Row
from ..methods.row_builder import build_row
from ..methods.signals import Floats
from ..model import Joint, Plastic, Rigid, Rod, System, Wall
from ..model.frozen import InvalidModel, invalid_argument
from ..model.laws import Spring, SpringDashpot
from ..model.profiles import averages

RIGID_STIFFNESS = 1e4
"""Stiffness of a rigid contact, over the largest of a cell or another contact."""
MAX_ROUNDS = 50
"""Largest number of rounds of the search, in which contacts open and close."""
OVERLAP_RTOL = 1e-12
"""Overlap that counts as round-off, over the largest displacement."""
BALANCE_RTOL = 1e-9
"""Net force that counts as round-off, over the largest force, on floating bodies."""
YIELD_RTOL = 1e-9
"""Share by which round-off may raise a resistance above the ultimate one."""


class Contact(NamedTuple):
    """A contact of two bodies as a spring between neighbouring nodes."""

    number: int  # index of the contact in the system
    right_node: int  # the spring lies between this node and the one before
    stiffness: float  # N/m
    overlap: float  # m, minus the gap
    pulls: bool  # whether it can bear tension, as a joint can


@dataclass
class Chain:
    """A row as a chain of nodes and springs.

    Attributes
    ----------
    system : System
    row : Row
    mesh : Mesh
    is_moving : list of bool
        Bodies that move, are walls or are left out: they keep their positions.
    is_fixed : array of bool
        Nodes of these bodies, and nodes without mass or with a prescribed motion
        [node].
    weight : array
        N [node].
    stiffness, tension : array
        Of the cells, N/m and N [cell]; 0 where there is no cell.
    soil : array
        Records of the nodes that soil holds, as in the method.
    contacts : list of Contact
        Contacts of bodies at rest with each other or with a wall.
    """

    system: System
    row: Row
    mesh: Mesh
    is_moving: list[bool]
    is_fixed: Any
    weight: Floats
    stiffness: Floats
    tension: Floats
    soil: Any
    contacts: list[Contact]


class Equilibrium(NamedTuple):
    """The equilibrium of a chain."""

    displacement: Floats  # m, from the state of the chain [node]
    tension: Floats  # of the cells, N [cell]
    resistance: Floats  # of the soil, N [node that soil holds]
    overlaps: list[float]  # of the contacts, m [contact of the chain]


def chain_of(system: System, counts: list[int], left_out: int = 0) -> Chain:
    """A system as a chain of nodes and springs, in the state that the system has.

    Parameters
    ----------
    system : System
        A single system, no family.
    counts : list of int
        Cells of each segment.
    left_out : int
        Number of bodies at the left end that are left out: like bodies that move, they
        keep their positions and bear on nothing.

    Raises
    ------
    InvalidModel
        If a contact law has no stiffness.
    """
    row = build_row(system)
    mesh = Mesh(row, counts)
    is_moving = []
    for i, body in enumerate(system.bodies):
        is_moving.append(i < left_out or isinstance(body, Wall) or moves(body))
    is_fixed = (mesh.mass == 0) | (mesh.is_prescribed == 1)
    for i, keeps_position in enumerate(is_moving):
        if keeps_position:
            is_fixed[nodes_of(row, mesh, i)] = True
    stiffness = mesh.cells.relaxed_stiffness
    shafts = soil_of(mesh, step=1.0)
    resists_at_rest = shafts["ultimate"] > 0  # drag does not
    return Chain(
        system=system,
        row=row,
        mesh=mesh,
        is_moving=is_moving,
        is_fixed=is_fixed,
        weight=mesh.mass * float(system.gravity),
        stiffness=stiffness,
        tension=_tensions(row, mesh),
        soil=shafts[resists_at_rest],
        contacts=_contacts(row, mesh, is_moving, float(stiffness.max(initial=0.0))),
    )


def moves(body: Any) -> bool:
    """Whether a body, or a part of it, has a velocity at t = 0."""
    values = getattr(body.velocity, "values", body.velocity)
    return bool(np.any(values))


def nodes_of(row: Row, mesh: Mesh, body: int) -> slice:
    """Nodes of a rod or of a rigid mass; an empty slice for a wall."""
    first_segment, last_segment = row.spans[body]
    if first_segment <= last_segment:  # only a rod has segments
        return slice(mesh.first[first_segment], mesh.last[last_segment] + 1)
    mass = row.mass_of[body]
    if not 0 <= mass < len(mesh.node_of_mass):  # a wall
        return slice(0, 0)
    node = mesh.node_of_mass[mass]
    return slice(node, node + 1)


def cell_edges(row: Row, mesh: Mesh, body: int) -> Floats:
    """Positions of the ends of a rod's cells, from 0, m from its left end."""
    first_segment, last_segment = row.spans[body]
    nodes = nodes_of(row, mesh, body)
    # Cell i lies between the nodes i - 1 and i.
    widths = mesh.cells.width[nodes.start + 1 : nodes.stop]
    assert first_segment <= last_segment  # the body is a rod
    return np.concatenate(([0.0], np.cumsum(widths)))


def soil_of_rod(chain: Chain, body: int) -> Any:
    """Indices in `chain.soil` of the records along a rod; none without soil."""
    held_bodies = shaft_bodies(chain.row)
    if body not in held_bodies:
        return np.zeros(0, int)
    shaft = held_bodies.index(body)
    return np.flatnonzero(chain.soil["shaft"] == shaft)


def _tensions(row: Row, mesh: Mesh) -> Floats:
    """Tension of each cell from the strain of its rod, N; 0 where there is no cell."""
    tension = np.zeros(len(mesh.stiffness))
    for i, body in enumerate(row.system.bodies):
        if not isinstance(body, Rod):
            continue
        nodes = nodes_of(row, mesh, i)
        cells = slice(nodes.start + 1, nodes.stop)
        edges = cell_edges(row, mesh, i)
        strain = averages(body.strain, edges, float(body.length))
        elongation = strain * mesh.cells.width[cells]
        tension[cells] = mesh.cells.relaxed_stiffness[cells] * elongation
    return tension


def _contacts(
    row: Row, mesh: Mesh, is_moving: list[bool], largest_stiffness: float
) -> list[Contact]:
    """Contacts that can bear a weight: those with a stiffness, then rigid ones.

    A rigid contact is a spring with `RIGID_STIFFNESS` times the largest stiffness of a
    cell, which is `largest_stiffness`, or of another contact. InvalidModel is raised
    for a law without a constant stiffness.
    """
    system = row.system
    linear = []
    rigid = []
    for k, link in row.unbonded_links.items():
        law = system.contacts[k]
        if not _can_bear(system, is_moving, k):
            continue
        _, right_node = mesh.link_nodes[link]  # the nodes on both sides
        stiffness = 0.0  # a rigid one gets its stiffness below
        if isinstance(law, Joint | Spring | SpringDashpot | Plastic):
            linear_law: Any = law
            stiffness = float(linear_law.stiffness)
        elif not isinstance(law, Rigid):
            message = (
                "has no constant stiffness, with which rest is computed; use Spring, "
                f"Yielding, Cushion or Rigid, got {type(law).__name__}"
            )
            raise invalid_argument(f"contacts.{k}", message)
        overlap = -float(system.gaps[k])
        if isinstance(law, Joint):
            overlap = -float(law.stretch)
        contact = Contact(k, right_node, stiffness, overlap, isinstance(law, Joint))
        if isinstance(law, Rigid):
            rigid.append(contact)
        else:
            linear.append(contact)
            largest_stiffness = max(largest_stiffness, stiffness)
    if largest_stiffness == 0:  # rigid bodies alone
        largest_stiffness = 1.0
    rigid_stiffness = RIGID_STIFFNESS * largest_stiffness
    stiff_contacts = [contact._replace(stiffness=rigid_stiffness) for contact in rigid]
    return linear + stiff_contacts


def _can_bear(system: System, is_moving: list[bool], contact: int) -> bool:
    """Whether a contact joins two bodies at rest, or one of them and a wall."""
    bodies_at_rest = 0
    for i in (contact, contact + 1):
        if not is_moving[i]:
            bodies_at_rest += 1
        elif not isinstance(system.bodies[i], Wall):
            return False
    return bodies_at_rest > 0


# Equilibrium
# --------------------------------------------------------------------------------------


def find_equilibrium(chain: Chain) -> Equilibrium:
    """Find the equilibrium of a chain, as if its soil did not yield on the way there.

    First all contacts are closed. Then, in rounds, contacts that would pull open, and
    open ones that overlap close, until nothing changes.

    Raises
    ------
    InvalidModel
        If nothing holds a body, or contacts still change after `MAX_ROUNDS` rounds.
    """
    is_pressed = [True for _ in chain.contacts]
    soil = chain.soil
    nodes = soil["node"]
    count = len(chain.is_fixed)
    soil_stiffness = np.bincount(nodes, soil["stiffness"], count)
    # Force of weight and soil on each node, N
    on_nodes = chain.weight - np.bincount(nodes, soil["resistance"], count)
    for _ in range(MAX_ROUNDS):
        springs = chain.stiffness.copy()
        tension = chain.tension.copy()
        for contact, pressed in zip(chain.contacts, is_pressed, strict=True):
            if pressed:
                springs[contact.right_node] = contact.stiffness
                tension[contact.right_node] = -contact.stiffness * contact.overlap
        force = np.diff(tension) + on_nodes  # on each node, of its two springs as well
        is_fixed = _fixed_with_floating(chain, springs, soil_stiffness, force)
        u = solve_chain(springs, soil_stiffness, is_fixed, force)
        round_off = OVERLAP_RTOL * float(np.abs(u).max())
        overlaps = []
        stays_pressed = []
        for contact, pressed in zip(chain.contacts, is_pressed, strict=True):
            node = contact.right_node
            overlap = float(contact.overlap + u[node - 1] - u[node])
            overlaps.append(overlap)
            # A contact changes its state only if the overlap is more than round-off.
            least_overlap = round_off
            if pressed:
                least_overlap = -round_off
            stays_pressed.append(contact.pulls or overlap >= least_overlap)
        if stays_pressed == is_pressed:
            break
        is_pressed = stays_pressed
    else:
        message = "open and close without end in the search for rest; give stiffer laws"
        raise invalid_argument("contacts", message)
    stretch = np.diff(u, prepend=0.0, append=0.0)
    return Equilibrium(
        displacement=u,
        tension=chain.tension + chain.stiffness * stretch,
        resistance=soil["resistance"] + soil["stiffness"] * u[nodes],
        overlaps=overlaps,
    )


def solve_chain(springs: Any, soil: Any, is_fixed: Any, force: Any) -> Floats:
    """Displacements of the nodes of a chain under forces on the nodes, m.

    Parameters
    ----------
    springs : array
        Stiffness between the nodes i - 1 and i, N/m [node + 1].
    soil : array
        Stiffness of the soil at each node, N/m [node].
    is_fixed : array of bool
        Nodes that stay [node].
    force : array
        N [node]. With the unit matrix, column j of the result is due to a unit force on
        node j.
    """
    diagonal = springs[:-1] + springs[1:] + soil
    coupling = springs[:-1].copy()  # to the node before
    coupling[0] = 0.0
    coupling[is_fixed] = 0.0
    coupling[1:][is_fixed[:-1]] = 0.0
    diagonal[is_fixed] = 1.0
    loads = np.where(is_fixed, 0.0, force)
    # LAPACK takes a symmetric matrix as two bands: above the diagonal, and diagonal.
    u: Floats = solveh_banded(np.array([-coupling, diagonal]), loads)
    return u


def _fixed_with_floating(chain: Chain, springs: Any, soil: Any, force: Any) -> Any:
    """Fixed nodes of a chain, and also one node of each group that nothing holds.

    A group is the bodies between two springs without stiffness. InvalidModel is raised
    if the forces on a group that nothing holds do not balance.
    """
    is_fixed = chain.is_fixed.copy()
    largest = float(np.abs(chain.weight).max() + np.abs(chain.tension).max())
    # A group starts at a node without a spring to the node before it.
    starts = np.flatnonzero(springs[:-1] == 0)
    stops = np.append(starts[1:], len(is_fixed))
    for start, stop in zip(starts, stops, strict=True):
        group = slice(start, stop)
        if is_fixed[group].any() or soil[group].any():
            continue
        net = float(force[group].sum())
        if abs(net) > BALANCE_RTOL * largest:
            body = _body_at(chain, int(start))
            message = (
                f"cannot rest: nothing holds it against a force of {net:.6g} N; give "
                "it soil along its shaft, a wall to stand on, or no gravity"
            )
            raise invalid_argument(f"bodies.{body}", message)
        is_fixed[start] = True
    return is_fixed


def _body_at(chain: Chain, node: int) -> int:
    """Index of the first body to which a node belongs; 0 if it belongs to none."""
    for body in range(len(chain.system.bodies)):
        nodes = nodes_of(chain.row, chain.mesh, body)
        if nodes.start <= node < nodes.stop:
            return body
    return 0


def yielding_places(chain: Chain, equilibrium: Equilibrium) -> list[tuple[str, str]]:
    """Path of each rod or contact that would yield at equilibrium, and a clause on it.

    For a rod the clause states the first position at which the soil yields, m.
    """
    places = []
    for i, body in enumerate(chain.system.bodies):
        if not isinstance(body, Rod):
            continue
        along_rod = soil_of_rod(chain, i)
        most = chain.soil["ultimate"][along_rod] * (1 + YIELD_RTOL)
        beyond = np.flatnonzero(np.abs(equilibrium.resistance[along_rod]) > most)
        if beyond.size:
            first_node = nodes_of(chain.row, chain.mesh, i).start
            first_yielding = along_rod[beyond[0]]
            node = int(chain.soil["node"][first_yielding])
            x = cell_edges(chain.row, chain.mesh, i)[node - first_node]
            places.append((f"bodies.{i}.shaft", f"the soil yields at {x:.6g} m"))
    for contact, overlap in zip(chain.contacts, equilibrium.overlaps, strict=True):
        force = contact.stiffness * overlap
        if force > _flow_force(chain, contact) * (1 + YIELD_RTOL):
            places.append((f"contacts.{contact.number}", "the contact yields"))
    return places


def _flow_force(chain: Chain, contact: Contact) -> float:
    """Force at which a contact yields without hardening, N.

    It is inf for laws that do not yield, and for those that harden, such as a cushion:
    they can bear any force.
    """
    law: Any = chain.system.contacts[contact.number]
    is_plastic = isinstance(law, Plastic)
    if not is_plastic or law.hardening > 0:
        return math.inf
    return float(law.yield_force)


def check_bears(chain: Chain, equilibrium: Equilibrium) -> None:
    """Raise InvalidModel if soil or a contact would yield at equilibrium.

    The error has a problem for each such rod and contact.
    """
    problems = []
    for path, words in yielding_places(chain, equilibrium):
        message = f"cannot bear the weight at rest: {words}; raise the resistance"
        problems.append((path, message))
    if problems:
        raise InvalidModel(problems)


# What energy can do
# -------------------------------------------------------------------------------


def potential_energy(chain: Chain, equilibrium: Equilibrium) -> float:
    """Energy of the state of a chain above that of its equilibrium, J.

    Springs and soil have k u^2/2, with the displacement u to the equilibrium. A contact
    has the difference of its stored energies k d^2/2 at the overlaps d now and at
    rest, minus the work of its force at rest over the change of d: never below 0.
    """
    u = equilibrium.displacement
    stretch = np.diff(u, prepend=0.0, append=0.0)
    energy = float(chain.stiffness @ stretch**2 / 2)
    of_soil = chain.soil["stiffness"] * u[chain.soil["node"]] ** 2
    energy += float(of_soil.sum() / 2)
    for contact, overlap in zip(chain.contacts, equilibrium.overlaps, strict=True):
        pressed_now = contact.overlap
        pressed_at_rest = overlap
        if not contact.pulls:  # an open contact has no force
            pressed_now = max(0.0, pressed_now)
            pressed_at_rest = max(0.0, pressed_at_rest)
        force = contact.stiffness * pressed_at_rest
        stored = contact.stiffness * (pressed_now**2 - pressed_at_rest**2) / 2
        energy += stored - force * (contact.overlap - overlap)
    return energy


def can_yield(chain: Chain, equilibrium: Equilibrium, energy: float) -> bool:
    """Whether motion about the equilibrium can make soil yield at shaft or toe.

    Motion of the energy E displaces node i by at most sqrt(2 E C), with its compliance
    C: the displacement by a unit force. Contacts, which may open, are left out of C, so
    that it is no smaller than it should be. A contact at the overlap d yields at d_y if
    E is at least k (d_y - d)^2/2.

    Parameters
    ----------
    chain : Chain
    equilibrium : Equilibrium
    energy : float
        Kinetic and potential energy above that of the equilibrium, J.
    """
    soil = chain.soil
    nodes = soil["node"]
    if len(nodes):
        reach = np.sqrt(2 * energy * _compliances(chain)[nodes])
        forces = np.abs(equilibrium.resistance) + soil["stiffness"] * reach
        is_soil = soil["ultimate"] > 0  # drag does not yield
        if np.any(is_soil & (forces >= soil["ultimate"])):
            return True
    for contact, overlap in zip(chain.contacts, equilibrium.overlaps, strict=True):
        left = _flow_force(chain, contact) / contact.stiffness - max(0.0, overlap)
        if left <= 0 or contact.stiffness * left**2 / 2 <= energy:
            return True
    return False


def _compliances(chain: Chain) -> Floats:
    """Displacement of each node by a unit force on it, m/N; 0 for a fixed node.

    One node of each group that nothing holds is fixed, see `_fixed_with_floating`.
    Contacts are open, except joints.
    """
    count = len(chain.is_fixed)
    soil = np.bincount(chain.soil["node"], chain.soil["stiffness"], count)
    springs = chain.stiffness.copy()
    for contact in chain.contacts:
        if contact.pulls:
            springs[contact.right_node] = contact.stiffness
    no_force = np.zeros(count)
    is_fixed = _fixed_with_floating(chain, springs, soil, no_force)
    compliances: Floats = np.diag(solve_chain(springs, soil, is_fixed, np.eye(count)))
    return compliances
