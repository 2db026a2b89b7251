"""The table of validation: expected and computed numbers, and their bounds.

A case is a file of this folder with a function `run() -> Rows`. Its docstring is the
text of its page: what is compared, the equations, the bounds, and the source.
"""

import re
from collections.abc import Iterator
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np

FOLDER = Path(__file__).parent
PAGES = FOLDER.parent / "docs" / "validation"
FROM_PAGES = "../../validation"  # path from the folder of pages to this one
ROUND_OFF_RTOL = 1e-8  # a bound up to this part of a number leaves room for round-off
COLUMNS = ("case", "quantity", "source", "expected", "got", "bound")
VERDICT_COLUMNS = ("case", "source", "numbers", "share of bound", "verdict")
FIGURES = {  # figures that the page of a case shows
    "box_10_4": (
        "equal_rods",
        "unequal_rods",
        "unequal_rods_stages",
        "unequal_rods_contact",
        "unequal_rods_energy",
        "restitution",
    ),
    "damping": ("ring_down",),
    "hertz_ends": ("hertz_ends",),
    "length_effects": ("contact_episodes", "chains", "cradle"),
    "saint_venant": ("restitution_over_length", "restitution_map"),
}
INTRODUCTION = """# Validation

Here are {cases} cases with {numbers} numbers. Each number that rodimpact computes is
compared with a number from another source: a closed form, a published test problem, a
measured record, another program, or the textbook. Each difference must stay within a
bound that is given in advance. The page of a case explains the comparison, and lists
all numbers, sources and bounds.

The column `source` gives the first source of a case, and `numbers` counts its
comparisons. `share of bound` is the largest ratio of a difference to its bound, for
bounds that are wider than round-off: 100 % is the limit. Shares near 100 % belong to
bounds that were set slightly above a measured difference, such as the misfit to a
record.

`python -m validation` runs all cases and writes these pages, unless a bound is broken.
`python -m validation.figures` draws the figures, and `python -m validation.performance`
measures the speed.

"""

Number: TypeAlias = float | Fraction


class Row(NamedTuple):
    """One number: `got` must lie within `bound` of `expected`; all in one unit."""

    case: str
    quantity: str
    source: str
    expected: Number
    got: Number
    bound: float

    @property
    def difference(self) -> Number:
        """Distance of `got` from `expected`."""
        return abs(self.got - self.expected)

    @property
    def holds(self) -> bool:
        """Whether the difference is within its bound; never for nan."""
        return bool(self.difference <= self.bound)

    @property
    def allows_only_round_off(self) -> bool:
        """Whether the bound leaves room for round-off only."""
        size = abs(float(self.expected))
        return self.bound <= ROUND_OFF_RTOL * max(1.0, size)

    @property
    def decimal_places(self) -> int | None:
        """Decimal places that are shown, so few that all processors show the same.

        They are those of the bound, if it allows only round-off and is a power of ten;
        one fewer for another bound of round-off; two more for a wider bound. None means
        all places: the bound is 0.
        """
        if self.bound == 0:
            return None
        digit, exponent = f"{self.bound:.1e}".split("e")
        places = -int(exponent)
        if not self.allows_only_round_off:
            return places + 2
        if digit == "1.0":
            return places
        return places - 1

    def text_of(self, value: Number) -> str:
        """A number as the table shows it: a fraction in full, a float to its places."""
        if isinstance(value, Fraction):
            return str(value)
        number = float(value)
        places = self.decimal_places
        if places is not None:
            number = round(number, places) + 0.0  # turns -0.0 into 0.0
        return repr(number).removesuffix(".0")

    def cells(self) -> tuple[str, ...]:
        """Texts of a table line: case, quantity, source, expected, got, bound."""
        expected = self.text_of(self.expected)
        got = self.text_of(self.got)
        bound = f"{self.bound:.1e}"
        return (self.case, self.quantity, self.source, expected, got, bound)


class AtLeast(Row):
    """A number that may exceed `expected`, and fall short of it by `bound`."""

    @property
    def difference(self) -> float:
        """How much `got` falls short."""
        shortfall = self.expected - self.got
        return float(np.maximum(shortfall, 0.0))


Rows: TypeAlias = Iterator[Row]


