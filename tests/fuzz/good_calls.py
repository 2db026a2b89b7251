"""Good arguments for every public function, class and method of the package.

The names and the parameters come from the package. A public name without an entry in
`CALLS`, in `RETURNED` or in `LEFT_OUT` is an error, so no name escapes the tests that
spoil arguments.
"""

import functools
import inspect
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import rodimpact as ri
from rodimpact.results.saved import case_of
from rodimpact.storage.grids import Varied

STEEL = ri.materials.steel
METAL = ri.Material("metal", youngs_modulus=2e11, density=8000.0, poisson_ratio=0.3)
ROD = ri.Rod(0.2, area=1e-4, material=STEEL, velocity=1.0)
LONGER = ri.Rod(0.3, area=2e-4, material=STEEL)
BAR = ri.Rod(1.5, diameter=1e-2, material=METAL)
STRIKER = ri.Rod(0.3, diameter=1e-2, material=METAL, velocity=10.0)
PAIR = ri.System([ROD, LONGER])
SPRUNG = ri.System([ROD, LONGER], contacts=[ri.Spring(1e8)])
HERTZIAN = ri.System([ri.RigidMass(1.0, velocity=1.0), ROD], contacts=[ri.Hertz(1e9)])
FAMILY = ri.System(
    [ri.Rod([0.1, 0.2], area=1e-4, material=STEEL, velocity=1.0), ri.Wall()]
)
PILE = ri.System([ROD.replace(shaft=ri.Soil(1e5, 2e-3))])
DRIVEN = ri.System(
    [ri.RigidMass(10.0, velocity=3.0), LONGER, ri.Wall()],
    contacts=[ri.Spring(1e8), ri.SmithToe(1e5, 2e-3)],
)
VOLTS = ri.Signal(np.hanning(50), dt=1e-6, unit="V", name="bridge")
STRAIN = ri.Signal(1e-3 * np.hanning(50), dt=1e-6, name="strain")
WAVES = ri.waves.Bar(5000.0, 0.3, 0.005)
LONG_PAIR = ri.System(
    [
        ri.Rod(20.0, area=1e-4, material=STEEL, velocity=1.0),
        ri.Rod(30.0, area=2e-4, material=STEEL),
    ]
)
UNTIL = 1e-4  # s, of a short run
LONG = 1e-2  # s, of a run of long rods
CASE = """schema = 1
bodies = [{kind = "mass", mass = 1, velocity = 1}, {kind = "wall"}]
contacts = [{restitution = 0.5}]
"""
RECORD = "time_s,a_V\n" + "".join(f"{i}e-6,{i % 7}\n" for i in range(60))


# What the package returns
# -------------------------------------------------------------------------


@cache
def exact_solution():
    return ri.solve(PAIR)


@cache
def piecewise_solution():
    return ri.solve(SPRUNG, UNTIL)


@cache
def grid_solution():
    return ri.solve(PAIR, UNTIL, "finite-difference", cells=8)


@cache
def refined_solution():
    """A grid that searched for its mesh, so that it states the errors of its fields."""
    return ri.solve(PAIR, UNTIL, "finite-difference", rtol=0.1)


@cache
def soil_solution():
    return ri.solve(PILE, UNTIL, cells=8)


@cache
def bearing():
    return ri.bearing_graph(DRIVEN, [2e3], cells=4, until=LONG)


@cache
def family_result():
    return ri.sweep(FAMILY, gauges=[(0, 0.05)], times=[1e-5])


def varied_lengths():
    """The lengths that vary along the axes of `family_result`."""
    axes = family_result().axes
    return tuple(Varied(axis.name, axis.values, "m") for axis in axes)


@cache
def gauge():
    return exact_solution().gauge(0, 0.1)


@cache
def bar_gauges():
    """Strain gauges of a shot without a specimen."""
    shot = ri.solve(ri.System([STRIKER, BAR, BAR]), until=1.5e-3)
    signals = [shot.gauge(body, 0.75).signal(2e-6) for body in (1, 2)]
    return [ri.BarGauge(signal, 0.75) for signal in signals]


@cache
def calibration():
    return ri.calibrate(*bar_gauges(), BAR, striker_speed=10.0)


