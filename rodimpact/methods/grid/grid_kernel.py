"""Rods on a staggered grid, step by step.

Velocities are at nodes, forces in the cells between them. Half of the mass of each cell
sits at either of its nodes, so that u_tt = (F_right - F_left)/m at a node and F = E A
du/dx in a cell. In every step the nodes drift half a step, are kicked by the forces in
the middle of it, and drift the other half (leapfrog). For a Courant number of 1 in a
uniform rod this carries waves without error, above 1 it is unstable. With u the
displacement at the end of a step, the energy v M v/2 + (u K u - v K v/4)/2 is kept to
round-off.

Where a rod is damped (sigma = E eps + eta d(eps)/dt) or has lateral inertia (rho A u_tt
- rho nu^2 I_p u_xxtt = E A u_xx), the force of a cell depends on the new velocities,
half of the viscous force by the mean over the step: (M + J + D/2) dv = forces - D v.
This matrix is tridiagonal, so the step follows from the wave speed alone; see
`elimination_kernel`.

By Mindlin and Herrmann each cell has a radial strain q of its own. In a cell of
stiffness k at constant q, du its elongation, and between neighbours,

    tension = k du + b q,    J q_tt = change of (s times the change of q) - G q - b du

so that G q + b du is (G - b^2/k) q + b/k times the tension. Both are kicked and drift
together with the nodes, which keeps the same energy with q among the displacements u.

Bodies bonded together are one *piece* of neighbouring nodes; between pieces lies a cell
without stiffness. Contacts are the links of `contact_kernel` between the last node of a
piece and the first of the next, with the discrete inertia seen there. Their w is the
mean closing velocity of a step. A rigid contact does not update its gap while it is
closed: the two nodes move on with one velocity. The energy that the nodes lose as it
closes is of the size of a cell. Viscous ends that touch at t = 0 have already begun to
slow down, see `start.slow_down`: all that follows would be half a step too late.
"""

import math
from typing import Any

from ..compiling import borrowed
from ..link import Law
from ..states import BoundaryKind
from . import contact_kernel as contacts
from . import elimination_kernel as elimination
from . import soil_kernel
from .records import INDEX_MASK, NONE, Run


