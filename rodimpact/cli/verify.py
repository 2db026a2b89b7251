"""Compare e of each method with a closed form. The exit status is 4 if a method fails.

The validation pages of the manual, docs/validation.md, compare hundreds of numbers with
closed forms, published test problems and measured records.
"""

import argparse
from typing import NamedTuple

from .. import RigidMass, Rod, System, solve, theory
from ..materials import brass, steel
from ..storage.tables import align, versioned_json
from .exit_status import DONE, UNVERIFIED, CommandResult

FRONTS_RTOL = 1e-12
CHARACTERISTICS_RTOL = 1e-9
GRID_RTOL = 1e-2
CELLS = 100
"""Cells of the grid."""
STRIKER = Rod(0.4, area=2e-4, material=steel, velocity=1.0)
HAMMER = RigidMass(0.5, velocity=1.0)  # kg, m/s
BAR = Rod(1.0, area=1e-4, material=brass)


class Check(NamedTuple):
    """A number of the solver beside the closed form.

    Attributes
    ----------
    name : str
        The collision, and the method that solved it.
    expected : float
        Coefficient of restitution e by the closed form.
    computed : float
        e by the solver.
    bound : float
        Largest relative difference that passes.
    """

    name: str
    expected: float
    computed: float
    bound: float

    @property
    def difference(self) -> float:
        """Relative difference, abs(computed - expected)/abs(expected)."""
        return abs(self.computed / self.expected - 1)

    @property
    def passed(self) -> bool:
        """Whether the difference is within the bound; nan is not."""
        return self.difference <= self.bound


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the option --json."""
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(args: argparse.Namespace) -> CommandResult:
    """Run all `checks`; table or JSON of the differences from closed forms.

    The status is UNVERIFIED if a check failed.
    """
    results = checks()
    failed = sum(not check.passed for check in results)
    status = DONE
    if failed:
        status = UNVERIFIED
    if args.json:
        return CommandResult(_json(results), status)
    total = f"All {len(results)} checks passed"
    if failed:
        total = f"{failed} of {len(results)} checks FAILED"
    pages = "The validation pages of the manual (docs/validation.md) compare many more."
    return CommandResult(f"{_table(results)}\n\n{total}. {pages}", status)


def _json(results: list[Check]) -> str:
    """JSON of all checks, and whether all passed.

    Each check has its fields, the difference, and whether it passed.
    """
    rows = []
    for check in results:
        row = check._asdict()
        row["difference"] = check.difference
        row["passed"] = check.passed
        rows.append(row)
    return versioned_json(passed=all(check.passed for check in results), checks=rows)


def _table(results: list[Check]) -> str:
    """Table of all checks: expected, computed, difference, bound, "ok" or "FAILED"."""
    rows = [["e of", "expected", "computed", "difference", "bound", ""]]
    for check in results:
        verdict = "FAILED"
        if check.passed:
            verdict = "ok"
        numbers = [f"{check.expected:.9g}", f"{check.computed:.9g}"]
        errors = [f"{check.difference:.1e}", f"{check.bound:.0e}"]
        rows.append([check.name, *numbers, *errors, verdict])
    return align(rows, left=(0, 5))


def checks() -> list[Check]:
    """Checks of the methods: a collision solved by each, beside its closed form.

    Returns
    -------
    list of Check

    Examples
    --------
    >>> all(check.passed for check in checks())
    True
    """
    striker = STRIKER.segments[0]
    bar = BAR.segments[0]
    two_rods = theory.saint_venant(
        striker.impedance,
        striker.transit_time,
        bar.impedance,
        bar.transit_time,
        closing_speed=1.0,
    )
    mass_on_rod = theory.mass_on_rod(
        HAMMER.mass, bar.impedance, bar.transit_time, speed=1.0
    )
    rods = System([STRIKER, BAR])
    hammer = System([HAMMER, BAR])
    fronts = solve(rods, method="fronts")
    pieces = solve(hammer, method="characteristics")
    grid = solve(hammer, method="finite-difference", cells=CELLS)
    return [
        Check(
            "two rods, by fronts",
            float(two_rods.restitution),
            fronts.outcome.restitution,
            FRONTS_RTOL,
        ),
        Check(
            "a mass on a rod, by characteristics",
            float(mass_on_rod.restitution),
            pieces.outcome.restitution,
            CHARACTERISTICS_RTOL,
        ),
        Check(
            f"a mass on a rod, by finite differences on {CELLS} cells",
            float(mass_on_rod.restitution),
            grid.outcome.restitution,
            GRID_RTOL,
        ),
    ]
