"""The table of validation: what each case expects, what rodimpact gets, and how far apart they are.

A case is a file of this folder with a function `run() -> list[Row]`.
"""

from __future__ import annotations

from fractions import Fraction
from importlib import import_module
from pathlib import Path
from typing import NamedTuple

FOLDER = Path(__file__).parent
HEAD = ("case", "quantity", "source", "expected", "got", "difference", "bound")


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
        numbers = (shown(self.expected), shown(self.got))
        return (self.case, self.quantity, self.source, *numbers,
                f"{float(self.difference):.1e}", f"{self.bound:.1e}")


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


def shown(value: float | Fraction) -> str:
    """A number as the table shows it: a fraction as it is, a float to 15 digits."""
    return str(value) if isinstance(value, Fraction) else f"{float(value):.15g}"


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
    for case, found in rows.items():
        first = (import_module(f"{__package__}.{case}").__doc__ or "").strip().splitlines()[0]
        lines = [HEAD, ("---",) * len(HEAD), *(row.cells() for row in found)]
        table = "".join("| " + " | ".join(cells) + " |\n" for cells in lines)
        parts.append(f"## [{case}.py]({case}.py)\n\n{first}\n\n{table}")
    figures = sorted(path.name for path in (FOLDER / "figures").glob("*.svg"))
    shown = "".join(f"- [{name}](figures/{name})\n" for name in figures)
    return "\n".join([*parts, f"## Figures\n\n{shown}"])


INTRODUCTION = """# Validation

Every line compares a number that rodimpact computes with one from elsewhere: a closed form, a
published test problem, the textbook. `difference` is absolute, in the unit of the quantity, and
`tests/test_validation.py` holds it below `bound`. The head of each file says what is compared, and
where the numbers come from.

This page is written by `python -m validation`; `python -m validation.performance` measures speed
and `python -m validation.figures` draws the pictures.
"""
