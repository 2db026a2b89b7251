"""The mesh of a row: which node and which cell belongs to which body.

A segment of N cells has N + 1 nodes. Half of the mass of each cell is at each of its
two nodes. Bodies that are bonded share a node and form one piece of neighbouring nodes.
A wall with a contact or joint is a node of its own. Cell i lies between the nodes i - 1
and i. Cell 0, the cells between pieces and the last cell have no mass and no stiffness.
"""

import math
from bisect import bisect_left
from collections.abc import Collection, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ...model import Segment
from ...model.frozen import LARGEST, SMALLEST, InvalidModel
from ...model.lateral_inertia import INERTIA, MINDLIN_HERRMANN, radial_moduli
from ...model.profiles import extremes
from ..link import Law
from ..row import Array, Row

STEP_TICKS = 1 << 36
"""Ticks of a time step: times of results are counted in ticks."""
MAX_COUPLING = 2.0**32
"""Largest ratio of the coupling of neighbouring nodes to the inertia of a cell.

Beyond it round-off hides the motion.
"""
CELL_ROOM = 2.0**40
"""Largest ratio of radial inertia or stiffness of a segment to that of its cells."""
MODAL_CELLS = 200
"""Number of cells of a rod whose lowest modes are computed."""
MODES = 8
"""Number of lowest modes, among which the one with the slowest decay is sought."""


class Cells(NamedTuple):
    """Properties of the cells, all [cell].

    q is the radial strain in Mindlin and Herrmann's model. What follows from a model of
    lateral inertia is 0 in cells without this model.
    """

    cell_mass: Array
    """rho A dx, kg."""
    stiffness: Array
    """E A/dx, N/m; by Mindlin and Herrmann (lambda + 2 mu) A/dx, that at constant q."""
    viscous: Array
    """eta A/dx, N s/m."""
    lateral_inertia: Array
    """rho nu^2 I_p/dx, kg, by Rayleigh and Love."""
    radial_inertia: Array
    """Inertia of q, m rho I_p dx, kg m^2, by Mindlin and Herrmann."""
    coupling: Array
    """Tension by a unit of q, 2 lambda A, N."""
    radial_stiffness: Array
    """4 (lambda + mu) A dx, N m."""
    shear_stiffness: Array
    """s mu I_p/dx, N m, between neighbouring cells."""
    width: Array
    """dx, m; 1 between pieces, where all else is 0."""

    @property
    def relaxed_stiffness(self) -> Array:
        """Stiffness E A/dx for slow elongation, which q follows, N/m [cell]."""
        return self.stiffness - quotient(self.coupling**2, self.radial_stiffness)