def run_steps(grid: Any, history: Any, until: int) -> bool:
    """Take steps until `until` are taken, and fill the window `history` with them.

    A step is drift, kick, contacts, drift; see above. States are kept at the ends of
    steps.

    Parameters
    ----------
    grid : Grid
    history : StepHistory
        Its entries are those of the steps from `run.first_step` on. `prescribed` and
        `when` are given: values at the ends, and the steps after which states are
        stored.
    until : int

    Returns
    -------
    bool
        False if a rigid mass was caught between walls that leave it no room.
    """
    # All arrays are unpacked before the loop: reading a field of a NamedTuple inside
    # makes machine code update the reference count of every array in each step.
    run = grid.run[0]
    v = borrowed(grid.velocity)
    force = borrowed(grid.force)
    stiffness = borrowed(grid.stiffness)
    pieces = borrowed(grid.pieces)
    lower = borrowed(grid.lower)
    inverse_diagonal = borrowed(grid.inverse_diagonal)
    upper = borrowed(grid.upper)
    change = borrowed(grid.change)
    viscous = borrowed(grid.viscous)
    lost = borrowed(grid.lost)
    old_velocity = borrowed(grid.old_velocity)
    radial_strain = borrowed(grid.radial_strain)
    radial_rate = borrowed(grid.radial_rate)
    coupling = borrowed(grid.coupling)
    inverse_radial_inertia = borrowed(grid.inverse_radial_inertia)
    radial_stiffness = borrowed(grid.radial_stiffness)
    tension_share = borrowed(grid.tension_share)
    shear = borrowed(grid.shear)
    links = borrowed(grid.links)
    ends = borrowed(grid.ends)
    watched = borrowed(grid.watched)
    pulled = borrowed(grid.pulled)
    soil = borrowed(grid.soil)
    off_diagonal = borrowed(grid.off_diagonal)
    diagonal = borrowed(grid.diagonal)
    loaded = borrowed(grid.loaded_diagonal)
    is_prescribed = borrowed(grid.is_prescribed)
    by_first = borrowed(grid.velocity_by_first)
    by_last = borrowed(grid.velocity_by_last)
    signals = borrowed(history.signals)
    prescribed = borrowed(history.prescribed)
    velocities = borrowed(history.velocities)
    tensions = borrowed(history.tensions)
    shafts = borrowed(history.shafts)
    resistance = borrowed(history.resistance)
    when = borrowed(history.when)
    kept_lost = borrowed(history.lost)
    kept_velocity = borrowed(history.velocity)
    kept_force = borrowed(history.force)
    kept_displacement = borrowed(history.displacement)
    kept_radial = borrowed(history.radial)
    kept_rate = borrowed(history.radial_rate)
    while True:
        if run.kept_states < len(when) and when[run.kept_states] == run.step:
            keep_nodes(run, v, force, stiffness, kept_velocity, kept_force)
            if run.has_radial_strain > 0:
                keep_radial_strains(
                    run, radial_strain, radial_rate, coupling, kept_radial, kept_rate
                )
                add_radial_tensions(run, radial_rate, coupling, kept_force)
            keep_pieces(run, pieces, lost, kept_displacement, kept_lost)
            soil_kernel.keep_soil(run, soil, v, resistance)
            run.kept_states += 1
        if run.step >= until:
            return True
        set_step_inputs(run, v, links, ends, prescribed)
        drift_pieces(pieces, v)
        drift_cells(v, force, stiffness)
        if run.has_radial_strain > 0:
            drift_radially(radial_strain, radial_rate, coupling, force)
            kick_radially(
                radial_strain,
                radial_rate,
                inverse_radial_inertia,
                radial_stiffness,
                tension_share,
                shear,
                force,
            )
        push_ends(v, force, ends)
        soil_kernel.move_soil(run, soil, v)
        soil_kernel.load_equations(run, soil, diagonal, loaded)
        soil_kernel.factor_equations(
            run, off_diagonal, loaded, is_prescribed, lower, inverse_diagonal, upper
        )
        soil_kernel.push_ends_of_pieces(run, pieces, is_prescribed, by_first, by_last)
        soil_kernel.solve_equations(run, lower, inverse_diagonal, upper, by_first)
        soil_kernel.solve_equations(run, lower, inverse_diagonal, upper, by_last)
        soil_kernel.renew_mobilities(run, links, by_first, by_last)
        if run.is_implicit > 0:
            set_right_side(v, force, viscous, old_velocity, change)
            soil_kernel.pull_back(run, soil, v, change)
            prescribe_changes(v, change, ends)
            elimination.substitute(lower, inverse_diagonal, upper, change)
            apply_changes(v, change)
        else:
            kick(v, force, inverse_diagonal)
        set_prescribed_velocities(v, ends)
        if not solve_contacts(run, v, links):
            return False
        push_pieces(
            v,
            by_first,
            by_last,
            links,
            run.velocity_tolerance,
        )
        record_links(run, v, links, signals)
        drift_pieces(pieces, v)
        if run.is_implicit > 0:
            dissipate(v, old_velocity, viscous, lost)
        soil_kernel.record_soil(run, soil, v, old_velocity, shafts)
        store_selected(run, v, watched, velocities)
        store_selected(run, force, pulled, tensions)
        run.step += 1


def keep_nodes(
    run: Run, v: Any, force: Any, stiffness: Any, kept_velocity: Any, kept_force: Any
) -> None:
    """Store velocities and tensions at the end of a step in the next state kept.

    Tensions are known in the middle of a step: half a step adds k (v[i] - v[i - 1])/2.
    """
    n = len(v)
    nodes = run.kept_states * n  # first entry of the state among those of nodes
    # The same among those of cells; the mask changes no index.
    cells = (run.kept_states * (n + 1)) & INDEX_MASK
    kept_force[cells] = 0.0
    kept_force[cells + n] = 0.0
    # Numba compiles a loop in a tenth of the time of a copied slice.
    for i in range(n):
        kept_velocity[nodes + i] = v[i]
        if i > 0:
            kept_force[cells + i] = force[i] + stiffness[i] * (v[i] - v[i - 1]) / 2


