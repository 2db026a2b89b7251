"""The method "characteristics": end signals as averages over a common time step.

It carries what piecewise constant fronts cannot: rigid masses, compliant contacts, gravity, driven
ends and smooth initial states. The row is laid out once; the step is chosen so that transit times
are whole numbers of steps where they can be, and divided until the outcome stands still. Steps are
cut where contacts close, which a run finds one after the other and begins anew for each.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from ...model import Rod, Steps
from ...model.frozen import InvalidModel
from .. import abilities as physics
from .. import kernels
from ..clock import STEP_TICKS, Clock
from ..contact_law_kernel import IMPACT, RIGID, SPRING
from ..finality_kernel import NEVER
from ..groups import groups
from ..refinement import contact_measures, refined, velocity_measure
from ..row import Array, Row
from ..run import Run, Waves
from ..signals import StepSignal
from ..stepped import StepRecord, as_run
from ..stepped_run import SteppedRun, clock_of_steps
from .delays import WHOLE, arriving, lost_to_means, transit_ticks
from .machine import Machine, check_memory
from .step_kernel import CUTS, LINK, State, choose_step, inside

RTOL = 1e-5
FIRST = 64  # fewest steps of the longest transit
FINEST = 1 << 14  # most steps of the longest transit in the search for an accurate step
ROUGHEST = 1 << 12  # the same where contacts close and open between steps, of which order 1 is left
CHOICE_TIME = 1e-7  # s, about what plain Python takes for a transit and a number of steps
SHORTEST = 4  # fewest steps of the shortest transit
MOST_STEPS = 1 << 16  # of the longest transit, that the shortest may ask for
MOST_CUTS = 24  # of a step, where contacts close
MOST_SEARCHED = 10_000  # steps of the longest transit, among which all transits may be whole
MOMENT = STEP_TICKS >> 21  # ticks before and after an impact
SAME = 1 / 16  # steps: a contact that closes so near to where it did was placed badly before


class Closing(NamedTuple):
    """A contact that closes, and whose force begins with a jump: time, s, and its link."""

    time: float
    link: int

    def places(self, row: Row, step: float) -> list[float]:
        """Ticks at which steps are cut: where the force begins, or around the moment of an impact.

        The bodies of an impact change their velocity in the middle of a part, so that is short.
        """
        tick = self.time / step * STEP_TICKS
        return [tick - MOMENT, tick + MOMENT] if row.laws[self.link] == IMPACT else [tick]


@dataclass(frozen=True, kw_only=True)
class StepRun(SteppedRun):
    """A finished run of this method.

    Attributes
    ----------
    edges_before : array of int
        As `edges`, before t = 0.
    state : State
        The kernel's, at the end, on arrays.
    closings : list of Closing or None
        Where contacts close and steps are cut; None where they are not.
    """

    edges_before: Array
    state: State
    closings: list[Closing] | None = None

    def before(self, line: int) -> int:
        """How many averages a line has from before t = 0."""
        return inside(self.state, line // 2)

    def wave(self, line: int) -> Array:
        """What left an end in each step, those before t = 0 first, in the falling frame."""
        start = int(self.signals.wave_start[line])
        return np.asarray(self.signals.wave[start - self.before(line) : start + self.steps])

    def arriving(self, line: int) -> Array:
        """What arrived at the other end in each step, in the falling frame."""
        return arriving(self.wave(line), self.clock.ticks[line // 2], np.diff(self.edges))

    @property
    def free_velocities(self) -> list[float]:
        """At the end, of the centres of mass of groups of bonded bodies that nothing holds, m/s."""
        a, row = self.clock, self.row
        free: list[float] = []
        fall = row.frame + row.gravity * a.tick * float(self.edges[-1])
        edges = np.concatenate((self.edges_before, self.edges))
        bonded = groups(row.system)
        for group in bonded:
            mass = momentum = 0.0
            for body in group:
                for s in range(row.spans[body][0], row.spans[body][1] + 1):
                    start = self.edges[-1] - a.ticks[s]
                    for wave in (self.wave(2 * s), self.wave(2 * s + 1)):
                        stays = np.diff(np.maximum(edges[-1 - len(wave) :], start))
                        momentum += a.impedance[s] / 2 * float(wave @ stays) * a.tick
                    mass += a.impedance[s] * a.ticks[s] * a.tick
                m = row.mass_of[body]
                if 0 <= m < len(row.masses) and (body == 0 or row.mass_of[body - 1] != m):
                    mass += row.masses[m]
                    momentum += row.masses[m] * float(self.speed(m)[-1])
            held = any(
                kind in ("velocity", "absorbing") and group is end
                for (kind, _), end in zip(row.outside, (bonded[0], bonded[-1]), strict=True)
            )
            if mass and not held:
                free.append(float(momentum / mass + fall))
        return free

    @property
    def energy_lost(self) -> float:
        """Energy lost to the time step, of that which was there or was turned over."""
        a, lasts = self.clock, np.diff(self.edges)
        lost = float(np.sum(self.tally.numerical)) * self.step
        there = sum(M * v * v for M, v in zip(
            self.row.masses, np.array(self.row.mass_velocity) - self.row.frame, strict=True)) / 2
        for line in range(2, 2 * len(a.ticks) - 2):
            s, wave = line // 2, self.wave(line)
            lost += a.impedance[s] * a.tick * float(np.sum(lost_to_means(wave, a.ticks[s], lasts)))
            before = np.maximum(np.append(self.edges_before[-self.before(line) :], 0), -a.ticks[s])
            there += a.impedance[s] * a.tick / 4 * float(
                np.diff(before) @ wave[: self.before(line)] ** 2)
        return lost / there if there > 0 else 0.0

    @property
    def largest_strain(self) -> float:
        """Bound of the strains."""
        waves = [np.abs(self.wave(line)).max(initial=0.0) / self.clock.wave_speed[line // 2]
                 for line in range(2, 2 * len(self.state.steps) - 2)]
        return float(max(waves))

    def place(self, contact: int) -> int:
        """Place in the tally of a contact that can open."""
        return self.row.contact_link[contact]

    def path(self, contact: int) -> Array:
        """How far a contact that can open closes in each step, m."""
        _, gap = self.contact(contact)
        return np.asarray(-np.diff(gap, prepend=float(self.row.system.gaps[contact])))

    def bond(self, contact: int) -> Array:
        """Mean force in a bonded contact in each step, N, from the waves of a rod that it joins."""
        for body, side in ((contact, 1), (contact + 1, 0)):
            first, last = self.row.spans[body]
            if last:
                s, out = (last, 2 * last + 1) if side else (first, 2 * first)
                outgoing = self.wave(out)[self.before(out) :]
                incoming = self.arriving(out ^ 1)
                force: Array = (incoming - outgoing) / (2 * self.state.mobility[s])
                return force if side else -force
        raise ValueError(f"contact {contact} joins no rod")

    def outer(self, side: int) -> tuple[Array, Array]:
        """Force of what is outside the left or right end on the row, and its velocity, by steps.

        N and m/s, in the laboratory; positive to the inside, and to the right.
        """
        row, n = self.row, len(self.state.steps) - 2
        kind, link = row.outside[side][0], (0, len(row.laws) - 1)[side]
        s, out = (1, 2) if side == 0 else (n, 2 * n + 1)
        outgoing, incoming = self.wave(out)[self.before(out) :], self.arriving(out ^ 1)
        line = self.signals.wave_start[(2 * n + 3) * side]
        imposed = self.by_step(self.signals.wave, line)
        if row.laws[link] >= RIGID:
            force, v = self.by_link(self.signals.force, link), imposed
        elif kind == "force" and row.first[1 + side * n] > row.first[side * n]:
            speed = self.speed(0 if side == 0 else len(row.masses) - 1)
            force, v = imposed, (speed[1:] + speed[:-1]) / 2
        else:
            force = (1, -1)[side] * (outgoing - incoming) / (2 * self.state.mobility[s])
            v = (outgoing + incoming) / 2
        value = row.outside[side][1]
        if kind == "velocity" and isinstance(value, float):
            return force, np.full(self.steps, value)
        middles = (self.edges[1:] + self.edges[:-1]) / 2 * self.clock.tick
        return force, v + row.frame + row.gravity * middles

    def speed(self, mass: int) -> Array:
        """Velocity of a mass at `edges`, in the frame."""
        side = mass - len(self.row.masses)
        if side >= 0:
            return self.row.wall_speed(side, self.edges * self.clock.tick)
        initial = self.row.mass_velocity[mass] - self.row.frame
        later = self.by_step(self.signals.speed, self.signals.mass_start[mass])
        return np.concatenate(([initial], later))


LACKS = (physics.damping, physics.lateral, physics.taper)


def solve(row: Row, until: float | None, max_events: int, **options: Any) -> Run:
    """Run a single collision; arguments as of `follow`."""
    return hand_over(follow(row, until, max_events, **options), until)


def hand_over(run: StepRun, until: float | None) -> Run:
    """What every method hands back, of a run to `until`."""
    def waves(_: StepRecord) -> Waves:
        ticks = np.concatenate((run.edges_before, run.edges[:-1]))
        lines = [run.wave(line) for line in range(2, 2 * len(run.state.steps) - 2)]
        left = [StepSignal(ticks[len(ticks) - len(values) :], values) for values in lines]
        return Waves([None, None, *left])

    return as_run(run, "characteristics", until, waves, finer="a smaller dt")


def follow(
    row: Row, until: float | None, max_events: int, dt: float | None, rtol: float | None
) -> StepRun:
    """Run a single collision.

    Parameters
    ----------
    row : Row
        Of a single system.
    until : float, optional
        s; by default the run ends a round trip of the longest rod after the proof of finality.
    max_events : int
        Cap on steps times ends, where no end is given.
    dt : float, optional
        Step, s; chosen if not given.
    rtol : float, optional
        Relative accuracy to which the step is halved.

    Raises
    ------
    TooLong
        If the run takes too much memory.
    """
    row.check_scales()
    transits = [float(s.transit_time) for s in row.segments]
    if dt is not None and dt > min(transits) * (1 + 2.0**-36):
        path = row.paths[1 + transits.index(min(transits))]
        message = f"must not exceed the shortest transit time, {min(transits):.6g} s of {path}"
        raise InvalidModel([("dt", f"{message}, got {dt!r}")])
    if dt is not None:
        return _level(row, dt, until, max_events, [])
    goal = RTOL if rtol is None else rtol
    least = max(FIRST, math.ceil(SHORTEST * max(transits) / min(transits)),
                math.ceil(max(transits) / _resolving(row)))
    if least > MOST_STEPS:
        short = min(range(len(transits)), key=transits.__getitem__)
        message = (
            f"its transit time or that of a contact is so short beside the longest, "
            f"{max(transits):.3g} s, that this would take {least:.3g} steps; leave it out, soften "
            "the contact of a mass, or give the step dt"
        )
        raise InvalidModel([(row.paths[short + 1], message)])
    number, smear = _choose(transits, least, max(MOST_SEARCHED, 2 * least), 0.0)
    fits = smear <= WHOLE / STEP_TICKS
    abrupt = begins_with_jumps(row)

    closings: list[Closing] | None = [] if fits and abrupt else None

    def level(factor: int) -> StepRun:
        nonlocal closings
        steps = factor * number
        if not fits:  # another share of a step on every level
            low = factor * least
            steps, _ = _choose(transits, low, 4 * low // 3 - 1, float(abrupt))
        run = _level(row, max(transits) / steps, until, max_events, closings)
        closings = run.closings
        return run

    first = number if fits else least
    finest = FINEST if fits or not abrupt else ROUGHEST
    run, estimates = refined(level, measures, goal, 2 * finest // first, _energy_error)
    return replace(run, estimates=estimates, rtol=goal)


def measures(run: StepRun) -> dict[str, Array]:
    """What is to stand still: velocities, and what the contacts did."""
    velocity = velocity_measure(run.free_velocities, run.row.scale)
    return {"velocity": velocity, **contact_measures(run)}


def begins_with_jumps(row: Row) -> bool:
    """Whether a contact is rigid, an impact or a dashpot, so that its force begins with a jump."""
    return any(
        RIGID <= law <= IMPACT or (law == SPRING and damping > 0)
        for law, damping in zip(row.laws, row.damping, strict=True)
    )


def _energy_error(run: StepRun) -> dict[str, float]:
    """Share of the energy that jumps inside steps lose: so much may be missing elsewhere."""
    return {"energy": run.energy_lost} if RIGID in run.row.laws else {}


def _choose(transits: list[float], least: int, most: int, power: float) -> tuple[int, float]:
    """Let `choose_step` choose."""
    choose: Callable[..., Any] = choose_step
    if kernels.worth_compiling((most - least) * len(transits) * CHOICE_TIME, choose_step):
        choose = kernels.compiled(choose_step)
    times: Any = transits if choose is choose_step else np.array(transits)
    number, smear = choose(times, least, most, WHOLE / STEP_TICKS, power)
    return int(number), float(smear)


def _resolving(row: Row) -> float:
    """Step that resolves the contact of a mass with a stiff neighbour: a twentieth of its time."""
    finest, v = math.inf, 2 * row.scale or 1.0
    for i, sides in enumerate(row.beside):
        around = [row.masses[m] for kind, m in sides if kind == "mass"]
        if around and row.laws[i] >= SPRING:
            m, stiff, power = 1 / sum(1 / M for M in around), row.stiffness[i], row.exponent[i] + 1
            if power == 2:
                finest = min(finest, math.pi * math.sqrt(m / stiff) / 20)
            else:
                deepest = (power / 2 * m * v * v / stiff) ** (1 / power)
                finest = min(finest, 2.9432 * deepest / v / 20)
    longest = max(float(s.transit_time) for s in row.segments)
    return max(finest, longest / FINEST * 4)


def _level(
    row: Row, step: float, until: float | None, max_events: int, closings: list[Closing] | None
) -> StepRun:
    """One run with a given step, which is cut where contacts close whose force begins with a jump.

    `closings` are those known of a run with another step; None if there are more than steps are cut
    for. The run has its own.
    """
    check_memory(row, step, until or 0.0, 1)
    ticks = transit_ticks(row, step)
    if closings is None or not begins_with_jumps(row) or any(T % STEP_TICKS for T in ticks):
        run = attempt(row, ticks, step, [], until, max_events, may_cut=False)
        assert isinstance(run, StepRun)
        return run
    jumps = given_jumps(row, ticks, step)
    for _ in range(MOST_CUTS):
        cuts = places_inside([*jumps, *(x for c in closings for x in c.places(row, step))])
        new = attempt(row, ticks, step, cuts, until, max_events, may_cut=True)
        if isinstance(new, StepRun):
            return replace(new, closings=closings)
        closings = [
            x for x in closings if x.link != new.link or abs(x.time - new.time) > SAME * step
        ] + [new]
        if len(closings) > MOST_CUTS:
            break
    return _level(row, step, until, max_events, None)


def places_inside(ticks: Iterable[float]) -> list[int]:
    """Places of ticks in their steps, in order, without those at the ends and beside others."""
    inside_step = sorted({round(x) % STEP_TICKS for x in ticks})
    return [x for before, x in pairwise([0, *inside_step])
            if x - before > WHOLE and STEP_TICKS - x > WHOLE]


def given_jumps(row: Row, ticks: list[int], step: float) -> list[int]:
    """Ticks in a step at which jumps of the initial state and of drives pass the ends of segments.

    None of them where there are more than a step is cut for.
    """
    jumps: list[float] = []
    for body, (first, last) in zip(row.system.bodies, row.spans, strict=True):
        profiles = (body.velocity, body.strain) if isinstance(body, Rod) else ()
        at = [float(x) for p in profiles if isinstance(p, Steps) for x in p.at]
        left = 0.0
        for s in range(first, last + 1):
            L = float(row.segments[s - 1].length)
            away = [(x - left) / L * ticks[s - 1] for x in at if left < x < left + L]
            jumps += [*away, *(-x for x in away)]
            left += L
    for _, value in row.outside:
        if isinstance(value, Steps):
            jumps += [float(t) / step * STEP_TICKS for t in value.at]
    if any(law == IMPACT and gap == 0 for law, gap in zip(row.laws, row.gap, strict=True)):
        jumps.append(MOMENT)
    places = places_inside(jumps)
    return places if len(places) <= MOST_CUTS else []


def attempt(
    row: Row, ticks: list[int], step: float, cuts: list[int], until: float | None,
    max_events: int, may_cut: bool,
) -> StepRun | Closing:
    """One run with given cuts, or the first closing inside a part of a step."""
    parts, nodes = len(cuts) + 1, len(ticks) + 1
    check_memory(row, step, until or 0.0, parts)
    longest = max(
        math.ceil(sum(ticks[first - 1 : last]) / STEP_TICKS) for first, last in row.spans
    ) * parts
    proof, reason, going = -1, "until", True
    cap = max(1, max_events // nodes)
    end = None if until is None else round(until / step * STEP_TICKS)
    room = 8 * longest if end is None else max(1, -(-end // STEP_TICKS)) * parts
    machine = Machine(row, ticks, step, room, cuts)
    machine.clock[CUTS] = may_cut
    if end is not None:
        first = np.searchsorted(machine.places, end % STEP_TICKS, "right") - 1
        going = machine.advance(end // STEP_TICKS * parts + int(first))
        if going and machine.finality_time() == 0:
            proof = machine.taken
        going = going and machine.finish(end)
    else:
        while going and proof < 0 and machine.taken < cap:
            wait = machine.finality_time()
            if wait == 0:
                proof = machine.taken
            else:
                # an eighth more each time, so that proofs and copies cost no more than the run
                pause = min(wait, 8 * longest) if wait < NEVER else longest
                more = max(longest, pause, machine.taken // 8)
                going = machine.advance(min(cap, machine.taken + more))
        reason = "final" if proof >= 0 else "max_events"
        if proof >= 0:
            going = machine.advance(machine.taken + 2 * longest)
    if not going:
        when = machine.taken // parts + float(machine.state.closed[0])
        return Closing(when * step, int(machine.clock[LINK]))
    edges = machine.edges(0, machine.taken)
    if end is not None:
        edges[-1] = end
    earliest = -max(inside(machine.state, s + 1) for s in range(len(ticks)))
    return StepRun(
        clock=_clock(row, ticks, step), row=row, step=step, edges=edges, end=int(edges[-1]),
        events=machine.taken * nodes, tally=machine.tally, signals=machine.signals,
        finality_time=proof, stopped_by=reason, edges_before=machine.edges(earliest, -1),
        state=machine.state,
    )


def _clock(row: Row, ticks: list[int], step: float) -> Clock:
    """Clock of a row whose segments have transit times of so many ticks."""
    errors = [abs(T * (step / STEP_TICKS) / float(s.transit_time) - 1)
              for T, s in zip(ticks, row.segments, strict=True)]
    worst = max(range(len(errors)), key=errors.__getitem__)
    return clock_of_steps(
        row, ticks, step, [float(s.impedance) for s in row.segments],
        transit_error=errors[worst], worst=row.paths[worst + 1],
    )
