"""Lay a measured record beside what the gauges of a case show: misfit, shift, gain, pulse timing.

rodimpact compare CASE.toml RECORD.csv --gauge incident=1:0.5 --start -20us --stop 120us

A gauge bears the name of its channel. The prediction is shifted in time and multiplied as suits the
record best, unless --shift and --scale say how much; pulses are timed after that. Exit status 3 if
the run stopped before what was asked.
"""

from __future__ import annotations

import argparse
from functools import partial
from typing import NamedTuple

from ..methods.duration import Forecast, warn
from ..model import Rod
from ..model.frozen import InvalidModel, Problems
from ..records.bridge import Bridge
from ..records.comparison import Misfit, Pulse, gain_unit
from ..records.signal import Signal
from ..results.regions import nothing_to_draw
from ..results.solution import Solution
from ..storage.tables import align, as_json
from ..units import format_si
from . import record_options
from .asking import check_outputs, naming, write
from .progress import progress_bar, solved, status_of
from .run_options import NUMBERS, add_run_options, run_options

GAUGE_TIME = 2e-6  # s, about what an event takes in the signal of a gauge and beside a record
_DIMENSIONS = {"start": "time", "stop": "time", "shift": "time", "scale": "dimensionless",
               "carried": "length", "radius": "length"}


