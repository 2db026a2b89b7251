"""A row of bodies on a staggered grid: which node and which cell belongs to what.

A segment of N cells has N + 1 nodes; half of each cell's mass sits at either. Bodies that are
bonded share a node, and make one piece. A wall that can be touched is a node by itself. Cell i lies
between the nodes i - 1 and i, so the cells 0, those between pieces, and the last stand for nothing.
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
STIFFEST = (
    2.0**32
)  # times the inertia of a cell, beyond which round-off drowns its motion
CELL_ROOM = 2.0**40
"""Largest ratio of the radial inertia or stiffness of a segment to that of its cells."""
MODAL_CELLS, MODES = 200, 8  # of a rod whose lowest modes are asked for


class Cells(NamedTuple):
    """What cells are made of, all [cell] arrays; q is the radial strain of `lateral_inertia`.

    cell_mass rho A dx, kg; stiffness (E, or lambda + 2 mu at constant q) A/dx, N/m
    viscous eta A/dx, N s/m; lateral rho nu^2 I_p/dx, kg, by Rayleigh and Love
    By Mindlin and Herrmann: swelling, the inertia m rho I_p dx of q, kg m^2; coupling 2 lambda A,
    tension for a unit of q, N; radial 4 (lambda + mu) A dx and shear s mu I_p/dx, N m.
    width dx, m; 1 between pieces, where all else is 0.
    """

    cell_mass: Array
    stiffness: Array
    viscous: Array
    lateral: Array
    swelling: Array
    coupling: Array
    radial: Array
    shear: Array
    width: Array

    @property
    def relaxed(self) -> Array:
        """Stiffness E A/dx [cell] of slow stretching, where q follows, N/m."""
        return self.stiffness - quotient(self.coupling**2, self.radial)


class GridMotion(NamedTuple):
    """What a grid knows of the motion: the mesh, states at some times, forces from outside a piece.

    counts, first, last, starts : by segment, and by piece, as in `Mesh`
    mass, shear [node]; cells : as there
    when [state] in steps; velocity [state, node] in m/s, in the frame; force [state, cell] in N;
    place [state, piece] in m/s times steps; lost [state] in W times steps
    radial, radial_rate [state, cell] : radial strain in 1/s times steps, and its rate in 1/s;
    [state, 0] where no cell has its own
    pushes : by node, [steps] mean force to the right from outside its piece, N
    """

    counts: Sequence[int]
    first: Sequence[int]
    last: Sequence[int]
    starts: Sequence[int]
    mass: Array
    shear: Array
    cells: Cells
    when: Array
    velocity: Array
    force: Array
    place: Array
    lost: Array
    radial: Array
    radial_rate: Array
    pushes: Mapping[int, Array]

    def stretches(self, step: float) -> Array:
        """By how much cells are longer [state, cell], m."""
        force, k = self.force, self.cells.stiffness
        if self.radial.size:
            force = force - self.cells.coupling * self.radial * step
        return quotient(force, k)

    def energies(
        self, nodes: slice, mass: Array, place: int, v: Array, step: float
    ) -> tuple[float, float]:
        """Kinetic and strain energy of some nodes of these masses and velocities in a state, J."""
        inside, change = slice(nodes.start + 1, nodes.stop), np.diff(v)
        _, k, _, lateral, J, b, G, *_ = (x[inside] for x in self.cells)
        bound = lateral - k * step**2 / 4
        k = np.where(k > 0, k, np.inf)
        kinetic = float(mass @ (v * v) + bound @ (change * change)) / 2
        strained = float(np.sum(self.force[place, inside] ** 2 / k)) / 2
        if not self.radial.size:
            return kinetic, strained
        q, p = self.radial[place] * step, self.radial_rate[place]
        slope, faster, q, p = np.diff(q)[nodes], np.diff(p)[nodes], q[inside], p[inside]
        shear = (
            self.shear[nodes] / 2
        )  # a spring between two rods belongs to either by half
        shear[1:-1] *= 2
        swollen = (G - b * b / k) @ q**2 + shear @ slope**2
        less = 2 * (b * change) @ p + G @ p**2 + shear @ faster**2
        moving = J @ p**2 - step * step / 4 * less
        return kinetic + float(moving) / 2, strained + float(swollen) / 2


class Mesh:
    """A row on a grid, in SI.

    Attributes
    ----------
    row : Row
    counts : list of int
        Cells of each segment.
    first, last : list of int
        Nodes of each segment, counted from 1 as in the row; entry 0 is empty.
    node_of_mass : list of int
    starts, stops : list of int
        First and last node of each piece.
    mass, held : [node] array
        kg; whether the velocity is given.
    cells : Cells
    cell_mass, stiffness, viscous, lateral, width : [cell] array
        Of the cells.
    shear : [node] array
        Of the radial strain of its two cells, those of `Cells` in series, N m.
    touching : dict of int to (int, int)
        By link of a law: the nodes on its left and on its right.
    ends, end_cells : list of int
        Node on which the outside acts, left and right, and the cell beside it.
    bonds : dict of int to (int, int)
        By bonded link whose force is asked for: its node, and the cell of a rod beside it.
    watched, pulled : list of int
        Nodes whose velocities are asked for at the end of each step, cells whose forces are.
    groups : list of (int, int)
        First and last node of all that hangs together: pieces, with the joints between them.
    swells : bool
        Whether cells have a radial strain of their own.
    implicit : bool
        Whether new velocities depend on each other: there is damping or lateral inertia.

    Raises
    ------
    InvalidModel
        If viscosity or lateral inertia is out of all proportion to the mass.
    """

    def __init__(self, row: Row, counts: list[int]) -> None:
        self.row, self.counts = row, counts
        self.first, self.last = [-1], [-1]
        self.node_of_mass: list[int] = []
        self.touching: dict[int, tuple[int, int]] = {}
        self.bonds: dict[int, tuple[int, int]] = {}
        node, parts, outer = -1, list[Cells](), (0, len(row.links) - 1)
        driven = [
            side for side, (kind, _) in enumerate(row.outside) if kind == "velocity"
        ]
        asked = {*row.contact_link, *(outer[side] for side in driven)}
        for i, ((before, _), (kind, s)) in enumerate(row.beside):
            apart = row.links[i].law >= Law.JOINT
            for _ in range(
                (i == 0) + apart
            ):  # what lies outside begins the first piece
                node += 1
                parts.append(NO_CELL)
            if apart:
                self.touching[i] = node - 1, node
            elif (
                row.links[i].law == Law.BOND and i in asked
            ):  # of a rod and something else
                self.bonds[i] = node, node + (before != "segment")
            if kind == "mass":
                self.node_of_mass.append(node)
            elif kind == "segment":
                parts.append(_cells(row.segments[s - 1], counts[s - 1]))
                _refuse_stiff(row.paths[s], parts[-1])
                self.first.append(node)
                node += counts[s - 1]
                self.last.append(node)
        self.starts, self.stops = _between(self.touching.values(), node)
        open_links = [
            of for i, of in self.touching.items() if row.links[i].law != Law.JOINT
        ]
        self.groups = list(zip(*_between(open_links, node), strict=True))
        self.ends, self.end_cells = [0, node], [1, node]
        self.cells = Cells(*np.concatenate([*parts, NO_CELL], axis=1))
        self.cell_mass, self.stiffness, self.viscous, self.lateral, *_, self.width = (
            self.cells
        )
        self.mass = (self.cell_mass[:-1] + self.cell_mass[1:]) / 2
        self.shear = _in_series(self.cells.shear)
        self.mass[self.node_of_mass] += row.masses
        self.shear[self.node_of_mass] = 0.0
        self.held = np.zeros(node + 1, np.int64)
        self.held[[self.ends[side] for side in driven]] = 1
        self.pulled = [cell for _, cell in self.bonds.values()]
        beside = (node for cell in self.pulled for node in (cell - 1, cell))
        self.watched = list(dict.fromkeys([*self.ends, *self.node_of_mass, *beside]))
        self.swells = bool(np.any(self.cells.swelling))
        self.implicit = bool(np.any(self.viscous) or np.any(self.lateral))


def _between(
    cuts: Collection[tuple[int, int]], last: int
) -> tuple[list[int], list[int]]:
    """First and last nodes of what lies between pairs of neighbouring nodes, up to the last one."""
    return [0, *(right for _, right in cuts)], [*(left for left, _ in cuts), last]


def _cells(segment: Any, count: int) -> Cells:
    """The cells of a segment."""
    material, dx = segment.material, float(segment.length) / count
    area = segment.area_between(np.linspace(0.0, float(segment.length), count + 1))
    E, rho = float(material.youngs_modulus), float(material.density)
    stiffness, polar = E * area / dx, segment.polar_moments(area)
    lateral, swelling, coupling, radial, shear = np.zeros((5, count))
    if segment.lateral_inertia == MINDLIN_HERRMANN:
        moduli = radial_moduli(E, float(material.poisson_ratio))
        stiffness = moduli.axial * area / dx
        swelling, coupling = INERTIA * rho * polar * dx, moduli.coupling * area
        radial, shear = moduli.radial * area * dx, moduli.shear * polar / dx
    elif segment.lateral_inertia is not None:
        lateral = rho * float(material.poisson_ratio) ** 2 * polar / dx
    viscous = float(material.viscosity) * area / dx
    return Cells(
        rho * area * dx,
        stiffness,
        viscous,
        lateral,
        swelling,
        coupling,
        radial,
        shear,
        np.full(count, dx),
    )


NO_CELL = Cells(*np.append(np.zeros(8), 1.0)[:, None])


def _in_series(springs: Array) -> Array:
    """Of neighbours half of each in series [node]."""
    left, right = springs[:-1], springs[1:]
    return quotient(2 * (left * right), left + right)


def quotient(a: Any, b: Array) -> Array:
    """a/b, and 0 where b is 0, as between pieces."""
    return np.asarray(a / np.where(b > 0, b, np.inf))


def check_polar_moments(row: Row) -> None:
    """Raise InvalidModel where radial inertia or stiffness in a section is beyond floats.

    They are rho I_p L, kg m^2, and E I_p/L, N m; in cells they are a number of times larger or
    smaller, and their squares are computed.
    """
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
                    "makes radial inertia or stiffness whose squares overflow or vanish, got "
                    f"{area!r}; take an area nearer to 1 in consistent units"
                )
                raise InvalidModel([(f"{path}.area", message)])


def crossing_time(segment: Any) -> float:
    """Time in which the fastest waves cross a segment, s."""
    if segment.lateral_inertia != MINDLIN_HERRMANN:
        return float(segment.transit_time)
    whole = _cells(segment, 1)
    return math.sqrt(float(whole.cell_mass[0] / whole.stiffness[0]))


def stable_step(segment: Any, count: int) -> float:
    """Longest stable step of a segment in so many cells, s.

    Leapfrog is stable up to 2/omega of the fastest motion. By Mindlin and Herrmann that is the one
    in which all nodes and all radial strains swing against their neighbours; its equation is a
    bound where cells differ, too::

        (omega^2 - 4 k/m) (omega^2 - (G + 4 s)/J) = 4 b^2/(m J)

    with the mass m, stiffness k, coupling b, radial G, shear s and swelling J of a cell.
    """
    if segment.lateral_inertia != MINDLIN_HERRMANN:
        return float(segment.transit_time) / count
    m, k, _, _, J, b, G, s, _ = _cells(segment, count)
    axial, radial = 4 * k / m, (G + 4 * s) / J
    square = (axial + radial + np.hypot(axial - radial, 4 * b / np.sqrt(m * J))) / 2
    return 2 / math.sqrt(float(square.max()))


def most_cells(segment: Any, count: int, step: float) -> int:
    """How many cells, `count` at most, a segment may have for a step in s to be stable."""
    unstable = bisect_left(
        range(1, count + 1), True, key=lambda N: stable_step(segment, N) < step
    )
    return max(1, unstable)


def _refuse_stiff(path: str, cells: Cells) -> None:
    """Raise InvalidModel where cells resist changes of length so much that nothing else counts."""
    impedance = np.sqrt(cells.stiffness) * np.sqrt(cells.cell_mass)
    sizes = {
        "material.viscosity": cells.viscous / impedance,
        "lateral_inertia": cells.lateral / cells.cell_mass,
    }
    for name, size in sizes.items():
        if size.max() > STIFFEST:
            message = (
                f"couples cells {size.max():.2g} times as strongly as their inertia, so round-off "
                "hides the motion; take a smaller value, or a RigidMass"
            )
            raise InvalidModel([(f"{path}.{name}", message)])


def lasting_mode(segments: Sequence[Segment]) -> tuple[float, float]:
    """Mode of a free rod by itself that lasts longest.

    Returns
    -------
    angular frequency, decay rate of the amplitude : float
        rad/s and 1/s; a mode x of K x = omega^2 M x decays at x D x/(2 x M x).
    """
    from scipy.linalg import block_diag, eigh

    transit = sum(float(s.transit_time) for s in segments)
    counts = [
        max(4, round(MODAL_CELLS * float(s.transit_time) / transit)) for s in segments
    ]
    parts = [_cells(s, N) for s, N in zip(segments, counts, strict=True)]
    mass, stiffness, viscous, lateral, *_ = cells = Cells(
        *np.concatenate(parts, axis=1)
    )
    M = np.diag((np.append(mass, 0.0) + np.append(0.0, mass)) / 2) + _chain(lateral)
    K = block_diag(
        _chain(stiffness), np.diag(cells.radial) + _chain(_in_series(cells.shear))
    )
    n = len(M)
    K[:n, n:] = np.diff(np.eye(n), axis=0).T * cells.coupling
    K[n:, :n] = K[:n, n:].T
    kept = np.append(np.ones(n, bool), cells.swelling > 0)
    M = block_diag(M, np.diag(cells.swelling))[np.ix_(kept, kept)]
    squares, modes = eigh(K[np.ix_(kept, kept)], M, subset_by_index=[1, MODES])
    rates = np.einsum("im,ij,jm->m", modes[:n], _chain(viscous), modes[:n]) / 2
    slowest = int(np.argmin(rates))
    return float(np.sqrt(squares[slowest])), float(rates[slowest])


def _chain(values: Array) -> Array:
    """Matrix of springs, dashpots or inertances between neighbouring nodes."""
    difference = np.diff(np.eye(len(values) + 1), axis=0)
    return np.asarray(difference.T @ (values[:, None] * difference))