def keep_radial_strains(
    run: Run,
    radial_strain: Any,
    radial_rate: Any,
    coupling: Any,
    kept_radial: Any,
    kept_rate: Any,
) -> None:
    """Store radial strains q and their rates at the end of a step.

    They go to the next state that is kept. q is known in the middle of a step: half a
    step adds rate/2.
    """
    cells = (run.kept_states * len(coupling)) & INDEX_MASK  # first entry of this state
    for i in range(len(coupling)):
        kept_rate[cells + i] = radial_rate[i]
        kept_radial[cells + i] = radial_strain[i] + radial_rate[i] / 2


def add_radial_tensions(
    run: Run, radial_rate: Any, coupling: Any, kept_force: Any
) -> None:
    """Add what radial strains change in half a step, b rate/2, to the tensions kept."""
    cells = (run.kept_states * len(coupling)) & INDEX_MASK  # first entry of this state
    for i in range(len(coupling)):
        kept_force[cells + i] += coupling[i] * radial_rate[i] / 2


def keep_pieces(
    run: Run, pieces: Any, lost: Any, kept_displacement: Any, kept_lost: Any
) -> None:
    """Store displacements of pieces and the energy lost in all cells.

    They go to the next state that is kept.
    """
    first = run.kept_states * len(pieces)  # first entry of the state
    for i in range(len(pieces)):
        kept_displacement[first + i] = pieces[i].displacement
    total = 0.0
    for energy in lost:
        total += energy
    kept_lost[run.kept_states] = total


def set_step_inputs(run: Run, v: Any, links: Any, ends: Any, prescribed: Any) -> None:
    """Set what is prescribed at the ends in this step.

    The closing velocities before it are set, too.
    """
    for i in range(len(links)):
        link = links[i]
        link.initial_closing = v[link.left_node] - v[link.right_node]
    row = run.step - run.first_step  # row of the window, with an entry for each end
    for side in range(2):
        ends[side].prescribed = prescribed[2 * row + side]


def store_selected(run: Run, values: Any, selected: Any, table: Any) -> None:
    """Store `values` at the indices `selected` in the row of a table of this step."""
    row = run.step - run.first_step
    for k in range(len(selected)):
        table[row * len(selected) + k] = values[selected[k]]


def drift_pieces(pieces: Any, v: Any) -> None:
    """Let pieces drift for half a step.

    Their displacements grow by v/2 of the first node.
    """
    for p in range(len(pieces)):
        pieces[p].displacement += v[pieces[p].first_node] / 2


def drift_cells(v: Any, force: Any, stiffness: Any) -> None:
    """Move the forces of cells to the middle of the step: k (v[i] - v[i - 1]) is added.

    Between pieces there is no stiffness.
    """
    for i in range(1, len(v)):
        force[i] += stiffness[i] * (v[i] - v[i - 1])


def drift_radially(
    radial_strain: Any, radial_rate: Any, coupling: Any, force: Any
) -> None:
    """Move radial strains to the middle of the step.

    Their part b dq of the tensions is added.
    """
    for i in range(len(radial_strain)):
        radial_strain[i] += radial_rate[i]
        force[i] += coupling[i] * radial_rate[i]


def kick_radially(
    radial_strain: Any,
    radial_rate: Any,
    inverse_radial_inertia: Any,
    radial_stiffness: Any,
    tension_share: Any,
    shear: Any,
    force: Any,
) -> None:
    """Move the rates of radial strain to the end of the step.

    J dq_t = s_i (q[i + 1] - q[i]) - s_(i-1) (q[i] - q[i - 1]) - (G - b^2/k) q - b/k
    tension.

    J and the stiffnesses are those of `records.Grid`; s_i lies between the cells i and
    i + 1.
    """
    before = 0.0  # shear force from the cell on the left
    for i in range(len(radial_strain) - 1):
        after = shear[i] * (radial_strain[i + 1] - radial_strain[i])
        elastic = radial_stiffness[i] * radial_strain[i]
        push = after - before - elastic - tension_share[i] * force[i]
        radial_rate[i] += inverse_radial_inertia[i] * push
        before = after


