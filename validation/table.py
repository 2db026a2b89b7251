"""The table of validation: what each case expects, what rodimpact gets, how far apart they may be.

A case is a file of this folder with a function `run() -> list[Row]`.
"""

from __future__ import annotations

from fractions import Fraction
from importlib import import_module
from pathlib import Path
from typing import NamedTuple

FOLDER = Path(__file__).parent
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
        tight = self.bound <= ROUND_OFF * max(1.0, abs(float(self.expected)))
        digit, exponent = f"{self.bound:.1e}".split("e")
        return -int(exponent) - (digit != "1.0") if tight else 2 - int(exponent)

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
        return max(0.0, float(self.expected - self.got))

    @property
    def holds(self) -> bool:
        """Whether it falls short by no more than the bound; never for nan."""
        return bool(self.got >= self.expected - self.bound)


def cases() -> list[str]:
    """Names of the files of this folder that are cases."""
    return sorted(p.stem for p in FOLDER.glob("*.py") if "\ndef run()" in p.read_text())


def run(case: str) -> list[Row]:
    """Rows of one case."""
    rows: list[Row] = import_module(f"{__package__}.{case}").run()
    return rows


def page(rows: dict[str, list[Row]]) -> str:
    """Text of README.md; rows by case."""
    parts = [INTRODUCTION]
    for case, lines_of_case in rows.items():
        first = (import_module(f"{__package__}.{case}").__doc__ or "").strip().splitlines()[0]
        lines = [HEAD, ("---",) * len(HEAD), *(row.cells() for row in lines_of_case)]
        table = "".join("| " + " | ".join(cells) + " |\n" for cells in lines)
        parts.append(f"## [{case}.py]({case}.py)\n\n{first}\n\n{table}")
    figures = sorted(path.name for path in (FOLDER / "figures").glob("*.svg"))
    shown = "".join(f"- [{name}](figures/{name})\n" for name in figures)
    return "\n".join([*parts, f"## Figures\n\n{shown}"])


INTRODUCTION = """# Validation

Every line compares a number that rodimpact computes with one from elsewhere: a closed form, a
published test problem, the textbook. They may be `bound` apart, in the unit of the quantity, which
`tests/test_validation.py` sees to; more digits than the bound gives a meaning to are not shown. The
head of each file says what is compared, and where the numbers come from.

This page is written by `python -m validation`; `python -m validation.performance` measures speed
and `python -m validation.figures` draws the pictures.
"""
