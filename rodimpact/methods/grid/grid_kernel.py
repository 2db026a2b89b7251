"""Rods on a staggered grid: velocities at nodes, forces in the cells between them, step after step.

Half of each cell's mass sits at either node, so that u_tt = (F_right - F_left)/m at a node and
F = E A du/dx in a cell. In every step the nodes drift half a step, are kicked by the forces in the
middle of it, and drift the other half (leapfrog). For a Courant number of 1 in a uniform rod this
carries waves without error, above 1 it explodes. With u the displacement at the end of a step, the
energy v M v/2 + (u K u - v K v/4)/2 is kept to round-off.

Where a rod is damped (sigma = E eps + eta d(eps)/dt) or resists by lateral inertia
(rho A u_tt - rho nu^2 I_p u_xxtt = E A u_xx), what a cell adds depends on the new velocities, half
of the viscous force by the mean over the step: (M + J + D/2) dv = forces - D v. This is
tridiagonal, so the step follows the wave speed alone; see `elimination_kernel`.

Cells may have a radial strain of their own; see `radial_kernel`.

Bodies bonded together are one *piece* of neighbouring nodes; between pieces lies a cell without
stiffness. Contacts are the links of `contact_kernel` between the last node of a piece and the
first of the next, with the discrete inertia seen there. Their w is the mean closing velocity of a
step. A rigid contact does not update its gap while it is shut: the two nodes move on with one
velocity. The energy that the nodes lose as it shuts is of the size of a cell. Viscous ends that
shut before the first kick are not let into each other until then: all that follows would be as much
too late, half a step where they touch from the start.
"""

from __future__ import annotations

import math
from typing import Any

from ..laws import Beyond, Law
from . import contact_kernel as contacts
from . import elimination_kernel as elimination
from . import radial_kernel as radial
from .records import FAR, NONE


def follow(grid: Any, track: Any, until: int) -> bool:
    """Go on to the end of step `until`.

    Parameters
    ----------
    grid : Grid
    track : Track
        From step `run.first` on.
    until : int

    Returns
    -------
    bool
        False if a rigid mass was caught between walls that leave it no room.
    """
    run = grid.run[0]
    # taken out of the tuples once, and handed on only where needed: a call for one array costs as
    # much as ten nodes
    v, force, stiffness, mobility = grid.velocity, grid.force, grid.stiffness, grid.mobility
    piece, implicit, node = grid.piece, grid.implicit, grid.node
    viscous, lost, change, old = grid.viscous, grid.lost, grid.change, grid.old
    strain, rate, coupling = grid.strain, grid.rate, grid.coupling
    ease, own, share, shear = grid.ease, grid.own, grid.share, grid.shear
    link, end, watched, pulled = grid.link, grid.end, grid.watched, grid.pulled
    signal, given, speed, pull = track.signal, track.given, track.speed, track.pull
    while True:
        if run.kept < len(track.when) and track.when[run.kept] == run.step:
            keep(grid, track)
            run.kept += 1
        if run.step >= until:
            return True
        remember(run, v, link, end, given)
        move(piece, v)
        drift(v, force, stiffness)
        if run.swells > 0:
            radial.drift(strain, rate, coupling, force)
            radial.kick(strain, rate, ease, own, share, shear, force)
        kick(v, force, mobility)
        if len(implicit) > 0:
            kick_implicit(implicit, node, v, force, viscous, change, old, end)
        move_ends(v, mobility, end)
        for i in range(len(link)):
            if link[i].last != NONE and not resolve(
                run, v, mobility, implicit, node, link, signal, i
            ):
                return False
        move(piece, v)
        if len(implicit) > 0:
            dissipate(implicit, v, old, viscous, lost)
        enter(run.step - run.first, v, watched, speed)
        enter(run.step - run.first, force, pulled, pull)
        run.step += 1


def keep(grid: Any, track: Any) -> None:
    """Enter the state as it is at the end of a step."""
    run, v, force, stiffness, lost = (
        grid.run[0], grid.velocity, grid.force, grid.stiffness, grid.lost)
    kept_velocity, kept_force, kept_place = track.velocity, track.force, track.place
    n, p, total = len(v), len(grid.piece), 0.0
    nodes, cells, pieces = (
        run.kept * n & FAR, run.kept * (n + 1) & FAR, run.kept * p & FAR)
    for i in range(n):
        kept_velocity[nodes + i] = v[i]
    kept_force[cells] = kept_force[cells + n] = 0.0
    for i in range(1, n):
        kept_force[cells + i] = force[i] + stiffness[i] * (v[i] - v[i - 1]) / 2
    if run.swells > 0:
        for i in range(n + 1):
            q, rate = grid.strain[i], grid.rate[i]
            kept_force[cells + i] += grid.coupling[i] * rate / 2
            track.radial[cells + i] = q + rate / 2
            track.radial_rate[cells + i] = rate
    for i in range(p):
        kept_place[pieces + i] = grid.piece[i].place
    for i in range(n + 1):
        total += lost[i]
    track.lost[run.kept] = total


def remember(run: Any, v: Any, link: Any, end: Any, given: Any) -> None:
    """Note what is given in this step, and velocities before it."""
    for i in range(len(link)):
        at = link[i]
        at.before = v[at.left] - v[at.right]
    for side in range(2):
        outside = end[side]
        outside.given = given[2 * (run.step - run.first) + side]
        outside.old = v[outside.node]


def enter(row: int, values: Any, places: Any, entered: Any) -> None:
    """Enter the values at some places in a row of a table."""
    for k in range(len(places)):
        entered[row * len(places) + k] = values[places[k]]


def move(piece: Any, v: Any) -> None:
    """Let pieces drift for half a step."""
    for p in range(len(piece)):
        piece[p].place += v[piece[p].start] / 2


