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

        It is (tension - b q)/k, q the radial strain of a cell and b its coupling, and 0
        in cells without stiffness, as between pieces.
        """
        force = self.force
        if self.radial.size:
            # `radial` holds q/step.
            force = force - self.cells.coupling * self.radial * step
        return quotient(force, self.cells.stiffness)

    def energies(
        self, nodes: slice, mass: Array, state: int, v: Array, step: float
    ) -> tuple[float, float]:
        """Kinetic and strain energy of neighbouring nodes and the cells between, J.

        They are those that the scheme keeps at the end of a step h, with the matrices M
        and K of inertia and stiffness: (v M v - h^2 v K v/4)/2 and u K u/2, the latter
        by the stored tensions. Cells of stiffness k add k to K between their nodes, and
        lateral inertia to M. The radial strain q of a cell has an inertia J,
        stiffnesses G and s, and the coupling b with the elongation; in terms of the
        tension its own stiffness is G - b^2/k.

        Parameters
        ----------
        nodes : slice
            From the first of the nodes to one after the last.
        mass : array
            Masses of these nodes that count, kg.
        state : int
            Index of the state.
        v : array
            Velocities of these nodes, m/s.
        step : float
            h, s.
        """
        inside = slice(nodes.start + 1, nodes.stop)  # cells between the nodes
        stretch_rate = np.diff(v)  # of these cells, m/s
        k = self.cells.stiffness[inside]
        # What cells add to M - h^2 K/4 between their nodes
        cell_inertia = self.cells.lateral_inertia[inside] - k * step**2 / 4
        twice_kinetic = mass @ (v * v) + cell_inertia @ (stretch_rate * stretch_rate)
        kinetic = float(twice_kinetic) / 2
        k_or_inf = np.where(k > 0, k, np.inf)  # cells without stiffness have no energy
        strained = float(np.sum(self.force[state, inside] ** 2 / k_or_inf)) / 2
        if not self.radial.size:  # no cell has a radial strain
            return kinetic, strained
        # Those of the radial strains are added.
        J = self.cells.radial_inertia[inside]
        b = self.cells.coupling[inside]
        G = self.cells.radial_stiffness[inside]
        # Radial strains and their rates in all cells
        all_q = self.radial[state] * step  # stored as 1/s times steps
        all_rates = self.radial_rate[state]
        # Cell i is on the left of node i: their differences on both sides of the nodes
        q_step = np.diff(all_q)[nodes]
        rate_step = np.diff(all_rates)[nodes]
        q = all_q[inside]
        rate = all_rates[inside]
        # s at the nodes. Between two rods, at the first or the last of these nodes, it
        # belongs to either rod by half.
        shear = self.shear_stiffness[nodes] / 2
        shear[1:-1] *= 2
        twice_radial_strained = (G - b * b / k_or_inf) @ q**2 + shear @ q_step**2
        # v K v without k (stretch rate)^2, which `kinetic` has already
        mixed = 2 * (b * stretch_rate) @ rate
        v_K_v = mixed + G @ rate**2 + shear @ rate_step**2
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
        """Lay out a row on a grid with `counts` cells in its segments, [segment].

        All attributes are set. Pieces end at contacts and joints, groups at contacts
        only. Nodes of rigid masses, of the ends, and beside cells whose forces are
        recorded are watched. Raise InvalidModel where cells are coupled too strongly.
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
        # This fills the lists above, and sets `cells`, or raises InvalidModel.
        last_node = self._lay_out(driven)
        self.starts, self.stops = _between(self.touching.values(), last_node)
        contacts = []  # nodes on both sides of each link that can open
        for link, nodes in self.touching.items():
            if row.links[link].law != Law.JOINT:
                contacts.append(nodes)
        group_starts, group_stops = _between(contacts, last_node)
        self.groups = list(zip(group_starts, group_stops, strict=True))
        self.ends = [0, last_node]
        self.end_cells = [1, last_node]  # cell i lies on the left of node i
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
        self.is_prescribed = np.zeros(last_node + 1, np.int64)
        for side in driven:
            self.is_prescribed[self.ends[side]] = 1
        self.pulled = [cell for _, cell in self.bonds.values()]
        watched = [*self.ends, *self.node_of_mass]
        for cell in self.pulled:
            watched.extend((cell - 1, cell))  # the nodes on both sides of the cell
        self.watched = list(dict.fromkeys(watched))  # each once
        self.has_radial_strain = bool(np.any(self.cells.radial_inertia))
        self.implicit = bool(np.any(self.viscous) or np.any(self.lateral_inertia))

    def _lay_out(self, driven: list[int]) -> int:
        """Set which nodes and cells belong to what; return the number of the last node.

        The row is walked from left to right. `cells` is set, and `first`, `last`,
        `node_of_mass`, `touching` and `bonds`, empty so far, are filled. `driven` are
        the sides (0, 1) whose velocity is prescribed: a bond there is recorded, as
        those of contacts are. InvalidModel is raised where cells are coupled too
        strongly.
        """
        row = self.row
        outer_links = (0, len(row.links) - 1)
        recorded_links = set(row.contact_link)
        for side in driven:
            recorded_links.add(outer_links[side])
        node = 0  # the last one so far: the outside begins the first piece
        parts = [NO_CELL]  # its cells; cell i lies on the left of node i
        # Link i lies between something of kind `before` and something of kind `after`:
        # "outside", "mass" or "segment", whose number is `s`.
        for i, ((before, _), (after, s)) in enumerate(row.neighbours):
            law = row.links[i].law
            if law >= Law.JOINT:  # a joint or a contact: a piece ends
                node += 1
                parts.append(NO_CELL)
                self.touching[i] = node - 1, node
            elif law == Law.BOND and i in recorded_links:
                # The bond is at a node of a rod, and is recorded with the rod's cell.
                if before == "segment":
                    cell = node
                else:
                    cell = node + 1
                self.bonds[i] = node, cell
            if after == "mass":
                self.node_of_mass.append(node)
            elif after == "segment":
                count = self.counts[s - 1]  # segments count from 1
                cells = _cells(row.segments[s - 1], count)
                _refuse_stiff(row.paths[s], cells)
                parts.append(cells)
                self.first.append(node)
                node += count
                self.last.append(node)
        # The cells beyond both ends of the row are none, too.
        self.cells = Cells(*np.concatenate([*parts, NO_CELL], axis=1))
        return node


