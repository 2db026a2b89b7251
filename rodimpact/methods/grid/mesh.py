"""The mesh of a row: which node and which cell belongs to which body.

A segment of N cells has N + 1 nodes. Half of the mass of each cell sits at either of
its nodes. Bodies that are bonded share a node and make one piece of neighbouring nodes.
A wall that can be touched is a node by itself. Cell i lies between the nodes i - 1 and
i. Cell 0, the cells between pieces and the last cell have no mass and no stiffness.
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
"""Ticks of a time step: times between two states are looked up in these."""
MAX_COUPLING = 2.0**32
"""Largest coupling of neighbouring nodes over the inertia of a cell.

Beyond it round-off hides the motion.
"""
CELL_ROOM = 2.0**40
"""Largest ratio of radial inertia or stiffness of a segment to that of its cells."""
MODAL_CELLS = 200
"""Cells of a rod whose lowest modes are computed."""
MODES = 8
"""Lowest modes, among which that with the slowest decay is searched for."""


class Cells(NamedTuple):
    """Properties of the cells, all [cell].

    q is the radial strain by Mindlin and Herrmann.
    """

    cell_mass: Array
    """rho A dx, kg."""
    stiffness: Array
    """E A/dx, N/m; by Mindlin and Herrmann (lambda + 2 mu) A/dx, at constant q."""
    viscous: Array
    """eta A/dx, N s/m."""
    lateral_inertia: Array
    """rho nu^2 I_p/dx, kg, by Rayleigh and Love."""
    radial_inertia: Array
    """Inertia of q, m rho I_p dx, kg m^2, by Mindlin and Herrmann."""
    coupling: Array
    """Tension for a unit of q, 2 lambda A, N."""
    radial_stiffness: Array
    """4 (lambda + mu) A dx, N m."""
    shear_stiffness: Array
    """s mu I_p/dx, N m, between neighbouring cells."""
    width: Array
    """dx, m; 1 between pieces, where all else is 0."""

    @property
    def relaxed_stiffness(self) -> Array:
        """Stiffness E A/dx [cell] of slow stretching, where q follows, N/m."""
        return self.stiffness - quotient(self.coupling**2, self.radial_stiffness)


class GridMotion(NamedTuple):
    """The motion on a grid at some times.

    It has the mesh, states, and forces from outside a piece.
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
    """Time steps after which the states were kept [state]."""
    velocity: Array
    """m/s, in the frame [state, node]."""
    force: Array
    """Elastic tension, N [state, cell]."""
    displacement: Array
    """Displacement of the first node of each piece, m/s times steps [state, piece]."""
    lost: Array
    """Energy turned to heat, W times steps [state]."""
    radial: Array
    """Radial strain, 1/s times steps [state, cell].

    It is [state, 0] where no cell has its own.
    """
    radial_rate: Array
    """Rate of the radial strain, 1/s [state, cell]."""
    resistance: Array
    """Static resistance of the soil, N [state, node that soil holds]."""
    soil: Array
    """`records.SOIL` [node that soil holds]."""
    soil_force: Array
    """Force of the soil, N, to the right [state, node that soil holds]."""
    pushes: Mapping[int, Array]
    """Mean force to the right from outside its piece in a step, N [step], by node."""

    def stretches(self, step: float) -> Array:
        """Elongation of the cells, m [state, cell]; `step` in s.

        It is (tension - b q)/k, q the radial strain of a cell.
        """
        force = self.force
        if self.radial.size:
            # `radial` holds q/step.
            force = force - self.cells.coupling * self.radial * step
        return quotient(force, self.cells.stiffness)

    def energies(
        self, nodes: slice, mass: Array, state: int, v: Array, step: float
    ) -> tuple[float, float]:
        """Kinetic and strain energy of neighbouring nodes and their cells, J.

        The cells are those between these nodes. At the end of a step h the scheme keeps
        (v M v - h^2 v K v/4 + u K u)/2. The first two terms are the kinetic energy: K
        is k between neighbours, and lateral inertia adds to M there. The radial strain
        q of a cell has an inertia J, stiffnesses G and s, and the coupling b with the
        elongation; in terms of the tension its own stiffness is G - b^2/k.

        Parameters
        ----------
        nodes : slice
        mass : array
            Masses of these nodes that count, kg.
        state : int
            Index of the state.
        v : array
            Velocities of these nodes, m/s.
        step : float
            s.
        """
        inside = slice(nodes.start + 1, nodes.stop)  # cells between the nodes
        change = np.diff(v)
        k = self.cells.stiffness[inside]
        # What cells add to M - h^2 K/4 between their nodes
        off_diagonal = self.cells.lateral_inertia[inside] - k * step**2 / 4
        k = np.where(k > 0, k, np.inf)  # cells without stiffness have no energy
        kinetic = float(mass @ (v * v) + off_diagonal @ (change * change)) / 2
        strained = float(np.sum(self.force[state, inside] ** 2 / k)) / 2
        if not self.radial.size:
            return kinetic, strained
        J = self.cells.radial_inertia[inside]
        b = self.cells.coupling[inside]
        G = self.cells.radial_stiffness[inside]
        q = self.radial[state] * step  # stored as 1/s times steps
        rate = self.radial_rate[state]  # rate of q
        slope = np.diff(q)[nodes]  # difference of the cells beside each node
        slope_rate = np.diff(rate)[nodes]
        q = q[inside]
        rate = rate[inside]
        # A spring between two rods, at an end of the nodes, belongs to either by half.
        shear = self.shear_stiffness[nodes] / 2
        shear[1:-1] *= 2
        radial_strained = (G - b * b / k) @ q**2 + shear @ slope**2
        # v K v without k (dv)^2, which the kinetic energy has already
        stiffness_term = 2 * (b * change) @ rate + G @ rate**2 + shear @ slope_rate**2
        moving = J @ rate**2 - step * step / 4 * stiffness_term  # twice the energy
        return kinetic + float(moving) / 2, strained + float(radial_strained) / 2


