"""Figures of the tutorials are what the cells above them show."""

import importlib.util
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import rodimpact as ri

ROOT = Path(__file__).parents[1]
spec = importlib.util.spec_from_file_location(
    "page_figures", ROOT / "docs" / "page_figures.py"
)
page_figures = importlib.util.module_from_spec(spec)
spec.loader.exec_module(page_figures)
NUMBER = re.compile(r"-?\d+\.?\d*")
MOST = 60_000  # bytes
OFF = 4.0  # points by which versions of Matplotlib may lay out differently


def parts(file):
    """Title, words, numbers and their places, and the extent of every path."""
    root = ElementTree.parse(file).getroot()
    tags = {
        tag: [e for e in root.iter() if e.tag.endswith("}" + tag)]
        for tag in ("text", "path")
    }
    texts = ["".join(e.itertext()).replace("\N{MINUS SIGN}", "-") for e in tags["text"]]
    places = [
        [float(x) for x in NUMBER.findall(e.get("transform"))[:2]] for e in tags["text"]
    ]
    paths = [
        np.array(NUMBER.findall(e.get("d")), float).reshape(-1, 2) for e in tags["path"]
    ]
    return (
        root.findtext(".//{*}title"),
        [t for t in texts if not NUMBER.fullmatch(t)],
        [float(t) for t in texts if NUMBER.fullmatch(t)],
        places,
        [[path.min(axis=0), path.max(axis=0)] for path in paths],
    )


@pytest.mark.parametrize(
    "page",
    [
        page if page == "student" else pytest.param(page, marks=pytest.mark.exhaustive)
        for page in page_figures.PAGES
    ],
)
def test_committed_figures_are_those_of_their_cells(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shown = re.findall(
        r"\(figures/(\w+)\.svg\)", (ROOT / "docs" / f"{page}.md").read_text("utf-8")
    )
    drawn = dict(page_figures.figures_of(page))
    assert shown
    assert set(shown) == set(drawn)
    for name, picture in drawn.items():
        ri.plot.save(picture, tmp_path / f"{name}.svg")
        committed = ROOT / "docs" / "figures" / f"{name}.svg"
        assert committed.stat().st_size <= MOST
        title, words, numbers, places, paths = parts(tmp_path / f"{name}.svg")
        others = parts(committed)
        assert title
        assert (title, words) == others[:2], name
        assert numbers == pytest.approx(others[2], rel=0.01, abs=1e-9), name
        assert np.array(places) == pytest.approx(np.array(others[3]), abs=OFF), name
        assert np.array(paths) == pytest.approx(np.array(others[4]), abs=OFF), name
