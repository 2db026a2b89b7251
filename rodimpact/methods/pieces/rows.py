"""From a row, or a family of them, to the records that the kernels of this method work on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ... import model
from ...model import Rod, Samples, Steps
from ...model.frozen import InvalidModel
from ...model.profiles import extremes
from ..abilities import driven
from ..clock import too_long, too_short
from ..compiling import Functions, as_family
from ..laws import Law
from ..row import Row
from ..scales import largest, smallest
from . import layout
from .known import Waves, jumps_of
from .layout import Asked, Clock, Given
from .records import LINE, LINK, MASS, NODE, PART, RUN

RECORDS = {"run": RUN, "node": NODE, "link": LINK, "mass": MASS, "line": LINE, "part": PART}

BY_MEMBER = ("stiffness", "exponent", "damping", "strength", "gap", "masses", "mass_velocity",
             "transit", "impedance", "weight")


@dataclass(frozen=True, kw_only=True)
class Layout:
    """Records of every member of a family, [member, ...]; a single collision is a family of one.

    Attributes
    ----------
    row : Row
    given : Given
    clock : Clock
    run, node, link, mass, line, part
        Records; `run` is [member].
    first : [member, piece] PIECE
        Pieces that are known at t = 0.
    fit : float
        By how much they miss what was given, relative to the velocity scale.
    own : tuple of (int, function)
        Laws of the user, by link.
    """

    row: Row
    given: Given
    clock: Clock
    run: Any
    node: Any
    link: Any
    mass: Any
    line: Any
    part: Any
    first: Any
    fit: float
    own: Functions


def own_laws(row: Row) -> Functions:
    """Laws of the user, by link."""
    pairs = zip(row.system.contacts, row.contact_link, strict=True)
    return tuple((i, law.force) for law, i in pairs if isinstance(law, model.Law))


def is_even(row: Row) -> bool:
    """Whether all that moves at t = 0, and all that acts from outside, is a number."""
    profiles = [value for _, value in row.outside]
    for body in row.system.bodies:
        profiles += [body.velocity, body.strain] if isinstance(body, Rod) else []
    return not any(isinstance(profile, Steps | Samples) for profile in profiles)


def lay_out(
    row: Row, until: float | None, tolerance: float, max_events: int, keep: bool
) -> Layout:
    """Put a row, or a family of even ones, on records.

    Parameters
    ----------
    row : Row
    until : float or None
        s.
    tolerance : float
        Of pieces, relative to the velocity scale.
    max_events : int
        Cap on steps of nodes.
    keep : bool
        Whether to keep forces, overlaps and velocities of masses.

    Raises
    ------
    InvalidModel
        If transit times are too far apart for one clock, or the run is too long for it.
    """
    given = given_of(row, until)
    clock, jumps = clock_of(row, given, until)
    waves = Waves(row, given, clock, jumps, tolerance, until)
    asked = Asked(until, tolerance, max_events, keep, not driven(row.system))
    laid = layout.lay_out(given, clock, asked, waves.known, waves.outside)
    records = {name: as_family(getattr(laid, name), kind, row.members)
               for name, kind in RECORDS.items()}
    records["run"] = records["run"][:, 0]
    return Layout(row=row, given=given, clock=clock, first=waves.records, fit=waves.fit,
                  own=own_laws(row), **records)


def given_of(row: Row, until: float | None) -> Given:
    """The numbers of a row, each for every member."""
    of, reference = row.of, reference_time(row, until)
    given = layout.given_of(row, reference, of(row.frame), velocity_scale(row, reference))
    table = [[(of(force), of(share)) for force, share in entries] for entries in given.table]
    by_member = {name: [*map(of, getattr(given, name))] for name in BY_MEMBER}
    return given._replace(table=table, **by_member)


def reference_time(row: Row, until: float | None) -> Any:
    """Longest transit, s; without rods `until`, else the longest time of a contact or a flight."""
    of = row.of
    if row.segments:
        return largest([of(s.transit_time) for s in row.segments])
    if until:
        return of(until)
    speeds = [of(v) for v in (*row.mass_velocity, *(v for k, v in row.outside if k == "velocity"))]
    v = np.maximum(largest(speeds) - smallest(speeds), 1e-300)
    m = largest([of(m) for m in row.masses])
    times = [of(gap) / v for gap in row.gap]
    for i in range(len(row.laws)):
        if np.any(of(row.stiffness[i]) > 0):
            power = of(row.exponent[i]) + 1
            deepest = (power / 2 * m * v * v / of(row.stiffness[i])) ** (1 / power)
            times.append(3 * deepest / v)
    longest = largest(times)
    return np.where(longest > 0, longest, 1.0)


def velocity_scale(row: Row, time: Any) -> Any:
    """Scale of velocities, m/s; 1 where nothing moves."""
    of = row.of
    if row.segments:
        scale = of(row.scale)
    else:
        moving = [of(v) for v in row.mass_velocity]
        scale = np.abs(of(row.gravity)) * time
        least = smallest([*map(of, row.masses)] or [np.inf])  # all of it may be bonded to walls
        for kind, value in row.outside:
            sizes = [np.abs(of(x)) for x in extremes(value)]
            if kind == "velocity":
                moving += [of(x) for x in extremes(value)]
            elif kind == "force":
                scale = scale + largest(sizes) * time / least
        scale = scale + largest(moving) - smallest(moving)
        for i, law in enumerate(row.laws):
            if law == Law.JOINT or law >= Law.SPRING:  # what is stored in it at t = 0 moves a mass
                d = np.abs(of(row.gap[i])) if law == Law.JOINT else np.maximum(-of(row.gap[i]), 0.0)
                stored = of(row.stiffness[i]) * d ** (of(row.exponent[i]) + 1)
                scale = scale + np.sqrt(stored / least)
    return np.where(scale > 0, scale, 1.0)


def clock_of(row: Row, given: Given, until: float | None) -> tuple[Clock, list[list[int]]]:
    """The clock, and for each member the times in ticks from ends of rods to jumps inside."""
    n, inner = len(given.transit), jumps_of(row)
    durations = [*given.transit, *(share * given.transit[s] for s, share in inner)]
    end = layout.horizon_of(given) if until is None else row.of(until)
    ticks, found = np.zeros((row.members, n), np.int64), np.zeros(row.members)
    jumps = []
    table = np.array(durations).reshape(len(durations), row.members).T.tolist()
    spans = zip(table, given.reference.tolist(), end.tolist(), strict=True)
    for m, (times, longest, stop) in enumerate(spans):
        total, made = layout.count_ticks(times, longest, stop)
        if total == 0:
            raise InvalidModel([too_long(stop, longest)])
        found[m], ticks[m], more = longest / total, made[:n], made[n:]
        jumps.append(more)
        if n and min(made[:n]) <= 4096:
            s = int(ticks[m].argmin())
            raise InvalidModel([too_short(row.paths[s + 1], times[s], max(times))])
    return Clock(found, [*ticks.T], np.rint(end / found)), jumps
