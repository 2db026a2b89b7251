"""A small table of materials, each number with its source.

The materials are isotropic and at room temperature. A bar of the same alloy may differ
by a few per cent: measure its wave speed if this matters.

>>> round(steel.wave_speed)     # m/s
5048
"""

import sys
from types import ModuleType
from typing import Any

from .hints import nearest
from .model import Material

__all__ = [
    "acrylic",
    "aluminium",
    "brass",
    "copper",
    "glass",
    "oak",
    "steel",
    "titanium",
    "tungsten",
]

SOURCES = {
    "steel": "plain carbon steel, customary round values; tables give 195 to 212 GPa",
    "aluminium": "Kaye & Laby, Tables of Physical and Chemical Constants, aluminium: "
    "70.3 GPa, 0.345, 2698 kg/m^3",
    "brass": "Kaye & Laby, brass (70 Cu, 30 Zn): 100.6 GPa, 0.350; density 8530 kg/m^3",
    "copper": "Kaye & Laby, copper: 129.8 GPa, 0.343, 8933 kg/m^3",
    "titanium": "Ti-6Al-4V, ASM Metals Handbook: 113.8 GPa, 0.342, 4430 kg/m^3",
    "tungsten": "Kaye & Laby, tungsten: 411 GPa, 0.280, 19254 kg/m^3",
    "glass": "Kaye & Laby, crown glass: 71.3 GPa, 0.22; density 2500 kg/m^3, typical "
    "soda-lime",
    "oak": "USDA Wood Handbook (FPL-GTR-190), northern red oak at 12 % moisture, along "
    "the grain: 12.5 GPa; density 700 kg/m^3 typical; Poisson ratio not given",
    "acrylic": "PMMA, Kaye & Laby: about 3.0 GPa, 0.37, 1190 kg/m^3; viscoelastic, "
    "take as elastic with care",
}
"""Source of the numbers of each material, by its name."""

steel = Material("steel", youngs_modulus=200e9, density=7850.0, poisson_ratio=0.29)
aluminium = Material(
    "aluminium", youngs_modulus=70.3e9, density=2698.0, poisson_ratio=0.345
)
brass = Material("brass", youngs_modulus=100.6e9, density=8530.0, poisson_ratio=0.350)
copper = Material("copper", youngs_modulus=129.8e9, density=8933.0, poisson_ratio=0.343)
titanium = Material(
    "titanium", youngs_modulus=113.8e9, density=4430.0, poisson_ratio=0.342
)
tungsten = Material(
    "tungsten", youngs_modulus=411e9, density=19254.0, poisson_ratio=0.280
)
glass = Material("glass", youngs_modulus=71.3e9, density=2500.0, poisson_ratio=0.22)
oak = Material("oak", youngs_modulus=12.5e9, density=700.0)
acrylic = Material("acrylic", youngs_modulus=3.0e9, density=1190.0, poisson_ratio=0.37)

_MATERIALS = (steel, aluminium, brass, copper, titanium, tungsten, glass, oak, acrylic)
TABLE = {material.name: material for material in _MATERIALS}
"""Every material of this module, by its name."""


def __getattr__(name: str) -> Any:
    """Raise AttributeError that names the nearest material."""
    message = f"no material is called {name!r}; {nearest(name, TABLE)}"
    raise AttributeError(message, name=name)


class _Attributes(ModuleType):
    """A module whose error on ``materials["steel"]`` names ``materials.steel``."""

    def __getitem__(self, name: Any) -> Any:
        """Raise TypeError that names the attribute in place of the brackets."""
        if isinstance(name, str) and name in TABLE:
            raise TypeError(f"materials are attributes: write materials.{name}")
        raise TypeError(
            f"materials are attributes; {nearest(name, TABLE, 'materials.')}"
        )


sys.modules[__name__].__class__ = _Attributes