class Case(NamedTuple):
    """What some rows have in common: the name of their case, and their source."""

    name: str
    source: str

    def row(
        self,
        quantity: str,
        expected: Number,
        got: Any,
        bound: float,
        *,
        source: str = "",
        detail: str = "",
    ) -> Row:
        """Row of one number.

        Parameters
        ----------
        quantity : str
            What is compared, with its unit.
        expected, got : float or Fraction
            The number of the source, and that of rodimpact.
        bound : float
            Largest allowed difference, in the same unit.
        source : str
            Source of this number, if it is not that of the case.
        detail : str
            What the source says, such as a formula: "source: detail".
        """
        text = source
        if not source:
            text = self.source
        if detail:
            text += f": {detail}"
        if not isinstance(got, Fraction):
            got = float(got)
        return Row(self.name, quantity, text, expected, got, bound)

    def zero(
        self,
        quantity: str,
        differences: Any,
        bound: float,
        *,
        source: str = "",
        detail: str = "",
    ) -> Row:
        """Row of the largest magnitude among differences that should be 0.

        `differences` may have either sign and any shape.
        """
        got = largest_magnitude(differences)
        return self.row(quantity, 0.0, got, bound, source=source, detail=detail)

    def at_least(self, quantity: str, expected: float, got: float, bound: float) -> Row:
        """Row of a number that may exceed `expected`, or fall short by `bound`."""
        return AtLeast(self.name, quantity, "at least", expected, got, bound)


def largest_magnitude(differences: Any) -> float:
    """Largest absolute value; nan if any of the differences is nan."""
    return float(np.max(np.abs(differences)))


def cases() -> list[str]:
    """Names of the files of this folder that are cases.

    They are those with a function `run`, without the suffix, in alphabetical order.
    """
    names = []
    for path in FOLDER.glob("*.py"):
        if "\ndef run()" in path.read_text():
            names.append(path.stem)
    return sorted(names)


def run(case: str) -> list[Row]:
    """Rows of one case, computed now."""
    module = import_module(f"{__package__}.{case}")
    return list(module.run())


def description(case: str) -> str:
    """Docstring of a case: what is compared, and the sources."""
    module = import_module(f"{__package__}.{case}")
    return (module.__doc__ or "").strip()


def title(case: str) -> str:
    """The first line of the docstring, up to a colon or full stop."""
    line = description(case).splitlines()[0]
    return re.split(r"[:.] |[:.]?$", line, maxsplit=1)[0]


def first_source(case: str) -> str:
    """The first source in the docstring, up to a comma, semicolon, colon or bracket."""
    sources = description(case).rpartition("Source:")[2]
    line = " ".join(sources.split())
    return re.split(r"[,;:(]|\.$", line)[0].strip()


def table_line(cells: tuple[str, ...]) -> str:
    """One line of a table in Markdown."""
    return "| " + " | ".join(cells) + " |\n"


def separator_line(columns: tuple[str, ...]) -> str:
    """The line of a table in Markdown below the names of its columns."""
    return "|" + "---|" * len(columns) + "\n"


def page(case: str, rows: list[Row]) -> str:
    """Text of the page of one case, `docs/validation/CASE.md`.

    It has title, docstring, link to the program, table of rows, and figures.
    """
    table = table_line(COLUMNS) + table_line(("---",) * len(COLUMNS))
    for row in rows:
        table += table_line(row.cells())
    parts = [f"# {title(case)}\n", f"{description(case)}\n"]
    parts.append(f"Program: [{case}.py]({FROM_PAGES}/{case}.py).\n")
    parts.append(table)
    for figure in FIGURES.get(case, ()):
        parts.append(f"![]({FROM_PAGES}/figures/{figure}.svg)\n")
    return "\n".join(parts)


def verdict(case: str, rows: list[Row]) -> tuple[str, ...]:
    """Cells of one case in the table of README.md, as in `VERDICT_COLUMNS`.

    One cell is the largest difference over its bound, without rows that allow only
    round-off; it is "round-off" if all rows do. The last cell is "pass" if all rows
    hold, else "fail".
    """
    shares = []
    for row in rows:
        if not row.allows_only_round_off:
            shares.append(float(row.difference) / row.bound)
    share = "round-off"
    if shares:
        share = f"{max(shares):.0%}"
    word = "fail"
    if all(row.holds for row in rows):
        word = "pass"
    link = f"[{title(case)}](../docs/validation/{case}.md)"
    return (link, first_source(case), str(len(rows)), share, word)


def verdicts(rows_by_case: dict[str, list[Row]]) -> str:
    """Text of README.md, one line a case.

    It begins with the numbers of cases and of compared values.
    """
    numbers = sum(map(len, rows_by_case.values()))
    text = INTRODUCTION.format(cases=len(rows_by_case), numbers=numbers)
    text += table_line(VERDICT_COLUMNS) + separator_line(VERDICT_COLUMNS)
    for case, rows in rows_by_case.items():
        text += table_line(verdict(case, rows))
    return text
