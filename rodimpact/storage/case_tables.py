"""Tables of a case file: reading of their entries, with a note of every mistake.

A table has numbers, words and tables by their keys. A class of the model declares its
numbers in `fields`: unit, sign, default. A table is read according to these
declarations, so a new field or class needs no line here. A mistake is noted at its path
in the file; a number with a mistake becomes nan, and reading goes on.
"""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Collection, Mapping
from typing import Any

from .. import units
from ..hints import listed, nearest
from ..model.frozen import MOST_TOLD, REQUIRED, InvalidModel, QuantityField
from ..model.profiles import Polynomials, Samples, Steps
from ..units import shown
from .grids import Grid, Tie

PROFILE_SYNTAX = {  # part of messages: syntax of a profile, by `QuantityField.along`
    "length": " A profile is written {values = [...], at = [...]} or "
    "{samples = [...]};",
    "time": " A profile is written {values = [...], at = [...]} or "
    "{samples = [...], step = ...};",
}
KEYS_OF_SAMPLE_PATHS = {r"^values\[(\d+)\]": r"samples.\1", "^values": "samples"}
"""Paths of a profile of samples with other names in the file: pattern, replacement."""
SAMPLE_STEP = Samples.fields["step"]._replace(default=REQUIRED)
POLYNOMIAL_KEYS = {
    r"^values\[(\d+)\]": r"polynomials.\1",
    "^values": "polynomials",
}
"""Paths of a profile of polynomials with other names in the file."""
SAME_NAMES: Mapping[str, str] = {}
"""No replacement: file and model have the same names."""
MATERIAL_PLACE = "a table of the material, [materials.NAME]"
PLACE_OF_KEY = {
    "E": f"{MATERIAL_PLACE}, as youngs_modulus",
    "density": MATERIAL_PLACE,
    "poisson_ratio": MATERIAL_PLACE,
    "rho": f"{MATERIAL_PLACE}, as density",
    "shaft": "a rod, below its [[bodies]], as the table [bodies.shaft]",
    "soil": "a rod, below its [[bodies]], as the table [bodies.shaft]",
    "viscosity": MATERIAL_PLACE,
    "youngs_modulus": MATERIAL_PLACE,
}
"""Table to which a key belongs, for messages about a key in a wrong table."""
CURVE_KEYS = ("smooth", "error")
"""Keys of a profile of samples about the curve between the samples."""


@dataclasses.dataclass
class Reading:
    """State of the reading of one file, shared by all its tables.

    Attributes
    ----------
    grids : dict of str to Grid or Tie
        Grids and ties by the path of the number or the name of the variable.
    numbers : dict of str to None
        Paths of all numbers that can vary, in the order of reading; an ordered set.
    mistakes : dict of str to str
        The first mistake at each path.
    """

    grids: dict[str, Grid | Tie]
    numbers: dict[str, None] = dataclasses.field(default_factory=dict)
    mistakes: dict[str, str] = dataclasses.field(default_factory=dict)

    @property
    def axes(self) -> list[Grid]:
        """The grids in the order of their axes; ties are left out."""
        return [grid for grid in self.grids.values() if isinstance(grid, Grid)]


