"""Pieces of all lines at t = 0.

These are the waves that are in the segments at t = 0, and the signals from outside.
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
"""Largest error of pieces that fit the state of an earlier run, over velocity scale."""
JUMP_RTOL = 1e-12
"""Largest distance of two positions of the same jump, over the segment length."""


def segments_of(row: Row) -> Iterator[tuple[Any, int, Any]]:
    """Yield for each segment its rod, its number, and its start in the rod, m.

    Segments are numbered through the whole row, from 0 on. Masses and walls have no
    segments.
    """
    for body, (first, last) in zip(row.system.bodies, row.spans, strict=True):
        begin: Any = 0.0
        # Spans count segments from 1. A wall or a mass has the span 1, 0: no segments.
        for s in range(first - 1, last):
            yield body, s, begin
            begin = begin + row.segments[s].length


def jumps_of(row: Row) -> list[tuple[int, float]]:
    """Jumps of initial velocities and strains inside segments, of `Steps` only.

    Each is a pair: the number of the segment, and the distance of the jump from the
    left end of the segment over its length. Jumps at the ends of segments are left out.
    A jump of both velocity and strain is listed twice.
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
    """Whether one of these values is a profile in space or time, not a number."""
    return any(isinstance(value, Steps | Samples | Polynomials) for value in profiles)


def records_of_family(objects: list[Any], record: Any, row: Row) -> Any:
    """Array [member, i] of records of the dtype `record` from a list of objects, [i].

    A field of an object is a number, an array with one number for each member, or a
    list of these. Lists of lists are not copied: such fields are 0, see `_copy_list`.
    """
    records = np.zeros((*row.system.shape, len(objects)), record)
    for i, source in enumerate(objects):
        for name in record.names:
            value = getattr(source, name)
            if isinstance(value, list):
                _copy_list(records[..., i][name], value)
            else:
                records[name][..., i] = value
    # The axes of the family become one axis of members.
    return records.reshape(row.members, len(objects))


def _copy_list(target: Any, values: list[Any]) -> None:
    """Copy a list of numbers, or of arrays by member, to a field of blank records.

    The last axis of `target` is the index in the list. A list of lists has the values
    of two waves over a piece, which nothing has set yet: they stay 0.
    """
    for j, number in enumerate(values):
        if isinstance(number, list):
            return
        # A blank record has zeros already, and most numbers in a list are zeros.
        is_zero = type(number) is float and number == 0.0
        if not is_zero:
            target[..., j] = number


class OutsideSignal(NamedTuple):
    """How the signal of a line from outside follows from the value u(t) at an end.

    The signal is factor * u(t) + start + slope * t. It is a velocity in the frame, a
    force, or a wave.
    """

    factor: Any  # m/s for a strain u (the signal is a wave); else 1
    start: Any  # m/s or N
    slope: Any  # m/s^2