class Mesh:
    """A row on a grid, in SI.

    Attributes
    ----------
    row : Row
    counts : list of int
        Number of cells of each segment.
    first, last : list of int
        First and last node of each segment, counted from 1 as in the row; entry 0 is
        empty.
    node_of_mass : list of int
        Node of each rigid mass.
    starts, stops : list of int
        First and last node of each piece.
    mass, is_prescribed : [node] array
        kg; 1 where the velocity is prescribed, else 0.
    cells : Cells
    cell_mass, stiffness, viscous, lateral_inertia, width : [cell] array
        Columns of `cells`.
    shear_stiffness : [node] array
        Shear stiffness between the radial strains of the two cells of a node, N m:
        those of `Cells` in series.
    touching : dict of int to (int, int)
        Nodes on the left and on the right of each link that has a law.
    ends, end_cells : list of int
        Node on which the outside acts, left and right, and the cell beside it.
    bonds : dict of int to (int, int)
        Node of each bonded link whose force is recorded, and the cell of a rod beside
        it.
    watched, pulled : list of int
        Nodes whose velocities, and cells whose forces, are recorded in each step.
    groups : list of (int, int)
        First and last node of each group of pieces with joints between them.
    has_radial_strain : bool
        Whether cells have a radial strain of their own.
    implicit : bool
        Whether new velocities depend on each other: there is damping or lateral
        inertia.

    Raises
    ------
    InvalidModel
        If viscosity or lateral inertia is out of all proportion to the mass.
    """

    def __init__(self, row: Row, counts: list[int]) -> None:
        """Lay out a row on a grid with `counts` cells in its segments.

        All attributes are set. Pieces end at contacts and joints, groups at contacts
        only. Nodes of rigid masses, of the ends, and beside cells whose forces are
        recorded are watched.
        """
        self.row = row
        self.counts = counts
        self.first = [-1]  # segments count from 1
        self.last = [-1]
        self.node_of_mass: list[int] = []
        self.touching: dict[int, tuple[int, int]] = {}
        self.bonds: dict[int, tuple[int, int]] = {}
        driven = []
        for side, (kind, _) in enumerate(row.boundaries):
            if kind == "velocity":
                driven.append(side)
        # This fills the lists above, and sets `cells`.
        node = self._lay_out(driven)  # the last one
        self.starts, self.stops = _between(self.touching.values(), node)
        open_links = []  # nodes of the links that can open
        for link, nodes in self.touching.items():
            if row.links[link].law != Law.JOINT:
                open_links.append(nodes)
        self.groups = list(zip(*_between(open_links, node), strict=True))
        self.ends = [0, node]
        self.end_cells = [1, node]  # cell i lies on the left of node i
        self.cell_mass = self.cells.cell_mass
        self.stiffness = self.cells.stiffness
        self.viscous = self.cells.viscous
        self.lateral_inertia = self.cells.lateral_inertia
        self.width = self.cells.width
        # Half of the mass of the cells on both sides
        self.mass = (self.cell_mass[:-1] + self.cell_mass[1:]) / 2
        self.shear_stiffness = _in_series(self.cells.shear_stiffness)
        self.mass[self.node_of_mass] += row.masses
        # Cells on both sides of a rigid mass swell independently.
        self.shear_stiffness[self.node_of_mass] = 0.0
        self.is_prescribed = np.zeros(node + 1, np.int64)
        self.is_prescribed[[self.ends[side] for side in driven]] = 1
        self.pulled = [cell for _, cell in self.bonds.values()]
        watched = [*self.ends, *self.node_of_mass]
        for cell in self.pulled:
            watched.extend((cell - 1, cell))  # the nodes on both sides of the cell
        self.watched = list(dict.fromkeys(watched))  # each once
        self.has_radial_strain = bool(np.any(self.cells.radial_inertia))
        self.implicit = bool(np.any(self.viscous) or np.any(self.lateral_inertia))

    def _lay_out(self, driven: list[int]) -> int:
        """Set which nodes and cells belong to what; return the last node.

        The row is walked from left to right. `cells` is set, and `first`, `last`,
        `node_of_mass`, `touching` and `bonds` are filled. `driven` are the sides whose
        velocity is prescribed: the force there is recorded.
        """
        row = self.row
        outer_links = (0, len(row.links) - 1)
        # Links that are recorded if they are bonds: contacts, and those of driven ends
        recorded_links = {*row.contact_link, *(outer_links[side] for side in driven)}
        node = -1  # the last one so far
        parts: list[Cells] = []
        # Link i lies between what stands before it and a thing of this kind and number.
        for i, ((before, _), (kind, s)) in enumerate(row.neighbours):
            law = row.links[i].law
            if i == 0:  # the outside begins the first piece
                node += 1
                parts.append(NO_CELL)
            if law >= Law.JOINT:  # a joint or a contact: a piece ends
                node += 1
                parts.append(NO_CELL)
                self.touching[i] = node - 1, node
            elif law == Law.BOND and i in recorded_links:  # a rod and something else
                # The cell of the rod: cell i lies on the left of node i.
                if before == "segment":
                    cell = node
                else:
                    cell = node + 1
                self.bonds[i] = node, cell
            if kind == "mass":
                self.node_of_mass.append(node)
            elif kind == "segment":
                cells = _cells(row.segments[s - 1], self.counts[s - 1])
                _refuse_stiff(row.paths[s], cells)
                parts.append(cells)
                self.first.append(node)
                node += self.counts[s - 1]
                self.last.append(node)
        self.cells = Cells(*np.concatenate([*parts, NO_CELL], axis=1))
        return node


