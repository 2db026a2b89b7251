"""Soil along the shafts of rods in a time step.

There is one record for each node that soil holds. The static resistance R follows the
displacement u of the node against the ground, elastic between -R_u and R_u with the
stiffness k = R_u/q. It is known in the middle of a step, as the tension of a cell is.
The damping c is J abs(R) by Smith's law and J R_u by the viscous one. In a step the
soil pulls the node back by

    R + c v,        v the mean velocity of the node against the ground,

so that c belongs to the left side of the equations of the step, and limits no step. R
is explicit: its stiffness is part of the stable step. Smith's c changes, and the
equations with it.

With R before and after a slip s of the soil, a step does the work (R_before + R_after)
s/2 on it, which is never negative, and the damping takes c v v: soil never gives back
more than it took.
"""

from typing import Any

from . import elimination_kernel as elimination
from .records import INDEX_MASK, Run


def ground_velocity(run: Run) -> float:
    """Return the velocity of the ground in the frame, m/s, at the end of the last step.

    The frame falls with g, so that the ground gains -g dt in each step.
    """
    return run.ground_velocity + run.step * run.ground_acceleration


def move_soil(run: Run, soil: Any, v: Any) -> None:
    """Move the static resistances to the middle of the step.

    The dampings of this step are set, too. Over a step the resistance grows by k
    (v - ground), within -R_u and R_u. By Smith's law the damping is c = J abs(R); by
    the viscous law it stays as it is.
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
    """Subtract the force R + c (v - ground) of the soil from x.

    x has the right sides of the equations of the step. v are the velocities before the
    step; the ground has its mean velocity over the step. What c does by the change of v
    in the step is on the left side.
    """
    ground = ground_velocity(run) + run.ground_acceleration / 2  # mean over the step
    for i in range(len(soil)):
        at_node = soil[i]
        node = at_node.node
        x[node] -= at_node.resistance + at_node.damping * (v[node] - ground)


def record_soil(run: Run, soil: Any, v: Any, old_velocity: Any, shafts: Any) -> None:
    """Set the entries of this step in `shafts`.

    They are the force of the soil on each rod, and its power. The force on a node is
    -(R + c u), u its mean velocity against the ground in the step, from `old_velocity`
    before the step and `v` after it; its power is that force times u.
    """
    ground = ground_velocity(run) + run.ground_acceleration / 2  # mean over the step
    first = (run.step - run.first_step) * run.shafts  # first entry of this step
    for i in range(run.shafts):
        shaft = shafts[first + i]
        shaft.force = 0.0
        shaft.power = 0.0
        shaft.first_node_force = 0.0
        shaft.last_node_force = 0.0
    for i in range(len(soil)):
        at_node = soil[i]
        node = at_node.node
        mean = (v[node] + old_velocity[node]) / 2 - ground  # u
        force = -(at_node.resistance + at_node.damping * mean)
        shaft = shafts[first + at_node.shaft]
        shaft.force += force
        shaft.power += force * mean
        if at_node.end_of_rod < 0:
            shaft.first_node_force = force
        if at_node.end_of_rod > 0:
            shaft.last_node_force = force


def keep_soil(run: Run, soil: Any, v: Any, kept_resistance: Any) -> None:
    """Store the static resistances at the end of a step in the next state that is kept.

    The soil has them in the middle of the step: half a step adds k (v - ground)/2, as
    velocities are lengths by step.
    """
    ground = ground_velocity(run)
    first = (run.kept_states * len(soil)) & INDEX_MASK  # first entry of this state
    for i in range(len(soil)):
        at_node = soil[i]
        R = at_node.resistance + at_node.stiffness * (v[at_node.node] - ground) / 2
        kept_resistance[first + i] = min(max(R, -at_node.ultimate), at_node.ultimate)


def load_equations(run: Run, soil: Any, diagonal: Any, loaded: Any) -> None:
    """Set `loaded` to the diagonal of the equations of a step, D + c/2.

    c are the present dampings.

    This and the functions that follow do nothing where soil does not change the
    equations. Each of them asks that itself: were it asked around their calls, arrays
    would be last used behind a condition, and machine code would count references to
    them in every step.
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
    is_prescribed: Any,
    lower: Any,
    inverse_diagonal: Any,
    upper: Any,
) -> None:
    """Set the LU factors of the loaded equations.

    They are `lower`, `inverse_diagonal` and `upper`. Where soil does not change the
    equations nothing is done.
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

    `by_first` becomes 1 at first nodes, `by_last` at last nodes, and both 0 elsewhere,
    as at nodes whose velocity is prescribed. Where soil does not change the equations
    nothing is done.
    """
    if run.soil_changes_equations == 0:
        return
    for i in range(len(by_first)):
        by_first[i] = 0.0
        by_last[i] = 0.0
    last = len(by_first) - 1  # last node of piece k, which begins behind piece k - 1
    for k in range(len(pieces) - 1, -1, -1):
        first = pieces[k].first_node
        by_first[first] = 1.0 - is_prescribed[first]
        by_last[last] = 1.0 - is_prescribed[last]
        last = first - 1


def solve_equations(
    run: Run, lower: Any, inverse_diagonal: Any, upper: Any, x: Any
) -> None:
    """Replace x, forces on the nodes, by their changes of velocity in a step.

    Where soil does not change the equations nothing is done.
    """
    if run.soil_changes_equations == 0:
        return
    elimination.substitute(lower, inverse_diagonal, upper, x)


def renew_mobilities(run: Run, links: Any, by_first: Any, by_last: Any) -> None:
    """Set the mobilities of the links.

    They follow from the velocities by unit forces on the ends of pieces.
    `self_mobility` of a link is the closing that its own unit force takes away in a
    step, `coupling_mobility` the closing that a unit force in the link before it adds
    through the piece between both. Half of a change of velocity counts, as a closing is
    a mean over the step.

    `by_first` and `by_last` have the velocity of each node by a unit force on the first
    and on the last node of its piece, (m/s)/N [node]. Nothing changes where soil does
    not change equations.
    """
    if run.soil_changes_equations == 0:
        return
    for i in range(len(links)):
        link = links[i]
        link.self_mobility = by_last[link.left_node] / 2 + by_first[link.right_node] / 2
        if i > 0:
            link.coupling_mobility = by_first[link.left_node] / 2
