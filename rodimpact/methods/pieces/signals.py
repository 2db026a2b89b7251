"""Signals of a run from its log: waves, contacts, rigid masses, and ends of the row."""

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial.chebyshev import chebder

from ...model import Wall
from ..clock import Clock
from ..groups import fill_bonds
from ..link import Law
from ..row import Row
from ..run import BoundaryAction, ContactSignal, Signals, Waves, episodes_of
from ..signals import Pieces, each_once

NOTHING = Pieces([0], [0.0])
"""The signal that is always 0."""


def signals_of(row: Row, clock: Clock, end: int, state: Any) -> Signals:
    """Signals of a run: waves, contacts, actions on both ends, and rigid bodies.

    There is a signal of each contact of the system, including bonds between rigid
    bodies, whose force follows from the motion. If an end is a wall, the force on it is
    that of the nearest contact.

    Parameters
    ----------
    row : Row
    clock : Clock
    end : int
        Last tick of the run.
    state : State
        Records of the run, as arrays.
    """
    run = state.runs[0]
    bodies = row.system.bodies
    lines = _lines(state.log[: run["piece_count"]], len(state.lines))
    contact_events = state.contact_log[: run["contact_event_count"]]
    # Velocity of the frame, which falls: a straight line
    fall = clock.gravity * clock.tick * np.array([0.0, end])
    frame = Pieces.through([0, end], clock.frame + fall)
    masses = _masses(row, end, lines, frame, state, contact_events)
    contacts: list[ContactSignal | None] = []
    for i in row.contact_link:
        if i < 0:  # the contact is a bond between rigid bodies, which is not a link
            contacts.append(None)
        else:
            of_link = contact_events[contact_events["link"] == i]
            contact = _contact(state.links[i], of_link, lines, clock.tick)
            contacts.append(contact)
    left_end = _outside(row, 0, lines, frame, state)
    right_end = _outside(row, 1, lines, frame, state)
    # Contacts are passed in order from the end at which the wall is.
    left = _with_wall_force(left_end, bodies[0], contacts)
    right = _with_wall_force(right_end, bodies[-1], contacts[::-1])
    # Forces of bonds are computed from left to right, from the force on the left end.
    if left is None:
        push = NOTHING
    else:
        push = left.push
    all_contacts = _with_bonds(row, contacts, masses, clock.tick, push)
    # Segment s, from 1 on, has the entries 2 s and 2 s + 1 of `Waves`.
    waves = Waves([None, None, *lines[: 2 * len(row.segments)]])
    boundary_actions = (left, right)
    return Signals(waves, all_contacts, boundary_actions, masses=masses)


def _with_bonds(
    row: Row,
    contacts: list[ContactSignal | None],
    masses: dict[int, Pieces],
    tick: float,
    push: Pieces,
) -> tuple[ContactSignal, ...]:
    """Signals of all contacts, with those of bonds between rigid bodies filled in.

    Such a bond is None in `contacts`. Its force follows from the neighbouring forces
    and the accelerations of the bodies, see `fill_bonds`. Its gap and closing velocity
    are 0, and it has no episodes. `masses` are the velocities of rigid bodies by the
    number of the body, `push` is the force on the left end of the row, N, and `tick`
    the duration of a tick, s.
    """

    def inertia_force(body: int) -> Pieces:
        """Mass times acceleration of a rigid body, N."""
        mass = float(row.system.bodies[body].mass)
        return _rate(masses[body], mass / tick)  # rates per tick, divided by the tick

    forces: list[Pieces | None] = []
    for contact in contacts:
        if contact is None:
            forces.append(None)
        else:
            forces.append(contact.force)
    all_forces = fill_bonds(row.system, forces, inertia_force, push)
    signals = []
    for contact, force in zip(contacts, all_forces, strict=True):
        if contact is None:
            bond = ContactSignal(force, gap=NOTHING, closing=NOTHING, episodes=())
            signals.append(bond)
        else:
            signals.append(contact)
    return tuple(signals)


def _masses(
    row: Row,
    end: int,
    lines: list[Pieces],
    frame: Pieces,
    state: Any,
    contact_events: Any,
) -> dict[int, Pieces]:
    """Velocity of each rigid body in the frame, m/s, by the number of the body.

    A body that is bonded to a wall has the velocity of the wall. If rigid bodies strike
    at t = 0, or the run ends there, all bodies have their initial velocities during the
    first tick. `end` is the last tick of the run, `lines` are the signals of all lines,
    `frame` is the velocity of the frame, and `contact_events` are the rows of the log
    of contacts.
    """
    is_impact_at_start = (contact_events["impulse"] > 0) & (contact_events["tick"] == 0)
    starts_with_impact = bool(np.any(is_impact_at_start))
    count = len(row.masses)
    masses = {}
    for body, m in enumerate(row.mass_of):
        # m is the number of the mass, or `count` and above for a body that is bonded to
        # a wall, or negative for a rod or a wall.
        if m >= count:
            side = m - count  # 0 for the left wall, 1 for the right wall
            _, wall_velocity = row.boundaries[side]
            on_ground = Pieces.through([0, end], np.full(2, float(wall_velocity)))
            masses[body] = on_ground - frame
        elif m >= 0:
            velocity = lines[state.masses["history_line"][m]]
            if starts_with_impact or end == 0:
                initial = float(row.mass_velocity[m]) - float(row.frame)
                velocity = _with_tick_value(velocity, 0, initial)
            masses[body] = velocity
    return masses


