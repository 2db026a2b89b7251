"""`rodimpact formula`."""

import sys

import pytest
from case_texts import HEAD, UNEQUAL_RODS, with_area

from rodimpact.cli import main


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(UNEQUAL_RODS)
    return str(path)


def test_the_formula_of_the_box(case, capsys):
    pytest.importorskip("sympy")
    assert main(["formula", case, "--symbols", "length"]) == 0
    told = capsys.readouterr().out
    assert "l1: bodies.0.length" in told
    assert "e = l1/l2" in told
    assert "where l1 < l2" in told
    assert main(["formula", case, "--latex"]) == 0
    assert r"\begin{aligned}e &=" in capsys.readouterr().out


def test_many_conditions_are_told_by_an_option(tmp_path, capsys):
    pytest.importorskip("sympy")
    path = tmp_path / "three.toml"
    first, *others = (with_area(area).replace("0.4", length)
                      for area, length in [("1e-4", "0.4"), ("2e-4", "1.0"), ("1e-4", "0.7")])
    path.write_text(HEAD + first + "velocity = 1.0\n" + "".join(others))
    assert main(["formula", str(path)]) == 0
    short = capsys.readouterr().out
    assert "more; --conditions shows all" in short
    assert main(["formula", str(path), "--conditions"]) == 0
    told = capsys.readouterr().out
    assert "shows all" not in told
    assert told.count("\n  and ") > short.count("<")


def test_mistakes_are_told_in_one_line(case, capsys, monkeypatch):
    pytest.importorskip("sympy")
    assert main(["formula", case, "--symbols", "lenght"]) == 2
    assert "perhaps 'length' is meant" in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "sympy", None)
    assert main(["formula", case]) == 2
    assert capsys.readouterr().err == (
        "rodimpact: sympy is not installed; pip install 'rodimpact[sympy]' adds it\n")
