"""The page in a notebook: shown by a widget, which gives back what the sliders say."""

import sys

import pytest
from steel import rod

import rodimpact as ri

PAIR = ri.System([rod(0.4, 1.0), rod(1.0)])


@pytest.fixture
def explorer():
    """A page whose widget a notebook shows."""
    pytest.importorskip("anywidget", reason="the extra notebook is not installed")
    page = ri.explore(PAIR)
    page._repr_mimebundle_()
    return page


def test_without_the_extra_a_notebook_shows_the_frame(monkeypatch):
    """If the module of the widget is missing, a notebook shows the page in a frame."""
    monkeypatch.setitem(sys.modules, "rodimpact.explorer.notebook", None)
    page = ri.explore(PAIR)
    bundle = page._repr_mimebundle_()
    assert bundle["text/html"].startswith("<iframe srcdoc=")
    assert page.system == PAIR


def test_with_the_extra_a_notebook_shows_a_widget(explorer):
    data, _ = explorer._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in data
    assert explorer._widget.page == explorer.html
    assert explorer._repr_html_().startswith("<iframe")  # the form where no kernel runs


def test_the_system_is_that_of_the_case_that_the_page_sends_or_the_first_one(explorer):
    changed = PAIR.replace(bodies=[rod(0.7, 2.0), rod(1.0)], contacts=[ri.Hertz(2e10)])
    assert explorer.system == PAIR

    explorer._widget.case = ri.format_case(changed)
    assert explorer.system == changed

    # The page sends an empty text when all changes are undone.
    explorer._widget.case = ""
    assert explorer.system is PAIR