class Table:
    """One table of the file, with its path; the path of the whole file is ""."""

    def __init__(self, reading: Reading, path: str, data: dict[str, Any]) -> None:
        """Store the path, the entries, and the state of the reading of the file.

        `data` has the entries by key, as `tomllib` reads them. No key is known yet.
        """
        self.reading = reading
        self.path = path
        self.data = data
        # Known keys, in the order in which they were asked for; an ordered set
        self.keys: dict[str, None] = {}

    def where(self, key: str) -> str:
        """Path of an entry in the file, such as "bodies.0.length"."""
        if not self.path:
            return key
        return f"{self.path}.{key}"

    def note_mistake(
        self, key: str, message: str, word: Any = "", choices: Collection[str] = ()
    ) -> None:
        """Note a mistake at a key of this table.

        Only the first mistake of an entry is kept, since further ones follow from it.
        With `choices`, the choice nearest to `word` is added to the message, unless
        `MOST_TOLD` mistakes are noted already.
        """
        mistakes = self.reading.mistakes
        is_shown = len(mistakes) < MOST_TOLD
        # `nearest` is slow, so it is not called for messages that are not shown.
        if choices and is_shown:
            message = f"{message}; {nearest(word, choices)}"
        mistakes.setdefault(self.where(key), message)

    def has(self, key: str) -> bool:
        """Whether the table has this entry; from now on its key is known."""
        self.keys[key] = None
        return key in self.data

    def get(self, key: str, default: Any = None) -> Any:
        """Entry at this key, or the default if there is none.

        From now on the key is known.
        """
        self.keys[key] = None
        return self.data.get(key, default)

    def grid_or_tie(self, key: str) -> Grid | Tie | None:
        """The grid or the tie that replaces this number; None if there is none.

        The path of the number is noted as one that can vary.
        """
        path = self.where(key)
        self.reading.numbers[path] = None
        return self.reading.grids.get(path)

    def has_or_varies(self, key: str) -> bool:
        """Whether the file has this number, or a grid or a tie replaces it.

        Its path is noted as one that can vary, and its key is known from now on.
        """
        varying = self.grid_or_tie(key)
        return self.has(key) or varying is not None

    def given_numbers(self, kind: Any, without: Collection[str] = ()) -> dict[str, Any]:
        """Numbers of the class `kind` that are given, varied or required, by key.

        They are arguments of its constructor, in SI units, see `number`. A required
        number that is missing is noted as a mistake and is nan. Optional numbers that
        are missing are left out, and so are those that `without` names.
        """
        numbers = {}
        for key, field in kind.fields.items():
            if key in without:
                continue
            if field.many:  # a list: its items may vary, but not the list itself
                is_given = self.has(key)
            else:
                is_given = self.has_or_varies(key)
            if is_given or field.default is REQUIRED:
                numbers[key] = self.number(key, field)
        return numbers

    def number(self, key: str, field: QuantityField) -> Any:
        """Value of a number of the model, in SI units.

        It is a float, or an array if a grid or a tie replaces the entry. If `field`
        allows it, it is a list, a profile, a word or infinity. A missing or wrong entry
        is noted as a mistake. The result is then nan, or None for a wrong list or word,
        or 1 for a wrong profile.
        """
        if field.many:
            return self.number_list(key, field.dimension)
        value = self.get(key)
        # A `Grid` or a `Tie` at this path replaces the entry.
        value = self.reading.grids.get(self.where(key), value)
        may_be_profile = field.along != ""  # along a rod or in time
        if may_be_profile and isinstance(value, dict):
            return self.profile(key, field)
        if field.word and isinstance(value, str) and value[:1].isalpha():
            # A text that begins with a letter cannot be a number with a unit.
            return self.word(key, (field.word,))
        may_be_infinite = "infinite" in field.sign  # such as "positive or infinite"
        if may_be_infinite and value in ("inf", math.inf):
            return math.inf
        if value is None:
            choices = ", ".join(units.UNITS.get(field.dimension, ()))
            units_hint = ""
            if choices:
                units_hint = f" or text with one of {choices}"
            self.note_mistake(key, f"is missing; give a number in SI units{units_hint}")
            return math.nan
        profile_hint = PROFILE_SYNTAX.get(field.along, "")
        return self.quantity(key, value, field.dimension, profile_hint)

    def quantity(self, key: str, value: Any, dimension: str, hint: str = "") -> Any:
        """Convert the `value` at a key to SI units: to a float or an array.

        A float results from a number, or from a text with a unit of the dimension, such
        as "length"; an array results from a `Grid` or a `Tie`. For any other value a
        mistake is noted, and the result is nan. If the value is a list and the number
        can vary, `hint` is added to the message.
        """
        try:
            if isinstance(value, Grid | Tie):
                return value.array(dimension)
            return units.parse(value, dimension)
        except ValueError as error:
            path = self.where(key)
            message = str(error)
            # The list may be meant as a profile (`hint`), or as the values of a grid.
            can_vary = path in self.reading.numbers
            if isinstance(value, list) and can_vary:
                message += f'{hint} vary={{"{path}": "start:stop:count"}} varies it'
            self.note_mistake(key, message)
            return math.nan

    def number_list(self, key: str, dimension: str, vary: bool = True) -> Any:
        """The list at a key as floats in SI units, of a dimension such as "length".

        If `vary` is true, a grid or a tie may replace an item, which is then an array.
        An item with a mistake is nan. If the entry is missing or not a list, the result
        is None. All mistakes are noted.
        """
        values = self.get(key)
        if not isinstance(values, list):
            message = f"must be a list of numbers, got {shown(values)}"
            if values is None:
                message = "is missing; give a list of numbers"
            self.note_mistake(key, message)
            return None
        numbers = []
        for i, value in enumerate(values):
            item_key = f"{key}.{i}"
            if vary:
                varying = self.grid_or_tie(item_key)
                if varying is not None:
                    value = varying
            numbers.append(self.quantity(item_key, value, dimension))
        return numbers

    def profile(self, key: str, field: QuantityField) -> Any:
        """The profile that the table at a key describes; 1 if it has mistakes.

        It is `Samples` if the table has the entry ``samples``; else `Polynomials` if it
        has the entry ``polynomials`` and the profile is along a rod; else `Steps`.
        Mistakes are noted.
        """
        table = self.table(key)
        if table.has("samples"):
            entries = {
                "values": table.number_list("samples", field.dimension, vary=False)
            }
            if field.along == "time":
                # The step can vary (samples cannot): this call notes its path.
                table.has_or_varies("step")
                entries["step"] = table.number("step", SAMPLE_STEP)
            for name in CURVE_KEYS:  # "smooth" and "error" are passed on unchanged
                if table.has(name):
                    entries[name] = table.get(name)
            profile = table.make_or_note(Samples, KEYS_OF_SAMPLE_PATHS, **entries)
        elif table.has("polynomials") and field.along == "length":
            entries = {
                "values": table.number_list("polynomials", field.dimension, vary=False)
            }
            if table.has("at"):
                entries["at"] = table.number_list("at", field.along, vary=False)
            if table.has("error"):
                error = table.get("error")
                entries["error"] = table.quantity("error", error, field.dimension)
            profile = table.make_or_note(Polynomials, POLYNOMIAL_KEYS, **entries)
        else:
            values = table.number_list("values", field.dimension)
            jumps = table.number_list("at", field.along)
            profile = table.make_or_note(Steps, values=values, at=jumps)
        table.note_unknown_keys()
        if profile is None:
            return 1.0  # any number will do, since the file is refused
        return profile

    def word(
        self, key: str, choices: Collection[str], default: str | None = None
    ) -> str | None:
        """The word at a key, which must be one of the choices.

        If the entry is missing, it is the default. For any other entry, or if there is
        no default, a mistake is noted, and the result is None.
        """
        value = self.get(key, default)
        if isinstance(value, str) and value in choices:
            return value
        if value is None:
            self.note_mistake(key, f"is missing; use one of {listed(list(choices))}")
        else:
            self.note_mistake(key, f"unknown {key} {shown(value)}", value, choices)
        return None

    def table(self, key: str) -> Table:
        """The table at a key; an empty table if there is none.

        If the entry is not a table, a mistake is noted, and the result is an empty
        table whose own mistakes are not noted.
        """
        data = self.get(key, {})
        if isinstance(data, dict):
            return Table(self.reading, self.where(key), data)
        self.note_mistake(key, f"must be a table, got {shown(data)}")
        # Mistakes of the empty table go into another `Reading`, which is dropped.
        unseen = Reading(grids={})
        return Table(unseen, self.where(key), {})

    def tables(self, key: str) -> list[Table]:
        """All tables of the list at a key, in their order; [] if there is none.

        If the entry is not a list of tables, a mistake is noted, and the result is [].
        """
        items = self.get(key, [])
        is_valid = isinstance(items, list)
        if is_valid:
            is_valid = all(isinstance(item, dict) for item in items)
        if not is_valid:
            # A header has no index: [[bodies.segments]] for bodies.0.segments
            header = re.sub(r"\.\d+", "", self.where(key))
            message = f"must be tables that each begin [[{header}]]"
            self.note_mistake(key, f"{message}, got {shown(items)}")
            items = []
        tables = []
        for i, item in enumerate(items):
            tables.append(Table(self.reading, self.where(f"{key}.{i}"), item))
        return tables

    def read_object(self, kind: Any, **entries: Any) -> Any:
        """The object of the class `kind` that this table describes.

        Its numbers are read here; `entries` are its other arguments. The result is None
        if the object has mistakes. Mistakes and unknown keys are noted.
        """
        numbers = self.given_numbers(kind)
        numbers.update(entries)
        built = self.make_or_note(kind, **numbers)
        self.note_unknown_keys()
        return built

    def make_or_note(
        self, kind: Any, names: Mapping[str, str] = SAME_NAMES, /, **entries: Any
    ) -> Any:
        """Call `kind`, a class or a function, with the entries; return its result.

        If it raises InvalidModel, its mistakes are noted at their paths in this table,
        and the result is None. `names` has patterns of the model's paths and their
        replacements in the file, where the two have different names.
        """
        try:
            return kind(**entries)
        except InvalidModel as error:
            for path, message in error.problems:
                for pattern, name in names.items():
                    path = re.sub(pattern, name, path)
                self.note_mistake(path, message)
            return None

    def note_unknown_keys(self) -> None:
        """Note a mistake for each entry whose key is not known.

        The message names the table to which the key belongs, see `PLACE_OF_KEY`, or
        else the nearest known key.
        """
        for key in self.data:
            if key in self.keys:
                continue
            if key in PLACE_OF_KEY:
                message = f"unknown key here; it belongs to {PLACE_OF_KEY[key]}"
                self.note_mistake(key, message)
            else:
                self.note_mistake(key, "unknown key", key, self.keys)