def bar_calibration_arguments():
    """A pulse at two distances."""
    passing = STRAIN.extended(after=1e-4)
    later = passing.propagated(1.0, BAR)
    return {"first": passing, "second": later, "distance": 1.0, "bar": BAR}


@cache
def reduction():
    """A shot at a specimen that yields."""
    law = ri.Yielding(stiffness=4e8, yield_force=15e3, hardening=2e7)
    system = ri.System([STRIKER, BAR, BAR], contacts=[ri.Rigid(), law])
    shot = ri.solve(system, until=8e-4)
    signals = [
        shot.gauge(body, x).signal(1e-6).extended(before=5e-5)
        for body, x in ((1, 0.75), (2, 0.5))
    ]
    gauges = [
        ri.BarGauge(signal, d) for signal, d in zip(signals, (0.75, 0.5), strict=True)
    ]
    return ri.reduce(*gauges, BAR, ri.Specimen(5e-3, area=5e-5), align_within=1e-5)


@cache
def reduction_gauges():
    return reduction().signals


@cache
def measured():
    record = ri.solve(LONG_PAIR, until=LONG).gauge(1, 15.0).signal(1e-4)
    return ri.Measured(record, (1, 15.0), shift=0.0, gain=1.0)


def fit_arguments():
    """Arguments of `fit` with waves so slow that until = 3 s is not long."""
    return {
        "system": LONG_PAIR,
        "measured": measured(),
        "vary": {"bodies.0.velocity": (0.5, 2.0)},
        "until": LONG,
        "starts": 1,
        "additions": {"blur": {"records.0.blur": (0.0, 1e-3)}},
    }


@cache
def fitted():
    return ri.fit(**fit_arguments())


@cache
def pulse_design():
    impedance = BAR.segments[0].impedance
    wanted = ri.Signal([5.0 * impedance, 5.0 * impedance], [0.0, 80e-6], unit="N")
    return ri.design.striker(wanted, BAR, velocity=10.0, duration=80e-6, segments=1)


@cache
def atlas():
    x = ("bodies.0.length", 0.1, 0.3)
    y = ("bodies.1.length", 0.1, 0.3)
    return ri.atlas(PAIR, x, y, most_cells=20)


@cache
def formula():
    return ri.closed_form(PAIR)


@cache
def page():
    return ri.explore(PAIR)


@cache
def gradient():
    return ri.gradient(PAIR, wrt=["bodies.0.length"])


