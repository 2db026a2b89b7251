"""Rods on a staggered grid: velocities at nodes, forces in the cells between them, step after step.

Half of each cell's mass sits at either node, so that u_tt = (F_right - F_left)/m at a node and
F = E A du/dx in a cell. In every step the nodes drift half a step, are kicked by the forces in the
middle of it, and drift the other half (leapfrog). For a Courant number of 1 in a uniform rod this
carries waves without error, above 1 it explodes. With u the displacement at the end of a step, the
energy v M v/2 + (u K u - v K v/4)/2 is kept to round-off.

Where a rod is damped (sigma = E eps + eta d(eps)/dt) or resists by lateral inertia
(rho A u_tt - rho nu^2 I_p u_xxtt = E A u_xx), what a cell adds depends on the new velocities, half
of the viscous force by the mean over the step: (M + J + D/2) dv = forces - D v. This is
tridiagonal, so the step follows the wave speed alone; it is eliminated from both ends to the
middle, two independent recurrences at a time.

Cells may have a radial strain of their own; see `radial_kernel`.

Bodies bonded together are one *piece* of neighbouring nodes; between pieces lies a cell without
stiffness. Contacts are the links of `contact_kernel` between the last node of a piece and the
first of the next, with the discrete inertia seen there. Their w is the mean closing velocity of a
step. A rigid contact does not update its gap while it is shut: the two nodes move on with one
velocity. The energy that the nodes lose as it shuts is of the size of a cell. Viscous ends that
shut before the first kick are not let into each other until then: all that follows would be as much
too late, half a step where they touch from the start.

Units are those of `contact_kernel`: M/h, E A h/dx, displacement/h.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ..finality_kernel import NEVER, Side, bound_of, separation_time
from ..laws import IMPACT, JOINT, RIGID, YIELD
from .contact_kernel import Chain, Tally, balance, indent, record_step, start_impacts
from .radial_kernel import FAR, Radial, drift_radially, energy_of_cell, kick_radially

DONE, SQUEEZED = range(2)  # why a run stopped
STEP, KEPT, LINK = range(3)  # places in the clock
NOTHING, PUSHED, MOVED, ENDLESS = range(4)  # what an end does: free, force, velocity, absorbing


class Grid(NamedTuple):
    """Nodes and cells; cell i lies between the nodes i - 1 and i. Lists or arrays."""

    velocity: Any  # [node]
    force: Any  # [cell] elastic tension in the middle of the last step; 0 between pieces
    mobility: Any  # [node] 1/mass; 0 where the velocity is given, or the piece is implicit
    stiffness: Any  # [cell]
    first: Any  # [stretch] of nodes of an explicit piece: its first and
    last: Any  # [stretch] last node
    kick: Any  # [stretch] ease of its inner nodes, -1 if they differ
    stiff: Any  # [stretch] stiffness of its cells, -1 if they differ
    joint: Any  # [joint] first and last nodes of stretches
    start: Any  # [piece] first node
    place: Any  # [piece] its displacement


class Implicit(NamedTuple):
    """Pieces that are damped or have lateral inertia."""

    first: Any  # [implicit piece] nodes
    middle: Any
    last: Any
    left: Any  # [implicit piece] what the middle takes from its neighbours
    right: Any
    viscous: Any  # [cell] eta A/dx
    bound: Any  # [cell] what couples its two nodes: lateral inertia and half the viscosity
    into: Any  # [node] multipliers of the elimination
    back: Any  # [node]
    inverse: Any  # [node]
    by_first: Any  # [node] velocity for a unit force on the first node of the piece
    by_last: Any  # [node] and on the last
    change: Any  # [node] of the velocity in this step
    old: Any  # [node] velocity before it
    lost: Any  # [cell] turned to heat


class Links(NamedTuple):
    """Contacts and joints, from left to right."""

    law: Any
    stiffness: Any
    exponent: Any
    damping: Any
    strength: Any
    gap: Any
    force: Any
    closing: Any  # mean closing velocity of the last step
    open: Any  # 1 if the gap has opened since the contact last pressed
    shut: Any  # 1 while a rigid contact is closed
    left: Any  # node on the left
    right: Any
    left_implicit: Any  # implicit piece on the left, -1 if it is explicit
    right_implicit: Any
    own: Any  # half the mobility of both sides together
    shared: Any  # half the mobility that it shares with the link before
    before: Any  # closing velocity at the start of the step
    strained: Any  # [strained cell] which one, as its end shuts before the first kick
    stretch: Any  # [strained cell] by how much then
    straining: Any  # [strained cell] link
    group: Any  # [group + 1] first links of those that feel each other


class Bonds(NamedTuple):
    """Interfaces in a piece whose force is asked for: F > 0 pushes the parts apart."""

    node: Any
    mass: Any  # of what stands at the node on one side of the interface
    side: Any  # on which side: 0 left, 1 right
    cell: Any  # that pulls at it, -1 if none
    link: Any  # that pushes it, -1 if none
    end: Any  # of the row that pushes it, 0 or 1, -1 if none
    here: Any  # velocity of the node before the step
    there: Any  # and of the cell's other node


class Ends(NamedTuple):
    """What acts on the left and on the right end of the row."""

    kind: Any  # NOTHING, PUSHED, MOVED, ENDLESS
    node: Any
    impedance: Any  # of an endless bar
    rest: Any  # the wave that comes from it beside the given one
    old: Any  # velocity of the node before the step


class Groups(NamedTuple):
    """What the proof of finality asks of pieces, and of those that are joined."""

    first: Any  # [group] nodes
    last: Any
    mass: Any  # [node]
    held: Any  # [node] 1 if its velocity is given
    lateral: Any  # [cell] inertia that resists changes of its length
    relaxed: Any  # [cell] stiffness where the radial strain follows
    left: Any  # [link] group on the left
    right: Any
    joint: Any  # [cell] the joint that stands there, -1 without


class Signals(NamedTuple):
    """By step, one after the other; entry j of a signal stands at its start + j."""

    force: Any
    gap: Any
    closing: Any
    link_start: Any  # [link]
    bond: Any  # bond b starts at b room
    given: Any  # at side room: force or wave, or velocity at the end of each step
    push: Any  # at side room: force of the outside to the inside
    speed: Any  # at side room: mean velocity of the end
    room: Any  # [1]
    mass_node: Any  # [mass]
    mass_speed: Any  # mass m starts at m room


class States(NamedTuple):
    """States that are kept: at the ends of the steps `when`, the first of them 0."""

    when: Any
    velocity: Any
    force: Any
    place: Any
    lost: Any
    radial: Any  # radial strains of cells, none where no cell has its own
    radial_rate: Any


def factor(implicit: Implicit, diagonal: Any, held: Any, p: int) -> None:
    """Eliminate implicit piece p from both ends to the middle; `held` nodes have given velocities.

    The row of node i is diagonal[i] x[i] - bound[i] x[i - 1] - bound[i + 1] x[i + 1].
    """
    a, m, b = implicit.first[p], implicit.middle[p], implicit.last[p]
    bound, into, back, inverse = implicit.bound, implicit.into, implicit.back, implicit.inverse
    middle = diagonal[m]
    for i, step, end in ((a, 1, m), (b, -1, m)):
        carried = 0.0
        while i != end:
            cell = i + 1 if step > 0 else i
            inverse[i] = 1.0 if held[i] else 1 / (diagonal[i] - carried)
            back[i] = 0.0 if held[i] else bound[cell] * inverse[i]
            into[i + step] = bound[cell] * inverse[i]
            carried = bound[cell] * back[i]
            i += step
        middle -= carried
    implicit.left[p] = implicit.right[p] = 0.0
    if held[m]:
        inverse[m] = 1.0
        return
    inverse[m] = 1 / middle
    if m > a:
        implicit.left[p] = bound[m] * inverse[m - 1]
    if m < b:
        implicit.right[p] = bound[m + 1] * inverse[m + 1]


def substitute(implicit: Implicit, x: Any, p: int) -> None:
    """Solve for implicit piece p; x holds the right side and becomes the solution."""
    a, m, b = implicit.first[p], implicit.middle[p], implicit.last[p]
    into, back, inverse = implicit.into, implicit.back, implicit.inverse
    near, far = m - a, b - m
    both = near if near < far else far
    y, z = x[a], x[b]
    for i in range(1, both):
        y = x[a + i] + into[a + i] * y
        z = x[b - i] + into[b - i] * z
        x[a + i], x[b - i] = y, z
    for i in range(max(both, 1), near):
        y = x[a + i] + into[a + i] * y
        x[a + i] = y
    for i in range(max(both, 1), far):
        z = x[b - i] + into[b - i] * z
        x[b - i] = z
    y = x[m]
    if near > 0:
        y += implicit.left[p] * x[m - 1]
    if far > 0:
        y += implicit.right[p] * x[m + 1]
    y *= inverse[m]
    x[m], z = y, y
    for i in range(1, both + 1):
        y = inverse[m - i] * x[m - i] + back[m - i] * y
        z = inverse[m + i] * x[m + i] + back[m + i] * z
        x[m - i], x[m + i] = y, z
    for i in range(both + 1, near + 1):
        y = inverse[m - i] * x[m - i] + back[m - i] * y
        x[m - i] = y
    for i in range(both + 1, far + 1):
        z = inverse[m + i] * x[m + i] + back[m + i] * z
        x[m + i] = z


def drift(grid: Grid, implicit: Implicit) -> None:
    """Forces in the middle of the step."""
    v, force, stiffness = grid.velocity, grid.force, grid.stiffness
    for g in range(len(grid.first)):
        a, b, k = grid.first[g] & FAR, grid.last[g] & FAR, grid.stiff[g]
        if k >= 0:
            for i in range(a + 1, b + 1):
                force[i] += k * (v[i] - v[i - 1])
        else:
            for i in range(a + 1, b + 1):
                force[i] += stiffness[i] * (v[i] - v[i - 1])
    for p in range(len(implicit.first)):
        a, b = implicit.first[p] & FAR, implicit.last[p] & FAR
        for i in range(a + 1, b + 1):
            force[i] += stiffness[i] * (v[i] - v[i - 1])


def kick(grid: Grid) -> None:
    """Velocities of explicit pieces."""
    v, force, mobility = grid.velocity, grid.force, grid.mobility
    for g in range(len(grid.first)):
        a, b, k = grid.first[g] & FAR, grid.last[g] & FAR, grid.kick[g]
        if k >= 0:
            for i in range(a + 1, b):
                v[i] += k * (force[i + 1] - force[i])
        else:
            for i in range(a + 1, b):
                v[i] += mobility[i] * (force[i + 1] - force[i])
    for j in range(len(grid.joint)):
        i = grid.joint[j]
        v[i] += mobility[i] * (force[i + 1] - force[i])


def kick_implicit(grid: Grid, implicit: Implicit, ends: Ends, signals: Signals, j: int) -> None:
    """Velocities of implicit pieces."""
    v, force, x, old = grid.velocity, grid.force, implicit.change, implicit.old
    viscous = implicit.viscous
    for p in range(len(implicit.first)):
        a, b = implicit.first[p] & FAR, implicit.last[p] & FAR
        for i in range(a, b + 1):
            old[i] = v[i]
        x[a] = force[a + 1] + viscous[a + 1] * (v[a + 1] - v[a])
        x[b] = -force[b] - viscous[b] * (v[b] - v[b - 1])
        for i in range(a + 1, b):
            right = force[i + 1] + viscous[i + 1] * (v[i + 1] - v[i])
            x[i] = right - (force[i] + viscous[i] * (v[i] - v[i - 1]))
        for side in range(2):
            n = ends.node[side]
            if a <= n <= b:
                if ends.kind[side] == MOVED:
                    x[n] = signals.given[side * signals.room[0] + j] - v[n]
                else:
                    x[n] += outer_force(ends, signals, side, j, v[n])
        substitute(implicit, x, p)
        for i in range(a, b + 1):
            v[i] += x[i]


def outer_force(ends: Ends, signals: Signals, side: int, j: int, v: float) -> float:
    """Force to the right on the node at one end of the row; that of an endless bar at this v."""
    F: float = 0.0
    if ends.kind[side] == PUSHED:
        F = signals.given[side * signals.room[0] + j]
        if side == 1:
            F = -F
    elif ends.kind[side] == ENDLESS:
        wave = ends.rest[side] + signals.given[side * signals.room[0] + j]
        F = ends.impedance[side] * (wave - v)
    return F


def move_ends(grid: Grid, ends: Ends, signals: Signals, j: int) -> None:
    """Let what is outside act on the ends of explicit pieces."""
    for side in range(2):
        n = ends.node[side]
        if ends.kind[side] == MOVED:
            grid.velocity[n] = signals.given[side * signals.room[0] + j]
        elif ends.kind[side] != NOTHING and grid.mobility[n] > 0:
            F = outer_force(ends, signals, side, j, ends.old[side])
            grid.velocity[n] += grid.mobility[n] * F


def push(grid: Grid, implicit: Implicit, links: Links, i: int, F: float) -> None:
    """Change the velocities of both sides by the force of link i."""
    v, l, r = grid.velocity, links.left[i], links.right[i]
    p, q = links.left_implicit[i], links.right_implicit[i]
    if p < 0:
        v[l] -= grid.mobility[l] * F
    else:
        for n in range(implicit.first[p] & FAR, (l & FAR) + 1):
            v[n] -= implicit.by_last[n] * F
    if q < 0:
        v[r] += grid.mobility[r] * F
    else:
        for n in range(r & FAR, (implicit.last[q] & FAR) + 1):
            v[n] += implicit.by_first[n] * F


def settle(
    links: Links, tally: Tally, chain: Chain, i: int, q: int, F: float, w: float, tol: float
) -> float:
    """Enter what link i loses while it closes by w; return its gap at the step's end."""
    law, gap, before = links.law[i], links.gap[i], links.before[i]
    rest: float = gap - w
    if law == RIGID:
        tally.numerical[i] += F * w
        shut = links.shut[i] > 0
        links.shut[i] = 1
        if shut and F <= 0 and 2 * w - before < -tol:
            links.shut[i] = 0
            rest = before / 2 - w
        elif shut:
            rest = 0.0
        elif F <= 0:
            links.shut[i] = 0
    elif law == IMPACT:
        if F > 0:
            tally.lost[i] += F * chain.limit[q]
            rest = gap - chain.limit[q]
        elif gap <= 0 and abs(w) <= tol:
            rest = gap
    else:
        rest = indent(links, tally, i, F, chain.place[q])
    return rest


