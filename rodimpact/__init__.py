"""Collisions of elastic rods: exact waves, unilateral contact, and the restitution that follows.

>>> import rodimpact as ri
>>> left = ri.Rod(length=0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
>>> right = ri.Rod(length=1.0, area=1e-4, material=ri.materials.steel)
>>> round(ri.collide(left, right).restitution, 12)
0.4
"""

from __future__ import annotations

from importlib import import_module

__version__ = "0.1.0"

TYPE_CHECKING = False  # without `typing`, which takes longer than all else before the first command
if TYPE_CHECKING:  # names under their own names, so that type checkers take them as public
    from typing import Any

    from . import design as design
    from . import materials as materials
    from . import plot as plot
    from . import rigid as rigid
    from . import theory as theory
    from . import units as units
    from . import waves as waves
    from .algebra.atlas import Atlas as Atlas
    from .algebra.atlas import atlas as atlas
    from .algebra.formula import ClosedForm as ClosedForm
    from .algebra.formula import closed_form as closed_form
    from .algebra.rational import Exact as Exact
    from .algebra.rational import exact as exact
    from .derivatives.gradients import gradient as gradient
    from .derivatives.result import Gradient as Gradient
    from .derivatives.result import Kink as Kink
    from .explorer.exploring import Page as Page
    from .explorer.exploring import explore as explore
    from .fitting.measured import Measured as Measured
    from .fitting.result import Descent as Descent
    from .fitting.result import Fit as Fit
    from .fitting.result import Fitted as Fitted
    from .fitting.searching import fit as fit
    from .methods.compiling import DamagedCache as DamagedCache
    from .methods.duration import LongRun as LongRun
    from .methods.kernels import NoCompiler as NoCompiler
    from .methods.registry import Options as Options
    from .methods.run import ContactTally as ContactTally
    from .methods.run import Episode as Episode
    from .model import System as System
    from .model.bodies import Material as Material
    from .model.bodies import RigidMass as RigidMass
    from .model.bodies import Rod as Rod
    from .model.bodies import Segment as Segment
    from .model.bodies import Wall as Wall
    from .model.ends import Absorbing as Absorbing
    from .model.ends import Fixed as Fixed
    from .model.ends import Free as Free
    from .model.ends import Incoming as Incoming
    from .model.ends import Moved as Moved
    from .model.ends import Pushed as Pushed
    from .model.frozen import InvalidModel as InvalidModel
    from .model.laws import Bonded as Bonded
    from .model.laws import Hertz as Hertz
    from .model.laws import HuntCrossley as HuntCrossley
    from .model.laws import Joint as Joint
    from .model.laws import Law as Law
    from .model.laws import PowerLaw as PowerLaw
    from .model.laws import Rigid as Rigid
    from .model.laws import Spring as Spring
    from .model.laws import SpringDashpot as SpringDashpot
    from .model.laws import Yielding as Yielding
    from .model.profiles import Samples as Samples
    from .model.profiles import Steps as Steps
    from .records.bridge import Bridge as Bridge
    from .records.comparison import Misfit as Misfit
    from .records.comparison import Pulse as Pulse
    from .records.reading import ClippedSignal as ClippedSignal
    from .records.reading import read_signals as read_signals
    from .records.signal import Signal as Signal
    from .records.together import signals_from_xarray as signals_from_xarray
    from .records.together import signals_to_xarray as signals_to_xarray
    from .records.together import write_signals as write_signals
    from .results.contacts import ContactHistory as ContactHistory
    from .results.energy import EnergyLedger as EnergyLedger
    from .results.gauges import Gauge as Gauge
    from .results.gauges import gauges_to_csv as gauges_to_csv
    from .results.outcome import Outcome as Outcome
    from .results.outcome import UndefinedRestitution as UndefinedRestitution
    from .results.regions import Regions as Regions
    from .results.regions import regions_of as regions_of
    from .results.ring_down import RingDown as RingDown
    from .results.solution import Solution as Solution
    from .running.loading import load as load
    from .running.solving import collide as collide
    from .running.solving import solve as solve
    from .running.sweep_result import Axis as Axis
    from .running.sweep_result import SweepResult as SweepResult
    from .running.sweeping import SweepError as SweepError
    from .running.sweeping import sweep as sweep
    from .storage.casefile import Case as Case
    from .storage.casefile import parse_case as parse_case
    from .storage.casefile import read_case as read_case
    from .storage.casefile import write_case as write_case
    from .storage.checkpoint import DamagedChunks as DamagedChunks
    from .storage.dimensions import by_dimension as by_dimension
    from .storage.reading import FileFormatError as FileFormatError
    from .warming import warm as warm

