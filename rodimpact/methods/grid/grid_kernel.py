"""Rods on a staggered grid, step by step.

Velocities are at nodes, forces in the cells between them. Half of the mass of each cell
is at each of its two nodes, so that u_tt = (F_right - F_left)/m at a node and F = E A
du/dx in a cell. In every step the nodes drift for half a step, are kicked by the forces
in the middle of the step, and drift for the other half (leapfrog). In a uniform rod the
scheme carries waves without error at a Courant number of 1; above 1 it is unstable.
With the displacements u at the end of a step, the energy
v M v/2 + (u K u - v K v/4)/2 is conserved to round-off.

In a rod with damping (sigma = E eps + eta d(eps)/dt) or lateral inertia (rho A u_tt -
rho nu^2 I_p u_xxtt = E A u_xx) the force of a cell depends on the new velocities, as
viscous forces follow from the mean velocities over the step:
(M + J + D/2) dv = forces - D v. This matrix is tridiagonal, see `elimination_kernel`.
The largest stable step depends on the wave speed only.

In Mindlin and Herrmann's model each cell has a radial strain q of its own. For a cell
with the stiffness k at constant q and the elongation du,

    tension = k du + b q,    J q_tt = change of (s times the change of q) - G q - b du

where changes are differences of neighbours. So G q + b du is equal to
(G - b^2/k) q + b/k tension. q and its rate drift and are kicked together with the
nodes, which conserves the same energy with q among the displacements u.

Bodies bonded together are one *piece* of neighbouring nodes; between two pieces is a
cell without stiffness. Contacts are the links of `contact_kernel` between the last node
of a piece and the first node of the next, with the discrete inertia seen there. Their w
is the mean closing velocity of a step. A rigid contact does not change its gap while it
is closed: the two nodes move with the same velocity. The energy that the nodes lose as
it closes is that of about one cell. Viscous ends that touch at t = 0 have already begun
to slow down, see `start.slow_down`; otherwise all later events would be half a step
late.
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
    """Take steps until `until` steps have been taken, and record them in `history`.

    A step consists of drift, kick, contacts, drift. The grid is left in the state after
    the last step. States are stored after the numbers of steps in `history.when`, also
    the state before the first step if it is listed there. If a rigid mass is caught
    between walls, the run ends inside a step.

    Parameters
    ----------
    grid : Grid
    history : StepHistory
        Its entries are those of the steps from `run.first_step` on, in flat arrays.
        `prescribed` (values at the ends) and `when` (numbers of steps after which
        states are stored) are inputs; the other arrays are filled.
    until : int
        Number of steps since t = 0.

    Returns
    -------
    bool
        False if a rigid mass was caught between walls that leave it no room.
    """
    # All arrays are unpacked before the loop: if the loop read fields of a NamedTuple,
    # machine code would update the reference count of every array in each step.
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
    recorded_nodes = borrowed(grid.recorded_nodes)
    recorded_cells = borrowed(grid.recorded_cells)
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
        # The state at the end of the last step is stored if its number of steps is the
        # next one in `when`, of which `kept_states` have been passed.
        if run.kept_states < len(when) and when[run.kept_states] == run.steps_taken:
            keep_nodes(run, v, force, stiffness, kept_velocity, kept_force)
            if run.has_radial_strain > 0:
                keep_radial_strains(
                    run, radial_strain, radial_rate, coupling, kept_radial, kept_rate
                )
                add_radial_tensions(run, radial_rate, coupling, kept_force)
            keep_pieces(run, pieces, lost, kept_displacement, kept_lost)
            soil_kernel.keep_soil(run, soil, v, resistance)
            run.kept_states += 1
        if run.steps_taken >= until:
            return True
        set_step_inputs(run, v, links, ends, prescribed)
        # Drift: displacements and forces are those in the middle of the step.
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
        # If the damping of soil changes, the equations of the step are new: their
        # factors, and the velocities by unit forces. Else these six calls do nothing.
        soil_kernel.load_equations(run, soil, diagonal, loaded)
        soil_kernel.factor_equations(
            run, off_diagonal, loaded, is_prescribed, lower, inverse_diagonal, upper
        )
        soil_kernel.push_ends_of_pieces(run, pieces, is_prescribed, by_first, by_last)
        soil_kernel.solve_equations(run, lower, inverse_diagonal, upper, by_first)
        soil_kernel.solve_equations(run, lower, inverse_diagonal, upper, by_last)
        soil_kernel.renew_mobilities(run, links, by_first, by_last)
        # Kick: v becomes the velocity at the end of the step, without link forces.
        if run.is_implicit > 0:
            set_right_side(v, force, viscous, old_velocity, change)
            soil_kernel.pull_back(run, soil, v, change)
            prescribe_changes(v, change, ends)
            elimination.substitute(lower, inverse_diagonal, upper, change)
            apply_changes(v, change)
        else:
            kick(v, force, inverse_diagonal)
        set_prescribed_velocities(v, ends)
        # Contacts and joints: their forces change v.
        if not solve_contacts(run, v, links):
            return False
        push_pieces(v, by_first, by_last, links, run.velocity_tolerance)
        record_links(run, v, links, signals)
        # Drift to the end of the step, and records of this step
        drift_pieces(pieces, v)
        if run.is_implicit > 0:
            dissipate(v, old_velocity, viscous, lost)
        soil_kernel.record_soil(run, soil, v, old_velocity, shafts)
        store_selected(run, v, recorded_nodes, velocities)
        store_selected(run, force, recorded_cells, tensions)
        run.steps_taken += 1


def keep_nodes(
    run: Run, v: Any, force: Any, stiffness: Any, kept_velocity: Any, kept_force: Any
) -> None:
    """Store velocities and tensions at the end of a step as state `run.kept_states`.

    They are written to `kept_velocity` [state, node] and `kept_force` [state, cell],
    which are flat; `run.kept_states` is not changed. `force` has the tensions in the
    middle of the step: half a step adds k (v[i] - v[i - 1])/2. The tensions of the
    cells beyond both ends of the row are stored as 0.
    """
    n = len(v)  # number of nodes; there is one cell more
    nodes = run.kept_states * n  # first entry of the state in kept_velocity
    # First entry of the state in kept_force; the mask changes no index.
    cells = (run.kept_states * (n + 1)) & INDEX_MASK
    kept_force[cells] = 0.0
    kept_force[cells + n] = 0.0
    # A loop, as Numba needs ten times as long to compile a copy of a slice
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

    They are written as state `run.kept_states` to `kept_radial` and `kept_rate`
    [state, cell], which are flat; `run.kept_states` is not changed. `radial_strain` has
    q in the middle of the step: half a step adds rate/2.
    """
    cells = (run.kept_states * len(coupling)) & INDEX_MASK  # first entry of this state
    for i in range(len(coupling)):
        kept_rate[cells + i] = radial_rate[i]
        kept_radial[cells + i] = radial_strain[i] + radial_rate[i] / 2


