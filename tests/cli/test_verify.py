"""The self-check passes, and notices what it is there to notice."""

import math

import pytest

from rodimpact.cli import verify
from rodimpact.cli.verify import Check, checks


@pytest.mark.parametrize("check", checks(), ids=lambda check: check.name)
def test_the_solver_meets_the_closed_form(check):
    assert check.passed, check


def test_every_check_has_a_name_of_its_own():
    names = [check.name for check in checks()]
    assert len(set(names)) == len(names) > 25


def test_round_off_stays_far_below_the_bound():
    assert max(check.residual for check in checks()) < verify.BOUND / 100


def test_residuals_are_relative_unless_nothing_is_expected():
    assert Check("x", 1e6, 1e6 + 1e-3).residual == pytest.approx(1e-9)
    assert Check("x", 0.0, -1e-9).residual == 1e-9


def test_a_wrong_number_fails():
    assert not Check("x", 1.0, 1.0 + 1e-11).passed
    assert Check("x", 1.0, 1.0 + 1e-13).passed


def test_a_number_that_is_missing_fails():
    assert not Check("x", 1.0, math.nan).passed
    assert not verify.worst("family", [1.0, 2.0, 3.0], [1.0, math.nan, 3.5]).passed


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