_HOME = {
    "algebra.atlas": ("Atlas", "atlas"),
    "algebra.formula": ("ClosedForm", "closed_form"),
    "algebra.rational": ("Exact", "exact"),
    "model.frozen": ("InvalidModel",),
    "model.profiles": ("Samples", "Steps"),
    "model.bodies": ("Material", "RigidMass", "Rod", "Segment", "Wall"),
    "model.laws": (
        "Bonded", "Hertz", "HuntCrossley", "Joint", "Law", "PowerLaw", "Rigid", "Spring",
        "SpringDashpot", "Yielding",
    ),
    "model.ends": ("Absorbing", "Fixed", "Free", "Incoming", "Moved", "Pushed"),
    "model.system": ("System",),
    "methods.registry": ("Options",),
    "methods.duration": ("LongRun",),
    "methods.kernels": ("NoCompiler",),
    "methods.compiling": ("DamagedCache",),
    "records.bridge": ("Bridge",),
    "records.comparison": ("Misfit", "Pulse"),
    "records.reading": ("ClippedSignal", "read_signals"),
    "records.signal": ("Signal",),
    "records.together": ("signals_from_xarray", "signals_to_xarray", "write_signals"),
    "running.solving": ("collide", "solve"),
    "results.energy": ("EnergyLedger",),
    "results.gauges": ("Gauge", "gauges_to_csv"),
    "results.solution": ("Solution",),
    "methods.run": ("ContactTally", "Episode"),
    "results.contacts": ("ContactHistory",),
    "results.outcome": ("Outcome", "UndefinedRestitution"),
    "results.regions": ("Regions", "regions_of"),
    "results.ring_down": ("RingDown",),
    "running.loading": ("load",),
    "storage.checkpoint": ("DamagedChunks",),
    "storage.dimensions": ("by_dimension",),
    "storage.reading": ("FileFormatError",),
    "running.sweep_result": ("Axis", "SweepResult"),
    "running.sweeping": ("SweepError", "sweep"),
    "warming": ("warm",),
    "derivatives.gradients": ("gradient",),
    "derivatives.result": ("Gradient", "Kink"),
    "explorer.exploring": ("Page", "explore"),
    "fitting.measured": ("Measured",),
    "fitting.result": ("Descent", "Fit", "Fitted"),
    "fitting.searching": ("fit",),
    "storage.casefile": ("Case", "parse_case", "read_case", "write_case"),
}
_MODULES = ("design", "materials", "plot", "rigid", "theory", "units", "waves")
_WHERE = {name: module for module, names in _HOME.items() for name in names}

__all__ = [*sorted(_WHERE), *_MODULES]


def _in_notebook(result: Any) -> str:
    """Pictures are drawn only where they are asked for."""
    from .plot.notebook import html_of

    return html_of(result)


def __getattr__(name: str) -> Any:
    """Import a public name when it is first asked for."""
    if name in _MODULES:
        return import_module(f".{name}", __name__)
    if name in _WHERE:
        value = getattr(import_module(f".{_WHERE[name]}", __name__), name)
        from .results import notebook

        notebook.html = _in_notebook
        globals()[name] = value
        return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