def _between(
    cuts: Collection[tuple[int, int]], last: int
) -> tuple[list[int], list[int]]:
    """First nodes, and last nodes, of the spans of nodes between cuts, [span] each.

    Nodes are counted from 0 to `last`. A cut is a pair of neighbouring nodes, from left
    to right.
    """
    starts = [0]
    stops = []
    for left, right in cuts:  # nodes on both sides of a cut
        stops.append(left)
        starts.append(right)
    return starts, [*stops, last]


def _cells(segment: Any, count: int) -> Cells:
    """The properties of `count` cells of a segment, of equal lengths.

    Where the area varies, each cell has the mean of its own. Radial motion adds a
    lateral inertia (Rayleigh and Love), or a radial strain with equations of its own
    (Mindlin and Herrmann).
    """
    material = segment.material
    dx = float(segment.length) / count
    area = segment.area_between(np.linspace(0.0, float(segment.length), count + 1))
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
    polar = segment.polar_moments(area)
    if segment.lateral_inertia != MINDLIN_HERRMANN:  # Rayleigh and Love
        lateral = rho * float(material.poisson_ratio) ** 2 * polar / dx
        return cells._replace(lateral_inertia=lateral)
    moduli = radial_moduli(E, float(material.poisson_ratio))
    return cells._replace(
        stiffness=moduli.axial * area / dx,
        radial_inertia=INERTIA * rho * polar * dx,  # corrected by INERTIA
        coupling=moduli.coupling * area,
        radial_stiffness=moduli.radial * area * dx,
        shear_stiffness=moduli.shear * polar / dx,
    )


