"""Numbers of a case that vary: the text "0.1:1:200" becomes an array.

A list or an array of values does so, too. The array lies along an axis of its own. A
number may be tied to another one that varies, by a factor: "2.5 mm*bodies.1.mass". It
has no axis of its own. A name that is no number of the case, such as R, is a variable
if another number is tied to it.
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
"""What begins the path of a number in the text of a tie."""
FORM = "start:stop:count, start:stop:count:log or a list such as 0.1,0.2,0.4"
SPACED = re.compile(
    r"(?P<start>[^:]*):(?P<stop>[^:]*):\s*(?P<count>[0-9]{1,20})\s*(?P<log>:\s*log\s*)?"
)


class Varied(NamedTuple):
    """A number of a case, or a variable, that runs through a grid.

    path : such as ``bodies.0.length``, or the name of a variable; values : array of
    shape (n,), in `unit`; unit : of SI, "" for a pure number.
    """

    path: str
    values: Floats
    unit: str


class Grid:
    """The text or the list of a grid, which stands in for the number at a path.

    Attributes
    ----------
    varied : Varied or None
        The values, once the number is read and its dimension is known.
    """

    def __init__(self, path: str, text: Any, shape: list[int]) -> None:
        """Keep the path, the text and the shape of the array of values.

        The shape is for `reshape`: -1 along the axis of this grid, 1 along the others.
        The values follow when the number is read, see `varied`.
        """
        self.path = path
        self.text = text
        self.varied: Varied | None = None
        self._shape = shape

    def array(self, dimension: str) -> Number:
        """Values of the number in SI units, along the axis of this grid.

        They are kept in `varied`, too. ValueError if the text is no grid.
        """
        values = grid_values(self.text, dimension)
        self.varied = Varied(self.path, values, units.si_unit(dimension))
        return values.reshape(self._shape)

    def along_axis(self, values: Floats) -> Number:
        """Values of a number that is tied to this one, shaped to lie along its axis."""
        return values.reshape(self._shape)

    def amounts(self) -> Varied:
        """Path, values and SI unit of the grid, by the unit of its first value.

        The dimension need not be known, as for a variable. Nothing is kept. ValueError
        if the text is no grid.
        """
        items = _listed_values(self.text)
        if isinstance(self.text, str):
            items = re.split("[:,]", self.text, maxsplit=1)
        unit = ""
        # A first value that is no text is in SI units, or is refused below.
        if items and isinstance(items[0], str):
            unit = units.read_amount(items[0]).unit
        values = grid_values(self.text, units.dimension_of(unit))
        return Varied(self.path, values, unit)


class Tie:
    """The text of a number that is tied to one that varies, and stands in for it.

    Attributes
    ----------
    path : str
    source : Grid
        Grid of the number, or of the variable, to which it is tied.
    """

    def __init__(self, path: str, text: str, source: Grid) -> None:
        """Keep the path, the text and its parts around the path of the source.

        The text must be a product with this path, as `_source_of` has found.
        """
        self.path = path
        self.source = source
        self._text = text
        self._dimension = ""  # that of the tied number, once it is read
        parts = _parts_of_tie(text, source.path)
        assert parts is not None
        self._parts = parts

    def array(self, dimension: str) -> Number:
        """Values of the tied number in SI units, along the axis of the source.

        They are the values of the source, times the factors or over the divisor of the
        text. The dimension is only kept: `wrong_unit` compares it. ValueError for a
        source or factor that cannot be read, or a divisor of 0.
        """
        self._dimension = dimension
        parts = self._parts
        values = self.source.amounts().values  # anew: the source may be read later
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
        """End of a sentence on a unit that the tied number cannot have; "" if it can.

        The source and the tied number must have been read. A variable without unit may
        stand for any quantity, as any bare number of a case. A unit with a power that
        is no number, such as N/m^p, is not checked.
        """
        assert self.source.varied is not None
        source_unit = self.source.varied.unit
        if source_unit == "" and VARIABLE.fullmatch(self.source.path):
            return ""
        wanted_unit = units.si_unit(self._dimension)
        # Powers of the symbols of a unit; `multiply_unit` changes them in place.
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
            sign = 1
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
    """Words of a sentence on a quantity: "in m/s", or "a pure number"."""
    if unit == "":
        return "a pure number"
    return f"in {unit}"


class TieParts(NamedTuple):
    """Parts of the text of a tie, factor * name operator operand.

    A part that is missing is "".
    """

    factor: str
    operator: str
    operand: str


def _parts_of_tie(text: str, name: str) -> TieParts | None:
    """Parts of a text before and after the name of another number.

    The text is "name", "factor*name", "name*operand", "name/operand", or has both, as
    "factor*name/operand". A missing part is "". None is returned for any other text.
    The parts are not converted to numbers.
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
    """Path of the number to which the text at `path` ties that number.

    `paths` are those of all numbers that vary. "" if the text is no tie; whether it is
    a grid is not checked. InvalidModel if it names a number of the case that does not
    vary.
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
    names_number = CASE_NUMBER_PATTERN.search(text) is not None
    if names_number:  # and none that varies
        hint = "vary the number to which it is tied, too"
        if other_names:
            hint = f"write FACTOR*NAME with one of {listed(other_names)}"
        message = f"is tied to nothing that varies, got {shown(text)}; {hint}"
        raise invalid_argument(path, message)
    return ""


def _check_factors(
    path: str, text: str, parts: TieParts, other_names: Collection[str]
) -> None:
    """Raise InvalidModel for a product of two numbers of the case, or two variables.

    The parts are those of the text at `path`, which ties that number to one of
    `other_names` by a factor or a divisor. Only texts that are no amounts are taken for
    names.
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
    """Whether a value in the text of a grid is no amount, and has this name in it."""
    for value in re.split("[:,]", text):
        if _names(value, name) and not units.is_amount(value):
            return True
    return False


