"""Every case of validation/ within its bounds, and its README.md the table they make."""

import functools
import importlib.util
import sys
from fractions import Fraction
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent.parent / "validation"


def load_package():
    spec = importlib.util.spec_from_file_location("validation", FOLDER / "__init__.py")
    sys.modules["validation"] = importlib.util.module_from_spec(spec)
    return importlib.import_module("validation.table")


table = load_package()
CASES = table.cases()
rows_of = functools.cache(table.run)


@pytest.fixture(scope="module")
def written():
    """Lines of the table in README.md, cut into cells, by (case, quantity)."""
    lines = (FOLDER / "README.md").read_text(encoding="utf-8").splitlines()
    cells = [tuple(cell.strip() for cell in line.strip("|").split("|"))
             for line in lines if line.startswith("|")]
    assert cells.count(table.HEAD) == len(CASES)
    ruled = ("---",) * len(table.HEAD)
    return {line[:2]: line[2:] for line in cells if line not in (table.HEAD, ruled)}


def test_cases_are_found():
    assert {"box_10_4", "saint_venant", "rational_proof", "rows"} <= set(CASES)


@pytest.mark.parametrize("case", CASES)
def test_case(case, written):
    rows = rows_of(case)
    assert rows
    for row in rows:
        assert row.holds, row
        source, expected, got, bound = written[row.case, row.quantity]
        assert source == row.source
        assert float(bound) == pytest.approx(row.bound, rel=0.05)  # two digits are shown
        rounding = 0 if row.places is None else Fraction(10) ** -row.places / 2
        slack = Fraction(row.bound)  # both numbers lie within it of what is expected
        assert abs(Fraction(expected) - Fraction(row.expected)) <= slack + rounding
        assert abs(Fraction(got) - Fraction(row.got)) <= 2 * slack + rounding


def test_readme_has_no_other_lines(written):
    rows = [row for case in CASES for row in rows_of(case)]
    assert [row[:2] for row in rows] == list(written)


def test_a_broken_bound_shows():
    good = table.Row("case", "quantity", "source", 1.0, 1.0 + 1e-13, 1e-12)
    assert good.holds
    assert not good._replace(got=1.1).holds
    assert not good._replace(got=float("nan")).holds
