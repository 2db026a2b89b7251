"""The program: `rodimpact`, or `python -m rodimpact`."""

import signal

if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C just ends it until `main` listens

from .cli import main as main

if __name__ == "__main__":
    raise SystemExit(main())
