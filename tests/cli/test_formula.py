"""`rodimpact formula`."""

import sys

import pytest
from case_texts import HEAD, with_area

pytest.importorskip("sympy")


def test_the_formula_of_the_box_has_symbols_and_a_condition_and_is_printed_as_latex(
    case, output_of
):
    """`rodimpact formula` prints e of two rods with the symbol of each length and its
    condition, and with --latex as LaTeX.
    """
    text = output_of("formula", str(case), "--symbols", "length")
    latex = output_of("formula", str(case), "--latex")
    for line in ("l1: bodies.0.length", "e = l1/l2", "where l1 < l2"):
        assert line in text
    assert r"\begin{aligned}e &=" in latex


def test_all_conditions_are_told_by_an_option_only(case, output_of):
    """The formula of three rods is printed short, with a note on --conditions, or in
    full, with a line for each condition.
    """
    struck = with_area("2e-4").replace("0.4", "1.0")
    last = with_area("1e-4").replace("0.4", "0.7")
    striker = with_area("1e-4") + "velocity = 1.0\n"
    case.write_text(HEAD + striker + struck + last)

    short = output_of("formula", str(case), "--symbols", "length")
    full = output_of("formula", str(case), "--symbols", "length", "--conditions")

    assert "more; --conditions shows all" in short
    assert "shows all" not in full
    # In full each condition but the first has a line.
    assert full.count("\n  and ") > short.count("<")


def test_a_symbol_that_names_no_number_is_refused(case, refuses):
    message = "rodimpact: --symbols: 'lenght' names no number"
    error = refuses(["formula", str(case), "--symbols", "lenght"], message)
    assert error.count("\n") == 1


def test_a_missing_package_names_its_extra(case, refuses, monkeypatch):
    monkeypatch.setitem(sys.modules, "sympy", None)
    assert refuses(["formula", str(case)]) == (
        "rodimpact: sympy is not installed; pip install 'rodimpact[sympy]' adds it\n"
    )
