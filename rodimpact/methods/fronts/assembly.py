"""From a system to flat lists: segments, nodes, ticks and the waves under way at t = 0.

Bodies are laid end to end as segments 1 to n; the segments 0 and n + 1 are what lies outside. What
holds or drives an end is a body without segments, as is a wall. What members of a family share is
their `Make`; the numbers in which they differ go to the layout kernel.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from ...model import Absorbing, Bonded, End, Fixed, Free, Incoming, Moved, Pushed, Rod, Steps
from ...model.frozen import InvalidModel, Number
from .. import kernels, laws
from ..clock import Clock
from ..row import Row
from ..tick_rule_kernel import CLOCK_BITS, COARSEST
from .front_kernel import BOND, FREE, OPEN, PUSH, TOUCH, Log, State, Tally, begin
from .layout_kernel import (
    ENDLESS,
    LAID,
    LONG,
    MOVED,
    OVERFLOW,
    PUSHED,
    STEADY,
    Layout,
    Make,
    Work,
    lay_out_all,
)

OUTSIDE: dict[type[End], int] = {
    Free: STEADY, Fixed: STEADY, Absorbing: ENDLESS, Incoming: ENDLESS, Pushed: PUSHED,
    Moved: MOVED,
}
STATUS = {laws.FREE: FREE, laws.FORCE: PUSH, laws.BOND: BOND, laws.RIGID: TOUCH}
PAIR_TIME = 4e-7  # s, about what plain Python takes to compare two durations


@dataclass(frozen=True, kw_only=True)
class Assembly(Clock):
    """A single collision in flat lists, for the fronts method.

    Attributes
    ----------
    nodes : tuple of int
        Node of each contact.
    tolerance : float
        Velocity below which two waves are the same, m/s.
    window : int
        Ticks by which a closing may move to an arrival.
    status : list of int
        Of each node at t = 0, before anything is solved.
    gaps : list of float
        At each node, velocity times ticks.
    outside : (float, float)
        Wave arriving from the left and from the right wall.
    waves : list of list of (int, float)
        By line: ticks at which fronts left (the first at minus one transit) and values behind them;
        on the first and the last line what an end that goes on for ever, or is driven, gets from
        outside.
    """

    nodes: tuple[int, ...]
    tolerance: float
    window: int
    status: list[int]
    gaps: list[float]
    outside: tuple[float, float]
    waves: list[list[tuple[int, float]]]


class Blueprint:
    """A row, or a family of them, as numbers for the layout kernel.

    Attributes
    ----------
    row : Row
    make : Make
        On lists.
    numbers : list of float or array
        One row of the kernel's `given`; arrays where members differ.
    status : list of int
        Of each node while its gap is 0.
    """

    def __init__(self, row: Row) -> None:
        self.row, system = row, row.system
        places, jumps = [], []
        profiles: list[Number] = []
        for body in system.bodies:
            places.append(len(profiles))
            for profile in (body.velocity, body.strain if isinstance(body, Rod) else 0.0):
                numbers = _in_pieces(profile)
                jumps.append(len(numbers) // 2)
                profiles += numbers
        spans, pieces, contacts = list(row.spans), row.segments, len(system.gaps)
        n, nodes = len(pieces), [last for _, last in spans[:contacts]]
        for side, end in enumerate(system.ends):
            if isinstance(end, Free):
                continue
            numbers = _in_pieces(getattr(end, "value", 0.0))
            spans.insert(side * len(spans), (1, 0))
            places.insert(side * len(places), len(profiles))
            jumps[side * len(jumps) : side * len(jumps)] = [len(numbers) // 2, 0]
            profiles += [*numbers, 0.0]
        first, last = (list(ends) for ends in zip(*spans, strict=True))
        self.numbers: list[Number] = [
            *(p.wave_speed for p in pieces), *(p.impedance for p in pieces),
            *(p.length for p in pieces), *system.gaps, *profiles,
        ]
        places = [3 * n + contacts + place for place in places]
        size = [n, len(self.numbers), 2 * (n + sum(jumps)) + 2]
        outside = [OUTSIDE[type(end)] for end in system.ends]
        bonded = [isinstance(law, Bonded) for law in system.contacts]
        joined = [int(all(bonded)), int(any(bonded))]
        self.make = Make(first, last, nodes, places, jumps, outside, size, joined)
        self.status = [STATUS[law] for law in row.laws]

    def space(
        self, members: int, full: Callable[[int, Any], Any] = lambda size, zero: [zero] * size
    ) -> tuple[Layout, Work]:
        """Room for the layout of that many members, on lists or what `full` makes."""
        rows, sizes = sizes_of(self.make)
        kinds = [0, 0.0, 0.0, 0.0, 0, 0, 0, 0.0, 0.0, 0, 0, 0.0, 0.0, 0.0, 0.0, 0]
        layout = Layout(*map(full, [members * row for row in rows], kinds))
        kinds = [0.0, 0, 0, 0, 0, 0, 0.0, 0.0, 0.0, 0]
        return layout, Work(*map(full, sizes, kinds))


def sizes_of(make: Make) -> tuple[list[int], list[int]]:
    """Sizes of the columns of a `Layout` of one member, and of a `Work`."""
    n, fronts, marks = make.size[0], make.size[2], make.size[0]
    for jumps in make.jumps:
        marks += jumps
    layout = [n + 2, n + 2, n + 1, 2, 1, fronts, fronts, fronts, 1, 1, 1, 1, 1, 1, 1, 1]
    return layout, [marks, marks, marks, marks, marks, n + 2, marks, marks, marks, 2]


def assemble(row: Row, until: float | None = None) -> Assembly:
    """Lay out a single collision for the fronts method.

    Parameters
    ----------
    row : Row
    until : float, optional
        Time to be reached, s; sets how fine a tick can be.

    Raises
    ------
    InvalidModel
        When velocities overflow, or transit times are too far apart for one clock.
    """
    plan = Blueprint(row)
    make, given = plan.make, cast("list[float]", plan.numbers)
    n = make.size[0]
    end = -1.0 if until is None else until
    fates: Any = [LAID]
    if kernels.worth_compiling(make.size[2] ** 2 * PAIR_TIME, lay_out_all):
        layout, work = plan.space(1, np.full)
        arrays, fates = Make(*(np.array(x, dtype=np.int64) for x in make)), np.array(fates)
        kernels.compiled(lay_out_all)(arrays, np.array(given), end, layout, work, fates)
        layout, work = kernels.as_lists(layout), kernels.as_lists(work)
    else:
        layout, work = plan.space(1)
        lay_out_all(make, given, end, layout, work, fates)
    if fates[0] != LAID:
        raise InvalidModel([_refusal(fates[0], plan, layout, work.duration)])
    waves: list[list[tuple[int, float]]] = [[] for _ in range(2 * n + 4)]
    for r in range(layout.count[0]):
        waves[layout.line[r]].append((layout.tick[r], layout.value[r]))
    tick = layout.tick_seconds[0]
    errors = [abs(layout.transit[s] * tick / work.duration[s - 1] - 1) for s in range(1, n + 1)]
    worst = max(range(n), key=errors.__getitem__)
    status = [OPEN if gap > 0 else at for gap, at in zip(layout.gap, plan.status, strict=True)]
    endless = [given[n + s] if kind == ENDLESS else 0.0
               for kind, s in zip(make.outside, (0, n - 1), strict=True)]
    return Assembly(
        system=row.system, spans=row.spans,
        nodes=tuple(make.node), wave_speed=[0.0, *given[:n], 0.0],
        impedance=[endless[0], *given[n : 2 * n], endless[1]],
        length=[0.0, *given[2 * n : 3 * n], 0.0],
        ticks=layout.transit, tick=tick, frame=layout.frame[0], tolerance=layout.tolerance[0],
        window=layout.window[0], status=status, gaps=layout.gap,
        outside=(layout.outside[0], layout.outside[1]), waves=waves,
        transit_error=errors[worst], worst=row.paths[worst + 1],
    )


def _in_pieces(profile: Any) -> list[Number]:
    """Values of a profile, and where it jumps."""
    return [*profile.values, *profile.at] if isinstance(profile, Steps) else [profile]


def _refusal(fate: int, plan: Blueprint, layout: Layout, durations: Any) -> tuple[str, str]:
    """Path and sentence for a member that cannot be laid out."""
    if fate == OVERFLOW:
        scale = float(layout.scale[0])
        return "bodies", f"velocities and strains of {scale!r} m/s overflow the energy; use smaller"
    longest = max(durations[: plan.make.size[0]])
    if fate == LONG:
        horizon, most = layout.horizon[0], longest * 2.0 ** (CLOCK_BITS - 1 - COARSEST)
        return "until", (
            f"a run of {horizon:g} s is {horizon / longest:.3g} times the longest transit time "
            f"{longest:g} s, more than the clock can count; stop before {most:.3g} s"
        )
    short = layout.short[0]
    return plan.row.paths[short], (
        f"its transit time {durations[short - 1]:.3g} s is too short beside the longest, "
        f"{longest:.3g} s: one exact clock holds ratios up to about 2e11; leave it out"
    )


def start(
    ticks: Sequence[Any],
    mobility: Sequence[Any],
    status: Sequence[int],
    gaps: Sequence[Any],
    outside: tuple[Any, Any],
    waves: Sequence[Sequence[tuple[int, Any]]],
    room: int = 256,
) -> tuple[State, Tally, Log, list[int]]:
    """Make the kernel's state at t = 0, on lists, of whatever kind of number the amplitudes are.

    Parameters
    ----------
    ticks, mobility : [n + 2]
        Transit times, of that kind too if they are no ticks, and 1/Z by segment; outside 0, but
        for the 1/Z of an endless bar.
    status, gaps : [n + 1]
        By node.
    outside : pair
        Waves of the walls.
    waves : [2 n + 2] or [2 n + 4] lists of (tick, value)
        By line; that of line 1 is empty.
    room : int
        Log rows to provide beyond the initial ones.
    """
    sent = [(t, l, wave) for l, fronts in enumerate(waves) for t, wave in fronts]
    state, tally, log, clock = work_space(len(ticks) - 2, len(sent) + room, 0 * mobility[1])
    log.tick[: len(sent)], log.line[: len(sent)], log.value[: len(sent)] = (
        [front[i] for front in sent] for i in range(3)
    )
    state.transit[:], state.mobility[:] = ticks, mobility
    state.status[:], state.gap[:] = status, gaps
    state.arrived[0], state.arrived[-1] = outside
    begin(state, tally, log, clock, len(sent))
    return state, tally, log, clock


def work_space(
    n: int, room: int, zero: Any = 0.0
) -> tuple[State, Tally, Log, list[int]]:
    """Space on lists for a run of n segments, with so many rows of the log."""
    leaves = 1
    while leaves <= n:
        leaves *= 2
    segments, nodes, lines = n + 2, n + 1, 2 * n + 4
    state = State(
        [0] * segments, [zero] * segments, [0] * nodes, [0] * nodes, [zero] * nodes,
        [zero] * nodes, [zero] * nodes, [zero] * nodes, [zero] * lines, [-1] * lines,
        [-1] * lines, [0] * (2 * leaves),
    )
    tally = Tally(
        [zero] * nodes, [zero] * nodes, [zero] * nodes, [0] * nodes, [0] * nodes, [0] * nodes,
        [0] * nodes, [0] * nodes,
    )
    log = Log(
        [0] * room, [-1] * room, [0] * room, [zero] * room, [0] * room, [0] * room, [0] * room
    )
    return state, tally, log, [0] * 7
