"""A row, or a family of them, as numbers for the kernels of this method, and their work space."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from ...model import Rod, Samples, Steps
from ...model.frozen import Number
from ..abilities import driven
from ..contact_law_kernel import BOND, IMPACT, JOINT, RIGID, SPRING, Chain, Tally
from ..groups import groups
from ..memory import ask
from ..row import Row
from .level_kernel import MOST_CUTS, MOST_PLACES, NONE, Level, Limit, Make, Numbers
from .search_kernel import MEASURES, MOST_DIVIDED, MOST_LEVELS, Search, width_of_measures
from .step_kernel import Points, Signals, State

LEAST_LAYER = 2.0**-24  # of the longest transit: less is stiffer than steps resolve
OUTSIDE = ("none", "velocity", "force", "absorbing")
"""Kinds of what acts on an end, in the kernel's order."""


class Work(NamedTuple):
    """What the kernels of a run work on, in the order of their arguments; lists or arrays."""

    make: Make
    numbers: Numbers
    limit: Limit
    search: Search
    level: Level
    state: State
    tally: Tally
    signals: Signals
    points: Points
    links: Chain
    clock: Any


def is_even(row: Row) -> bool:
    """Whether all that moves at t = 0, and all that acts from outside, is a number."""
    profiles = [value for _, value in row.outside]
    for body in row.system.bodies:
        profiles += [body.velocity, body.strain] if isinstance(body, Rod) else []
    return not any(isinstance(profile, Steps | Samples) for profile in profiles)


def make_of(row: Row) -> Make:
    """What a family of rows has in common, on lists."""
    system, masses = row.system, len(row.masses)
    bonded = groups(system)
    group_of = {body: g for g, group in enumerate(bonded) for body in group}
    group, mass_group, body_mass = [0] * (len(row.segments) + 2), [0] * masses, []
    for body, (first, last) in enumerate(row.spans):
        for s in range(first, last + 1):
            group[s] = group_of[body]
        m = row.mass_of[body]
        body_mass.append(m if m < masses else -1)
        if 0 <= m < masses:
            mass_group[m] = group_of[body]
    held = [0] * len(bonded)
    for (kind, _), g in zip(row.outside, (0, -1), strict=True):
        if kind in ("velocity", "absorbing"):
            held[g] = 1
    first_segment, last_segment = (list(ends) for ends in zip(*row.spans, strict=True))
    return Make(
        first=row.first, law=row.laws, opening=list(row.opening.values()), group=group,
        mass_group=mass_group, held=held, body_first=first_segment, body_last=last_segment,
        body_mass=body_mass, outside=[OUTSIDE.index(kind) for kind, _ in row.outside],
        jump_segment=[s for s, _ in _jumps(row)],
        kind=[int(driven(system)), int(begins_with_jumps(row)), int(RIGID in row.laws)],
    )


def numbers_of(row: Row) -> Numbers:
    """What members of a family differ in: floats, or arrays of the shape of a family."""
    right: list[Number] = [0.0] * len(row.segments)
    left = right[:]
    for body, (first, last) in zip(row.system.bodies, row.spans, strict=True):
        if isinstance(body, Rod) and not isinstance(body.velocity, Steps | Samples) and (
            not isinstance(body.strain, Steps | Samples)
        ):
            for s in range(first - 1, last):
                v, stretch = body.velocity - row.frame, body.strain * row.segments[s].wave_speed
                right[s], left[s] = v - stretch, v + stretch
    outside = [0.0 if isinstance(v, Steps | Samples) else v for _, v in row.outside]
    for side, (kind, _) in enumerate(row.outside):
        if kind == "absorbing":
            outside[side] = outside[side] * row.wave_of_strain(side)
    return Numbers(
        transit=[s.transit_time for s in row.segments],
        impedance=[s.impedance for s in row.segments],
        right=right, left=left, stiffness=row.stiffness, exponent=row.exponent,
        damping=row.damping, strength=row.strength, gap=row.gap, mass=row.masses,
        speed=[v - row.frame for v in row.mass_velocity],
        weight=[getattr(b, "mass", 0.0) if m >= 0 else 0.0
                for b, m in zip(row.system.bodies, row.mass_of, strict=True)],
        outside=outside, jump_place=[x for _, x in _jumps(row)],
        setting=[row.frame, row.gravity, row.scale, *_contact_times(row)],
    )


