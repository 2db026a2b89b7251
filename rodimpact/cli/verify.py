"""Check the solver against closed forms. Exit status 4 if any number is off."""

from __future__ import annotations

import argparse

from ..storage.tables import align, as_json, finite
from . import DONE, UNVERIFIED, selfcheck


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Only the form of the answer."""
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(given: argparse.Namespace) -> tuple[str, int]:
    """Table or JSON of the residuals."""
    checks = selfcheck.checks()
    failed = sum(not check.passed for check in checks)
    status = UNVERIFIED if failed else DONE
    if given.json:
        rows = [{"name": c.name, "expected": c.expected, "got": finite(c.got), "bound": c.bound,
                 "residual": finite(c.residual), "passed": c.passed} for c in checks]
        return as_json(passed=not failed, checks=rows), status
    table = [["check", "expected", "found", "residual", "bound", ""], *(
        [c.name, f"{c.expected:.9g}", f"{c.got:.9g}", f"{c.residual:.1e}", f"{c.bound:.0e}",
         "ok" if c.passed else "FAILED"] for c in checks)]
    verdict = f"{failed} checks FAILED" if failed else f"All {len(checks)} checks passed"
    text = f"{verdict}; a check of several cases shows the worst."
    return f"{align(table, left=(0, 5))}\n\n{text}", status