class GridMotion(NamedTuple):
    """The motion on a grid at some times.

    It consists of the mesh, the states at these times, and the forces on pieces.
    """

    counts: Sequence[int]
    """Cells of each segment."""
    first: Sequence[int]
    """First node of each segment, as in `Mesh`."""
    last: Sequence[int]
    """Last node of each segment."""
    starts: Sequence[int]
    """First node of each piece."""
    mass: Array
    """kg [node]."""
    shear_stiffness: Array
    """N m [node], as in `Mesh`."""
    cells: Cells
    when: Array
    """Number of time steps after which each state was kept [state]."""
    velocity: Array
    """m/s, in the frame [state, node]."""
    force: Array
    """Elastic tension, N [state, cell]."""
    displacement: Array
    """Displacement of the first node of each piece, m/s times steps [state, piece]."""
    lost: Array
    """Energy turned to heat, W times steps [state]."""
    radial: Array
    """Radial strain, 1/s times steps [state, cell]; [state, 0] if no cell has one."""
    radial_rate: Array
    """Rate of the radial strain, 1/s [state, cell]."""
    resistance: Array
    """Static resistance of the soil, N [state, node that soil holds]."""
    soil: Array
    """`records.SOIL` [node that soil holds]."""
    soil_force: Array
    """Force of the soil, N, to the right [state, node that soil holds]."""
    pushes: Mapping[int, Array]
    """Force on a node from outside its piece, to the right, N [step], by node.

    An entry is the mean over a step.
    """

    def stretches(self, step: float) -> Array:
        """Elongation of the cells, m [state, cell]; `step` is in s.

        It is (tension - b q)/k with the stiffness k, the radial strain q and the
        coupling b of a cell, and 0 in cells without stiffness, as between pieces.
        """
        tension = self.force
        if self.radial.size:  # some cells have a radial strain
            # `radial` holds q/step.
            tension = tension - self.cells.coupling * self.radial * step
        return quotient(tension, self.cells.stiffness)

    def energies(
        self, nodes: slice, mass: Array, state: int, v: Array, step: float
    ) -> tuple[float, float]:
        """Kinetic and strain energy of neighbouring nodes and the cells between, J.

        Their sum is the energy that the scheme conserves. With the step h and the
        matrices M and K of inertia and stiffness, the kinetic energy is
        (v M v - h^2 v K v/4)/2. The strain energy of the displacements u is u K u/2; it
        is computed from the tensions. A cell of stiffness k adds k to K between its
        nodes, and its lateral inertia to M. The radial strain q of a cell has the
        inertia J, the stiffnesses G and s, and the coupling b with the elongation; if
        the tension is known, its own stiffness is G - b^2/k.

        Parameters
        ----------
        nodes : slice
            From the first of the nodes to one after the last.
        mass : array
            Masses of these nodes, kg: those that belong to the body.
        state : int
            Index of the state, for tensions and radial strains.
        v : array
            Velocities of these nodes, m/s; they may be relative to a mean motion.
        step : float
            h, s.
        """
        inside = slice(nodes.start + 1, nodes.stop)  # cells between the nodes
        stretch_rate = np.diff(v)  # of these cells, m/s
        k = self.cells.stiffness[inside]
        # Contribution of the cells to M - h^2 K/4, for differences of neighbours
        cell_inertia = self.cells.lateral_inertia[inside] - k * step**2 / 4
        twice_kinetic = mass @ (v * v) + cell_inertia @ (stretch_rate * stretch_rate)
        kinetic = float(twice_kinetic) / 2
        # Cells without stiffness, between pieces, have no strain energy.
        k_or_inf = np.where(k > 0, k, np.inf)
        strained = float(np.sum(self.force[state, inside] ** 2 / k_or_inf)) / 2
        if not self.radial.size:  # no cell has a radial strain
            return kinetic, strained
        # The energies of the radial strains are added.
        J = self.cells.radial_inertia[inside]
        b = self.cells.coupling[inside]
        G = self.cells.radial_stiffness[inside]
        # Radial strains and their rates in all cells
        all_q = self.radial[state] * step  # stored divided by the step, 1/s
        all_rates = self.radial_rate[state]
        # Differences of the two cells beside each node: cell i is on the left of node i
        q_change = np.diff(all_q)[nodes]
        rate_change = np.diff(all_rates)[nodes]
        q = all_q[inside]
        rate = all_rates[inside]
        # Shear stiffness s at the nodes. At the first and the last node, which may be
        # shared with another rod, only half of it counts.
        shear = self.shear_stiffness[nodes] / 2
        shear[1:-1] *= 2
        twice_radial_strained = (G - b * b / k_or_inf) @ q**2 + shear @ q_change**2
        # v K v without k stretch_rate^2, which is part of `cell_inertia`
        mixed = 2 * (b * stretch_rate) @ rate
        v_K_v = mixed + G @ rate**2 + shear @ rate_change**2
        twice_radial_kinetic = J @ rate**2 - step * step / 4 * v_K_v
        kinetic += float(twice_radial_kinetic) / 2
        strained += float(twice_radial_strained) / 2
        return kinetic, strained


