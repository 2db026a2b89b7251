"""Tables of a case file: they hand out entries by name, and note each mistake with its path.

What an entry should be says the `Field` of the model that it fills, so that a new field of a class
needs no line here. Where a mistake allows no value, another stands in, and reading goes on.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping
from typing import Any

from .. import units
from ..model.frozen import MOST_TOLD, REQUIRED, Field, InvalidModel, listed, nearest
from ..model.profiles import Samples, Steps
from ..units import shown
from .grids import Grids

PROFILES = {  # how a profile is written along a rod, and in time
    "length": " A profile is written {values = [...], at = [...]} or {samples = [...]};",
    "time": " A profile is written {values = [...], at = [...]} or {samples = [...], step = ...};",
}
OF_SAMPLES = {r"^values\[(\d+)\]": r"samples.\1", "^values": "samples"}
"""Keys of a table, where the model calls numbers otherwise."""


class Table:
    """One table of the file."""

    def __init__(
        self, path: str, data: dict[str, Any], grids: Grids, mistakes: dict[str, str]
    ) -> None:
        self.path, self.data, self.grids, self.mistakes = path, data, grids, mistakes
        self.asked: dict[str, None] = {}

    def where(self, key: str) -> str:
        """Path of this entry."""
        return f"{self.path}.{key}" if self.path else key

    def note(
        self, key: str, message: str, word: Any = "", choices: Collection[str] = ()
    ) -> None:
        """Note a mistake, unless this entry has one already: the second would come of the first.

        Which of the choices is near the word is looked for only if the mistake will be told.
        """
        if (path := self.where(key)) not in self.mistakes:
            if choices and len(self.mistakes) < MOST_TOLD:
                message = f"{message}; {nearest(word, choices)}"
            self.mistakes[path] = message

    def has(self, key: str) -> bool:
        """Whether the file has this entry, which it may have."""
        self.asked[key] = None
        return key in self.data

    def get(self, key: str, default: Any = None) -> Any:
        """What the file has under this key, which it may have."""
        self.asked[key] = None
        return self.data.get(key, default)

    def gives(self, key: str) -> bool:
        """Whether there is such a number, in the file or varied."""
        varied = self.grids.ask(self.where(key))
        return self.has(key) or varied

    def entries(self, kind: Any) -> dict[str, Any]:
        """What fills the fields of this class."""
        return {key: self.entry(key, field) for key, field in kind.fields.items()}

    def entry(self, key: str, field: Field) -> Any:
        """A number, an array where it is varied, a profile, or the word that may stand there."""
        if field.many:
            return self.numbers(key, field.dimension) or ()
        value = self.data.get(key)
        if field.along and isinstance(value, dict):
            return self._profile(key, field)
        if not self.gives(key):
            if field.default is not REQUIRED:
                return field.default
            known = ", ".join(units.UNITS.get(field.dimension, ()))
            hint = f" or text with one of {known}" if known else ""
            self.note(key, f"is missing; give a number in SI units{hint}")
            return math.nan
        if self.where(key) not in self.grids.texts:
            if field.word and isinstance(value, str) and value[:1].isalpha():
                return self.word(key, (field.word,))
            if "infinite" in field.sign and value in ("inf", math.inf):
                return math.inf
        return self.quantity(
            key, value, field.dimension, True, PROFILES.get(field.along, "")
        )

    def quantity(
        self, key: str, value: Any, dimension: str, vary: bool = False, hint: str = ""
    ) -> Any:
        """Value of a number or a text with unit, or the grid that varies it; nan for others."""
        path = self.where(key)
        try:
            if vary and self.grids.ask(path):
                return self.grids.take(path, dimension)
            return units.parse(value, dimension)
        except ValueError as error:
            told = (
                f'{hint} vary={{"{path}": "start:stop:count"}} varies it'
                if vary
                else ""
            )
            self.note(key, f"{error}{told if isinstance(value, list) else ''}")
            return math.nan

    def _profile(self, key: str, field: Field) -> Any:
        """`Steps` or `Samples` over a length or a time."""
        inner = self.table(key)
        if inner.has("samples"):
            apart = Samples.fields["step"]._replace(default=REQUIRED)
            step = inner.entry("step", apart) if field.along == "time" else None
            values = inner.numbers("samples", field.dimension, vary=False)
            profile = inner.make(Samples, OF_SAMPLES, values=values, step=step)
        else:
            profile = inner.make(
                Steps,
                values=inner.numbers("values", field.dimension),
                at=inner.numbers("at", field.along),
            )
        inner.close()
        return profile or 1.0

    def numbers(self, key: str, dimension: str, vary: bool = True) -> Any:
        """A list of numbers, each of which may vary or not; None for anything else."""
        given = self.get(key)
        if isinstance(given, list):
            return [
                self.quantity(f"{key}.{i}", x, dimension, vary)
                for i, x in enumerate(given)
            ]
        self.note(
            key,
            "is missing; give a list of numbers"
            if given is None
            else f"must be a list of numbers, got {shown(given)}",
        )
        return None

    def word(
        self, key: str, choices: Collection[str], default: str | None = None
    ) -> str | None:
        """One of `choices`, None where it is not."""
        value = self.get(key, default)
        if isinstance(value, str) and value in choices:
            return value
        if value is None:
            self.note(key, f"is missing; use one of {listed(list(choices))}")
        else:
            self.note(key, f"unknown {key} {shown(value)}", value, choices)
        return None

    def table(self, key: str) -> Table:
        """The table of that name, an empty one if there is none."""
        data = self.get(key, {})
        if isinstance(data, dict):
            return self.inner(key, data)
        self.note(key, f"must be a table, got {shown(data)}")
        return Table(
            self.where(key), {}, Grids(), {}
        )  # what it lacks is no further mistake

    def inner(self, key: str, data: dict[str, Any]) -> Table:
        """A table within this one."""
        return Table(self.where(key), data, self.grids, self.mistakes)

    def tables(self, key: str) -> list[Table]:
        """All tables of that name."""
        data = self.get(key, [])
        if not isinstance(data, list) or not all(
            isinstance(item, dict) for item in data
        ):
            brackets = re.sub(r"\.\d+", "", self.where(key))
            self.note(
                key, f"must be tables that each begin [[{brackets}]], got {shown(data)}"
            )
            data = []
        return [self.inner(f"{key}.{i}", item) for i, item in enumerate(data)]

    def make(
        self, kind: Any, keys: Mapping[str, str] | None = None, /, **entries: Any
    ) -> Any:
        """An object of the model; None, with its mistakes noted here, if they allow none.

        What this table calls otherwise than the model is in `keys`, by a pattern of the path.
        """
        try:
            return kind(**entries)
        except InvalidModel as error:
            for path, message in error.problems:
                for pattern, name in (keys or {}).items():
                    path = re.sub(pattern, name, path)
                self.note(path, message)
            return None

    def close(self) -> None:
        """Note every entry that nobody asked for."""
        for key in self.data:
            if key not in self.asked:
                self.note(key, "unknown key", key, self.asked)