def begins_with_jumps(row: Row) -> bool:
    """Whether a contact is rigid, an impact or a dashpot, so that its force begins with a jump."""
    return any(
        RIGID <= law <= IMPACT or (law == SPRING and bool(np.any(np.asarray(damping) > 0)))
        for law, damping in zip(row.laws, row.damping, strict=True)
    )


def _jumps(row: Row) -> list[tuple[int, float]]:
    """Where the initial state jumps, and drives: segment and share of it, or 0 and time in s."""
    jumps: list[tuple[int, float]] = []
    for body, (first, last) in zip(row.system.bodies, row.spans, strict=True):
        profiles = (body.velocity, body.strain) if isinstance(body, Rod) else ()
        at = [float(x) for p in profiles if isinstance(p, Steps) for x in p.at]
        begin = 0.0
        for s in range(first, last + 1 if at else first):
            L = float(row.segments[s - 1].length)
            jumps += [(s, (x - begin) / L) for x in at if begin < x < begin + L]
            begin += L
    for _, value in row.outside:
        if isinstance(value, Steps):
            jumps += [(0, float(t)) for t in value.at]
    return jumps


def _contact_times(row: Row) -> list[Number]:
    """Times that the contacts ask for, s.

    A step that resolves the contact of a mass: a twentieth of its time, where it swings back. And
    the least time in which a contact loads a rod, whose impedance then carries what comes: that of
    a linear spring's deformation, or that in which the momentum of a rigid mass goes over.
    """
    v: Any = np.where(np.asarray(row.scale) > 0, 2 * np.asarray(row.scale), 1.0)
    finest: Any = math.inf
    layer: Any = math.inf
    for i, sides in enumerate(row.beside):
        law, stiff, power = row.laws[i], row.stiffness[i], np.asarray(row.exponent[i]) + 1
        masses = [row.masses[m] for kind, m in sides if kind == "mass"]
        ends = [row.segments[s - 1].impedance for kind, s in sides if kind == "segment"]
        m: Any = 1 / sum(1 / M for M in masses) if masses else math.inf
        Z: Any = 1 / sum(1 / z for z in ends) if ends else math.inf
        if masses and (law >= SPRING or law == JOINT):
            with np.errstate(divide="ignore"):  # a dashpot alone has no time
                deepest = (power / 2 * m * v * v / stiff) ** (1 / power)
                swing = math.pi * np.sqrt(m / np.asarray(stiff))
            time = np.where(power == 2, swing, 2.9432 * deepest / v)
            swings = (law == JOINT) | (power != 2) | (math.pi * m <= 2 * time * Z)
            finest = np.minimum(finest, np.where(swings, time / 20, math.inf))
        if law >= SPRING and ends:
            loading = (Z + (row.damping[i] if law == SPRING else 0.0)) / stiff
            layer = np.minimum(layer, np.where(power == 2, loading, math.inf))
        elif law == RIGID and masses and ends:
            layer = np.minimum(layer, m / Z)
    longest: Any = reduce(np.maximum, [s.transit_time for s in row.segments])
    times = (np.maximum(finest, longest / MOST_DIVIDED * 4),
             np.maximum(layer, longest * LEAST_LAYER))
    return [float(time) if np.ndim(time) == 0 else time for time in times]