NO_CELL = Cells(*np.append(np.zeros(8), 1.0)[:, None])


def _in_series(springs: Array) -> Array:
    """Stiffness between the middles of neighbouring cells, [node].

    The cells have these springs, [cell]. Two half springs, of stiffness 2 a and 2 b,
    are in series: 2 a b/(a + b).
    """
    a = springs[:-1]
    b = springs[1:]
    return quotient(2 * (a * b), a + b)


def quotient(a: Any, b: Array) -> Array:
    """Return a/b, and 0 where b is 0, as between pieces; b is never negative."""
    return np.asarray(a / np.where(b > 0, b, np.inf))


def check_polar_moments(row: Row) -> None:
    """Raise InvalidModel if radial inertia or stiffness of a section is beyond floats.

    They are rho I_p L, kg m^2, and E I_p/L, N m; in cells they are a number of times
    larger or smaller, and their squares are computed.
    """
    # Path 0 is empty: segments are counted from 1.
    for path, segment in zip(row.paths[1:], row.segments, strict=True):
        if segment.lateral_inertia is None:
            continue
        material = segment.material
        length = float(segment.length)
        for area in map(float, extremes(segment.area)):
            polar = float(segment.polar_moments(np.asarray(area)))
            sizes = (
                float(material.density) * polar * length,
                float(material.youngs_modulus) * polar / length,
            )
            if min(sizes) < SMALLEST * CELL_ROOM or max(sizes) > LARGEST / CELL_ROOM:
                message = (
                    "makes radial inertia or stiffness whose squares overflow or "
                    f"vanish, got {area!r}; take an area nearer to 1 in consistent "
                    "units"
                )
                raise InvalidModel([(f"{path}.area", message)])


def half_cell_edges(left: float, length: float, count: int) -> Array:
    """Edges of the half cells of a segment, m [2 * count + 1].

    The segment begins at `left`, m, and has `count` cells on its `length`, m.
    """
    return np.asarray(left + length * np.arange(2 * count + 1) / (2 * count))


