"""Compute stress and strain of a specimen between two bars from their gauge records.

rodimpact reduce CASE.toml RECORD.csv --length 3.2mm --diameter 6.34mm
    --gauge incident=0:0.381 --gauge transmitted=1:0.381

A shot is one experiment. The case file contains the two bars as neighbouring rods: the
input bar on the left, and the output bar on the right. The specimen is not a body of
the case; options describe it. You can use the case file with which you planned the
shot. Each bar has one or two gauges. The name of a gauge is the name of its channel in
the record.

If the record contains separate pulses, give the channel of each pulse:
    rodimpact reduce CASE.toml PULSES.csv --length 3.2mm --diameter 6.34mm
    --incident i=0:0.381 --reflected r=0:0.381 --transmitted t=1:0.381 --clock own

If each bar has a single gauge at which waves overlap, --equal-forces separates the
waves. For a striker that hits the specimen itself, give --direct-impact. Then the
bodies of the case are the striker, with its velocity, and the output bar.

The first lines of the output are a verdict: equilibrium, peak stress, strain rate and
energy. The next lines give each doubt about the shot, with a value and a remedy. With
--strict the exit status is 3 if there is a doubt.
"""

import argparse
import warnings
from typing import Any

from .. import (
    BarGauge,
    Case,
    CutPulses,
    DoubtfulReduction,
    Reduction,
    Signal,
    Specimen,
    reduce,
)
from ..records.cut_pulses import CLOCKS
from ..storage.tables import versioned_json
from . import gauge_options, record_options
from .arguments import Arguments, add_number, figure_writer
from .exit_status import DONE, INCOMPLETE, CommandResult
from .gauge_options import GaugePositions

PULSES = ("incident", "reflected", "transmitted")
"""Options for pulses that are cut out of their records."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add arguments: the bars, the record, the specimen, the waves, the outputs."""
    record_options.add_case_and_record(parser)
    parser.add_argument("--csv", metavar="FILE", help="write all results against time")
    parser.add_argument(
        "--strict", action="store_true", help="exit status 3 if the verdict has a doubt"
    )
    specimen = parser.add_argument_group("the specimen")
    add_number(
        specimen,
        "--length",
        "length",
        "length of the specimen before the shot; a number without a unit is in m",
        required=True,
    )
    add_number(specimen, "--diameter", "length", "diameter of a round specimen")
    add_number(
        specimen, "--area", "area", "cross-sectional area, in place of the diameter"
    )
    add_number(
        specimen,
        "--youngs-modulus",
        "pressure",
        "Young's modulus of the specimen; --align-within then also makes the initial "
        "slope of the curve equal to this modulus",
    )
    add_number(
        specimen,
        "--wave-speed",
        "velocity",
        "wave speed in the specimen; with --equal-forces or --direct-impact, the "
        "verdict then estimates the time until the forces on both faces are equal",
    )
    specimen.add_argument(
        "--incompressible",
        action="store_true",
        help="assume constant volume, and add columns of true stress and true strain",
    )
    waves = parser.add_argument_group("the waves")
    for name in PULSES:
        waves.add_argument(
            f"--{name}",
            metavar=gauge_options.GAUGE_FORM,
            help=f"channel of the separate {name} pulse, and position of its gauge; "
            "give all three pulses in place of --gauge",
        )
    waves.add_argument(
        "--equal-forces",
        action="store_true",
        help="separate the waves that overlap at the only gauge of each bar; the "
        "command then assumes equal forces on both faces of the specimen, and a free "
        "far end of the output bar",
    )
    waves.add_argument(
        "--direct-impact",
        action="store_true",
        help="a striker hits the specimen itself; in CASE.toml the striker is the body "
        "to the left of the output bar, with a velocity",
    )
    waves.add_argument(
        "--clock",
        choices=CLOCKS,
        default="common",
        help="common (the default): the separate pulses share one time axis; own: each "
        "pulse has its own time axis, and the command aligns the beginnings of the "
        "pulses",
    )
    waves.add_argument(
        "--compression",
        choices=("negative", "positive"),
        default="negative",
        help="sign of compressive strains in the record; default: negative",
    )
    add_number(
        waves,
        "--align-within",
        "time",
        "shift the reflected and the transmitted wave by at most this time, so that "
        "the forces on both faces agree while the specimen is elastic; default: 0, no "
        "shift",
        default=0.0,
    )
    record_options.add_record_options(parser)


def run(args: Arguments) -> CommandResult:
    """Check all arguments, reduce, write the files; table or JSON.

    InvalidModel is raised for all mistakes in the arguments. With --strict, doubts make
    the exit status INCOMPLETE, unless a file could not be written.
    """
    case = args.read_case()
    # Whether the call gives pulses that were cut out of their records.
    is_cut = any(getattr(args, name) is not None for name in PULSES)
    if is_cut:
        positions = _positions_of_pulses(args, case)
    else:
        positions = gauge_options.gauge_positions(args, case)
    specimen: Any = args.build_or_add_problems(
        Specimen,
        args.length,
        area=args.area,
        diameter=args.diameter,
        youngs_modulus=args.youngs_modulus,
        wave_speed=args.wave_speed,
        incompressible=args.incompressible,
    )
    bodies = {position.body for position in positions.values()}
    first = min(bodies, default=0)
    if args.direct_impact:
        _check_direct_impact(args, bodies, is_cut)
    are_neighbours = bodies == {first, first + 1}
    if not (args.direct_impact or is_cut or are_neighbours):
        args.problems.append(
            (
                "--gauge",
                f"give {gauge_options.GAUGE_FORM} for one gauge or two on "
                "each of two neighbouring rods",
            )
        )
    signals = record_options.read_record(args, positions)
    if args.bridge is None:  # a bridge makes strains of voltages
        _check_units(args, positions, signals)
    args.check_outputs("csv", "save", figure="save")  # raises all problems so far
    reduction = _reduce(args, case, specimen, positions, signals)
    status = args.write(
        csv=reduction.to_csv, save=figure_writer(lambda plot: plot.reduction(reduction))
    )
    if args.strict and reduction.doubts and status == DONE:
        status = INCOMPLETE
    if args.json:
        return CommandResult(_json(reduction), status)
    return CommandResult(str(reduction), status)


