"""The method of steps: an independent solver for rows of uniform rods, masses and
walls.

No code of the package is used here. A rod is two delay lines. Between two rods stands a
node: a chain of links with masses between them. In the node an ordinary differential
equation holds for the overlaps d of the links and the velocities v of the masses,

    d' = velocity on the left - velocity on the right,
    m v' = force on the left - force on the right,

where the end of a rod moves with its incoming wave minus or plus F/Z. The equation is
solved cell by cell, by collocation at Gauss points, with three rules that make the
solution a reference:

* **Defect.** A cell is accepted if the equation holds at 41 further points, to
  `tolerance` of the velocity scale. So the solution is exact for a system that is
  perturbed by no more than that.
* **Events.** A change of a law (touch, opening, yielding) is found as a root, and ends
  the cell.
* **Breakpoints.** What an event or the start changes at a tick is sent along as a
  breakpoint. No cell of any node reaches across a breakpoint of an incoming wave.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev, legendre

import rodimpact as ri

STAGES = 14  # points of collocation in a cell
GAUSS, WEIGHTS = legendre.leggauss(STAGES)
CHECKS = np.cos(np.pi * np.arange(40, -1, -1) / 40)  # -1 to 1, closer at both ends
PLACES = np.sort(np.concatenate((GAUSS, CHECKS)))
IS_GAUSS = np.isin(PLACES, GAUSS)
FROM_VALUES = np.linalg.inv(chebyshev.chebvander(GAUSS, STAGES - 1))
"""Matrix from values at the Gauss points to Chebyshev coefficients."""
AT_CHECKS = chebyshev.chebvander(CHECKS, STAGES - 1) @ FROM_VALUES
"""Matrix from values at the Gauss points to those at the checks."""
CHECK_SERIES = np.linalg.pinv(chebyshev.chebvander(CHECKS, 2 * STAGES))
"""Matrix from values at the checks to Chebyshev coefficients of twice the degree."""


def evaluate(coefficients, places):
    """Sum of the Chebyshev series at places from -1 to 1: c_k cos(k arccos(y))."""
    angles = np.arccos(np.minimum(1.0, np.maximum(-1.0, places)))
    orders = np.arange(len(coefficients))
    return np.cos(np.multiply.outer(angles, orders)) @ coefficients


def integration_matrix(points):
    """Matrix from values at the Gauss points to integrals from -1 to `points`."""
    columns = []
    for column in FROM_VALUES.T:
        integral = chebyshev.chebint(column, lbnd=-1)
        columns.append(evaluate(integral, points))
    return np.array(columns).T


TO_GAUSS = integration_matrix(GAUSS)
TO_CHECKS = integration_matrix(CHECKS)
TO_END = integration_matrix(np.array([1.0]))

ITERATIONS = 15  # of Newton's method
LAST_CHANGE_RTOL = 3e-14  # change of the rates at which Newton's method ends
SHORTEST_CELL = 2e-14  # over the longest transit time; it is accepted as it is
GUARD_TOLERANCE = 1e-12  # a guard that is less negative than this has not changed sign
MAX_CHANGES = 200  # of laws without progress in time
DIFFERENCE_STEP = 1e-7  # step of differences, relative

OPEN, PRESSED, SLACK, PLASTIC = range(4)
"""States of a link: apart; with its force; overlapping without force, as a dashpot
pulls; crushed further, so that an elastic part of the overlap is counted.
"""


class Cell(NamedTuple):
    """One cell of a line: times in s at which it left, Chebyshev coefficients, and
    whether the wave has a break at its start.
    """

    start: float
    stop: float
    coefficients: np.ndarray
    starts_at_break: bool


class Line:
    """What left one end of a rod, m/s, as cells; it arrives at the other end a transit
    later.
    """

    def __init__(self, transit, value):
        """A line with a transit time, s, whose wave had this constant value, m/s,
        before time 0.
        """
        coefficients = np.zeros(STAGES)
        coefficients[0] = value
        self.transit = transit
        self.cells = [Cell(-transit, 0.0, coefficients, starts_at_break=False)]
        self.reading = 0

    def known_until(self):
        """Time until which the arriving wave is known, s."""
        return self.cells[-1].stop + self.transit

    def move_on(self, time):
        """Skip the cells that have arrived by `time`; the last cell is never skipped."""
        last = len(self.cells) - 1
        sent_at = time - self.transit
        while self.reading < last and self.cells[self.reading].stop <= sent_at:
            self.reading += 1

    def next_break(self, time, end):
        """Arrival of the next breakpoint after `time`, s; `end` if it is not before."""
        for cell in self.cells[self.reading :]:  # in the order of their arrival
            arrival = cell.start + self.transit
            if arrival >= end:
                break
            if cell.starts_at_break and arrival > time:
                return arrival
        return end

    def breaks_at(self, time):
        """Whether the cell that is read has a breakpoint at its start, which arrives
        exactly at `time`.
        """
        cell = self.cells[self.reading]
        return cell.starts_at_break and cell.start + self.transit == time

    def values(self, times):
        """Incoming wave at increasing times, which begin with the cell that is being
        read.
        """
        sent = times - self.transit
        wave = np.empty(len(times))
        begin = 0
        number = self.reading
        while begin < len(times):
            cell = self.cells[number]
            end = len(times)
            if number + 1 < len(self.cells):
                # Times up to the end of the cell; the last cell holds for all later ones.
                end = int(np.searchsorted(sent, cell.stop, "right"))
            if end > begin:
                share = 2 * (sent[begin:end] - cell.start) / (cell.stop - cell.start)
                wave[begin:end] = evaluate(cell.coefficients, share - 1)
                begin = end
            number += 1
        return wave


class Link:
    """One contact: its law, its state, and the totals of its force."""

    def __init__(self, law, gap):
        """An open link with the numbers of its law, 0 or infinite where the law has
        none, and no impulse, peak or times so far (nan).
        """
        self.law = law
        self.kind = type(law).__name__
        self.stiffness = getattr(law, "stiffness", 0.0)
        self.exponent = getattr(law, "exponent", 1.0)
        self.damping = getattr(law, "damping", 0.0)
        self.strength = getattr(law, "yield_force", np.inf)
        self.mobility = 0.0
        self.overlap = -gap
        self.state = OPEN
        self.impulse = 0.0
        self.peak = 0.0
        self.duration = 0.0
        self.first = np.nan
        self.last = np.nan
        self.opening = np.nan
        self.faint = 0.0

    @property
    def rigid(self):
        """Whether the law is rigid contact, with or without restitution."""
        return self.kind == "Rigid"

    def force(self, overlap, closing):
        """Force at an overlap, m, and the closing rate without the own force, m/s.

        With the own force F the rate is `closing` - Y F, Y the mobility: laws with
        damping are
        solved for F: F = (k d + c closing)/(1 + c Y), and F = g (1 + c closing)/(1 + g
        c Y) with g = k d^p.
        """
        if self.state in (OPEN, SLACK):
            return np.zeros_like(overlap)
        if self.rigid:
            return closing / self.mobility
        if self.kind == "SpringDashpot":
            without_own = self.stiffness * overlap + self.damping * closing
            return without_own / (1 + self.damping * self.mobility)
        power = np.sign(overlap) * np.abs(overlap) ** self.exponent
        elastic = self.stiffness * power
        if self.kind != "HuntCrossley":
            return elastic
        without_own = elastic * (1 + self.damping * closing)
        return without_own / (1 + np.abs(elastic) * self.damping * self.mobility)

    def overlap_rate(self, closing, force):
        """Rate of the overlap, m/s, with the own force, N, from the closing rate
        without it: 0 for a rigid contact that presses, and that of the elastic part in
        the plastic state.
        """
        if self.rigid and self.state == PRESSED:
            return np.zeros_like(closing)
        rate = closing - self.mobility * force
        if self.state == PLASTIC:  # the overlap that is counted is the elastic part
            return rate * (self.law.hardening / self.stiffness)
        return rate

    def drive(self, overlap, closing):
        """A dashpot presses where this is positive, of the order of the velocity."""
        if self.kind == "SpringDashpot":
            return self.stiffness * overlap / self.damping + closing
        return 1 / self.damping + closing

    def guards(self, overlap, closing, force, speed, length):
        """Numbers that stay positive while the state lasts, each with the next
        state.
        """
        damped = self.damping > 0
        if self.state == OPEN:
            return [(-overlap / length, PRESSED)]
        if self.rigid:
            return [(force * self.mobility / speed, OPEN)]
        if self.state == PLASTIC:
            return [((closing - self.mobility * force) / speed, PRESSED)]
        left = (overlap / length, OPEN)
        if self.state == SLACK:
            return [left, (-self.drive(overlap, closing) / speed, PRESSED)]
        if damped:
            return [left, (self.drive(overlap, closing) / speed, SLACK)]
        if self.kind == "Yielding":
            return [left, (1 - force / self.strength, PLASTIC)]
        return [left]

    def change_to(self, state, time, force):
        """Change to `state` at `time`, s. The force, N, becomes the strength if the
        link was plastic; on closing and opening the overlap is 0.
        """
        if self.state == PLASTIC:
            self.strength = force
        if state == OPEN:
            self.opening = time
        if OPEN in (state, self.state):
            self.overlap = 0.0
        self.state = state


class Node:
    """A chain of links, with a rod, a mass, a wall or nothing on each side of each."""

    def __init__(self, links, masses, speeds):
        """A node at time 0 between two rods or at an end, with links, masses and speeds
        of its bodies; lines and mobilities are set later.
        """
        self.links = links
        self.masses = masses  # None where the body is no mass
        self.speeds = speeds  # of the bodies: of masses and walls
        self.incoming = [None, None]  # lines from the left and from the right rod
        self.leaving = [None, None]  # lines into these
        self.mobility = [0.0, 0.0]
        self.time = 0.0
        self.length = np.inf
        self.broken = True  # whether a breakpoint is at `time`

    def moving(self):
        """Indices of the bodies of the chain that are masses."""
        return [i for i, mass in enumerate(self.masses) if mass is not None]

    def state(self):
        """Overlaps of the links, then velocities of the masses."""
        overlaps = [link.overlap for link in self.links]
        return np.array(overlaps + [self.speeds[i] for i in self.moving()])

    def unpack(self, states, waves):
        """Closing rates without own forces, and forces of all links, each [time].

        `states` is [time, overlap or velocity], `waves` what comes in from the left and
        from the right.
        """
        count = len(self.links)
        moving = self.moving()
        velocities = []
        for i in range(len(self.masses)):
            if i == 0 and self.incoming[0]:
                velocities.append(waves[0])
            elif i == count and self.incoming[1]:
                velocities.append(waves[1])
            elif i in moving:
                velocities.append(states[:, count + moving.index(i)])
            else:
                velocities.append(np.full(len(states), self.speeds[i]))
        closings = [before - behind for before, behind in pairwise(velocities)]
        forces = []
        for i, link in enumerate(self.links):
            forces.append(link.force(states[:, i], closings[i]))
        return closings, forces

    def rates(self, states, waves):
        """Derivatives of the states by time, [time, overlap or velocity]."""
        closings, forces = self.unpack(states, waves)
        rates_of_state = np.empty_like(states)
        for i, link in enumerate(self.links):
            rates_of_state[:, i] = link.overlap_rate(closings[i], forces[i])
        # The columns of velocities follow those of the overlaps. A mass i is pushed on
        # by the link i - 1 before it, and held up by the link i behind it.
        for column, i in enumerate(self.moving(), len(self.links)):
            before = forces[i - 1] if i > 0 else 0.0
            behind = forces[i] if i < len(forces) else 0.0
            rates_of_state[:, column] = (before - behind) / self.masses[i]
        return rates_of_state


class Totals(NamedTuple):
    """Outcome of a row: m/s by body, and of each contact N s, N and s.

    `faint` is the time for which a contact was closed with a force that moves a rod by
    less than 1e-11 of the velocity scale: the force duration of such a contact is
    ill-conditioned.
    """

    velocities: np.ndarray
    impulses: np.ndarray
    peaks: np.ndarray
    durations: np.ndarray
    firsts: np.ndarray
    lasts: np.ndarray
    openings: np.ndarray
    faint: np.ndarray


class Row:
    """A row on its way; `run` carries it to a time, `totals` says what it came to.

    Parameters
    ----------
    system : rodimpact.System
        Uniform rods that move evenly and may be strained evenly, masses and walls; free
        ends; no gravity. Contacts: `Rigid` beside a rod, `Spring`, `SpringDashpot`,
        `Hertz`, `PowerLaw`, `HuntCrossley`, `Yielding`.
    tolerance : float
        Largest defect, over the velocity scale.
    """

    def __init__(self, system, tolerance=1e-12):
        """Make links and nodes of the system at rest at time 0, and the scales of the
        errors: the longest transit time, the range of initial velocities, and the
        largest mobility.
        """
        self.system = system
        self.tolerance = tolerance
        self.links = []
        for law, gap in zip(system.contacts, system.gaps, strict=True):
            self.links.append(Link(law, float(gap)))
        self._make_nodes()
        transits = [line.transit for line in self.lines]
        self.transit = max(transits)
        speeds = [0.0]
        for line in self.lines:
            speeds.append(line.cells[0].coefficients[0])
        for body in system.bodies:
            if not isinstance(body, ri.Rod):
                speeds.append(body.velocity)
        self.speed = max(speeds) - min(speeds)
        self.mobility = max(max(node.mobility) for node in self.nodes)

    def _make_nodes(self):
        """Make nodes and delay lines of the row, from left to right; the end links of a
        node get the mobility of the rods beside it.
        """
        self.nodes = []
        self.lines = []
        masses = []
        speeds = []
        links = []
        # Lines and mobility of the rod on the left of the node that is being made
        entering = None
        for i, body in enumerate(self.system.bodies):
            if i > 0:
                links.append(self.links[i - 1])
            rod = isinstance(body, ri.Rod)
            masses.append(body.mass if isinstance(body, ri.RigidMass) else None)
            speeds.append(0.0 if rod else body.velocity)
            if rod:
                node = Node(links, masses, speeds)
                self._append_node(node, entering, self._lines_of(body))
                entering = self.lines[-2], self.lines[-1], node.mobility[1]
                masses = [None]
                speeds = [0.0]
                links = []
        self._append_node(Node(links, masses, speeds), entering, None)
        for node in self.nodes:
            if node.links:
                node.links[0].mobility += node.mobility[0]
                node.links[-1].mobility += node.mobility[1]

    def _lines_of(self, rod):
        """Lines of a rod to the right and to the left, and the mobility of its ends,
        m/s/N.
        """
        (segment,) = rod.segments
        speed = segment.material.wave_speed
        transit = segment.length / speed
        impedance = segment.material.density * segment.area * speed
        to_right = Line(transit, rod.velocity - speed * rod.strain)
        to_left = Line(transit, rod.velocity + speed * rod.strain)
        self.lines += [to_right, to_left]
        return to_right, to_left, 1 / impedance

    def _append_node(self, node, before, behind):
        """Append a node between two rods, each given as by `_lines_of`; None where no
        rod is. Waves come to the left side of the node, 0, from the left and leave it
        to the left; at its right side, 1, the reverse.
        """
        if before:
            to_right, to_left, mobility = before
            node.incoming[0] = to_right
            node.leaving[0] = to_left
            node.mobility[0] = mobility
        if behind:
            to_right, to_left, mobility = behind
            node.incoming[1] = to_left
            node.leaving[1] = to_right
            node.mobility[1] = mobility
        self.nodes.append(node)

    def run(self, until):
        """Solve cell by cell until all nodes have reached the time `until`, s; return
        the row.
        """
        while True:
            node = min(self.nodes, key=lambda node: node.time)
            if node.time >= until:
                return self
            self._advance(node, until)

    def _advance(self, node, until):
        """Solve one cell of a node from its time on, up to a breakpoint, the known
        waves or `until`; at an event at its end a link changes its state. The cell is
        made shorter until it is accepted and no guard changes its sign inside.
        """
        start = node.time
        shortest = SHORTEST_CELL * self.transit  # s
        end = until  # the cell may not go beyond it
        breaks = node.broken
        for line in node.incoming:
            if line is None:
                continue
            line.move_on(start)
            end = min(end, line.known_until())
            end = line.next_break(start, end)
            breaks = breaks or line.breaks_at(start)
        stop = start + node.length
        if start + 1.1 * node.length >= end:  # no tiny cell is left over
            stop = end
        changes = 0
        event = None
        while True:
            solved = self._solve(node, start, stop)
            width = stop - start
            if width <= shortest:
                break  # two breakpoints that rounding has parted
            if not solved.accepted:
                stop = start + 0.4 * width  # the next attempt is shorter
                event = None
                continue
            found = self._first_event(node, start, stop, solved)
            if found is None:
                break
            where, link, state = found
            if where <= start + shortest:
                # The law changes at once: the cell is solved again with the new one.
                changes += 1
                assert changes < MAX_CHANGES, "laws change without end"
                forces = solved.forces_at_checks[node.links.index(link)]
                force_at_start = float(forces[0])
                link.change_to(state, start, force_at_start)
                breaks = True
                event = None
                continue
            if event and where >= stop - 1e-14 * self.transit:
                break  # the cell ends at the event
            stop = where
            event = link, state
        self._enter(node, start, stop, solved, breaks)
        node.broken = False
        if event:
            link, state = event
            forces = solved.forces_at_checks[node.links.index(link)]
            force_at_stop = float(forces[-1])
            link.change_to(state, stop, force_at_stop)
            node.broken = True
        growth = 1.3  # of the length, from this cell to the next
        if solved.defect < 0.02 * self.tolerance * self.speed:
            growth = 3.0  # the defect is far below what is accepted
        next_length = growth * (stop - start)
        if stop == end:  # a breakpoint cut this cell short
            next_length = max(node.length, next_length)
        node.length = next_length

    def _solve(self, node, start, stop):
        """Solve one cell of a node: `Solved`, whether it is accepted or not."""
        half = 0.5 * (stop - start)
        times = start + half * (1 + PLACES)
        at_gauss = [None, None]
        at_checks = [None, None]
        for side, line in enumerate(node.incoming):
            if line:
                values = line.values(times)
                at_gauss[side] = values[IS_GAUSS]
                at_checks[side] = values[~IS_GAUSS]
        first = node.state()
        rates, converged = self._collocate(node, first, half, at_gauss)
        states = first + half * (TO_CHECKS @ rates)
        states_at_gauss = first + half * (TO_GAUSS @ rates)
        closings, forces = node.unpack(states, at_checks)
        _, forces_at_gauss = node.unpack(states_at_gauss, at_gauss)

        # Rates, forces and waves at the checks, beside their polynomials there
        defect = 0.0
        if len(first):
            wanted = node.rates(states, at_checks)
            defect = float(np.abs(wanted - AT_CHECKS @ rates).max())
        for force, values in zip(forces, forces_at_gauss, strict=True):
            missed = float(np.abs(force - AT_CHECKS @ values).max())
            defect = max(defect, missed * self.mobility)
        for values, values_at_checks in zip(at_gauss, at_checks, strict=True):
            if values is not None:
                missed = float(np.abs(values_at_checks - AT_CHECKS @ values).max())
                defect = max(defect, missed)
        is_small = defect <= self.tolerance * self.speed
        states_at_end = first + half * (TO_END @ rates)
        return Solved(
            accepted=converged and is_small,
            defect=defect,
            waves=at_gauss,
            forces=forces_at_gauss,
            states_at_checks=states,
            closings_at_checks=closings,
            forces_at_checks=forces,
            last=states_at_end[0],
        )

    def _collocate(self, node, first, half, waves):
        """Rates at the Gauss points [point, state] by Newton's method, and whether it
        converged. The Jacobian is made of differences.
        """
        size = len(first)
        rates = np.zeros((STAGES, size))
        if not size:
            return rates, True
        rates[:] = node.rates(np.tile(first, (STAGES, 1)), waves)
        for _ in range(ITERATIONS):
            states = first + half * (TO_GAUSS @ rates)
            here = node.rates(states, waves)
            jacobian = np.zeros((STAGES, size, STAGES, size))
            for column in range(size):
                scale = max(np.abs(states[:, column]).max(), half * self.speed)
                step = DIFFERENCE_STEP * scale
                moved = states.copy()
                moved[:, column] += step
                slope = (node.rates(moved, waves) - here) / step
                jacobian[:, :, :, column] -= (
                    half * slope[:, :, None] * TO_GAUSS[:, None, :]
                )
            matrix = jacobian.reshape(STAGES * size, STAGES * size)
            matrix += np.eye(STAGES * size)
            change = np.linalg.solve(matrix, (here - rates).ravel())
            rates += change.reshape(rates.shape)
            largest = max(np.abs(rates).max(), self.speed)
            if np.abs(change).max() <= LAST_CHANGE_RTOL * largest:
                return rates, True
        return rates, bool(np.abs(change).max() <= 1e-13 * largest)

    def _first_event(self, node, start, stop, solved):
        """Time, link and next state of the first guard that changes its sign; None if
        none.
        """
        first = None
        half = 0.5 * (stop - start)
        length = self.speed * self.transit
        for i, link in enumerate(node.links):
            guards = link.guards(
                solved.states_at_checks[:, i],
                solved.closings_at_checks[i],
                solved.forces_at_checks[i],
                self.speed,
                length,
            )
            for values, state in guards:
                tolerance = GUARD_TOLERANCE
                if link.state == OPEN and starts_softly(values):
                    tolerance = 0.0
                negative = np.flatnonzero(values < -tolerance)
                if not len(negative):
                    continue
                first_negative = negative[0]  # index of a check point
                values_before = values[:first_negative]
                positive = np.flatnonzero(values_before > GUARD_TOLERANCE)
                where = start
                if len(positive):
                    last_positive = positive[-1]
                    zero = root(values, last_positive, first_negative)  # in -1 to 1
                    where = start + half * (1 + zero)
                if first is None or where < first[0]:
                    first = where, link, state
        return first

    def _enter(self, node, start, stop, solved, breaks):
        """Enter a solved cell from `start` to `stop`: append the leaving waves to their
        lines, update overlaps, impulses, peaks and durations of the links and speeds of
        the masses, and put the node at `stop`. `breaks`: whether the waves have a break
        at `start`.
        """
        half = 0.5 * (stop - start)
        for side in (0, 1):
            if not node.leaving[side]:
                continue
            values = solved.waves[side]
            if node.links:
                # The end moves with the wave, -F/Z on the left and F/Z on the right;
                # what leaves differs twice as much.
                force = solved.forces[-side]  # of the first link, or of the last
                direction = 2 * side - 1
                values = values + 2 * direction * node.mobility[side] * force
            cell = Cell(start, stop, FROM_VALUES @ values, breaks)
            node.leaving[side].cells.append(cell)
        for i, link in enumerate(node.links):
            link.overlap = float(solved.last[i])
            link.impulse += half * float(WEIGHTS @ solved.forces[i])
            largest = float(solved.forces_at_checks[i].max())
            resolved = stop - start > 2 * SHORTEST_CELL * self.transit
            if resolved and largest > 0.99 * link.peak:  # between checks it is larger
                largest_of_cell = maximum(solved.forces[i])
                link.peak = max(link.peak, largest_of_cell)
            pressed = link.state in (PRESSED, PLASTIC)
            if link.rigid:  # it may be closed without force
                pressed = pressed and largest * self.mobility > 1e-12 * self.speed
            if pressed and largest * self.mobility < 1e-11 * self.speed:
                link.faint += stop - start
            if pressed:
                link.duration += stop - start
                link.last = stop
                if np.isnan(link.first):
                    link.first = start
        for column, i in enumerate(node.moving(), len(node.links)):
            node.speeds[i] = float(solved.last[column])
        node.time = stop

    def totals(self):
        """Outcome so far: `Totals`. Rods have the velocities of their momenta."""
        impulses = [link.impulse for link in self.links]
        pushes = [0.0, *impulses, 0.0]  # on the left of each body, and of the last
        velocities = []
        for i, body in enumerate(self.system.bodies):
            gained = 0.0
            if not isinstance(body, ri.Wall):
                gained = (pushes[i] - pushes[i + 1]) / body.mass
            velocities.append(body.velocity + gained)
        columns = [velocities, impulses]
        for name in ("peak", "duration", "first", "last", "opening", "faint"):
            columns.append([getattr(link, name) for link in self.links])
        return Totals(*map(np.array, columns))


class Solved(NamedTuple):
    """A cell that is solved; it is accepted if its defect is small."""

    accepted: bool
    defect: float
    waves: list
    forces: list
    states_at_checks: np.ndarray
    closings_at_checks: list
    forces_at_checks: list
    last: np.ndarray


def starts_softly(values):
    """Whether a gap that is closed starts to close further, like a power of time.

    It has closed at the start of the cell, though its overlap exceeds round-off only
    later.
    """
    closed = abs(values[0]) < 1e-18
    return bool(closed and np.all(values[5:] < 0) and values[-1] < -1e-17)


def root(values, low, high):
    """Zero of the polynomial through the values at the check points, between two of
    these.
    """
    coefficients = CHECK_SERIES @ values
    left = CHECKS[low]
    right = CHECKS[high]
    for _ in range(60):
        middle = 0.5 * (left + right)
        if evaluate(coefficients, middle) > 0:
            left = middle
        else:
            right = middle
    return right


def maximum(values):
    """Largest value, on a cell, of the polynomial with these values at the Gauss
    points.
    """
    coefficients = FROM_VALUES @ values
    places = np.linspace(-1, 1, 400)
    # A search by thirds between both neighbours of the best of 400 points
    best = int(np.argmax(evaluate(coefficients, places)))
    low = places[max(best - 1, 0)]
    high = places[min(best + 1, 399)]
    for _ in range(50):
        third = (high - low) / 3
        ends = evaluate(coefficients, np.array([low + third, high - third]))
        if ends[0] < ends[1]:
            low += third
        else:
            high -= third
    return float(evaluate(coefficients, np.array([low, high])).max())


def solve_by_steps(system, until, tolerance=1e-12):
    """Outcome of a row at `until`, s, by the method of steps: `Totals`."""
    return Row(system, tolerance).run(until).totals()
