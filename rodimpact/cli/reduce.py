"""Stress and strain of a specimen between two bars, from the record of their gauges.

rodimpact reduce CASE.toml RECORD.csv --gauge incident=0:0.381 --gauge transmitted=1:0.381
    --length 3.2mm --diameter 6.34mm

The case file contains the two bars as neighbouring rods with their lengths; the case that planned
the shot can be used. The specimen is between the two rods. Each rod has one or two gauges. The name
of a gauge is the name of its channel in the record.
"""

import argparse
import warnings
from typing import Any

from .. import BarGauge, DoubtfulReduction, Specimen, reduce
from ..storage.tables import as_json
from . import record_options
from .asking import Given, drawn, number


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The bars, the record, the specimen, and what to write."""
    record_options.add_case_and_record(parser)
    parser.add_argument("--csv", metavar="FILE", help="write all columns over time")
    specimen = parser.add_argument_group("the specimen")
    number(specimen, "--length", "length", "length before the shot", required=True)
    number(specimen, "--diameter", "length", "diameter, if round; or give")
    number(specimen, "--area", "area", "cross-sectional area")
    number(specimen, "--youngs-modulus", "pressure", "of its elastic part")
    specimen.add_argument(
        "--incompressible",
        action="store_true",
        help="its volume is constant: add true stress and strain",
    )
    waves = parser.add_argument_group("the waves")
    waves.add_argument(
        "--compression",
        choices=("negative", "positive"),
        default="negative",
        help="sign of compressive strains in the record; default: negative",
    )
    number(
        waves,
        "--align-within",
        "time",
        "largest shift of the reflected and the transmitted wave",
        default=0.0,
    )
    record_options.add_record_options(parser)


def run(given: Given) -> tuple[str, int]:
    """Check everything, reduce, write the files, and hand back the table or JSON."""
    case = given.read_case()
    places = record_options.gauge_places(given, case)
    specimen: Any = given.attempt(
        Specimen,
        given.length,
        area=given.area,
        diameter=given.diameter,
        youngs_modulus=given.youngs_modulus,
        incompressible=given.incompressible,
    )
    first = min((body for body, _ in places.values()), default=0)
    if {body - first for body, _ in places.values()} != {0, 1}:
        given.problems.append(
            (
                "--gauge",
                f"give {record_options.FORM} for one gauge or two on "
                "each of two neighbouring rods",
            )
        )
    signals = record_options.read_record(given, places)
    given.problems += [
        (
            "--bridge",
            f"is missing; the channel {name!r} is in {signals[name].unit}, not strain",
        )
        for name in places
        if given.bridge is None and name in signals and signals[name].unit
    ]
    given.check_outputs("csv", "save", figure="save")
    bars: Any = case.system.bodies[first : first + 2]
    gauges: tuple[list[BarGauge], list[BarGauge]] = [], []
    for name, (body, x) in places.items():
        far = x if body > first else float(bars[0].length) - x
        with given.naming(f"--gauge {name}"):
            gauges[body - first].append(BarGauge(signals[name], far))
    names = dict.fromkeys(("", "input_gauges", "output_gauges"), "--gauge")
    with given.naming(names={"bars": case.path, **names}), warnings.catch_warnings():
        # the table and the JSON contain the same sentences
        warnings.simplefilter("ignore", DoubtfulReduction)
        found = reduce(
            *gauges,
            bars,
            specimen,
            compression=given.compression,
            align_within=given.align_within,
        )
    status = given.write(
        csv=found.to_csv, save=drawn(lambda plot: plot.reduction(found))
    )
    if not given.json:
        return str(found), status
    columns = {name: signal.values.tolist() for name, signal in found.signals.items()}
    text = as_json(
        shifts=found.shifts,
        doubts=list(found.doubts),
        time=found.times.tolist(),
        **columns,
    )
    return text, status
