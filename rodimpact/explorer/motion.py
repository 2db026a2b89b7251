"""Motion of a run of any method: grids of cells, paths, curves, gauges and energies.

A run is a dictionary:

- ``row``; ``tick``, the duration of a tick, s; ``frame``, the velocity of the frame in
  which waves are given, m/s;
- ``transits``, the transit times of the segments, ticks; ``now``, the last tick;
- ``waves`` of `reading.waves_of`, two for each segment, to the right and to the left;
- ``masses``, the velocity of each mass in the frame, as a wave;
- ``springs``, pairs of a link and its overlap as a wave;
- ``exact``, whether waves are constant between their jumps;
- ``draft``, whether fewer points are wanted for a quick answer.

The page has these functions as JavaScript.
"""

from typing import Any

from ..methods.groups import groups
from ..methods.pieces import lines, reading
from ..storage.tables import without_round_off
from .tiling import ROWS, across_of, add_cells, no_cells

PATH_INTERVALS = 400
"""Intervals of the path of a mass."""
CURVE_INTERVALS_PER_PIECE = 8
"""Intervals of a curve in one piece of a wave."""
MIN_CURVE_STEP = 5e-5
"""Least distance of two points of a curve, as a fraction of the run."""
ENERGY_INTERVALS = 100
"""Equal intervals of the curves of energy."""
DRAFT_ENERGY_INTERVALS = 30
"""Equal intervals of the curves of energy in a draft."""
MAX_ENERGY_INTERVALS = 400
"""Largest number of times of the curves of energy; beyond, so many even intervals."""
SAME_TIME = 1e-9
"""Times whose distance is a smaller fraction of the run count as one."""
STRAIN_POINTS = 32
"""Points of a segment at which the strain is taken for its strain energy."""
KINDS = [
    "moving as a whole",
    "vibration, kinetic part",
    "strain energy",
    "total",
    "in compliant contacts",
]
"""Kinds of energy, in the order of `energies_at`."""


# Displacements ------------------------------------------------------------------------


def grids_of(run: Any) -> Any:
    """Grids of displacements of all segments, in the form of the module `tiling`.

    Each has `ROWS` equal steps of time from 0 to the end of the run, and cells of about
    equal width along its segment. Walls and masses have no grid.
    """
    row = run["row"]
    end = run["now"] * run["tick"]
    grids = no_cells()
    for i, body in enumerate(row.system.bodies):
        left = 0.0  # distance of the segment's left end from that of the body, m
        initial_displacement = 0.0  # of the segment's left end, by initial strain, m
        for j, segment in enumerate(body.segments):
            s = row.spans[i][0] - 1 + j  # in the row; spans count from 1
            n_cells = across_of(row.system, segment)
            displacements: list[list[float]] = []
            for k in range(ROWS + 1):
                now = run["now"] * k / ROWS
                displacements.append(
                    displacements_at(run, s, now, n_cells, initial_displacement)
                )
            add_cells(grids, i, segment, left, end, displacements)
            left += segment.length
            initial_displacement += body.strain * segment.length
    return grids


def displacements_at(
    run: Any, s: int, now: float, n_cells: int, initial_displacement: float
) -> list[float]:
    """Displacements of n_cells + 1 points of segment s at the tick `now`, m.

    The points are at equal distances from the left to the right end. A point has the
    displacement u = u0 + integral((a + b)/2 dt), with the right-going wave a, the
    left-going wave b, and u0 = `initial_displacement` at the left end. At the fraction
    m/n_cells of the segment, a left the left end a delay of T m/n_cells ago, and b the
    right end the rest of the transit time T ago.
    """
    tick = run["tick"]
    frame = run["frame"]
    T = run["transits"][s]
    right_going = run["waves"][2 * s]
    left_going = run["waves"][2 * s + 1]
    # Integrals, the first of the two results, begin at the tick -T. That of a up to 0
    # is subtracted, so that the left end has no displacement at t = 0.
    initial_integral = reading.passed_by(right_going, 0)[0]
    displacements = []
    for m in range(n_cells + 1):
        delay = T * m / n_cells
        from_left = reading.passed_by(right_going, now - delay)[0] - initial_integral
        from_right = reading.passed_by(left_going, now - T + delay)[0]
        in_frame = (from_left + from_right) / 2  # m/s times ticks
        displacements.append((in_frame + frame * now) * tick + initial_displacement)
    return displacements


