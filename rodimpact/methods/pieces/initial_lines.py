"""Pieces of all lines at t = 0.

First come the waves under way in segments, then waves from outside.
"""

import math
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from ...model import Polynomials, Samples, Steps
from ..clock import Clock
from ..row import Row
from ..scales import wave_of_strain
from ..signals import Ints, Pieces
from . import layout, profile_pieces
from .layout import InitialLine, RunRequest
from .records import MAX_HARD_ORDER, NONE, PIECE

EXACT_FIT = 2.0**-48
"""Largest miss of waves of an earlier run, over the velocity scale."""
JUMP_RTOL = 1e-12
"""Largest distance of two places of the same jump, over the segment length."""


def segments_of(row: Row) -> Iterator[tuple[Any, int, Any]]:
    """Yield for each segment its rod, its number, and where it begins in the rod, m.

    Segments are numbered through the row, from 0 on. Bodies without segments yield
    nothing.
    """
    for body, (first, last) in zip(row.system.bodies, row.spans, strict=True):
        begin: Any = 0.0
        for s in range(first - 1, last):  # none of a wall or a mass, whose span is 1, 0
            yield body, s, begin
            begin = begin + row.segments[s].length


def jumps_of(row: Row) -> list[tuple[int, float]]:
    """Jumps of the initial velocity and strain inside segments, of `Steps` only.

    Each is a pair: the number of its segment, and the share of the length of the
    segment on the left of it. Jumps at the ends of segments are left out; one that
    velocity and strain share stands twice.
    """
    jumps = []
    for rod, s, begin in segments_of(row):
        length = row.segments[s].length
        for profile in (rod.velocity, rod.strain):
            if not isinstance(profile, Steps):
                continue
            for x in profile.at:
                if begin < x < begin + length:
                    jumps.append((s, float((x - begin) / length)))
    return jumps


def varies(*profiles: Any) -> bool:
    """Whether one of these values varies in space or time.

    Such a value is a profile, not a number.
    """
    return any(isinstance(value, Steps | Samples | Polynomials) for value in profiles)


def records_of_family(objects: list[Any], record: Any, row: Row) -> Any:
    """Records, [member, i], of objects, as an array of the dtype `record`.

    A field of an object is a number, an array with one number for each member, or a
    list of such numbers. Lists of lists are left 0, see `_copy_list`.
    """
    records = np.zeros((*row.system.shape, len(objects)), record)
    for i, source in enumerate(objects):
        for name in record.names:
            value = getattr(source, name)
            if isinstance(value, list):
                _copy_list(records[..., i][name], value)
            else:
                records[name][..., i] = value
    return records.reshape(row.members, len(objects))


def _copy_list(target: Any, values: list[Any]) -> None:
    """Copy a list of numbers, or of arrays by member, to a field of records.

    The last axis of `target` is the place in the list. The records are still 0. Lists
    of lists are values over a piece: nothing has set them, so they stay 0.
    """
    for j, number in enumerate(values):
        if isinstance(number, list):
            return
        # A plain 0 is there already; most numbers of a piece are such zeros.
        is_zero = type(number) is float and number == 0.0
        if not is_zero:
            target[..., j] = number


class OutsideSignal(NamedTuple):
    """The signal of a line from outside, made of the value u(t) that acts on an end.

    It is factor * u(t) + start + slope * t: a velocity in the frame, a force, or a
    wave.
    """

    factor: Any  # m/s by strain; 1 for velocities and forces
    start: Any  # m/s or N
    slope: Any  # m/s^2