def resolve_contact(
    grid: Grid, implicit: Implicit, links: Links, chain: Chain, tally: Tally, signals: Signals,
    i0: int, last: int, j: int, tol: float, gap_resolution: float,
) -> bool:
    """Solve the links i0 to i0 + last in step j; return False where their bodies cannot move."""
    v, speed = grid.velocity, 0.0
    for q in range(last + 1):
        i = i0 + q
        u, w, before = v[links.left[i]], v[links.right[i]], links.before[i]
        speed = max(speed, abs(u) + abs(w) + abs(before))
        chain.free[q], chain.own[q] = (before + u - w) / 2, links.own[i]
        chain.shared[q], chain.before[q] = links.shared[i], before
        chain.force[q], chain.slope[q] = links.force[i], 0.0
        chain.place[q] = links.closing[i] - links.gap[i]
        chain.limit[q] = 0.0
        if links.law[i] == RIGID:
            chain.limit[q] = max(before, 0.0) / 2
            if links.shut[i] == 0:
                chain.limit[q] = max(links.gap[i] / 2 + before / 4, 0.0)
        elif links.law[i] == IMPACT:
            chain.limit[q] = math.inf
    struck = True
    while struck:
        if not balance(links, chain, i0, last, speed):
            return False
        struck = start_impacts(links, chain, i0, last, tol)
    for q in range(last + 1):
        i, F = i0 + q, chain.force[q]
        if RIGID <= links.law[i] <= IMPACT and F * links.own[i] <= tol:
            F = 0.0
        chain.force[q] = F
        if F != 0:
            push(grid, implicit, links, i, F)
    for q in range(last + 1):
        i, F = i0 + q, chain.force[q]
        w = (links.before[i] + v[links.left[i]] - v[links.right[i]]) / 2
        if links.law[i] == RIGID and F > 0:
            w = chain.limit[q]
        gap = settle(links, tally, chain, i, q, F, w, tol)
        links.closing[i] = w
        signals.closing[signals.link_start[i] + j] = links.gap[i] - gap
        if links.law[i] == RIGID or links.law[i] == YIELD:
            signals.closing[signals.link_start[i] + j] = w
        if links.law[i] == RIGID and j == 0 and F > 0:  # with what `shut_at_once` has entered
            signals.closing[signals.link_start[i] + j] = tally.numerical[i] / F
        opened = links.open[i]
        record_step(links, tally, signals, i, j, F, gap)
        if gap <= gap_resolution:
            links.open[i] = min(opened, links.open[i])
    return True


