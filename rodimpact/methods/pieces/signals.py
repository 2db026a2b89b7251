"""From the log of a run to signals.

They are of waves, contacts, masses, and what acts from outside.
"""

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


def signals_of(row: Row, clock: Clock, end: int, state: Any) -> Signals:
    """Signals of a run: waves, contacts, actions on the ends, and rigid bodies.

    Contacts are those of the user, bonds of rigid bodies among them; what acts on an
    end with a wall is the force of its contact.

    Parameters
    ----------
    row : Row
    clock : Clock
    end : int
        Last tick.
    state : State
        Records of the run, as arrays.
    """
    run = state.runs[0]
    bodies = row.system.bodies
    lines = _lines(state.log[: run["piece_count"]], len(state.lines))
    contact_events = state.contact_log[: run["contact_event_count"]]
    fall = clock.gravity * clock.tick * np.array([0.0, end])
    frame = Pieces.through([0, end], clock.frame + fall)
    masses = _masses(row, end, lines, frame, state, contact_events)
    contacts: list[ContactSignal | None] = []
    for i in row.contact_link:
        if i < 0:  # the contact is a bond of rigid bodies, and no link
            contacts.append(None)
        else:
            of_link = contact_events[contact_events["link"] == i]
            contact = _contact(state.links[i], of_link, lines, clock.tick)
            contacts.append(contact)
    left_end = _outside(row, 0, lines, frame, state)
    right_end = _outside(row, 1, lines, frame, state)
    # Contacts are counted from the end whose wall they touch.
    left = _with_wall_force(left_end, bodies[0], contacts)
    right = _with_wall_force(right_end, bodies[-1], contacts[::-1])
    if left is None:
        push = NOTHING
    else:
        push = left.push
    all_contacts = _with_bonds(row, contacts, masses, clock.tick, push)
    # Segments count from 1 there, and have two lines each.
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
    """Signals of all contacts, also of bonds between rigid bodies.

    Such a bond is no link, and None among `contacts`: its force follows from the forces
    beside it, and from the velocities `masses` of the bodies. It has no gap and no
    episodes. `push` acts on the left end of the row, `tick` is the duration of a tick,
    s.
    """

    def inertia_force(body: int) -> Pieces:
        """Mass times acceleration of a rigid body, N."""
        return _rate(masses[body], float(row.system.bodies[body].mass) / tick)

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
            signals.append(ContactSignal(force, NOTHING, NOTHING, ()))
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

    A body that is bonded to a wall moves with the wall. A blow at t = 0 takes one tick,
    in which bodies keep the velocities before it; so do those of a run that ends at
    t = 0. `contact_events` are the rows of the log of contacts.
    """
    is_blow_at_start = (contact_events["impulse"] > 0) & (contact_events["tick"] == 0)
    starts_with_blow = bool(np.any(is_blow_at_start))
    count = len(row.masses)
    masses = {}
    for body, m in enumerate(row.mass_of):
        if m >= count:  # the body is bonded to a wall
            side = m - count  # 0 for the left wall, 1 for the right one
            speed = float(row.boundaries[side][1])
            masses[body] = Pieces.through([0, end], np.full(2, speed)) - frame
        elif m >= 0:
            velocity = lines[state.masses["history_line"][m]]
            if starts_with_blow or end == 0:
                before = float(row.mass_velocity[m]) - float(row.frame)
                velocity = _with_tick_value(velocity, 0, before)
            masses[body] = velocity
    return masses


def _with_wall_force(
    outside: BoundaryAction | None, body: Any, contacts: list[ContactSignal | None]
) -> BoundaryAction | None:
    """What acts on an end of the row: on a wall the force of the nearest contact.

    `body` stands at this end, and `contacts` begin there. If it is no wall, or all
    contacts are None, `outside` is returned as it is; it may be None, too. Contacts
    that are None are bonds of rigid bodies to the wall, which pass the force of the
    next contact on. The force holds the impulses of blows, too.
    """
    if outside is None or not isinstance(body, Wall):
        return outside
    for contact in contacts:
        if contact is not None:
            return outside._replace(push=contact.force)
    return outside


def _lines(log: Any, count: int) -> list[Pieces]:
    """Signals of the first `count` lines from their pieces in the log.

    A line without pieces has `NOTHING`.
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
    """Force, gap and closing velocity of a link over ticks, and its episodes.

    `contact_events` are its rows in the log of contacts, which bound the episodes,
    `tick` is the duration of a tick, s. Blows, the impacts, are forces of one tick, in
    which the closing velocity is that of their work. Bonds have neither gap nor closing
    velocity, and joints no episodes.
    """
    # What the lines that follow this one keep: see `layout.number_history_lines`.
    history_line = link["history_line"]
    force = lines[history_line]
    if link["law"] < Law.JOINT:  # a bond has no gap
        return ContactSignal(force, NOTHING, NOTHING, ())
    gap = lines[history_line + 1].times(-1.0)  # minus the overlap
    if link["law"] == Law.YIELD:
        closing = lines[history_line + 2]
    else:
        closing = _rate(gap, -1.0 / tick)
    blows = contact_events[contact_events["impulse"] > 0]
    # An impact takes no time; here it takes the tick before it, or the first one.
    blow_ticks = np.maximum(blows["tick"] - 1, 0)
    for blow_tick in np.unique(blow_ticks):
        simultaneous = blows[blow_ticks == blow_tick]
        impulse = simultaneous["impulse"].sum()
        work = (simultaneous["impulse"] * simultaneous["mean_closing"]).sum()
        force = _with_tick_value(force, int(blow_tick), float(impulse) / tick)
        closing = _with_tick_value(closing, int(blow_tick), float(work / impulse))
    if link["law"] < Law.RIGID:  # a joint does not open
        return ContactSignal(force, gap, closing, ())
    episodes = episodes_of(contact_events["tick"], contact_events["status"], tick)
    return ContactSignal(force, gap, closing, episodes)