class Mesh:
    """A row on a grid, in SI.

    Attributes
    ----------
    row : Row
    counts : list of int
        Number of cells of each segment.
    first, last : list of int
        First and last node of each segment; segments are counted from 1 as in the row,
        and entry 0 is -1.
    node_of_mass : list of int
        Node of each rigid mass.
    starts, stops : list of int
        First and last node of each piece.
    mass, is_prescribed : [node] array
        Mass, kg, and 1 where the velocity is prescribed, else 0.
    cells : Cells
    cell_mass, stiffness, viscous, lateral_inertia, width : [cell] array
        Columns of `cells`.
    shear_stiffness : [node] array
        Shear stiffness between the radial strains of the two cells beside a node, N m:
        half of each cell in series.
    link_nodes : dict of int to (int, int)
        Nodes on the left and on the right of each contact or joint, by the number of
        the link in the row, from left to right.
    ends, end_cells : list of int
        First and last node of the row, on which the outside acts, and the cells beside
        them.
    bonds : dict of int to (int, int)
        Node of each bonded link whose force is recorded, and the cell of a rod beside
        it, by the number of the link in the row.
    recorded_nodes, recorded_cells : list of int
        Nodes whose velocities, and cells whose tensions, are recorded in each step.
    groups : list of (int, int)
        First and last node of each group of pieces with joints between them.
    has_radial_strain : bool
        Whether any cell has a radial strain of its own.
    couples_nodes : bool
        Whether the velocity changes of neighbouring nodes in a step depend on each
        other, by viscosity or lateral inertia by Rayleigh and Love.

    Raises
    ------
    InvalidModel
        If viscosity or lateral inertia is too large for the mass, see `MAX_COUPLING`.
    """

    def __init__(self, row: Row, counts: list[int]) -> None:
        """Lay out a row on a grid with `counts` cells in its segments, [segment].

        All attributes are set. Pieces end at contacts and joints, groups at contacts
        only. The nodes of rigid masses, both ends, and the nodes of cells whose
        tensions are recorded are `recorded_nodes`. InvalidModel is raised if cells are
        coupled too strongly.
        """
        self.row = row
        self.counts = counts
        self.first = [-1]  # entry 0 is not used, as segments count from 1
        self.last = [-1]
        self.node_of_mass: list[int] = []
        self.link_nodes: dict[int, tuple[int, int]] = {}
        self.bonds: dict[int, tuple[int, int]] = {}
        driven = []  # sides whose velocity is prescribed: 0 left, 1 right
        for side, (kind, _) in enumerate(row.boundaries):
            if kind == "velocity":
                driven.append(side)
        # This fills the lists and dictionaries above, sets `cells`, and raises
        # InvalidModel if cells are coupled too strongly.
        last_node = self._lay_out(driven)
        # First and last nodes of the pieces, [piece] each
        self.starts, self.stops = _between(self.link_nodes.values(), last_node)
        contacts = []  # nodes on both sides of each link that can open
        for link, nodes in self.link_nodes.items():
            if row.links[link].law != Law.JOINT:
                contacts.append(nodes)
        group_starts, group_stops = _between(contacts, last_node)
        self.groups = list(zip(group_starts, group_stops, strict=True))
        self.ends = [0, last_node]
        self.end_cells = [1, last_node]  # cell i is on the left of node i
        self.cell_mass = self.cells.cell_mass
        self.stiffness = self.cells.stiffness
        self.viscous = self.cells.viscous
        self.lateral_inertia = self.cells.lateral_inertia
        self.width = self.cells.width
        # A node has half of the mass of the cells on its left and on its right.
        self.mass = (self.cell_mass[:-1] + self.cell_mass[1:]) / 2
        # [node], of the two half cells beside the node
        self.shear_stiffness = _in_series(self.cells.shear_stiffness)
        self.mass[self.node_of_mass] += row.masses
        # Radial strains on both sides of a rigid mass are independent.
        self.shear_stiffness[self.node_of_mass] = 0.0
        self.is_prescribed = np.zeros(last_node + 1, np.int64)
        for side in driven:
            self.is_prescribed[self.ends[side]] = 1
        # Tensions of these cells give the forces in bonds.
        self.recorded_cells = [cell for _, cell in self.bonds.values()]
        recorded = [*self.ends, *self.node_of_mass]
        for cell in self.recorded_cells:
            recorded.extend((cell - 1, cell))  # the nodes on both sides of the cell
        self.recorded_nodes = list(dict.fromkeys(recorded))  # each once
        self.has_radial_strain = bool(np.any(self.cells.radial_inertia))
        self.couples_nodes = bool(np.any(self.viscous) or np.any(self.lateral_inertia))

    def _lay_out(self, driven: list[int]) -> int:
        """Assign nodes and cells to the row; return the index of the last node.

        The row is walked from left to right: bonded neighbours share a node, and each
        contact or joint begins a new one. `cells` is set, and `first`, `last`,
        `node_of_mass`, `link_nodes` and `bonds`, which are empty before, are filled.
        `driven` are the sides (0, 1) whose velocity is prescribed: a bond there is
        recorded, as are the bonds between bodies. InvalidModel is raised if cells are
        coupled too strongly.
        """
        row = self.row
        outer_links = (0, len(row.links) - 1)
        recorded_links = set(row.contact_link)  # its entry -1 is no link
        for side in driven:
            recorded_links.add(outer_links[side])
        node = 0  # last node so far; the first piece begins at the left end of the row
        parts = [NO_CELL]  # cells so far: cell 0 is on the left of node 0
        # Each neighbour of link i is a pair of its kind, "outside", "mass" or
        # "segment", and its number.
        for i, (left, right) in enumerate(row.neighbours):
            left_kind, _ = left
            right_kind, s = right  # `s` is used for segments only
            law = row.links[i].law
            if law >= Law.JOINT:  # a joint or a contact: a piece ends
                node += 1
                parts.append(NO_CELL)
                self.link_nodes[i] = node - 1, node
            elif law == Law.BOND and i in recorded_links:
                # The bond is at a node of a rod; the cell of this rod beside it is
                # recorded, the cell of the left rod if both are rods.
                if left_kind == "segment":
                    cell = node
                else:
                    cell = node + 1
                self.bonds[i] = node, cell
            if right_kind == "mass":
                self.node_of_mass.append(node)
            elif right_kind == "segment":
                count = self.counts[s - 1]  # segments count from 1
                cells = _cells(row.segments[s - 1], count)
                _refuse_stiff(row.paths[s], cells)
                parts.append(cells)
                self.first.append(node)
                node += count
                self.last.append(node)
        # One more empty cell is on the right of the last node. Each part is an array
        # [property, cell].
        self.cells = Cells(*np.concatenate([*parts, NO_CELL], axis=1))
        return node


