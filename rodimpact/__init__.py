"""Collisions of elastic rods: exact waves, unilateral contact, and the restitution that follows.

>>> import rodimpact as ri
>>> left = ri.Rod(length=0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
>>> right = ri.Rod(length=1.0, area=1e-4, material=ri.materials.steel)
>>> round(ri.collide(left, right).restitution, 12)
0.4
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:  # names under their own names, so that type checkers take them as public
    from . import materials as materials
    from . import plot as plot
    from . import rigid as rigid
    from . import theory as theory
    from . import units as units
    from .bodies import Material as Material
    from .bodies import RigidMass as RigidMass
    from .bodies import Rod as Rod
    from .bodies import Segment as Segment
    from .bodies import Wall as Wall
    from .casefile import Case as Case
    from .casefile import parse_case as parse_case
    from .casefile import read_case as read_case
    from .casefile import write_case as write_case
    from .contacts import ContactHistory as ContactHistory
    from .contacts import ContactTally as ContactTally
    from .contacts import Episode as Episode
    from .ends import Absorbing as Absorbing
    from .ends import Fixed as Fixed
    from .ends import Free as Free
    from .ends import Moved as Moved
    from .ends import Pushed as Pushed
    from .files import load as load
    from .frozen import InvalidModel as InvalidModel
    from .gauges import Gauge as Gauge
    from .gauges import gauges_to_csv as gauges_to_csv
    from .laws import Bonded as Bonded
    from .laws import Hertz as Hertz
    from .laws import HuntCrossley as HuntCrossley
    from .laws import PowerLaw as PowerLaw
    from .laws import Rigid as Rigid
    from .laws import Spring as Spring
    from .laws import SpringDashpot as SpringDashpot
    from .ledger import EnergyLedger as EnergyLedger
    from .model import System as System
    from .options import Options as Options
    from .outcome import Outcome as Outcome
    from .outcome import UndefinedRestitution as UndefinedRestitution
    from .profiles import Samples as Samples
    from .profiles import Steps as Steps
    from .regions import Regions as Regions
    from .regions import regions_of as regions_of
    from .ring_down import RingDown as RingDown
    from .solution import Solution as Solution
    from .solving import LongRun as LongRun
    from .solving import collide as collide
    from .solving import solve as solve
    from .sweeping import Axis as Axis
    from .sweeping import SweepError as SweepError
    from .sweeping import SweepResult as SweepResult
    from .sweeping import sweep as sweep
    from .writing import FileFormatError as FileFormatError

_HOME = {
    "frozen": ("InvalidModel",),
    "profiles": ("Samples", "Steps"),
    "bodies": ("Material", "RigidMass", "Rod", "Segment", "Wall"),
    "laws": ("Bonded", "Hertz", "HuntCrossley", "PowerLaw", "Rigid", "Spring", "SpringDashpot"),
    "ends": ("Absorbing", "Fixed", "Free", "Moved", "Pushed"),
    "model": ("System",),
    "options": ("Options",),
    "solving": ("LongRun", "collide", "solve"),
    "ledger": ("EnergyLedger",),
    "gauges": ("Gauge", "gauges_to_csv"),
    "solution": ("Solution",),
    "contacts": ("ContactHistory", "ContactTally", "Episode"),
    "outcome": ("Outcome", "UndefinedRestitution"),
    "regions": ("Regions", "regions_of"),
    "ring_down": ("RingDown",),
    "files": ("load",),
    "writing": ("FileFormatError",),
    "sweeping": ("Axis", "SweepError", "SweepResult", "sweep"),
    "casefile": ("Case", "parse_case", "read_case", "write_case"),
}
_MODULES = ("materials", "plot", "rigid", "theory", "units")
_WHERE = {name: module for module, names in _HOME.items() for name in names}

__all__ = [*sorted(_WHERE), *_MODULES]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first asked for."""
    if name in _MODULES:
        return import_module(f".{name}", __name__)
    if name in _WHERE:
        value = getattr(import_module(f".{_WHERE[name]}", __name__), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