def push_ends(v: Any, force: Any, ends: Any) -> None:
    """Set the forces from outside, as tensions of cells beyond the ends of the row.

    An endless bar of impedance Z that sends a wave presses with Z (wave - v) to the
    right at the left end, and with Z (v - wave) to the left at the right end.
    """
    for side in range(2):
        end = ends[side]
        # Pressure on the end, into the row: minus the tension of the cell beyond it
        push = 0.0
        if end.kind == BoundaryKind.PUSHED:
            push = end.prescribed
        elif end.kind == BoundaryKind.ENDLESS:
            wave = end.background_wave + end.prescribed
            inward = 1 - 2 * side  # 1 on the left, -1 on the right
            push = inward * end.impedance * (wave - v[end.node])
        # Cell i is on the left of node i: beyond the left end is the cell of its node,
        # beyond the right end the next one.
        force[end.node + side] = -push


def kick(v: Any, force: Any, inverse_mass: Any) -> None:
    """Move velocities to the end of a step in which nothing is implicit.

    m dv = F_right - F_left, with node i between the cells i and i + 1.
    """
    for i in range(len(v)):
        v[i] += inverse_mass[i] * (force[i + 1] - force[i])


def set_right_side(v: Any, force: Any, viscous: Any, old_velocity: Any, x: Any) -> None:
    """Set x, the right side of the equations of a step.

    It has the elastic and viscous forces on the nodes. The viscous force is eta A/dx
    (v[i + 1] - v[i]) with the velocities before the step, which are kept in
    `old_velocity`. Node i lies between the cells i and i + 1.
    """
    before = force[0]  # tension on the left of node i
    for i in range(len(v) - 1):
        old_velocity[i] = v[i]
        # Tension on its right: elastic, and viscous by the velocities before the step
        after = force[i + 1] + viscous[i + 1] * (v[i + 1] - v[i])
        x[i] = after - before
        before = after
    n = len(v) - 1
    old_velocity[n] = v[n]
    x[n] = force[n + 1] - before


def prescribe_changes(v: Any, x: Any, ends: Any) -> None:
    """Set the right side x of the equation of each moved end.

    It is the change of the velocity of that end.
    """
    for side in range(2):
        if ends[side].kind == BoundaryKind.MOVED:
            x[ends[side].node] = ends[side].prescribed - v[ends[side].node]


def apply_changes(v: Any, change: Any) -> None:
    """Add the changes to the velocities: they are those at the end of the step then."""
    for i in range(len(v)):
        v[i] += change[i]


def set_prescribed_velocities(v: Any, ends: Any) -> None:
    """Set the velocities of moved ends to the prescribed ones, free of round-off."""
    for side in range(2):
        if ends[side].kind == BoundaryKind.MOVED:
            v[ends[side].node] = ends[side].prescribed


def solve_contacts(run: Run, v: Any, links: Any) -> bool:
    """Find the forces of all links in this step, chain by chain.

    Return False where bodies of a chain cannot move, as a mass between two walls.
    """
    for i in range(len(links)):
        if links[i].chain_end != NONE and not solve_contact_chain(run, v, links, i):
            return False
    return True