def add_radial_tensions(
    run: Run, radial_rate: Any, coupling: Any, kept_force: Any
) -> None:
    """Add the change by radial strains in half a step, b rate/2, to stored tensions.

    These are the tensions of state `run.kept_states` in `kept_force` [state, cell],
    which is flat; b is `coupling`.
    """
    cells = (run.kept_states * len(coupling)) & INDEX_MASK  # first entry of this state
    for i in range(len(coupling)):
        kept_force[cells + i] += coupling[i] * radial_rate[i] / 2


def keep_pieces(
    run: Run, pieces: Any, lost: Any, kept_displacement: Any, kept_lost: Any
) -> None:
    """Store the displacements of pieces, and the sum of the energies lost in all cells.

    They are written as state `run.kept_states` to `kept_displacement` [state, piece],
    which is flat, and to `kept_lost` [state]; `run.kept_states` is not changed.
    """
    first = run.kept_states * len(pieces)  # first entry of the state
    for i in range(len(pieces)):
        kept_displacement[first + i] = pieces[i].displacement
    total = 0.0
    for energy in lost:
        total += energy
    kept_lost[run.kept_states] = total


def set_step_inputs(run: Run, v: Any, links: Any, ends: Any, prescribed: Any) -> None:
    """Set `old_closing` of the links and `prescribed` of both ends for this step.

    `old_closing` is the closing velocity before the step, from the velocities v. The
    values of both ends are those of this step in `prescribed`
    [step of the window, side], which is flat.
    """
    for i in range(len(links)):
        link = links[i]
        link.old_closing = v[link.left_node] - v[link.right_node]
    step_in_window = run.steps_taken - run.first_step
    for side in range(2):
        ends[side].prescribed = prescribed[2 * step_in_window + side]