def record_bond_forces(
    grid: Grid, implicit: Implicit, bonds: Bonds, links: Links, ends: Ends, signals: Signals, j: int
) -> None:
    """Enter the forces at bonds and what passed the ends in step j."""
    v, room = grid.velocity, signals.room[0]
    for side in range(2):
        if ends.kind[side] == NOTHING:
            continue
        n = ends.node[side]
        mean = (ends.old[side] + v[n]) / 2
        signals.speed[side * room + j] = mean
        F = outer_force(ends, signals, side, j, mean)
        signals.push[side * room + j] = F if side == 0 else -F
    for b in range(len(bonds.node)):
        n, c, i, e = bonds.node[b], bonds.cell[b], bonds.link[b], bonds.end[b]
        pulled: float = 0.0
        if c >= 0:
            other = n - 1 if c == n else n + 1
            sign = 1 if c == n else -1
            stretch = sign * (bonds.here[b] - bonds.there[b])
            change = sign * (v[n] - v[other]) - stretch
            pulled = grid.force[c] + implicit.viscous[c] * stretch + implicit.bound[c] * change
        if i >= 0:
            pulled -= links.force[i]
        if e >= 0:
            pulled -= signals.push[e * room + j]
        F = -pulled - bonds.mass[b] * (v[n] - bonds.here[b])
        if bonds.side[b] == 1:
            F = bonds.mass[b] * (v[n] - bonds.here[b]) - pulled
        signals.bond[b * room + j] = F
    for m in range(len(signals.mass_node)):
        signals.mass_speed[m * room + j] = v[signals.mass_node[m]]


