"""Error bands of few draws of the noise, unless a test reads them."""

import pytest

from rodimpact.records import shot

FEW_DRAWS = 4


@pytest.fixture
def all_draws():
    """Requested by tests that read error bands."""


@pytest.fixture(autouse=True)
def few_draws(request, monkeypatch):
    """Each draw takes as long as a reduction without bands."""
    if "all_draws" not in request.fixturenames:
        monkeypatch.setattr(shot, "NOISE_DRAWS", FEW_DRAWS)