INSTANCES: dict[str, list[Callable[[], Any]]] = {
    "Absorbing": [ri.Absorbing],
    "Addition": [lambda: fitted().additions[0]],
    "Atlas": [atlas],
    "Axis": [lambda: family_result().axes[0]],
    "BarCalibration": [lambda: ri.calibrate_bar(**bar_calibration_arguments())],
    "BarGauge": [lambda: bar_gauges()[0]],
    "CutPulses": [lambda: ri.CutPulses(*[bar_gauges()[0]] * 3)],
    "BearingGraph": [bearing],
    "BearingPoint": [lambda: bearing().points[0]],
    "Blow": [lambda: ri.blows(DRIVEN, 1, cells=4, until=UNTIL)[0]],
    "Bonded": [ri.Bonded],
    "Bridge": [lambda: ri.Bridge("quarter", gauge_factor=2.0, excitation=5.0)],
    "Calibration": [calibration],
    "Case": [lambda: ri.parse_case(CASE)],
    "ClosedForm": [formula],
    "ContactHistory": [
        lambda: exact_solution().contacts[0],
        lambda: piecewise_solution().contacts[0],
        lambda: grid_solution().contacts[0],
    ],
    "ContactTally": [lambda: exact_solution().outcome.contacts[0]],
    "Descent": [lambda: fitted().descents[0]],
    "EnergyLedger": [lambda: exact_solution().energy(0.0)],
    "Episode": [lambda: exact_solution().contacts[0].episodes[0]],
    "Exact": [lambda: ri.exact(PAIR)],
    "ExtremeStress": [lambda: exact_solution().extreme_stress(0)],
    "FieldError": [lambda: refined_solution().field_error(0.0)],
    "FileFormatError": [lambda: ri.FileFormatError("it is empty", "x.toml")],
    "Fit": [fitted],
    "Fitted": [lambda: fitted().fitted[0]],
    "Fixed": [ri.Fixed],
    "Free": [ri.Free],
    "Gauge": [gauge],
    "Gradient": [gradient],
    "Hertz": [lambda: ri.Hertz(1e9)],
    "HuntCrossley": [lambda: ri.HuntCrossley(1e9, 0.1)],
    "Incoming": [lambda: ri.Incoming(1.0)],
    "InvalidModel": [lambda: ri.InvalidModel([("length", "must be positive")])],
    "Joint": [lambda: ri.Joint(1e8)],
    "Kink": [lambda: ri.Kink(0.1, 0.2, 0.0)],
    "Law": [lambda: ri.Law(linear)],
    "Material": [
        lambda: METAL,
        lambda: ri.Material("bar", wave_speed=5e3, density=8000.0),
    ],
    "MeanCurve": [lambda: ri.mean_of_shots([reduction(), reduction()], 5)],
    "Measured": [measured],
    "Misfit": [lambda: VOLTS.misfit(VOLTS)],
    "Moved": [
        lambda: ri.Moved(1.0),
        lambda: ri.Moved(position=ri.Samples([0.0, 1e-3], step=1e-4)),
    ],
    "Options": [ri.Options],
    "Outcome": [lambda: exact_solution().outcome],
    "Page": [page],
    "Polynomials": [lambda: ri.Polynomials([[1.0, 2.0]])],
    "PowerLaw": [lambda: ri.PowerLaw(1e8, 1.5)],
    "Pulse": [VOLTS.pulse],
    "Pushed": [lambda: ri.Pushed(10.0)],
    "Reduction": [reduction],
    "Verdict": [lambda: reduction().verdict],
    "Alignment": [lambda: reduction().alignment],
    "Regions": [lambda: ri.regions_of(exact_solution())],
    "Rigid": [ri.Rigid],
    "RigidMass": [lambda: ri.RigidMass(1.0)],
    "RingDown": [lambda: exact_solution().ring_down()],
    "Rod": [lambda: ROD],
    "Samples": [lambda: ri.Samples([1.0, 2.0])],
    "Segment": [lambda: ri.Segment(0.1, 1e-4, METAL)],
    "Signal": [lambda: VOLTS],
    "Solution": [exact_solution, piecewise_solution, grid_solution, refined_solution],
    "Specimen": [lambda: ri.Specimen(5e-3, area=5e-5)],
    "SmithToe": [lambda: ri.SmithToe(1e5, 2e-3, 0.5)],
    "Soil": [lambda: ri.Soil(1e5, 2e-3, 0.1)],
    "SoilProfile": [lambda: soil_solution().soil(0, 0.0)],
    "Drag": [lambda: ri.Drag(1e3)],
    "Cushion": [lambda: ri.Cushion(1e8, 0.5)],
    "Spring": [lambda: ri.Spring(1e8)],
    "SpringDashpot": [lambda: ri.SpringDashpot(1e8, 10.0)],
    "Steps": [lambda: ri.Steps([1.0, 0.0], [0.1])],
    "StressPeak": [lambda: exact_solution().extreme_stress(0).tension],
    "SweepResult": [family_result],
    "System": [lambda: FAMILY],
    "Tabulated": [lambda: ri.Tabulated([1e-5, 1e-4], [100.0, 500.0])],
    "UndefinedRestitution": [lambda: ri.UndefinedRestitution("nothing collides")],
    "Wall": [ri.Wall],
    "Yielding": [lambda: ri.Yielding(1e8, 1e4)],
    "design.PulseDesign": [pulse_design],
    "rigid.RigidCollision": [lambda: ri.rigid.collide(1.0, 1.0, 2.0, 0.0, 0.5)],
    "rigid.StackDrop": [lambda: ri.rigid.stack_drop([2.0, 1.0], [0.5, 0.5], 1.0)],
    "theory.PairCollision": [lambda: ri.theory.saint_venant(1.0, 1.0, 2.0, 3.0)],
    "waves.Bar": [lambda: WAVES],
}
"""Instances of every public class, by name."""

ABLE = {
    "Solution.field_error": [refined_solution],
    "Solution.soil": [soil_solution],
}
"""Instances of methods that not every instance of the class in `INSTANCES` has."""

