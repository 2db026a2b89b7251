"""Largest and smallest of some numbers; the page has this as JavaScript.

In a family numbers are arrays, so nothing here is decided by one of them.
"""

from __future__ import annotations

from typing import Any

import numpy as np


def largest(values: Any) -> Any:
    """Largest of some numbers, for each member of a family."""
    found = values[0]
    for value in values[1:]:
        found = np.maximum(found, value)
    return found


def smallest(values: Any) -> Any:
    """Smallest of some numbers, for each member of a family."""
    found = values[0]
    for value in values[1:]:
        found = np.minimum(found, value)
    return found
