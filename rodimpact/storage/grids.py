"""Numbers of a case that vary: grids such as "0.1:1:200", and ties to other numbers.

A grid is a text, a list or an array; it becomes an array of values along an axis of its
own. A number may be tied to another one that varies by a factor, as in
"2.5 mm*bodies.1.mass"; it varies along the axis of that number. A name that is not a
number of the case, such as R, is a variable if a number is tied to it.
"""

import re
from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .. import units
from ..hints import listed
from ..model.frozen import MOST_MEMBERS, Number, invalid_argument
from ..model.quantities import MAX_AXES, Floats
from ..units import shown

VARIABLE = re.compile(r"[A-Za-z]\w*")
"""Name of a variable to which numbers may be tied."""
CASE_NUMBER_PATTERN = re.compile(r"\b(bodies|contacts|ends|materials|gravity)\b")
"""Words with which the path of a number of the case begins."""
FORM = "start:stop:count, start:stop:count:log or a list such as 0.1,0.2,0.4"
SPACED = re.compile(
    r"(?P<start>[^:]*):(?P<stop>[^:]*):\s*(?P<count>[0-9]{1,20})\s*(?P<log>:\s*log\s*)?"
)


class Varied(NamedTuple):
    """A number of a case, or a variable, with the values of its grid.

    path : path of the number, such as ``bodies.0.length``, or name of the variable;
    values : array of shape (n,), in `unit`; unit : SI unit, "" for a pure number.
    """

    path: str
    values: Floats
    unit: str


class Grid:
    """A grid (text, list or array), which replaces the number at a path.

    Attributes
    ----------
    path : str
    text : str, list or array
    varied : Varied or None
        The values; None until the number is read and its dimension is known.
    """

    def __init__(self, path: str, text: Any, shape: list[int]) -> None:
        """Store the path, the text, and the shape to which values are reshaped.

        The shape is -1 along the axis of this grid and 1 along all others. The values
        are not computed here, see `array`.
        """
        self.path = path
        self.text = text
        self.varied: Varied | None = None
        self._shape = shape

    def array(self, dimension: str) -> Number:
        """Values of the number in SI units, as an array along the axis of this grid.

        They are stored in `varied`, too. ValueError if the text is not a grid.
        """
        values = grid_values(self.text, dimension)
        self.varied = Varied(self.path, values, units.si_unit(dimension))
        return values.reshape(self._shape)

    def along_axis(self, values: Floats) -> Number:
        """Reshape values, (n,), of a tied number to lie along the axis of this grid."""
        return values.reshape(self._shape)

    def amounts(self) -> Varied:
        """Path, values and SI unit of the grid; its first value has the unit.

        Unlike `array`, this needs no dimension, which is unknown for a variable.
        `varied` is not changed. ValueError if the text is not a grid.
        """
        items = _listed_values(self.text)
        if isinstance(self.text, str):  # [first value, all the rest]
            items = re.split("[:,]", self.text, maxsplit=1)
        unit = ""
        # A first value that is not text is in SI units, or `grid_values` refuses it.
        if items and isinstance(items[0], str):
            unit = units.read_amount(items[0]).unit
        values = grid_values(self.text, units.dimension_of(unit))
        return Varied(self.path, values, unit)


class Tie:
    """The text that ties a number to one that varies; it replaces the number.

    Attributes
    ----------
    path : str
        Path of the tied number.
    source : Grid
        Grid of the number, or of the variable, to which it is tied.
    """

    def __init__(self, path: str, text: str, source: Grid) -> None:
        """Store the path, the source, and the parts of the text around its path.

        The text must be a product with the path of the source, as `_source_of` finds.
        """
        self.path = path
        self.source = source
        self._text = text
        self._dimension = ""  # dimension of the tied number, set when it is read
        parts = _parts_of_tie(text, source.path)
        assert parts is not None  # the text is a tie to this source
        self._parts = parts

    def array(self, dimension: str) -> Number:
        """Values of the tied number in SI units, as an array along the source's axis.

        They are the values of the source, times the factors and divided by the divisor
        of the text. The dimension is stored for `wrong_unit`, and is not checked here.
        ValueError if the source or a factor cannot be read, or if the divisor is 0.
        """
        self._dimension = dimension
        parts = self._parts
        # `source.varied` may still be None: the number of the source may be read later.
        values = self.source.amounts().values
        if parts.factor:
            values = values * units.read_amount(parts.factor).value
        if parts.operator == "*":
            values = values * units.read_amount(parts.operand).value
        elif parts.operator == "/":
            divisor = units.read_amount(parts.operand).value
            if divisor == 0:
                raise ValueError(f"divides by 0, got {shown(self._text)}")
            values = values / divisor
        return self.source.along_axis(values)

    def wrong_unit(self) -> str:
        """Message if the product has another unit than the tied number; else "".

        The source and the tied number must have been read. Two cases are not checked: a
        variable without a unit, whose values may be any quantity in SI units, and a
        unit with a power that is not a number, such as N/m^p.
        """
        assert self.source.varied is not None  # the source has been read
        source_unit = self.source.varied.unit
        if source_unit == "" and VARIABLE.fullmatch(self.source.path):
            return ""
        wanted_unit = units.si_unit(self._dimension)
        # Powers by symbol of a unit; `multiply_unit` changes these dicts in place.
        powers: dict[str, float] = {}
        wanted_powers: dict[str, float] = {}
        try:
            units.multiply_unit(powers, source_unit, 1)
            units.multiply_unit(wanted_powers, wanted_unit, 1)
        except ValueError:  # a unit such as N/m^p
            return ""
        parts = self._parts
        if parts.factor:
            factor_unit = units.read_amount(parts.factor).unit
            units.multiply_unit(powers, factor_unit, 1)
        if parts.operand:
            operand_unit = units.read_amount(parts.operand).unit
            sign = 1  # of the powers of the operand's unit; -1 for a divisor
            if parts.operator == "/":
                sign = -1
            units.multiply_unit(powers, operand_unit, sign)
        if units.in_base_units(powers) == units.in_base_units(wanted_powers):
            return ""
        return (
            f"is {_in_unit(wanted_unit)}, but {shown(self._text)} is "
            f"{_in_unit(units.written_unit(powers))}; tie it to such a quantity, or "
            "give the factor its unit, as in R/2.5mm for a stiffness"
        )


