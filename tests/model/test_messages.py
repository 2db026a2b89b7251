"""Texts of errors and of objects are short, printable, and name what is wrong."""

import pytest

import rodimpact as ri


def test_no_control_character_of_a_name_reaches_a_terminal():
    """Names may have any characters, for files keep them."""
    red = ri.Material("\x1b[31mred\u202e", youngs_modulus=2e11, density=8000)
    rod = ri.Rod(0.2, area=1e-4, material=red, velocity=1.0)
    system = ri.System([rod, ri.Wall()])
    family = ri.System([rod.replace(length=[0.1, 0.2]), ri.Wall()])
    solution = ri.solve(system)
    shown = [
        red,
        rod,
        rod.segments[0],
        system,
        solution,
        solution.outcome,
        family,
        ri.sweep(family),
        ri.Case(system),
    ]
    for value in shown:
        for text in (repr(value), str(value)):
            assert text.replace("\n", "").isprintable()


def test_messages_show_a_long_path_in_short():
    path = "long/" * 2000 + "x.toml"
    with pytest.raises(OSError, match=r"long\.\.\.") as refused:
        ri.load(path)
    assert len(str(refused.value)) < 400
    system = ri.System([ri.RigidMass(1.0), ri.Wall()], contacts=[ri.Hertz(1e9)])
    solution = ri.solve(system, 1e-6)
    with pytest.raises(OSError, match="cannot write") as refused:
        solution.save(path)
    assert len(str(refused.value)) < 400


@pytest.mark.parametrize("problems", [None, [1], [("length",)], "ab", [("a", 1)]])
def test_problems_that_are_no_pairs_of_texts_are_refused(problems):
    with pytest.raises(ri.InvalidModel, match=r"problems: must be a list of \(path, "):
        ri.InvalidModel(problems)
