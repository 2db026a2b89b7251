"""Forces between bodies and on the ends of the row.

They are means over the steps of a run.
"""

import numpy as np

from ..groups import fill_bonds
from ..run import INWARD, BoundaryAction
from ..signals import Floats, Pieces
from .run import GridRun


def contact_forces(run: GridRun, left: BoundaryAction | None) -> list[Floats]:
    """Mean force of each contact in each step, N [contact][step].

    `left` is what acts on the left end of the row: forces in bonds of rigid bodies
    follow from there.
    """
    row = run.row
    forces: list[Floats | None] = []
    for k, link in enumerate(row.contact_link):
        if k in row.by_law:  # a contact or a joint, whose force is recorded
            forces.append(run.contact(k)[0])
        elif link < 0:
            forces.append(None)  # a bond of rigid bodies: it follows from their momenta
        else:  # a bond with a rod
            forces.append(run.bond_force(link))

    def momentum_rate(body: int) -> Floats:
        """Rate of the momentum of a rigid body in each step, N."""
        mass = float(row.system.bodies[body].mass)
        gained = np.diff(run.mass_velocity(row.mass_of[body]))
        return np.asarray(mass * gained / run.step)

    pushed: Floats = np.zeros(run.steps)
    if left is not None:
        pushed = left.push.values
    return fill_bonds(row.system, forces, momentum_rate, pushed)


def outside_of(run: GridRun, side: int) -> BoundaryAction | None:
    """Force and velocity of what acts on the left (0) or right (1) end.

    They are those in the laboratory.

    Both are means over the steps. The force is that of the contact of a wall, of the
    bond of a held or moved end, of an endless bar, Z (wave - v) inward, or the one that
    is given. None at a free end, and in a run without steps.
    """
    row = run.row
    if side == 0:
        link = 0
    else:
        link = len(row.links) - 1
    kind, _ = row.boundaries[side]
    if kind == "none" or not run.steps:
        return None
    v = run.velocity(run.mesh.ends[side])
    speed = (v[:-1] + v[1:]) / 2  # mean over each step
    # Force of a pushed end, wave of an endless bar
    given = run.history.prescribed[:, side]
    if link in run.mesh.touching:  # there is a wall, with a contact or a joint
        force = run.recorded(link, "force")
    elif kind == "velocity":  # a wall that is bonded to the row, or a driven end
        force = run.bond_force(link)
    elif kind == "absorbing":
        end = run.grid.ends[side]
        excess = end["background_wave"] + given - speed
        force = INWARD[side] * (end["impedance"] * excess)
    else:
        force = given
    # Velocity that the frame has gained in the middle of each step
    fall = row.system.gravity * run.step * (np.arange(run.steps) + 0.5)
    return BoundaryAction(
        row.boundary_name(side),
        over_steps(run, np.ascontiguousarray(force)),
        over_steps(run, speed + row.frame + fall),
    )


def over_steps(run: GridRun, means: Floats) -> Pieces:
    """A signal, by ticks, with these means over the steps of a run.

    It is 0 in a run without steps.
    """
    if run.steps == 0:
        return Pieces([0], [0.0])
    return Pieces(run.edges[:-1], means)
