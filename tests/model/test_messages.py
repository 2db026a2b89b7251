"""Texts of errors and of objects are short, printable, and name what is wrong."""

import pytest

import rodimpact as ri


def test_no_control_character_of_a_name_reaches_a_terminal():
    """Names may have any characters, for files keep them. This one turns a terminal red
    and its text to the left.
    """
    name = "\x1b[31mred\u202e"
    red = ri.Material(name, youngs_modulus=2e11, density=8000)
    rod = ri.Rod(0.2, area=1e-4, material=red, velocity=1.0)
    rods = rod.replace(length=[0.1, 0.2])
    system = ri.System([rod, ri.Wall()])
    family = ri.System([rods, ri.Wall()])
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
            in_one_line = text.replace("\n", "")
            assert in_one_line.isprintable()


LONG_PATH = "long/" * 2000 + "x.toml"


def test_the_message_of_a_long_path_that_cannot_be_read_is_short():
    with pytest.raises(OSError, match=r"long\.\.\.") as refused:
        ri.load(LONG_PATH)
    message = str(refused.value)
    assert len(message) < 400


def test_the_message_of_a_long_path_that_cannot_be_written_is_short():
    """Saving a solution at a very long path raises OSError with a message of less than
    400 characters.
    """
    bodies = [ri.RigidMass(1.0), ri.Wall()]
    system = ri.System(bodies, contacts=[ri.Hertz(1e9)])
    solution = ri.solve(system, until=1e-6)
    with pytest.raises(OSError, match="cannot write") as refused:
        solution.save(LONG_PATH)
    message = str(refused.value)
    assert len(message) < 400


@pytest.mark.parametrize("problems", [None, [1], [("length",)], "ab", [("a", 1)]])
def test_problems_that_are_no_pairs_of_texts_are_refused(problems):
    with pytest.raises(ri.InvalidModel, match=r"problems: must be a list of \(path, "):
        ri.InvalidModel(problems)
