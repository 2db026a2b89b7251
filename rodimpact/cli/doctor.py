"""Show versions, where compiled code is kept, and whether it works here.

One collision is solved by compiled and by interpreted code; exit status 4 if they do not agree
exactly. With --warm, everything that can run compiled is compiled and kept.
"""

import argparse
import platform
import time
from contextlib import suppress
from importlib import metadata

from .. import Rod, System, Wall, __version__, solve, warm
from ..materials import brass, steel
from ..methods import kernels
from ..methods.fronts.members import run_members
from ..storage.report import solution_json
from ..storage.tables import align, as_json
from . import DONE, UNVERIFIED
from .asking import note

PACKAGES = ("numpy", "scipy", "numba", "matplotlib")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Whether to compile everything, and the form of the answer."""
    parser.add_argument(
        "--warm",
        action="store_true",
        help="compile everything now, so that nothing waits later",
    )
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(given: argparse.Namespace) -> tuple[str, int]:
    """Table or JSON of the findings."""
    python = f"{platform.python_version()} on {platform.platform()}"
    versions = {"rodimpact": __version__, "python": python, **dict.fromkeys(PACKAGES)}
    for name in PACKAGES:
        with suppress(metadata.PackageNotFoundError):
            versions[name] = metadata.version(name)
    cache, agrees, verdict = try_compiled()
    status = UNVERIFIED if agrees is False else DONE
    seconds = warm() if given.warm and agrees else None
    if given.json:
        return as_json(
            versions=versions,
            cache_directory=cache,
            agrees=agrees,
            status=verdict,
            seconds_to_compile_all=seconds,
        ), status
    rows = [[name, version or "missing"] for name, version in versions.items()]
    rows += [["cache of compiled code", cache or "none"], ["compiled code", verdict]]
    if seconds is not None:
        rows.append(["everything compiled", f"in {seconds:.1f} s"])
    return align(rows, left=(0, 1)), status


def try_compiled() -> tuple[str | None, bool | None, str]:
    """Cache directory, whether compiled and interpreted code agree, and that in words.

    None where compiling is disabled.
    """
    reason = kernels.why_not()
    if not kernels.enabled():
        return None, None, f"{reason}; everything works, long runs are slow"
    if reason:
        return None, False, reason
    note("compiling; this takes a while the first time")
    try:
        begin = time.perf_counter()
        with kernels.forced(True):
            compiled = solve_a_row()
        seconds = time.perf_counter() - begin
        cache = kernels.compiled(run_members).place or None
    except (
        Exception
    ) as error:  # whatever is wrong with this installation is the finding
        return None, False, f"fails: {type(error).__name__}: {error}"
    with kernels.forced(False):
        if solve_a_row() != compiled:
            return cache, False, "does not agree with interpreted code"
    return cache, True, f"works ({seconds:.2g} s), agrees with interpreted code exactly"


def solve_a_row() -> str:
    """Every number that one run tells."""
    left = Rod(0.31, area=1e-4, material=steel, velocity=1.0)
    right = Rod(0.52, area=1e-4, material=brass)
    return solution_json(solve(System([left, right, Wall()], gaps=[1e-6, 1e-5])))