class Laid(NamedTuple):
    """A channel and its prediction, shifted and multiplied, and the pulses of the two, if whole."""

    measured: Signal
    predicted: Signal
    misfit: Misfit
    pulses: tuple[Pulse | None, Pulse | None]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A case, a record and how to read it, what to compare, what to write, how far to go."""
    record_options.add_case_and_record(parser)
    compared = parser.add_argument_group("what is compared")
    for name, metavar, what in (
        ("start", "TIME", "of the part of the record; by default all"),
        ("stop", "TIME", "its end"),
        ("shift", "TIME", "fixed, of the prediction; positive is later"),
        ("scale", "X", "its gain, fixed"),
        ("carried", "LENGTH", "shift the computed pulse so much farther, with the exact dispersion "
         "of a round bar, for a gauge placed close behind the struck end"),
        ("radius", "LENGTH", "equivalent radius of that bar, if the case gives no diameter"),
    ):
        compared.add_argument(f"--{name}", metavar=metavar, help=what)
    record_options.add_record_options(parser)
    add_run_options(parser, tuple(NUMBERS))


def run(arguments: argparse.Namespace) -> tuple[str, int]:
    """Check everything, solve, compare, write the figure, and hand back the table or JSON."""
    problems: Problems = []
    case, places, given, bridge = record_options.asked(problems, arguments, _DIMENSIONS)
    options = run_options(problems, arguments, case)
    if not places:
        problems.append(("--gauge", f"is missing; {record_options.FORM} gives a channel and the "
                         "place of its gauge, as [[gauges]] of the case do, with a name"))
    if given.get("radius", 1.0) <= 0:
        problems.append(("--radius", f"must be positive, got {given['radius']!r}"))
    if "radius" in given and "carried" not in given:
        problems.append(("--radius", "goes with --carried"))
    signals = record_options.read_record(problems, arguments, given, places)
    files = {"--save": arguments.save}
    check_outputs(problems, files, arguments.force, figure="--save")
    assert case is not None  # or there were problems

    measured = {name: _prepared(name, signals[name], bridge, given) for name in places}
    solution = solved(case.system, **options)
    if reason := nothing_to_draw(solution):
        raise InvalidModel([(case.path, reason)])
    laid: dict[str, Laid] = {}
    with progress_bar("gauges") as bar:
        forecast = Forecast(warn, "an earlier end (--until)", bar, "reading the gauges")
        seconds = GAUGE_TIME * solution.run.events * len(places)
        forecast.expect(seconds, f"{solution.run.events} events")
        for name, place in places.items():
            forecast.reached(len(laid), len(places))
            with naming({}, f"--gauge {name}"):
                laid[name] = _laid(measured[name], _predicted(solution, place, given), given)
    wrote = write(files, {"--save": partial(_draw, laid)}, arguments.force)
    status = wrote or status_of(solution)
    return (_json(laid) if arguments.json else _table(laid)), status


def _prepared(
    name: str, signal: Signal, bridge: Bridge | None, given: dict[str, float]
) -> Signal:
    """A channel as strain if there is a bridge, cut to what is compared."""
    with naming({"volts": f"--bridge of {name}", "start, end": f"--start, --stop of {name}"}):
        strain = signal if bridge is None else bridge.strain(signal)
        return strain.window(given.get("start", signal.start), given.get("stop", signal.end))


def _predicted(
    solution: Solution, place: tuple[int, float], given: dict[str, float]
) -> Signal:
    """What a gauge shows, as much farther along its bar as is asked."""
    signal = solution.gauge(*place).signal()
    if "carried" not in given:
        return signal
    rod, around = solution.system.bodies[place[0]], signal.end / 4
    assert isinstance(rod, Rod)
    wide = signal.extended(around, around)
    return wide.propagated(given["carried"], rod, radius=given.get("radius"))


def _laid(measured: Signal, predicted: Signal, given: dict[str, float]) -> Laid:
    """A prediction laid over a record."""
    fixed = {name: given.get(name) for name in ("shift", "scale")}
    found = measured.misfit(predicted, **fixed)
    moved = predicted.replace(
        values=found.scale * predicted.values, times=predicted.times + found.shift,
        unit=measured.unit)
    return Laid(measured, predicted, found, (
        _pulse(measured, measured), _pulse(moved, measured)))


def _pulse(signal: Signal, within: Signal) -> Pulse | None:
    """Timing of the pulse in a signal, while another lasts; None if there is no whole one."""
    try:
        return signal.window(within.start, within.end).pulse()
    except ValueError:
        return None


def _table(laid: dict[str, Laid]) -> str:
    """Tables of all channels."""
    blocks = []
    for name, (measured, predicted, found, pulses) in laid.items():
        units = {"start": "s", "width": "s", "rise": "s", "plateau": measured.unit}
        words = {"start": "pulse starts", "width": "width at half height",
                 "rise": "rise from 10 to 90 %", "plateau": "plateau"}
        blocks.append(align([
            [name, "measured", "predicted"],
            *([words[each], *("-" if pulse is None else format_si(getattr(pulse, each), unit_of)
                              for pulse in pulses)] for each, unit_of in units.items()),
        ]) + "\n" + align([
            ["misfit, root mean square over plateau", f"{100 * found.rms:.4g} %"],
            ["shift of the prediction",
             format_si(found.shift, "s") + (", at its limit" if found.at_limit else "")],
            ["gain of the prediction",
             f"{found.scale:.6g} {gain_unit(measured.unit, predicted.unit)}".rstrip()],
        ]))
    return "\n\n".join(blocks)


def _json(laid: dict[str, Laid]) -> str:
    """The same as JSON, in SI units."""
    channels = {
        name: {
            "unit": each.measured.unit, "start": each.measured.start, "stop": each.measured.end,
            "misfit": each.misfit._asdict(),
            **{which: pulse and pulse._asdict() for which, pulse in
               zip(("measured", "predicted"), each.pulses, strict=True)},
        } for name, each in laid.items()
    }
    return as_json(channels=channels)


def _draw(laid: dict[str, Laid], path: str, force: bool) -> None:
    """Draw all channels side by side."""
    from .. import plot
    from ..plot.records import side_by_side

    pairs = side_by_side(len(laid))
    for pair, (measured, predicted, found, _) in zip(pairs, laid.values(), strict=True):
        scale = found.scale if measured.unit == predicted.unit else None  # else it was free
        plot.comparison(measured, predicted, pair, shift=found.shift, scale=scale)
    plot.save(pairs[0][0], path, force=force)
