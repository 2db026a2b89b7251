"""A row at rest: rods, soil and contacts that carry the weights."""

from typing import Any

import numpy as np

from ..hints import explain_arguments
from ..methods.grid.method import mesh_size
from ..methods.row_builder import build_row
from ..model import Fixed, Joint, Plastic, Rigid, Rod, Soil, Steps, System, Wall
from ..model.arguments import check_kind, demand, integer
from ..model.ends import FREE
from .statics import (
    Chain,
    Equilibrium,
    cell_edges,
    chain_of,
    check_bears,
    find_equilibrium,
    moves,
    nodes_of,
    soil_of_rod,
)

CELLS = 100
"""Default number of cells of the segment with the longest transit time."""
MAX_CELLS = 10_000
"""Largest number of cells that a call may ask for."""


@explain_arguments
def at_rest(system: System, cells: int = CELLS) -> System:
    """Move a system to its equilibrium, in which all weights are carried.

    The given state may be an unloaded pile under gravity, or a pile after a blow. In
    equilibrium rods, soil and contacts are deformed elastically. Bodies that move at t
    = 0, such as the ram, are not changed, and their weight acts on no other body.

    Parameters
    ----------
    system : System
        A single system whose ends are free, fixed, or walls. Contacts that carry a
        weight have a constant stiffness, or are `Rigid` or `Bonded`.
    cells : int, optional
        Cells of the segment with the longest transit time, as for `solve`. Strain and
        mobilised resistance are constant in each cell, so a run with the same number of
        cells stays at rest to round-off.

    Returns
    -------
    System
        With `strain` of rods, `mobilised` of soil, gaps, and laws that have yielded
        under the weight, at rest.

    Raises
    ------
    InvalidModel
        If nothing holds a body, or soil yields under the weight.

    Examples
    --------
    A pile of 11 kN in soil of 400 kN mobilises 2.8 % of it:

    >>> import rodimpact as ri
    >>> soil = ri.Soil(resistance=400e3, quake=2.5e-3)
    >>> pile = ri.Rod(15.0, area=0.0094, material=ri.materials.steel, shaft=soil)
    >>> resting = ri.at_rest(ri.System([pile], gravity=9.81))
    >>> shares = resting.bodies[0].shaft.mobilised.values
    >>> bool(0.027 < min(shares) < max(shares) < 0.028)
    True

    A hanging rod has the strain rho g L/E at its upper end:

    >>> steel = ri.materials.steel
    >>> rod = ri.Rod(1000.0, area=0.0034, material=steel)
    >>> hanging = ri.System([rod], ends=(ri.Fixed(), ri.Free()), gravity=9.81)
    >>> strain = ri.at_rest(hanging).bodies[0].strain.values[0]
    >>> round(strain / (steel.density * 9.81 * 1000.0 / steel.youngs_modulus), 3)
    0.995
    """
    check_kind("system", system, System, "rodimpact.System([pile])")
    demand(system.shape == (), "system", "is a family; put members to rest one by one")
    _check_ends(system)
    for i, body in enumerate(system.bodies):
        is_moving_wall = isinstance(body, Wall) and moves(body)
        demand(not is_moving_wall, f"bodies.{i}", "is a wall that moves; nothing rests")
    cells = integer("cells", cells, 1, MAX_CELLS)
    counts, _ = mesh_size(build_row(system), cells, None, None)
    chain = chain_of(system, counts)
    equilibrium = find_equilibrium(chain)
    check_bears(chain, equilibrium)
    return resting_system(chain, equilibrium)


def _check_ends(system: System) -> None:
    """Raise InvalidModel unless each end is free or fixed."""
    for side, end in zip(("left", "right"), system.ends, strict=True):
        can_rest = end == FREE or isinstance(end, Fixed)
        message = (
            "must be free or fixed for a row at rest: rodimpact.Free() or "
            f"rodimpact.Fixed(), got {type(end).__name__}"
        )
        demand(can_rest, f"ends.{side}", message)


def resting_system(chain: Chain, equilibrium: Equilibrium) -> System:
    """The system of a chain with the state of its equilibrium.

    Rods at rest have new strain and mobilised resistance. Contacts that bear a weight
    have new gaps, stretches of joints, and laws that have yielded.
    """
    system = chain.system
    bodies: list[Any] = []
    for i, body in enumerate(system.bodies):
        if isinstance(body, Rod) and not chain.is_moving[i]:
            bodies.append(_resting_rod(chain, equilibrium, i, body))
        else:
            bodies.append(body)
    gaps = list(system.gaps)
    laws = list(system.contacts)
    for contact, overlap in zip(chain.contacts, equilibrium.overlaps, strict=True):
        k = contact.number
        law = laws[k]
        if isinstance(law, Joint):
            laws[k] = law.replace(stretch=-overlap)
        elif isinstance(law, Rigid):
            gaps[k] = max(0.0, -overlap)
        else:
            gaps[k] = -overlap
        if isinstance(law, Plastic):
            force = contact.stiffness * max(0.0, overlap)
            laws[k] = law.hardened(force)
    return system.replace(bodies=bodies, gaps=gaps, contacts=laws)


def _resting_rod(chain: Chain, equilibrium: Equilibrium, index: int, rod: Rod) -> Rod:
    """A rod with the strain and the mobilised resistance of the equilibrium.

    Strain is constant in each cell; the share of the resistance that is mobilised is
    constant about each node, and 0 without soil there.
    """
    nodes = nodes_of(chain.row, chain.mesh, index)
    # Cell i lies between the nodes i - 1 and i: a rod has one cell less than nodes.
    cells = slice(nodes.start + 1, nodes.stop)
    edges = cell_edges(chain.row, chain.mesh, index)
    elongation = equilibrium.tension[cells] / chain.stiffness[cells]
    strain = elongation / chain.mesh.cells.width[cells]
    resting = rod.replace(strain=Steps(strain.tolist(), edges[1:-1].tolist()))
    if not isinstance(rod.shaft, Soil):
        return resting
    along_rod = soil_of_rod(chain, index)
    held_nodes = chain.soil["node"][along_rod] - nodes.start
    ultimate = chain.soil["ultimate"][along_rod]
    shares = np.zeros(nodes.stop - nodes.start)
    shares[held_nodes] = equilibrium.resistance[along_rod] / ultimate
    middles = (edges[1:] + edges[:-1]) / 2  # between nodes, where the share changes
    mobilised = Steps(np.clip(shares, -1.0, 1.0).tolist(), middles.tolist())
    return resting.replace(shaft=rod.shaft.replace(mobilised=mobilised))