def path_of(run: Any, i: int) -> Any:
    """Lists ``t``, s, and ``displacement``, m, of a wall or a mass; None for a rod.

    A wall has two points, because it moves evenly. The displacement of a mass, at
    `PATH_INTERVALS` + 1 times, is the integral of its velocity.
    """
    body = run["row"].system.bodies[i]
    tick = run["tick"]
    if body.kind == "rod":
        return None
    if body.kind == "wall":
        end = run["now"] * tick
        return {"t": [0.0, end], "displacement": [0.0, body.velocity * end]}
    velocity = run["masses"][run["row"].mass_of[i]]  # in the frame, as a wave
    times = []
    displacements = []
    for k in range(PATH_INTERVALS + 1):
        now = run["now"] * k / PATH_INTERVALS
        in_frame = reading.passed_by(velocity, now)[0]
        times.append(now * tick)
        displacements.append((in_frame + run["frame"] * now) * tick)
    return {"t": times, "displacement": displacements}


# Curves -------------------------------------------------------------------------------


def curve_of(run: Any, terms: Any) -> Any:
    """Curve of a sum of waves from 0 to the end of the run.

    A piece of a wave has `CURVE_INTERVALS_PER_PIECE` intervals, or one if the waves are
    constant in pieces. Points of other waves that would be nearer than `MIN_CURVE_STEP`
    are left out. A jump has two values at one time.

    Parameters
    ----------
    run : dict
    terms : list of (wave, delay, factor)
        Waves with their delays, ticks, and factors.

    Returns
    -------
    dict
        Times ``t``, s, and values ``y``.
    """
    now = run["now"]
    least_step = MIN_CURVE_STEP * now
    n_intervals = CURVE_INTERVALS_PER_PIECE
    if run["exact"]:
        least_step = 0.0
        n_intervals = 1
    breaks = breaks_of(terms, now)
    times: list[float] = []
    values: list[float] = []
    # Tick of the last point. It begins so early that the first interval has points.
    last_tick = -now
    for i in range(len(breaks) - 1):
        start = breaks[i]
        end = breaks[i + 1]
        is_long_enough = end > start and end - last_tick > least_step
        if is_long_enough:
            for k in range(n_intervals + 1):
                tick = start + (end - start) * k / n_intervals
                is_end = k in (0, n_intervals)
                if is_end or tick - last_tick > least_step:
                    times.append(tick * run["tick"])
                    # At `end` the value is that just before a jump: of the pieces that
                    # hold since `start`.
                    values.append(sum_of_waves(terms, start, tick))
                    last_tick = tick
    return {"t": times, "y": values}


def breaks_of(terms: Any, now: float) -> list[float]:
    """Ticks from 0 to `now`, in order, between which all waves of a sum are smooth.

    They are 0, `now`, and all delayed beginnings of pieces of the waves between them.
    """
    breaks = [0, now]
    for wave, delay, _ in terms:
        for start in wave["start"]:
            if 0 < start + delay < now:
                breaks.append(start + delay)
    return sorted(breaks)


def sum_of_waves(terms: Any, since: float, tick: float) -> float:
    """Sum of delayed waves at a tick, by the pieces that hold at the tick `since`.

    If `since` is earlier than a jump at `tick`, this is the sum just before the jump.
    """
    values = []
    for wave, delay, factor in terms:
        values.append(factor * value_held(wave, since - delay, tick - delay))
    total: float = sum(values)
    return total


def value_held(wave: Any, since: float, tick: float) -> float:
    """Value at a tick of that piece of a wave which holds at the tick `since`."""
    piece = wave["piece"][reading.piece_index_at(wave, since)]
    return float(lines.at(piece, reading.position_in(piece, tick)))


