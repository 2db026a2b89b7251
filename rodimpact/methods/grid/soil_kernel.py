"""Soil along the shafts of rods in a time step.

There is one record for each node in soil. The static resistance R follows the
displacement u of the node relative to the ground: it is elastic between -R_u and R_u,
with the stiffness k = R_u/q and the quake q. It is known in the middle of a step, as is
the tension of a cell. The damping c is J abs(R) by Smith's law and J R_u by the viscous
law. In a step the soil pulls the node back with the force

    R + c v,    v the mean velocity of the node relative to the ground.

So c belongs to the left side of the equations of the step, and does not limit the step.
R is explicit, and its stiffness reduces the stable step. Smith's c changes from step to
step, and so do the equations.

If the soil slips by s, a step does the work (R_before + R_after) s/2 on it, which is
never negative, and the damping takes c v v: soil never returns more energy than it has
taken.
"""

from typing import Any

from . import elimination_kernel as elimination
from .records import INDEX_MASK, Run


def ground_velocity(run: Run) -> float:
    """Return the velocity of the ground in the frame after the steps taken, m/s.

    The frame falls with the acceleration g, so the velocity of the ground changes by
    `ground_acceleration`, -g dt, in each step.
    """
    return run.ground_velocity + run.steps_taken * run.ground_acceleration


def move_soil(run: Run, soil: Any, v: Any) -> None:
    """Advance the static resistances R to the middle of the step, and set the dampings.

    R was that in the middle of the step before. It changes by k (v - ground), as time
    is counted in steps, and is limited to -R_u and R_u. By Smith's law the damping
    becomes J abs(R); by the viscous law, and for drag, it is constant.
    """
    ground = ground_velocity(run)
    for i in range(len(soil)):
        at_node = soil[i]
        R = at_node.resistance + at_node.stiffness * (v[at_node.node] - ground)
        R = min(max(R, -at_node.ultimate), at_node.ultimate)
        at_node.resistance = R
        if at_node.is_smith > 0:
            at_node.damping = at_node.damping_factor * abs(R)


def pull_back(run: Run, soil: Any, v: Any, x: Any) -> None:
    """Subtract the force R + c (v - ground) of the soil from x, N [node].

    x has the right sides of the equations of the step. v are the velocities before the
    step, and `ground` is the mean velocity of the ground over the step. The part of the
    damping force by the change of v is on the left side of the equations.
    """
    # Mean velocity over the step: half of the change in the step is added, as
    # `ground_acceleration` is in m/s per step.
    ground = ground_velocity(run) + run.ground_acceleration / 2
    for i in range(len(soil)):
        at_node = soil[i]
        node = at_node.node
        x[node] -= at_node.resistance + at_node.damping * (v[node] - ground)


def record_soil(run: Run, soil: Any, v: Any, old_velocity: Any, shafts: Any) -> None:
    """Set the entries of this step in `shafts` [step of the window, rod in soil].

    They are the force of the soil on each rod, N, its power, W, and the parts of the
    force on the first and the last node of the rod, which are 0 if these nodes have no
    soil. The force on a node is -(R + c u) and its power is force times u, where u is
    the mean velocity of the node relative to the ground, from `old_velocity` before the
    step and v after the step. `shafts` is flat.
    """
    # Mean velocity over the step: half of the change in the step is added.
    ground = ground_velocity(run) + run.ground_acceleration / 2
    step_in_window = run.steps_taken - run.first_step
    first = step_in_window * run.shaft_count  # first entry of this step
    for i in range(run.shaft_count):
        shaft = shafts[first + i]
        shaft.force = 0.0
        shaft.power = 0.0
        shaft.first_node_force = 0.0
        shaft.last_node_force = 0.0
    for i in range(len(soil)):
        at_node = soil[i]
        node = at_node.node
        u = (v[node] + old_velocity[node]) / 2 - ground
        force = -(at_node.resistance + at_node.damping * u)
        shaft = shafts[first + at_node.shaft]
        shaft.force += force
        shaft.power += force * u
        if at_node.end_of_rod < 0:
            shaft.first_node_force = force
        if at_node.end_of_rod > 0:
            shaft.last_node_force = force