def _rate(signal: Pieces, factor: float) -> Pieces:
    """Derivative of a signal by ticks times a factor.

    It is `NOTHING` if all pieces of the signal are constant; a jump between two has
    none.
    """
    if signal.coefficient_count == 1:  # its pieces are constant
        return NOTHING
    per_tick = 2 * factor / signal.widths  # y runs through 2 in a piece
    slopes = chebder(signal.coefficients, axis=1) * per_tick[:, None]
    return Pieces(signal.ticks, slopes, signal.end)


def _with_tick_value(signal: Pieces, tick: int, value: float) -> Pieces:
    """The signal with this value from `tick` to the next tick, and else as it was.

    The given signal is not changed.
    """
    ticks = each_once(signal.ticks, [tick, tick + 1])
    # The last piece begins at tick + 1 or later, and must last a tick.
    cut = signal.cut(ticks, max(signal.end, tick + 2))
    here = np.searchsorted(ticks, tick)
    cut.coefficients[here] = 0.0
    cut.coefficients[here, 0] = value
    return cut


def _outside(
    row: Row, side: int, lines: list[Pieces], frame: Pieces, state: Any
) -> BoundaryAction | None:
    """Force on the left (0) or right (1) end of the row, and the velocity of that end.

    The velocity is seen from the ground, m/s. At a free end None is returned. `lines`
    are the signals of all lines, `frame` is the velocity of the frame.
    """
    kind, value = row.boundaries[side]
    if kind == "none":
        return None
    if side == 0:
        outermost = 0  # first one of nodes, masses and links
    else:
        outermost = -1  # last one
    node = state.nodes[outermost]
    if kind == "velocity" and isinstance(value, float):  # it is constant
        speed = Pieces([0], [value])
    elif kind == "velocity":
        speed = lines[node["incoming_lines"][side]] + frame
    elif kind == "force" and node["link_count"] > 1:  # the force acts on a rigid mass
        speed = lines[state.masses["history_line"][outermost]] + frame
    else:  # v of a rod's end is half the sum of the waves that leave and arrive
        inner = 1 - side  # side of the end node on which its rod lies
        source = node["incoming_lines"][inner]
        arriving = lines[source].delayed(int(state.lines["delay"][source]))
        leaving = lines[node["outgoing_lines"][inner]]
        speed = leaving.times(0.5) + arriving.times(0.5) + frame
    push = lines[state.links["history_line"][outermost]]
    return BoundaryAction(row.boundary_name(side), push, speed)
