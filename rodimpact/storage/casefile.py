"""Case files: a collision written down in TOML, and every mistake in it at once.

    schema = 1
    gravity = "9.81 m/s^2"   # to the right; 0 if left out

    [[bodies]]
    kind = "rod"
    length = "400 mm"        # a number in SI units, or text with a unit
    area = 1e-4              # or a profile, or the `diameter` of a round rod
    material = "steel"       # of `rodimpact.materials`, or [materials.NAME] of the file
    velocity = 1.0           # or a profile; so is `strain`

    [[bodies]]
    kind = "mass"            # rigid
    mass = "2 kg"
    velocity = 0.0

    [[bodies]]
    kind = "wall"            # takes `velocity` only

    [[contacts]]             # entry i: between body i and i + 1; touching if left out
    gap = "50 um"
    law = "rigid"            # or another of `rodimpact.model.laws`

    [[contacts]]
    law = "spring"
    stiffness = "3 kN/mm"

    [ends.left]              # of the row; free if left out
    kind = "pushed"          # or "moved", "incoming", "fixed", "absorbing", "free"
    value = "1 kN"           # or a profile in time; for "pushed", "moved", "incoming"

    [solve]                  # until, method, max_events, dt, rtol, cells, snapshots:
                             # as for `rodimpact.solve`; all but the last for
                             # `rodimpact.sweep`, too

    [output]                 # plot, save: names of files to write

    [[gauges]]               # a strain gauge of `rodimpact explore`, `run --gauges` and
                             # `compare`
    body = 0
    fraction = 0.5           # of the rod's length, from its left end
    name = "incident"        # its column, or the channel of the record; may be left out

    [result]                 # of a saved solution: its outcome, see `SavedResult`

A law, "rigid", "bonded", "joint", "spring", "spring-dashpot", "hertz" and so on, takes
the numbers of its class, under their names; Hertz contact a stiffness, or left_radius
and right_radius.

A table [materials.NAME] has youngs_modulus or wave_speed, density, poisson_ratio and
viscosity. Instead of the viscosity it may have a loss_factor and the loss_frequency at
which that factor holds. A stepped rod has [[bodies.segments]], each with length, area
and material. Rods and segments may have a lateral_inertia, "rayleigh-love" or
"mindlin-herrmann"; without a diameter it needs a polar_moment, a number or "circular".
A mistake is reported with the path of its entry, such as `bodies.0.length`.

A profile is {values = [1.0, 0.0], at = [0.1]}, constant between jumps, or
{samples = [...]}, at equal distances from end to end. In time `at` are times, and
samples have a `step` between them.

A face of a Hertz contact is flat if its radius is left out or "inf". The face of a rod
has the material of the rod. The face of a mass or a wall is rigid, unless left_material
or right_material names its material.

Any number except samples may be varied. The grid given for its path then replaces the
entry, which may be absent, and the case becomes a family with one axis per grid. A
number that is tied to another one varies along the axis of that number.
"""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Mapping

from numpy.typing import ArrayLike

from ..hints import explain_arguments
from ..model.frozen import invalid_argument
from ..units import one_line, shown
from .case import MAX_CASE_BYTES
from .case import Case as Case
from .case import GaugePlace as GaugePlace
from .case_reading import case_from as case_from
from .case_writing import format_case as format_case
from .case_writing import write_case as write_case
from .reading import open_regular
from .writing import file_name

BARE_VALUE = re.compile(
    r"""(?<=[=,[{])\s*(?P<value>[^\s"'\[\]{},#=][^"'\[\]{},#=]*)(?=[,\]}#]|$)"""
)
"""A value in a line of a case file that is not text, a list or a table.

It follows one of ``= , [ {``, and a comma, a closing bracket, a comment or the end of
the line follows it.
"""


