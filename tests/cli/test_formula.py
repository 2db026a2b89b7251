"""`rodimpact formula`."""

import sys

import pytest
from case_texts import HEAD, with_area

pytest.importorskip("sympy")


def test_the_formula_of_the_box(case, output_of):
    text = output_of("formula", str(case), "--symbols", "length")
    for line in ("l1: bodies.0.length", "e = l1/l2", "where l1 < l2"):
        assert line in text
    assert r"\begin{aligned}e &=" in output_of("formula", str(case), "--latex")


def test_many_conditions_are_told_by_an_option(case, output_of):
    struck = with_area("2e-4").replace("0.4", "1.0")
    last = with_area("1e-4").replace("0.4", "0.7")
    striker = with_area("1e-4") + "velocity = 1.0\n"
    case.write_text(HEAD + striker + struck + last)
    short = output_of("formula", str(case))
    assert "more; --conditions shows all" in short
    text = output_of("formula", str(case), "--conditions")
    assert "shows all" not in text
    assert text.count("\n  and ") > short.count("<")


def test_mistakes_are_told_in_one_line(case, refuses, monkeypatch):
    message = "rodimpact: --symbols: 'lenght' names no number"
    refuses(["formula", str(case), "--symbols", "lenght"], message)
    monkeypatch.setitem(sys.modules, "sympy", None)
    assert refuses(["formula", str(case)]) == (
        "rodimpact: sympy is not installed; pip install 'rodimpact[sympy]' adds it\n"
    )