RETURNED = {
    "Addition",
    "Alignment",
    "Atlas",
    "Axis",
    "BarCalibration",
    "BearingGraph",
    "BearingPoint",
    "Blow",
    "Calibration",
    "ClosedForm",
    "ContactHistory",
    "ContactTally",
    "Descent",
    "EnergyLedger",
    "Episode",
    "Exact",
    "ExtremeStress",
    "FieldError",
    "Fit",
    "Fitted",
    "Gauge",
    "Gradient",
    "Kink",
    "MeanCurve",
    "Misfit",
    "Outcome",
    "Page",
    "Pulse",
    "Reduction",
    "Regions",
    "RingDown",
    "SoilProfile",
    "Solution",
    "StressPeak",
    "SweepResult",
    "Verdict",
    "design.PulseDesign",
    "rigid.RigidCollision",
    "rigid.StackDrop",
    "theory.PairCollision",
}
"""Classes that the package returns. Users read their attributes and do not construct
them.
"""

EXCEPTIONS = {
    "ClippedSignal", "DamagedCache", "DamagedChunks", "DoubtfulCalibration", "DoubtfulReduction",
    "NoCompiler",
    "OutcomeDiffers", "RoundedTimes", "UndefinedRestitution",
}  # fmt: skip
"""Warnings, and an error, that take any message as every exception of Python does."""
OPERATORS = {"__add__", "__sub__", "__mul__", "__truediv__", "__getitem__", "__call__"}

LEFT_OUT = {
    "warm": "takes no argument, and compiles for minutes",
    "SweepResult.restored": "takes the document of a file that was checked when it was "
    "read",
    **dict.fromkeys(EXCEPTIONS, "takes any message"),
}
"""Names without a spoilt argument, each with its reason."""


def linear(overlap, rate):
    """A contact law of the user's own."""
    return 1e8 * overlap


def field_arguments(**more):
    """Arguments of a field of a solution."""
    return {"body": 0, "x": 0.1, "t": 1e-5, **more}


PATH = {"path": "file.csv", "force": True}
PAIR_OF_RODS = {
    "impedance_1": 1.0, "transit_time_1": 1.0, "impedance_2": 2.0, "transit_time_2": 3.0
}  # fmt: skip