def _check_direct_impact(args: Arguments, bodies: set[int], is_cut: bool) -> None:
    """Add a problem unless all gauges are on one bar that has a body before it.

    Cut pulses or --equal-forces together with --direct-impact are a problem, too.
    """
    if is_cut or args.equal_forces:
        message = "goes with --gauge alone; equal forces are assumed"
        args.problems.append(("--direct-impact", message))
    elif len(bodies) != 1 or 0 in bodies:
        message = "needs --gauge on one bar, and the striker as the body before it"
        args.problems.append(("--direct-impact", message))


def _positions_of_pulses(args: Arguments, case: Case) -> GaugePositions:
    """Positions of the gauges of the three cut pulses, by their channels.

    Problems are added: a pulse that is missing, --gauge as well, pulses on wrong
    bodies, and channels that are not different.
    """
    positions: GaugePositions = {}
    bodies = []
    for name in PULSES:
        text = getattr(args, name)
        if text is None:
            args.problems.append((f"--{name}", "is missing; give all three pulses"))
            continue
        # One position, or none with a problem added
        pulse_position = gauge_options.positions_in(args, case, f"--{name}", [text])
        for channel, position in pulse_position.items():
            positions[channel] = position
            bodies.append(position.body)
    if args.gauge:
        args.problems.append(("--gauge", "give either gauges or three cut pulses"))
    if len(bodies) == len(PULSES):
        incident, reflected, transmitted = bodies
        if reflected != incident or transmitted != incident + 1:
            message = "must be on the body after that of the other two pulses"
            args.problems.append(("--transmitted", message))
        if len(positions) < len(PULSES):  # pulses of one channel share an entry
            args.problems.append(("--incident", "give three different channels"))
    return positions


def _check_units(
    args: Arguments, positions: GaugePositions, signals: dict[str, Signal]
) -> None:
    """Add a problem for each channel with a gauge that has a unit: it is no strain."""
    for name in positions:
        if name in signals and signals[name].unit:
            message = (
                f"is missing; the channel {name!r} is in {signals[name].unit}, "
                "not strain"
            )
            args.problems.append(("--bridge", message))


def _reduce(
    args: Arguments,
    case: Case,
    specimen: Specimen,
    positions: GaugePositions,
    signals: dict[str, Signal],
) -> Reduction:
    """Reduce the record of a shot: gauges of two bars, cut pulses, or a direct impact.

    The first body with a gauge is the input bar, the next one the output bar; in a
    direct impact the only body with gauges is the output bar. Distances of gauges are
    measured from the specimen: at the right end of the input bar, at the left end of
    the output bar.
    """
    first = min(position.body for position in positions.values())
    if args.direct_impact:
        first -= 1  # the striker
    pair: Any = case.system.bodies[first : first + 2]
    bars = pair
    input_gauges = []
    output_gauges = []
    for name, position in positions.items():
        with args.naming_mistakes(f"--gauge {name}"):
            if position.body == first:
                distance = float(pair[0].length) - position.x
                input_gauges.append(BarGauge(signals[name], distance))
            else:
                output_gauges.append(BarGauge(signals[name], position.x))
    shot: dict[str, Any] = {
        "input_gauges": input_gauges,
        "output_gauges": output_gauges,
    }
    if args.equal_forces:
        shot["equal_forces"] = True
    if args.direct_impact:
        striker, bars = pair  # `reduce` then takes the output bar alone
        shot = {"output_gauges": output_gauges, "striker": striker}
    if args.incident is not None:
        incident, reflected = input_gauges
        (transmitted,) = output_gauges
        with args.naming_mistakes(f"--{PULSES[0]}"):
            pulses = CutPulses(incident, reflected, transmitted, args.clock)
        shot = {"pulses": pulses}
    names = {  # in messages, for arguments of `reduce`; "" for a mistake of none
        "bars": case.path,
        "": "--gauge",
        "input_gauges": "--gauge",
        "output_gauges": "--gauge",
        "pulses": "--incident, --reflected, --transmitted",
        "striker": f"the striker in {case.path}",
        "incident": "--incident",
        "reflected": "--reflected",
        "transmitted": "--transmitted",
    }
    with args.naming_mistakes(names=names), warnings.catch_warnings():
        # the table and the JSON contain the same sentences
        warnings.simplefilter("ignore", DoubtfulReduction)
        return reduce(
            **shot,
            bars=bars,
            specimen=specimen,
            compression=args.compression,
            align_within=args.align_within,
        )


def _json(reduction: Reduction) -> str:
    """The reduction as JSON in SI units.

    It has the verdict, the shifts, the alignment (null if there is none), the doubts,
    the times, and all signals. The sentences of the verdict are left out.
    """
    columns = {}
    for name, signal in reduction.signals.items():
        columns[name] = signal.values.tolist()
    verdict = reduction.verdict._asdict()
    del verdict["sentences"]  # they say in words what the other fields are
    alignment = None
    if reduction.alignment is not None:
        alignment = reduction.alignment._asdict()
    return versioned_json(
        verdict=verdict,
        shifts=reduction.shifts,
        alignment=alignment,
        doubts=list(reduction.doubts),
        time=reduction.times.tolist(),
        **columns,
    )
