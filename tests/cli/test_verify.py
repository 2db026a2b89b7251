"""The self-check passes, and notices what it is there to notice."""

import math

import pytest

from rodimpact.cli import verify
from rodimpact.cli.verify import checks


def test_the_solver_meets_the_closed_forms_far_within_the_bound():
    found = checks()
    assert len({check.name for check in found}) == len(found) > 25
    assert [check for check in found if not check.residual < verify.BOUND / 100] == []


@pytest.mark.parametrize(("expected", "got", "residual"), [
    (1e6, 1e6 + 1e-3, 1e-9), (0.0, -1e-9, 1e-9), (1.0, 1.0 + 1e-11, 1e-11),
    (1.0, math.nan, math.nan), ([1.0, 2.0, 3.0], [1.0, math.nan, 3.5], math.nan),
])
def test_a_wrong_number_or_a_missing_one_fails(expected, got, residual):
    """Residuals are relative unless nothing is expected."""
    check = verify.worst("x", expected, got)
    assert check.residual == pytest.approx(residual, rel=1e-4, nan_ok=True)
    assert not check.passed
    assert verify.worst("x", 1.0, 1.0 + 1e-13).passed


def test_a_wrong_solver_is_noticed(monkeypatch):
    right = verify.solve

    def wrong(system, **options):
        solution = right(system, **options)
        object.__setattr__(
            solution.outcome, "velocities_after",
            tuple(v * (1 + 1e-9) for v in solution.outcome.velocities_after),
        )
        return solution

    monkeypatch.setattr(verify, "solve", wrong)
    failed = [check.name for check in checks() if not check.passed]
    assert "lengths l1 < l2: restitution" in failed
    assert any(name.startswith("35 pairs of rods: restitution") for name in failed)
