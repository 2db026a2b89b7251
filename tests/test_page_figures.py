"""Figures of the tutorials are what the cells above them show."""

import importlib.util
import itertools
import re
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np
import pytest
from exhaustive import few_of

import rodimpact as ri

ROOT = Path(__file__).parents[1]
SPEC = importlib.util.spec_from_file_location(
    "page_figures", ROOT / "docs" / "page_figures.py"
)
page_figures = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(page_figures)
NUMBER = re.compile(r"-?\d+\.?\d*")
MAX_BYTES = 60_000
"""Largest size of a figure that is committed."""
LAYOUT_TOLERANCE = 4.0
"""Points by which versions of Matplotlib may lay out differently."""


class Parts(NamedTuple):
    """What a figure shows."""

    title: str
    words: list[str]
    numbers: list[float]
    places: np.ndarray  # of words and numbers, points [text, 2]
    extents: np.ndarray  # least and largest corner of every path, points [path, 2, 2]


def numbers_in(text):
    return [float(number) for number in NUMBER.findall(text)]


def parts_of(file):
    """`Parts` of a figure in an SVG file: its title, words, numbers, positions of the
    texts, and extents of the paths.
    """
    root = ElementTree.parse(file).getroot()
    words = []
    numbers = []
    places = []
    for element in root.iterfind(".//{*}text"):
        text = "".join(element.itertext()).replace("\N{MINUS SIGN}", "-")
        if NUMBER.fullmatch(text):
            numbers.append(float(text))
        else:
            words.append(text)
        places.append(numbers_in(element.get("transform"))[:2])
    extents = []
    for element in root.iterfind(".//{*}path"):
        corners = np.reshape(numbers_in(element.get("d")), (-1, 2))
        extents.append([corners.min(axis=0), corners.max(axis=0)])
    title = root.findtext(".//{*}title")
    return Parts(title, words, numbers, np.array(places), np.array(extents))


FIRST_FIGURES = ("student", 2)
WHOLE_PAGES = [(page, None) for page in page_figures.PAGES]


@pytest.mark.exhaustive
@pytest.mark.parametrize("part", few_of([FIRST_FIGURES, *WHOLE_PAGES], [FIRST_FIGURES]))
def test_committed_figures_are_those_of_their_cells(part, tmp_path, monkeypatch):
    """A part is a page, and how many of its figures are drawn: None for all."""
    page, count = part
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs" / f"{page}.md").read_text("utf-8")
    names = re.findall(r"\(figures/(\w+)\.svg\)", text)[:count]

    # Cells behind the last of these figures do not run.
    figures = itertools.islice(page_figures.figures_of(page), count)
    pictures = dict(figures)

    assert names
    assert set(names) == set(pictures)
    for name, picture in pictures.items():
        ri.plot.save(picture, tmp_path / f"{name}.svg")
        committed = ROOT / "docs" / "figures" / f"{name}.svg"
        assert committed.stat().st_size <= MAX_BYTES
        assert_show_the_same(parts_of(tmp_path / f"{name}.svg"), parts_of(committed))


def assert_show_the_same(drawn, committed):
    """Assert that the `Parts` of two figures are the same: title, words, numbers to 1 %,
    and positions of texts and extents of paths to LAYOUT_TOLERANCE, since versions of
    libraries draw differently.
    """
    title = committed.title
    assert drawn.title
    assert drawn.title == committed.title
    assert drawn.words == committed.words, title
    near_numbers = pytest.approx(committed.numbers, rel=0.01, abs=1e-9)
    assert drawn.numbers == near_numbers, title
    near_places = pytest.approx(committed.places, abs=LAYOUT_TOLERANCE)
    assert drawn.places == near_places, title
    near_extents = pytest.approx(committed.extents, abs=LAYOUT_TOLERANCE)
    assert drawn.extents == near_extents, title