def nodes_of_half_cells(count: int) -> Array:
    """Node beside each half cell of `count` cells in a row, [2 * count].

    The nodes are 0, 1, 1, 2, 2, ...
    """
    return np.asarray((np.arange(2 * count) + 1) // 2)


def crossing_time(segment: Any) -> float:
    """Time in which the fastest waves cross a segment, s."""
    if segment.lateral_inertia != MINDLIN_HERRMANN:
        return float(segment.transit_time)
    whole = _cells(segment, 1)
    return math.sqrt(float(whole.cell_mass[0] / whole.stiffness[0]))


def stable_step(segment: Any, count: int, soil_stiffness: float = 0.0) -> float:
    """Longest stable step of a segment in `count` cells, s.

    Leapfrog is stable up to 2/omega of the fastest motion. Soil of a stiffness per
    length, N/m^2, adds soil_stiffness/(rho A) to the square of omega. The fastest
    motion of a cell with transit time t has omega = 2/t; lateral inertia by Rayleigh
    and Love makes it slower. By Mindlin and Herrmann it is the motion in which all
    nodes and all radial strains swing against their neighbours. Its equation is a bound
    where cells differ, too::

        (omega^2 - 4 k/m) (omega^2 - (G + 4 s)/J) = 4 b^2/(m J)

    with the mass m, stiffness k, coupling b, radial G, shear s and radial inertia J of
    a cell.
    """
    by_soil = 0.0
    if soil_stiffness > 0:
        least_area = float(min(extremes(segment.area)))
        by_soil = soil_stiffness / (float(segment.material.density) * least_area)
    if segment.lateral_inertia != MINDLIN_HERRMANN:
        cell_transit = float(segment.transit_time) / count
        # 2/sqrt(4/t^2 + by_soil)
        return cell_transit / math.sqrt(1 + by_soil * (cell_transit / 2) ** 2)
    cells = _cells(segment, count)
    m = cells.cell_mass
    J = cells.radial_inertia
    # omega^2 of both motions by themselves
    axial = 4 * cells.stiffness / m
    radial = (cells.radial_stiffness + 4 * cells.shear_stiffness) / J
    # The larger root of the equation, which is quadratic in omega^2
    mixed = np.hypot(axial - radial, 4 * cells.coupling / np.sqrt(m * J))
    square = (axial + radial + mixed) / 2
    return 2 / math.sqrt(float(square.max()) + by_soil)


def most_cells(segment: Any, count: int, step: float) -> int:
    """Largest number of cells of a segment for which a step in s is stable.

    It is `count` at most, and at least 1, even if a step is too long for a single cell.
    The longest stable step falls with the number of cells, so the stable numbers come
    first, and there are as many as the place of the first unstable one.
    """
    stable_count = bisect_left(
        range(1, count + 1), True, key=lambda N: stable_step(segment, N) < step
    )
    return max(1, stable_count)


def _refuse_stiff(path: str, cells: Cells) -> None:
    """Raise InvalidModel where viscosity or lateral inertia couples cells too strongly.

    `path` is that of the segment which has the cells.
    """
    impedance = np.sqrt(cells.stiffness) * np.sqrt(cells.cell_mass)  # kg/s [cell]
    sizes = {
        "material.viscosity": cells.viscous / impedance,
        "lateral_inertia": cells.lateral_inertia / cells.cell_mass,
    }
    for name, size in sizes.items():
        if size.max() > MAX_COUPLING:
            message = (
                f"couples cells {size.max():.2g} times as strongly as their inertia, "
                "so round-off hides the motion; take a smaller value, or a RigidMass"
            )
            raise InvalidModel([(f"{path}.{name}", message)])


def lasting_mode(segments: Sequence[Segment]) -> tuple[float, float]:
    """Find the mode of a free rod by itself that lasts longest.

    It is one of the lowest `MODES`.

    Returns
    -------
    angular frequency, decay rate of the amplitude : float
        rad/s and 1/s; a mode x of K x = omega^2 M x decays at x D x/(2 x M x).
    """
    from scipy.linalg import block_diag, eigh

    transit = sum(float(segment.transit_time) for segment in segments)
    parts = []
    for segment in segments:
        share = float(segment.transit_time) / transit  # share of the cells
        parts.append(_cells(segment, max(4, round(MODAL_CELLS * share))))
    # Each part is a matrix [property, cell]: the cells of all segments stand in a row.
    cells = Cells(*np.concatenate(parts, axis=1))
    # Half of the cells on the right and on the left of each node
    mass = (np.append(cells.cell_mass, 0.0) + np.append(0.0, cells.cell_mass)) / 2
    axial_inertia = np.diag(mass) + _chain(cells.lateral_inertia)
    radial = np.diag(cells.radial_stiffness) + _chain(_in_series(cells.shear_stiffness))
    # Unknowns are the displacements of nodes, then the radial strains of cells.
    K = block_diag(_chain(cells.stiffness), radial)
    n = len(axial_inertia)
    K[:n, n:] = _differences(n).T * cells.coupling
    K[n:, :n] = K[:n, n:].T
    # Unknowns with inertia: without lateral inertia
    # radial strains have none, and are left out.
    moves = np.append(np.ones(n, bool), cells.radial_inertia > 0)
    inside = np.ix_(moves, moves)
    M = block_diag(axial_inertia, np.diag(cells.radial_inertia))[inside]
    # Mode 0 is the motion of the rigid rod.
    squares, modes = eigh(K[inside], M, subset_by_index=[1, MODES])
    axial = modes[:n]  # displacements of nodes, which alone feel viscosity
    # Modes have x M x = 1, so that x D x/2 is the rate.
    rates = np.einsum("im,ij,jm->m", axial, _chain(cells.viscous), axial) / 2
    slowest = int(np.argmin(rates))
    return float(np.sqrt(squares[slowest])), float(rates[slowest])


def _chain(values: Array) -> Array:
    """Matrix of springs, dashpots or inertances between neighbours.

    Their constants are [cell]. The matrix is D^T diag(values) D, D the differences of
    neighbouring nodes.
    """
    D = _differences(len(values) + 1)
    return np.asarray(D.T @ (values[:, None] * D))


def _differences(n: int) -> Array:
    """Matrix [n - 1, n] from values at n nodes to the differences of neighbours."""
    return np.diff(np.eye(n), axis=0)