@explain_arguments
def read_case(
    path: str | os.PathLike[str], vary: Mapping[str, ArrayLike] | None = None
) -> Case:
    """Read a case file.

    Parameters
    ----------
    path : str or path
        Name of a TOML file in UTF-8.
    vary : mapping of str to str or array, optional
        Paths of numbers and the grids to vary them on, as for `parse_case`.

    Returns
    -------
    Case

    Raises
    ------
    InvalidModel
        If the file cannot be read, is not TOML, or does not describe a collision; with
        all its mistakes.

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "case.toml")
    ...     ri.write_case(path, ri.System([rod, ri.Wall()]))
    ...     case = ri.read_case(path)
    >>> float(ri.solve(case.system, **case.solve).outcome.restitution)
    1.0
    """
    name = file_name(path)
    try:
        with open_regular(name) as file:
            raw = file.read(MAX_CASE_BYTES + 1)  # one more byte shows a longer file
    except OSError as error:
        message = f"cannot be read: {error.strerror}"
        raise invalid_argument(name, message) from None
    if len(raw) > MAX_CASE_BYTES:
        raise invalid_argument(
            name, f"has more than {MAX_CASE_BYTES} bytes; is it a case file?"
        )
    try:
        text = raw.decode("utf-8-sig")  # with or without a byte order mark
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1  # lines are counted from 1
        raise invalid_argument(
            name, f"is not text in UTF-8 (at line {line}); save it as UTF-8"
        ) from None
    return parse_case(text, name, vary)


@explain_arguments
def parse_case(
    text: str, source: str = "case", vary: Mapping[str, ArrayLike] | None = None
) -> Case:
    """Read the text of a case file.

    Parameters
    ----------
    text : str
        TOML.
    source : str
        Name of the text in messages.
    vary : mapping of str to str or array, optional
        For each number to vary its path, such as ``bodies.0.length`` or
        ``materials.NAME.density``, and the text of a grid: ``start:stop:count`` for
        equal steps, ``start:stop:count:log`` for equal ratios, both with both ends, or
        a list ``a,b,c``. Each number may have a unit. A list or an array takes the
        place of a text; its numbers are in SI units. The k-th of them becomes axis k
        of the family. A number may be tied to another one that varies, ``FACTOR*PATH``
        or ``FACTOR*PATH/DIVISOR``, and has no axis of its own; factors may have units,
        too. Several numbers may be tied to a variable: a name of your own, such as
        ``R``, with a grid.

    Returns
    -------
    Case

    Raises
    ------
    InvalidModel
        With all mistakes, each with the path of its entry.

    Examples
    --------
    >>> case = parse_case('''
    ... schema = 1
    ... bodies = [
    ... {kind = "rod", length = "40 cm", area = 1e-4, material = "steel", velocity = 1},
    ... {kind = "wall"},
    ... ]
    ... ''')
    >>> case.system.bodies[0].length, case.system.gaps
    (0.4, (0.0,))
    >>> family = parse_case(format_case(case), vary={"bodies.0.length": "50 mm:1 m:20"})
    >>> family.system.shape, family.system[19].bodies[0].length
    ((20,), 1.0)
    >>> lengths = {"L": "50 mm:1 m:20", "bodies.0.length": "L"}
    >>> tied = {**lengths, "bodies.0.velocity": "2 1/s*L"}
    >>> parse_case(format_case(case), vary=tied).system[19].bodies[0].velocity
    2.0
    """
    if not isinstance(source, str):
        raise invalid_argument(
            "source", f"must be the name of a case, got {shown(source)}"
        )
    if not isinstance(text, str):
        raise invalid_argument(
            source, f"must be the text of a case file, got {shown(text)}"
        )
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        # For a number of 5000 digits the message of Python ends with advice on
        # sys.set_int_max_str_digits, which is cut off.
        reason, _, _ = str(error).partition("; use sys.")
        message = f"is not valid TOML: {reason}{_hint_at_quotes(text, reason)}"
        if not source.endswith(".toml"):
            message += (
                "; a case file is TOML (a record is read by `rodimpact compare`, a "
                "table of a sweep by pandas.read_csv or a spreadsheet)"
            )
        raise invalid_argument(source, message) from None
    return case_from(data, source, vary)


def _hint_at_quotes(text: str, reason: str) -> str:
    """Hint for a value that lacks its quotes, such as 400 mm; "" for other mistakes.

    `text` is the case file, and `reason` the message of `tomllib`. The line that the
    message names is searched; "" if it names none.
    """
    line_number = re.search(r"\(at line (\d+), column \d+\)", reason)
    if line_number is None:
        return ""
    line = text.split("\n")[int(line_number[1]) - 1]  # lines are counted from 1
    for match in BARE_VALUE.finditer(line):
        value = match["value"].strip()
        try:
            # Numbers, true, false and dates need no quotes.
            tomllib.loads(f"value = {value}")
        except ValueError:
            return f'; put text in quotes, "{one_line(value)}"'
    return ""