def _with_wall_force(
    outside: BoundaryAction | None, body: Any, contacts: list[ContactSignal | None]
) -> BoundaryAction | None:
    """The action `outside` on an end of the row, at a wall with the force on the wall.

    `body` is the body at this end, and `contacts` are all contacts, in order from this
    end. If the body is a wall, the force of the nearest contact that is not None
    replaces the `push` of `outside`. Contacts that are None are bonds of rigid bodies
    to the wall, which transmit the force of the next contact. If the body is not a
    wall, or all contacts are None, `outside`, which may be None, is returned as it is.
    """
    if outside is None or not isinstance(body, Wall):
        return outside
    for contact in contacts:
        if contact is not None:
            return outside._replace(push=contact.force)
    return outside


def _lines(log: Any, count: int) -> list[Pieces]:
    """Signals of the first `count` lines, [line], from their pieces in the log.

    The signal of a line without pieces is `NOTHING`.
    """
    log = log[np.argsort(log["line"], kind="stable")]  # line by line, in order of time
    # Row at which each line begins, and the end of the last one
    bounds = np.searchsorted(log["line"], np.arange(count + 1))
    lines = []
    for start, stop in pairwise(bounds):
        pieces = log[start:stop]
        line = NOTHING
        if len(pieces):
            coefficients = pieces["coefficients"]
            if not pieces["degree"].any():  # all pieces are constant
                coefficients = coefficients[:, :1]
            line = Pieces(pieces["start"], coefficients, pieces["end"][-1])
        lines.append(line)
    return lines


def _contact(
    link: Any, contact_events: Any, lines: list[Pieces], tick: float
) -> ContactSignal:
    """Force, gap and closing velocity of a link as signals, and its episodes.

    `contact_events` are the rows of the link in the log of contacts, which give the
    episodes. `tick` is the duration of a tick, s. An impact is a force that lasts for
    one tick, with a closing velocity that gives its work. A bond has the gap and the
    closing velocity 0; bonds and joints have no episodes.
    """
    # Lines of the history: force, overlap, closing velocity; see
    # `layout.number_history_lines`.
    history_line = link["history_line"]
    force = lines[history_line]
    if link["law"] < Law.JOINT:  # a bond
        return ContactSignal(force, gap=NOTHING, closing=NOTHING, episodes=())
    gap = lines[history_line + 1].times(-1.0)  # minus the overlap
    if link["law"] == Law.YIELD:
        closing = lines[history_line + 2]
    else:
        closing = _rate(gap, -1.0 / tick)  # m/s: minus the rate of the gap
    impacts = contact_events[contact_events["impulse"] > 0]  # none for other laws
    # An impact takes no time. Its force is put into the tick before it; at t = 0, into
    # the first tick.
    impact_ticks = np.maximum(impacts["tick"] - 1, 0)
    for impact_tick in np.unique(impact_ticks):
        simultaneous = impacts[impact_ticks == impact_tick]
        impulse = simultaneous["impulse"].sum()
        work = (simultaneous["impulse"] * simultaneous["mean_closing"]).sum()
        force = _with_tick_value(force, int(impact_tick), float(impulse) / tick)
        closing = _with_tick_value(closing, int(impact_tick), float(work / impulse))
    if link["law"] < Law.RIGID:  # a joint
        return ContactSignal(force, gap, closing, episodes=())
    episodes = episodes_of(contact_events["tick"], contact_events["status"], tick)
    return ContactSignal(force, gap, closing, episodes)


def _rate(signal: Pieces, factor: float) -> Pieces:
    """Derivative of a signal by ticks, times a factor.

    If all pieces of the signal are constant, it is `NOTHING`: jumps between pieces do
    not count.
    """
    if signal.coefficient_count == 1:  # its pieces are constant
        return NOTHING
    per_tick = 2 * factor / signal.widths  # y runs through 2 in a piece
    slopes = chebder(signal.coefficients, axis=1) * per_tick[:, None]
    return Pieces(signal.ticks, slopes, signal.end)


def _with_tick_value(signal: Pieces, tick: int, value: float) -> Pieces:
    """A signal that has this value from `tick` to tick + 1, and else equals `signal`.

    The argument `signal` is not changed.
    """
    ticks = each_once(signal.ticks, [tick, tick + 1])
    # The last piece begins at tick + 1 or later, and must last at least one tick.
    cut = signal.cut(ticks, max(signal.end, tick + 2))
    index = np.searchsorted(ticks, tick)  # of the piece from `tick` to tick + 1
    cut.coefficients[index] = 0.0
    cut.coefficients[index, 0] = value
    return cut


def _outside(
    row: Row, side: int, lines: list[Pieces], frame: Pieces, state: Any
) -> BoundaryAction | None:
    """Force on an end of the row, and the velocity of this end; None at a free end.

    `side` is 0 for the left end, 1 for the right end. The velocity is relative to the
    ground, m/s. `lines` are the signals of all lines, `frame` is the velocity of the
    frame.
    """
    kind, value = row.boundaries[side]
    if kind == "none":
        return None
    # Index of the outermost node, mass and link at this end
    if side == 0:
        outermost = 0
    else:
        outermost = -1
    node = state.nodes[outermost]
    if kind == "velocity" and isinstance(value, float):  # it is constant
        speed = Pieces([0], [value])
    elif kind == "velocity":
        speed = lines[node["incoming_lines"][side]] + frame
    elif kind == "force" and node["link_count"] > 1:  # the force acts on a rigid mass
        speed = lines[state.masses["history_line"][outermost]] + frame
    else:  # the end of a rod: v is half the sum of the arriving and leaving waves
        inner = 1 - side  # side of the node on which the rod is
        source = node["incoming_lines"][inner]
        arriving = lines[source].delayed(int(state.lines["delay"][source]))
        leaving = lines[node["outgoing_lines"][inner]]
        speed = leaving.times(0.5) + arriving.times(0.5) + frame
    push = lines[state.links["history_line"][outermost]]
    return BoundaryAction(row.boundary_name(side), push, speed)
