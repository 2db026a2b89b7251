"""Show versions and the folder of compiled code; with --warm, compile all methods.

The exit status is 1 if --warm cannot compile.
"""

import argparse
import platform
from contextlib import suppress
from importlib import metadata

from .. import __version__, warm
from ..methods import kernels
from ..methods.fronts.members import run_members
from ..storage.tables import align, versioned_json
from .exit_status import DONE, FAULT, CommandResult

NO_CACHE_FOLDER = "no folder can be written; set NUMBA_CACHE_DIR to one"
PACKAGES = ("numpy", "scipy", "numba", "matplotlib")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options --warm and --json."""
    parser.add_argument(
        "--warm",
        action="store_true",
        help="compile all methods now, so that later runs need not wait",
    )
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(args: argparse.Namespace) -> CommandResult:
    """Table or JSON of the versions and the cache; with --warm, compile everything.

    With --warm the result also has the time that this took. Without a compiler the
    reason is given in place of the cache; with --warm the status then is FAULT.
    """
    versions = _versions()
    cache = None
    seconds = None
    why_no_compiler = None
    status = DONE
    reason = kernels.why_not()
    if reason:
        why_no_compiler = reason
        if args.warm:
            status = FAULT
    else:
        folder = kernels.compiled(run_members).place
        if folder:
            cache = folder
        if args.warm:
            seconds = warm()
    if args.json:
        text = versioned_json(
            versions=versions,
            cache_directory=cache,
            no_compiler=why_no_compiler,
            seconds_to_compile_all=seconds,
        )
        return CommandResult(text, status)
    rows = []
    for name, version in versions.items():
        if version is None:
            version = "missing"
        rows.append([name, version])
    if cache is None:
        cache = f"none: {NO_CACHE_FOLDER}"
        if why_no_compiler is not None:
            cache = f"none: {why_no_compiler}"
    rows.append(["cache of compiled code", cache])
    if seconds is not None:
        rows.append(["everything compiled", f"in {seconds:.1f} s"])
    return CommandResult(align(rows, left=(0, 1)), status)


def _versions() -> dict[str, str | None]:
    """Versions of rodimpact, of Python and of `PACKAGES`; None for a missing one."""
    versions: dict[str, str | None] = {
        "rodimpact": __version__,
        "python": f"{platform.python_version()} on {platform.platform()}",
    }
    for name in PACKAGES:
        versions[name] = None
        with suppress(metadata.PackageNotFoundError):
            versions[name] = metadata.version(name)
    return versions