def _in_unit(unit: str) -> str:
    """Words of a message on a unit: "in m/s", or "a pure number" for ""."""
    if unit == "":
        return "a pure number"
    return f"in {unit}"


class TieParts(NamedTuple):
    """Parts of the text of a tie: "factor*name operator operand".

    The operator is "*" or "/". A missing part is "".
    """

    factor: str
    operator: str
    operand: str


def _parts_of_tie(text: str, name: str) -> TieParts | None:
    """Parts of the text of a tie before and after the name of another number.

    The text is "name", "factor*name", "name*operand", "name/operand" or a combination
    such as "factor*name/operand". A missing part is "". The parts are texts, not
    converted to numbers. The result is None for any other text.
    """
    factor = r"(?:(?P<factor>[^*]+)\*)?"  # optional
    operand = r"(?:(?P<operator>[*/])(?P<operand>.+))?"  # optional
    pattern = rf"\s*{factor}\s*{re.escape(name)}\s*{operand}"
    parts = re.fullmatch(pattern, text)
    if parts is None:
        return None
    # `re` gives None for a missing group.
    return TieParts(
        parts["factor"] or "", parts["operator"] or "", parts["operand"] or ""
    )


def _source_of(path: str, text: Any, paths: Collection[str]) -> str:
    """Path of the varying number to which a text ties the number at `path`.

    `paths` are the paths of all numbers that vary. The result is "" if the text is not
    a tie; then it may be a grid, which is not checked here. InvalidModel is raised if
    the text has a path in another way than a tie, or a path that does not vary.
    """
    if not isinstance(text, str):
        return ""
    other_names = [name for name in paths if name != path]
    for name in other_names:
        parts = _parts_of_tie(text, name)
        if parts is not None:
            _check_factors(path, text, parts, other_names)
            return name
    for name in other_names:
        if _is_formula_of(text, name):
            message = (
                f"must be a product with {name}, as FACTOR*{name} or {name}/DIVISOR, "
                f"got {shown(text)}; else compute its values and list them, and leave "
                f"out {name}"
            )
            raise invalid_argument(path, message)
    # A text that names a varying number has returned or raised above.
    names_number = CASE_NUMBER_PATTERN.search(text) is not None
    if names_number:
        hint = "vary the number to which it is tied, too"
        if other_names:
            hint = f"write FACTOR*NAME with one of {listed(other_names)}"
        message = f"is tied to nothing that varies, got {shown(text)}; {hint}"
        raise invalid_argument(path, message)
    return ""


def _check_factors(
    path: str, text: str, parts: TieParts, other_names: Collection[str]
) -> None:
    """Raise InvalidModel if a factor of a tie is itself a number or a variable.

    `parts` are those of the text at `path`, which ties this number to one of
    `other_names`. The factor and the operand must be amounts, numbers with or without a
    unit. They may not contain one of `other_names`, or the path of a number of the
    case; other texts are not checked here.
    """
    for part in (parts.factor, parts.operand):
        if part == "" or units.is_amount(part):
            continue
        for name in other_names:
            if _names(part, name):
                message = f"is a product with {name}, which varies, too"
                remedy = "tie it to one of both, and write a value for the other"
                raise invalid_argument(path, f"{message}, got {shown(text)}; {remedy}")
        if CASE_NUMBER_PATTERN.search(part) is not None:
            message = f"has {part.strip()} as a factor, which does not vary"
            remedy = "write its value in its place, such as 2mm"
            raise invalid_argument(path, f"{message}, got {shown(text)}; {remedy}")


def _is_formula_of(text: str, name: str) -> bool:
    """Whether some value in the text of a grid has this name in it, and is no amount.

    An amount is a number with or without a unit: "2 m" does not count for the name m.
    """
    for value in re.split("[:,]", text):
        if _names(value, name) and not units.is_amount(value):
            return True
    return False


