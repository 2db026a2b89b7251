"""Soil along the shafts of rods in a time step: one record for each node that soil holds.

The static resistance R follows the displacement u of the node against the ground, elastic between
-R_u and R_u with the stiffness k = R_u/q. It is known in the middle of a step, as the tension of a
cell is. The damping c is J |R| by Smith's law and J R_u by the viscous one. In a step the soil
pulls the node back by

    R + c v,        v the mean velocity of the node against the ground,

so that c belongs to the left side of the equations of the step, and limits no step. R is explicit:
its stiffness is part of the stable step. Smith's c changes, and the equations with it.

With R before and after a slip s of the soil, a step does the work (R_before + R_after) s/2 on it,
which is never negative, and the damping takes c v v: soil never gives back more than it took.
"""

from typing import Any

from . import elimination_kernel as elimination
from .records import INDEX_MASK, Run


def ground_velocity(run: Run) -> float:
    """Velocity of the ground in the frame, which falls, before the present step."""
    return run.ground_velocity + run.step * run.ground_acceleration


def move_soil(run: Run, soil: Any, v: Any) -> None:
    """Static resistances in the middle of the step, and the dampings that they make."""
    ground = ground_velocity(run)
    for i in range(len(soil)):
        at_node = soil[i]
        R = at_node.resistance + at_node.stiffness * (v[at_node.node] - ground)
        R = min(max(R, -at_node.ultimate), at_node.ultimate)
        at_node.resistance = R
        if at_node.is_smith > 0:
            at_node.damping = at_node.damping_factor * abs(R)


def pull_back(run: Run, soil: Any, v: Any, x: Any) -> None:
    """Take what the soil holds off the right sides x of the equations of the step."""
    ground = ground_velocity(run) + run.ground_acceleration / 2
    for i in range(len(soil)):
        at_node = soil[i]
        node = at_node.node
        x[node] -= at_node.resistance + at_node.damping * (v[node] - ground)


def record_soil(run: Run, soil: Any, v: Any, old_velocity: Any, shafts: Any) -> None:
    """Record the force of the soil on each rod in this step, and its power."""
    ground = ground_velocity(run) + run.ground_acceleration / 2
    first = (run.step - run.first_step) * run.shafts
    for i in range(run.shafts):
        shaft = shafts[first + i]
        shaft.force = 0.0
        shaft.power = 0.0
        shaft.first_node_force = 0.0
        shaft.last_node_force = 0.0
    for i in range(len(soil)):
        at_node = soil[i]
        node = at_node.node
        mean = (v[node] + old_velocity[node]) / 2 - ground
        force = -(at_node.resistance + at_node.damping * mean)
        shaft = shafts[first + at_node.shaft]
        shaft.force += force
        shaft.power += force * mean
        if at_node.end_of_rod < 0:
            shaft.first_node_force = force
        if at_node.end_of_rod > 0:
            shaft.last_node_force = force


def keep_soil(run: Run, soil: Any, v: Any, kept: Any) -> None:
    """Store the static resistances as they are at the end of a step."""
    ground = ground_velocity(run)
    first = run.kept_states * len(soil) & INDEX_MASK
    for i in range(len(soil)):
        at_node = soil[i]
        R = at_node.resistance + at_node.stiffness * (v[at_node.node] - ground) / 2
        kept[first + i] = min(max(R, -at_node.ultimate), at_node.ultimate)


def load_equations(run: Run, soil: Any, diagonal: Any, loaded: Any) -> None:
    """Diagonal of the equations of a step with the dampings of the soil as they are now.

    This and the functions that follow do nothing where soil does not change the equations.
    """
    if run.soil_changes_equations == 0:
        return
    for i in range(len(diagonal)):
        loaded[i] = diagonal[i]
    for i in range(len(soil)):
        loaded[soil[i].node] += soil[i].damping / 2


def factor_equations(
    run: Run,
    off_diagonal: Any,
    loaded: Any,
    held: Any,
    lower: Any,
    inverse_diagonal: Any,
    upper: Any,
) -> None:
    """Factor the equations anew."""
    if run.soil_changes_equations == 0:
        return
    elimination.factor(off_diagonal, loaded, held, lower, inverse_diagonal, upper)


def push_ends_of_pieces(
    run: Run, pieces: Any, held: Any, by_first: Any, by_last: Any
) -> None:
    """Unit forces on the first and on the last node of each piece, as right sides."""
    if run.soil_changes_equations == 0:
        return
    for i in range(len(by_first)):
        by_first[i] = 0.0
        by_last[i] = 0.0
    before = len(by_first) - 1  # last node of the piece before
    for k in range(len(pieces) - 1, -1, -1):
        first = pieces[k].first_node
        by_first[first] = 1.0 - held[first]
        by_last[before] = 1.0 - held[before]
        before = first - 1


def solve_equations(
    run: Run, lower: Any, inverse_diagonal: Any, upper: Any, x: Any
) -> None:
    """Velocities x that forces x give in a step."""
    if run.soil_changes_equations == 0:
        return
    elimination.substitute(lower, inverse_diagonal, upper, x)


def renew_mobilities(run: Run, links: Any, by_first: Any, by_last: Any) -> None:
    """What the links ask of the velocities that forces on the ends of pieces give."""
    if run.soil_changes_equations == 0:
        return
    for i in range(len(links)):
        link = links[i]
        link.self_mobility = by_last[link.left_node] / 2 + by_first[link.right_node] / 2
        if i > 0:
            link.coupling_mobility = by_first[link.left_node] / 2
