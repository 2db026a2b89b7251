"""What a notebook shows of a result: its picture, where there is one, and its table."""

import base64
import io
import re
import subprocess
import sys

import numpy as np
import pytest
from drawing import rod
from PIL import Image

import rodimpact as ri


def picture(html):
    """The picture in it, if there is one, and the words that stand for it."""
    image = re.search(r'<img src="data:image/png;base64,([^"]+)" alt="([^"]*)"', html)
    return image and (Image.open(io.BytesIO(base64.b64decode(image[1]))), image[2])


def table(html):
    return re.search(
        r'<pre style="white-space: pre;[^>]*>(.*)</pre>$', html, re.DOTALL
    )[1]


LENGTHS = np.linspace(0.2, 1.0, 5)
FAMILIES = {
    "curve": (
        ri.System([rod(LENGTHS, 1.0), rod()]),
        "restitution over bodies.0.length",
    ),
    "map": (
        ri.System([rod(LENGTHS[:, None], 1.0), rod(area=np.array([1e-4, 2e-4]))]),
        "restitution over bodies.0.length, bodies.1.area",
    ),
    "chain": (
        ri.System([rod(LENGTHS, 1.0), rod(), rod()]),
        "velocity_after.2 over bodies.0.length",
    ),
    "three axes": (
        ri.System(
            [
                rod(LENGTHS[:, None, None], LENGTHS[:2, None]),
                rod(area=np.array([1e-4, 2e-4])),
            ]
        ),
        None,
    ),
    "one": (ri.System([rod(0.4, 1.0), rod()]), None),
}


def test_a_solution_shows_its_overview_and_its_table():
    solution = ri.solve(ri.System([rod(0.4, 1.0), rod()]))
    html = solution._repr_html_()
    shown, description = picture(html)
    assert shown.width > shown.height > 500
    assert description.startswith("2 rods, closing speed 1 m/s, restitution e = 0.4")
    assert "coefficient of restitution e              0.4" in table(html)


@pytest.mark.parametrize("name", FAMILIES)
def test_a_family_shows_a_picture_where_one_can_be_drawn_and_its_table(name):
    system, expected = FAMILIES[name]
    html = ri.sweep(system)._repr_html_()
    shown = picture(html)
    assert (shown and shown[1]) == expected
    assert "collisions" in table(html)


def test_the_table_of_a_family_has_units_and_says_where_the_rest_is():
    areas = np.linspace(1e-4, 2e-4, 30)
    text = table(ri.sweep(ri.System([rod(0.4, 1.0), rod(area=areas)]))._repr_html_())
    assert "0.0001 m^2" in text
    assert "12 of 30; to_csv writes all, save keeps them" in text


def test_who_does_without_the_public_names_sees_the_table():
    code = (
        "from rodimpact.model import Rod, System, Wall\n"
        "from rodimpact.materials import steel\n"
        "from rodimpact.running.solving import solve\n"
        "solution = solve(System([Rod(0.4, area=1e-4, material=steel, velocity=1.0), Wall()]))\n"
        "print(solution._repr_html_()[:5])"
    )
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert run.stdout == "<pre \n"


def test_every_picture_shows_its_figure():
    solution = ri.solve(ri.System([rod(0.4, 1.0), rod()]))
    for drawn in (ri.plot.contact(solution), ri.plot.restitution([0.5], [0.5])):
        shown = np.asarray(Image.open(io.BytesIO(drawn._repr_png_())).convert("L"))
        assert min(shown.shape) > 200
        assert np.ptp(shown) > 200
