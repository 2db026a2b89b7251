"""Stress and strain of a specimen between two bars, from the record of their gauges.

rodimpact reduce CASE.toml RECORD.csv --gauge incident=0:0.381 --gauge transmitted=1:0.381
    --length 3.2mm --diameter 6.34mm

The case file contains the two bars as neighbouring rods with their lengths; the case that planned
the shot can be used. The specimen is between the two rods. Each rod has one or two gauges. The name
of a gauge is the name of its channel in the record.
"""

from __future__ import annotations

import argparse
from functools import partial
from typing import Any

from ..model.frozen import Problems
from ..records.bars import BarGauge
from ..records.bridge import Bridge
from ..records.reduction import Reduction, Specimen, reduce
from ..records.signal import Signal
from ..storage.tables import as_json
from . import record_options
from .asking import attempt, check_outputs, naming, write
from .options import flag

_SPECIMEN = {"length": "length", "diameter": "length", "area": "area", "youngs_modulus": "pressure"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The bars, the record, the specimen, and what to write."""
    record_options.add_case_and_record(parser)
    parser.add_argument("--csv", metavar="FILE", help="write all columns over time")
    specimen = parser.add_argument_group("the specimen")
    specimen.add_argument("--length", metavar="LENGTH", help="length before the shot")
    specimen.add_argument("--diameter", metavar="LENGTH", help="diameter, if round; or give")
    specimen.add_argument("--area", metavar="AREA", help="cross-sectional area")
    specimen.add_argument("--youngs-modulus", metavar="PRESSURE", help="of its elastic part")
    specimen.add_argument("--incompressible", action="store_true",
                          help="its volume is constant: add true stress and strain")
    waves = parser.add_argument_group("the waves")
    waves.add_argument("--compression", choices=("negative", "positive"), default="negative",
                       help="sign of compressive strains in the record; default: negative")
    waves.add_argument("--align-within", metavar="TIME",
                       help="largest shift of the reflected and the transmitted wave")
    record_options.add_record_options(parser)


def run(arguments: argparse.Namespace) -> tuple[str, int]:
    """Check everything, reduce, write the files, and hand back the table or JSON."""
    problems: Problems = []
    case, places, given, bridge = record_options.asked(
        problems, arguments, {"align_within": "time", **_SPECIMEN})
    specimen = _specimen(problems, given, arguments.incompressible)
    first = min((body for body, _ in places.values()), default=0)
    if {body - first for body, _ in places.values()} != {0, 1}:
        problems.append(("--gauge", f"give {record_options.FORM} for one gauge or two on each of "
                         "two neighbouring rods"))
    signals = record_options.read_record(problems, arguments, given, places)
    problems += [
        ("--bridge", f"is missing; the channel {name!r} is in {signals[name].unit}, not strain")
        for name in places if bridge is None and name in signals and signals[name].unit
    ]
    files = {"--csv": arguments.csv, "--save": arguments.save}
    check_outputs(problems, files, arguments.force, figure="--save")
    assert case is not None  # or there were problems
    bars: Any = case.system.bodies[first : first + 2]
    gauges = _gauges(places, signals, bridge, first, float(bars[0].length))
    options = {"bars": case.path, "align_within": "--align-within",
               **dict.fromkeys(("", "input_gauges", "output_gauges"), "--gauge")}
    with naming(options):
        found = reduce(
            *gauges, bars, specimen, compression=arguments.compression,
            align_within=given.get("align_within", 0.0))
    writers: dict[str, Any] = {"--csv": found.to_csv, "--save": partial(_draw, found)}
    status = write(files, writers, arguments.force)
    return (_json(found) if arguments.json else str(found)), status


def _specimen(problems: Problems, given: dict[str, float], incompressible: bool) -> Any:
    """The specimen; None, and an entry in `problems`, if its options are invalid."""
    own: dict[str, Any] = {name: given[name] for name in _SPECIMEN if name in given}
    if "length" not in own:
        problems.append(("--length", "is missing; give the length of the specimen"))
        return None
    options = {name: flag(name) for name in _SPECIMEN}
    return attempt(problems, Specimen, **own, incompressible=incompressible, options=options)


def _gauges(
    places: record_options.Places, signals: dict[str, Signal], bridge: Bridge | None,
    first: int, length: float,
) -> tuple[list[BarGauge], list[BarGauge]]:
    """Gauges of the input and of the output bar, with their distances from the specimen."""
    sides: tuple[list[BarGauge], list[BarGauge]] = [], []
    for name, (body, x) in places.items():
        with naming({}, f"--gauge {name}"):  # such as a signal in no volts
            strain = signals[name] if bridge is None else bridge.strain(signals[name])
            sides[body - first].append(BarGauge(strain, length - x if body == first else x))
    return sides


def _json(found: Reduction) -> str:
    """All columns as JSON, in SI units."""
    columns = {name: signal.values.tolist() for name, signal in found.signals.items()}
    return as_json(shifts=found.shifts, time=found.times.tolist(), **columns)


def _draw(found: Reduction, path: str, force: bool) -> None:
    from .. import plot

    plot.save(plot.reduction(found).ax, path, force=force)