def _names(text: str, name: str) -> bool:
    """Whether a text has the name of a number or a variable in it, as a whole word."""
    # Dots are part of a path: "bodies.0" is no whole word in "bodies.0.length".
    return re.search(rf"(?<![\w.]){re.escape(name)}(?![\w.])", text) is not None


def read_grids(vary: Mapping[str, ArrayLike] | None) -> dict[str, Grid | Tie]:
    """Grids and ties by the paths of `vary`; {} if `vary` is None.

    An entry of `vary` is a text, a list or an array. A text that is a product with
    another path of `vary` is a tie, and any other entry is a grid. The k-th grid varies
    along axis k; a tie varies along the axis of its source, which must be a grid.
    InvalidModel is raised if `vary` is not a mapping of paths, if it has more than
    `MAX_AXES` grids, or if a tie is wrong. Values are not computed here.
    """
    entries: Any = vary
    if vary is None:
        entries = {}
    is_valid = isinstance(entries, Mapping)
    if is_valid:
        is_valid = all(isinstance(path, str) for path in entries)
    if not is_valid:
        message = "must name numbers by their paths, each with a grid"
        raise invalid_argument("vary", f"{message}, got {shown(entries)}")
    # For each path, the path to which it is tied, or "" for a grid
    sources = {path: _source_of(path, entries[path], entries) for path in entries}
    axes = [path for path, source in sources.items() if source == ""]
    if len(axes) > MAX_AXES:
        message = f"is one of {len(axes)} numbers; at most {MAX_AXES} vary at once"
        raise invalid_argument(axes[MAX_AXES], message)  # the first one too many
    grids: dict[str, Grid] = {}
    for axis, path in enumerate(axes):
        shape = [1] * len(axes)
        shape[axis] = -1  # np.reshape puts all values along this axis
        grids[path] = Grid(path, entries[path], shape)
    by_path: dict[str, Grid | Tie] = {}
    for path, source in sources.items():
        if source == "":
            by_path[path] = grids[path]
        elif source in grids:
            by_path[path] = Tie(path, entries[path], grids[source])
        else:
            message = f"is tied to {source}, which is tied itself; tie it to a grid"
            raise invalid_argument(path, message)
    return by_path


def variables_of(grids: Mapping[str, Grid | Tie], numbers: Collection[str]) -> set[str]:
    """Names of the variables among the grids.

    A variable is a grid to which a number is tied, and whose name, such as R, has no
    dot and is not one of `numbers`, the paths of all numbers that can vary. `grids` has
    grids and ties by path.
    """
    names = set()
    for tie in grids.values():
        if isinstance(tie, Tie):
            name = tie.source.path
            if name not in numbers and VARIABLE.fullmatch(name):
                names.add(name)
    return names


def _listed_values(grid: Any) -> list[Any]:
    """Items of a list, a tuple or an array as a list; [] for any other grid."""
    values = grid
    if isinstance(grid, np.ndarray):
        values = grid.tolist()  # a number for an array of shape ()
    if isinstance(values, list | tuple):
        return list(values)
    return []


def grid_values(text: Any, dimension: str) -> Floats:
    """All values of a grid, shape (n,), in the SI unit of the dimension.

    `text` is a list such as "a,b,c"; "start:stop:count", with equal steps and both
    ends; "start:stop:count:log", with equal ratios; or a list or an array of numbers or
    of texts with units. ValueError is raised for anything else, for a count of 1 with
    different ends, for equal ratios with an end that is not > 0, and for ends too far
    apart for floats. A grid has 1 to `MOST_MEMBERS` values.
    """
    items = _listed_values(text)
    if 1 <= len(items) <= MOST_MEMBERS:
        return np.array([units.parse(item, dimension) for item in items])
    if isinstance(text, str) and ":" not in text:  # a list "a,b,c"
        return np.array([units.parse(number, dimension) for number in text.split(",")])
    spaced = None
    if isinstance(text, str):
        spaced = SPACED.fullmatch(text)
    if spaced is None or not 1 <= int(spaced["count"]) <= MOST_MEMBERS:
        message = f"must be {FORM}, with 1 to {MOST_MEMBERS} values"
        raise ValueError(f"{message}; got {shown(text)}")
    start = units.parse(spaced["start"], dimension)
    stop = units.parse(spaced["stop"], dimension)
    count = int(spaced["count"])
    has_equal_ratios = spaced["log"] is not None
    if count == 1 and start != stop:
        message = "one value cannot be at both ends; raise the count in"
        raise ValueError(f"{message} {shown(text)}")
    if has_equal_ratios and min(start, stop) <= 0:
        raise ValueError(f"needs ends above 0 for equal ratios, got {shown(text)}")
    with np.errstate(all="ignore"):  # an overflow is refused below
        if has_equal_ratios:
            values = np.geomspace(start, stop, count)
        else:
            values = np.linspace(start, stop, count)
    if not np.isfinite(values).all():
        raise ValueError(f"the ends of {shown(text)} are too far apart")
    return values
