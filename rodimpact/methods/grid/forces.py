"""Forces between bodies and on the ends of the row.

They are means over the steps of a run.
"""

import numpy as np

from ..groups import fill_bonds
from ..run import INWARD, BoundaryAction
from ..signals import Floats, Pieces
from .run import GridRun


def contact_forces(run: GridRun, left: BoundaryAction | None) -> list[Floats]:
    """Mean force of each contact in each step of a run, N [contact][step].

    The force of a contact or a joint is the recorded one, that of a bond with a rod
    follows from the rod, see `GridRun.bond_force`. In bonds of rigid bodies it follows
    by Newton's law from the force on the left of the body, at the left end of the row
    from that of `left`, what acts there; None is a free end, with the force 0.
    """
    row = run.row
    forces: list[Floats | None] = []
    for k, link in enumerate(row.contact_link):
        if k in row.by_law:  # a contact or a joint, whose force is recorded
            force, _ = run.contact(k)
            forces.append(force)
        elif link < 0:
            forces.append(None)  # a bond of rigid bodies: `fill_bonds` finds its force
        else:  # a bond with a rod
            forces.append(run.bond_force(link))

    def momentum_rate(body: int) -> Floats:
        """Rate of the momentum of a rigid body in each step, N [step]."""
        mass = float(row.system.bodies[body].mass)
        gained = np.diff(run.mass_velocity(row.mass_of[body]))  # m/s, in each step
        return np.asarray(mass * gained / run.step)

    pushed: Floats = np.zeros(run.steps)
    if left is not None:
        pushed = left.push.values
    return fill_bonds(row.system, forces, momentum_rate, pushed)


def outside_of(run: GridRun, side: int) -> BoundaryAction | None:
    """Push and velocity of what acts on the left (0) or right (1) end of the row.

    Both are means over each step; the velocity is that in the laboratory, m/s. The
    push, N, positive into the row, is the force in the contact, joint or bond of a wall
    or moved end, that of an endless bar, Z (wave - v) to the right at the left end and
    Z (v - wave) to the left at the right end, or else the given one. None is returned
    for a free end, and for a run without steps.
    """
    row = run.row
    if side == 0:
        link = 0
    else:
        link = len(row.links) - 1
    kind, _ = row.boundaries[side]
    if kind == "none" or not run.steps:
        return None
    v = run.velocity(run.mesh.ends[side])  # in the frame, at the ends of steps
    speed = (v[:-1] + v[1:]) / 2  # mean over each step
    # [step]: the force of a pushed end, or the wave that an endless bar sends
    given = run.history.prescribed[:, side]
    if link in run.mesh.touching:  # there is a wall, with a contact or a joint
        force = run.recorded(link, "force")
    elif kind == "velocity":  # a wall that is bonded to the row, or a moved end
        force = run.bond_force(link)
    elif kind == "absorbing":  # an endless bar
        end = run.grid.ends[side]
        excess = end["background_wave"] + given - speed
        force = INWARD[side] * (end["impedance"] * excess)
    else:  # a pushed end
        force = given
    # The frame moves with row.frame and falls: what it gains until the middle of a step
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
