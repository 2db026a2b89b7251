"""Numbers that vanish on purpose raise nothing, whatever NumPy is told to raise."""

import numpy as np
import pytest

import rodimpact as ri

STEEL = ri.materials.steel


def rod(length, velocity=0.0, **more):
    return ri.Rod(length, diameter=0.01, material=STEEL, velocity=velocity, **more)


def laterally_inert():
    swelling = rod(0.4, 1.0, lateral_inertia="mindlin-herrmann")
    return str(ri.solve(ri.System([swelling, rod(1.0)]), until=3e-4, cells=50).outcome)


def slow():
    return ri.solve(ri.System([rod(0.4, 1e-150), rod(1.0)]), until=1e-3).energy([0.0, 5e-4])


@pytest.mark.parametrize("call", [laterally_inert, slow])
def test_underflow_is_silent(call):
    with np.errstate(all="raise"):
        assert call()