def _between(
    cuts: Collection[tuple[int, int]], last: int
) -> tuple[list[int], list[int]]:
    """First nodes and last nodes of the spans of nodes between cuts, [span] each.

    The nodes are 0 to `last`. A cut is the pair of neighbouring nodes on its left and
    right; the cuts are ordered from left to right. Without cuts there is one span.
    """
    starts = [0]
    stops = []
    for left, right in cuts:
        stops.append(left)
        starts.append(right)
    stops.append(last)
    return starts, stops


def _cells(segment: Any, count: int) -> Cells:
    """Properties of `count` cells of equal length in a segment.

    If the area varies, each cell has its own mean area. In Rayleigh and Love's model
    cells have a lateral inertia. In Mindlin and Herrmann's model they have a radial
    strain with its own equations, and the stiffness is that at constant radial strain.
    Fields of `Cells` that the segment's model does not have are 0.
    """
    material = segment.material
    dx = float(segment.length) / count
    borders = np.linspace(0.0, float(segment.length), count + 1)
    area = segment.area_between(borders)  # mean area of each cell, m^2 [cell]
    E = float(material.youngs_modulus)
    rho = float(material.density)
    nothing = np.zeros(count)
    cells = Cells(
        cell_mass=rho * area * dx,
        stiffness=E * area / dx,
        viscous=float(material.viscosity) * area / dx,
        lateral_inertia=nothing,
        radial_inertia=nothing,
        coupling=nothing,
        radial_stiffness=nothing,
        shear_stiffness=nothing,
        width=np.full(count, dx),
    )
    if segment.lateral_inertia is None:
        return cells
    polar = segment.polar_moments(area)  # m^4 [cell]
    if segment.lateral_inertia != MINDLIN_HERRMANN:  # Rayleigh and Love
        # The kinetic energy of the radial motion is rho nu^2 I_p (dv/dx)^2/2 per
        # length: rho nu^2 I_p/dx (difference of v)^2/2 in a cell.
        lateral = rho * float(material.poisson_ratio) ** 2 * polar / dx
        return cells._replace(lateral_inertia=lateral)
    moduli = radial_moduli(E, float(material.poisson_ratio))
    return cells._replace(
        stiffness=moduli.axial * area / dx,
        radial_inertia=INERTIA * rho * polar * dx,  # INERTIA is a correction factor
        coupling=moduli.coupling * area,
        radial_stiffness=moduli.radial * area * dx,
        shear_stiffness=moduli.shear * polar / dx,
    )