CALLS: dict[str, Callable[[], dict[str, Any]]] = {
    # model
    "BarGauge": lambda: {"signal": STRAIN, "distance": 0.5},
    "CutPulses": lambda: dict.fromkeys(
        ("incident", "reflected", "transmitted"), ri.BarGauge(STRAIN, 0.5)
    ),
    "Bridge": lambda: {"kind": "quarter", "gauge_factor": 2.0, "excitation": 5.0},
    "Case": lambda: {"system": PAIR},
    "FileFormatError": lambda: {"message": "it is empty"},
    "Hertz": lambda: {"stiffness": 1e9},
    "HuntCrossley": lambda: {"stiffness": 1e9, "damping": 0.1},
    "Incoming": lambda: {"value": 1.0},
    "InvalidModel": lambda: {"problems": [("length", "must be positive")]},
    "Joint": lambda: {"stiffness": 1e8},
    "Law": lambda: {"force": linear},
    "Material": lambda: {"name": "metal", "youngs_modulus": 2e11, "density": 8000.0},
    "Measured": lambda: {"signal": VOLTS, "gauge": (1, 0.5)},
    "Moved": lambda: {"value": 1.0},
    "Options": dict,
    "Polynomials": lambda: {"values": [[1.0, 2.0], [1.0, 0.0]], "at": [0.5]},
    "PowerLaw": lambda: {"stiffness": 1e8, "exponent": 1.5},
    "Pushed": lambda: {"value": 1.0},
    "Rigid": dict,
    "RigidMass": lambda: {"mass": 1.0},
    "Rod": lambda: {"length": 0.2, "area": 1e-4, "material": METAL},
    "Samples": lambda: {"values": [1.0, 2.0]},
    "Segment": lambda: {"length": 0.1, "area": 1e-4, "material": METAL},
    "Signal": lambda: {"values": [0.0, 1.0, 2.0], "dt": 1e-6},
    "Specimen": lambda: {"length": 5e-3, "area": 5e-5},
    "SmithToe": lambda: {"resistance": 1e5, "quake": 2e-3},
    "Soil": lambda: {"resistance": 1e5, "quake": 2e-3},
    "Drag": lambda: {"coefficient": 1e3},
    "Cushion": lambda: {"loading": 1e8, "restitution": 0.5},
    "Spring": lambda: {"stiffness": 1e8},
    "SpringDashpot": lambda: {"stiffness": 1e8, "damping": 10.0},
    "Steps": lambda: {"values": [1.0, 0.0], "at": [0.1]},
    "System": lambda: {"bodies": [ROD, LONGER]},
    "Tabulated": lambda: {"compression": [1e-5, 1e-4], "force": [100.0, 500.0]},
    "Wall": dict,
    "Yielding": lambda: {"stiffness": 1e8, "yield_force": 1e4},
    "waves.Bar": lambda: {"wave_speed": 5000.0, "poisson_ratio": 0.3, "radius": 0.005},
    # methods of model classes
    "Hertz.from_radii": lambda: {
        "left_radius": 0.1, "right_radius": 0.2, "left_material": METAL, "right_material": METAL
    },
    "Material.damped": lambda: {"loss_factor": 0.01, "frequency": 1e3},
    "Options.method_for": lambda: {"system": PAIR},
    "Options.run": lambda: {"method": "fronts", "system": PAIR},
    "Rod.in_steps": lambda: {"n": 3},
    "Segment.area_between": lambda: {"edges": [0.0, 0.05, 0.1]},
    "Segment.in_steps": lambda: {"n": 3},
    "Segment.polar_moments": lambda: {"areas": np.array([1e-4, 2e-4])},
    "System.__getitem__": lambda: {"index": 0},
    "System.from_dict": lambda: {"data": PAIR.to_dict()},
    **{
        f"{law}.stored": lambda: {"indentation": 1e-5}
        for law in (
            "Hertz", "HuntCrossley", "Joint", "Law", "PowerLaw", "Spring", "SpringDashpot",
            "Tabulated", "Yielding", "SmithToe", "Cushion",
        )
    },
    "Tabulated.hardened": lambda: {"force": 300.0},
    "Yielding.hardened": lambda: {"force": 2e4},
    "SmithToe.hardened": lambda: {"force": 2e4},
    "Cushion.hardened": lambda: {"force": 2e4},
    # solving
    "collide": lambda: {"left": ROD, "right": LONGER},
    "exact": lambda: {"system": PAIR},
    "gradient": lambda: {"system": PAIR, "wrt": ["bodies.0.length"]},
    "solve": lambda: {"system": SPRUNG, "until": 2e-5, "max_events": 2000},
    "sweep": lambda: {"system": FAMILY},
    "regions_of": lambda: {"solution": exact_solution()},
    # algebra
    "atlas": lambda: {
        "system": PAIR,
        "x": ("bodies.0.length", 0.1, 0.3),
        "y": ("bodies.1.length", 0.1, 0.3),
        "most_cells": 5,
    },
    "closed_form": lambda: {"system": PAIR},
    "Atlas.largest": lambda: {"most": 3},
    "Atlas.locate": lambda: {"x": 0.2, "y": 0.15},
    "Atlas.restitution": lambda: {"x": 0.2, "y": 0.15},
    "ClosedForm.at": lambda: dict(formula().values),
    "ClosedForm.holds": lambda: dict(formula().values),
    "ClosedForm.where": lambda: {"remedy": "take other values"},
    "Gradient.__getitem__": lambda: {"path": "bodies.0.length"},
    # solutions
    "ContactHistory.force": lambda: {"t": 1e-5},
    "ContactHistory.gap": lambda: {"t": 1e-5},
    "ContactHistory.impulse_until": lambda: {"t": 1e-5},
    "ContactHistory.law_at": lambda: {"t": 1e-5},
    "ContactHistory.work_until": lambda: {"t": 1e-5},
    "Gauge.signal": lambda: {"interval": 1e-6},
    "Gauge.strain_at": lambda: {"t": 1e-5},
    "Gauge.to_csv": lambda: PATH,
    "Page.open": lambda: {"browser": False},
    "Page.save": lambda: {"path": "page.html", "force": True},
    "Solution.axial_force": field_arguments,
    "Solution.displacement": field_arguments,
    "Solution.energy": lambda: {"t": 1e-5},
    "Solution.extreme_stress": lambda: {"body": 0},
    "Solution.field_error": lambda: {"t": 1e-5},
    "Solution.gauge": lambda: {"body": 0, "x": 0.1},
    "Solution.mean_velocity": lambda: {"body": 0, "t": 1e-5},
    "Solution.position": field_arguments,
    "Solution.save": lambda: {"path": "file.toml", "force": True},
    "Solution.soil": lambda: {"body": 0, "t": 1e-5},
    "Solution.strain": field_arguments,
    "Solution.stress": field_arguments,
    "Solution.system_at": lambda: {"t": 1e-5},
    "Solution.to_xarray": lambda: {"x": [0.05, 0.1], "t": [0.0, 1e-5]},
    "Solution.velocity": field_arguments,
    "SweepResult.explain": lambda: {"index": 0},
    "SweepResult.save": lambda: {"path": "file.npz", "force": True},
    "SweepResult.table": lambda: {"start": 0},
    "SweepResult.to_csv": lambda: PATH,
    "gauges_to_csv": lambda: {"gauges": {"a": gauge()}, **PATH},
    # records
    "Bridge.strain": lambda: {"volts": VOLTS},
    "Measured.prediction": lambda: {"strain": STRAIN, "system": LONG_PAIR},
    "Measured.overlapping_shifts": lambda: {"until": 1e-4, "system": LONG_PAIR},
    "Reduction.at_strain": lambda: {"strain": 0.01, "column": reduction().stress},
    "Reduction.to_csv": lambda: PATH,
    "Signal.__add__": lambda: {"other": VOLTS},
    "Signal.__mul__": lambda: {"number": 2.0},
    "Signal.__sub__": lambda: {"other": VOLTS},
    "Signal.__truediv__": lambda: {"number": 2.0},
    "Signal.as_measured": lambda: {"scale": 2.0},
    "Signal.at": lambda: {"t": 1e-5},
    "Signal.baseline": lambda: {"start": 0.0, "end": 1e-5},
    "Signal.extended": lambda: {"before": 1e-5},
    "Signal.from_xarray": lambda: {"data": VOLTS.to_xarray()},
    "Signal.low_pass": lambda: {"frequency": 1e5},
    "Signal.misfit": lambda: {"other": VOLTS},
    "Signal.propagated": lambda: {"distance": 0.1, "bar": WAVES},
    "Signal.resampled": lambda: {"dt": 2e-6},
    "Signal.shifted": lambda: {"delay": 1e-6},
    "Signal.to_csv": lambda: PATH,
    "Signal.window": lambda: {"start": 1e-5, "end": 3e-5},
    "calibrate_bar": bar_calibration_arguments,
    "calibrate": lambda: {
        "input_gauges": bar_gauges()[0], "output_gauges": bar_gauges()[1], "bars": BAR
    },
    "mean_of_shots": lambda: {"shots": [reduction(), reduction()]},
    "read_signals": lambda: {"path": "record.csv"},
    "reduce": lambda: {
        "input_gauges": bar_gauges()[0],
        "output_gauges": bar_gauges()[1],
        "bars": BAR,
        "specimen": ri.Specimen(5e-3, area=5e-5),
    },
    "signals_from_xarray": lambda: {"data": ri.signals_to_xarray({"a": VOLTS})},
    "signals_to_xarray": lambda: {"signals": {"a": VOLTS}},
    "write_signals": lambda: {"signals": {"a": VOLTS}, **PATH},
    # piles
    "bearing_graph": lambda: {
        "system": DRIVEN, "resistances": [1e5], "cells": 4, "until": UNTIL
    },
    "BearingGraph.__getitem__": lambda: {"name": "set"},
    "BearingGraph.to_csv": lambda: PATH,
    "blows": lambda: {"system": DRIVEN, "count": 1, "cells": 4, "until": UNTIL},
    "at_rest": lambda: {"system": ri.System([ROD.replace(velocity=0.0)])},
    # fitting and design
    "Fit.against": lambda: {"other": fitted()},
    "Fit.to_csv": lambda: PATH,
    "design.momentum_trap": lambda: {
        "system": ri.System([STRIKER.replace(length=30.0), BAR.replace(length=150.0)]),
        "after": 2e-2, "until": 7e-2,
    },
    "design.striker": lambda: {
        "wanted": pulse_design().wanted, "bar": BAR, "velocity": 10.0, "duration": 80e-6,
        "segments": 1,
    },
    "fit": fit_arguments,
    # files
    "explore": lambda: {"case": PAIR},
    "load": lambda: {"path": "saved.toml"},
    "parse_case": lambda: {"text": CASE},
    "read_case": lambda: {"path": "case.toml"},
    "format_case": lambda: {"case": PAIR},
    "write_case": lambda: {"path": "new.toml", "case": PAIR, "force": True},
    # figures
    "plot.animation": lambda: {"solution": exact_solution(), "frames": 2},
    "plot.atlas": lambda: {"plane": atlas()},
    "plot.bearing": lambda: {"graph": bearing()},
    "plot.comparison": lambda: {"measured": VOLTS, "predicted": VOLTS},
    "plot.contact": lambda: {"solution": exact_solution()},
    "plot.design": lambda: {"result": pulse_design()},
    "plot.energy": lambda: {"solution": exact_solution()},
    "plot.fit": lambda: {"result": fitted()},
    "plot.gauge": lambda: {"record": gauge()},
    "plot.look": lambda: {"mode": "light"},
    "plot.overview": lambda: {"solution": exact_solution()},
    "plot.reduction": lambda: {"curve": reduction()},
    "plot.restitution": lambda: {"ratios": [0.1, 0.5], "values": [0.1, 0.5]},
    "plot.save": lambda: {
        "picture": ri.plot.energy(exact_solution()), "path": "file.png", "force": True
    },
    "plot.show": lambda: {"picture": ri.plot.energy(exact_solution())},
    "plot.snapshots": lambda: {"solution": exact_solution(), "times": [1e-5]},
    "plot.spacetime": lambda: {"solution": exact_solution()},
    "plot.sweep": lambda: {
        "result": family_result(),
        "varied": varied_lengths(),
        "label": "rounded ends",
    },
    # closed forms and units
    "rigid.collide": lambda: {"m1": 1.0, "v1": 1.0, "m2": 2.0, "v2": 0.0, "restitution": 0.5},
    "rigid.reduced_mass": lambda: {"m1": 1.0, "m2": 2.0},
    "rigid.restitution_from_heights": lambda: {"drop": 1.0, "rebound": 0.5},
    "rigid.restitution_from_velocities": lambda: {
        "v1_before": 1.0, "v2_before": 0.0, "v1_after": 0.0, "v2_after": 0.5
    },
    "rigid.stack_drop": lambda: {
        "masses": [2.0, 1.0], "restitutions": [0.5, 0.5], "height": 1.0
    },
    "theory.horn_amplification": lambda: {"area_0": 1e-4, "area_1": 2e-4},
    "theory.horn_frequency": lambda: {"wave_speed": 5000.0, "wave_number": 10.0, "taper": 2.0},
    "theory.kelvin_voigt_decay": lambda: {
        "youngs_modulus": 2e11, "viscosity": 1e4, "angular_frequency": 1e4
    },
    "theory.mass_on_rod": lambda: {
        "mass": 1.0, "impedance": 2.0, "transit_time": 1.0, "speed": 1.0
    },
    "theory.rayleigh_love_speed": lambda: {
        "wave_speed": 5000.0, "poisson_ratio": 0.3, "gyration_radius": 0.01, "wave_number": 10.0
    },
    "theory.rod_on_wall": lambda: {"impedance": 2.0, "transit_time": 1.0, "speed": 1.0},
    "theory.saint_venant": lambda: PAIR_OF_RODS,
    "theory.saint_venant_force": lambda: {"time": 0.5, **PAIR_OF_RODS},
    "units.conversion": lambda: {"unit": "mm"},
    "units.format_si": lambda: {"value": 1.0, "unit": "m"},
    "units.in_si": lambda: {"values": 250.0, "unit": "us"},
    "units.parse": lambda: {"text": "1 mm", "dimension": "length"},
    "waves.Bar.delays": lambda: {"frequency": 1e4},
    "waves.Bar.group_velocity": lambda: {"frequency": 1e4},
    "waves.Bar.of": lambda: {"rod": BAR},
    "waves.Bar.phase_velocity": lambda: {"frequency": 1e4},
    "waves.Bar.wavenumber": lambda: {"frequency": 1e4},
    "waves.first_mode": lambda: {"radius_over_wavelength": 0.1, "poisson_ratio": 0.3},
    "waves.mindlin_herrmann": lambda: {"radius_over_wavelength": 0.1, "poisson_ratio": 0.3},
    "waves.rayleigh_speed": lambda: {"poisson_ratio": 0.3},
}  # fmt: skip
"""Good arguments by name: the required ones, and those without which the call would
take long.
"""