def drift(v: Any, force: Any, stiffness: Any) -> None:
    """Forces in the middle of the step; between pieces there is no stiffness."""
    for i in range(1, len(v)):
        force[i] += stiffness[i] * (v[i] - v[i - 1])


def kick(v: Any, force: Any, mobility: Any) -> None:
    """Velocities of explicit pieces; the nodes of others have no mobility."""
    for i in range(len(v)):
        v[i] += mobility[i] * (force[i + 1] - force[i])


def kick_implicit(
    implicit: Any, node: Any, v: Any, force: Any, viscous: Any, x: Any, old: Any, end: Any
) -> None:
    """Velocities of implicit pieces; x becomes their changes."""
    for p in range(len(implicit)):
        a, b = implicit[p].first & FAR, implicit[p].last & FAR
        for i in range(a, b + 1):
            old[i] = v[i]
        x[a] = force[a + 1] + viscous[a + 1] * (v[a + 1] - v[a])
        x[b] = -force[b] - viscous[b] * (v[b] - v[b - 1])
        for i in range(a + 1, b):
            right = force[i + 1] + viscous[i + 1] * (v[i + 1] - v[i])
            x[i] = right - (force[i] + viscous[i] * (v[i] - v[i - 1]))
        for side in range(2):
            n = end[side].node
            if a <= n <= b:
                if end[side].kind == Beyond.MOVED:
                    x[n] = end[side].given - v[n]
                else:
                    x[n] += outer_force(end[side], side, v[n])
        elimination.substitute(implicit[p], node, x)
        for i in range(a, b + 1):
            v[i] += x[i]


def outer_force(at: Any, side: int, v: float) -> float:
    """Force to the right on the node at one end of the row; that of an endless bar at this v."""
    F: float = 0.0
    if at.kind == Beyond.PUSHED:
        F = at.given
        if side == 1:
            F = -F
    elif at.kind == Beyond.ENDLESS:
        F = at.impedance * (at.rest + at.given - v)
    return F


def move_ends(v: Any, mobility: Any, end: Any) -> None:
    """Let what is outside act on the ends of explicit pieces."""
    for side in range(2):
        at, n = end[side], end[side].node
        if at.kind == Beyond.MOVED:
            v[n] = at.given
        elif at.kind != Beyond.STEADY and mobility[n] > 0:
            v[n] += mobility[n] * outer_force(at, side, at.old)


def push(v: Any, mobility: Any, implicit: Any, node: Any, at: Any) -> None:
    """Change the velocities of both sides by the force of a link."""
    F, l, r, p, q = at.force, at.left, at.right, at.left_implicit, at.right_implicit
    if p == NONE:
        v[l] -= mobility[l] * F
    else:
        for n in range(implicit[p].first & FAR, (l & FAR) + 1):
            v[n] -= node[n].by_last * F
    if q == NONE:
        v[r] += mobility[r] * F
    else:
        for n in range(r & FAR, (implicit[q].last & FAR) + 1):
            v[n] += node[n].by_first * F


def resolve(
    run: Any, v: Any, mobility: Any, implicit: Any, node: Any, link: Any, signal: Any, first: int
) -> bool:
    """Solve links that feel each other; return False where their bodies cannot move."""
    last, speed = link[first].last, 0.0
    for i in range(first, last + 1):
        at, u, w = link[i], v[link[i].left], v[link[i].right]
        speed = max(speed, abs(u) + abs(w) + abs(at.before))
        at.free, at.slope = (at.before + u - w) / 2, 0.0
        at.place = at.closing - at.gap
        at.limit = greatest_closing(at)
    struck = True
    while struck:
        if not contacts.balance(link, first, last, speed):
            return False
        struck = contacts.start_impacts(link, first, last, run.tolerance)
    for i in range(first, last + 1):
        at = link[i]
        stiff = at.law == Law.RIGID or at.law == Law.IMPACT
        if stiff and at.force * at.own <= run.tolerance:
            at.force = 0.0
        if at.force != 0:
            push(v, mobility, implicit, node, at)
    for i in range(first, last + 1):
        at, before = link[i], link[i].gap
        at.closing = (at.before + v[at.left] - v[at.right]) / 2
        if at.law == Law.RIGID and at.force > 0:
            at.closing = at.limit
        at.gap = contacts.settle(at, at.closing, run.tolerance)
        contacts.count(at, run.resolution)
        entry = signal[(run.step - run.first) * len(link) + i]
        entry.force, entry.gap, entry.closing = at.force, at.gap, before - at.gap
        if at.law == Law.RIGID or at.law == Law.YIELD:
            entry.closing = at.closing
        if at.law == Law.RIGID and run.step == 0 and at.force > 0:  # with what the start has lost
            entry.closing = at.numerical / at.force
    return True


def greatest_closing(at: Any) -> float:
    """By how much a rigid contact that presses may close; an impact waits until it happens."""
    limit = 0.0
    if at.law == Law.IMPACT:
        limit = math.inf
    elif at.law == Law.RIGID and at.shut == 0:
        limit = max(at.gap / 2 + at.before / 4, 0.0)
    elif at.law == Law.RIGID:
        limit = max(at.before, 0.0) / 2
    return limit


def dissipate(implicit: Any, v: Any, old: Any, viscous: Any, lost: Any) -> None:
    """Enter what viscosity turned to heat."""
    for p in range(len(implicit)):
        a, b = implicit[p].first & FAR, implicit[p].last & FAR
        for i in range(a + 1, b + 1):
            rate = (v[i] - v[i - 1] + (old[i] - old[i - 1])) / 2
            lost[i] += viscous[i] * rate * rate
