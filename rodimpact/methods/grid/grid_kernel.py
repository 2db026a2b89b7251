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

By Mindlin and Herrmann each cell has a radial strain q of its own. In a cell of stiffness k at
constant q, du being how much longer it is, and between neighbours,

    tension = k du + b q,    J q_tt = change of (s times the change of q) - G q - b du

so that G q + b du is (G - b^2/k) q + b/k times the tension. Both are kicked and drift together with
the nodes, which keeps the same energy with q among the displacements u.

Bodies bonded together are one *piece* of neighbouring nodes; between pieces lies a cell without
stiffness. Contacts are the links of `contact_kernel` between the last node of a piece and the
first of the next, with the discrete inertia seen there. Their w is the mean closing velocity of a
step. A rigid contact does not update its gap while it is shut: the two nodes move on with one
velocity. The energy that the nodes lose as it shuts is of the size of a cell. Viscous ends that
touch at t = 0 have already begun to slow down, see `start.slow_down`: all that follows would be
half a step too late.
"""

import math
from typing import Any

from ..link import Law
from ..states import Beyond
from . import contact_kernel as contacts
from . import elimination_kernel as elimination
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
    # taken out of the tuples once, and by name: whatever takes a tuple in the loop, or an array out
    # of it, makes all references count in each step
    v, force, stiffness, piece = grid.velocity, grid.force, grid.stiffness, grid.piece
    into, inverse, back, change = grid.into, grid.inverse, grid.back, grid.change
    viscous, lost, old = grid.viscous, grid.lost, grid.old
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
            drift_radially(strain, rate, coupling, force)
            kick_radially(strain, rate, ease, own, share, shear, force)
        push_ends(v, force, end)
        if run.implicit > 0:
            pull_implicit(v, force, viscous, old, change, end)
            elimination.substitute(into, inverse, back, change)
            for i in range(len(v)):
                v[i] += change[i]
        else:
            kick(v, force, inverse)
        for side in range(2):
            if end[side].kind == Beyond.MOVED:
                v[end[side].node] = end[side].given
        for i in range(len(link)):
            if link[i].last != NONE and not resolve(run, v, link, i):
                return False
        push(v, grid.by_first, grid.by_last, link, run.tolerance)
        record(run, v, link, signal)
        move(piece, v)
        if run.implicit > 0:
            dissipate(v, old, viscous, lost)
        enter(run.step - run.first, v, watched, speed)
        enter(run.step - run.first, force, pulled, pull)
        run.step += 1


def keep(grid: Any, track: Any) -> None:
    """Enter the state as it is at the end of a step."""
    run, v, force, stiffness = grid.run[0], grid.velocity, grid.force, grid.stiffness
    strain, rate, coupling = grid.strain, grid.rate, grid.coupling
    kept, radial, n, total = track.force, track.radial, len(v), 0.0
    nodes, cells, pieces = (
        run.kept * n,
        run.kept * (n + 1) & FAR,
        run.kept * len(grid.piece),
    )
    kept[cells] = kept[cells + n] = 0.0
    for i in range(n):  # numba compiles a loop in a tenth of the time of a copied slice
        track.velocity[nodes + i] = v[i]
        if i > 0:
            kept[cells + i] = force[i] + stiffness[i] * (v[i] - v[i - 1]) / 2
    if run.swells > 0:
        for i in range(n + 1):
            track.radial_rate[cells + i] = rate[i]
            kept[cells + i] += coupling[i] * rate[i] / 2
            radial[cells + i] = strain[i] + rate[i] / 2
    for i in range(len(grid.piece)):
        track.place[pieces + i] = grid.piece[i].place
    for lost in grid.lost:
        total += lost
    track.lost[run.kept] = total


def remember(run: Any, v: Any, link: Any, end: Any, given: Any) -> None:
    """Note what is given in this step, and velocities before it."""
    for i in range(len(link)):
        at = link[i]
        at.before = v[at.left] - v[at.right]
    for side in range(2):
        end[side].given = given[2 * (run.step - run.first) + side]


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


def drift_radially(strain: Any, rate: Any, coupling: Any, force: Any) -> None:
    """Radial strains in the middle of the step, and what they add to the forces."""
    for i in range(len(strain)):
        strain[i] += rate[i]
        force[i] += coupling[i] * rate[i]


def kick_radially(
    strain: Any, rate: Any, ease: Any, own: Any, share: Any, shear: Any, force: Any
) -> None:
    """Rates of radial strain."""
    before = 0.0
    for i in range(len(strain) - 1):
        after = shear[i] * (strain[i + 1] - strain[i])
        rate[i] += ease[i] * (after - before - own[i] * strain[i] - share[i] * force[i])
        before = after


def push_ends(v: Any, force: Any, end: Any) -> None:
    """Forces of what is outside, as if there were cells beyond the ends of the row."""
    for side in range(2):
        at, push = end[side], 0.0  # into the row
        if at.kind == Beyond.PUSHED:
            push = at.given
        elif at.kind == Beyond.ENDLESS:
            push = (1 - 2 * side) * at.impedance * (at.rest + at.given - v[at.node])
        force[at.node + side] = -push


def kick(v: Any, force: Any, mobility: Any) -> None:
    """Velocities where nothing is implicit."""
    for i in range(len(v)):
        v[i] += mobility[i] * (force[i + 1] - force[i])


def pull_implicit(v: Any, force: Any, viscous: Any, old: Any, x: Any, end: Any) -> None:
    """Forces x on the nodes, with those that viscosity adds; the changes that are given."""
    before = force[0]
    for i in range(len(v) - 1):
        old[i] = v[i]
        after = force[i + 1] + viscous[i + 1] * (v[i + 1] - v[i])
        x[i] = after - before
        before = after
    n = len(v) - 1
    old[n] = v[n]
    x[n] = force[n + 1] - before
    for side in range(2):
        if end[side].kind == Beyond.MOVED:
            x[end[side].node] = end[side].given - v[end[side].node]


def resolve(run: Any, v: Any, link: Any, first: int) -> bool:
    """Solve links that feel each other; return False where their bodies cannot move."""
    last, speed = link[first].last, 0.0
    for i in range(first, last + 1):
        at, u, w = link[i], v[link[i].left], v[link[i].right]
        speed = max(speed, abs(u) + abs(w) + abs(at.before))
        at.free, at.slope = (at.before + u - w) / 2, 0.0
        at.place = at.closing - at.gap
        at.limit = math.inf  # an impact waits until it happens
        if at.law != Law.IMPACT:
            at.limit = max(
                at.before / 2 if at.shut == 1 else at.gap / 2 + at.before / 4, 0.0
            )
    struck = found = True
    while struck:
        found = contacts.balance(link, first, last, speed) and found
        struck = contacts.start_impacts(link, first, last, run.tolerance)
    return found


def push(v: Any, by_first: Any, by_last: Any, link: Any, tol: float) -> None:
    """Change the velocities on both sides of links by their forces."""
    for i in range(len(link)):
        at = link[i]
        if (at.law == Law.RIGID or at.law == Law.IMPACT) and at.force * at.own <= tol:
            at.force = 0.0
        if at.force != 0:
            for n in range(at.leftmost & FAR, (at.left & FAR) + 1):
                v[n] -= by_last[n] * at.force
            for n in range(at.right & FAR, (at.rightmost & FAR) + 1):
                v[n] += by_first[n] * at.force


def record(run: Any, v: Any, link: Any, signal: Any) -> None:
    """Enter what passed in links, and their gaps at the end of the step."""
    for i in range(len(link)):
        at, before = link[i], link[i].gap
        at.closing = (at.before + v[at.left] - v[at.right]) / 2
        if (at.law == Law.RIGID or at.law == Law.IMPACT) and at.force > 0:
            at.closing = at.limit
        at.gap = contacts.settle(at, at.closing, run.tolerance)
        entry = signal[(run.step - run.first) * len(link) + i]
        entry.force, entry.gap, entry.closing = at.force, at.gap, before - at.gap
        if at.law == Law.RIGID or at.law == Law.YIELD:
            entry.closing = at.closing
        if run.step == 0 and at.early_force > 0:
            work = at.early_loss + at.force * at.closing
            entry.force = at.force + at.early_force
            entry.closing = work / entry.force


def dissipate(v: Any, old: Any, viscous: Any, lost: Any) -> None:
    """Enter what viscosity turned to heat."""
    for i in range(1, len(v)):
        rate = (v[i] - v[i - 1] + (old[i] - old[i - 1])) / 2
        lost[i] += viscous[i] * rate * rate
