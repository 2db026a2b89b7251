"""From a mesh and a step to the arrays of the kernels, all but the state of motion."""

from typing import Any

import numpy as np

from ...model.frozen import InvalidModel
from ...model.profiles import averages
from ..compiling import as_records
from ..link import LINK
from ..row import Array, Row
from ..scales import wave_of_strain
from ..states import Beyond
from . import elimination_kernel as elimination
from . import records
from .mesh import Mesh, quotient
from .records import NONE, Grid

LEAST = 2.0**-800  # stiffness, where time is counted in steps
TOLERANCE = (
    2.0**-40
)  # of the velocities, below which contacts graze: round-off of many steps
KINDS = {
    "none": Beyond.STEADY,
    "force": Beyond.PUSHED,
    "velocity": Beyond.MOVED,
    "absorbing": Beyond.ENDLESS,
}


def grid_of(mesh: Mesh, step: float) -> Grid:
    """Everything at rest and without force, gaps as they are."""
    row, h, n = mesh.row, step, len(mesh.mass)
    mass, Z, cells = mesh.mass / h, _impedances(mesh), mesh.cells
    mass[mesh.ends] += Z / 2
    multipliers = eliminated(mesh, mass, bound_of(mesh, h))
    by_first, by_last = (
        answered(multipliers, np.bincount(nodes, mesh.held[nodes] == 0, n))
        for nodes in (mesh.starts, mesh.stops)
    )
    return Grid(
        run=filled(
            records.RUN,
            1,
            tolerance=TOLERANCE * row.scale,
            swells=mesh.has_radial_strain,
            implicit=mesh.implicit,
        ),
        velocity=np.zeros(n),
        force=np.zeros(n + 1),
        **dict(zip(("into", "inverse", "back"), multipliers, strict=True)),
        by_first=by_first,
        by_last=by_last,
        stiffness=mesh.stiffness * h,
        piece=filled(records.PIECE, len(mesh.starts), start=mesh.starts),
        viscous=mesh.viscous,
        lost=np.zeros(n + 1),
        change=np.zeros(n),
        old=np.zeros(n),
        strain=np.zeros(n + 1),
        rate=np.zeros(n + 1),
        ease=quotient(h, cells.swelling),
        coupling=cells.coupling * h,
        own=(cells.radial - quotient(cells.coupling**2, cells.stiffness)) * h,
        share=quotient(cells.coupling, cells.stiffness),
        shear=np.append(mesh.shear * h, 0.0),
        link=_links(mesh, h, by_first, by_last),
        end=filled(
            records.END,
            2,
            kind=[KINDS[kind] for kind, _ in row.outside],
            node=mesh.ends,
            impedance=Z,
        ),
        watched=np.array(mesh.watched, np.int64),
        pulled=np.array(mesh.pulled, np.int64),
    )


def bound_of(mesh: Mesh, step: float) -> Array:
    """By what a cell joins the changes of velocity at its nodes [cell]."""
    return np.asarray(mesh.lateral / step + mesh.viscous / 2)


def filled(kind: Any, count: int, /, **columns: Any) -> Array:
    """Records of a kind, some of whose fields are given."""
    found = np.zeros(count, kind)
    for name, values in columns.items():
        found[name] = values
    return found


def _impedances(mesh: Mesh) -> Array:
    """Impedances of endless bars beyond the ends, sqrt(E A rho A) of the cells there; else 0."""
    cells, endless = (
        mesh.end_cells,
        [kind == "absorbing" for kind, _ in mesh.row.outside],
    )
    return np.where(
        endless, np.sqrt(mesh.cells.relaxed[cells] * mesh.cell_mass[cells]), 0.0
    )


def eliminated(mesh: Mesh, mass: Array, bound: Array) -> tuple[Array, ...]:
    """Multipliers of the elimination for nodes of these masses and cells that bind them."""
    diagonal = mass + bound[:-1] + bound[1:]
    found = elimination.factor(bound.tolist(), diagonal.tolist(), mesh.held.tolist())
    return tuple(map(np.array, found))


def answered(multipliers: tuple[Array, ...], push: Any) -> Array:
    """Changes of velocity for these forces on the nodes; given ones where they are."""
    (into, inverse, back), x = multipliers, np.array(push, float)
    elimination.substitute(into, inverse, back, x)
    return x


# Links -------------------------------------------------------------------------------------------


def _links(mesh: Mesh, h: float, by_first: Array, by_last: Array) -> Array:
    """Links, each between two neighbouring pieces."""
    given = as_records([mesh.row.links[i] for i in mesh.touching], LINK)
    count, k, p = len(given), given["stiffness"], given["exponent"]
    stiffness = k * h**p
    gap = (given["gap"] + given["stretch"]) / h  # one of them is 0
    for i in np.flatnonzero((k > 0) & (stiffness < LEAST)):
        message = f"a force of {float(k[i])!r} times the indentation to the {p[i]:g} vanishes in"
        raise InvalidModel(
            [("contacts", f"{message} steps of {h:.3g} s; use a lower power")]
        )
    left, right = (
        np.array(mesh.stops[:-1], np.int64),
        np.array(mesh.starts[1:], np.int64),
    )
    # two links feel each other through a piece of one node, or one that answers as a whole
    shared = np.zeros(count)
    shared[1:] = by_first[left[1:]] / 2
    begins = np.flatnonzero(shared == 0)
    last = np.full(count, NONE)
    last[begins] = np.append(begins[1:], count) - 1
    return filled(
        records.LINK,
        count,
        **{name: given[name] for name in given.dtype.names}
        | {
            "stiffness": stiffness,
            "gap": gap,
            "shut": gap == 0,
            "last": last,
            "left": left,
            "leftmost": mesh.starts[:-1] if mesh.implicit else left,
            "right": right,
            "rightmost": mesh.stops[1:] if mesh.implicit else right,
            "own": by_last[left] / 2 + by_first[right] / 2,
            "shared": shared,
        },
    )


# What drives the ends -----------------------------------------------------------------------------


def driven(mesh: Mesh, step: float, side: int, steps: int) -> Array:
    """What is given at an end in each step: force, wave, or velocity at its end in the frame."""
    kind, value = mesh.row.outside[side]
    if kind == "velocity":
        return moved(mesh.row, step, value, step * np.arange(1, steps + 1))
    # at each kick the mean over two steps, which waves can follow
    halves = averages(value, step / 2 * np.arange(2 * steps + 2), 0.0)
    around = np.concatenate((halves[:1], halves))
    pushes = np.asarray(
        (around[:-3:2] + around[1:-2:2] + around[2:-1:2] + around[3::2]) / 4
    )
    if kind == "absorbing":
        return np.asarray(wave_of_strain(mesh.row, side) * pushes)
    return pushes


def moved(row: Row, step: float, value: Any, t: Array) -> Array:
    """Velocity of a wall or a driven end, averaged over a step about times t, in the frame."""
    edges = np.append(t - step / 2, t[-1:] + step / 2)
    found = averages(value, np.maximum(edges, 0.0), 0.0)
    return np.asarray(found - row.frame - row.system.gravity * t)
