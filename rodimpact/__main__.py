"""The program: `rodimpact`, or `python -m rodimpact`."""

import os
import signal
import sys

if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
    signal.signal(
        signal.SIGINT, signal.SIG_DFL
    )  # Ctrl-C just ends it until `main` listens

from . import cli


def main() -> int:
    """Run the command; once interrupted, end at once, with no wait for threads that compute."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):  # so that nothing half-written stays
        number = getattr(signal, name, signal.SIGINT)
        if signal.getsignal(number) == signal.SIG_DFL:
            signal.signal(number, signal.default_int_handler)
    status = cli.main()
    if status == cli.INTERRUPTED:
        for stream in filter(None, (sys.stdout, sys.stderr)):
            stream.flush()
        os._exit(status)
    return status


if __name__ == "__main__":
    raise SystemExit(main())