NO_CELL = Cells(*np.append(np.zeros(8), 1.0)[:, None])  # 8 properties and the width
"""An empty cell, as between pieces, [property, 1]: all is 0, except the width 1 m."""


def _in_series(springs: Array) -> Array:
    """Stiffness between the middles of neighbouring cells, [node].

    `springs` [cell] are the stiffnesses a, b of whole cells. Two half cells, of
    stiffness 2 a and 2 b, are in series: their stiffness is 2 a b/(a + b), and 0 if
    both are 0.
    """
    a = springs[:-1]
    b = springs[1:]
    return quotient(2 * (a * b), a + b)


def quotient(a: Any, b: Array) -> Array:
    """Return a/b, and 0 where b is 0, as between pieces; b must not be negative."""
    return np.asarray(a / np.where(b > 0, b, np.inf))


def check_polar_moments(row: Row) -> None:
    """Raise InvalidModel if squares of radial inertia or stiffness overflow or vanish.

    The radial inertia is rho I_p L, kg m^2, and the stiffness is E I_p/L, N m, at the
    smallest and largest area of each segment with lateral inertia. Those of cells may
    be `CELL_ROOM` times larger or smaller, which must not overflow or vanish either.
    The error names the first segment that fails.
    """
    # Path 0 is empty: segments are counted from 1.
    for path, segment in zip(row.paths[1:], row.segments, strict=True):
        if segment.lateral_inertia is None:
            continue
        material = segment.material
        length = float(segment.length)
        for area in map(float, extremes(segment.area)):
            polar = float(segment.polar_moments(np.asarray(area)))
            inertia = float(material.density) * polar * length
            stiffness = float(material.youngs_modulus) * polar / length
            least = min(inertia, stiffness)
            most = max(inertia, stiffness)
            vanishes = least < SMALLEST * CELL_ROOM
            overflows = most > LARGEST / CELL_ROOM
            if vanishes or overflows:
                message = (
                    "makes radial inertia or stiffness whose squares overflow or "
                    f"vanish, got {area!r}; take an area nearer to 1 in consistent "
                    "units"
                )
                raise InvalidModel([(f"{path}.area", message)])


def half_cell_edges(left: float, length: float, count: int) -> Array:
    """Edges of the half cells of a segment, m [2 * count + 1].

    The left end of the segment is at `left`, m; its `length`, m, is divided into
    `count` cells.
    """
    return np.asarray(left + length * np.arange(2 * count + 1) / (2 * count))


