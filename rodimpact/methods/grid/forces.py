"""Forces between bodies and on the ends of the row, averaged over steps of a run."""

import numpy as np

from ..groups import fill_bonds
from ..run import INWARD, BoundaryAction
from ..signals import Floats, Pieces
from .run import GridRun


def contact_forces(run: GridRun, left: BoundaryAction | None) -> list[Floats]:
    """Mean force of each contact in each step of a run, N [contact][step].

    The force of a contact or a joint is recorded. The force in a bond with a rod
    follows from the motion of the rod, see `GridRun.bond_force`. The force in a bond of
    two rigid bodies follows by Newton's law from the force on the left of its left
    body. At the left end of the row this is the push of `left`; None is a free end,
    with the force 0.
    """
    row = run.row
    forces: list[Floats | None] = []
    for k, link in enumerate(row.contact_link):
        if k in row.unbonded_links:  # a contact or a joint, whose force is recorded
            force, _ = run.contact(k)
            forces.append(force)
        elif link < 0:
            forces.append(None)  # a bond of rigid bodies: `fill_bonds` finds its force
        else:  # a bond with a rod
            forces.append(run.bond_force(link))

    def momentum_rate(body: int) -> Floats:
        """Rate of change of the momentum of a rigid body in each step, N [step]."""
        mass = float(row.system.bodies[body].mass)
        velocity_change = np.diff(run.mass_velocity(row.mass_of[body]))  # m/s [step]
        return np.asarray(mass * velocity_change / run.step)

    left_push: Floats = np.zeros(run.steps)
    if left is not None:
        left_push = left.push.values
    return fill_bonds(row.system, forces, momentum_rate, left_push)


def outside_of(run: GridRun, side: int) -> BoundaryAction | None:
    """Push and velocity of the outside at the left (0) or right (1) end of the row.

    Both are means over each step; the velocity is that in the laboratory, m/s. The
    push, N, is positive into the row. At a wall or moved end it is the force in the
    contact, joint or bond there; at a semi-infinite bar it is Z (wave - v) on the left
    and Z (v - wave) on the right; at a pushed end it is the given force. None is
    returned for a free end, and for a run without steps.
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
    mean_velocity = (v[:-1] + v[1:]) / 2  # over each step [step]
    # Force on a pushed end, or wave that a semi-infinite bar sends [step]
    given = run.history.prescribed[:, side]
    if link in run.mesh.link_nodes:  # a wall with a contact or a joint
        force = run.recorded(link, "force")
    elif kind == "velocity":  # a wall that is bonded to the row, or a moved end
        force = run.bond_force(link)
    elif kind == "absorbing":  # a semi-infinite bar
        end = run.grid.ends[side]
        excess = end["background_wave"] + given - mean_velocity
        force = INWARD[side] * (end["impedance"] * excess)
    else:  # a pushed end
        force = given
    # The frame has the velocity row.frame + g t; this is g t in the middle of each step
    fall = row.system.gravity * run.step * (np.arange(run.steps) + 0.5)
    return BoundaryAction(
        kind=row.boundary_name(side),
        push=over_steps(run, np.ascontiguousarray(force)),
        speed=over_steps(run, mean_velocity + row.frame + fall),
    )


def over_steps(run: GridRun, means: Floats) -> Pieces:
    """Signal, with times in ticks, that has these constant values over the steps.

    `means` [step] are the values. In a run without steps the signal is 0.
    """
    if run.steps == 0:
        return Pieces([0], [0.0])  # the value 0 from tick 0 on
    return Pieces(run.edges[:-1], means)  # each value begins with its step
