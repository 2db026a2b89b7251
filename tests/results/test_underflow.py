"""Numbers that vanish on purpose raise nothing, whatever NumPy is told to raise."""

import numpy as np
import pytest

import rodimpact as ri

STEEL = ri.materials.steel


def rod(length, velocity=0.0, **more):
    """A round rod of steel, of 10 mm."""
    return ri.Rod(length, diameter=0.01, material=STEEL, velocity=velocity, **more)


@pytest.mark.parametrize(
    "left", [rod(0.4, 1.0, lateral_inertia="mindlin-herrmann"), rod(0.4, 1e-150)]
)
def test_underflow_is_silent(left):
    """Radial motion that decays, and squares of a velocity of 1e-150 m/s, vanish."""
    system = ri.System([left, rod(1.0)])
    with np.errstate(all="raise"):
        solution = ri.solve(system, until=3e-4)
        duration = solution.outcome.contacts[0].duration
        energy = solution.energy([0.0, duration])
    assert np.all(np.isfinite(energy.total))
    assert np.all(np.isfinite(energy.residual))