class InitialLines:
    """Pieces of all lines that are known at t = 0.

    Attributes
    ----------
    log : list of [member, piece] PIECE
        One array for each line: two lines for each segment, then those from outside.
    lines : list of InitialLine
        Numbers of the pieces of each line.
    outside : list of int
        Numbers of the lines from outside to the left and right end, NONE for the free
        end of a rod.
    fit_error : float
        Largest difference of a profile from its pieces, or of a function from its
        samples, relative to the velocity scale.
    carried_error : float
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
        """Make the pieces of all lines: two lines for each segment, then from outside.

        All attributes of the class are set. `jumps` are the ticks of jumps inside
        segments, as of `family_clock`: the keys are the segment and the share of its
        length.
        """
        self._row = row
        self._clock = clock
        self._jumps = jumps
        self._request = request
        self.log = list[Any]()
        self.lines = list[InitialLine]()
        self.fit_error = 0.0
        self.carried_error = 0.0
        for rod, s, begin in segments_of(row):
            self._add_under_way(s, rod, begin)
        self.outside = [self._add_outside(side) for side in (0, 1)]

    def _add(self, pieces: Any) -> int:
        """Append a line with these pieces, [member, piece]; return its number.

        The pieces are appended to `log`, their numbers to `lines`. Their fields `line`
        and `next` are set. `next` is a row of the log of the run, in which the pieces
        of all lines follow each other.
        """
        number = len(self.log)
        # Row of the log of the run at which the line begins
        first_row = sum(line.piece_count for line in self.lines)
        count = pieces.shape[1]
        pieces["line"] = number
        pieces["next"] = [*range(first_row + 1, first_row + count), NONE]
        # Breaks and duration are taken from the first member: if there are more
        # members, each has a single piece. The start of the first piece is no break.
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
        velocity_per_unit: float = 1.0,
    ) -> Any:
        """Pieces, [piece], that fit a signal between two ticks.

        `signal` is a wave, m/s, or a force, N, of which a unit makes the velocity
        `velocity_per_unit`, m/s. It is the sum of `profiles` times factors; the
        profiles are needed only for their types and errors, each with the velocity that
        a unit of its values makes. `Polynomials` along a rod are the state of an
        earlier run: they are fitted to round-off. Other signals, including
        `Polynomials` over time (`is_drive`), are fitted within a quarter of the
        tolerance.

        Two attributes of this class, relative to the velocity scale, are raised if an
        error is larger: `fit_error` to the error of the fit and to the errors of
        samples, `carried_error` to the errors of polynomials.
        """
        scale = float(self._clock.scale)
        signal_scale = scale / velocity_per_unit  # in the unit of the signal
        # A quarter of the tolerance of pieces, in the unit of the signal
        tolerance = self._request.tolerance * signal_scale / 4
        has_polynomials = any(isinstance(p, Polynomials) for p, _ in profiles)
        is_state = has_polynomials and not is_drive
        if is_state:
            largest_miss = EXACT_FIT * signal_scale
        else:
            largest_miss = tolerance
        # The tolerance is also the smallest change that makes a break.
        pieces, miss = profile_pieces.in_pieces(
            signal, start, stop, break_size=tolerance, largest_miss=largest_miss
        )
        self.fit_error = max(self.fit_error, miss / signal_scale)
        for profile, factor in profiles:
            if isinstance(profile, Samples):
                error = abs(factor) * profile.error / scale
                self.fit_error = max(self.fit_error, error)
            elif isinstance(profile, Polynomials):
                error = abs(factor) * profile.error / scale
                self.carried_error = max(self.carried_error, error)
        return pieces

    def _add_under_way(self, s: int, rod: Any, begin: Any) -> None:
        """Add the lines of the two waves that are in segment s of a rod at t = 0.

        They are a = v - c strain, to the right, and b = v + c strain, to the left, m/s,
        with the strain of the rod and its velocity v in the frame. The segment begins
        in the rod at `begin`, m. If v or the strain vary, there is only one member.
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
        # `v` and `strain` are functions of the ticks x/c from the left end. The value
        # of a at x left the left end x/c before t = 0, at tick -x/c: time runs against
        # x, and the pieces are reversed.
        a = (v + strain.times(-c)).plus(-frame)
        mirrored_pieces = self._fit_pieces(a, 0, T, *profiles)
        a_pieces = profile_pieces.backwards(mirrored_pieces)
        self._add(a_pieces[None])  # [member, piece], with one member
        # The value of b at x left the right end at tick -(T - x/c) = x/c - T.
        b = (v + strain.times(c)).plus(-frame).delayed(-T)
        b_pieces = self._fit_pieces(b, -T, 0, *profiles)
        self._add(b_pieces[None])

    def _ticks_in_segment(self, s: int, begin: Any) -> Callable[[Any], Ints]:
        """A function that converts positions in a rod, m, to ticks.

        The ticks are the time that a wave takes from the left end of segment s to the
        position, rounded. The segment begins in the rod at `begin`, m. For the position
        of a jump, they are the ticks that the clock has counted to it.
        """
        segment = self._row.segments[s]
        transit = self._clock.transits[s]
        jump_ticks = []  # pairs: share of the length, ticks
        for (jump_segment, share), tick in self._jumps.items():
            if jump_segment == s:
                jump_ticks.append((share, tick))

        def ticks_of(x: Any) -> Ints:
            """Ticks from the left end of the segment to positions x in the rod, m."""
            shares = (x - begin) / segment.length
            ticks = np.rint(shares * transit).astype(np.int64)
            for share, tick in jump_ticks:  # positions of jumps
                ticks[np.abs(shares - share) < JUMP_RTOL] = tick
            return ticks

        return ticks_of

    def _add_outside(self, side: int) -> int:
        """Add the line from outside to an end of the row; return its number.

        `side` is 0 on the left, 1 on the right. For the free end of a rod no line is
        added, and NONE is returned. The free end of a rigid mass gets a line with the
        force 0.
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
        """Whether the outermost body at an end is a rod, not a rigid mass.

        `side` is 0 on the left, 1 on the right.
        """
        # Node k has the masses first[k] to first[k + 1] - 1: none if both are equal.
        first = self._row.first_mass
        if side == 0:
            return bool(first[0] == first[1])
        return bool(first[-2] == first[-1])

    def _outside_signal(self, side: int) -> OutsideSignal:
        """Factor, start and slope of the signal from outside at an end of the row.

        They depend on the kind of the end. `side` is 0 on the left, 1 on the right. The
        signal of a moved end is its velocity relative to the frame, which falls under
        gravity. The signal of a pushed end is the force. The signal of an endless rod
        is the wave that this end sends inward at t = 0, plus the wave of the strain.
        """
        row = self._row
        kind, _ = row.boundaries[side]
        if kind == "velocity":
            return OutsideSignal(
                factor=1.0, start=-self._clock.frame, slope=-row.system.gravity
            )
        if kind == "absorbing":
            pieces = self.log[self._line_inward(side)]  # [member, piece]
            # The last piece ends at t = 0. All Chebyshev polynomials are 1 at its end,
            # so that its value there is the sum of the coefficients.
            last_series = pieces[:, -1]["coefficients"]
            start = last_series.sum(axis=1).reshape(row.system.shape)
            return OutsideSignal(
                factor=wave_of_strain(row, side), start=start, slope=0.0
            )
        # A pushed end, or the free end of a rigid mass, whose force is 0
        return OutsideSignal(factor=1.0, start=0.0, slope=0.0)

    def _line_inward(self, side: int) -> int:
        """Number of the line on which an end of the row sends waves inward.

        `side` is 0 on the left, 1 on the right. Segment s, from 0 on, has line 2 s to
        the right and line 2 s + 1 to the left.
        """
        if side == 0:
            return 0  # segment 0, to the right
        last = len(self._row.segments) - 1
        return 2 * last + 1

    def _steady(self, value: Any, signal: OutsideSignal) -> Any:
        """The piece, [member, 1], of the signal from outside for a constant value.

        `signal` says how it follows from the value. If its slope is 0, the piece is
        constant and lasts for ever. Otherwise, for a velocity under gravity, it is a
        straight line up to a tick after the end of the run, `until` of the request.
        """
        tick = self._clock.tick
        if np.any(np.asarray(signal.slope) != 0):  # a velocity, whose factor is 1
            stop = np.rint(self._request.until / tick) + 1
            # The straight line is mean + half_rise y, with y from -1 to 1.
            half_rise = signal.slope * stop * tick / 2
            mean = signal.start + value + half_rise
            piece = layout.piece_of(0, stop, [mean, half_rise])
        else:
            piece = layout.constant_wave(signal.start + value * signal.factor)
        return records_of_family([piece], PIECE, self._row)

    def _varying(self, kind: str, value: Any, signal: OutsideSignal) -> Any:
        """Pieces, [1, piece], of the signal from outside for a value that varies.

        `value` is a profile over time, which acts on an end of the row of this `kind`.
        The pieces fit factor * value + start + slope * t, see `OutsideSignal`. There is
        only one member, since the values at the ends of a family are constant.
        `fit_error` and `carried_error` may be raised, see `_fit_pieces`.
        """
        until = self._request.until
        assert until is not None  # a drive demands an end of the run
        tick = float(self._clock.tick)
        # One tick more than the run, so that the signal has a value at the last
        # instant. A run counts as one tick at least.
        stop = round(max(until, tick) / tick) + 1

        def ticks_of(t: Any) -> Ints:
            """Ticks from t = 0 to times, s."""
            return np.rint(t / tick).astype(np.int64)

        u = profile_pieces.signal_of(value, until, ticks_of)
        drive = u.times(float(signal.factor)).plus(float(signal.start))
        if signal.slope:
            ramp = np.array([0.0, signal.slope * stop * tick])  # values at 0 and `stop`
            drive = drive + Pieces.through([0, stop], ramp)
        # Velocity that a unit of the value makes: it converts the error of the value
        if kind == "force":
            # A force F changes the wave that leaves its end by 2 F/Z. In other segments
            # the wave is at most 2 F over the smallest Z. Without rods 0 is taken.
            impedances = [float(segment.impedance) for segment in self._row.segments]
            velocity_per_value = 2 / min(impedances, default=math.inf)
            velocity_per_unit = velocity_per_value  # `drive` is the force, N
        else:
            velocity_per_value = float(signal.factor)
            velocity_per_unit = 1.0  # `drive` is a wave, m/s
        if velocity_per_unit == 0:  # no rods: 1 N counts as 1 m/s
            velocity_per_unit = 1.0
        profile = (value, velocity_per_value)
        pieces = self._fit_pieces(
            drive,
            0,
            stop,
            profile,
            is_drive=True,
            velocity_per_unit=velocity_per_unit,
        )
        return pieces[None]  # [member, piece]
