"""The table of validation: what each case expects, what rodimpact gets, how far apart they may be.

A case is a file of this folder with a function `run() -> Rows`.
"""

import re
from collections.abc import Iterable
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np

FOLDER = Path(__file__).parent
PAGES = FOLDER.parent / "docs" / "validation"
ROUND_OFF = 1e-8  # of a number of size 1: a bound above it is none of round-off
HEAD = ("case", "quantity", "source", "expected", "got", "bound")


class Row(NamedTuple):
    """One number: `got` must lie within `bound` of `expected`, in the unit of the quantity."""

    case: str
    quantity: str
    source: str
    expected: float | Fraction
    got: float | Fraction
    bound: float

    @property
    def difference(self) -> float | Fraction:
        """Distance of `got` from `expected`."""
        return abs(self.got - self.expected)

    @property
    def holds(self) -> bool:
        """Whether the difference is within its bound; never for nan."""
        return bool(self.difference <= self.bound)

    @property
    def tight(self) -> bool:
        """Whether the bound leaves room for round-off only."""
        return self.bound <= ROUND_OFF * max(1.0, abs(float(self.expected)))

    def cells(self) -> tuple[str, ...]:
        """Texts of one line of the table."""
        numbers = (self.shown(self.expected), self.shown(self.got))
        return (self.case, self.quantity, self.source, *numbers, f"{self.bound:.1e}")

    @property
    def places(self) -> int | None:
        """Decimal places to which numbers are shown: no digit is one that a processor decides.

        Those of a bound on round-off, rounded up to a power of ten, and two more than those of a
        wider bound; all of them where nothing may differ.
        """
        if self.bound == 0:
            return None
        digit, exponent = f"{self.bound:.1e}".split("e")
        return -int(exponent) - (digit != "1.0") if self.tight else 2 - int(exponent)

    def shown(self, value: float | Fraction) -> str:
        """A number as the table shows it: a fraction as it is, a float to its places."""
        if isinstance(value, Fraction):
            return str(value)
        places = self.places
        number = float(value) if places is None else round(float(value), places) + 0.0
        return repr(number).removesuffix(".0")


class AtLeast(Row):
    """A number that may exceed `expected`, and fall short of it by `bound`."""

    @property
    def difference(self) -> float:
        """How much `got` falls short."""
        return float(np.maximum(self.expected - self.got, 0.0))


Rows: TypeAlias = Iterable[Any]  # of rows, and of parts of a case, which are the same


class Case(NamedTuple):
    """What rows have in common: the name of their case, and their source."""

    name: str
    source: str

    def row(
        self,
        quantity: str,
        expected: float | Fraction,
        got: Any,
        bound: float,
        source: str = "",
    ) -> Row:
        """One row; a source of its own, or after a colon what of the common one it is."""
        of = source if source and source[0] != ":" else self.source + source
        got = got if isinstance(got, Fraction) else float(got)
        return Row(self.name, quantity, of, expected, got, bound)

    def zero(
        self, quantity: str, differences: Any, bound: float, source: str = ""
    ) -> Row:
        """The row of the largest of some differences, of either sign."""
        return self.row(quantity, 0.0, largest(differences), bound, source)

    def at_least(self, quantity: str, expected: float, got: float, bound: float) -> Row:
        """The row of a number that may exceed what is expected."""
        return AtLeast(self.name, quantity, "at least", expected, got, bound)


def largest(differences: Any) -> float:
    """Largest absolute value."""
    return float(np.max(np.abs(differences)))


def cases() -> list[str]:
    """Names of the files of this folder that are cases."""
    return sorted(p.stem for p in FOLDER.glob("*.py") if "\ndef run()" in p.read_text())


def run(case: str) -> list[Row]:
    """Rows of one case."""
    rows: list[Row] = []
    for part in import_module(f"{__package__}.{case}").run():
        rows += [part] if isinstance(part, Row) else part
    return rows


def told(case: str) -> str:
    """Docstring of a case: what is compared, and the sources."""
    return (import_module(f"{__package__}.{case}").__doc__ or "").strip()


def title(case: str) -> str:
    """The first line of the docstring, up to a colon or full stop."""
    return re.split(r"[:.] |[:.]?$", told(case).splitlines()[0], maxsplit=1)[0]


def source(case: str) -> str:
    """The first source that the docstring names."""
    named = " ".join(told(case).rpartition("Source:")[2].split())
    return re.split(r"[,;:(]|\.$", named)[0].strip()


def page(case: str, rows: list[Row]) -> str:
    """Text of the page of one case, which is `docs/validation/CASE.md`."""
    lines = [HEAD, ("---",) * len(HEAD), *(row.cells() for row in rows)]
    table = "".join("| " + " | ".join(cells) + " |\n" for cells in lines)
    shown = [
        f"![]({FROM_PAGES}/figures/{name}.svg)\n" for name in FIGURES.get(case, ())
    ]
    program = f"Program: [{case}.py]({FROM_PAGES}/{case}.py).\n"
    return "\n".join([f"# {title(case)}\n", f"{told(case)}\n", program, table, *shown])


def verdicts(rows: dict[str, list[Row]]) -> str:
    """Text of README.md, a line a case; rows by case."""
    lines = [
        "| case | source | numbers | share of bound | verdict |",
        "|---|---|---|---|---|",
    ]
    for case, its in rows.items():
        shares = [float(row.difference) / row.bound for row in its if not row.tight]
        share = f"{max(shares):.0%}" if shares else "round-off"
        verdict = "pass" if all(row.holds for row in its) else "fail"
        link = f"[{title(case)}](../docs/validation/{case}.md)"
        lines.append(f"| {link} | {source(case)} | {len(its)} | {share} | {verdict} |")
    count = sum(map(len, rows.values()))
    return INTRODUCTION.format(cases=len(rows), numbers=count) + "\n".join(lines) + "\n"


FROM_PAGES = "../../validation"
FIGURES = {
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

Here are {cases} cases with {numbers} numbers. Each number that rodimpact computes is compared with
one from another source: a closed form, a published test problem, a measured record, another
program, the textbook. Each difference must stay within a bound, which is given in advance. The
page of a case tells what is compared, and lists all of its numbers, sources and bounds.

`source` is the first that the page of a case names. `numbers` counts its comparisons. `share of
bound` is the largest difference over its bound, where bounds are wider than round-off: 100 % is
the limit. Shares near 100 % belong to bounds that were drawn around a measured difference, such as
the misfit to a record.

`python -m validation` runs all cases, writes these pages, and refuses to write if a bound is
broken. `python -m validation.figures` draws the pictures, `python -m validation.performance`
measures the speed.

"""
