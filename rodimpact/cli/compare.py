"""Lay a measured record beside what the gauges of a case show: misfit, shift, gain, pulse timing.

rodimpact compare CASE.toml RECORD.csv --gauge incident=1:0.5 --start -20us --stop 120us

A gauge bears the name of its channel. The prediction is shifted in time and multiplied as suits the
record best, unless --shift and --scale say how much; pulses are timed after that. Exit status 3 if
the run stopped before what was asked.
"""

import argparse
from contextlib import suppress
from functools import partial
from typing import Any, TypeAlias

from .. import InvalidModel, Misfit, Pulse, Signal, Solution, solve
from ..records.comparison import gain_unit
from ..results.regions import nothing_to_draw
from ..storage.tables import align, as_json
from ..units import format_si
from . import record_options
from .asking import Given, add_run_options, drawn, number, status_of

_PULSE = {
    "start": "pulse starts",
    "width": "width at half height",
    "rise": "rise from 10 to 90 %",
    "plateau": "plateau",
}


# a channel, its prediction, shift and gain of the prediction, and the pulses of the two, if whole
Laid: TypeAlias = tuple[Signal, Signal, Misfit, list[Pulse | None]]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A case, a record and how to read it, what to compare, what to write, how far to go."""
    record_options.add_case_and_record(parser)
    compared = parser.add_argument_group("what is compared")
    number(compared, "--start", "time", "of the part of the record; by default all")
    number(compared, "--stop", "time", "its end")
    number(compared, "--shift", "time", "fixed, of the prediction; positive is later")
    number(compared, "--scale", "dimensionless", "its gain, fixed")
    number(
        compared,
        "--carried",
        "length",
        "shift the computed pulse so much farther, with the "
        "exact dispersion of a round bar, for a gauge placed close behind the struck end",
    )
    number(
        compared,
        "--radius",
        "length",
        "its equivalent radius, if the case gives no diameter",
    )
    record_options.add_record_options(parser)
    add_run_options(parser)


def run(given: Given) -> tuple[str, int]:
    """Check everything, solve, compare, write the figure, and hand back the table or JSON."""
    case = given.read_case()
    places = record_options.gauge_places(given, case)
    options = given.run_options(case)
    if not places:
        given.problems.append(
            (
                "--gauge",
                f"is missing; {record_options.FORM} gives a channel and "
                "the place of its gauge, as [[gauges]] of the case do, with a name",
            )
        )
    if given.radius is not None and given.radius <= 0:
        given.problems.append(("--radius", f"must be positive, got {given.radius!r}"))
    if given.radius is not None and given.carried is None:
        given.problems.append(("--radius", "goes with --carried"))
    records = record_options.read_record(given, places)
    given.check_outputs("save", figure="save")
    for name in places:
        record = records[name]
        with given.naming(names={"start, end": f"--start, --stop of {name}"}):
            records[name] = record.window(
                record.start if given.start is None else given.start,
                record.end if given.stop is None else given.stop,
            )
    solution = solve(case.system, **options)
    if reason := nothing_to_draw(solution):
        raise InvalidModel([(case.path, reason)])
    laid: dict[str, Laid] = {}
    for name, place in places.items():
        with given.naming(f"--gauge {name}"):
            laid[name] = _laid(records[name], _predicted(solution, place, given), given)
    status = given.write(save=drawn(partial(_draw, laid))) or status_of(solution)
    return (_json(laid) if given.json else _table(laid)), status


def _predicted(solution: Solution, place: tuple[int, float], given: Given) -> Signal:
    """What a gauge shows, as much farther along its bar as is asked."""
    signal = solution.gauge(*place).signal()
    if given.carried is None:
        return signal
    rod: Any = solution.system.bodies[place[0]]
    wide = signal.extended(signal.end / 4, signal.end / 4)
    return wide.propagated(given.carried, rod, radius=given.radius)


def _laid(measured: Signal, predicted: Signal, given: Given) -> Laid:
    """A prediction laid over a record, and the pulses of the two while the record lasts."""
    found = measured.misfit(predicted, shift=given.shift, scale=given.scale)
    moved = predicted.replace(
        values=found.scale * predicted.values,
        times=predicted.times + found.shift,
        unit=measured.unit,
    )
    pulses: list[Pulse | None] = [None, None]
    for i, signal in enumerate((measured, moved)):
        with suppress(ValueError):  # there is no whole one
            pulses[i] = signal.window(measured.start, measured.end).pulse()
    return measured, predicted, found, pulses


def _table(laid: dict[str, Laid]) -> str:
    """Tables of all channels."""
    blocks = []
    for name, (measured, predicted, found, pulses) in laid.items():
        rows = [[name, "measured", "predicted"]]
        for each, words in _PULSE.items():
            unit = measured.unit if each == "plateau" else "s"
            rows.append(
                [
                    words,
                    *(
                        "-" if pulse is None else format_si(getattr(pulse, each), unit)
                        for pulse in pulses
                    ),
                ]
            )
        at_limit = ", at its limit" if found.at_limit else ""
        gain = f"{found.scale:.6g} {gain_unit(measured.unit, predicted.unit)}"
        blocks.append(
            align(rows)
            + "\n"
            + align(
                [
                    [
                        "misfit, root mean square over plateau",
                        f"{100 * found.rms:.4g} %",
                    ],
                    ["shift of the prediction", format_si(found.shift, "s") + at_limit],
                    ["gain of the prediction", gain.rstrip()],
                ]
            )
        )
    return "\n\n".join(blocks)


def _json(laid: dict[str, Laid]) -> str:
    """The same as JSON, in SI units."""
    channels = {}
    for name, (measured, _, misfit, pulses) in laid.items():
        timings = [pulse and pulse._asdict() for pulse in pulses]
        channels[name] = {
            "unit": measured.unit,
            "start": measured.start,
            "stop": measured.end,
            "misfit": misfit._asdict(),
            "measured": timings[0],
            "predicted": timings[1],
        }
    return as_json(channels=channels)


def _draw(laid: dict[str, Laid], plot: Any) -> Any:
    """Draw all channels side by side."""
    from ..plot.records import side_by_side

    pairs = side_by_side(len(laid))
    for pair, (measured, predicted, found, _) in zip(pairs, laid.values(), strict=True):
        scale = (
            found.scale if measured.unit == predicted.unit else None
        )  # else it was free
        plot.comparison(measured, predicted, pair, shift=found.shift, scale=scale)
    return pairs[0][0]
