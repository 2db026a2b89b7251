"""Error bands of few draws of the noise, unless a test reads them."""

import pytest

from rodimpact.records import shot

FEW_DRAWS = 4


@pytest.fixture
def all_draws():
    """A test that requests this reads error bands: `few_draws` does nothing in it."""


@pytest.fixture(autouse=True)
def few_draws(request, monkeypatch):
    """Bands of other tests are made of few draws.

    Each draw takes as long as a reduction without bands.
    """
    if "all_draws" not in request.fixturenames:
        monkeypatch.setattr(shot, "NOISE_DRAWS", FEW_DRAWS)
