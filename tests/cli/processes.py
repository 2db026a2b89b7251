"""Python in processes of its own."""

import contextlib
import os
import subprocess
import sys
from pathlib import Path

import rodimpact as ri

ROOT = Path(ri.__file__).parent.parent
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT), "MPLBACKEND": "agg"}
DEFAULTS = {
    "env": ENVIRONMENT,
    "text": True,
    "stdout": subprocess.PIPE,
    "stderr": subprocess.PIPE,
}


def python(*arguments, **options):
    """Run Python on the package in a process of its own."""
    command = [sys.executable, *map(str, arguments)]
    return subprocess.run(command, timeout=60, check=False, **(DEFAULTS | options))


@contextlib.contextmanager
def started(*arguments, **options):
    """A process like that of `python`, which works while the block runs.

    It is killed if it has not ended with the block.
    """
    command = [sys.executable, *map(str, arguments)]
    with subprocess.Popen(command, **(DEFAULTS | options)) as process:
        try:
            yield process
        finally:
            process.kill()