def store_selected(run: Run, values: Any, selected: Any, table: Any) -> None:
    """Store some of the `values`, at the indices `selected`, in a table.

    They are written to the entries of this step. The table [step of the window,
    selected] is flat.
    """
    step_in_window = run.steps_taken - run.first_step
    for k in range(len(selected)):
        table[step_in_window * len(selected) + k] = values[selected[k]]


def drift_pieces(pieces: Any, v: Any) -> None:
    """Let pieces drift for half a step: add v/2 of the first node to displacements.

    Time is counted in steps and lengths are in m/s, see `records`.
    """
    for p in range(len(pieces)):
        pieces[p].displacement += v[pieces[p].first_node] / 2


def drift_cells(v: Any, force: Any, stiffness: Any) -> None:
    """Advance tensions of cells to the middle of this step: add k (v[i] - v[i - 1]).

    They were those in the middle of the step before. Cell i is on the left of node i;
    between pieces the stiffness k is 0. The first and the last cell are not changed.
    """
    for i in range(1, len(v)):
        force[i] += stiffness[i] * (v[i] - v[i - 1])


def drift_radially(
    radial_strain: Any, radial_rate: Any, coupling: Any, force: Any
) -> None:
    """Advance radial strains q to the middle of this step, and add b dq to tensions.

    They were those in the middle of the step before. The change dq in a step is their
    rate, as time is counted in steps. `force` has the tensions of the cells; b is
    `coupling`.
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
    """Advance the rates of the radial strains q to the end of the step.

    Their change dq_t in cell i follows from

        J dq_t = s[i] (q[i + 1] - q[i]) - s[i - 1] (q[i] - q[i - 1])
                 - (G - b^2/k) q[i] - b/k force[i].

    `shear` is s, with s[i] between the cells i and i + 1; `radial_stiffness` is
    G - b^2/k, `tension_share` is b/k, and `force` has the tensions; see `records.Grid`.
    The last cell, beyond the right end of the row, keeps its rate.
    """
    shear_on_left = 0.0  # cell 0 has none
    for i in range(len(radial_strain) - 1):
        shear_on_right = shear[i] * (radial_strain[i + 1] - radial_strain[i])
        elastic = radial_stiffness[i] * radial_strain[i]
        push = shear_on_right - shear_on_left - elastic - tension_share[i] * force[i]
        radial_rate[i] += inverse_radial_inertia[i] * push
        shear_on_left = shear_on_right


def push_ends(v: Any, force: Any, ends: Any) -> None:
    """Set the forces from outside, as tensions of the cells beyond the ends of the row.

    These are the first and the last entry of `force`; a push is a negative tension. At
    a pushed end the push is the prescribed one. A semi-infinite bar of impedance Z
    pushes with Z (wave - v) at the left end and with Z (v - wave) at the right end,
    where `wave` is `background_wave` plus the prescribed wave. At any other end the
    tension is 0.
    """
    for side in range(2):
        end = ends[side]
        push = 0.0  # force on the end, positive into the row
        if end.kind == BoundaryKind.PUSHED:
            push = end.prescribed
        elif end.kind == BoundaryKind.ENDLESS:
            wave = end.background_wave + end.prescribed
            inward = 1 - 2 * side  # 1 on the left, -1 on the right
            push = inward * end.impedance * (wave - v[end.node])
        # Cell i is on the left of node i: the cell beyond the left end (side 0) has the
        # index of the node, the cell beyond the right end (side 1) that index plus 1.
        force[end.node + side] = -push


def kick(v: Any, force: Any, inverse_mass: Any) -> None:
    """Advance velocities to the end of an explicit step: m dv = F_right - F_left.

    Node i lies between the cells i and i + 1.
    """
    for i in range(len(v)):
        v[i] += inverse_mass[i] * (force[i + 1] - force[i])


def set_right_side(v: Any, force: Any, viscous: Any, old_velocity: Any, x: Any) -> None:
    """Set x, the right side of the equations of an implicit step, and `old_velocity`.

    x [node] becomes the force on a node: the tension on its right minus the tension on
    its left. The tension of cell i is `force` plus the viscous tension
    eta A/dx (v[i] - v[i - 1]) by the velocities v before the step. Node i lies between
    the cells i and i + 1; the cells beyond both ends of the row are not viscous.
    `old_velocity` becomes a copy of v.
    """
    tension_on_left = force[0]
    for i in range(len(v) - 1):
        old_velocity[i] = v[i]
        tension_on_right = force[i + 1] + viscous[i + 1] * (v[i + 1] - v[i])
        x[i] = tension_on_right - tension_on_left
        tension_on_left = tension_on_right
    last = len(v) - 1
    old_velocity[last] = v[last]
    x[last] = force[last + 1] - tension_on_left


def prescribe_changes(v: Any, x: Any, ends: Any) -> None:
    """Set the right side x of the equation of each end whose velocity is prescribed.

    It becomes the change of velocity of this end in this step. Other entries of x are
    not changed.
    """
    for side in range(2):
        if ends[side].kind == BoundaryKind.MOVED:
            x[ends[side].node] = ends[side].prescribed - v[ends[side].node]


def apply_changes(v: Any, change: Any) -> None:
    """Add the changes to the velocities, which become those at the end of the step."""
    for i in range(len(v)):
        v[i] += change[i]


def set_prescribed_velocities(v: Any, ends: Any) -> None:
    """Set the velocities of moved ends to the prescribed ones, free of round-off."""
    for side in range(2):
        if ends[side].kind == BoundaryKind.MOVED:
            v[ends[side].node] = ends[side].prescribed


def solve_contacts(run: Run, v: Any, links: Any) -> bool:
    """Find the forces of all links in this step, chain by chain.

    The forces are set in the links; v are the velocities without these forces and are
    not changed. False is returned if no forces solve a chain, as for a mass squeezed
    between two walls; the chains after it are then not solved.
    """
    for i in range(len(links)):
        is_first_of_chain = links[i].chain_end != NONE
        if is_first_of_chain and not solve_contact_chain(run, v, links, i):
            return False
    return True


def solve_contact_chain(run: Run, v: Any, links: Any, first: int) -> bool:
    """Find the forces of a chain of links; return False if they were not found.

    Links that are coupled by bodies between them make a chain, see `contact_kernel`;
    `first` is the first link of the chain. If impacts begin, all forces of the chain
    are found once more. v are the velocities at the end of the step without link
    forces; they are not changed. `force`, `force_free_closing`, `max_closing`,
    `overlap` and `force_slope` of each link of the chain are set; gaps and closings are
    not changed.
    """
    last = links[first].chain_end
    speed = 0.0  # bound of the speeds of the bodies beside a link, m/s
    for i in range(first, last + 1):
        link = links[i]
        v_left = v[link.left_node]
        v_right = v[link.right_node]
        speed = max(speed, abs(v_left) + abs(v_right) + abs(link.old_closing))
        # The closing of a step is the mean of the closing velocities before and after
        # the step.
        link.force_free_closing = (link.old_closing + v_left - v_right) / 2
        link.force_slope = 0.0
        # First guess: the link closes as much as in the step before.
        link.overlap = link.closing - link.gap
        link.max_closing = math.inf  # stays infinite until an impact begins
        if link.law != Law.IMPACT:
            # Only rigid contacts use this value. A contact that is closed has the
            # closing velocity u at the start of the step and 0 at its end: the mean is
            # u/2. A contact that closes inside the step is stopped over two steps. With
            # u1 between them, their closings (u + u1)/2 and u1/2 add up to the gap: u1
            # is gap - u/2, and the closing of this step is gap/2 + u/4.
            if link.is_closed == 1:
                max_closing = link.old_closing / 2
            else:
                max_closing = link.gap / 2 + link.old_closing / 4
            link.max_closing = max(max_closing, 0.0)
    # If the forces make another impact begin, all forces change: solve again. If the
    # chain is not solved once, the result is False.
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
    """Change the velocities v of the pieces beside the links by the link forces.

    First, the force of a rigid contact or an impact is set to 0 if it is round-off: if
    it changes the closing in the step by at most `tolerance`, m/s. `by_first` and
    `by_last` [node] are the velocity changes by a unit force on the first and on the
    last node of the piece.
    """
    for i in range(len(links)):
        link = links[i]
        has_max_closing = link.law == Law.RIGID or link.law == Law.IMPACT
        is_round_off = link.force * link.self_mobility <= tolerance
        if has_max_closing and is_round_off:
            link.force = 0.0
        if link.force != 0:
            # A force pushes the piece on its left, at the last node of this piece, to
            # the left, and the piece on its right, at the first node, to the right.
            # INDEX_MASK changes no index, but shows the compiler that none is negative.
            for n in range(
                link.leftmost_node & INDEX_MASK, (link.left_node & INDEX_MASK) + 1
            ):
                v[n] -= by_last[n] * link.force
            for n in range(
                link.right_node & INDEX_MASK, (link.rightmost_node & INDEX_MASK) + 1
            ):
                v[n] += by_first[n] * link.force


def record_links(run: Run, v: Any, links: Any, signals: Any) -> None:
    """Set closings and gaps of the links at the end of the step, and record signals.

    The mean force and closing of this step and the gap at its end are written to
    `signals` [step of the window, link], which is flat. v are the velocities at the end
    of the step. The closing of a link is the mean of those before and after the step;
    at a rigid contact or an impact with a force it is replaced by `max_closing`. The
    closing in the signal is that of the link at rigid and yielding contacts; at all
    other links it is the decrease of the gap in this step.

    In the first step of the run the force `initial_force` of a contact that closed at
    t = 0 is added in the signal, and its recorded closing is such that force times
    closing is the energy that the bodies lost. `updated_gap` also sets `is_closed` of
    rigid contacts, and the yield force and the row of the hardening table of contacts
    that yield.
    """
    for i in range(len(links)):
        link = links[i]
        gap_before = link.gap
        # Mean of the closing velocities before and after the step
        link.closing = (link.old_closing + v[link.left_node] - v[link.right_node]) / 2
        has_max_closing = link.law == Law.RIGID or link.law == Law.IMPACT
        if has_max_closing and link.force > 0:
            # `max_closing`, set with the forces of this step, is an upper bound of the
            # closing. A force > 0 means that the closing attains it: the value is the
            # same, without round-off.
            link.closing = link.max_closing
        link.gap = contacts.updated_gap(link, link.closing, run.velocity_tolerance)
        step_in_window = run.steps_taken - run.first_step
        signal = signals[step_in_window * len(links) + i]
        signal.force = link.force
        signal.gap = link.gap
        # The gap of a rigid or yielding contact does not follow its closing while it
        # presses. Any other gap decreases by the closing, exactly by this difference.
        # An impact at rest keeps its gap, too: its closing is only round-off then, and
        # the difference 0 is recorded.
        can_keep_gap = link.law == Law.RIGID or link.law == Law.YIELD
        if can_keep_gap:
            signal.closing = link.closing
        else:
            signal.closing = gap_before - link.gap
        has_initial_force = run.steps_taken == 0 and link.initial_force > 0
        if has_initial_force:
            # Energy lost in the link: by `initial_force`, and the work of its own force
            lost = link.initial_loss + link.force * link.closing
            signal.force = link.force + link.initial_force
            signal.closing = lost / signal.force


def dissipate(v: Any, old_velocity: Any, viscous: Any, lost: Any) -> None:
    """Add the energy that viscosity turned to heat in this step to `lost` [cell].

    It is eta A/dx times the square of the mean rate of elongation. The mean is that of
    the rates after the step, by v, and before the step, by `old_velocity`. Time is
    counted in steps.
    """
    for i in range(1, len(v)):
        # Rate of elongation: mean of the values after and before the step
        rate = (v[i] - v[i - 1] + (old_velocity[i] - old_velocity[i - 1])) / 2
        lost[i] += viscous[i] * rate * rate
