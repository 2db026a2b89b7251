"""Parts of case files that are right, to put a mistake beside, and how to find the
mistakes.
"""

import pytest

import rodimpact as ri
from rodimpact.storage.casefile import parse_case

STEEL = ri.materials.steel
ROD = ri.Rod(0.4, area=1e-4, material=STEEL)

HEAD = "schema = 1\n"
A_ROD = '[[bodies]]\nkind = "rod"\nlength = 0.4\narea = 1e-4\nmaterial = "steel"\n'
A_WALL = '[[bodies]]\nkind = "wall"\n'
A_MASS = '[[bodies]]\nkind = "mass"\nmass = 2\n'
CONTACT = "[[contacts]]\n"
LAW = CONTACT + "law = "
LEFT = "[ends.left]\nkind = "
A_GUM = "[materials.x]\nyoungs_modulus = 1\ndensity = 1\n"


def with_area(area):
    """The text of `A_ROD` with another text as its area."""
    return A_ROD.replace("1e-4", area)


def problems(text, vary=None):
    """{path: message} of the mistakes for which a case file is refused.

    It fails if the text is a right case, or if a mistake is reported twice.
    """
    with pytest.raises(ri.InvalidModel) as caught:
        parse_case(text, vary=vary)
    paths = [path for path, _ in caught.value.problems]
    assert len(set(paths)) == len(paths), "a mistake is reported twice"
    return dict(caught.value.problems)


UNEQUAL_RODS = """\
schema = 1

[[bodies]]
kind = "rod"
length = "0.4 m"
area = "1 cm^2"
material = "steel"
velocity = 1.0

[[bodies]]
kind = "rod"
length = "1 m"
area = "1 cm^2"
material = "steel"
"""
