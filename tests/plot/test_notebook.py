"""A notebook shows the picture of a result, if there is one, and its table."""

import base64
import io
import re
import subprocess
import sys

import numpy as np
import pytest
from drawing import rod
from exhaustive import few_of
from PIL import Image

import rodimpact as ri

PICTURE = re.compile(
    r'<img src="data:image/png;base64,(?P<data>[^"]+)" alt="(?P<description>[^"]*)"'
)
TABLE = re.compile(r'<pre style="white-space: pre;[^>]*>(.*)</pre>$', re.DOTALL)


def description(html):
    """The alternative text of the picture in an HTML text; None without a picture."""
    picture = PICTURE.search(html)
    if picture is None:
        return None
    return picture["description"]


def image(html):
    """The picture in the HTML of a result."""
    data = PICTURE.search(html)["data"]
    file = io.BytesIO(base64.b64decode(data))
    return Image.open(file)


def table(html):
    """The table in the HTML of a result, a text."""
    return TABLE.search(html)[1]


LENGTHS = np.linspace(0.2, 1.0, 5)
AREAS = np.array([1e-4, 2e-4])
CUBE = rod(LENGTHS[:, None, None], LENGTHS[:2, None])
FAMILIES = {
    "curve": ri.System([rod(LENGTHS, 1.0), rod()]),
    "map": ri.System([rod(LENGTHS[:, None], 1.0), rod(area=AREAS)]),
    "chain": ri.System([rod(LENGTHS, 1.0), rod(), rod()]),
    "three axes": ri.System([CUBE, rod(area=AREAS)]),
    "one": ri.System([rod(0.4, 1.0), rod()]),
}
DESCRIPTIONS = {
    "curve": "restitution over bodies.0.length",
    "map": "restitution over bodies.0.length, bodies.1.area",
    "chain": "velocity_after.2 over bodies.0.length",
    "three axes": None,
    "one": None,
}


@pytest.fixture(scope="module")
def solution():
    """The solution of a rod of 0.4 m that strikes one of 1 m."""
    return ri.solve(ri.System([rod(0.4, 1.0), rod()]))


@pytest.mark.exhaustive
def test_a_solution_shows_its_overview_and_its_table(solution):
    """A solution in a notebook is an image, its description, and the table of its
    outcome.
    """
    html = solution._repr_html_()

    picture = image(html)
    words = "2 rods, closing speed 1 m/s, restitution e = 0.4"
    assert picture.width > picture.height > 500
    assert description(html).startswith(words)
    assert "coefficient of restitution e              0.4" in table(html)


@pytest.mark.parametrize("name", few_of(FAMILIES, {"curve", "three axes"}))
def test_a_family_shows_a_picture_if_one_can_be_drawn_and_its_table(name):
    html = ri.sweep(FAMILIES[name])._repr_html_()

    assert description(html) == DESCRIPTIONS[name]
    assert "collisions" in table(html)


@pytest.mark.exhaustive
def test_the_table_of_a_family_has_units_and_names_the_way_to_all_rows():
    areas = np.linspace(1e-4, 2e-4, 30)
    family = ri.System([rod(0.4, 1.0), rod(area=areas)])

    html = ri.sweep(family)._repr_html_()

    text = table(html)
    assert "0.0001 m^2" in text
    assert "12 of 30; to_csv writes all, save keeps them" in text


@pytest.mark.exhaustive
def test_without_the_public_names_a_solution_shows_its_table():
    """With submodules imported alone, the HTML of a solution has no picture."""
    code = """
from rodimpact.model import Rod, System, Wall
from rodimpact.materials import steel
from rodimpact.running.solving import solve
rod = Rod(0.4, area=1e-4, material=steel, velocity=1.0)
solution = solve(System([rod, Wall()]))
print(solution._repr_html_()[:5])
"""
    command = [sys.executable, "-c", code]

    process = subprocess.run(command, capture_output=True, text=True, check=True)

    assert process.stdout == "<pre \n"


def assert_shows_its_figure(picture):
    """A notebook is given a PNG of some size that is not blank."""
    image = Image.open(io.BytesIO(picture._repr_png_()))
    pixels = np.asarray(image.convert("L"))
    assert min(pixels.shape) > 200
    assert np.ptp(pixels) > 200


@pytest.mark.exhaustive
def test_every_picture_shows_its_figure(solution):
    assert_shows_its_figure(ri.plot.contact(solution))
    assert_shows_its_figure(ri.plot.restitution([0.5], [0.5]))