def memory_of(row: Row, on_lists: bool) -> tuple[float, float]:
    """Numbers that a run keeps for a part of a step, and for an average from before t = 0.

    Signals with what results make of them: waves and their integrals; force, gap, path, rate and
    power with integrals; edges and times. Lists take four times what arrays take, and stand beside
    them at the end.
    """
    lines, contacts = 2 * len(row.segments), len(row.contact_link)
    masses, ends = sum(m >= 0 for m in row.mass_of), sum(kind != "none" for kind, _ in row.outside)
    step, before = 2 * lines + 10 * contacts + 5 * masses + 6 * ends + 10, 4
    if on_lists:
        step += 4 * (lines + 2 * contacts + masses + ends)
        before += 8
    return float(step), float(before)


def check_memory(row: Row, step: float, parts: float, before: float, on_lists: bool) -> None:
    """Raise TooLong where a run of so many parts, with averages from before t = 0, is too much."""
    of_part, of_average = memory_of(row, on_lists)
    if parts < before:
        what = f"keeping waves over {before:.4g} steps"
        ask(before * of_average, "dt", what, "take a longer step")
    what = f"a run of {parts:.4g} steps of {step:.3g} s"
    numbers = parts * of_part + before * of_average
    ask(numbers, "until", what, "stop earlier, or take a longer step (dt or rtol)")


Full = Callable[[int, Any], Any]


def space(make: Make, full: Full, room: int, before: int) -> Work:
    """Work space for runs of `room` parts, on what `full` makes, a number of times the same.

    Parameters
    ----------
    make : Make
    full : function
    room : int
    before : int
        Averages from before t = 0 of a line, all segments together.
    """
    links, masses, n = len(make.law), len(make.mass_group), len(make.group) - 2
    bodies, bonded, opening = len(make.body_first), len(make.held), len(make.opening)
    contacts, jumps = sum(law > BOND for law in make.law), len(make.jump_segment)
    lines, cuts = 2 * n + sum(kind != NONE for kind in make.outside), MOST_CUTS + 2
    places = max(MOST_PLACES, room + 1)

    def of(kind: Callable[..., Any], whole: str = "", **sizes: int) -> Any:
        """Columns of so many numbers; whole ones where they are named so."""
        counts = whole.split()
        return kind(**{name: full(n, 0 if name in counts else 0.0) for name, n in sizes.items()})

    numbers = of(
        Numbers, transit=n, impedance=n, right=n, left=n, stiffness=links, exponent=links,
        damping=links, strength=links, gap=links, mass=masses, speed=masses, weight=bodies,
        outside=2, jump_place=jumps, setting=5,
    )
    search = of(
        Search, "at", at=10, goal=1, sizes=MOST_LEVELS, estimates=MEASURES + 1,
        values=MOST_LEVELS * width_of_measures(make), mass=bonded, before=bonded, after=bonded,
        vibration=bodies, impulse=opening, peak=opening, pressed=opening,
    )
    level = of(
        Level, "at ticks places edges closing_link kept_link", at=14, step=1, ticks=n + 2,
        places=places, edges=room + 1, share=n + 2, closing_time=cuts, closing_link=cuts,
        kept_time=cuts, kept_link=cuts, times=room + 1, gap=room + 1,
    )
    state = of(
        State, "steps parts open", steps=n + 2, share=n + 2, transit=n + 2, parts=1, part=places,
        mobility=n + 2, first=0, mass=masses, law=0, stiffness=links, exponent=links,
        damping=links, strength=links, gap=links, force=links, closing=links, open=links,
        speed=masses, closed=1, layer=1,
    )._replace(first=make.first, law=make.law)
    tally = of(
        Tally, "first last pressed episodes", **dict.fromkeys(Tally._fields, links)
    )
    signals = of(
        Signals, "wave_start link_start mass_start", wave=lines * room + 2 * (before + 1),
        wave_start=2 * n + 4, force=contacts * room, gap=contacts * room, link_start=links,
        speed=masses * room, mass_start=masses,
    )
    return Work(
        make, numbers, of(Limit, "steps", until=1, steps=1, numbers=3), search, level, state,
        tally, signals, of(Points, "", **dict.fromkeys(Points._fields, masses + 2)),
        of(Chain, "", **dict.fromkeys(Chain._fields, masses + 1)), full(3, 0),
    )