def gauge_curve(run: Any, s: int, x: float) -> Any:
    """Curve of the strain of segment s at the distance x from its left end, m.

    The strain is (b - a)/(2 c), with the right-going wave a, the left-going wave b and
    the wave speed c. Each wave has the delay from the end that it left, in whole ticks.
    """
    segment = run["row"].segments[s]
    T = run["transits"][s]
    # Delay of the right-going wave; the left-going wave has the rest of T.
    delay = max(0, min(T, round(x / segment.length * T)))
    factor = 0.5 / segment.wave_speed  # 1/(2 c)
    right_going = run["waves"][2 * s]
    left_going = run["waves"][2 * s + 1]
    return curve_of(
        run, [(left_going, T - delay, factor), (right_going, delay, -factor)]
    )


# Energies -----------------------------------------------------------------------------


def energy_curves(run: Any, corners: list[float]) -> Any:
    """Lists of times ``t``, s, and of the energies at these times, J, by `KINDS`.

    The energy in compliant contacts is left out if there are no such contacts.

    Parameters
    ----------
    run : dict
    corners : list of float
        Times at which energies change, s; left out if they are too many.
    """
    times = energy_times(run, corners)
    kinds = KINDS
    if len(run["springs"]) == 0:
        kinds = KINDS[:4]  # the last is that in compliant contacts
    energies = [energies_at(run, t / run["tick"]) for t in times]  # [time][kind]
    curves = {"t": times}
    for i, name in enumerate(kinds):
        curves[name] = [of_time[i] for of_time in energies]
    return curves


def energy_times(run: Any, corners: list[float]) -> list[float]:
    """Times of the curves of energy, s, in order, each once.

    They are the corners and `ENERGY_INTERVALS` + 1 even times, in a draft
    `DRAFT_ENERGY_INTERVALS` + 1. If these are more than `MAX_ENERGY_INTERVALS`, so many
    even intervals up to the last time are taken instead, without the corners.
    """
    n_intervals = ENERGY_INTERVALS
    if run["draft"]:
        n_intervals = DRAFT_ENERGY_INTERVALS
    times = [*corners]
    for k in range(n_intervals + 1):
        # "now" is the last tick of the run.
        times.append(run["now"] * k / n_intervals * run["tick"])
    times = sorted(times)
    end = times[-1]
    distinct: list[float] = []
    for i, t in enumerate(times):
        if i == 0 or t > times[i - 1] + SAME_TIME * end:
            distinct.append(t)
    if len(distinct) <= MAX_ENERGY_INTERVALS:
        return distinct
    last = distinct[-1]
    even = []
    for i in range(MAX_ENERGY_INTERVALS + 1):
        even.append(last * i / MAX_ENERGY_INTERVALS)
    return even


def energies_at(run: Any, now: float) -> list[float]:
    """Energies at a tick, J, in the order of `KINDS`.

    A segment of mass m has the kinetic and strain energy m (mean(a^2 + b^2)/4 +
    V (mean((a + b)/2) + V/2)), with the waves a and b in the frame of velocity V; its
    first term is the energy in the frame. A compressed contact has
    k d^(p + 1)/(p + 1). The kinetic part of vibration is the energy of the bodies minus
    that of their motion as a whole and the strain energy; it is 0 if round-off makes it
    negative.
    """
    row = run["row"]
    frame = run["frame"]
    momenta = []  # of the bodies, kg m/s
    energy = 0.0  # kinetic and strain energy of all bodies
    for i, body in enumerate(row.system.bodies):
        momentum = body.mass * frame
        # Spans count the segments from 1; a wall or a mass has the empty span (1, 0).
        for s in range(row.spans[i][0] - 1, row.spans[i][1]):
            mass = row.segments[s].mass
            mean, square = means_of(run, s, now)
            momentum += mass * mean
            energy += mass * (square + frame * (mean + frame / 2))
        m = row.mass_of[i]
        if m >= 0:  # the body is a mass
            v = reading.value_at(run["masses"][m], now)  # in the frame
            momentum += body.mass * v
            energy += body.mass * (v + frame) ** 2 / 2
        momenta.append(momentum)
    contact_energy = 0.0
    for link, overlap in run["springs"]:
        compression = max(0.0, reading.value_at(overlap, now))
        power = 1 + link.exponent
        contact_energy += link.stiffness * compression**power / power
    as_a_whole = energy_as_a_whole(row.system, momenta)
    strain = strain_energy(run, now)
    vibration = max(0.0, without_round_off(energy - as_a_whole - strain, energy))
    total = energy + contact_energy
    return [as_a_whole, vibration, strain, total, contact_energy]