def _between(
    cuts: Collection[tuple[int, int]], last: int
) -> tuple[list[int], list[int]]:
    """First nodes, and last nodes, of the spans of nodes between cuts, [span] each.

    Nodes are counted from 0 to `last`. A cut is a pair of neighbouring nodes between
    which it lies; the cuts come from left to right. Without cuts there is one span.
    """
    starts = [0]
    stops = []
    for left, right in cuts:
        stops.append(left)
        starts.append(right)
    stops.append(last)
    return starts, stops


def _cells(segment: Any, count: int) -> Cells:
    """The properties of `count` cells of a segment, of equal lengths.

    Where the area varies, each cell has the mean of its own. Fields of `Cells` that the
    segment's model of radial motion does not have are 0: by Rayleigh and Love it has a
    lateral inertia, by Mindlin and Herrmann a radial strain with equations of its own,
    and the stiffness is that at constant radial strain.
    """
    material = segment.material
    dx = float(segment.length) / count
    borders = np.linspace(0.0, float(segment.length), count + 1)
    area = segment.area_between(borders)  # mean between neighbouring borders [cell]
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
        # The energy of radial motion is rho nu^2 I_p (dv/dx)^2/2 a metre.
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


NO_CELL = Cells(*np.append(np.zeros(8), 1.0)[:, None])
"""A single cell, as between pieces: all is 0, but the width is 1."""


def _in_series(springs: Array) -> Array:
    """Stiffness between the middles of neighbouring cells, [node].

    `springs` [cell] are the stiffnesses of the whole cells. Half springs of two
    neighbours, of stiffness 2 a and 2 b, are in series: 2 a b/(a + b), 0 if both are 0.
    """
    a = springs[:-1]
    b = springs[1:]
    return quotient(2 * (a * b), a + b)


def quotient(a: Any, b: Array) -> Array:
    """Return a/b, and 0 where b is 0, as between pieces; b is never negative."""
    return np.asarray(a / np.where(b > 0, b, np.inf))


