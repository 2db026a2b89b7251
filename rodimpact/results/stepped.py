"""From a run on a time step to what a solution holds: contact signals, tallies, outcome."""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np

from ..methods.contact_law_kernel import RIGID
from ..methods.grid.method import GridRun
from ..methods.refinement import peak
from ..methods.steps.method import StepRun
from ..model import Bonded, RigidMass, Wall
from .contacts import ContactTally, pressed_spans
from .energy import ledger
from .fields import Fields
from .groups import group_states, groups, velocities_in_group
from .outcome import Totals
from .records import StepRecord
from .signals import Floats

Run: TypeAlias = StepRun | GridRun

KINDS = {"velocity": "drive", "force": "drive", "absorbing": "absorbing"}


def read_record(run: Run) -> StepRecord:
    """Signals of the contacts, and of what is outside."""
    plan, forces, gaps, paths = run.plan, [], [], []
    for k, link in enumerate(plan.contact_link):
        if link >= 0 and plan.laws[link] >= RIGID:
            force, gap = run.contact(k)
            forces.append(force)
            gaps.append(np.concatenate(([float(plan.system.gaps[k])], gap)))
            paths.append(run.path(k))
        else:
            forces.append(run.bond(k) if link >= 0 else np.full(run.steps, math.nan))
            gaps.append(np.zeros(run.steps + 1))
            paths.append(np.zeros(run.steps))
    ends: list[tuple[str, Floats, Floats] | None] = []
    for side, (kind, _) in enumerate(plan.outside):
        if kind == "none":
            ends.append(None)
            continue
        wall = isinstance(plan.system.bodies[-side], Wall)
        ends.append(("wall" if wall else KINDS[kind], *run.outer(side)))
    _join_rigid_bodies(run, forces, [end[1] if end else np.zeros(run.steps) for end in ends])
    return StepRecord(run.edges, forces, gaps, paths, ends, run.resolved)


def _join_rigid_bodies(run: Run, forces: list[Floats], pushes: list[Floats]) -> None:
    """Fill in the forces between bonded rigid bodies, from Newton's law for one after the other.

    `pushes` act on the two ends of the row, to the inside.
    """
    bodies, rigid = run.plan.system.bodies, [i < 0 for i in run.plan.contact_link]

    def spent(body: int) -> Floats:
        mass = bodies[body]
        assert isinstance(mass, RigidMass)
        gained: Floats = float(mass.mass) * np.diff(run.speed(run.plan.mass_of[body]))
        return gained / run.durations

    held = rigid.index(False) if isinstance(bodies[0], Wall) and False in rigid else 0
    for k in range(held - 1, -1, -1):
        forces[k] = forces[k + 1] + spent(k + 1)
    for k in range(held, len(forces)):
        if rigid[k]:
            forces[k] = (forces[k - 1] if k else pushes[0]) - spent(k)


def _tallies(run: Run, record: StepRecord) -> tuple[ContactTally, ...]:
    """Totals of every contact in SI units."""
    found, t, times = [], run.tally, run.edges * run.clockwork.tick
    for k, force in enumerate(record.forces):
        law = run.plan.system.contacts[k]
        if isinstance(law, Bonded):
            impulse = float(force @ run.durations)
            found.append(ContactTally(impulse, float(np.max(force, initial=0.0)), 0.0,
                                      math.nan, math.nan, 0))
            continue
        link, spans = run.place(k), pressed_spans(times, force, record.gaps[k])
        begins, ends = np.array(spans).reshape(-1, 2).T
        ends = np.nan_to_num(ends, nan=float(times[-1]))
        sudden = getattr(law, "restitution", None) is not None
        if sudden:  # an impact takes no time, though it takes a step here
            ends = np.where(ends - begins <= run.step * (1 + 1e-9), begins, ends)
        found.append(ContactTally(
            impulse=float(t.impulse[link]) * run.step,
            peak_force=math.nan if sudden else peak(run.edges, force),
            duration=float(np.sum(ends - begins)),
            first=float(begins[0]) if spans else math.nan,
            last=float(ends[-1]) if spans else math.nan,
            episodes=int(t.episodes[link]),
        ))
    return tuple(found)


def totals_of_steps(run: Run, fields: Fields, record: StepRecord) -> Totals:
    """Read the totals off a finished run on a time step."""
    system, plan, a = run.plan.system, run.plan, run.clockwork
    count = len(system.bodies)
    end = float(run.edges[-1]) * a.tick
    tallies = _tallies(run, record)
    contacts = record.histories(fields, tallies)
    states = group_states(system, fields, np.unique(run.edges[[0, -1]]))
    book = ledger(fields, contacts, record.outside(fields, contacts), states)
    masses = [a.mass(i) for i in range(count)]
    velocity, vibration = np.zeros((2, count)), (states.moving + states.strained).T
    own = {inside[0]: v for inside, v in zip(states.bodies, states.velocity, strict=True)}
    for group in groups(system):
        inside = next((x for x in states.bodies if x[0] in group), [])
        mean = own[inside[0]] if inside else np.zeros(1)
        for place in (0, -1):
            velocity[place, group] = velocities_in_group(system, group, inside, mean[place])
    impulse = sum(
        sign * float(side[1] @ run.durations)
        for side, sign in zip(record.ends, (1, -1), strict=True) if side is not None
    )
    total = float(states.mass.sum())
    gained = float(states.momentum[-1] - states.momentum[0])
    missing = gained - impulse - total * plan.gravity * end
    pushed = sum(abs(tally.impulse) for tally in tallies if tally.impulse == tally.impulse)
    absolute = total * plan.scale + pushed
    energy = book.total
    turnover = float(energy[0]) + abs(float(book.gravity_work[-1])) + sum(
        abs(float(x[-1])) for x in (book.wall_work, book.drive_work, book.radiated)
    ) + total * plan.scale**2 / 2
    works = ("wall_work", "drive_work", "gravity_work", "radiated", "dissipated", "damped",
             "numerical")
    return Totals(
        masses=masses, velocities=(velocity[0].tolist(), velocity[-1].tolist()),
        kinetic=(float(book.kinetic[0]), float(book.kinetic[-1])),
        vibration=(vibration[0].tolist(), vibration[-1].tolist()), contacts=tallies,
        momentum=(missing, absolute), energy=(float(book.residual[-1]), turnover),
        works={"contact_energy": float(book.contact[-1]),
               **{name: float(getattr(book, name)[-1]) for name in works}},
    )