def shut_at_once(grid: Grid, links: Links, tally: Tally) -> None:
    """Part the ends that shut before the first kick by what they would overlap there."""
    v, force = grid.velocity, grid.force
    for e in range(len(links.strained)):
        i, stretch = links.strained[e], links.stretch[e]
        k = grid.stiffness[i]
        tension = force[i] + k * (v[i] - v[i - 1]) / 2
        tally.numerical[links.straining[e]] -= stretch * (tension + k * stretch / 2)
        force[i] += k * stretch


def remember(grid: Grid, links: Links, bonds: Bonds, ends: Ends) -> None:
    """Note the velocities that are asked for after the step."""
    v = grid.velocity
    for i in range(len(links.law)):
        links.before[i] = v[links.left[i]] - v[links.right[i]]
    for side in range(2):
        ends.old[side] = v[ends.node[side]]
    for b in range(len(bonds.node)):
        n, c = bonds.node[b], bonds.cell[b]
        bonds.here[b] = bonds.there[b] = v[n]
        if c >= 0:
            bonds.there[b] = v[n - 1 if c == n else n + 1]


def dissipate(grid: Grid, implicit: Implicit) -> None:
    """Enter what viscosity turned to heat."""
    v, old, viscous, lost = grid.velocity, implicit.old, implicit.viscous, implicit.lost
    for p in range(len(implicit.first)):
        a, b = implicit.first[p] & FAR, implicit.last[p] & FAR
        for i in range(a + 1, b + 1):
            rate = (v[i] - v[i - 1] + (old[i] - old[i - 1])) / 2
            lost[i] += viscous[i] * rate * rate