def _names(text: str, name: str) -> bool:
    """Whether the name of a number or a variable stands in a text, as a whole word."""
    return re.search(rf"(?<![\w.]){re.escape(name)}(?![\w.])", text) is not None


def read_grids(vary: Mapping[str, ArrayLike] | None) -> dict[str, Grid | Tie]:
    """Return grids and ties by their paths, as the caller wrote them; {} for None.

    An entry of `vary` is a text, a list or an array; a text may name another path, and
    is a tie then. The k-th grid runs along axis k; a tie runs along the axis of its
    source, which must be a grid. InvalidModel is raised for anything but a mapping of
    paths, for more than `MAX_AXES` grids, or for a wrong tie. The values of the grids
    are not evaluated here.
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
    # By path: the path of the number to which it is tied, or "" for a grid
    sources = {path: _source_of(path, entries[path], entries) for path in entries}
    axes = [path for path, source in sources.items() if source == ""]
    if len(axes) > MAX_AXES:
        message = f"is one of {len(axes)} numbers; at most {MAX_AXES} vary at once"
        raise invalid_argument(axes[MAX_AXES], message)
    grids: dict[str, Grid] = {}
    for axis, path in enumerate(axes):
        shape = [1] * len(axes)  # as np.reshape takes it: the values run along `axis`
        shape[axis] = -1
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
    """Names of the grids that are variables: no numbers, and others are tied to them.

    `grids` are grids and ties by path, `numbers` the paths of all numbers that can
    vary. A name such as R is a variable; one with a dot is not.
    """
    names = set()
    for tie in grids.values():
        if isinstance(tie, Tie):
            name = tie.source.path
            if name not in numbers and VARIABLE.fullmatch(name):
                names.add(name)
    return names


def _listed_values(grid: Any) -> list[Any]:
    """Values of a list or an array in one dimension; [] for anything else."""
    values = grid
    if isinstance(grid, np.ndarray):
        values = grid.tolist()
    if isinstance(values, list | tuple):
        return list(values)
    return []


def grid_values(text: Any, dimension: str) -> Floats:
    """All values of a grid, shape (n,), in the SI unit of the dimension.

    The text is a list "a,b,c", or "start:stop:count" with both ends and equal steps,
    with ":log" equal ratios. In its place there may be a list or an array of numbers,
    or of texts with units. ValueError for anything else, for one value with different
    ends, for equal ratios from or to 0, and for ends too far apart for floats.
    """
    items = _listed_values(text)
    if 1 <= len(items) <= MOST_MEMBERS:
        return np.array([units.parse(item, dimension) for item in items])
    if isinstance(text, str) and ":" not in text:  # a list
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
    with np.errstate(all="ignore"):
        if has_equal_ratios:
            values = np.geomspace(start, stop, count)
        else:
            values = np.linspace(start, stop, count)
    if not np.isfinite(values).all():
        raise ValueError(f"the ends of {shown(text)} are too far apart")
    return values
