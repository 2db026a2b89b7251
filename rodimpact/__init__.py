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

if TYPE_CHECKING:
    from . import materials, plot, rigid, theory, units
    from .casefile import Case, parse_case, read_case, write_case
    from .contacts import ContactHistory, Episode
    from .files import FileFormatError, load
    from .frozen import InvalidModel
    from .model import Bonded, Material, Rigid, Rod, Segment, Steps, System, Wall
    from .outcome import Outcome, UndefinedRestitution
    from .regions import Regions, regions_of
    from .solution import EnergyLedger, Gauge, Solution
    from .solving import collide, solve

_HOME = {
    "frozen": ("InvalidModel",),
    "model": ("Bonded", "Material", "Rigid", "Rod", "Segment", "Steps", "System",
              "Wall"),
    "solving": ("collide", "solve"),
    "solution": ("EnergyLedger", "Gauge", "Solution"),
    "contacts": ("ContactHistory", "Episode"),
    "outcome": ("Outcome", "UndefinedRestitution"),
    "regions": ("Regions", "regions_of"),
    "files": ("FileFormatError", "load"),
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
    return sorted([*globals(), *__all__])