def keep(grid: Grid, implicit: Implicit, radial: Radial, states: States, place: int) -> None:
    """Enter a state: all as it is at the end of a step."""
    v, force, stiffness = grid.velocity, grid.force, grid.stiffness
    n, pieces, lost = len(v), len(grid.start), 0.0
    for i in range(n):
        states.velocity[place * n + i] = v[i]
    states.force[place * (n + 1)] = states.force[place * (n + 1) + n] = 0.0
    for i in range(1, n):
        tension = force[i] + stiffness[i] * (v[i] - v[i - 1]) / 2
        states.force[place * (n + 1) + i] = tension
        lost += implicit.lost[i]
    for g in range(len(radial.first)):
        for i in range(radial.first[g], radial.last[g] + 1):
            c = place * (n + 1) + i
            states.force[c] += radial.coupling[i] * radial.rate[i] / 2
            states.radial[c] = radial.strain[i] + radial.rate[i] / 2
            states.radial_rate[c] = radial.rate[i]
    for p in range(pieces):
        states.place[place * pieces + p] = grid.place[p]
    states.lost[place] = lost


def run(
    grid: Grid, implicit: Implicit, radial: Radial, links: Links, chain: Chain, bonds: Bonds,
    ends: Ends, tally: Tally, signals: Signals, states: States, clock: Any, end: int, tol: float,
    gap_resolution: float,
) -> int:
    """Go on from the end of step clock[STEP] to that of step `end`.

    Parameters
    ----------
    grid, implicit, radial, links, chain, bonds, ends, tally, signals, states
    clock : [3] int
        Steps taken; states kept; link of the trouble after SQUEEZED.
    end : int
    tol : float
        Velocity below which contacts graze and impacts rest.
    gap_resolution : float
        Gap, in velocity times steps, that counts as no opening: the mesh does not see it.

    Returns
    -------
    DONE, or SQUEEZED: a rigid mass was caught between walls that leave it no room.
    """
    v, place = grid.velocity, clock[KEPT]
    j = clock[STEP]
    while True:
        if place < len(states.when) and states.when[place] == j:
            keep(grid, implicit, radial, states, place)
            place += 1
        clock[STEP], clock[KEPT] = j, place
        if j >= end:
            return DONE
        if j == 0:
            shut_at_once(grid, links, tally)
        remember(grid, links, bonds, ends)
        for p in range(len(grid.start)):
            grid.place[p] += v[grid.start[p]] / 2
        drift(grid, implicit)
        drift_radially(radial, grid.force)
        kick_radially(radial, grid.force)
        kick(grid)
        kick_implicit(grid, implicit, ends, signals, j)
        move_ends(grid, ends, signals, j)
        for g in range(len(links.group) - 1):
            i, last = links.group[g], links.group[g + 1] - links.group[g] - 1
            if not resolve_contact(
                grid, implicit, links, chain, tally, signals, i, last, j, tol, gap_resolution
            ):
                clock[LINK] = i
                return SQUEEZED
        for p in range(len(grid.start)):
            grid.place[p] += v[grid.start[p]] / 2
        dissipate(grid, implicit)
        record_bond_forces(grid, implicit, bonds, links, ends, signals, j)
        j += 1


