"""Play with a collision in the browser: sliders, the space-time diagram, the rods moving.

A server on this machine, for this machine only, shows the page until Ctrl-C. Without a case it
begins with two rods of different length.
"""

from __future__ import annotations

import argparse
import threading
import webbrowser

from ..model.frozen import InvalidModel
from . import DONE
from .asking import note

FIRST = "unequal"  # of the presets, where no case is given


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A case, and how to serve it."""
    parser.add_argument("case", metavar="CASE.toml", nargs="?", help="the case file to begin with")
    parser.add_argument("--port", metavar="N", default="0", help="default: any free one")
    parser.add_argument("--no-browser", action="store_true", help="print the address, open nothing")


def run(arguments: argparse.Namespace) -> tuple[str, int]:
    """Serve the page until interrupted."""
    from ..explore.design import Design
    from ..explore.presets import presets
    from ..explore.server import Server

    if not arguments.port.isdecimal() or not 0 <= int(arguments.port[:9]) < 1 << 16:
        message = f"must be a whole number from 0 to 65535, got {arguments.port!r}"
        raise InvalidModel([("--port", message)])
    if arguments.case is None:
        design = next(p.design for p in presets() if p.key == FIRST)
    else:
        design = Design.read(arguments.case)
    try:
        listening = Server(design, int(arguments.port))
    except OSError as error:
        remedy = "leave --port out for a free one"
        raise OSError(f"cannot use port {arguments.port}: {error.strerror}; {remedy}") from None
    with listening as server:
        print(server.url, flush=True)
        note("Ctrl-C ends it")
        if not arguments.no_browser:
            # some browsers return only when they are closed
            threading.Thread(target=webbrowser.open, args=[server.url], daemon=True).start()
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            note("")
    return "", DONE
