"""Compare a measured record with the gauges of a case: misfit, shift, factor, pulses.

rodimpact compare CASE.toml RECORD.csv --gauge incident=1:0.5 --start -20us --stop 120us

The name of a gauge is the name of its channel in the record. The command shifts the
computed strain in time and multiplies the strain by a factor. The command chooses the
shift and the factor with the smallest misfit. --shift fixes the shift, and --scale
fixes the factor. The misfit is the root mean square of the difference, divided by the
plateau of the record. A table lists start, width, rise and plateau of the measured
pulse and of the computed pulse. The exit status is 3 if the run stopped early, for
example at --max-events.
"""

import argparse
from collections.abc import Iterator
from contextlib import suppress
from functools import partial
from typing import Any, NamedTuple

from .. import Case, InvalidModel, Misfit, Pulse, Signal, Solution, solve
from ..records.comparison import gain_unit
from ..results.regions import nothing_to_draw
from ..storage.tables import align, versioned_json
from ..units import format_si
from . import gauge_options, record_options
from .arguments import (
    Arguments,
    add_number,
    add_run_options,
    figure_writer,
    status_of,
)
from .exit_status import DONE, CommandResult
from .gauge_options import GaugePosition, GaugePositions

PULSE_ROWS = {
    "start": "pulse starts",
    "width": "width at half height",
    "rise": "rise from 10 to 90 %",
    "plateau": "plateau",
}
"""Rows of the table, by the field of a `Pulse`."""