def keep_soil(run: Run, soil: Any, v: Any, kept_resistance: Any) -> None:
    """Store the static resistances R at the end of a step as state `run.kept_states`.

    They are written to this row of `kept_resistance` [state, node in soil], which is
    flat. The records of the soil have R in the middle of the step and are not changed.
    Half a step adds k (v - ground)/2, as time is counted in steps; the result is
    limited to -R_u and R_u.
    """
    ground = ground_velocity(run)
    first = (run.kept_states * len(soil)) & INDEX_MASK  # first entry of this state
    for i in range(len(soil)):
        at_node = soil[i]
        R = at_node.resistance + at_node.stiffness * (v[at_node.node] - ground) / 2
        kept_resistance[first + i] = min(max(R, -at_node.ultimate), at_node.ultimate)


def load_equations(run: Run, soil: Any, diagonal: Any, loaded: Any) -> None:
    """Set `loaded` [node] to `diagonal` plus half of the present dampings of the soil.

    It is the diagonal of the equations of a step. Nothing is done if soil does not
    change the equations.
    """
    # This function and those below check the condition themselves. If the caller did,
    # the last use of some arrays would be inside a condition, and machine code would
    # count references to them in every step.
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
    is_prescribed: Any,
    lower: Any,
    inverse_diagonal: Any,
    upper: Any,
) -> None:
    """Write the LU factors of the equations with the diagonal `loaded`.

    They are written to `lower`, `inverse_diagonal` and `upper`, [node] each. Nothing is
    done if soil does not change the equations.
    """
    if run.soil_changes_equations == 0:
        return
    elimination.factor(
        off_diagonal, loaded, is_prescribed, lower, inverse_diagonal, upper
    )


def push_ends_of_pieces(
    run: Run, pieces: Any, is_prescribed: Any, by_first: Any, by_last: Any
) -> None:
    """Set right sides: unit forces on the first and on the last node of each piece.

    `by_first` becomes 1 at the first nodes and `by_last` at the last nodes. Elsewhere,
    and at nodes whose velocity is prescribed, both become 0. `solve_equations` then
    turns them into changes of velocity. Nothing is done if soil does not change the
    equations.
    """
    if run.soil_changes_equations == 0:
        return
    for i in range(len(by_first)):
        by_first[i] = 0.0
        by_last[i] = 0.0
    # From right to left: the last node of a piece is the node before the first node of
    # the piece on its right.
    last = len(by_first) - 1
    for k in range(len(pieces) - 1, -1, -1):
        first = pieces[k].first_node
        by_first[first] = 1.0 - is_prescribed[first]
        by_last[last] = 1.0 - is_prescribed[last]
        last = first - 1  # last node of the next piece on the left


def solve_equations(
    run: Run, lower: Any, inverse_diagonal: Any, upper: Any, x: Any
) -> None:
    """Replace x, forces on the nodes, N, by their changes of velocity in a step, m/s.

    They solve the equations of a step with these factors. Nothing is done if soil does
    not change the equations.
    """
    if run.soil_changes_equations == 0:
        return
    elimination.substitute(lower, inverse_diagonal, upper, x)


def renew_mobilities(run: Run, links: Any, by_first: Any, by_last: Any) -> None:
    """Set the mobilities of the links from the velocity changes by unit forces.

    `by_first` and `by_last` have the velocity change of each node by a unit force on
    the first and on the last node of its piece, (m/s)/N [node]. `self_mobility` of a
    link is the decrease of its closing in a step by a unit of its own force;
    `coupling_mobility` is the increase by a unit force of the link before it, through
    the piece between them. It is not changed for the first link. A closing is a mean
    over the step, hence the factor 1/2. Nothing is done if soil does not change the
    equations.
    """
    if run.soil_changes_equations == 0:
        return
    for i in range(len(links)):
        link = links[i]
        link.self_mobility = by_last[link.left_node] / 2 + by_first[link.right_node] / 2
        if i > 0:
            link.coupling_mobility = by_first[link.left_node] / 2
