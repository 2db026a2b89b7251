"""Show versions, and where compiled code is kept. With --warm, everything is compiled and kept.

Exit status 1 if --warm can compile nothing.
"""

import argparse
import platform
from contextlib import suppress
from importlib import metadata

from .. import __version__, warm
from ..methods import kernels
from ..methods.fronts.members import run_members
from ..storage.tables import align, as_json
from . import DONE, FAULT

UNWRITABLE = "no folder can be written; set NUMBA_CACHE_DIR to one"
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
    """Table or JSON of the versions and the cache."""
    versions: dict[str, str | None] = {
        "rodimpact": __version__,
        "python": f"{platform.python_version()} on {platform.platform()}",
    }
    for name in PACKAGES:
        versions[name] = None
        with suppress(metadata.PackageNotFoundError):
            versions[name] = metadata.version(name)
    cache = None
    seconds = None
    reason = kernels.why_not()
    if not reason:
        cache = kernels.compiled(run_members).place or None
        if given.warm:
            seconds = warm()
    status = FAULT if given.warm and reason else DONE
    if given.json:
        return as_json(
            versions=versions,
            cache_directory=cache,
            no_compiler=reason or None,
            seconds_to_compile_all=seconds,
        ), status
    rows = [[name, version or "missing"] for name, version in versions.items()]
    rows.append(["cache of compiled code", cache or f"none: {reason or UNWRITABLE}"])
    if seconds is not None:
        rows.append(["everything compiled", f"in {seconds:.1f} s"])
    return align(rows, left=(0, 1)), status
