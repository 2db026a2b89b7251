"""The program: `rodimpact`, or `python -m rodimpact`."""

import os
import sys

INTERRUPTED = 130  # exit status after Ctrl-C, as shells have it


def main() -> int:
    """Run the command and return its exit status; after Ctrl-C, end the process here.

    Threads that still run would keep the process alive. So it ends with the status
    `INTERRUPTED` without waiting for them, once its output is written; this call does
    not return then.
    """
    try:
        from . import cli
    except KeyboardInterrupt:
        os._exit(INTERRUPTED)
    status = cli.main()
    if status == cli.INTERRUPTED:
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:  # without a console it is None
                stream.flush()
        os._exit(status)
    return status


if __name__ == "__main__":
    raise SystemExit(main())
