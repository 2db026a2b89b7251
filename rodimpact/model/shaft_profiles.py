"""An amount along the shaft of a rod.

It is a number for the whole rod, or a profile per length.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import profiles
from .frozen import Number, Problems, QuantityField
from .profiles import Floats, Polynomials, ProfileLike, Samples, Steps

PROFILES = (Steps, Samples, Polynomials)


def is_profile(value: ProfileLike | ArrayLike) -> bool:
    """Whether a value is a profile along a rod, or a function that becomes one."""
    is_function = callable(value) and not isinstance(value, type)
    return is_function or isinstance(value, PROFILES)


def checked_along(
    problems: Problems,
    name: str,
    value: Any,
    field: QuantityField,
    length: Number | None,
) -> Any:
    """A value along a rod of this length, m, checked; a function becomes `Samples`.

    Mistakes of a profile are added to `problems`; the returned value is then
    meaningless. A number is returned as it is, unchecked. The length is None if it is
    unknown.
    """
    if not is_profile(value):
        return value
    profile = profiles.checked_along_rod(problems, name, value, field, length)
    if isinstance(profile, Steps):  # `checked_along_rod` does not check their signs
        for i, step in enumerate(profile.values):
            field.checked(problems, f"{name}.values.{i}", step)
    return profile


def spread(amount: Any, edges: Any, length: float) -> Floats:
    """Amount of each stretch between n + 1 neighbouring edges of a rod, shape (n,).

    A profile is the amount per length: its mean between the edges is multiplied by
    their distance. A number is the amount of the whole rod of this length, m, and is
    spread evenly over it. Neither may be a family.
    """
    per_length: Any
    if isinstance(amount, PROFILES):
        per_length = profiles.averages(amount, edges, length)
    else:
        per_length = np.full(len(edges) - 1, amount / length)
    return np.asarray(per_length * np.diff(edges))