class Comparison(NamedTuple):
    """A channel of the record beside its prediction."""

    measured: Signal
    predicted: Signal
    misfit: Misfit  # it has shift and factor of the prediction, too
    measured_pulse: Pulse | None  # None if the record has no whole pulse
    predicted_pulse: Pulse | None  # pulse of the shifted prediction, during the record


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add arguments: the case, the record, what is compared, options of the run."""
    record_options.add_case_and_record(parser)
    compared = parser.add_argument_group("what is compared")
    add_number(
        compared,
        "--start",
        "time",
        "start of the compared part of the record; default: start of the record",
    )
    add_number(
        compared,
        "--stop",
        "time",
        "end of the compared part; default: end of the record",
    )
    add_number(
        compared,
        "--shift",
        "time",
        "fix the time shift of the computed strain; a positive shift is a delay",
    )
    add_number(
        compared,
        "--scale",
        "dimensionless",
        "fix the factor of the computed strain; the record must be a strain",
    )
    add_number(
        compared,
        "--carried",
        "length",
        "distance from the position of --gauge to the real gauge, if the real gauge is "
        "far from the struck end; --gauge is then a position near the struck end: the "
        "command computes the pulse there, then propagates the pulse over this "
        "distance along a round bar, with exact dispersion",
    )
    add_number(
        compared,
        "--radius",
        "length",
        "radius of the round bar of --carried, if the case gives no diameter",
    )
    record_options.add_record_options(parser)
    add_run_options(parser)


def run(args: Arguments) -> CommandResult:
    """Check all arguments, solve, compare, write the figure; table or JSON.

    InvalidModel is raised for all mistakes in the arguments, before the case is solved.
    The status is that of the figure, or INCOMPLETE if the run stopped early.
    """
    case = args.read_case()
    positions = gauge_options.gauge_positions(args, case)
    options = args.run_options(case)
    _check_arguments(args, positions)
    records = record_options.read_record(args, positions)
    args.check_outputs("save", figure="save")
    for name in positions:
        records[name] = _window(args, name, records[name])
    with args.naming_mistakes():
        solution = solve(case.system, **options)
    comparisons = _compare(args, case, solution, positions, records)
    status = args.write(save=figure_writer(partial(_draw, comparisons)))
    if status == DONE:
        status = status_of(solution)
    if args.json:
        return CommandResult(_json(comparisons), status)
    return CommandResult(_tables(comparisons), status)


def _check_arguments(args: Arguments, positions: GaugePositions) -> None:
    """Add problems: no gauge, a radius that is not positive or lacks --carried."""
    if not positions:
        args.problems.append(
            (
                "--gauge",
                f"is missing; {gauge_options.GAUGE_FORM} gives a channel and the "
                "place of its gauge, as [[gauges]] of the case do, with a name",
            )
        )
    if args.radius is not None and args.radius <= 0:
        args.problems.append(("--radius", f"must be positive, got {args.radius!r}"))
    if args.radius is not None and args.carried is None:
        args.problems.append(("--radius", "goes with --carried"))


def _window(args: Arguments, name: str, record: Signal) -> Signal:
    """The part of a record from --start to --stop; by default all of it.

    InvalidModel, with the names of both options, is raised if there is no such part.
    """
    start = record.start
    if args.start is not None:
        start = args.start
    stop = record.end
    if args.stop is not None:
        stop = args.stop
    # `window` names both of its arguments in one path.
    with args.naming_mistakes(names={"start, end": f"--start, --stop of {name}"}):
        return record.window(start, stop)


def _compare(
    args: Arguments,
    case: Case,
    solution: Solution,
    positions: GaugePositions,
    records: dict[str, Signal],
) -> dict[str, Comparison]:
    """Comparison of each record with the gauge of a solution, by channel.

    InvalidModel is raised if the run lasted no time.
    """
    reason = nothing_to_draw(solution)
    if reason:
        raise InvalidModel([(case.path, reason)])
    comparisons = {}
    for name, position in positions.items():
        with args.naming_mistakes(f"--gauge {name}"):
            predicted = _prediction(args, solution, position)
            comparisons[name] = _comparison(args, records[name], predicted)
    return comparisons


def _prediction(args: Arguments, solution: Solution, position: GaugePosition) -> Signal:
    """Strain at a gauge, or at the distance --carried farther along its bar.

    A carried strain is dispersed, and extended by a quarter of the run at both ends.
    """
    signal = solution.gauge(position.body, position.x).signal()
    if args.carried is None:
        return signal
    rod: Any = solution.system.bodies[position.body]
    margin = signal.end / 4  # room for the pulse, which dispersion spreads
    extended = signal.extended(margin, margin)
    return extended.propagated(args.carried, rod, radius=args.radius)


def _comparison(args: Arguments, measured: Signal, predicted: Signal) -> Comparison:
    """Misfit of a prediction, and the pulses of the record and of the prediction.

    The pulse of the prediction is found after shift and factor of the misfit are
    applied, in the time of the record. `predicted` of the result is without both.
    """
    misfit = measured.misfit(predicted, shift=args.shift, scale=args.scale)
    shifted = predicted.replace(
        values=misfit.scale * predicted.values,
        times=predicted.times + misfit.shift,
        unit=measured.unit,
    )
    start = measured.start
    end = measured.end
    return Comparison(
        measured=measured,
        predicted=predicted,
        misfit=misfit,
        measured_pulse=_pulse(measured, start, end),
        predicted_pulse=_pulse(shifted, start, end),
    )


def _pulse(signal: Signal, start: float, end: float) -> Pulse | None:
    """The pulse of a signal between two times, s; None if there is no whole one."""
    with suppress(ValueError):
        return signal.window(start, end).pulse()
    return None


def _tables(comparisons: dict[str, Comparison]) -> str:
    """Two tables for each channel: of the pulses, and of misfit, shift and factor.

    An empty line separates the channels.
    """
    blocks = []
    for name, comparison in comparisons.items():
        pulses = align(list(_pulse_rows(name, comparison)))
        misfit = align(_misfit_rows(comparison))
        blocks.append(f"{pulses}\n{misfit}")
    return "\n\n".join(blocks)


def _pulse_rows(name: str, comparison: Comparison) -> Iterator[list[str]]:
    """Rows of `PULSE_ROWS`, header first; "-" for a signal without a whole pulse."""
    yield [name, "measured", "predicted"]
    for field, words in PULSE_ROWS.items():
        unit = "s"
        if field == "plateau":
            unit = comparison.measured.unit
        row = [words]
        for pulse in (comparison.measured_pulse, comparison.predicted_pulse):
            text = "-"
            if pulse is not None:
                text = format_si(getattr(pulse, field), unit)
            row.append(text)
        yield row


def _misfit_rows(comparison: Comparison) -> list[list[str]]:
    """Rows of misfit, shift and factor of a prediction, without a header.

    The shift has a remark if it is at its limit.
    """
    misfit = comparison.misfit
    shift = format_si(misfit.shift, "s")
    if misfit.at_limit:
        shift += ", at its limit"
    unit = gain_unit(comparison.measured.unit, comparison.predicted.unit)
    return [
        ["misfit, root mean square over plateau", f"{100 * misfit.rms:.4g} %"],
        ["shift of the prediction", shift],
        ["factor of the prediction", f"{misfit.scale:.6g} {unit}".rstrip()],
    ]


def _json(comparisons: dict[str, Comparison]) -> str:
    """The comparisons as JSON, in SI units.

    By channel they have the unit, the compared interval, the misfit, and both pulses.
    """
    channels = {}
    for name, comparison in comparisons.items():
        channels[name] = {
            "unit": comparison.measured.unit,
            "start": comparison.measured.start,
            "stop": comparison.measured.end,
            "misfit": comparison.misfit._asdict(),
            "measured": _pulse_entries(comparison.measured_pulse),
            "predicted": _pulse_entries(comparison.predicted_pulse),
        }
    return versioned_json(channels=channels)


def _pulse_entries(pulse: Pulse | None) -> dict[str, Any] | None:
    """Fields of a pulse by name; None without a pulse."""
    if pulse is None:
        return None
    return pulse._asdict()


def _draw(comparisons: dict[str, Comparison], plot: Any) -> Any:
    """Draw all channels side by side; return the first Axes, to save the figure by.

    Each has the shift of its misfit, and the scale too if both signals have one unit.
    """
    from ..plot.records import side_by_side

    pairs = side_by_side(len(comparisons))
    for signal_and_residual, comparison in zip(
        pairs, comparisons.values(), strict=True
    ):
        measured = comparison.measured
        predicted = comparison.predicted
        scale = None  # free in the figure, as a gain between different units is
        if measured.unit == predicted.unit:
            scale = comparison.misfit.scale
        shift = comparison.misfit.shift
        plot.comparison(
            measured, predicted, signal_and_residual, shift=shift, scale=scale
        )
    return pairs[0][0]
