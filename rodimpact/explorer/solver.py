"""The solver inside the page: which functions become JavaScript, and on which clock.

JavaScript has whole numbers below 2^53 only, so the page's clock ends at 2^52 ticks,
Python's at 2^62. Transit times still have fine ticks, since the first clock of a run
counts a small share of its horizon; a run that outlasts it is made again on a coarser
clock.
"""

import functools
from time import monotonic

from ..methods.record_lists import blank
from ..model.numbering import body_numbers, contact_names
from ..model.profiles import Steps, extremes
from ..units import format_factor, format_si
from .javascript import javascript
from .reason import spells_of, value_at
from .solved import restitution_of_case, scene_of
from .tables import lacking, mistakes
from .texts import format_quantity, name_of

CONSTANTS = {
    "CLOCK_BITS": 52,
    "NEVER": 1 << 52,
    "IDLE": (1 << 53) - 1,
    "MIN_UNIT": 2.0**34,
    "MAX_PARTS": 1 << 32,
    "FIRST_HORIZON_SHARE": 2.0**-7,
}
"""Constants of the kernels on the page's clock."""
FUNCTIONS = (
    lacking,
    mistakes,
    scene_of,
    restitution_of_case,
    body_numbers,
    contact_names,
    name_of,
    spells_of,
    value_at,
)
"""Functions that the page calls."""
PROVIDED = {
    format_si: "inSi",
    format_quantity: "inSi",
    format_factor: "plainNumber",
    blank: "py.blank",
    extremes: "py.extremes",
    Steps: "py.steps",
    monotonic: "py.monotonic",
}
"""Functions that the page has in its own way, by their names there."""


@functools.cache
def script() -> str:
    """The solver as a script of the page: the object `solver` with `FUNCTIONS`.

    It is translated from Python once and kept.
    """
    names = ", ".join(function.__name__ for function in FUNCTIONS)
    text = javascript(FUNCTIONS, CONSTANTS, PROVIDED)
    return (
        '"use strict";\n// Translated from Python by rodimpact; see page/solver.js.\n'
        f"const solver = (() => {{\n{text}\nreturn {{ {names} }};\n"
        "})();\n"
    )