def check_polar_moments(row: Row) -> None:
    """Raise InvalidModel if squares of radial inertia or stiffness may not be floats.

    They are rho I_p L, kg m^2, and E I_p/L, N m, at the smallest and largest area of
    each segment that has lateral inertia; those of cells are up to `CELL_ROOM` times
    larger or smaller. The first segment that fails is named.
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
            if least < SMALLEST * CELL_ROOM or most > LARGEST / CELL_ROOM:
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
    """Time in which the fastest waves cross a segment, s.

    It is the transit time at the bar speed, but by Mindlin and Herrmann that of waves
    at constant radial strain, which are faster.
    """
    if segment.lateral_inertia != MINDLIN_HERRMANN:
        return float(segment.transit_time)
    whole = _cells(segment, 1)  # the whole segment as one cell
    return math.sqrt(float(whole.cell_mass[0] / whole.stiffness[0]))


def stable_step(segment: Any, count: int, soil_stiffness: float = 0.0) -> float:
    """Longest stable step of a segment in `count` cells, s.

    Leapfrog is stable up to 2/omega, omega of the fastest motion. That of a cell with
    transit time t has omega = 2/t; lateral inertia by Rayleigh and Love makes it
    slower, which is not used. Soil, `soil_stiffness` per length in N/m^2, adds
    soil_stiffness/(rho A) to omega^2. By Mindlin and Herrmann all nodes and all radial
    strains swing against their neighbours, and a bound of omega is the larger root of::

        (omega^2 - 4 k/m) (omega^2 - (G + 4 s)/J) = 4 b^2/(m J)

    with the mass m, stiffness k, coupling b, radial G, shear s and radial inertia J of
    a cell, taken for each cell.
    """
    by_soil = 0.0  # what soil adds to omega^2, 1/s^2
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
    # omega^2 of both motions by themselves
    axial = 4 * cells.stiffness / m
    radial = (cells.radial_stiffness + 4 * cells.shear_stiffness) / J
    # The equation is quadratic in omega^2: `root` is that of its discriminant.
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

    # The longest stable step falls with the number of cells. So the stable numbers come
    # first, and there are as many as come before the first unstable one.
    stable_count = bisect_left(range(1, count + 1), True, key=is_unstable)
    return max(1, stable_count)


def _refuse_stiff(path: str, cells: Cells) -> None:
    """Raise InvalidModel where viscosity or lateral inertia couples cells too strongly.

    The coupling of a cell over its inertia, or impedance, is `MAX_COUPLING` at most.
    `path` names the segment that has the cells in the error.
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
    """Frequency and decay rate of the mode of a free rod that lasts longest.

    The rod has these segments, and both of its ends are free. The mode is one of the
    `MODES` lowest on a mesh of about `MODAL_CELLS` cells, without the motion of the
    rigid rod.

    Returns
    -------
    float
        Angular frequency omega, rad/s.
    float
        Decay rate of the amplitude, 1/s. With the matrices of stiffness, inertia and
        damping, K x = omega^2 M x, it is x D x/(2 x M x); 0 without viscosity.
    """
    from scipy.linalg import block_diag, eigh

    transit = sum(float(segment.transit_time) for segment in segments)
    parts = []
    for segment in segments:
        share = float(segment.transit_time) / transit  # share of the cells
        count = max(4, round(MODAL_CELLS * share))
        parts.append(_cells(segment, count))
    # Each part is a matrix [property, cell]: the cells of all segments stand in a row.
    cells = Cells(*np.concatenate(parts, axis=1))
    # At each node half of the cells on its right and on its left
    mass = (np.append(cells.cell_mass, 0.0) + np.append(0.0, cells.cell_mass)) / 2
    # Unknowns are the displacements of the n nodes, then the radial strains of cells.
    n = len(mass)
    axial_inertia = np.diag(mass) + _chain(cells.lateral_inertia)
    shear_stiffness = _chain(_in_series(cells.shear_stiffness))
    radial_stiffness = np.diag(cells.radial_stiffness) + shear_stiffness
    K = block_diag(_chain(cells.stiffness), radial_stiffness)
    # Forces on nodes by radial strains [node, cell], and the transpose of them
    K[:n, n:] = _differences(n).T * cells.coupling
    K[n:, :n] = K[:n, n:].T
    M = block_diag(axial_inertia, np.diag(cells.radial_inertia))
    # Radial strains without inertia, where rods have none, are no unknowns.
    is_unknown = np.append(np.ones(n, bool), cells.radial_inertia > 0)
    unknowns = np.ix_(is_unknown, is_unknown)
    # Mode 0 is the motion of the rigid rod.
    squares, modes = eigh(K[unknowns], M[unknowns], subset_by_index=[1, MODES])
    axial = modes[:n]  # displacements of nodes [node, mode]: they alone feel viscosity
    # x D x/2 of each mode, as modes have x M x = 1
    rates = np.einsum("im,ij,jm->m", axial, _chain(cells.viscous), axial) / 2
    slowest = int(np.argmin(rates))
    return float(np.sqrt(squares[slowest])), float(rates[slowest])


def _chain(values: Array) -> Array:
    """Matrix [node, node] of springs, dashpots or inertances between neighbours.

    Their constants are `values` [cell]. The matrix is D^T diag(values) D, where D x are
    the differences of neighbouring nodes.
    """
    D = _differences(len(values) + 1)
    return np.asarray(D.T @ (values[:, None] * D))


def _differences(n: int) -> Array:
    """Matrix [n - 1, n] from values at n nodes to the differences of neighbours."""
    return np.diff(np.eye(n), axis=0)