def means_of(run: Any, s: int, now: float) -> Any:
    """Mean velocity of segment s, m/s, and its energy over its mass, (m/s)^2.

    Both are in the frame: mean((a + b)/2) and mean(a^2 + b^2)/4 of the waves a and b in
    the segment, which left its ends in the last transit time T before the tick `now`.
    """
    T = run["transits"][s]
    mean = 0.0
    square = 0.0
    for wave in run["waves"][2 * s : 2 * s + 2]:  # a and b
        integral, square_integral = reading.passed_by(wave, now)
        integral_before, square_before = reading.passed_by(wave, now - T)
        mean += (integral - integral_before) / T / 2
        square += (square_integral - square_before) / T / 4
    return mean, square


def strain_energy(run: Any, now: float) -> float:
    """Strain energy of all rods at a tick, J, by the midpoint rule between jumps.

    A segment of mass m and wave speed c with the strain (b - a)/(2 c), where a and b
    are its waves, has the energy m mean((b - a)^2)/8. If waves are constant between
    jumps, this is exact.
    """
    total = 0.0
    for s, segment in enumerate(run["row"].segments):
        T = run["transits"][s]
        right_going = run["waves"][2 * s]
        left_going = run["waves"][2 * s + 1]
        delays = jump_delays(run, s, now)
        for i in range(len(delays) - 1):
            width = delays[i + 1] - delays[i]
            n_points = 1
            if not run["exact"]:
                n_points = 1 + int(STRAIN_POINTS * width / T)
            squares = []
            for k in range(n_points):
                delay = delays[i] + width * (k + 0.5) / n_points
                b = reading.value_at(left_going, now - T + delay)
                a = reading.value_at(right_going, now - delay)
                squares.append((b - a) ** 2)
            sum_of_squares = sum(squares)
            # segment.mass * width / T is the mass between the two jumps.
            total += segment.mass * width / T * sum_of_squares / n_points / 8
    return total


def jump_delays(run: Any, s: int, now: float) -> list[float]:
    """Delays from the left end, ticks, between which segment s has no jump at `now`.

    They are in order, from 0 to the transit time T. A jump that left the left end at a
    tick is now at the delay now - tick; one that left the right end, at T - (now -
    tick).
    """
    T = run["transits"][s]
    right_going = run["waves"][2 * s]
    left_going = run["waves"][2 * s + 1]
    delays = [0.0]
    for tick in jumps_between(run, right_going, now - T, now):
        delays.append(now - tick)
    for tick in jumps_between(run, left_going, now - T, now):
        delays.append(tick - now + T)
    return [*sorted(delays), T]


def jumps_between(run: Any, wave: Any, start: float, stop: float) -> list[float]:
    """Ticks after `start`, up to `stop`, at which a wave jumps.

    If a run that is not exact has `STRAIN_POINTS` jumps or more, [] is returned: the
    midpoint rule has as many points in any case.
    """
    # A jump is the beginning of a piece. The first piece that begins after `start`:
    first = reading.piece_index_at(wave, start) + 1
    last = reading.piece_index_at(wave, stop)
    ticks = []
    for piece in wave["piece"][first : last + 1]:
        if piece.break_order == 0:  # the wave itself jumps, not only a derivative
            ticks.append(piece.start)
    if not run["exact"] and len(ticks) >= STRAIN_POINTS:
        return []
    return ticks


def energy_as_a_whole(system: Any, momenta: list[float]) -> float:
    """Energy of the centre-of-mass motions, J, from the momenta of the bodies, kg m/s.

    It is sum(p^2/(2 m)) over the groups of bonded bodies. A group without mass, which
    is a wall, adds nothing.
    """
    energy = 0.0
    for group in groups(system):
        mass = sum(system.bodies[i].mass for i in group)
        momentum = sum(momenta[i] for i in group)
        if mass > 0:
            energy += momentum * momentum / (2 * mass)
    return energy