class InitialLines:
    """Pieces of all lines that begin at t = 0 or before.

    Attributes
    ----------
    log : list of [member, piece] PIECE
        Line by line: two a segment, then those from outside.
    lines : list of InitialLine
        What each line holds.
    outside : list of int
        Lines from outside to the left and right end, NONE for the free end of a rod.
    fit : float
        Largest miss of a profile by its pieces, or of a function by its samples,
        relative to the velocity scale.
    carried : float
        Stated error of the run from whose state this one goes on, relative to the
        velocity scale.
    """

    def __init__(
        self,
        row: Row,
        clock: Clock,
        jumps: dict[tuple[int, float], int],
        request: RunRequest,
    ) -> None:
        """Make the pieces of all lines: two for each segment, then those from outside.

        `jumps` are those of `family_clock`: ticks by segment and share of its length.
        This sets all attributes of the class.
        """
        self._row = row
        self._clock = clock
        self._jumps = jumps  # ticks, by segment and share of its length
        self._request = request
        self.log = list[Any]()
        self.lines = list[InitialLine]()
        self.fit = 0.0
        self.carried = 0.0
        for rod, s, begin in segments_of(row):
            self._add_under_way(s, rod, begin)
        self.outside = [self._add_outside(side) for side in (0, 1)]

    def _add(self, pieces: Any) -> int:
        """Append pieces, [member, piece], to `log` and an `InitialLine` to `lines`.

        Return the number of the line. Two fields of the pieces are set: their line, and
        `next`, the row of the following one in the joined log.
        """
        number = len(self.log)
        # Row of the joined log at which the line begins
        first_row = sum(line.piece_count for line in self.lines)
        count = pieces.shape[1]
        pieces["line"] = number
        pieces["next"] = [*range(first_row + 1, first_row + count), NONE]
        # Breaks and duration are those of the first member: members of a family have a
        # single piece each.
        is_hard = pieces["break_order"][0, 1:] <= MAX_HARD_ORDER
        hard_breaks = int(np.sum(is_hard))
        duration = int(pieces["end"][0, -1] - pieces["start"][0, 0])
        self.log.append(pieces)
        self.lines.append(InitialLine(count, hard_breaks, duration))
        return number

    def _fit_pieces(
        self,
        signal: Pieces,
        start: int,
        stop: int,
        *profiles: tuple[Any, float],
        is_drive: bool = False,
    ) -> Any:
        """Pieces, [piece], that fit a signal between two ticks.

        `signal`, m/s, is already the sum of `profiles` times their factors; the
        profiles only give their kinds and their errors. Polynomials along a rod are the
        state of an earlier run: they are kept but for round-off. All else, also those
        of a drive (`is_drive`), is fitted within a quarter of the tolerance. Two
        attributes, errors over the velocity scale, are raised: `fit` by the largest
        miss and by the errors of samples, `carried` by the errors of polynomials.
        """
        scale = float(self._clock.scale)
        # A quarter of the tolerance of pieces, m/s
        tolerance = self._request.tolerance * scale / 4
        has_polynomials = any(isinstance(p, Polynomials) for p, _ in profiles)
        is_state = has_polynomials and not is_drive
        if is_state:
            largest_miss = EXACT_FIT * scale
        else:
            largest_miss = tolerance
        # The tolerance is also the smallest change that makes a break.
        pieces, miss = profile_pieces.in_pieces(
            signal, start, stop, break_size=tolerance, largest_miss=largest_miss
        )
        self.fit = max(self.fit, miss / scale)
        for profile, factor in profiles:
            if isinstance(profile, Samples):
                self.fit = max(self.fit, abs(factor) * profile.error / scale)
            elif isinstance(profile, Polynomials):
                error = abs(factor) * profile.error / scale
                self.carried = max(self.carried, error)
        return pieces

    def _add_under_way(self, s: int, rod: Any, begin: Any) -> None:
        """Add the lines of both waves in segment s at t = 0.

        They are a = v - c strain, to the right, and b = v + c strain, to the left, m/s,
        with the strain of the rod and its velocity v in the frame. The segment begins
        in its rod at `begin`, m. Where v or the strain vary there is one member only.
        """
        frame = self._clock.frame
        transit = self._clock.transits[s]
        c = self._row.segments[s].wave_speed
        if not varies(rod.velocity, rod.strain):
            velocity = rod.velocity - frame
            for piece in layout.initial_waves(velocity, rod.strain * c, transit):
                self._add(records_of_family([piece], PIECE, self._row))
            return
        ticks_of = self._ticks_in_segment(s, begin)
        v = profile_pieces.signal_of(rod.velocity, rod.length, ticks_of)
        strain = profile_pieces.signal_of(rod.strain, rod.length, ticks_of)
        profiles = ((rod.velocity, 1.0), (rod.strain, c))
        T = int(transit)
        # The part of a at x reaches the right end at T - x/c: it left the left end x/c
        # before t = 0, so that time runs against x.
        a = (v + strain.times(-c)).plus(-frame)
        mirrored_pieces = self._fit_pieces(a, 0, T, *profiles)
        a_pieces = profile_pieces.backwards(mirrored_pieces)
        self._add(a_pieces[None])  # [member, piece]
        # The part of b at x left the right end T - x/c before t = 0.
        b = (v + strain.times(c)).plus(-frame).delayed(-T)
        b_pieces = self._fit_pieces(b, -T, 0, *profiles)
        self._add(b_pieces[None])

    def _ticks_in_segment(self, s: int, begin: Any) -> Callable[[Any], Ints]:
        """A function of places in a rod, m: the ticks that a wave takes to them.

        The wave comes from the left end of segment s. Segment s begins in the rod at
        `begin`, m. A jump is at the ticks that the clock gave it.
        """
        segment = self._row.segments[s]
        transit = self._clock.transits[s]
        jump_ticks = []
        for (jump_segment, share), tick in self._jumps.items():
            if jump_segment == s:
                jump_ticks.append((share, tick))

        def ticks_of(x: Any) -> Ints:
            """Ticks from the left end of the segment to places x in the rod, m."""
            shares = (x - begin) / segment.length
            ticks = np.rint(shares * transit).astype(np.int64)
            for share, tick in jump_ticks:
                ticks[np.abs(shares - share) < JUMP_RTOL] = tick
            return ticks

        return ticks_of

    def _add_outside(self, side: int) -> int:
        """Add the line from outside of an end; return its number.

        For the free end of a rod nothing is added, and NONE is returned; a free rigid
        mass gets a line of force 0. `side` is 0 on the left, 1 on the right.
        """
        row = self._row
        kind, value = row.boundaries[side]
        if kind == "none" and self._ends_with_rod(side):
            return NONE
        signal = self._outside_signal(side)
        if varies(value):
            pieces = self._varying(kind, value, signal)
        else:
            pieces = self._steady(value, signal)
        return self._add(pieces)

    def _ends_with_rod(self, side: int) -> bool:
        """Whether no rigid mass stands at an end: 0 on the left, 1 on the right."""
        # The node k has the masses from first[k] to before first[k + 1].
        first = self._row.first_mass
        if side == 0:
            return bool(first[0] == first[1])
        return bool(first[-2] == first[-1])

    def _outside_signal(self, side: int) -> OutsideSignal:
        """How the signal of an end follows from the value that acts there.

        It does so by factor, start and slope, see `OutsideSignal`, which depend on the
        kind of the end. `side` is 0 on the left, 1 on the right. A velocity counts in
        the frame, which falls; a force acts as it is. The wave out of an endless rod is
        the one that the end sends inward at t = 0, and what the strain adds.
        """
        row = self._row
        kind, _ = row.boundaries[side]
        if kind == "velocity":
            return OutsideSignal(
                factor=1.0, start=-self._clock.frame, slope=-row.system.gravity
            )
        if kind == "absorbing":
            pieces = self.log[self._line_inward(side)]  # [member, piece]
            # Each Chebyshev polynomial is 1 at the end of the last piece, at t = 0.
            last_series = pieces[:, -1]["coefficients"]
            start = last_series.sum(axis=1).reshape(row.system.shape)
            return OutsideSignal(
                factor=wave_of_strain(row, side), start=start, slope=0.0
            )
        return OutsideSignal(factor=1.0, start=0.0, slope=0.0)

    def _line_inward(self, side: int) -> int:
        """Line on which the left (0) or right (1) end of the row sends waves inward.

        Segment s, from 0 on, has the line 2 s to the right and the line 2 s + 1 to the
        left.
        """
        if side == 0:
            return 0
        last = len(self._row.segments) - 1
        return 2 * last + 1

    def _steady(self, value: Any, signal: OutsideSignal) -> Any:
        """The piece, [member, 1], of a value that is constant.

        The value acts on an end; `signal` makes the wave, velocity or force of it. This
        is constant for ever. In a frame that falls it is a straight line, in a piece up
        to a tick after the end of the run, which is given then.
        """
        tick = self._clock.tick
        if np.any(np.asarray(signal.slope) != 0):  # a velocity, whose factor is 1
            stop = np.rint(self._request.until / tick) + 1  # a tick more than the run
            # The straight line is middle + half y.
            half = signal.slope * stop * tick / 2
            middle = signal.start + value + half
            piece = layout.piece_of(0, stop, [middle, half])
        else:
            piece = layout.constant_wave(signal.start + value * signal.factor)
        return records_of_family([piece], PIECE, self._row)

    def _varying(self, kind: str, value: Any, signal: OutsideSignal) -> Any:
        """Pieces, [1, piece], of a value that varies over time.

        The value acts on an end of this `kind`. The pieces fit the signal of the line:
        factor * value + start + slope * t, see `OutsideSignal`. There is one member:
        what acts on the ends of a family is constant in time.
        """
        until = self._request.until
        assert until is not None  # a drive demands an end of the run
        tick = float(self._clock.tick)
        # A tick more than the run, which lasts one at least: the signal has a value at
        # its last instant, too.
        stop = round(max(until, tick) / tick) + 1

        def ticks_of(t: Any) -> Ints:
            """Ticks from t = 0 to times, s."""
            return np.rint(t / tick).astype(np.int64)

        given = profile_pieces.signal_of(value, until, ticks_of)
        drive = given.times(float(signal.factor)).plus(float(signal.start))
        if signal.slope:
            ramp = np.array([0.0, signal.slope * stop * tick])  # values at 0 and `stop`
            drive = drive + Pieces.through([0, stop], ramp)
        # Velocity that a unit of the value makes, for the error of the value
        if kind == "force":
            # F changes the wave that leaves its end by 2 F/Z, and the end itself by
            # F/Z. Where the wave goes on into other segments it is at most 2 F over the
            # least Z. Without rods it is 0.
            impedances = [float(segment.impedance) for segment in self._row.segments]
            velocity_per_value = 2 / min(impedances, default=math.inf)
        else:
            velocity_per_value = float(signal.factor)
        profile = (value, velocity_per_value)
        pieces = self._fit_pieces(drive, 0, stop, profile, is_drive=True)
        return pieces[None]  # [member, piece]