def finality_time(
    groups: Groups, grid: Grid, radial: Radial, links: Links, ends: Ends, tol: float
) -> int:
    """Steps until it may be proved that nothing meets again: 0 if it is, NEVER if not as it is.

    For rows whose ends are not driven.
    """
    wait = 0
    for i in range(len(links.gap)):
        if links.law[i] == JOINT:
            continue
        if links.gap[i] < 0:
            return NEVER
        if wait < NEVER:
            left = side_of(groups, grid, radial, links, ends, groups.left[i], True, tol)
            right = side_of(groups, grid, radial, links, ends, groups.right[i], False, tol)
            wait = max(wait, separation_time(links.gap[i], left, right, tol))
    return wait


def side_of(
    groups: Groups, grid: Grid, radial: Radial, links: Links, ends: Ends, p: int, right_end: bool,
    tol: float,
) -> Side:
    """What the proof asks of group p, whose right or left end is at the contact.

    A far endless bar of impedance Z gives way by the momentum it has taken, over Z, and a joint
    that is a dashpot alone by the change of momentum over its c. The end is half a step ahead of
    the cells, by no more than the velocity that the energy gives it.
    """
    a, b = groups.first[p], groups.last[p]
    near, far = (b, a) if right_end else (a, b)
    mass: float = 0.0
    momentum: float = 0.0  # relative to the first node, so that a body without vibration has none
    for n in range(a, b + 1):
        mass += groups.mass[n]
        momentum += groups.mass[n] * (grid.velocity[n] - grid.velocity[a])
    Z, held = 0.0, groups.held[far] > 0
    mean: float = 0.0
    if held:
        mean = grid.velocity[far]
    else:
        mean = grid.velocity[a] + momentum / mass
        for s in range(2):
            if ends.node[s] == far and ends.kind[s] == ENDLESS:
                Z, mean = ends.impedance[s], ends.rest[s]
    if a == b:
        return Side(mean, mean, mean, 0.0, 0.0)
    energy: float = 0.0
    taken: float = 0.0
    beyond: float = 0.0
    d: float = 0.0
    slack: float = 0.0
    loose: float = 0.0
    for n in range(a, b + 1):
        v = grid.velocity[n] - mean
        energy += groups.mass[n] * v * v / 2
        taken += groups.mass[n] * v
        if n < b:
            k, change = grid.stiffness[n + 1], grid.velocity[n + 1] - grid.velocity[n]
            coupling, rate = radial.coupling[n + 1], radial.rate[n + 1]
            now = grid.force[n + 1] + k * change / 2 + coupling * rate / 2
            relaxed, i = groups.relaxed[n + 1], groups.joint[n + 1]
            if i >= 0:
                k, change = links.stiffness[i], 0.0
                now, relaxed = k * links.gap[i], k
            beyond += groups.mass[n] / mass
            g: float = 1.0
            if not held and Z == 0:
                g = beyond if right_end else 1 - beyond
            if k == 0:
                loose += 2 * g / links.damping[i]
                continue
            energy += groups.lateral[n + 1] * change * change / 2
            energy += (now * now - k * k * change * change / 4) / (2 * k)
            energy += energy_of_cell(radial, n + 1, change)
            d += (now - coupling * (radial.strain[n + 1] + rate / 2)) / k * g
            slack += g * g / relaxed
    if not right_end:
        d = -d
    if Z > 0:
        d -= taken / Z
        slack = 2 * (slack + mass / (Z * Z))
    if loose > 0:
        slack = 2 * (slack + mass * loose * loose)
    bound = bound_of(energy, slack) + math.sqrt(max(energy, 0.0) / (2 * groups.mass[near]))
    if bound <= tol:
        return Side(mean, mean, mean, d, bound)
    return Side(mean, -math.inf, math.inf, d, bound)
