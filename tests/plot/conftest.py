"""Figures without a layout, unless a test asks where words and Axes are."""

import pytest
from matplotlib.layout_engine import ConstrainedLayoutEngine


@pytest.fixture
def laid_out():
    """Requested by tests of places, of sizes and of rendered figures."""


@pytest.fixture(autouse=True)
def without_layout(request, monkeypatch):
    """A layout takes longer than all else of a figure."""
    if "laid_out" not in request.fixturenames:
        monkeypatch.setattr(ConstrainedLayoutEngine, "execute", lambda *_: None)