# Public names
# --------------------------------------------------------------------------------------


class Call(NamedTuple):
    """A public function, constructor or method."""

    name: str
    """``"solve"``, ``"Signal.low_pass"``, ``"theory.rod_on_wall"``."""
    parameters: tuple[str, ...]
    """Names of the parameters whose values are spoilt."""
    make: Callable[[], Callable[..., Any]]
    """Function that gives what is to be called, such as the method of an instance."""

    def arguments(self) -> dict[str, Any]:
        """Arguments with which the call answers."""
        if self.name.endswith(".replace"):
            return {}
        return dict(CALLS[self.name]())


def public_names() -> Iterator[tuple[str, Any]]:
    """Public names of the package and of its public modules, each with what it stands
    for.
    """
    for name in ri.__all__:
        public = getattr(ri, name)
        if not inspect.ismodule(public):
            yield name, public
            continue
        for part in public.__all__:
            yield f"{name}.{part}", getattr(public, part)


def public_classes() -> dict[str, type]:
    """Public classes by name."""
    return {name: public for name, public in public_names() if inspect.isclass(public)}


def methods_of(kind: type) -> list[str]:
    """Names of the public methods that a class, or a class of the package above it,
    defines.
    """
    names = set()
    for owner in kind.__mro__:
        if not owner.__module__.startswith("rodimpact"):
            continue
        for name, value in vars(owner).items():
            is_method = isinstance(value, classmethod) or inspect.isfunction(value)
            if is_method and (name[0] != "_" or name in OPERATORS):
                names.add(name)
    return sorted(names)


