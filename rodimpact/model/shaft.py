"""Soil or drag along the shaft of a rod."""

from __future__ import annotations

from typing import Any, TypeAlias, get_args

from . import drag, soil
from .drag import Drag
from .frozen import Number
from .profiles import flipped, negative
from .soil import Soil

Shaft: TypeAlias = Soil | Drag
"""The resistance along a rod; not the rod itself."""
SHAFTS: dict[str, type[Shaft]] = {kind.kind: kind for kind in get_args(Shaft)}


def shaft_along_rod(shaft: Shaft, length: Number | None) -> Shaft:
    """Shaft whose profiles are checked along a rod of this length, m, and sampled.

    A function becomes `Samples`. The length is None if it is unknown. InvalidModel if a
    profile has mistakes.
    """
    if isinstance(shaft, Drag):
        return drag.drag_along_rod(shaft, length)
    return soil.soil_along_rod(shaft, length)


def mirrored(shaft: Shaft, length: Number) -> Shaft:
    """The soil or drag along a rod of this length, m, with left and right exchanged.

    Profiles are reversed. The mobilised share of soil has a direction, so it changes
    its sign; other numbers are kept.
    """
    if isinstance(shaft, Drag):
        return shaft.replace(coefficient=flipped(shaft.coefficient, length))
    # A positive share pushes the rod to the left, so the mirrored rod to the right.
    return shaft.replace(
        resistance=flipped(shaft.resistance, length),
        mobilised=negative(flipped(shaft.mobilised, length)),
    )


def shaft_from(parameters: dict[str, Any]) -> Shaft:
    """Make the soil or drag with these parameters, among them its kind.

    Without the entry "kind" it is soil. The given dictionary is not changed.
    """
    parameters = dict(parameters)
    kind = parameters.pop("kind", Soil.kind)
    return SHAFTS[kind](**parameters)
