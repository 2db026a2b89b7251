"""Floating-point errors raise; random examples are the same in every run; kernels
compile once.

``pytest --hypothesis-profile=many`` draws more examples.
"""

import gc
import signal
import warnings

import numpy as np
import pytest
from hypothesis import settings

from rodimpact.methods import kernels
from rodimpact.methods.registry import METHODS
from rodimpact.running.warming import warm_method

for profile, examples in (("few", 3), ("many", 300)):
    settings.register_profile(
        profile, max_examples=examples, derandomize=True, deadline=None, print_blob=True
    )
settings.load_profile("few")

MANY = 1000  # tests that need all kernels


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Imported modules live to the end: the garbage collector need not search them."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_collection_finish(session):
    """Workers share the kernels among them, so that no two compile the same."""
    worker = getattr(session.config, "workerinput", None)
    if worker and len(session.items) > MANY and not kernels.why_not():
        number = int(worker["workerid"].removeprefix("gw"))
        count = worker["workercount"]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            for name in [*METHODS][number::count]:
                warm_method(name)


@pytest.fixture(autouse=True)
def floating_point_errors_raise():
    """No test may divide by zero, overflow or take an invalid operation."""
    with np.errstate(all="raise", under="ignore"):
        yield


@pytest.fixture
def children_hear_signals():
    """Children do not inherit that SIGINT is ignored, as in what `&` started.

    What is caught here is not caught there.
    """
    ignored = signal.getsignal(signal.SIGINT) == signal.SIG_IGN
    if ignored:
        signal.signal(signal.SIGINT, lambda *_: None)
    yield
    if ignored:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