def properties_of(kind: type) -> list[str]:
    """Names of the public attributes that are computed when they are read."""
    names = []
    for name in dir(kind):
        value = inspect.getattr_static(kind, name)
        if name[0] != "_" and isinstance(value, property | functools.cached_property):
            names.append(name)
    return names


def parameters_of(name: str, function: Callable[..., Any]) -> tuple[str, ...]:
    """Names of the parameters whose values can be spoilt, without ``self``.

    In place of ``**keywords`` they are those of the constructor for
    ``replace(**changes)``, and those of the good call for any other function.
    """
    names = []
    for parameter in inspect.signature(function).parameters.values():
        if parameter.kind is not parameter.VAR_KEYWORD:
            names.append(parameter.name)
        elif name.endswith(".replace"):
            kind = public_classes()[name.removesuffix(".replace")]
            names.extend(inspect.signature(kind).parameters)
        else:
            good_arguments = CALLS[name]()
            names.extend(good_arguments)
    return tuple(name for name in names if name != "self")


def functions() -> Iterator[Call]:
    """Every public function and constructor that takes arguments."""
    for name, public in public_names():
        if not callable(public) or name in RETURNED or name in LEFT_OUT:
            continue
        parameters = parameters_of(name, public)
        if parameters:
            yield Call(name, parameters, lambda public=public: public)


def methods() -> Iterator[Call]:
    """Every public method that takes arguments, of every instance."""
    for name, kind in public_classes().items():
        for method in methods_of(kind):
            whole = f"{name}.{method}"
            if name in EXCEPTIONS or whole in LEFT_OUT:
                continue
            parameters = parameters_of(whole, getattr(kind, method))
            if not parameters:
                continue
            # Only some instances are able to answer some methods.
            for instance in ABLE.get(whole, INSTANCES[name]):
                make = functools.partial(method_of, instance, method)
                yield Call(whole, parameters, make)


def method_of(instance: Callable[[], Any], method: str) -> Callable[..., Any]:
    """The method of an instance that is made when it is needed."""
    return getattr(instance(), method)


def write_files(folder: Path) -> None:
    """Files that functions read."""
    (folder / "case.toml").write_text(CASE)
    (folder / "record.csv").write_text(RECORD)
    (folder / "saved.toml").write_text(ri.format_case(case_of(piecewise_solution())))