def solve_contact_chain(run: Run, v: Any, links: Any, first: int) -> bool:
    """Find the forces of a chain of links; return False if there are none.

    Link `first` is the first of the chain. Links that are coupled by bodies between
    them make a chain, see `contact_kernel`. `v` are the velocities at the end of the
    step without link forces; they stay so.
    """
    last = links[first].chain_end
    speed = 0.0
    for i in range(first, last + 1):
        link = links[i]
        # Velocities at the end of the step without link forces
        left = v[link.left_node]
        right = v[link.right_node]
        speed = max(speed, abs(left) + abs(right) + abs(link.initial_closing))
        # The closing of a step is the mean of the
        # closing velocities before and after it.
        link.force_free_closing = (link.initial_closing + left - right) / 2
        link.force_slope = 0.0
        # Guess: the closing of the last step goes on
        link.overlap = link.closing - link.gap
        link.max_closing = math.inf  # an impact waits until it happens
        if link.law != Law.IMPACT:
            # A rigid contact that is closed closes no more at the end of the step. One
            # that closes inside the step is stopped over two steps.
            if link.is_closed == 1:
                max_closing = link.initial_closing / 2
            else:
                max_closing = link.gap / 2 + link.initial_closing / 4
            link.max_closing = max(max_closing, 0.0)
    # An impact that the forces of others make begin changes all forces: solve again.
    is_solved = True
    has_new_impact = True
    while has_new_impact:
        is_solved = contacts.solve_chain(links, first, last, speed) and is_solved
        has_new_impact = contacts.start_impacts(
            links, first, last, run.velocity_tolerance
        )
    return is_solved


def push_pieces(
    v: Any, by_first: Any, by_last: Any, links: Any, tolerance: float
) -> None:
    """Change the velocities on both sides of the links by the forces that were found.

    The force of a rigid link is set to 0 where it is round-off: where the closing
    velocity that it takes away is within `tolerance`, m/s. Such forces are not
    negative. `by_first` and `by_last` are the velocities by a unit force on the first
    and on the last node of a piece.
    """
    for i in range(len(links)):
        link = links[i]
        is_stiff = link.law == Law.RIGID or link.law == Law.IMPACT
        if is_stiff and link.force * link.self_mobility <= tolerance:
            link.force = 0.0
        if link.force != 0:
            # The nodes of the piece on the left, then of that on the right. INDEX_MASK
            # changes no index, but shows the compiler that none is negative.
            for n in range(
                link.leftmost_node & INDEX_MASK, (link.left_node & INDEX_MASK) + 1
            ):
                v[n] -= by_last[n] * link.force
            for n in range(
                link.right_node & INDEX_MASK, (link.rightmost_node & INDEX_MASK) + 1
            ):
                v[n] += by_first[n] * link.force


def record_links(run: Run, v: Any, links: Any, signals: Any) -> None:
    """Set closings and gaps of the links at the end of the step.

    They are stored with the forces. `signals` has a row for each step of the window. In
    the first step the force that contacts had as they closed at t = 0 is added, and the
    closing is such that force times closing is the work.
    """
    for i in range(len(links)):
        link = links[i]
        gap_before = link.gap
        link.closing = (
            link.initial_closing + v[link.left_node] - v[link.right_node]
        ) / 2
        is_stiff = link.law == Law.RIGID or link.law == Law.IMPACT
        if is_stiff and link.force > 0:
            link.closing = link.max_closing  # free of round-off
        link.gap = contacts.updated_gap(link, link.closing, run.velocity_tolerance)
        signal = signals[(run.step - run.first_step) * len(links) + i]
        signal.force = link.force
        signal.gap = link.gap
        signal.closing = gap_before - link.gap
        # The gaps of these do not follow their closing while they press.
        if link.law == Law.RIGID or link.law == Law.YIELD:
            signal.closing = link.closing
        if run.step == 0 and link.initial_force > 0:
            work = link.initial_loss + link.force * link.closing
            signal.force = link.force + link.initial_force
            signal.closing = work / signal.force


def dissipate(v: Any, old_velocity: Any, viscous: Any, lost: Any) -> None:
    """Add to `lost` the energy that viscosity turned to heat in this step, by cell.

    It is eta A/dx times the square of the mean rate of elongation.
    """
    for i in range(1, len(v)):
        # Mean of the rates after and before the step
        rate = (v[i] - v[i - 1] + (old_velocity[i] - old_velocity[i - 1])) / 2
        lost[i] += viscous[i] * rate * rate