def nodes_of_half_cells(count: int) -> Array:
    """Node of each half cell of `count` neighbouring cells, [2 * count].

    The nodes are 0, 1, 1, 2, 2, ..., `count`: the outer nodes have one half cell.
    """
    return np.asarray((np.arange(2 * count) + 1) // 2)


def crossing_time(segment: Any) -> float:
    """Time in which the fastest waves cross a segment, s.

    It is the transit time at the bar speed. In Mindlin and Herrmann's model waves at
    constant radial strain are faster, and their transit time is returned.
    """
    if segment.lateral_inertia != MINDLIN_HERRMANN:
        return float(segment.transit_time)
    # With the whole segment as one cell, sqrt(mass/stiffness) is its transit time.
    whole = _cells(segment, 1)
    return math.sqrt(float(whole.cell_mass[0] / whole.stiffness[0]))


def stable_step(segment: Any, count: int, soil_stiffness: float = 0.0) -> float:
    """Longest stable step of a segment in `count` cells, s.

    Leapfrog is stable for steps up to 2/omega, with the largest angular frequency
    omega. For cells of transit time t it is omega = 2/t. Lateral inertia by Rayleigh
    and Love makes it smaller, which is not used. Soil of stiffness `soil_stiffness` per
    length, N/m^2, adds soil_stiffness/(rho A) to omega^2. In Mindlin and Herrmann's
    model, in the fastest motion, all nodes and radial strains oscillate against their
    neighbours. An upper bound of omega is the larger root of::

        (omega^2 - 4 k/m) (omega^2 - (G + 4 s)/J) = 4 b^2/(m J)

    with the mass m, stiffness k, coupling b, radial stiffness G, shear stiffness s and
    radial inertia J of a cell; the largest bound of all cells counts.
    """
    by_soil = 0.0  # contribution of soil to omega^2, 1/s^2
    if soil_stiffness > 0:
        least_area = float(min(extremes(segment.area)))
        by_soil = soil_stiffness / (float(segment.material.density) * least_area)
    if segment.lateral_inertia != MINDLIN_HERRMANN:
        cell_transit = float(segment.transit_time) / count
        # This is 2/omega with omega^2 = 4/t^2 + by_soil.
        return cell_transit / math.sqrt(1 + by_soil * (cell_transit / 2) ** 2)
    cells = _cells(segment, count)
    m = cells.cell_mass
    J = cells.radial_inertia
    # omega^2 of the axial and of the radial motion without coupling
    axial = 4 * cells.stiffness / m
    radial = (cells.radial_stiffness + 4 * cells.shear_stiffness) / J
    # The equation is quadratic in omega^2. This is the root of its discriminant,
    # (axial - radial)^2 + 16 b^2/(m J).
    root = np.hypot(axial - radial, 4 * cells.coupling / np.sqrt(m * J))
    omega_squared = (axial + radial + root) / 2  # the larger solution [cell]
    return 2 / math.sqrt(float(omega_squared.max()) + by_soil)


def most_cells(segment: Any, count: int, step: float) -> int:
    """Largest number of cells of a segment, up to `count`, for which `step` is stable.

    `step` is in s. At least 1 is returned, even if the step is too long for a single
    cell.
    """

    def is_unstable(cells: int) -> bool:
        return stable_step(segment, cells) < step

    # The longest stable step decreases with the number of cells. In 1 to `count` the
    # stable numbers come first; there are as many as the index of the first unstable
    # number.
    stable_count = bisect_left(range(1, count + 1), True, key=is_unstable)
    return max(1, stable_count)


def _refuse_stiff(path: str, cells: Cells) -> None:
    """Raise InvalidModel if viscosity or lateral inertia couples cells too strongly.

    Viscosity divided by the impedance of a cell, and lateral inertia divided by its
    mass, may be at most `MAX_COUPLING`. `path` is the segment that an error names.
    """
    impedance = np.sqrt(cells.stiffness) * np.sqrt(cells.cell_mass)  # kg/s [cell]
    couplings = {
        "material.viscosity": cells.viscous / impedance,
        "lateral_inertia": cells.lateral_inertia / cells.cell_mass,
    }
    for name, coupling in couplings.items():
        if coupling.max() > MAX_COUPLING:
            message = (
                f"couples cells {coupling.max():.2g} times as strongly as their "
                "inertia, so round-off hides the motion; take a smaller value, or a "
                "RigidMass"
            )
            raise InvalidModel([(f"{path}.{name}", message)])


def lasting_mode(segments: Sequence[Segment]) -> tuple[float, float]:
    """Frequency and decay rate of the mode of a free rod that decays most slowly.

    The rod consists of these segments, and both of its ends are free. The mode is one
    of the `MODES` lowest modes of vibration on a mesh of about `MODAL_CELLS` cells.

    Returns
    -------
    float
        Angular frequency omega, rad/s.
    float
        Decay rate of the amplitude, 1/s; 0 without viscosity. With the matrices K, M
        and D of stiffness, inertia and damping, a mode x has K x = omega^2 M x and the
        decay rate x D x/(2 x M x).
    """
    from scipy.linalg import block_diag, eigh

    transit = sum(float(segment.transit_time) for segment in segments)
    parts = []
    for segment in segments:
        share = float(segment.transit_time) / transit  # fraction of the cells
        count = max(4, round(MODAL_CELLS * share))
        parts.append(_cells(segment, count))
    # Each part is an array [property, cell]; the cells of all segments are joined.
    cells = Cells(*np.concatenate(parts, axis=1))
    # Each node has half of the mass of the cells on its right and on its left; the two
    # outer nodes have one cell only, hence the zeros.
    mass = (np.append(cells.cell_mass, 0.0) + np.append(0.0, cells.cell_mass)) / 2
    # The unknowns are the displacements of the n nodes, then the radial strains of the
    # n - 1 cells.
    n = len(mass)
    # `_chain(c)` is D^T diag(c) D, where D forms differences of neighbours. It has one
    # row more than c has entries: n rows for values c of cells.
    axial_inertia = np.diag(mass) + _chain(cells.lateral_inertia)
    # Shear acts between the middles of neighbouring cells: `_in_series` has one entry
    # less than there are cells, and the matrix has a row for each cell.
    shear_stiffness = _chain(_in_series(cells.shear_stiffness))
    radial_stiffness = np.diag(cells.radial_stiffness) + shear_stiffness
    K = block_diag(_chain(cells.stiffness), radial_stiffness)
    # Forces on nodes by radial strains [node, cell], and the transposed matrix.
    # `coupling` is the tension of a cell by a unit of its radial strain.
    K[:n, n:] = _differences(n).T * cells.coupling
    K[n:, :n] = K[:n, n:].T
    M = block_diag(axial_inertia, np.diag(cells.radial_inertia))
    # Radial strains without inertia belong to segments without this model: they are no
    # unknowns.
    is_unknown = np.append(np.ones(n, bool), cells.radial_inertia > 0)
    unknowns = np.ix_(is_unknown, is_unknown)
    # Mode 0, the rigid-body motion, is left out.
    squares, modes = eigh(K[unknowns], M[unknowns], subset_by_index=[1, MODES])
    axial = modes[:n]  # displacements of nodes [node, mode]; only these are damped
    # x D x/2 of each mode, as `eigh` scales modes to x M x = 1; i and j are nodes, m is
    # the mode
    decay_rates = np.einsum("im,ij,jm->m", axial, _chain(cells.viscous), axial) / 2
    slowest = int(np.argmin(decay_rates))
    omega = float(np.sqrt(squares[slowest]))
    return omega, float(decay_rates[slowest])


def _chain(values: Array) -> Array:
    """Matrix [node, node] of springs, dashpots or inertances between neighbours.

    Their constants are `values` [cell]. The matrix is D^T diag(values) D, with the
    matrix D of `_differences`. There is one node more than cells.
    """
    D = _differences(len(values) + 1)
    return np.asarray(D.T @ (values[:, None] * D))


def _differences(n: int) -> Array:
    """Matrix [n - 1, n] from values at n nodes to the differences of neighbours."""
    return np.diff(np.eye(n), axis=0)
